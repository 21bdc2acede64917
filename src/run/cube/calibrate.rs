//! A machine's times, fitted to what an image is known to have taken on it.

use std::convert::Infallible;
use std::str::FromStr;

use super::{CubeScene, CubeSpec};
use crate::error::InputError;
use crate::machine::{Cycles, Ipsc2File, MachineFile};
use crate::run::{RunError, Watching, Workers};

/// What an image is known to have taken on so many nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownTime {
    /// Nodes.
    pub nodes: u32,
    /// Seconds.
    pub seconds: f64,
}

/// What the fit goes by.
#[derive(Clone, Debug, PartialEq)]
pub struct Known {
    /// Seconds on one node.
    pub one_node: f64,
    /// The share of them that is geometry, in percent.
    pub geometry: f64,
    /// Seconds on several.
    pub others: Vec<KnownTime>,
}

/// What came of a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibrated {
    /// The machine.
    pub machine: Ipsc2File,
    /// How many times Figure 7's times its own are.
    pub factor: f64,
    /// For each time that is known, what the machine takes.
    pub fitted: Vec<(KnownTime, f64)>,
}

/// No look-up takes longer, in cycles.
const LONGEST_LOOKUP: u64 = 4096;

impl FromStr for KnownTime {
    type Err = &'static str;

    /// `64:119`.
    fn from_str(text: &str) -> Result<KnownTime, &'static str> {
        let wrong = "expected a number of nodes and its seconds, as in 64:119";
        let (nodes, seconds) = text.split_once(':').ok_or(wrong)?;
        let known =
            KnownTime { nodes: nodes.parse().map_err(|_| wrong)?, seconds: seconds.parse().map_err(|_| wrong)? };
        let is_possible = known.nodes >= 2 && known.seconds.is_finite() && known.seconds > 0.0;
        if is_possible { Ok(known) } else { Err("expected 2 nodes or more, and seconds above 0") }
    }
}

impl CubeSpec {
    /// The machine on which this image takes what is known, if its nodes share a memory: Figure 7's times, all as many times longer as
    /// makes geometry so large a share of one node's time; shading is the rest of that; and the look-up of a page whose largest
    /// error against the other times is smallest.
    ///
    /// # Errors
    ///
    /// If the scene cannot be read, if the times cannot be, and if it is told to stop.
    pub fn calibrate(&self, known: &Known, workers: &Workers) -> Result<Calibrated, RunError<Infallible>> {
        let scene = self.lay_out(false, workers, |_| Ok(()))?;
        let (machine, factor) = self.on_one_node(&scene, known)?;
        let spec = |lookup: u64| {
            let lookup_us = lookup as f64 * machine.clock_ns / 1e3;
            CubeSpec { machine: Ipsc2File { lookup_us, ..machine.clone() }, ..self.clone() }
        };
        let fit = |lookup: u64| {
            let times = known.others.iter().map(|time| Ok((*time, spec(lookup).seconds(time.nodes, &scene, workers)?)));
            times.collect::<Result<Vec<_>, RunError<Infallible>>>()
        };
        let mut lookup = (machine.lookup_us * 1e3 / machine.clock_ns).round() as u64;
        if !known.others.is_empty() {
            lookup = lowest(0..LONGEST_LOOKUP, |lookup| Ok::<_, RunError<Infallible>>(largest_error(&fit(lookup)?)))?;
        }
        let one = KnownTime { nodes: 1, seconds: known.one_node };
        let mut fitted = vec![(one, spec(lookup).seconds(1, &scene, workers)?)];
        fitted.extend(fit(lookup)?);
        Ok(Calibrated { machine: spec(lookup).machine, factor, fitted })
    }

    /// The machine as one node alone makes it, and how many times longer than Figure 7's its times are.
    fn on_one_node(&self, scene: &CubeScene, known: &Known) -> Result<(Ipsc2File, f64), InputError> {
        let figure7 = MachineFile::standard()?.times_us;
        let mut file = self.machine.clone();
        file.nodes = 1;
        let clock = file.clock_ns / 1e3;
        let times = &mut file.times_us;
        let all = [
            (&mut times.grid_start, figure7.grid_start),
            (&mut times.grid_voxel, figure7.grid_voxel),
            (&mut times.slabs_start, figure7.slabs_start),
            (&mut times.slabs_polygon, figure7.slabs_polygon),
            (&mut times.intersection_start, figure7.intersection_start),
            (&mut times.intersection_polygon, figure7.intersection_polygon),
        ];
        all.into_iter().for_each(|(own, of_figure)| *own = of_figure);
        times.shade_hit = 0.0;
        let machine = file.build()?;
        let rays = 0..scene.graph.rays.len() as u32;
        let geometry: Cycles = rays.map(|ray| scene.graph.time_in_one(ray, &machine.times).all()).sum();
        let shaded = scene.graph.rays.iter().filter(|ray| ray.shaded).count();
        let factor = known.geometry / 100.0 * known.one_node / machine.clock.seconds(geometry);
        let begun = machine.clock.seconds(machine.costs.pixel) * scene.graph.trees.len() as f64;
        let shading = ((1.0 - known.geometry / 100.0) * known.one_node - begun) / shaded as f64;
        if !(factor.is_finite() && factor > 0.0 && shading.is_finite() && shading >= 0.0) {
            let error =
                InputError::new("no machine takes these times: nothing is left for shading, or there is nothing to do");
            return Err(error.help("take a smaller share of geometry, or a scene with hits"));
        }
        let whole = |us: f64| (us / clock).round() * clock;
        let times = &mut file.times_us;
        for own in [
            &mut times.grid_start,
            &mut times.grid_voxel,
            &mut times.slabs_start,
            &mut times.slabs_polygon,
            &mut times.intersection_start,
            &mut times.intersection_polygon,
        ] {
            *own = whole(*own * factor);
        }
        times.shade_hit = whole(shading * 1e6);
        file.nodes = self.machine.nodes;
        Ok((file, factor))
    }

    /// What the image takes on so many nodes.
    fn seconds(&self, nodes: u32, scene: &CubeScene, workers: &Workers) -> Result<f64, RunError<Infallible>> {
        let spec = CubeSpec { machine: Ipsc2File { nodes, ..self.machine.clone() }, ..self.clone() };
        let machine = spec.machine.build()?;
        let outcome = spec.run(scene, &machine, &Watching::default(), &workers.cancel)?;
        Ok(machine.clock.seconds(outcome.stats.cycles))
    }
}

fn largest_error(fitted: &[(KnownTime, f64)]) -> f64 {
    fitted.iter().map(|(known, seconds)| (seconds / known.seconds - 1.0).abs()).fold(0.0, f64::max)
}

/// Where a function is lowest that falls, then rises.
fn lowest<E>(range: std::ops::Range<u64>, mut of: impl FnMut(u64) -> Result<f64, E>) -> Result<u64, E> {
    let (mut low, mut high) = (range.start, range.end);
    while high - low > 2 {
        let third = (high - low) / 3;
        let (left, right) = (low + third, high - third);
        if of(left)? <= of(right)? { high = right } else { low = left }
    }
    let mut best = (low, of(low)?);
    for at in low + 1..=high {
        let value = of(at)?;
        if value < best.1 {
            best = (at, value);
        }
    }
    Ok(best.0)
}
