//! What the figures have in common: the caption, the legend, panels one above the other on one axis of time.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::Caption;
use super::render::{Drawn, FONT_NAME};
use crate::measure::Clock;
use crate::quantities::Cycles;
use crate::report::palette::Rgb;
use crate::report::time_unit::TimeUnit;

/// Width of every picture, in pixels.
pub const WIDTH: u32 = 1280;
/// Height of the caption and the legend.
pub const HEAD: u32 = 124;
/// Height of a panel.
const PANEL: u32 = 160;
/// What the panel with the time axis needs more.
pub const FOOT: u32 = 52;
/// Left of the axes: room for what they are called and for their labels.
pub const LEFT: u32 = 92;
/// The part of it that keeps their names off the picture's edge.
const EDGE: u32 = 14;
const RIGHT: u32 = 28;
/// Numbers on the horizontal axis, at the most.
pub const ACROSS: usize = 11;
/// Height of the text on axes and over panels.
pub const SMALL: u32 = 15;
/// Text that has to be smaller is cut.
const SMALLEST: u32 = 12;

/// Simulated time as the horizontal axis shows it.
#[derive(Clone, Copy, Debug)]
pub struct TimeScale {
    /// The unit.
    pub unit: TimeUnit,
    /// Units of one cycle.
    pub cycle: f64,
    bin: u64,
    cycles: u64,
}

impl TimeScale {
    /// The scale of a run of so many cycles, whose bins are so wide.
    pub fn new(cycles: Cycles, bin: Cycles, clock: Clock) -> TimeScale {
        let unit = TimeUnit::of(clock.seconds(cycles));
        let cycle = clock.seconds(Cycles(1)) / unit.seconds;
        TimeScale { unit, cycle, bin: bin.0, cycles: cycles.0 }
    }

    /// The end of the run.
    pub fn end(&self) -> f64 {
        (self.cycles as f64 * self.cycle).max(f64::MIN_POSITIVE)
    }

    /// Start and end of a bin.
    pub fn bin(&self, index: usize) -> (f64, f64) {
        let start = index as u64 * self.bin;
        (start as f64 * self.cycle, (start + self.cycles_of(index)) as f64 * self.cycle)
    }

    /// How many cycles a bin has: the last one may have fewer than the others.
    pub fn cycles_of(&self, index: usize) -> u64 {
        self.bin.min(self.cycles - index as u64 * self.bin)
    }

    /// A curve that has one value in each bin, as steps; values are rounded to multiples of `grain`, which is less than
    /// can be seen.
    pub fn steps(&self, values: impl Iterator<Item = f64>, grain: f64) -> Vec<(f64, f64)> {
        let mut steps: Vec<(f64, f64)> = Vec::new();
        for (index, value) in values.enumerate() {
            let ((start, end), value) = (self.bin(index), (value / grain).round() * grain);
            match steps.last_mut() {
                Some(last) if last.1 == value => last.0 = end,
                _ => steps.extend([(start, value), (end, value)]),
            }
        }
        steps
    }

    /// What the axis is called.
    pub fn label(&self) -> String {
        format!("simulated time ({})", self.unit.name)
    }
}

/// The size of a picture of so many panels.
pub fn size(panels: usize) -> (u32, u32) {
    (WIDTH, HEAD + panels as u32 * PANEL + FOOT)
}

/// A number on an axis, without zeros that say nothing.
pub fn number(value: &f64) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// A whole number on an axis; between them there is nothing to tell.
pub fn whole_number(value: &f64) -> String {
    if (value - value.round()).abs() < 1e-9 { number(value) } else { String::new() }
}

/// What cannot be seen in a panel whose vertical axis is so long.
pub fn grain(length: f64) -> f64 {
    length / (2 * PANEL) as f64
}

/// Text of a height.
pub fn font(height: u32) -> TextStyle<'static> {
    (FONT_NAME, height).into_font().color(&BLACK)
}

/// Text that takes no more than so many pixels: in smaller letters than of that height, and cut where that does not do.
pub fn fitted<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    text: &str,
    height: u32,
    room: u32,
) -> Result<(String, TextStyle<'static>), DrawingAreaErrorKind<DB::ErrorType>> {
    for height in (SMALLEST.min(height)..=height).rev() {
        if area.estimate_text_size(text, &font(height))?.0 <= room {
            return Ok((text.to_owned(), font(height)));
        }
    }
    Ok((cut(area, text, SMALLEST.min(height), room)?, font(SMALLEST.min(height))))
}

