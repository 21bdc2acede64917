//! What was run, whatever it was, and what came of it.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use pcs_sim::error;
use pcs_sim::geometry::Hit;
use pcs_sim::host::camera::ImageSize;
use pcs_sim::host::color_table::{ColorTable, Palette};
use pcs_sim::host::image;
use pcs_sim::machine::Capitan;
use pcs_sim::measure::{Clock, Measured, Observed, Profile};
use pcs_sim::program::Counts;
use pcs_sim::report::losses::Losses;
use pcs_sim::report::page::{self, Page};
use pcs_sim::report::plot::{self, Caption};
use pcs_sim::report::stats::Configuration;
use pcs_sim::report::{account, cube, farm};
use pcs_sim::run::{
    CubeOutcome, CubeSetup, FarmOutcome, FarmSetup, Outcome, Outputs, Rendered, Replay, Setup, Timing, Watching,
};
use pyo3::exceptions::PyAttributeError;
use pyo3::prelude::*;

use crate::doing::{Lost, render, time, trace};
use crate::outputs;
use crate::trouble::{Trouble, output};
use crate::work::Task;

/// What was run, and what came of it.
#[derive(Debug)]
pub enum Made {
    /// Primary rays.
    Rays { setup: Setup, outcome: Box<Outcome>, losses: Lost },
    /// A whole image, with the hits in the order in which the rays were sent.
    Image { setup: Setup, rendered: Box<Rendered>, losses: Lost, hits: Vec<Hit> },
    /// A recorded trace.
    Replay { replay: Mutex<Replay>, stats: Measured, losses: Lost, observed: Box<Observed> },
    /// A farm of workers.
    Farm { setup: Box<FarmSetup>, outcome: Box<FarmOutcome> },
    /// An image on a hypercube.
    Cube { setup: Box<CubeSetup>, outcome: Box<CubeOutcome> },
}

/// What a picture is written as.
#[derive(Clone, Copy, Debug)]
enum Form {
    Png,
    /// With a table of so many colours.
    Indexed(usize, Palette),
    Pfm,
}

/// What a run was, in words and as data.
#[derive(Debug)]
pub struct Described {
    /// Title and machine.
    pub caption: Caption,
    /// What each cell runs.
    pub names: Vec<String>,
    /// All that was asked for.
    pub configuration: Configuration,
}

/// What a lock guards.
pub fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a run is not asked for, as it is of another sort.
pub fn has_none(sort: &str, what: &str) -> PyErr {
    PyAttributeError::new_err(format!("{sort} has no {what}"))
}

/// What an image is that has no statistics.
pub const UNTIMED: &str = "an image without timing";

impl Made {
    fn timing(rendered: &Rendered) -> PyResult<&Timing> {
        rendered.timing.as_ref().ok_or_else(|| has_none(UNTIMED, "statistics"))
    }

    /// The statistics; an image without timing has none.
    pub fn measured(&self) -> PyResult<&Measured> {
        match self {
            Made::Rays { outcome, .. } => Ok(&outcome.stats),
            Made::Image { rendered, .. } => Ok(&Made::timing(rendered)?.stats),
            Made::Replay { stats, .. } => Ok(stats),
            Made::Farm { outcome, .. } => Ok(&outcome.stats),
            Made::Cube { outcome, .. } => Ok(&outcome.stats),
        }
    }

    /// What was seen of the run beside its measures.
    pub fn observed(&self) -> Option<&Observed> {
        match self {
            Made::Rays { outcome, .. } => Some(&outcome.observed),
            Made::Image { rendered, .. } => rendered.timing.as_ref().map(|timing| &timing.observed),
            Made::Replay { observed, .. } => Some(observed),
            Made::Farm { outcome, .. } => Some(&outcome.observed),
            Made::Cube { .. } => None,
        }
    }

    /// What ran, and how fast.
    pub fn head(&self) -> PyResult<String> {
        match self {
            Made::Rays { setup, outcome, .. } => Ok(account::head(setup, outcome)),
            Made::Replay { replay, stats, .. } => Ok(account::replay_head(&locked(replay), stats)),
            Made::Image { .. } => Err(has_none("an image", "head of its own")),
            Made::Farm { .. } => Err(has_none("a farm", "head of its own")),
            Made::Cube { .. } => Err(has_none("an image on a hypercube", "head of its own")),
        }
    }

