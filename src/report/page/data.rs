//! The figures that a page's script draws.

use serde::Serialize;

use super::Page;
use crate::machine::{CellState, CellStats, Cycles, FifoProfile, FifoStats, Work};
use crate::report::palette;
use crate::report::time_unit::TimeUnit;

#[derive(Serialize)]
pub struct Data<'a> {
    unit: &'static str,
    /// Where the bins start, in that unit.
    times: Vec<f64>,
    end: f64,
    states: Vec<State>,
    cells: Vec<Cell<'a>>,
    fifos: Vec<Fifo<'a>>,
    /// Rays done in each bin, per unit of time.
    rays: Vec<f64>,
    colors: Colors,
}

#[derive(Serialize)]
struct Colors {
    level: String,
    range: String,
    full: String,
    rays: String,
}

#[derive(Serialize)]
struct State {
    name: &'static str,
    color: String,
}

#[derive(Serialize)]
struct Cell<'a> {
    name: &'a str,
    /// Share of the run in which it computes or moves words.
    works: f64,
    /// For each state, its share of each bin in percent.
    states: Vec<Vec<f64>>,
}

#[derive(Serialize)]
struct Fifo<'a> {
    name: &'a str,
    capacity: u64,
    most: u64,
    /// Over the whole run.
    average: f64,
    full_share: f64,
    min: Vec<u64>,
    mean: Vec<f64>,
    max: Vec<u64>,
    /// Share of each bin in which it is full, in percent.
    full: Vec<f64>,
}

impl<'a> Data<'a> {
    pub fn new(page: &Page<'a>) -> Data<'a> {
        let Page { spec, stats, profile, .. } = *page;
        let unit = TimeUnit::of(spec.seconds(profile.cycles));
        let cycle = spec.seconds(Cycles(1)) / unit.seconds;
        let lengths: Vec<u64> = (0..profile.rays.len() as u64)
            .map(|bin| profile.bin.0.min(profile.cycles.0 - bin * profile.bin.0))
            .collect();
        let occurs = |state: &CellState| stats.cells.iter().any(|cell| cell.of(*state) > Cycles(0));
        let states: Vec<CellState> = CellState::ALL.into_iter().filter(occurs).collect();
        let cells = profile.cells.iter().zip(&stats.cells).enumerate().map(|(index, (bins, whole))| Cell {
            name: page.cell_names.get(index).map_or("", String::as_str),
            works: share(working(whole), profile.cycles.0),
            states: states.iter().map(|&state| shares(bins, &lengths, |bin| bin.of(state))).collect(),
        });
        let rate = |(&rays, &cycles): (&u64, &u64)| rounded(rays as f64 / (cycles as f64 * cycle));
        Data {
            unit: unit.name,
            times: (0..lengths.len() as u64).map(|bin| (bin * profile.bin.0) as f64 * cycle).collect(),
            end: profile.cycles.0 as f64 * cycle,
            states: states.iter().map(|&s| State { name: s.name(), color: palette::of_state(s).to_string() }).collect(),
            cells: cells.collect(),
            fifos: profile
                .fifos
                .iter()
                .zip(&stats.fifos)
                .map(|(f, whole)| Fifo::new(f, whole, page, &lengths))
                .collect(),
            rays: profile.rays.iter().zip(&lengths).map(rate).collect(),
            colors: Colors {
                level: palette::AMOUNT.to_string(),
                range: palette::RANGE.to_string(),
                full: palette::FULL.to_string(),
                rays: palette::AMOUNT.to_string(),
            },
        }
    }
}

impl<'a> Fifo<'a> {
    fn new(fifo: &'a FifoProfile, whole: &FifoStats, page: &Page<'a>, lengths: &[u64]) -> Fifo<'a> {
        let mean = |(word_cycles, &cycles): (u64, &u64)| rounded(word_cycles as f64 / cycles as f64);
        Fifo {
            name: &fifo.name,
            capacity: fifo.capacity.0,
            most: whole.max.0,
            average: whole.mean(page.stats.cycles),
            full_share: share(whole.full, page.stats.cycles.0),
            min: fifo.bins.iter().map(|bin| bin.min.0).collect(),
            mean: fifo.bins.iter().map(|bin| bin.word_cycles).zip(lengths).map(mean).collect(),
            max: fifo.bins.iter().map(|bin| bin.max.0).collect(),
            full: shares(&fifo.bins, lengths, |bin| bin.full),
        }
    }
}

fn working(cell: &CellStats) -> Cycles {
    Work::ALL.into_iter().map(|work| cell.busy.of(work)).sum::<Cycles>() + cell.moving
}

fn shares<B>(bins: &[B], lengths: &[u64], part: impl Fn(&B) -> Cycles) -> Vec<f64> {
    bins.iter().zip(lengths).map(|(bin, &cycles)| rounded(share(part(bin), cycles))).collect()
}

/// In percent.
fn share(part: Cycles, cycles: u64) -> f64 {
    100.0 * part.0 as f64 / cycles.max(1) as f64
}

/// Four digits are more than a screen shows, and keep the page small.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
