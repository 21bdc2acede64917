//! What the cells do over time.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Caption;
use super::chart::{self, TimeScale, font, rgb};
use super::render::{Drawn, Figure};
use crate::machine::{CellState, CellStats, Cycles};
use crate::report::palette::{self, Rgb};

/// Each cell's states over time, as stacked bands.
pub struct States<'a> {
    pub caption: &'a Caption,
    pub scale: TimeScale,
    /// Each cell's number and bins.
    pub cells: &'a [(usize, &'a Vec<CellStats>)],
}

impl Figure for States<'_> {
    fn size(&self) -> (u32, u32) {
        chart::size(self.cells.len())
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let occurs = |state: &CellState| self.cells.iter().any(|(_, bins)| total(bins, *state) > Cycles(0));
        let states: Vec<CellState> = CellState::ALL.into_iter().filter(occurs).collect();
        let legend: Vec<(&str, Rgb)> = states.iter().map(|&s| (s.name(), palette::of_state(s))).collect();
        let panels = chart::panels(area, self.caption, "What the cells do over time", &legend, self.cells.len())?;
        for (index, (cell, panel)) in self.cells.iter().zip(&panels).enumerate() {
            self.draw_cell(cell, &states, panel, index + 1 == self.cells.len())?;
        }
        Ok(())
    }
}

impl States<'_> {
    fn draw_cell<DB: DrawingBackend>(
        &self,
        (number, bins): &(usize, &Vec<CellStats>),
        states: &[CellState],
        panel: &DrawingArea<DB, Shift>,
        is_last: bool,
    ) -> Drawn<DB> {
        let mut chart = chart::builder(panel, &format!("cell {number}"), is_last)
            .build_cartesian_2d(0.0..self.scale.end(), 0.0..100.0)?;
        // From the highest band down, each over the one before it.
        for (index, &state) in states.iter().enumerate().rev() {
            let up_to = |(at, bin): (usize, &CellStats)| {
                let cycles: Cycles = states[..=index].iter().map(|&state| bin.of(state)).sum();
                100.0 * cycles.0 as f64 / self.scale.cycles_of(at) as f64
            };
            let edge = self.scale.steps(bins.iter().enumerate().map(up_to));
            chart.draw_series(AreaSeries::new(edge, 0.0, rgb(palette::of_state(state))))?;
        }
        let mut mesh = chart.configure_mesh();
        mesh.x_label_formatter(&chart::number).y_label_formatter(&chart::number);
        mesh.disable_mesh().y_labels(3).y_desc("% of time").label_style(font(13)).axis_desc_style(font(13));
        mesh.x_labels(if is_last { 11 } else { 0 });
        if is_last {
            mesh.x_desc(self.scale.label());
        }
        mesh.draw()
    }
}

fn total(bins: &[CellStats], state: CellState) -> Cycles {
    bins.iter().map(|bin| bin.of(state)).sum()
}