    /// What a run of rays is made of; the others have none, and no `what`.
    pub fn setup(&self, what: &str) -> PyResult<&Setup> {
        match self {
            Made::Rays { setup, .. } | Made::Image { setup, .. } => Ok(setup),
            Made::Replay { .. } => Err(has_none("a replay", what)),
            Made::Farm { .. } => Err(has_none("a farm", what)),
            Made::Cube { .. } => Err(has_none("an image on a hypercube", what)),
        }
    }

    /// The clock of the machine.
    pub fn clock(&self) -> Clock {
        match self {
            Made::Rays { setup, .. } | Made::Image { setup, .. } => setup.machine.spec.clock(),
            Made::Replay { replay, .. } => locked(replay).machine.spec.clock(),
            Made::Farm { .. } => Capitan::CLOCK,
            Made::Cube { setup, .. } => setup.machine.clock,
        }
    }

    /// The hits of the rays, in the order of their numbers; of an image, in the order in which they were sent.
    pub fn found(&self) -> PyResult<(&Setup, Vec<Hit>)> {
        match self {
            Made::Rays { setup, outcome, .. } => Ok((setup, setup.by_number(&outcome.hits))),
            Made::Image { setup, rendered, hits, .. } => Made::timing(rendered).map(|_| (setup, hits.clone())),
            Made::Replay { .. } | Made::Farm { .. } | Made::Cube { .. } => {
                self.setup("hits").map(|setup| (setup, Vec::new()))
            }
        }
    }

    /// How often the kernels did their work.
    pub fn tallied(&self) -> PyResult<&Counts> {
        match self {
            Made::Rays { outcome, .. } => Ok(&outcome.counts),
            Made::Image { rendered, .. } => Ok(&rendered.counts),
            Made::Replay { .. } => Err(has_none("a replay", "counts")),
            Made::Farm { .. } => Err(has_none("a farm", "counts of its own")),
            Made::Cube { .. } => Err(has_none("an image on a hypercube", "counts of its own")),
        }
    }

    /// The statistics as the command writes them.
    pub fn json(&self) -> PyResult<String> {
        let json = match self {
            Made::Rays { setup, outcome, losses } => account::stats_json(setup, outcome, losses.as_ref()),
            Made::Image { setup, rendered, losses, .. } => {
                account::image_stats_json(setup, rendered, Made::timing(rendered)?, losses.as_ref())
            }
            Made::Replay { replay, stats, losses, observed } => {
                account::replay_stats_json(&locked(replay), (stats, observed.path.as_ref()), losses.as_ref())
            }
            Made::Farm { setup, outcome } => farm::to_json(outcome, &setup.scene, &self.described().configuration),
            Made::Cube { setup, outcome } => cube::to_json(setup, outcome, &self.described().configuration),
        };
        json.map_err(|error| PyAttributeError::new_err(error.to_string()))
    }

    /// What was run, as JSON.
    pub fn configuration(&self) -> serde_json::Result<serde_json::Value> {
        match self {
            Made::Rays { setup, .. } | Made::Image { setup, .. } => serde_json::to_value(&setup.spec),
            Made::Replay { replay, .. } => serde_json::to_value(&locked(replay).spec),
            Made::Farm { setup, .. } => serde_json::to_value(&setup.spec),
            Made::Cube { setup, .. } => serde_json::to_value(&setup.spec),
        }
    }

    /// What it was, in words and as data.
    pub fn described(&self) -> Described {
        let (title, setup, names, configuration) = match self {
            Made::Rays { setup, .. } => {
                (account::title(setup), setup, account::cell_names(&setup.workload), Configuration::new(setup))
            }
            Made::Image { setup, rendered, .. } => (
                account::image_title(setup, rendered),
                setup,
                account::cell_names(&setup.workload),
                Configuration::new(setup),
            ),
            Made::Farm { setup, outcome } => {
                let configuration = Configuration::Farm(Box::new(setup.spec.clone()));
                return Described { caption: farm::caption(setup, outcome), names: Vec::new(), configuration };
            }
            Made::Cube { setup, .. } => {
                let configuration = Configuration::Cube(Box::new(setup.spec.clone()));
                return Described { caption: cube::caption(setup), names: Vec::new(), configuration };
            }
            Made::Replay { replay, .. } => {
                let replay = locked(replay);
                return Described {
                    caption: account::replay_caption(&replay),
                    names: Vec::new(),
                    configuration: Configuration::Replay(Box::new(replay.spec.clone())),
                };
            }
        };
        Described { caption: account::caption(title, setup), names, configuration }
    }

