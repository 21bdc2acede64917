//! Tables that are there already, as CSV or as Parquet.

use std::panic;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use bytes::Bytes;
use parquet::basic::Type as Physical;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;

use super::{Column, Kind};
use crate::error::InputError;
use crate::input::fields;

/// A table that was read from a file.
#[derive(Clone, Debug)]
pub struct StoredTable {
    headings: Vec<String>,
    labels: Vec<String>,
    kinds: Vec<Kind>,
    rows: Vec<Vec<String>>,
}

/// What a Parquet file begins with.
const PARQUET: &[u8] = b"PAR1";

impl StoredTable {
    /// Reads a table: Parquet, or CSV whose first line has the headings. `label` tells what columns of some names are called, given
    /// all headings; the others are called by their names.
    ///
    /// # Errors
    ///
    /// If the file cannot be read or is no table, for example as a row is longer or shorter than the headings.
    pub fn read(
        path: &Path,
        label: impl Fn(&[String], &str) -> Option<&'static str>,
    ) -> Result<StoredTable, InputError> {
        let faulty = |error: String| InputError::in_file(path, format!("is no table: {error}"));
        let bytes = fields::read_bytes(path)?;
        let (headings, kinds, rows) = if bytes.starts_with(PARQUET) {
            unless_damaged(|| of_parquet(bytes)).map_err(|error| faulty(error.to_string()))?
        } else {
            of_csv(&fields::text_of(path, bytes)?).map_err(|error| faulty(error.to_string()))?
        };
        let called =
            |heading: &String| label(&headings, heading).map_or_else(|| heading.replace('_', " "), str::to_owned);
        let labels = headings.iter().map(called).collect();
        Ok(StoredTable { headings, labels, kinds, rows })
    }

    /// The columns.
    pub fn columns(&self) -> Vec<Column<'_>> {
        let named = self.headings.iter().zip(&self.labels).zip(&self.kinds);
        named.map(|((name, label), &kind)| Column { name, kind, label }).collect()
    }

    /// The rows.
    pub fn rows(&self) -> Vec<&[String]> {
        self.rows.iter().map(Vec::as_slice).collect()
    }
}

/// Headings, kinds and rows.
type Parts = (Vec<String>, Vec<Kind>, Vec<Vec<String>>);

/// A column in which every cell that is not empty is a number holds numbers.
fn of_csv(text: &str) -> Result<Parts, csv::Error> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let cells = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect::<Vec<_>>();
    let headings = cells(reader.headers()?);
    let rows: Vec<Vec<String>> = reader.records().map(|row| row.map(|row| cells(&row))).collect::<Result<_, _>>()?;
    let kind = |index: usize| {
        let mut cells = rows.iter().map(|row| &row[index]).filter(|cell| !cell.is_empty());
        if cells.all(|cell| cell.parse::<f64>().is_ok()) { Kind::Number } else { Kind::Text }
    };
    let kinds = (0..headings.len()).map(kind).collect();
    Ok((headings, kinds, rows))
}

/// What the library reads, which takes files to be whole and panics on some that are damaged. Nobody is told of that but by the error.
fn unless_damaged<T>(read: impl FnOnce() -> Result<T, ParquetError>) -> Result<T, ParquetError> {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _turn = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let told = panic::take_hook();
    panic::set_hook(Box::new(|_| ()));
    let read = panic::catch_unwind(panic::AssertUnwindSafe(read));
    panic::set_hook(told);
    read.unwrap_or_else(|_| Err(ParquetError::General("the file is damaged".to_owned())))
}

fn of_parquet(bytes: Vec<u8>) -> Result<Parts, ParquetError> {
    let reader = SerializedFileReader::new(Bytes::from(bytes))?;
    let schema = reader.metadata().file_metadata().schema_descr();
    let headings = schema.columns().iter().map(|column| column.name().to_owned()).collect();
    let kind = |physical: Physical| match physical {
        Physical::BOOLEAN => Kind::Truth,
        Physical::INT32 | Physical::INT64 => Kind::Whole,
        Physical::FLOAT | Physical::DOUBLE => Kind::Number,
        Physical::INT96 | Physical::BYTE_ARRAY | Physical::FIXED_LEN_BYTE_ARRAY => Kind::Text,
    };
    let kinds: Vec<Kind> = schema.columns().iter().map(|column| kind(column.physical_type())).collect();
    if schema.root_schema().get_fields().iter().any(|field| field.is_group()) {
        return Err(ParquetError::General("its columns have columns of their own".to_owned()));
    }
    let rows = reader.get_row_iter(None)?.map(|row| {
        let row = row?;
        Ok(row.get_column_iter().map(|(_, field)| cell(field)).collect::<Vec<String>>())
    });
    Ok((headings, kinds, rows.collect::<Result<_, ParquetError>>()?))
}

/// A value as CSV has it.
fn cell(field: &Field) -> String {
    match field {
        Field::Null => String::new(),
        Field::Str(text) => text.clone(),
        Field::Double(number) => number.to_string(),
        Field::Float(number) => number.to_string(),
        other => other.to_string(),
    }
}
