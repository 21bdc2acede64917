//! Many cells or FIFOs in one picture: a thin row each, or one for some neighbours together.

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::Caption;
use super::chart::{self, FOOT, HEAD, LEFT, SMALL, TimeScale, WIDTH, font, rgb};
use super::render::{Drawn, Figure};
use super::{cells, fifos};
use crate::measure::{FifoBin, FifoInfo, FifoProfile, Names, State, StateTimes, Topology};
use crate::quantities::Cycles;
use crate::report::palette::{self, Rgb};

/// Rows that a picture has at the most.
const MOST_ROWS: usize = 64;
/// Height of all rows together, in pixels; few rows need less.
const ROWS: u32 = 960;
/// The highest that a row gets.
const HIGHEST_ROW: u32 = 48;
/// The part of its height that a row fills.
const FILLED: f64 = 0.88;

/// A cell or a FIFO, or some neighbours.
struct Row<B> {
    name: String,
    bins: Vec<B>,
    /// How many cells or FIFOs it stands for.
    members: f64,
}

/// Makes a row of each, or of as many neighbours as there must be together; `merge` makes one of some bins at the same time.
fn rows<'a, T, B>(
    items: &'a [T],
    name: impl Fn(usize) -> String,
    bins: impl Fn(&'a T) -> &'a [B],
    merge: impl Fn(&[B]) -> B,
) -> Vec<Row<B>>
where
    B: Copy + 'a,
{
    let together = items.len().div_ceil(MOST_ROWS).max(1);
    let row = |(index, part): (usize, &'a [T])| {
        let first = index * together;
        let last = first + part.len() - 1;
        let length = bins(&part[0]).len();
        Row {
            name: if first == last { name(first) } else { format!("{} ...", name(first)) },
            bins: (0..length).map(|bin| merge(&part.iter().map(|item| bins(item)[bin]).collect::<Vec<_>>())).collect(),
            members: part.len() as f64,
        }
    };
    items.chunks(together).enumerate().map(row).collect()
}

type Chart<'a, DB> = ChartContext<'a, DB, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

fn row_height(rows: usize) -> u32 {
    (ROWS / rows.max(1) as u32).min(HIGHEST_ROW)
}

fn size(rows: usize) -> (u32, u32) {
    (WIDTH, HEAD + 8 + rows as u32 * row_height(rows) + FOOT)
}

/// A chart whose rows count from 0 at the bottom, with their names, the first at the top.
fn frame<'a, DB: DrawingBackend>(
    area: &'a DrawingArea<DB, Shift>,
    names: impl ExactSizeIterator<Item = &'a str>,
    across: std::ops::Range<f64>,
    label: &str,
) -> Result<Chart<'a, DB>, DrawingAreaErrorKind<DB::ErrorType>> {
    let count = names.len();
    let mut builder = ChartBuilder::on(area);
    builder
        .margin_top(HEAD + 8)
        .margin_right(chart::right_of(area, &across))
        .y_label_area_size(LEFT)
        .x_label_area_size(FOOT);
    let mut chart = builder.build_cartesian_2d(across.clone(), 0.0..count.max(1) as f64)?;
    let mut mesh = chart.configure_mesh();
    mesh.disable_mesh().x_label_formatter(&chart::number).label_style(font(SMALL)).axis_desc_style(font(SMALL));
    mesh.x_labels(chart::ACROSS).y_labels(0).x_desc(label).draw()?;
    let height = (row_height(count) - 1).min(SMALL);
    let style = font(height).pos(Pos::new(HPos::Right, VPos::Center));
    for (index, name) in names.enumerate() {
        let (x, y) = chart.backend_coord(&(across.start, (count - index) as f64 - FILLED / 2.0));
        area.draw_text(name, &style, (x - 8, y))?;
    }
    Ok(chart)
}

/// Each cell's states over time, as bands.
pub struct Bands<'a> {
    caption: &'a Caption,
    what: String,
    scale: TimeScale,
    rows: Vec<Row<StateTimes>>,
    topology: &'a Topology,
    occurring: Vec<&'a State>,
}