    /// Runs it once more, watched.
    pub fn again(&self, watching: &Watching, task: &Task) -> Result<Observed, Trouble> {
        match self {
            Made::Rays { setup, .. } => Ok(trace(setup, watching, None, task)?.0.observed),
            Made::Image { setup, .. } => {
                Ok(render(setup, watching, None, task)?.0.timing.map(|timing| timing.observed).unwrap_or_default())
            }
            Made::Replay { replay, .. } => Ok(time(&mut locked(replay), watching, task)?.2),
            Made::Farm { setup, .. } => Ok(setup.run(setup.spec.tasks, watching, &task.workers.cancel)?.observed),
            Made::Cube { setup, .. } => Ok(setup.run(watching, &task.workers.cancel)?.observed),
        }
    }

    /// What the user should know: what had to be rounded, cut or assumed.
    pub fn notes(&self) -> Vec<String> {
        match self {
            Made::Rays { setup, .. } | Made::Image { setup, .. } => setup.notes().map(str::to_owned).collect(),
            Made::Replay { replay, .. } => locked(replay).machine.notes.clone(),
            Made::Farm { setup, .. } => setup.notes().map(str::to_owned).collect(),
            Made::Cube { setup, .. } => setup.notes().map(str::to_owned).collect(),
        }
    }