/// As much of a text as there is room for.
fn cut<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    text: &str,
    height: u32,
    room: u32,
) -> Result<String, DrawingAreaErrorKind<DB::ErrorType>> {
    let shortened = |letters: usize| text.chars().take(letters).chain(['…']).collect::<String>();
    let (mut fits, mut does_not) = (0, text.chars().count());
    while fits + 1 < does_not {
        let middle = (fits + does_not) / 2;
        let is_in = area.estimate_text_size(&shortened(middle), &font(height))?.0 <= room;
        if is_in { fits = middle } else { does_not = middle }
    }
    Ok(shortened(fits))
}

/// Right of the axes: room for half of the last label, as it may stand at their end.
pub fn right<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, label: &str, height: u32) -> u32 {
    area.estimate_text_size(label, &font(height)).map_or(RIGHT, |(width, _)| RIGHT.max(width / 2 + 4))
}

/// The same of an axis of numbers.
pub fn right_of<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, across: &Range<f64>) -> u32 {
    let ticks = RangedCoordf64::from(across.clone()).key_points(ACROSS);
    right(area, &ticks.last().map(number).unwrap_or_default(), SMALL)
}

/// A colour of the palette.
pub fn rgb(color: Rgb) -> RGBColor {
    RGBColor(color.0, color.1, color.2)
}

/// Draws caption and legend; what is left below is cut into panels, the last of which has room for the axis.
pub fn panels<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    caption: &Caption,
    what: &str,
    legend: &[(&str, Rgb)],
    count: usize,
) -> Result<Vec<DrawingArea<DB, Shift>>, DrawingAreaErrorKind<DB::ErrorType>> {
    head(area, caption, what, legend)?;
    let (_, mut rest) = area.split_vertically(HEAD);
    let mut panels = Vec::new();
    for _ in 1..count {
        let (panel, below) = rest.split_vertically(PANEL);
        panels.push(panel);
        rest = below;
    }
    panels.push(rest);
    Ok(panels)
}

/// Draws the caption and the legend.
pub fn head<DB: DrawingBackend>(
    area: &DrawingArea<DB, Shift>,
    caption: &Caption,
    what: &str,
    legend: &[(&str, Rgb)],
) -> Drawn<DB> {
    let room = area.dim_in_pixel().0.saturating_sub(2 * EDGE);
    let gray = RGBColor(90, 90, 90);
    for (text, height, color, y) in
        [(what, 26, BLACK, 10), (&caption.what_ran(), 17, BLACK, 44), (&caption.machine, SMALL, gray, 68)]
    {
        let (text, font) = fitted(area, text, height, room)?;
        area.draw_text(&text, &font.color(&color), (EDGE as i32, y))?;
    }
    let mut x = LEFT as i32;
    for (name, color) in legend {
        let square = [(x, 98), (x + 15, 113)];
        area.draw(&Rectangle::new(square, rgb(*color).filled()))?;
        area.draw(&Rectangle::new(square, RGBColor(120, 120, 120)))?;
        area.draw_text(name, &font(16), (x + 22, 98))?;
        x += 22 + area.estimate_text_size(name, &font(16))?.0 as i32 + 22;
    }
    Ok(())
}

/// A chart in a panel, with its name over the frame, over that stretch of the horizontal axis.
pub fn builder<'a, DB: DrawingBackend>(
    area: &'a DrawingArea<DB, Shift>,
    name: &str,
    is_last: bool,
    across: &Range<f64>,
) -> ChartBuilder<'a, 'a, DB> {
    let mut builder = ChartBuilder::on(area);
    builder.margin_left(EDGE).margin_right(right_of(area, across)).y_label_area_size(LEFT - EDGE);
    builder.caption(name, font(16)).x_label_area_size(if is_last { FOOT } else { 8 });
    builder
}

/// Draws the axes of a chart: what they are called, and how many values are named on the vertical one.
pub fn axes<DB: DrawingBackend, Y: Ranged<ValueType = f64> + ValueFormatter<f64>>(
    chart: &mut ChartContext<'_, DB, Cartesian2d<RangedCoordf64, Y>>,
    (across, up): (Option<&str>, &str),
    values: usize,
    format: &dyn Fn(&f64) -> String,
) -> Drawn<DB> {
    let mut mesh = chart.configure_mesh();
    mesh.max_light_lines(1).disable_x_mesh().x_label_formatter(&number).y_label_formatter(format);
    mesh.label_style(font(SMALL)).axis_desc_style(font(SMALL)).y_labels(values).y_desc(up);
    match across {
        Some(name) => mesh.x_labels(ACROSS).x_desc(name).draw(),
        None => mesh.x_labels(0).draw(),
    }
}
