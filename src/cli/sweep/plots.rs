//! The plots of a sweep's table.

use std::io::Write;
use std::path::{Path, PathBuf};

use pcs_sim::error::InputError;
use pcs_sim::report::plot::curves::{self, Axes};
use pcs_sim::report::table::{Column, Table};
use pcs_sim::run::OutputFile;
use pcs_sim::sweep::{Parameter, Sweep};

use super::super::args::SweepArgs;
use super::super::{Failure, outputs};

/// The plots that are asked for, their places found fit before the points are run.
pub struct Plots {
    plots: Vec<Plot>,
}

struct Plot {
    axes: Axes,
    svg: OutputFile,
    png: OutputFile,
}

impl Plots {
    /// Finds the columns, and opens the files.
    pub fn open(args: &SweepArgs, table: &Path, columns: &[Column]) -> Result<Plots, InputError> {
        let named: Vec<Axes> = split(&args.plot).map(|words| axes(words, columns)).collect::<Result<_, _>>()?;
        let file = |axes: &Axes, ending: &str| {
            let stem = table.file_stem().unwrap_or_default().to_string_lossy();
            let name = table.with_file_name(format!("{stem}-{}.{ending}", axes.name(columns)));
            outputs::create(&name, args.force)
        };
        let open = |axes: Axes| Ok(Plot { svg: file(&axes, "svg")?, png: file(&axes, "png")?, axes });
        Ok(Plots { plots: named.into_iter().map(open).collect::<Result<_, InputError>>()? })
    }

    /// Draws them.
    pub fn write(self, sweep: &Sweep, table: &Table<'_>, written: &mut Vec<PathBuf>) -> Result<(), Failure> {
        for Plot { axes, svg, png } in self.plots {
            let rendered = curves::render(table, &axes, &what_ran(sweep))
                .map_err(|error| Failure::Output(format!("{}: {error}", axes.name(table.columns))))?;
            outputs::finish(Some(svg), written, |file| file.write_all(rendered.svg.as_bytes()))?;
            outputs::finish(Some(png), written, |file| file.write_all(&rendered.png))?;
        }
        Ok(())
    }
}

/// The words of each plot, which begin with an `x=`.
fn split(words: &[String]) -> impl Iterator<Item = &[String]> {
    words.chunk_by(|_, next| !next.starts_with("x="))
}

fn axes(words: &[String], columns: &[Column]) -> Result<Axes, InputError> {
    let value = |word: &str, key: &str| word.strip_prefix(key)?.strip_prefix('=').map(str::to_owned);
    let mut given = [None, None, None];
    for word in words {
        let place = ["x", "y", "by"].iter().position(|key| value(word, key).is_some());
        let place = place.filter(|&place| given[place].is_none()).ok_or_else(|| misplaced(word))?;
        given[place] = value(word, ["x", "y", "by"][place]);
    }
    match given {
        [Some(x), Some(y), by] => Axes::new(columns, &x, &y, by.as_deref()),
        _ => Err(misplaced(&words.join(" "))),
    }
}

fn misplaced(words: &str) -> InputError {
    let error = InputError::new(format!("--plot takes x=COLUMN y=COLUMN and optionally by=COLUMN, not '{words}'"));
    error.help("for example --plot x=cells y=rays_per_second by=mode")
}

/// All parameters with their values, in a line: those that all points share first.
fn what_ran(sweep: &Sweep) -> String {
    let mut parameters: Vec<&Parameter> = sweep.parameters.iter().collect();
    parameters.sort_by_key(|parameter| parameter.values.len() > 1);
    let told = parameters.iter().map(|parameter| format!("{} {}", parameter.column.name, values(&parameter.values)));
    let told: Vec<String> = told.chain(["all else as by default".to_owned()]).collect();
    format!("sweep of {} points: {}", sweep.points(), told.join("; "))
}

fn values(values: &[String]) -> String {
    match values {
        [first, .., last] if values.len() > 4 => format!("{first} to {last}"),
        _ => values.join(", "),
    }
}
