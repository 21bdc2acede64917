//! Any column of a table over any other, as lines with markers.

mod draw;
mod series;

use super::render::{self, PlotError, Rendered};
use crate::error::InputError;
use crate::input::ron_text::suggest;
use crate::report::table::{Column, Kind, Table};

/// Which columns of a table are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes {
    /// From left to right; words are set side by side.
    x: usize,
    /// From bottom to top.
    y: usize,
    /// A line for each of its values.
    by: Option<usize>,
}

/// The number of the column with a name. Fails if there is none.
pub fn find(columns: &[Column], name: &str) -> Result<usize, InputError> {
    columns.iter().position(|column| column.name == name).ok_or_else(|| {
        let known: Vec<&str> = columns.iter().map(|column| column.name).collect();
        suggest(InputError::new(format!("the table has no column '{name}'")), name, &known, "columns")
    })
}

impl Axes {
    /// Finds the columns by their names. Fails if there are no such columns, or if `y` holds no numbers.
    pub fn new(columns: &[Column], x: &str, y: &str, by: Option<&str>) -> Result<Axes, InputError> {
        let find = |name: &str| find(columns, name);
        let axes = Axes { x: find(x)?, y: find(y)?, by: by.map(find).transpose()? };
        if !columns[axes.y].is_number() {
            let numbers: Vec<&str> = columns.iter().filter(|column| column.is_number()).map(|c| c.name).collect();
            let error = InputError::new(format!("column '{y}' holds no numbers, which y needs"));
            return Err(error.help(format!("columns with numbers are {}", numbers.join(", "))));
        }
        Ok(axes)
    }

    /// What the plot shows, as a file's name: `rays_per_second-over-cells-by-mode`.
    pub fn name(&self, columns: &[Column]) -> String {
        let by = self.by.map(|by| format!("-by-{}", columns[by].name));
        format!("{}-over-{}{}", columns[self.y].name, columns[self.x].name, by.unwrap_or_default())
    }
}

impl Column<'_> {
    fn is_number(&self) -> bool {
        matches!(self.kind, Kind::Whole | Kind::Number)
    }
}

/// Draws a table. `what_ran` tells what all of its rows have in common.
///
/// Where several rows have the same x on the same line, the line goes through their mean, and a bar spans them. Rows
/// without a value are left out. Fails if nothing is left, or if there are more lines than can be told apart.
pub fn render(table: &Table<'_>, axes: &Axes, what_ran: &str) -> Result<Rendered, PlotError> {
    render::bring_font()?;
    let series = series::Curves::new(table, axes).map_err(PlotError::new)?;
    render::render(&draw::Chart::new(table.columns, axes, &series, what_ran))
}
