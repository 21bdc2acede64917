//! What the FIFOs hold: over time, and how long how much.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Caption;
use super::chart::{self, TimeScale, font, rgb};
use super::render::{Drawn, Figure};
use crate::machine::{Cycles, FifoProfile};
use crate::report::bottleneck::percent;
use crate::report::palette;

/// Each FIFO's level over time.
pub struct Levels<'a> {
    pub caption: &'a Caption,
    pub scale: TimeScale,
    pub fifos: &'a [FifoProfile],
}

impl Figure for Levels<'_> {
    fn size(&self) -> (u32, u32) {
        chart::size(self.fifos.len())
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let legend = [
            ("mean", palette::LEVEL),
            ("lowest to highest in each interval", palette::RANGE),
            ("full at some time", palette::FULL),
        ];
        let what = "Words in the FIFOs over time";
        let panels = chart::panels(area, self.caption, what, &legend, self.fifos.len())?;
        for (index, (fifo, panel)) in self.fifos.iter().zip(&panels).enumerate() {
            self.draw_fifo(fifo, panel, index + 1 == self.fifos.len())?;
        }
        Ok(())
    }
}

impl Levels<'_> {
    fn draw_fifo<DB: DrawingBackend>(
        &self,
        fifo: &FifoProfile,
        panel: &DrawingArea<DB, Shift>,
        is_last: bool,
    ) -> Drawn<DB> {
        let highest = highest(fifo);
        let capacity = fifo.capacity.0;
        // The capacity belongs into the picture unless it would press the curve to the ground.
        let shows_capacity = 3 * highest >= capacity;
        let top = if shows_capacity { capacity } else { highest.max(1) } as f64 * 1.12;
        let name = format!("{}: at most {highest} of {capacity} words, full {} of the time", fifo.name, full(fifo));
        let mut chart = chart::builder(panel, &name, is_last).build_cartesian_2d(0.0..self.scale.end(), 0.0..top)?;
        let mut mesh = chart.configure_mesh();
        mesh.x_label_formatter(&chart::number).y_label_formatter(&chart::number);
        mesh.max_light_lines(1)
            .disable_x_mesh()
            .y_labels(4)
            .y_desc("words")
            .label_style(font(13))
            .axis_desc_style(font(13));
        mesh.x_labels(if is_last { 11 } else { 0 });
        if is_last {
            mesh.x_desc(self.scale.label());
        }
        mesh.draw()?;
        let bins = || fifo.bins.iter();
        let mut outline = self.scale.steps(bins().map(|bin| bin.max.0 as f64));
        outline.extend(self.scale.steps(bins().map(|bin| bin.min.0 as f64)).into_iter().rev());
        chart.draw_series([Polygon::new(outline, rgb(palette::RANGE).filled())])?;
        let mean = |(index, word_cycles): (usize, u64)| word_cycles as f64 / self.scale.cycles_of(index) as f64;
        let means = self.scale.steps(bins().map(|bin| bin.word_cycles).enumerate().map(mean));
        chart.draw_series(LineSeries::new(means, rgb(palette::LEVEL)))?;
        if shows_capacity {
            let line = [(0.0, capacity as f64), (self.scale.end(), capacity as f64)];
            chart.draw_series(DashedLineSeries::new(line, 6, 4, BLACK.into()))?;
        }
        let marks = fifo.bins.iter().enumerate().filter(|(_, bin)| bin.full > Cycles(0)).map(|(index, _)| {
            let (start, end) = self.scale.bin(index);
            Rectangle::new([(start, top * 0.95), (end, top)], rgb(palette::FULL).filled())
        });
        chart.draw_series(marks)?;
        Ok(())
    }
}

fn highest(fifo: &FifoProfile) -> u64 {
    fifo.bins.iter().map(|bin| bin.max.0).max().unwrap_or(0)
}

fn full(fifo: &FifoProfile) -> String {
    percent(fifo.bins.iter().map(|bin| bin.full).sum(), fifo.histogram.iter().copied().sum())
}

/// How long each FIFO held how many words.
pub struct Histograms<'a> {
    pub caption: &'a Caption,
    pub fifos: &'a [FifoProfile],
    pub cycles: Cycles,
}

/// The smallest share of the time that a histogram shows, in percent.
const SMALLEST_SHARE: f64 = 0.001;

impl Figure for Histograms<'_> {
    fn size(&self) -> (u32, u32) {
        chart::size(self.fifos.len())
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let legend = [("share of the time with so many words inside", palette::LEVEL), ("full", palette::FULL)];
        let panels = chart::panels(area, self.caption, "How full the FIFOs are", &legend, self.fifos.len())?;
        let widest = self.fifos.iter().map(highest).max().unwrap_or(0);
        for (index, (fifo, panel)) in self.fifos.iter().zip(&panels).enumerate() {
            self.draw_fifo(fifo, panel, widest, index + 1 == self.fifos.len())?;
        }
        Ok(())
    }
}

impl Histograms<'_> {
    fn draw_fifo<DB: DrawingBackend>(
        &self,
        fifo: &FifoProfile,
        panel: &DrawingArea<DB, Shift>,
        widest: u64,
        is_last: bool,
    ) -> Drawn<DB> {
        let name = format!("{}: at most {} of {} words", fifo.name, highest(fifo), fifo.capacity.0);
        let mut chart = chart::builder(panel, &name, is_last)
            .build_cartesian_2d(-0.5..widest as f64 + 0.5, (SMALLEST_SHARE..100.0).log_scale())?;
        let mut mesh = chart.configure_mesh();
        mesh.x_label_formatter(&chart::number).y_label_formatter(&chart::number);
        mesh.max_light_lines(1)
            .disable_x_mesh()
            .y_labels(4)
            .y_desc("% of the time")
            .label_style(font(13))
            .axis_desc_style(font(13));
        mesh.x_labels(if is_last { 20 } else { 0 });
        if is_last {
            mesh.x_desc("words in the FIFO");
        }
        mesh.draw()?;
        let step = fifo.step.0 as f64;
        let bars = fifo.histogram.iter().enumerate().filter(|(_, cycles)| cycles.0 > 0).map(|(index, cycles)| {
            let share = 100.0 * cycles.0 as f64 / self.cycles.0.max(1) as f64;
            let start = index as f64 * step - 0.5;
            let is_full = (index as u64 + 1) * fifo.step.0 > fifo.capacity.0;
            let color = rgb(if is_full { palette::FULL } else { palette::LEVEL });
            Rectangle::new([(start, SMALLEST_SHARE), (start + step, share.max(SMALLEST_SHARE))], color.filled())
        });
        chart.draw_series(bars)?;
        Ok(())
    }
}
