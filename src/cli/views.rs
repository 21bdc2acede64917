//! What shows a run over time: plots, a page, traces for viewers.

use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use pcs_sim::error::InputError;
use pcs_sim::machine::Observed;
use pcs_sim::measure::{Clock, Measured};
use pcs_sim::quantities::Cycles;
use pcs_sim::report::losses::Losses;
use pcs_sim::report::page::{self, Page};
use pcs_sim::report::plot::{self, Caption};
use pcs_sim::report::stats::Configuration;
use pcs_sim::report::trace::{Format, Trace};
use pcs_sim::run::{OutputFile, OutputFolder, Watching};

use super::args::ViewArgs;
use super::{Failure, outputs};

/// The views that are asked for, their places found fit before the run.
pub struct Views {
    plot: Option<OutputFolder>,
    page: Option<OutputFile>,
    trace: Option<(OutputFile, Format)>,
    window: Range<Cycles>,
    why: bool,
    enough: bool,
    force: bool,
}

/// A run that is over, for its views.
pub struct Seen<'a> {
    /// What ran.
    pub caption: &'a Caption,
    pub clock: Clock,
    pub stats: &'a Measured,
    /// What is lost against the busiest cell's work, if that is worth a word.
    pub losses: Option<&'a Losses>,
    /// What was seen of the array.
    pub observed: &'a Observed,
    /// What each cell runs, as far as that is known.
    pub cell_names: &'a [String],
    /// All parameters, if they are known.
    pub configuration: &'a Configuration,
    /// The picture that was traced, as PNG, if there is one.
    pub image: Option<&'a [u8]>,
}

impl Views {
    /// Opens the files, and makes the folder.
    pub fn open(args: &ViewArgs, force: bool) -> Result<Views, InputError> {
        let trace = |path: &PathBuf| {
            let format = Format::of(path)?;
            Ok((outputs::create(path, force)?, format))
        };
        Ok(Views {
            plot: args.plot.as_ref().map(|folder| prepare_folder(folder, force)).transpose()?,
            page: outputs::open(args.page.as_deref(), force)?,
            trace: args.trace.as_ref().map(trace).transpose()?,
            window: args.trace_window.clone().unwrap_or(Cycles(0)..Cycles(u64::MAX)),
            why: args.why,
            enough: args.enough,
            force,
        })
    }

    /// No views.
    pub fn none() -> Views {
        Views {
            plot: None,
            page: None,
            trace: None,
            why: false,
            enough: false,
            window: Cycles(0)..Cycles(0),
            force: false,
        }
    }

    /// What the views need to see of a machine.
    pub fn watching(&self) -> Watching {
        let profile = self.plot.is_some() || self.page.is_some();
        Watching {
            profile,
            recording: self.trace.as_ref().map(|_| self.window.clone()),
            path: self.why,
            moment: None,
            enough: self.enough,
        }
    }

    /// Whether a view shows the traced picture.
    pub fn show_image(&self) -> bool {
        self.page.is_some()
    }

    /// Writes the views of a run.
    pub fn write(self, run: &Seen<'_>, written: &mut Vec<PathBuf>) -> Result<(), Failure> {
        let &Seen { caption, clock, stats, losses, cell_names, configuration, image, .. } = run;
        let path = run.observed.path.as_ref();
        if let Some(profile) = &run.observed.profile {
            let page = Page { caption, clock, stats, losses, profile, path, cell_names, configuration, image };
            let (pictures, html) = rayon::join(
                || self.plot.as_ref().map(|_| plot::pictures(profile, path, clock, caption, cell_names)).transpose(),
                || self.page.as_ref().map(|_| page::html(&page)).transpose(),
            );
            let pictures = pictures.map_err(|error| Failure::Output(error.to_string()))?;
            if let (Some(folder), Some(pictures)) = (&self.plot, pictures) {
                write_plots(folder.path(), self.force, pictures, written)?;
            }
            let html = html.map_err(|error| Failure::Output(error.to_string()))?;
            outputs::finish(self.page, written, |file| file.write_all(html.unwrap_or_default().as_bytes()))?;
        }
        let (Some((file, format)), Some(recording)) = (self.trace, &run.observed.recording) else { return Ok(()) };
        let trace = Trace { caption, clock, cell_names, recording };
        outputs::finish(Some(file), written, |file| trace.write(format, file))?;
        trace.notes(format).iter().for_each(super::note);
        Ok(())
    }
}

fn prepare_folder(folder: &Path, force: bool) -> Result<OutputFolder, InputError> {
    let reason = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::Other => error.to_string(),
        kind => kind.to_string(),
    };
    let failed = |error| {
        let error = InputError::in_file(folder, format!("cannot be a folder for plots: {}", reason(error)));
        error.help("name a folder, or a new name for one")
    };
    let prepared = outputs::folder(folder).map_err(failed)?;
    let empty = std::fs::read_dir(folder).map_err(failed)?.next().is_none();
    if empty || force {
        return Ok(prepared);
    }
    Err(InputError::in_file(folder, "is not empty").help("name a new folder, or --force to replace the plots in it"))
}

fn write_plots(
    folder: &Path,
    force: bool,
    pictures: Vec<plot::Picture>,
    written: &mut Vec<PathBuf>,
) -> Result<(), Failure> {
    for picture in pictures {
        for (ending, bytes) in [("svg", picture.rendered.svg.as_bytes()), ("png", &picture.rendered.png)] {
            let path = folder.join(format!("{}.{ending}", picture.name));
            let file = outputs::create(&path, force)?;
            outputs::finish(Some(file), written, |file| file.write_all(bytes))?;
        }
    }
    Ok(())
}
