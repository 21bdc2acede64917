//! Two runs side by side, as their statistics tell of them.

use std::collections::HashMap;

use serde::Serialize;
use serde_json::Value;

use super::summary::{WIDTH, aligned, grouped, prose, table, time, wrapped};

/// Stations that are named in a line.
const NAMED: usize = 4;

/// Figures that are told first, if the statistics have them.
const FIRST: [&str; 4] = ["cycles", "rays_per_second", "speed_up", "efficiency"];

/// What statistics say, value by value.
#[derive(Clone, Debug)]
pub struct Figures {
    document: Value,
    /// Each value that is no list and no object, under its path, in the file's order.
    values: Vec<(String, Value)>,
}

/// A value that two statistics do not share.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Its path: `cells.0.busy.grid`, `fifos.X1.max`.
    pub name: String,
    /// What the first says; nothing where it has no such value.
    pub a: Option<Value>,
    /// What the second says.
    pub b: Option<Value>,
}

/// What two statistics say of their runs.
#[derive(Clone, Debug)]
pub struct Comparison {
    a: Figures,
    b: Figures,
    /// Where they differ.
    pub differences: Vec<Difference>,
    /// How many values are the same in both.
    pub same: usize,
}

impl Figures {
    /// The values of a statistics file.
    pub fn new(document: Value) -> Figures {
        let mut values = Vec::new();
        collect(String::new(), &document, &mut values);
        Figures { document, values }
    }

    fn number(&self, name: &str) -> Option<f64> {
        self.document.get(name)?.as_f64()
    }

    /// The stations that work most, in percent of the run, and what they are called.
    fn busiest(&self) -> Option<String> {
        let (noun, stations) = match (self.document.get("cells"), self.document.get("tasks")) {
            (Some(cells), _) => ("cell ", cells),
            (None, tasks) => ("", tasks?),
        };
        let cycles = self.number("cycles")?.max(1.0);
        let works = |station: &Value| {
            let busy = station.get("busy").and_then(Value::as_object).into_iter().flatten().map(|(_, cycles)| cycles);
            busy.chain(station.get("moving")).filter_map(Value::as_f64).sum::<f64>()
        };
        let name = |(at, station): (usize, &Value)| {
            let name = station.get("name").and_then(Value::as_str).map_or_else(|| at.to_string(), str::to_owned);
            (works(station), format!("{noun}{name}"))
        };
        let mut all: Vec<(f64, String)> = stations.as_array()?.iter().enumerate().map(name).collect();
        all.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        let told = all.iter().take(NAMED).map(|(works, name)| format!("{name} {:.1} %", 100.0 * works / cycles));
        Some(told.collect::<Vec<_>>().join(", "))
    }
}

fn collect(path: String, value: &Value, values: &mut Vec<(String, Value)>) {
    let inside = |key: &str| if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") };
    match value {
        Value::Object(fields) => fields.iter().for_each(|(key, value)| collect(inside(key), value, values)),
        Value::Array(items) => items.iter().enumerate().for_each(|(index, item)| {
            // FIFOs have names, and two runs need not have the same number of them.
            let name = item.get("name").and_then(Value::as_str).map(str::to_owned);
            collect(inside(&name.unwrap_or_else(|| index.to_string())), item, values);
        }),
        leaf => values.push((path, leaf.clone())),
    }
}

impl Comparison {
    /// Compares two.
    pub fn new(a: Figures, b: Figures) -> Comparison {
        let of_b: HashMap<&str, &Value> = b.values.iter().map(|(name, value)| (name.as_str(), value)).collect();
        let of_a: HashMap<&str, &Value> = a.values.iter().map(|(name, value)| (name.as_str(), value)).collect();
        let in_b_alone = b.values.iter().filter(|(name, _)| !of_a.contains_key(name.as_str()));
        let all = a.values.iter().chain(in_b_alone).map(|(name, _)| Difference {
            name: name.clone(),
            a: of_a.get(name.as_str()).copied().cloned(),
            b: of_b.get(name.as_str()).copied().cloned(),
        });
        let (same, differences): (Vec<_>, Vec<_>) = all.partition(|value| value.a == value.b);
        let same = same.len();
        Comparison { a, b, differences, same }
    }

    /// What matters most, in ten lines: which is faster, by how much, what is other in the configuration, who works most.
    pub fn summary(&self) -> String {
        let mut lines = vec![self.verdict()];
        let figures = FIRST.iter().filter_map(|name| {
            let (a, b) = (self.a.document.get(*name), self.b.document.get(*name));
            (a.is_some() || b.is_some()).then(|| Difference { name: name.to_string(), a: a.cloned(), b: b.cloned() })
        });
        lines.push(rows(figures.collect::<Vec<_>>().iter()).trim_end().to_owned());
        lines.push(self.configuration());
        let busiest = [("A", &self.a), ("B", &self.b)].map(|(name, run)| (name, run.busiest()));
        lines.extend(busiest.into_iter().filter_map(|(name, told)| Some(format!("busiest in {name}: {}", told?))));
        let count = self.differences.len();
        let more = if count == 0 { "" } else { "; --all lists them" };
        lines.push(format!("{count} values differ, {} are the same{more}", self.same));
        prose(&lines.join("\n")) + "\n"
    }

