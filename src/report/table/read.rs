//! Tables that others wrote.

use std::path::Path;

use super::{Column, Kind};
use crate::error::InputError;
use crate::input::fields;

/// A table read from a CSV file, whose columns are told apart by what is in them.
#[derive(Clone, Debug)]
pub struct CsvTable {
    headings: Vec<String>,
    labels: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl CsvTable {
    /// Reads a table; its first line has the headings. Fails if a row is longer or shorter than they are.
    pub fn read(path: &Path) -> Result<CsvTable, InputError> {
        let text = fields::read_text(path)?;
        let faulty = |error: csv::Error| InputError::in_file(path, format!("is no table: {error}"));
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let cells = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect::<Vec<_>>();
        let headings = cells(reader.headers().map_err(faulty)?);
        let labels = headings.iter().map(|heading| heading.replace('_', " ")).collect();
        let rows = reader.records().map(|row| row.map(|row| cells(&row))).collect::<Result<_, _>>().map_err(faulty)?;
        Ok(CsvTable { headings, labels, rows })
    }

    /// The columns. One in which every cell that is not empty is a number holds numbers.
    pub fn columns(&self) -> Vec<Column<'_>> {
        let kind = |index: usize| {
            let mut cells = self.rows.iter().map(|row| &row[index]).filter(|cell| !cell.is_empty());
            if cells.all(|cell| cell.parse::<f64>().is_ok()) { Kind::Number } else { Kind::Text }
        };
        let names = self.headings.iter().zip(&self.labels).enumerate();
        names.map(|(index, (name, label))| Column { name, kind: kind(index), label }).collect()
    }

    /// The rows that have all of these values in the columns of these numbers.
    pub fn rows_with(&self, values: &[(usize, &str)]) -> Vec<&[String]> {
        let has_all = |row: &&Vec<String>| values.iter().all(|(column, value)| row[*column] == *value);
        self.rows.iter().filter(has_all).map(Vec::as_slice).collect()
    }
}
