//! What the FIFOs hold: over time, and how long how much.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Caption;
use super::chart::{self, TimeScale, rgb};
use super::render::{Drawn, Figure};
use crate::measure::{FifoBin, FifoInfo, FifoProfile, Names};
use crate::quantities::{Cycles, Words};
use crate::report::palette::{self, Rgb};
use crate::report::summary::{percent, plural};

/// Each FIFO's level over time.
pub struct Levels<'a> {
    pub caption: &'a Caption,
    pub scale: TimeScale,
    pub called: &'a Names,
    pub fifos: &'a [(&'a FifoInfo, &'a FifoProfile)],
}

impl Figure for Levels<'_> {
    fn size(&self) -> (u32, u32) {
        chart::size(self.fifos.len())
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let panels = chart::panels(area, self.caption, &levels(self.called), &LEVELS_LEGEND, self.fifos.len())?;
        let deepest = deepest(self.fifos);
        for (index, (&(info, fifo), panel)) in self.fifos.iter().zip(&panels).enumerate() {
            self.draw_fifo((info, fifo), panel, deepest, index + 1 == self.fifos.len())?;
        }
        Ok(())
    }
}

impl Levels<'_> {
    fn draw_fifo<DB: DrawingBackend>(
        &self,
        (info, fifo): (&FifoInfo, &FifoProfile),
        panel: &DrawingArea<DB, Shift>,
        deepest: u64,
        is_last: bool,
    ) -> Drawn<DB> {
        let top = deepest as f64 * 1.12;
        let name = format!("{}, full {} of the time", most(info, fifo, self.called), full(fifo));
        let across = 0.0..self.scale.end();
        let mut chart = chart::builder(panel, &name, is_last, &across).build_cartesian_2d(across, 0.0..top)?;
        let across = self.scale.label();
        let values = if deepest < 4 { deepest as usize + 1 } else { 4 };
        let words = format!("{}s", self.called.word);
        chart::axes(&mut chart, (is_last.then_some(&across), &words), values, &chart::whole_number)?;
        let grain = chart::grain(top);
        let mut outline = self.scale.steps(fifo.bins.iter().map(|bin| bin.max.0 as f64), grain);
        let lowest = self.scale.steps(fifo.bins.iter().map(|bin| bin.min.0 as f64), grain);
        outline.extend(lowest.into_iter().rev());
        chart.draw_series([Polygon::new(outline, rgb(palette::RANGE).filled())])?;
        if let Some(capacity) = info.capacity {
            let line = [(0.0, capacity.0 as f64), (self.scale.end(), capacity.0 as f64)];
            chart.draw_series(DashedLineSeries::new(line, 6, 4, BLACK.into()))?;
        }
        let means = self.scale.steps(means(&fifo.bins, self.scale), grain);
        chart.draw_series(LineSeries::new(means, rgb(palette::AMOUNT).stroke_width(2)))?;
        let marks = full_times(&fifo.bins, self.scale)
            .map(|(start, end)| Rectangle::new([(start, top * 0.94), (end, top)], rgb(palette::FULL).filled()));
        chart.draw_series(marks)?;
        Ok(())
    }
}

/// What the picture of the levels is called.
pub fn levels(called: &Names) -> String {
    let words = capitalized(&called.word);
    format!("{words}s in the {}s over time", called.fifo)
}

/// A word that begins a sentence.
fn capitalized(word: &str) -> String {
    let (first, rest) = word.split_at(word.len().min(1));
    first.to_uppercase() + rest
}

/// Its colours.
pub const LEVELS_LEGEND: [(&str, Rgb); 3] = [
    ("mean", palette::AMOUNT),
    ("lowest to highest in each interval", palette::RANGE),
    ("full at some time in the interval", palette::FULL),
];

/// What the picture of the histograms is called.
pub fn histograms(called: &Names) -> String {
    format!("How full the {}s are", called.fifo)
}

/// A FIFO, and the most that it held.
fn most(info: &FifoInfo, fifo: &FifoProfile, called: &Names) -> String {
    let highest = highest(fifo);
    let words = match info.capacity {
        Some(capacity) => format!("{highest} of {}", plural(capacity.0, &called.word)),
        None => plural(highest, &called.word),
    };
    format!("{}: at most {words}", info.name)
}

