//! `pcs-sim compare A.json B.json`: two runs side by side.

use std::path::Path;

use pcs_sim::error::InputError;
use pcs_sim::input::is_stream;
use pcs_sim::report::comparison::{Comparison, Figures};
use pcs_sim::run::read_text;
use serde_json::Value;

use super::args::CompareArgs;
use super::{Failure, outputs, print};

mod side_by_side;

/// Tells in what two statistics files differ. Fails with status 1 if they do.
pub fn compare(args: &CompareArgs) -> Result<(), Failure> {
    if [&args.a, &args.b].iter().all(|path| is_stream(path)) {
        return Err(InputError::new("standard input cannot be both runs").help("name a file for one of them").into());
    }
    let inputs = [Some(args.a.as_path()), Some(args.b.as_path())];
    outputs::check_distinct(&[args.page.as_ref()], &inputs)?;
    let page = outputs::open(args.page.as_deref(), args.force)?;
    let (a, b) = (read(&args.a)?, read(&args.b)?);
    let comparison = Comparison::new(Figures::new(a.clone()), Figures::new(b.clone()));
    let unmade = |error: &dyn std::fmt::Display| Failure::Output(format!("the comparison cannot be written: {error}"));
    print(&if args.json {
        comparison.json().map_err(|error| unmade(&error))?
    } else if args.csv {
        comparison.csv().map_err(|error| unmade(&error))?
    } else {
        let all = if args.all { format!("\n{}", comparison.all()) } else { String::new() };
        format!("A: {}\nB: {}\n{}{all}", args.a.display(), args.b.display(), comparison.summary())
    })?;
    if let Some(page) = page {
        side_by_side::write(page, [(&args.a, a), (&args.b, b)], args.threads, args.json || args.csv)?;
    }
    if comparison.differences.is_empty() { Ok(()) } else { Err(Failure::Differ) }
}

/// A statistics file.
fn read(path: &Path) -> Result<Value, InputError> {
    let text = read_text(path)?;
    let value: Value = serde_json::from_str(&text).map_err(|error| {
        let what = format!("is no statistics file: {error}");
        InputError::in_text(path, &text, error.line(), error.column().max(1), 1, what)
    })?;
    if value.get("cycles").is_none() {
        let error = InputError::in_file(path, "is no statistics file: it has no cycles");
        return Err(error.help("--stats writes such files"));
    }
    Ok(value)
}
