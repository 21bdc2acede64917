//! Tables as Parquet, with a type for each column.

use std::io::Write;
use std::str::FromStr;
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};

use super::{Column, Kind, Table};

/// Why a table could not be written as Parquet.
#[derive(Debug, thiserror::Error)]
pub enum ParquetError {
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] parquet::errors::ParquetError),
    /// A cell is not of its column's kind.
    #[error("column {column} cannot hold '{cell}'")]
    Cell {
        /// The column's name.
        column: String,
        /// The cell.
        cell: String,
    },
}

/// Writes a table as Parquet. Cells without a value are null. The file's metadata have the version of pcs-sim, under
/// `pcs_sim.version`, and what `told` has: keys with their values.
pub fn write_parquet(out: impl Write + Send, table: &Table<'_>, told: &[(&str, &str)]) -> Result<(), ParquetError> {
    let told = told.iter().chain(&[("pcs_sim.version", env!("CARGO_PKG_VERSION"))]);
    let told = told.map(|(key, value)| KeyValue::new((*key).to_owned(), Some((*value).to_owned())));

    let fields = table.columns.iter().map(field).collect::<Result<_, _>>()?;
    let schema = Type::group_type_builder("table").with_fields(fields).build()?;
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata(Some(told.collect()))
        .set_created_by(concat!("pcs-sim version ", env!("CARGO_PKG_VERSION")).to_owned());
    let mut writer = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties.build()))?;
    let mut rows = writer.next_row_group()?;
    for index in 0..table.columns.len() {
        if let Some(mut column) = rows.next_column()? {
            write_column(&mut column, table, index)?;
            column.close()?;
        }
    }
    rows.close()?;
    writer.close()?;
    Ok(())
}

fn field(column: &Column) -> Result<TypePtr, parquet::errors::ParquetError> {
    let (physical, logical) = match column.kind {
        Kind::Text => (Physical::BYTE_ARRAY, Some(LogicalType::String)),
        Kind::Truth => (Physical::BOOLEAN, None),
        Kind::Whole => (Physical::INT64, None),
        Kind::Number => (Physical::DOUBLE, None),
    };
    let field = Type::primitive_type_builder(column.name, physical).with_repetition(Repetition::OPTIONAL);
    Ok(Arc::new(field.with_logical_type(logical).build()?))
}

fn write_column(column: &mut SerializedColumnWriter<'_>, table: &Table<'_>, index: usize) -> Result<(), ParquetError> {
    match table.columns[index].kind {
        Kind::Text => write_cells::<ByteArrayType>(column, table, index, |cell| Some(ByteArray::from(cell))),
        Kind::Truth => write_cells::<BoolType>(column, table, index, parsed),
        Kind::Whole => write_cells::<Int64Type>(column, table, index, parsed),
        Kind::Number => write_cells::<DoubleType>(column, table, index, parsed),
    }
}

fn parsed<T: FromStr>(cell: &str) -> Option<T> {
    cell.parse().ok()
}

fn write_cells<T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    table: &Table<'_>,
    index: usize,
    value: impl Fn(&str) -> Option<T::T>,
) -> Result<(), ParquetError> {
    let name = table.columns[index].name;
    let typed =
        |cell: &str| value(cell).ok_or_else(|| ParquetError::Cell { column: name.to_owned(), cell: cell.to_owned() });
    let values: Vec<T::T> = table.column(index).filter(|cell| !cell.is_empty()).map(typed).collect::<Result<_, _>>()?;
    // 1 where there is a value, 0 where there is none.
    let levels: Vec<i16> = table.column(index).map(|cell| !cell.is_empty() as i16).collect();
    column.typed::<T>().write_batch(&values, Some(&levels), None)?;
    Ok(())
}
