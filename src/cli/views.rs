//! What shows a run over time: plots, a page, traces for viewers.

use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use pcs_sim::error::InputError;
use pcs_sim::machine::{Array, Cycles, Recording};
use pcs_sim::report::files::OutputFile;
use pcs_sim::report::page::{self, Page};
use pcs_sim::report::plot;
use pcs_sim::report::trace::{Format, Trace};

use super::args::{ViewArgs, ViewerArgs};
use super::{Failure, outputs};

/// The views that are asked for, their places found fit before the run.
pub struct Views {
    plot: Option<PathBuf>,
    page: Option<OutputFile>,
    trace: TraceFile,
    force: bool,
}

/// A trace for viewers, if one is asked for, its place found fit before the run.
pub struct TraceFile {
    file: Option<(OutputFile, Format)>,
    window: Range<Cycles>,
}

impl Views {
    /// Opens the files, and makes the folder.
    pub fn open(args: &ViewArgs, force: bool) -> Result<Views, InputError> {
        if let Some(folder) = &args.plot {
            prepare_folder(folder, force)?;
        }
        let page = outputs::open(args.page.as_deref(), force)?;
        Ok(Views { plot: args.plot.clone(), page, trace: TraceFile::open(&args.viewer, force)?, force })
    }

    /// The array, with what the views need to see.
    pub fn fit(&self, array: Array) -> Array {
        let array = self.trace.fit(array);
        if self.plot.is_some() || self.page.is_some() { array.probed() } else { array }
    }

    /// Whether a view shows the traced picture.
    pub fn show_image(&self) -> bool {
        self.page.is_some()
    }

    /// Writes the views of a run, of what its array saw.
    pub fn write(
        self,
        page: Option<Page<'_>>,
        trace: Option<Trace<'_>>,
        written: &mut Vec<PathBuf>,
    ) -> Result<(), Failure> {
        if let Some(run) = page {
            if let Some(folder) = &self.plot {
                write_plots(folder, self.force, &run, written)?;
            }
            outputs::finish(self.page, written, |file| {
                let html = page::html(&run).map_err(std::io::Error::other)?;
                file.write_all(html.as_bytes())
            })?;
        }
        self.trace.write(trace, written)
    }
}

impl TraceFile {
    /// Opens the file.
    pub fn open(args: &ViewerArgs, force: bool) -> Result<TraceFile, InputError> {
        let open = |path: &PathBuf| {
            let format = Format::of(path)?;
            Ok((OutputFile::create(path, force)?, format))
        };
        let window = args.trace_window.clone().unwrap_or(Cycles(0)..Cycles(u64::MAX));
        Ok(TraceFile { file: args.trace.as_ref().map(open).transpose()?, window })
    }

    /// The array, with what the trace needs to see.
    pub fn fit(&self, array: Array) -> Array {
        match self.file {
            Some(_) => array.recorded(self.window.clone(), Recording::MOST_EVENTS),
            None => array,
        }
    }

    /// Writes what the array recorded, if it did.
    pub fn write(self, trace: Option<Trace<'_>>, written: &mut Vec<PathBuf>) -> Result<(), Failure> {
        let (Some((file, format)), Some(trace)) = (self.file, trace) else { return Ok(()) };
        outputs::finish(Some(file), written, |file| trace.write(format, file))?;
        trace.notes(format).iter().for_each(|note| eprintln!("note: {note}"));
        Ok(())
    }
}

fn prepare_folder(folder: &Path, force: bool) -> Result<(), InputError> {
    let failed = |error: std::io::Error| InputError::in_file(folder, format!("cannot be written: {}", error.kind()));
    std::fs::create_dir_all(folder).map_err(failed)?;
    let empty = std::fs::read_dir(folder).map_err(failed)?.next().is_none();
    if empty || force {
        return Ok(());
    }
    Err(InputError::in_file(folder, "is not empty").help("name a new folder, or --force to replace the plots in it"))
}

fn write_plots(folder: &Path, force: bool, run: &Page<'_>, written: &mut Vec<PathBuf>) -> Result<(), Failure> {
    let pictures = plot::pictures(run.profile, run.spec, run.caption, run.cell_names);
    for picture in pictures.map_err(|error| Failure::Output(error.to_string()))? {
        for (ending, bytes) in [("svg", picture.rendered.svg.as_bytes()), ("png", &picture.rendered.png)] {
            let path = folder.join(format!("{}.{ending}", picture.name));
            let file = OutputFile::create(&path, force)?;
            outputs::finish(Some(file), written, |file| file.write_all(bytes))?;
        }
    }
    Ok(())
}