/// The mean of each bin, in words.
pub fn means(bins: &[FifoBin], scale: TimeScale) -> impl Iterator<Item = f64> {
    bins.iter().enumerate().map(move |(at, bin)| bin.word_cycles as f64 / scale.cycles_of(at) as f64)
}

/// The stretches of bins in which the FIFO was full at some time.
pub fn full_times(bins: &[FifoBin], scale: TimeScale) -> impl Iterator<Item = (f64, f64)> {
    let is_full = |bin: &FifoBin| bin.full > Cycles(0);
    let mut first = 0;
    bins.chunk_by(move |a, b| is_full(a) == is_full(b)).filter_map(move |stretch| {
        let start = first;
        first += stretch.len();
        is_full(&stretch[0]).then(|| (scale.bin(start).0, scale.bin(first - 1).1))
    })
}

/// What the deepest of some FIFOs holds, or held if it takes all: the end of the one scale of a figure, so that its FIFOs compare.
pub fn deepest(fifos: &[(&FifoInfo, &FifoProfile)]) -> u64 {
    let depth = |(info, fifo): &(&FifoInfo, &FifoProfile)| info.capacity.map_or_else(|| highest(fifo), |words| words.0);
    fifos.iter().map(depth).max().unwrap_or(0).max(1)
}

/// The highest level of all.
pub fn highest(fifo: &FifoProfile) -> u64 {
    fifo.bins.iter().map(|bin| bin.max.0).max().unwrap_or(0)
}

fn full(fifo: &FifoProfile) -> String {
    percent(fifo.bins.iter().map(|bin| bin.full).sum(), fifo.histogram.iter().copied().sum())
}

/// How long each FIFO held how many words.
pub struct Histograms<'a> {
    pub caption: &'a Caption,
    pub called: &'a Names,
    pub fifos: &'a [(&'a FifoInfo, &'a FifoProfile)],
    pub cycles: Cycles,
}

/// The smallest share of the time that a histogram shows, in percent.
const SMALLEST_SHARE: f64 = 0.001;

impl Figure for Histograms<'_> {
    fn size(&self) -> (u32, u32) {
        chart::size(self.fifos.len())
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let inside = format!("share of the time with so many {}s inside", self.called.word);
        let legend = [(inside.as_str(), palette::AMOUNT), ("full", palette::FULL)];
        let panels = chart::panels(area, self.caption, &histograms(self.called), &legend, self.fifos.len())?;
        let widest = deepest(self.fifos);
        for (index, (&(info, fifo), panel)) in self.fifos.iter().zip(&panels).enumerate() {
            self.draw_fifo((info, fifo), panel, widest, index + 1 == self.fifos.len())?;
        }
        Ok(())
    }
}

impl Histograms<'_> {
    fn draw_fifo<DB: DrawingBackend>(
        &self,
        (info, fifo): (&FifoInfo, &FifoProfile),
        panel: &DrawingArea<DB, Shift>,
        widest: u64,
        is_last: bool,
    ) -> Drawn<DB> {
        let name = most(info, fifo, self.called);
        let across = -0.5..widest as f64 + 0.5;
        let mut chart = chart::builder(panel, &name, is_last, &across)
            .build_cartesian_2d(across, (SMALLEST_SHARE..100.0).log_scale())?;
        let inside = format!("{}s in the {}", self.called.word, self.called.fifo);
        chart::axes(&mut chart, (is_last.then_some(&inside), "% of the time"), 4, &chart::number)?;
        let step = fifo.step.0 as f64;
        let bars = fifo.histogram.iter().enumerate().filter(|(_, cycles)| cycles.0 > 0).map(|(index, cycles)| {
            let share = 100.0 * cycles.0 as f64 / self.cycles.0.max(1) as f64;
            let start = index as f64 * step - 0.5;
            let is_full = info.is_full(Words((index as u64 + 1) * fifo.step.0 - 1));
            let color = rgb(if is_full { palette::FULL } else { palette::AMOUNT });
            Rectangle::new([(start, SMALLEST_SHARE), (start + step, share.max(SMALLEST_SHARE))], color.filled())
        });
        chart.draw_series(bars)?;
        Ok(())
    }
}