impl<'a> Bands<'a> {
    /// What the stations do.
    pub fn of_stations(
        caption: &'a Caption,
        scale: TimeScale,
        topology: &'a Topology,
        all: &'a [Vec<StateTimes>],
    ) -> Bands<'a> {
        let stations = format!("{}s", topology.names.station);
        let what = together(&cells::what(topology), &stations, all.len().div_ceil(MOST_ROWS).max(1));
        let rows = rows(all, |index| topology.station(index), Vec::as_slice, StateTimes::sum);
        Bands { caption, what, scale, rows, topology, occurring: cells::occurring(&topology.states, all.iter()) }
    }

    /// Where the critical path is, and why: a row for each station that it stays in, and for the host of a line, which is the last
    /// of `all`. What is higher is there for more of the time, so that the rows add up to a full one.
    pub fn of_path(
        caption: &'a Caption,
        scale: TimeScale,
        topology: &'a Topology,
        all: &[Vec<StateTimes>],
    ) -> Bands<'a> {
        let cycles = |bins: &Vec<StateTimes>| bins.iter().map(|bin| bin.total().0).sum::<u64>();
        let whole: u64 = all.iter().map(cycles).sum();
        let stays_in = |bins: &Vec<StateTimes>| cycles(bins).saturating_mul(SHORTEST_STAY) >= whole.max(1);
        let (places, visited): (Vec<usize>, Vec<Vec<StateTimes>>) =
            all.iter().cloned().enumerate().filter(|(_, bins)| stays_in(bins)).unzip();
        let name = |index: usize| match places[index] {
            place if place == topology.stations => "host".to_owned(),
            place => topology.station(place),
        };
        let what = together(PATH, &format!("{}s", topology.names.station), visited.len().div_ceil(MOST_ROWS).max(1));
        let mut rows = rows(&visited, name, Vec::as_slice, StateTimes::sum);
        rows.iter_mut().for_each(|row| row.members = 1.0);
        Bands { caption, what, scale, rows, topology, occurring: cells::occurring(&topology.states, all.iter()) }
    }
}

/// A critical path that is in a cell for less than one part in so many only passes through it.
const SHORTEST_STAY: u64 = 1000;

/// What the picture of a critical path is called.
const PATH: &str = "Where the critical path is, and why";

impl Figure for Bands<'_> {
    fn size(&self) -> (u32, u32) {
        size(self.rows.len())
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let states = &self.topology.states;
        chart::head(area, self.caption, &self.what, &cells::legend(states, &self.occurring))?;
        let names = self.rows.iter().map(|row| row.name.as_str());
        let mut chart = frame(area, names, 0.0..self.scale.end(), &self.scale.label())?;
        let count = self.rows.len();
        let grain = 100.0 / f64::from(2 * row_height(count));
        for (index, row) in self.rows.iter().enumerate() {
            let ground = (count - index) as f64 - FILLED;
            for (state, edge) in cells::bands(&row.bins, &self.occurring, self.scale, grain) {
                let up = |(x, share): (f64, f64)| (x, ground + FILLED * share / 100.0 / row.members);
                let band = AreaSeries::new(edge.into_iter().map(up), ground, rgb(palette::of_state(states, state)));
                chart.draw_series(band)?;
            }
        }
        Ok(())
    }
}

/// Each FIFO's level over time.
pub struct Levels<'a> {
    caption: &'a Caption,
    scale: TimeScale,
    called: &'a Names,
    rows: Vec<Row<FifoBin>>,
    /// The level that fills a row.
    top: u64,
    together: usize,
}

impl<'a> Levels<'a> {
    pub fn new(
        (caption, called): (&'a Caption, &'a Names),
        scale: TimeScale,
        all: &'a [(&'a FifoInfo, &'a FifoProfile)],
    ) -> Levels<'a> {
        Levels {
            caption,
            scale,
            called,
            rows: rows(all, |index| all[index].0.name.clone(), |(_, fifo)| &fifo.bins, FifoBin::of_all),
            top: fifos::deepest(all),
            together: all.len().div_ceil(MOST_ROWS).max(1),
        }
    }
}

impl Figure for Levels<'_> {
    fn size(&self) -> (u32, u32) {
        size(self.rows.len())
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let what = together(&fifos::levels(self.called), &format!("{}s", self.called.fifo), self.together);
        let what = format!("{what}: each row from 0 to {}", self.top);
        chart::head(area, self.caption, &what, &fifos::LEVELS_LEGEND)?;
        let names = self.rows.iter().map(|row| row.name.as_str());
        let mut chart = frame(area, names, 0.0..self.scale.end(), &self.scale.label())?;
        let count = self.rows.len();
        let (top, grain) = (self.top as f64, self.top as f64 / f64::from(2 * row_height(count)));
        for (index, row) in self.rows.iter().enumerate() {
            let ground = (count - index) as f64 - FILLED;
            let up = |(x, words): (f64, f64)| (x, ground + FILLED * words / top);
            let bins = || row.bins.iter();
            let mut outline = self.scale.steps(bins().map(|bin| bin.max.0 as f64), grain);
            outline.extend(self.scale.steps(bins().map(|bin| bin.min.0 as f64), grain).into_iter().rev());
            let outline: Vec<_> = outline.into_iter().map(up).collect();
            chart.draw_series([Polygon::new(outline, rgb(palette::RANGE).filled())])?;
            let words = fifos::means(&row.bins, self.scale).map(|mean| mean / row.members);
            let means = self.scale.steps(words, grain).into_iter().map(up);
            chart.draw_series(AreaSeries::new(means, ground, rgb(palette::AMOUNT)))?;
            let marks = fifos::full_times(&row.bins, self.scale).map(|(start, end)| {
                Rectangle::new([(start, ground + FILLED), (end, ground + 0.98)], rgb(palette::FULL).filled())
            });
            chart.draw_series(marks)?;
        }
        Ok(())
    }
}

