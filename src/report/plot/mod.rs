//! Pictures of a run over time, and of a table of runs ([`curves`]), each as SVG and as PNG.

mod cells;
mod chart;
pub mod curves;
mod fifos;
mod links;
mod many;
mod owners;
mod pdf;
mod rays;
mod regions;
mod render;
mod scale;
mod space_time;

use rayon::prelude::*;

use crate::measure::{Clock, CriticalPath, FifoInfo, FifoProfile, Profile, Recording, Shape};

pub use regions::RegionMap;
pub use render::{Format, PlotError, Rendered};

/// What ran, in words, above every picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Caption {
    /// Program, array, scene and rays.
    pub title: String,
    /// How the scene is cut, if it is.
    pub partition: Option<String>,
    /// The machine.
    pub machine: String,
}

impl Caption {
    /// All that ran, in a line.
    pub fn what_ran(&self) -> String {
        let cut = self.partition.iter().map(|partition| format!(", partition {partition}"));
        [self.title.clone()].into_iter().chain(cut).collect()
    }
}

/// A run as pictures show it.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// What ran.
    pub caption: &'a Caption,
    /// The machine's clock.
    pub clock: Clock,
    /// The run over time.
    pub profile: &'a Profile,
    /// A window of it cycle by cycle, of which the rays' ways are drawn.
    pub recording: Option<&'a Recording>,
    /// The critical path, if that was asked for.
    pub path: Option<&'a CriticalPath>,
    /// What each cell runs, as far as that is known.
    pub cell_names: &'a [String],
    /// The regions of nodes, if they have any.
    pub regions: Option<RegionMap<'a>>,
}

/// A picture and its name.
#[derive(Debug)]
pub struct Picture {
    /// The name of its files, without the ending.
    pub name: String,
    /// What is in them.
    pub rendered: Rendered,
}

/// Panels that a picture has at the most: what a slide shows legibly. More cells or FIFOs become thin rows of one chart.
const MOST_PANELS: usize = 8;

/// What a FIFO is, and what it held.
type Fifo<'a> = (&'a FifoInfo, &'a FifoProfile);

/// A picture that is still to be drawn.
type Draw<'a> = Box<dyn Fn() -> Result<Rendered, PlotError> + Send + Sync + 'a>;

/// Draws all that a profile shows: the FIFOs' levels, their histograms, the cells' states, the rays done, and how long rays
/// took; the rays on their way, of a line that was recorded; and the critical path, if it is known. There are nine
/// pictures at the most (eleven with words on Z), however many cells there are. A machine without FIFOs has three; one whose nodes have
/// regions has two of their queues and three of the regions, too.
pub fn pictures(run: &Run<'_>) -> Result<Vec<Picture>, PlotError> {
    let Run { caption, clock, profile, recording, path, cell_names: names, regions } = *run;
    let scale = chart::TimeScale::new(profile.cycles, profile.bin, clock);
    let fifos: Vec<Fifo<'_>> = profile.topology.fifos.iter().zip(&profile.fifos).collect();
    let (topology, cells, cycles) = (&*profile.topology, &profile.stations, profile.cycles);
    let called = &topology.names;
    let mut pictures: Vec<(String, Draw<'_>)> = Vec::new();
    for (ending, fifos) in fifo_pictures(&fifos) {
        let fifo = called.fifo.to_lowercase();
        let (levels, histograms) = (format!("{fifo}s{ending}"), format!("{fifo}-histograms{ending}"));
        if fifos.len() <= MOST_PANELS {
            pictures.push((levels, Box::new(move || render::render(&fifos::Levels { caption, scale, called, fifos }))));
            let draw = move || render::render(&fifos::Histograms { caption, called, fifos, cycles });
            pictures.push((histograms, Box::new(draw)));
        } else {
            let words = (caption, called);
            pictures.push((levels, Box::new(move || render::render(&many::Levels::new(words, scale, fifos)))));
            let draw = move || render::render(&many::Histograms::new(words, fifos, cycles));
            pictures.push((histograms, Box::new(draw)));
        }
    }
    let draw: Draw<'_> = if cells.len() <= MOST_PANELS {
        Box::new(move || render::render(&cells::Bands { caption, scale, topology, cells, names }))
    } else {
        Box::new(move || render::render(&many::Bands::of_stations(caption, scale, topology, cells)))
    };
    pictures.push((format!("{}s", called.station), draw));
    if let Some(recording) = recording.filter(|recording| recording.topology.shape == Shape::Line) {
        let draw = move || render::render(&space_time::SpaceTime::new(caption, clock, recording));
        pictures.push(("space-time".to_owned(), Box::new(draw)));
    }
    if let Some(path) = path {
        let scale = chart::TimeScale::new(path.cycles, path.bin, clock);
        let places = path.places();
        let draw = move || render::render(&many::Bands::of_path(caption, scale, topology, &places));
        pictures.push(("critical-path".to_owned(), Box::new(draw)));
    }
    let rays = &profile.jobs;
    let draw = move || render::render(&rays::Rays { caption, scale, called, rays });
    pictures.push((format!("{}s", called.job), Box::new(draw)));
    let latency = &profile.latency;
    let draw = move || render::render(&rays::Latencies { caption, clock, called, latency });
    pictures.push(("latency".to_owned(), Box::new(draw)));
    if let Some(map) = regions {
        pictures.push(("regions".to_owned(), Box::new(move || render::render(&regions::Regions { caption, map }))));
        pictures.push(("links".to_owned(), Box::new(move || render::render(&links::Links { caption, map, profile }))));
        pictures.push(("owners".to_owned(), Box::new(move || render::render(&owners::Owners { caption, map }))));
    }
    render::bring_font()?;
    pictures.into_par_iter().map(|(name, draw)| Ok(Picture { name, rendered: draw()? })).collect()
}

/// The FIFOs of each picture: all in one, or those of each channel by themselves, if there are several.
fn fifo_pictures<'a, 'p>(fifos: &'a [Fifo<'p>]) -> Vec<(String, &'a [Fifo<'p>])> {
    if fifos.is_empty() {
        return Vec::new();
    }
    if fifos.len() <= MOST_PANELS {
        return vec![(String::new(), fifos)];
    }
    let groups = fifos.chunk_by(|a, b| a.0.group == b.0.group);
    let pictures: Vec<_> = groups.map(|fifos| (format!("-{}", fifos[0].0.group.to_lowercase()), fifos)).collect();
    if let [(_, fifos)] = pictures[..] { vec![(String::new(), fifos)] } else { pictures }
}