    /// Which is faster.
    fn verdict(&self) -> String {
        let of = |name: &str| self.a.number(name).zip(self.b.number(name));
        if self.differences.is_empty() {
            return "A and B are the same.".to_owned();
        }
        // Where they do not do the same work, their rates tell more than their times.
        let other_work = of("rays").is_some_and(|(a, b)| a != b);
        let (what, (a, b)) = match (other_work.then(|| of("rays_per_second")).flatten(), of("seconds")) {
            (Some((a, b)), _) => ("a ray", (1.0 / a.max(f64::MIN_POSITIVE), 1.0 / b.max(f64::MIN_POSITIVE))),
            (None, Some(seconds)) => ("the run", seconds),
            (None, None) => return "A and B tell no times.".to_owned(),
        };
        let told = |seconds: f64| time(seconds);
        match (b / a - 1.0) * 100.0 {
            change if change > 0.0 => {
                format!("B is slower: {what} takes {} in place of {}, {change:.2} % more.", told(b), told(a))
            }
            change if change < 0.0 => {
                format!("B is faster: {what} takes {} in place of {}, {:.2} % less.", told(b), told(a), -change)
            }
            _ => format!("Neither is faster: {what} takes {} in both.", told(a)),
        }
    }

    /// What differs in the configuration, in a line or two.
    fn configuration(&self) -> String {
        let of_configuration = |difference: &&Difference| difference.name.starts_with("configuration.");
        let all: Vec<&Difference> = self.differences.iter().filter(of_configuration).collect();
        let mut text = "configuration: ".to_owned() + if all.is_empty() { "the same" } else { "" };
        for (at, difference) in all.iter().enumerate() {
            let name = difference.name.trim_start_matches("configuration.");
            let part = format!("{name} {} to {}", shown(difference.a.as_ref()), shown(difference.b.as_ref()));
            let part = if at == 0 { part } else { format!("; {part}") };
            let left = all.len() - at;
            if at > 0 && text.chars().count() + part.chars().count() > 2 * WIDTH - 20 {
                return text + &format!("; and {left} more");
            }
            text += &part;
        }
        text
    }

    /// Everything that differs: a table of what there are numbers for, then the texts.
    pub fn all(&self) -> String {
        let is_text = |difference: &&Difference| {
            [&difference.a, &difference.b].into_iter().flatten().any(|value| shown(Some(value)).len() > LONGEST)
        };
        let (texts, figures): (Vec<&Difference>, Vec<&Difference>) = self.differences.iter().partition(is_text);
        let mut told = if figures.is_empty() { String::new() } else { rows(figures.into_iter()) };
        for Difference { name, a, b } in texts {
            let line = |side: &str, value: &Option<Value>| {
                wrapped(&format!("{side}: {}", shown(value.as_ref())), WIDTH - 2).replace('\n', "\n  ")
            };
            told += &format!("{name}\n  {}\n  {}\n", line("A", a), line("B", b));
        }
        told
    }

    /// The same as CSV: each value as the files have it.
    pub fn csv(&self) -> Result<String, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(["name", "a", "b", "difference", "change"])?;
        for difference in &self.differences {
            let bare = |value: &Option<Value>| match value {
                None => String::new(),
                Some(Value::String(text)) => text.clone(),
                Some(value) => value.to_string(),
            };
            let number = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
            let (a, b) = (bare(&difference.a), bare(&difference.b));
            writer.write_record([
                &difference.name,
                &a,
                &b,
                &number(difference.change()),
                &number(difference.share()),
            ])?;
        }
        let bytes = writer.into_inner().map_err(|error| error.into_error())?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// The same as indented JSON.
    pub fn json(&self) -> serde_json::Result<String> {
        #[derive(Serialize)]
        struct Whole<'a> {
            verdict: String,
            same: usize,
            differences: &'a [Difference],
        }
        let whole = Whole { verdict: self.verdict(), same: self.same, differences: &self.differences };
        serde_json::to_string_pretty(&whole).map(|json| json + "\n")
    }
}

impl Difference {
    /// By how much a number changed.
    fn change(&self) -> Option<f64> {
        let number = |value: &Option<Value>| value.as_ref().and_then(Value::as_f64);
        Some(number(&self.b)? - number(&self.a)?)
    }

    /// The same, as a share of what it was.
    fn share(&self) -> Option<f64> {
        let before = self.a.as_ref().and_then(Value::as_f64).filter(|before| *before != 0.0)?;
        Some(self.change()? / before)
    }
}

/// The longest text that has its place in a table, in bytes.
const LONGEST: usize = 20;

/// Differences as a table.
fn rows<'a>(differences: impl Iterator<Item = &'a Difference>) -> String {
    let mut rows = table(&["", "A", "B", "change"]);
    for difference in differences {
        let change = match (difference.share(), difference.change()) {
            (Some(share), _) => format!("{:+.2} %", 100.0 * share),
            (None, Some(change)) if change != 0.0 => format!("+{}", figure(change)),
            _ => String::new(),
        };
        rows.add_row([difference.name.clone(), shown(difference.a.as_ref()), shown(difference.b.as_ref()), change]);
    }
    aligned(rows)
}

fn shown(value: Option<&Value>) -> String {
    match value {
        None => "-".to_owned(),
        Some(Value::String(text)) => text.clone(),
        Some(Value::Number(number)) => {
            number.as_u64().map_or_else(|| figure(number.as_f64().unwrap_or_default()), grouped)
        }
        Some(value) => value.to_string(),
    }
}

/// A number as people read it: whole, or with two to six decimals.
fn figure(value: f64) -> String {
    let sign = if value < 0.0 { "-" } else { "" };
    let digits = match value.abs() {
        whole if whole.fract() == 0.0 && whole < 1e15 => 0,
        large if large >= 100.0 => 2,
        _ => 6,
    };
    let text = format!("{:.digits$}", value.abs());
    let (whole, fraction) = text.split_once('.').unwrap_or((&text, ""));
    let whole = whole.parse().map_or_else(|_| whole.to_owned(), grouped);
    if fraction.is_empty() { format!("{sign}{whole}") } else { format!("{sign}{whole}.{fraction}") }
}
