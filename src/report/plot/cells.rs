//! What the cells do over time.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Caption;
use super::chart::{self, TimeScale, rgb};
use super::render::{Drawn, Figure};
use crate::machine::{CellState, CellStats, Cycles};
use crate::report::palette::{self, Rgb};

/// Each cell's states over time, as stacked bands.
pub struct States<'a> {
    pub caption: &'a Caption,
    pub scale: TimeScale,
    pub cells: &'a [Vec<CellStats>],
    /// What each cell runs, as far as that is known.
    pub names: &'a [String],
}

impl Figure for States<'_> {
    fn size(&self) -> (u32, u32) {
        chart::size(self.cells.len())
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let states = occurring(self.cells.iter());
        let panels = chart::panels(area, self.caption, WHAT, &legend(&states), self.cells.len())?;
        for (index, panel) in panels.iter().enumerate().take(self.cells.len()) {
            self.draw_cell(index, &states, panel)?;
        }
        Ok(())
    }
}

impl States<'_> {
    fn draw_cell<DB: DrawingBackend>(
        &self,
        index: usize,
        states: &[CellState],
        panel: &DrawingArea<DB, Shift>,
    ) -> Drawn<DB> {
        let name = self.names.get(index).map_or(format!("cell {index}"), |name| format!("cell {index}: {name}"));
        let is_last = index + 1 == self.cells.len();
        let mut chart = chart::builder(panel, &name, is_last).build_cartesian_2d(0.0..self.scale.end(), 0.0..100.0)?;
        for (state, edge) in bands(&self.cells[index], states, self.scale, chart::grain(100.0)) {
            chart.draw_series(AreaSeries::new(edge, 0.0, rgb(palette::of_state(state))))?;
        }
        let across = self.scale.label();
        chart::axes(&mut chart, (is_last.then_some(&across), "% of time"), 3, &chart::number)
    }
}

/// What the picture is called.
pub const WHAT: &str = "What the cells do over time";

/// The states that occur in some cell.
pub fn occurring<'a>(cells: impl Iterator<Item = &'a Vec<CellStats>> + Clone) -> Vec<CellState> {
    let occurs = |state: &CellState| cells.clone().flatten().any(|bin| bin.of(*state) > Cycles(0));
    CellState::ALL.into_iter().filter(occurs).collect()
}

/// Their names and colours.
pub fn legend(states: &[CellState]) -> Vec<(&'static str, Rgb)> {
    states.iter().map(|&state| (state.name(), palette::of_state(state))).collect()
}

/// For each state the upper edge of its band, in percent, from the highest band down: each is drawn over the one before it.
pub fn bands(
    bins: &[CellStats],
    states: &[CellState],
    scale: TimeScale,
    grain: f64,
) -> impl Iterator<Item = (CellState, Vec<(f64, f64)>)> {
    let mut sums = vec![0; bins.len()];
    let mut bands: Vec<_> = states
        .iter()
        .map(|&state| {
            sums.iter_mut().zip(bins).for_each(|(sum, bin)| *sum += bin.of(state).0);
            let share = |(at, &sum): (usize, &u64)| 100.0 * sum as f64 / scale.cycles_of(at) as f64;
            (state, scale.steps(sums.iter().enumerate().map(share), grain))
        })
        .collect();
    bands.reverse();
    bands.into_iter()
}