    /// The name of the picture that shows it best: what each cell, or task, did when.
    pub fn first_picture(&self) -> &'static str {
        match self {
            Made::Farm { .. } => "tasks",
            Made::Cube { .. } => "nodes",
            _ => "cells",
        }
    }

    /// What people read of it.
    pub fn text(&self) -> String {
        match self {
            Made::Rays { setup, outcome, losses } => account::text(setup, outcome, losses.as_ref()),
            Made::Image { setup, rendered, losses, .. } => account::image_text(setup, rendered, losses.as_ref()),
            Made::Replay { replay, stats, losses, observed } => {
                account::replay_text(&locked(replay), (stats, observed.path.as_ref()), losses.as_ref())
            }
            Made::Farm { setup, outcome } => farm::text(setup, outcome),
            Made::Cube { setup, outcome } => cube::text(setup, outcome),
        }
    }

    /// The pixels, in linear light; `None` without a picture.
    pub fn pixels(&self) -> Option<Vec<f32>> {
        match self {
            Made::Rays { setup, outcome, .. } if setup.spec.rays.is_none() => {
                let pixels = setup.preview(&outcome.hits);
                Some(pixels.iter().flat_map(|pixel| pixel.to_array()).collect())
            }
            Made::Image { rendered, .. } => Some(rendered.pixels.iter().flat_map(|pixel| pixel.to_array()).collect()),
            Made::Cube { setup, .. } => Some(setup.scene.pixels.iter().flat_map(|pixel| pixel.to_array()).collect()),
            _ => None,
        }
    }

    /// Writes the picture, if there is one.
    fn write_picture(&self, file: &mut impl Write, form: Form) -> Result<(), Trouble> {
        let (size, pixels) = self.picture()?;
        match form {
            Form::Pfm => image::write_pfm(file, size, &pixels).map_err(output),
            Form::Png => image::write_png(file, size, &pixels).map_err(output),
            Form::Indexed(most, palette) => {
                let table = ColorTable::new(&image::on_screen(&pixels), most, palette);
                image::write_indexed_png(file, size, &table).map_err(output)
            }
        }
    }

    /// The picture, if there is one.
    pub fn picture(&self) -> Result<(ImageSize, image::Pixels), Trouble> {
        Ok(match self {
            Made::Rays { setup, outcome, .. } if setup.spec.rays.is_none() => {
                (setup.spec.size, setup.preview(&outcome.hits))
            }
            Made::Image { setup, rendered, .. } => (setup.spec.size, rendered.pixels.clone()),
            Made::Cube { setup, .. } => (setup.spec.size, setup.scene.pixels.clone()),
            _ => return Err(error::InputError::new("the rays are none of a picture").into()),
        })
    }

    /// The same as PNG for a page.
    fn png(&self) -> Result<Option<Vec<u8>>, Trouble> {
        let mut png = Vec::new();
        match self.pixels() {
            Some(_) => self.write_picture(&mut png, Form::Png).map(|()| Some(png)),
            None => Ok(None),
        }
    }

    fn losses(&self) -> Option<&Losses> {
        match self {
            Made::Rays { losses, .. } | Made::Image { losses, .. } | Made::Replay { losses, .. } => losses.as_ref(),
            Made::Farm { .. } | Made::Cube { .. } => None,
        }
    }

    /// The page.
    pub fn html(&self, stats: &Measured, seen: &Observed) -> Result<String, Trouble> {
        let Described { caption, names, configuration } = &self.described();
        let (clock, image) = (self.clock(), self.png()?);
        let losses = self.losses();
        page::html(&Page {
            caption,
            clock,
            stats,
            losses,
            profile: profile_of(seen)?,
            recording: seen.recording.as_ref(),
            path: self.observed().and_then(|observed| observed.path.as_ref()),
            cell_names: names,
            configuration,
            image: image.as_deref(),
            setup: match self {
                Made::Rays { setup, .. } | Made::Image { setup, .. } => Some(setup),
                _ => None,
            },
        })
        .map_err(output)
    }

    /// The pictures.
    pub fn drawn(&self, seen: &Observed) -> Result<Vec<plot::Picture>, Trouble> {
        let Described { caption, names, .. } = &self.described();
        let (profile, recording) = (profile_of(seen)?, seen.recording.as_ref());
        let path = self.observed().and_then(|observed| observed.path.as_ref());
        let regions = match self {
            Made::Cube { setup, outcome } => cube::region_map(setup, outcome),
            _ => None,
        };
        let run = plot::Run { caption, clock: self.clock(), profile, recording, path, cell_names: names, regions };
        plot::pictures(&run).map_err(output)
    }

    /// Writes the picture under a name that says as what.
    pub fn save_picture(&self, path: &Path, colors: Option<(usize, Palette)>, force: bool) -> Result<PathBuf, Trouble> {
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        let form = match (extension.as_deref(), self, colors) {
            (Some("pfm"), Made::Image { .. }, None) => Form::Pfm,
            (Some("png"), _, None) => Form::Png,
            (Some("png"), _, Some((most, palette))) => Form::Indexed(most, palette),
            (Some("pfm"), Made::Image { .. }, Some(_)) => {
                let error = error::InputError::new("colors makes a table of colours, and PFM has none");
                return Err(error.help("leave it out, or write a PNG").into());
            }
            _ => {
                let error = error::InputError::in_file(path, "is no name of an image");
                return Err(error.help("images end in .png or .pfm").into());
            }
        };
        let mut file = outputs::open(path, force)?;
        self.write_picture(&mut file, form)?;
        outputs::finish(file)
    }
}

/// What was seen of a run over time.
pub fn profile_of(seen: &Observed) -> Result<&Profile, Trouble> {
    seen.profile.as_ref().ok_or_else(|| output("the run was not seen over time"))
}

/// Writes pictures into a folder.
pub fn save_plots(folder: &Path, force: bool, pictures: Vec<plot::Picture>) -> Result<Vec<PathBuf>, Trouble> {
    let unfit =
        |error: std::io::Error| error::InputError::in_file(folder, format!("cannot be written: {}", error.kind()));
    let prepared = Outputs::default().folder(folder).map_err(unfit)?;
    let mut written = Vec::new();
    for picture in pictures {
        for (ending, bytes) in [("svg", picture.rendered.svg.as_bytes()), ("png", &picture.rendered.png)] {
            let path = prepared.path().join(format!("{}.{ending}", picture.name));
            written.push(outputs::write(&path, force, |file| file.write_all(bytes))?);
        }
    }
    Ok(written)
}
