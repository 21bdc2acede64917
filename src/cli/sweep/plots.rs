//! The plots of a sweep's table.

use std::path::{Path, PathBuf};

use pcs_sim::error::InputError;
use pcs_sim::report::plot::curves::{self, Choice};
use pcs_sim::report::table::{Column, Table};
use pcs_sim::sweep;

use super::super::Failure;
use super::super::args::SweepArgs;
use super::super::plot::Files;

/// The plots that are asked for, their places found fit before the points are run.
pub struct Plots {
    plots: Vec<(Choice, Files)>,
}

impl Plots {
    /// Finds the columns, and opens the files.
    pub fn open(args: &SweepArgs, table: &Path, columns: &[Column]) -> Result<Plots, InputError> {
        let asked: Vec<Choice> =
            split(&args.plot).map(|words| Choice::new(words, columns)).collect::<Result<_, InputError>>()?;
        let stem = table.file_stem().unwrap_or_default().to_string_lossy();
        let open = |choice: Choice| {
            let name = table.with_file_name(format!("{stem}-{}", choice.name(columns)));
            let files = Files::open(&name, &args.formats.plot_format, args.force)?;
            Ok((choice, files))
        };
        Ok(Plots { plots: asked.into_iter().map(open).collect::<Result<_, InputError>>()? })
    }

    /// Draws them, and tells of each that cannot be drawn why.
    pub fn write(self, table: &Table<'_>, written: &mut Vec<PathBuf>) -> Result<Vec<String>, Failure> {
        let mut undrawn = Vec::new();
        for (choice, files) in self.plots {
            let drawn = choice.of(table);
            match curves::render(&drawn, &choice.axes, &choice.look, &sweep::what_ran(&drawn)) {
                Ok(rendered) => files.write(&rendered, written)?,
                Err(error) => undrawn.push(format!("{}: {error}", choice.name(table.columns))),
            }
        }
        Ok(undrawn)
    }
}

/// The words of each plot, which begin with an `x=`.
fn split(words: &[String]) -> impl Iterator<Item = &[String]> {
    words.chunk_by(|_, next| !next.starts_with("x="))
}
