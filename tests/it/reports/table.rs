//! The tables of the reports, and their cells by name.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// A table: its headings and rows.
pub struct Table {
    pub name: String,
    pub headings: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    pub fn read(path: &Path) -> Result<Table, String> {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let unreadable = |error: csv::Error| format!("{}: {error}", path.display());
        let mut reader = csv::Reader::from_path(path).map_err(unreadable)?;
        let cells = |row: &csv::StringRecord| row.iter().map(str::to_owned).collect::<Vec<_>>();
        let headings = cells(reader.headers().map_err(unreadable)?);
        let rows = reader.records().map(|row| row.map(|row| cells(&row))).collect::<Result<_, _>>();
        Ok(Table { name, headings, rows: rows.map_err(unreadable)? })
    }

    /// The cells of a column, in the rows that meet all conditions.
    pub fn cells(&self, conditions: &[Condition], column: &str) -> Result<Vec<&str>, String> {
        let place = |name: &str| {
            let found = self.headings.iter().position(|heading| heading == name);
            found.ok_or(format!("{} has no column {name}", self.name))
        };
        let column = place(column)?;
        let mut rows: Vec<_> = self.rows.iter().collect();
        for condition in conditions {
            let key = place(&condition.column)?;
            rows.retain(|row| condition.holds(&row[key]));
        }
        if rows.is_empty() {
            Err(format!("{} has no such row", self.name))
        } else {
            Ok(rows.iter().map(|row| row[column].as_str()).collect())
        }
    }
}

/// What a row's cell must be: `cells=16`, `cells<=32`, `scene!=tree`, `scene=teapot|gears`; `_` stands for a space.
pub struct Condition {
    column: String,
    operator: &'static str,
    values: Vec<String>,
}

impl Condition {
    const OPERATORS: [&str; 6] = ["!=", "<=", ">=", "=", "<", ">"];

    /// The condition that a word is, if it is one.
    pub fn parse(word: &str) -> Option<Condition> {
        let (operator, at) = Self::OPERATORS.iter().find_map(|operator| Some((*operator, word.find(operator)?)))?;
        let values = word[at + operator.len()..].split('|').map(str::to_owned).collect();
        Some(Condition { column: word[..at].to_owned(), operator, values })
    }

    /// What it compares with.
    pub fn values(&self) -> &[String] {
        &self.values
    }

    fn holds(&self, cell: &str) -> bool {
        let number = |text: &str| text.parse::<f64>().ok();
        let order = |value: &String| number(cell)?.partial_cmp(&number(value)?);
        let is = |value: &String| {
            order(value).map_or_else(|| value.replace('_', " ") == cell.replace('_', " "), |o| o.is_eq())
        };
        let orders = || self.values.iter().filter_map(order);
        match self.operator {
            "=" => self.values.iter().any(is),
            "!=" => !self.values.iter().any(is),
            "<=" => orders().any(|order| order.is_le()),
            ">=" => orders().any(|order| order.is_ge()),
            "<" => orders().any(|order| order.is_lt()),
            _ => orders().any(|order| order.is_gt()),
        }
    }
}

/// Tables that have been read.
#[derive(Default)]
pub struct Tables(HashMap<PathBuf, Table>);

impl Tables {
    pub fn get(&mut self, path: &Path) -> Result<&Table, String> {
        if !self.0.contains_key(path) {
            self.0.insert(path.to_owned(), Table::read(path)?);
        }
        Ok(&self.0[path])
    }
}
