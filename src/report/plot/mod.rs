//! Pictures of a run over time, and of a table of runs ([`curves`]), each as SVG and as PNG.

mod cells;
mod chart;
pub mod curves;
mod fifos;
mod rays;
mod render;

use crate::machine::{MachineSpec, Profile};

pub use render::{PlotError, Rendered};

/// What ran, in words, above every picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Caption {
    /// Program, array, scene and rays.
    pub title: String,
    /// The machine.
    pub machine: String,
}

/// A picture and its name.
#[derive(Debug)]
pub struct Picture {
    /// The name of its files, without the ending.
    pub name: String,
    /// What is in them.
    pub rendered: Rendered,
}

/// Panels that a picture has at the most: what a slide shows legibly.
const MOST_PANELS: usize = 8;

/// Draws all that a profile shows: the FIFOs' levels, their histograms, the cells' states, the rays done, and how long rays
/// took. Where there are more FIFOs or cells than a picture shows, there are several.
pub fn pictures(profile: &Profile, spec: &MachineSpec, caption: &Caption) -> Result<Vec<Picture>, PlotError> {
    let scale = chart::TimeScale::new(profile, spec);
    let mut pictures = Vec::new();
    let mut add = |name: String, rendered: Rendered| pictures.push(Picture { name, rendered });
    for (name, fifos) in parts("fifos", &profile.fifos) {
        add(name, render::render(&fifos::Levels { caption, scale, fifos })?);
    }
    for (name, fifos) in parts("fifo-histograms", &profile.fifos) {
        add(name, render::render(&fifos::Histograms { caption, fifos, cycles: profile.cycles })?);
    }
    let cells: Vec<_> = profile.cells.iter().enumerate().collect();
    for (name, cells) in parts("cells", &cells) {
        add(name, render::render(&cells::States { caption, scale, cells })?);
    }
    add("rays".to_owned(), render::render(&rays::Rays { caption, scale, rays: &profile.rays })?);
    add("latency".to_owned(), render::render(&rays::Latencies { caption, spec, latency: &profile.latency })?);
    Ok(pictures)
}

/// Cuts the panels into pictures: `fifos`, or `fifos-1`, `fifos-2`, ...
fn parts<'a, T>(name: &'a str, panels: &'a [T]) -> impl Iterator<Item = (String, &'a [T])> {
    let several = panels.len() > MOST_PANELS;
    panels.chunks(MOST_PANELS).enumerate().map(move |(index, part)| {
        let name = if several { format!("{name}-{}", index + 1) } else { name.to_owned() };
        (name, part)
    })
}
