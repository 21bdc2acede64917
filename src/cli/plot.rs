//! `pcs-sim plot TABLE.csv x=COLUMN y=COLUMN by=COLUMN -o NAME`: a picture of a table that is there already.

use std::io::Write;
use std::path::PathBuf;

use pcs_sim::error::InputError;
use pcs_sim::report::plot::curves::{self, Axes};
use pcs_sim::report::table::{Column, CsvTable, Table};
use pcs_sim::run::OutputFile;

use super::args::PlotArgs;
use super::{Failure, outputs, print};

/// Draws the columns.
pub fn plot(args: &PlotArgs) -> Result<(), Failure> {
    let table = CsvTable::read(&args.table)?;
    let columns = table.columns();
    let Choice { axes, only } = choose(&args.columns, &columns)?;
    let [svg, png] = [open(args, "svg")?, open(args, "png")?];
    let rows = table.rows_with(&only);
    let rendered = curves::render(&Table { columns: &columns, rows }, &axes, &args.title)
        .map_err(|error| InputError::in_file(&args.table, error.to_string()))?;
    let mut written = Vec::new();
    outputs::finish(Some(svg), &mut written, |file| file.write_all(rendered.svg.as_bytes()))?;
    outputs::finish(Some(png), &mut written, |file| file.write_all(&rendered.png))?;
    print(&outputs::list(&written))
}

/// What of the table is drawn.
struct Choice<'a> {
    axes: Axes,
    /// Numbers of columns, and the values that rows must have there.
    only: Vec<(usize, &'a str)>,
}

fn choose<'a>(words: &'a [String], columns: &[Column]) -> Result<Choice<'a>, InputError> {
    let misplaced = |word: &str| {
        let error = InputError::new(format!("expected x=COLUMN y=COLUMN, not '{word}'"));
        error.help("for example x=cells y=speed_up by=partition scene=teapot")
    };
    let [mut x, mut y, mut by] = [None, None, None];
    let mut only = Vec::new();
    for word in words {
        let (key, value) = word.split_once('=').ok_or_else(|| misplaced(word))?;
        let axis = match key {
            "x" => &mut x,
            "y" => &mut y,
            "by" => &mut by,
            _ => {
                only.push((curves::find(columns, key)?, value));
                continue;
            }
        };
        if axis.replace(value).is_some() {
            return Err(misplaced(word));
        }
    }
    let (Some(x), Some(y)) = (x, y) else { return Err(misplaced(&words.join(" "))) };
    Ok(Choice { axes: Axes::new(columns, x, y, by)?, only })
}

fn open(args: &PlotArgs, ending: &str) -> Result<OutputFile, InputError> {
    let mut name = args.output.clone().into_os_string();
    name.push(format!(".{ending}"));
    outputs::create(&PathBuf::from(name), args.force)
}
