//! What shows a run over time: plots, a page, traces for viewers.

use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

use pcs_sim::error::InputError;
use pcs_sim::machine::Observed;
use pcs_sim::measure::{Clock, Measured, Shape};
use pcs_sim::quantities::Cycles;
use pcs_sim::report::losses::Losses;
use pcs_sim::report::page::{self, Page};
use pcs_sim::report::plot::{self, Caption};
use pcs_sim::report::stats::Configuration;
use pcs_sim::report::trace::{Format, Trace};
use pcs_sim::run::{OutputFile, OutputFolder, Setup, Watching};

use super::args::ViewArgs;
use super::plot::Files;
use super::{Failure, outputs};

/// The views that are asked for, their places found fit before the run.
pub struct Views {
    plot: Option<OutputFolder>,
    formats: Vec<plot::Format>,
    page: Option<OutputFile>,
    trace: Option<(OutputFile, Format)>,
    /// How GTKWave is to show the trace.
    save: Option<OutputFile>,
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
    /// The regions of nodes, if they have any.
    pub regions: Option<plot::RegionMap<'a>>,
    /// What it was made of, if there is a scene.
    pub setup: Option<&'a Setup>,
}

impl Views {
    /// Opens the files, and makes the folder.
    pub fn open(args: &ViewArgs, force: bool) -> Result<Views, InputError> {
        if args.trace_window.is_some() && args.trace.is_none() && args.page.is_none() && args.plot.is_none() {
            let error =
                InputError::new("--trace-window is about --trace, --page and --plot, and none of them is given");
            return Err(error.help("name a file for one: --page run.html"));
        }
        let trace = |path: &PathBuf| {
            let format = Format::of(path)?;
            Ok((outputs::create(path, force)?, format))
        };
        let save = |path: &PathBuf| {
            let save = Trace::save_path(Format::of(path)?, path);
            outputs::open(save.as_deref(), force)
        };
        Ok(Views {
            save: args.trace.as_ref().map(save).transpose()?.flatten(),
            plot: args.plot.as_ref().map(|folder| prepare_folder(folder, force)).transpose()?,
            formats: args.formats.plot_format.clone(),
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
            formats: Vec::new(),
            page: None,
            trace: None,
            save: None,
            why: false,
            enough: false,
            window: Cycles(0)..Cycles(0),
            force: false,
        }
    }

    /// What the views need to see of a machine. Pages and plots show the cells of a line cycle by cycle.
    pub fn watching(&self, shape: Shape) -> Watching {
        let profile = self.plot.is_some() || self.page.is_some();
        let recorded = self.trace.is_some() || (profile && shape == Shape::Line);
        Watching {
            profile,
            recording: recorded.then(|| self.window.clone()),
            path: self.why,
            moment: None,
            enough: self.enough,
            spans: false,
        }
    }

    /// Whether a view shows the traced picture.
    pub fn show_image(&self) -> bool {
        self.page.is_some()
    }

    /// Writes the views of a run.
    pub fn write(self, run: &Seen<'_>, written: &mut Vec<PathBuf>) -> Result<(), Failure> {
        let &Seen { caption, clock, stats, losses, cell_names, configuration, image, regions, setup, .. } = run;
        let (path, recording) = (run.observed.path.as_ref(), run.observed.recording.as_ref());
        if let Some(profile) = &run.observed.profile {
            let page = Page {
                caption,
                clock,
                stats,
                losses,
                profile,
                recording,
                path,
                cell_names,
                configuration,
                image,
                setup,
            };
            let drawn = plot::Run { caption, clock, profile, recording, path, cell_names, regions };
            let (pictures, html) = rayon::join(
                || self.plot.as_ref().map(|_| plot::pictures(&drawn)).transpose(),
                || self.page.as_ref().map(|_| page::html(&page)).transpose(),
            );
            let pictures = pictures.map_err(|error| Failure::Output(error.to_string()))?;
            if let (Some(folder), Some(pictures)) = (&self.plot, pictures) {
                write_plots(folder.path(), (&self.formats, self.force), pictures, written)?;
            }
            let html = html.map_err(|error| Failure::Output(error.to_string()))?;
            outputs::finish(self.page, written, |file| file.write_all(html.unwrap_or_default().as_bytes()))?;
        }
        let (Some((file, format)), Some(recording)) = (self.trace, &run.observed.recording) else { return Ok(()) };
        let trace = Trace { caption, clock, cell_names, recording };
        let dump = file.path().to_owned();
        outputs::finish(Some(file), written, |file| trace.write(format, file))?;
        outputs::finish(self.save, written, |file| file.write_all(trace.save_file(&dump).as_bytes()))?;
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
    (formats, force): (&[plot::Format], bool),
    pictures: Vec<plot::Picture>,
    written: &mut Vec<PathBuf>,
) -> Result<(), Failure> {
    for picture in pictures {
        Files::open(&folder.join(&picture.name), formats, force)?.write(&picture.rendered, written)?;
    }
    Ok(())
}
