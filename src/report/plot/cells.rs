//! What the cells do over time.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Caption;
use super::chart::{self, TimeScale, rgb};
use super::render::{Drawn, Figure};
use crate::measure::{State, StateTimes, States, Topology};
use crate::quantities::Cycles;
use crate::report::palette::{self, Rgb};

/// Each cell's states over time, as stacked bands.
pub struct Bands<'a> {
    pub caption: &'a Caption,
    pub scale: TimeScale,
    pub topology: &'a Topology,
    pub cells: &'a [Vec<StateTimes>],
    /// What each cell runs, as far as that is known.
    pub names: &'a [String],
}

impl Figure for Bands<'_> {
    fn size(&self) -> (u32, u32) {
        chart::size(self.cells.len())
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let all = &self.topology.states;
        let states = occurring(all, self.cells.iter());
        let what = what(self.topology);
        let panels = chart::panels(area, self.caption, &what, &legend(all, &states), self.cells.len())?;
        for (index, panel) in panels.iter().enumerate().take(self.cells.len()) {
            self.draw_cell(index, &states, panel)?;
        }
        Ok(())
    }
}

impl Bands<'_> {
    fn draw_cell<DB: DrawingBackend>(
        &self,
        index: usize,
        states: &[&State],
        panel: &DrawingArea<DB, Shift>,
    ) -> Drawn<DB> {
        let station = self.topology.station(index);
        let name = self.names.get(index).map_or_else(|| station.clone(), |name| format!("{station}: {name}"));
        let is_last = index + 1 == self.cells.len();
        let across = 0.0..self.scale.end();
        let mut chart = chart::builder(panel, &name, is_last, &across).build_cartesian_2d(across, 0.0..100.0)?;
        for (state, edge) in bands(&self.cells[index], states, self.scale, chart::grain(100.0)) {
            chart.draw_series(AreaSeries::new(edge, 0.0, rgb(palette::of_state(&self.topology.states, state))))?;
        }
        let across = self.scale.label();
        chart::axes(&mut chart, (is_last.then_some(&across), "% of time"), 3, &chart::number)
    }
}

/// What the picture is called.
pub fn what(topology: &Topology) -> String {
    format!("What the {}s do over time", topology.names.station)
}

/// The states that occur in some cell.
pub fn occurring<'a, 's>(
    states: &'s States,
    cells: impl Iterator<Item = &'a Vec<StateTimes>> + Clone,
) -> Vec<&'s State> {
    let occurs = |state: &&State| cells.clone().flatten().any(|bin| bin.of(state.id) > Cycles(0));
    states.all().iter().filter(occurs).collect()
}

/// Their names and colours.
pub fn legend<'s>(all: &States, states: &[&'s State]) -> Vec<(&'s str, Rgb)> {
    states.iter().map(|state| (state.name.as_str(), palette::of_state(all, state))).collect()
}

/// For each state the upper edge of its band, in percent, from the highest band down: each is drawn over the one before it.
pub fn bands<'s>(
    bins: &[StateTimes],
    states: &[&'s State],
    scale: TimeScale,
    grain: f64,
) -> impl Iterator<Item = (&'s State, Vec<(f64, f64)>)> {
    let mut sums = vec![0; bins.len()];
    let mut bands: Vec<_> = states
        .iter()
        .map(|&state| {
            sums.iter_mut().zip(bins).for_each(|(sum, bin)| *sum += bin.of(state.id).0);
            let share = |(at, &sum): (usize, &u64)| 100.0 * sum as f64 / scale.cycles_of(at) as f64;
            (state, scale.steps(sums.iter().enumerate().map(share), grain))
        })
        .collect();
    bands.reverse();
    bands.into_iter()
}
