//! `pcs-sim compare A.json B.json`: two runs side by side.

use std::collections::BTreeMap;
use std::path::Path;

use pcs_sim::error::InputError;
use pcs_sim::report::summary::{aligned, table};
use serde_json::Value;

use super::args::CompareArgs;
use super::{Failure, print};

/// Prints every figure and parameter in which two statistics files differ.
pub fn compare(args: &CompareArgs) -> Result<(), Failure> {
    let (a, b) = (leaves(&args.a)?, leaves(&args.b)?);
    let names: std::collections::BTreeSet<&String> = a.keys().chain(b.keys()).collect();
    let mut rows = table(&["", "A", "B", "B - A", "change"]);
    let mut differ = 0;
    for name in &names {
        let (left, right) = (a.get(*name), b.get(*name));
        if left == right {
            continue;
        }
        differ += 1;
        let (difference, change) = change(left, right);
        rows.add_row([name.to_string(), shown(left), shown(right), difference, change]);
    }
    let heading = format!("A: {}\nB: {}\n", args.a.display(), args.b.display());
    let same = names.len() - differ;
    if differ == 0 {
        return print(&format!("{heading}\nall {same} values are the same\n"));
    }
    print(&format!("{heading}\n{}\n{differ} values differ, {same} are the same\n", aligned(rows)))
}

/// All values of a file that are no lists or objects, each with its path: `cells.0.busy.grid`, `fifos.X1.max`.
fn leaves(path: &Path) -> Result<BTreeMap<String, Value>, InputError> {
    let unreadable = |error: std::io::Error| InputError::in_file(path, format!("cannot be read: {error}"));
    let text = std::fs::read_to_string(path).map_err(unreadable)?;
    let value: Value = serde_json::from_str(&text).map_err(|error| {
        let what = format!("is no statistics file: {error}");
        InputError::in_text(path, &text, error.line(), error.column().max(1), 1, what)
    })?;
    if value.get("cycles").is_none() {
        let error = InputError::in_file(path, "is no statistics file: it has no cycles");
        return Err(error.help("--stats writes such files"));
    }
    let mut leaves = BTreeMap::new();
    collect(String::new(), value, &mut leaves);
    Ok(leaves)
}

fn collect(path: String, value: Value, leaves: &mut BTreeMap<String, Value>) {
    let inside = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        Value::Object(fields) => fields.into_iter().for_each(|(key, value)| collect(inside(&key), value, leaves)),
        Value::Array(items) => items.into_iter().enumerate().for_each(|(index, item)| {
            // FIFOs have names, and two runs need not have the same number of them.
            let name = item.get("name").and_then(Value::as_str).map(str::to_owned);
            collect(inside(&name.unwrap_or_else(|| format!("{index:03}"))), item, leaves);
        }),
        leaf => {
            leaves.insert(path, leaf);
        }
    }
}

fn shown(value: Option<&Value>) -> String {
    match value {
        None => "-".to_owned(),
        Some(Value::String(text)) => text.clone(),
        Some(Value::Number(number)) if number.is_f64() => format!("{:.6}", number.as_f64().unwrap_or_default()),
        Some(value) => value.to_string(),
    }
}

/// By how much a number changed, by itself and in percent.
fn change(left: Option<&Value>, right: Option<&Value>) -> (String, String) {
    let number = |value: Option<&Value>| value.and_then(Value::as_f64);
    let (Some(a), Some(b)) = (number(left), number(right)) else { return (String::new(), String::new()) };
    let digits = if (b - a).fract() == 0.0 { 0 } else { 6 };
    let percent = if a == 0.0 { String::new() } else { format!("{:+.2} %", 100.0 * (b - a) / a) };
    (format!("{:+.digits$}", b - a), percent)
}
