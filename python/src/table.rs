//! Tables, which any library that knows Arrow takes without copies.

use std::ffi::CStr;
use std::sync::Arc;

use arrow_array::ffi::FFI_ArrowSchema;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, RecordBatchIterator, StringArray,
};
use arrow_schema::{ArrowError, DataType, Field, Schema};
use numpy::PyArray1;
use pcs_sim::report::table::{self, Column, Kind};
use pyo3::exceptions::{PyKeyError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyList};

/// A table in memory, by columns.
///
/// It is given to other libraries by the Arrow PyCapsule interface, without copies: `pandas.DataFrame.from_arrow(table)`,
/// `polars.DataFrame(table)`, `pyarrow.table(table)`, and by its name in DuckDB.
#[pyclass(frozen, module = "pcs_sim")]
#[derive(Debug)]
pub struct Table {
    batch: RecordBatch,
}

/// The name and the values of a column.
pub type Filled = (String, ArrayRef);

/// A column of whole numbers.
pub fn whole(name: impl Into<String>, values: impl IntoIterator<Item = u64>) -> Filled {
    // No run has as many as 2^63 cycles or words.
    (name.into(), Arc::new(Int64Array::from_iter_values(values.into_iter().map(|value| value as i64))))
}

/// A column of numbers.
pub fn number(name: impl Into<String>, values: impl IntoIterator<Item = Option<f64>>) -> Filled {
    (name.into(), Arc::new(Float64Array::from_iter(values)))
}

/// A column of truths.
pub fn truth(name: impl Into<String>, values: Vec<bool>) -> Filled {
    (name.into(), Arc::new(BooleanArray::from(values)))
}

/// A column of words.
pub fn text(name: impl Into<String>, values: impl IntoIterator<Item = String>) -> Filled {
    (name.into(), Arc::new(StringArray::from_iter_values(values)))
}

fn failed(error: ArrowError) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}

impl Table {
    /// A table of columns of the same length.
    pub fn new(columns: Vec<Filled>) -> PyResult<Table> {
        let fields: Vec<Field> =
            columns.iter().map(|(name, values)| Field::new(name, values.data_type().clone(), true)).collect();
        let values = columns.into_iter().map(|(_, values)| values).collect();
        Ok(Table { batch: RecordBatch::try_new(Arc::new(Schema::new(fields)), values).map_err(failed)? })
    }

    /// A table as the simulator has it, whose cells are text: they become what their columns hold.
    pub fn of_cells(table: &table::Table<'_>) -> PyResult<Table> {
        let columns = table.columns.iter().enumerate();
        Table::new(columns.map(|(index, column)| (column.name.to_owned(), values(table, index, column))).collect())
    }

    fn find(&self, name: &str) -> PyResult<&ArrayRef> {
        self.batch.column_by_name(name).ok_or_else(|| PyKeyError::new_err(name.to_owned()))
    }
}

/// The cells of a column. Empty ones are null, as they are in a table's Parquet file.
fn values(table: &table::Table<'_>, index: usize, column: &Column<'_>) -> ArrayRef {
    let cells = table.column(index).map(|cell| Some(cell).filter(|cell| !cell.is_empty()));
    match column.kind {
        Kind::Text => Arc::new(StringArray::from_iter(cells)),
        Kind::Truth => Arc::new(BooleanArray::from_iter(cells.map(|cell| cell?.parse().ok()))),
        Kind::Whole => Arc::new(Int64Array::from_iter(cells.map(|cell| cell?.parse().ok()))),
        Kind::Number => Arc::new(Float64Array::from_iter(cells.map(|cell| cell?.parse().ok()))),
    }
}

const STREAM: &CStr = c"arrow_array_stream";
const SCHEMA: &CStr = c"arrow_schema";

#[pymethods]
impl Table {
    /// The table as a stream of Arrow data. The schema that is asked for may be passed over, as the interface allows.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let _ = requested_schema;
        let batches = RecordBatchIterator::new([Ok(self.batch.clone())], self.batch.schema());
        PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(batches)), STREAM)
    }

    /// What the columns hold, as an Arrow schema.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.batch.schema().as_ref()).map_err(failed)?;
        PyCapsule::new_with_value(py, schema, SCHEMA)
    }

    /// The names of the columns.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.batch.schema().fields().iter().map(|field| field.name().clone()).collect()
    }

    /// The number of rows.
    fn __len__(&self) -> usize {
        self.batch.num_rows()
    }

    /// A column: a NumPy array of numbers (NaN where a number is missing), or a list.
    fn __getitem__<'py>(&self, py: Python<'py>, column: &str) -> PyResult<Bound<'py, PyAny>> {
        let values = self.find(column)?.as_any();
        if let Some(values) = values.downcast_ref::<Int64Array>().filter(|values| values.null_count() == 0) {
            return Ok(PyArray1::from_slice(py, values.values()).into_any());
        }
        if let Some(values) = values.downcast_ref::<Int64Array>() {
            let numbers = values.iter().map(|value| value.map_or(f64::NAN, |value| value as f64));
            return Ok(PyArray1::from_iter(py, numbers).into_any());
        }
        if let Some(values) = values.downcast_ref::<Float64Array>() {
            return Ok(PyArray1::from_iter(py, values.iter().map(|value| value.unwrap_or(f64::NAN))).into_any());
        }
        self.list(py, column)
    }

    /// The columns as lists, by name, with None where there is no value.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let columns = PyDict::new(py);
        for name in self.columns() {
            let values = self.list(py, &name)?;
            columns.set_item(name, values)?;
        }
        Ok(columns)
    }

    fn __repr__(&self) -> String {
        format!("<pcs_sim.Table: {} rows of {}>", self.batch.num_rows(), self.columns().join(", "))
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        let columns = self.to_dict(py)?;
        py.import("pcs_sim._helpers")?.getattr("html_table")?.call1((columns,))?.extract()
    }
}

impl Table {
    fn list<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let values = self.find(name)?;
        let any = values.as_any();
        let list = match values.data_type() {
            DataType::Int64 => any.downcast_ref::<Int64Array>().map(|values| PyList::new(py, values.iter())),
            DataType::Float64 => any.downcast_ref::<Float64Array>().map(|values| PyList::new(py, values.iter())),
            DataType::Boolean => {
                any.downcast_ref::<BooleanArray>().map(|values| PyList::new(py, values.iter().collect::<Vec<_>>()))
            }
            _ => any.downcast_ref::<StringArray>().map(|values| PyList::new(py, values.iter())),
        };
        Ok(list.ok_or_else(|| PyKeyError::new_err(name.to_owned()))??.into_any())
    }
}