/// For how long each FIFO held how many words, as shades.
pub struct Histograms<'a> {
    caption: &'a Caption,
    called: &'a Names,
    rows: Vec<Row<Cycles>>,
    /// What the deepest holds.
    deepest: u64,
    cycles: f64,
    /// Occupancies that share an entry of the histograms.
    step: f64,
    together: usize,
}

/// Shares of the time, in percent, from which on each shade stands; below the first there is none.
const SHADES: [(&str, f64, Rgb); 5] = [
    ("some time", 0.0, Rgb(214, 220, 236)),
    ("over 0.01 %", 0.01, Rgb(168, 178, 208)),
    ("over 0.1 %", 0.1, Rgb(118, 131, 170)),
    ("over 1 %", 1.0, Rgb(79, 91, 128)),
    ("over 10 % of the time", 10.0, Rgb(24, 28, 45)),
];

/// A histogram whose entries are for `step` occupancies each; steps are powers of two.
fn shared(fifo: &FifoProfile, step: u64, sum: impl Fn(&[Cycles]) -> Cycles) -> Vec<Cycles> {
    fifo.histogram.chunks((step / fifo.step.0.max(1)).max(1) as usize).map(sum).collect()
}

impl<'a> Histograms<'a> {
    pub fn new(
        (caption, called): (&'a Caption, &'a Names),
        all: &'a [(&'a FifoInfo, &'a FifoProfile)],
        cycles: Cycles,
    ) -> Histograms<'a> {
        let together = all.len().div_ceil(MOST_ROWS).max(1);
        let sum = |entries: &[Cycles]| entries.iter().copied().sum();
        // FIFOs of several depths: as the deepest have them.
        let step = all.iter().map(|(_, fifo)| fifo.step.0).max().unwrap_or(1);
        let mut histograms: Vec<Vec<Cycles>> = all.iter().map(|(_, fifo)| shared(fifo, step, sum)).collect();
        let longest = histograms.iter().map(Vec::len).max().unwrap_or(0);
        histograms.iter_mut().for_each(|histogram| histogram.resize(longest, Cycles(0)));
        Histograms {
            caption,
            called,
            rows: rows(&histograms, |index| all[index].0.name.clone(), |histogram| histogram, sum),
            deepest: fifos::deepest(all),
            cycles: cycles.0.max(1) as f64,
            step: step as f64,
            together,
        }
    }

    /// The shade of an entry.
    fn shade(&self, held: Cycles, members: f64) -> Option<Rgb> {
        let share = 100.0 * held.0 as f64 / (self.cycles * members);
        SHADES.iter().rev().find(|(_, from, _)| share > *from).map(|shade| shade.2)
    }
}

impl Figure for Histograms<'_> {
    fn size(&self) -> (u32, u32) {
        size(self.rows.len())
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let what = together(&fifos::histograms(self.called), &format!("{}s", self.called.fifo), self.together);
        chart::head(area, self.caption, &what, &SHADES.map(|(name, _, shade)| (name, shade)))?;
        let widest = self.deepest as f64 + 1.0;
        let names = self.rows.iter().map(|row| row.name.as_str());
        let inside = format!("{}s in the {}", self.called.word, self.called.fifo);
        let mut chart = frame(area, names, -0.5..widest - 0.5, &inside)?;
        let count = self.rows.len();
        for (index, row) in self.rows.iter().enumerate() {
            let ground = (count - index) as f64 - FILLED;
            let shades: Vec<Option<Rgb>> = row.bins.iter().map(|&held| self.shade(held, row.members)).collect();
            let mut first = 0;
            for stretch in shades.chunk_by(|a, b| a == b) {
                let start = first as f64 * self.step - 0.5;
                first += stretch.len();
                if let Some(shade) = stretch[0] {
                    let corners = [(start, ground), (first as f64 * self.step - 0.5, ground + FILLED)];
                    chart.draw_series([Rectangle::new(corners, rgb(shade).filled())])?;
                }
            }
        }
        Ok(())
    }
}

/// What a picture is called whose rows are of so many.
fn together(what: &str, of: &str, count: usize) -> String {
    if count == 1 { what.to_owned() } else { format!("{what}, {count} neighbouring {of} a row") }
}
