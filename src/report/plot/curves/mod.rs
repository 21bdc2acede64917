//! Any column of a table over any other, as lines with markers.

mod choice;
mod draw;
mod series;

use super::render::{self, PlotError, Rendered};
use crate::error::InputError;
use crate::input::ron_text::suggest;
use crate::report::table::{Column, Kind, Table};

pub use choice::{Choice, Log, Look};

/// Which columns of a table are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axes {
    /// From left to right; words are set side by side.
    x: usize,
    /// From bottom to top.
    y: usize,
    /// A line for each of its values.
    by: Option<usize>,
    /// A panel for each of its values.
    facet: Option<usize>,
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
        let axes = Axes { x: find(x)?, y: find(y)?, by: by.map(find).transpose()?, facet: None };
        if !columns[axes.y].is_number() {
            let numbers: Vec<&str> = columns.iter().filter(|column| column.is_number()).map(|c| c.name).collect();
            let error = InputError::new(format!("column '{y}' holds no numbers, which y needs"));
            return Err(error.help(format!("columns with numbers are {}", numbers.join(", "))));
        }
        Ok(axes)
    }

    /// The same with a panel for each value of a column. Fails if there is no such column.
    fn faceted(self, columns: &[Column], facet: Option<&str>) -> Result<Axes, InputError> {
        Ok(Axes { facet: facet.map(|facet| find(columns, facet)).transpose()?, ..self })
    }

    /// Whether a column has a part in the plot.
    fn uses(&self, column: usize) -> bool {
        [Some(self.x), Some(self.y), self.by, self.facet].contains(&Some(column))
    }

    /// What the plot shows, as a file's name: `rays_per_second-over-cells-by-mode`.
    pub fn name(&self, columns: &[Column]) -> String {
        let part = |word: &str, column: Option<usize>| {
            column.map(|column| format!("-{word}-{}", columns[column].name)).unwrap_or_default()
        };
        let parts = part("by", self.by) + &part("facet", self.facet);
        format!("{}-over-{}{parts}", columns[self.y].name, columns[self.x].name)
    }
}

impl Column<'_> {
    fn is_number(&self) -> bool {
        matches!(self.kind, Kind::Whole | Kind::Number)
    }
}

/// Draws a table. `what_ran` tells what all of its rows have in common.
///
/// A point stands for one row, or for several that agree: none is an average over what is not shown. Rows without a value are
/// left out.
///
/// # Errors
///
/// If nothing is left, if rows that differ come to the same place, if there are more lines or panels than can be told apart,
/// and if a logarithmic axis has numbers that are not above 0.
pub fn render(table: &Table<'_>, axes: &Axes, look: &Look, what_ran: &str) -> Result<Rendered, PlotError> {
    render::bring_font()?;
    let series = series::Curves::new(table, axes, look).map_err(PlotError::new)?;
    let chart = draw::Chart::new(table.columns, (axes, look), &series, what_ran).map_err(PlotError::new)?;
    render::render_in(&chart, look.cm)
}
