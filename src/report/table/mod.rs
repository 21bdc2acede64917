//! Tables of many runs: a row a run, a column a parameter or a figure.

mod parquet;
mod read;

use std::io::Write;
use std::path::Path;

use crate::error::InputError;
use crate::input::is_stream;

pub use self::parquet::{ParquetError, write_parquet};
pub use self::read::StoredTable;

/// What the cells of a column hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Words.
    Text,
    /// `true` or `false`.
    Truth,
    /// Whole numbers from 0 to 2^63 - 1.
    Whole,
    /// Numbers with a fraction.
    Number,
}

/// A column of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column<'a> {
    /// Its heading.
    pub name: &'a str,
    /// What its cells hold.
    pub kind: Kind,
    /// What it tells, with its unit: the name of an axis.
    pub label: &'a str,
}

impl<'a> Column<'a> {
    /// A column with a heading, of a kind, that tells what the label says.
    pub const fn new(name: &'a str, kind: Kind, label: &'a str) -> Column<'a> {
        Column { name, kind, label }
    }
}

/// A table. A cell is text as CSV has it, whatever the column's kind; an empty one has no value.
#[derive(Clone, Debug)]
pub struct Table<'a> {
    /// The columns.
    pub columns: &'a [Column<'a>],
    /// The rows, each as long as there are columns.
    pub rows: Vec<&'a [String]>,
}

impl Table<'_> {
    /// The cells of a column, from top to bottom.
    pub fn column(&self, index: usize) -> impl Iterator<Item = &str> {
        self.rows.iter().map(move |row| row[index].as_str())
    }
}

/// Fails if a table cannot have that name, which is written as CSV and as Parquet, side by side.
pub fn check_name(path: &Path) -> Result<(), InputError> {
    if is_stream(path) {
        let error = InputError::in_file(path, "a table is several files, which standard output cannot be");
        return Err(error.help("name it: table.csv"));
    }
    if path.extension().is_some_and(|ending| ending == "csv" || ending == "parquet") {
        return Ok(());
    }
    let error = InputError::in_file(path, "a table's name must end in .csv or .parquet");
    Err(error.help("it is written as both, side by side"))
}

/// Writes a table as CSV.
pub fn write_csv(out: impl Write, table: &Table<'_>) -> csv::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(table.columns.iter().map(|column| column.name))?;
    table.rows.iter().try_for_each(|row| writer.write_record(*row))?;
    Ok(writer.flush()?)
}
