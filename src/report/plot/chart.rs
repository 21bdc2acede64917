//! What the figures have in common: the caption, the legend, panels one above the other on one axis of time.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Caption;
use super::render::{Drawn, FONT_NAME};
use crate::machine::{Cycles, MachineSpec, Profile};
use crate::report::palette::Rgb;
use crate::report::time_unit::TimeUnit;

/// Width of every picture, in pixels.
const WIDTH: u32 = 1280;
/// Height of the caption and the legend.
const HEAD: u32 = 96;
/// Height of a panel.
const PANEL: u32 = 150;
/// What the panel with the time axis needs more.
const FOOT: u32 = 44;
/// Room for the labels of the vertical axis.
const LEFT: u32 = 86;
/// What the axis itself takes of it; the rest keeps its name off the picture's edge.
const AXIS: u32 = 70;
const RIGHT: u32 = 24;

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
    /// The scale of a run.
    pub fn new(profile: &Profile, spec: &MachineSpec) -> TimeScale {
        let unit = TimeUnit::of(spec.seconds(profile.cycles));
        let cycle = spec.seconds(Cycles(1)) / unit.seconds;
        TimeScale { unit, cycle, bin: profile.bin.0, cycles: profile.cycles.0 }
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

    /// A curve that has one value in each bin, as steps.
    pub fn steps(&self, values: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
        values.enumerate().flat_map(|(index, value)| [(self.bin(index).0, value), (self.bin(index).1, value)]).collect()
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

/// Text of a height.
pub fn font(height: u32) -> TextStyle<'static> {
    (FONT_NAME, height).into_font().color(&BLACK)
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
    area.draw_text(what, &font(22), (16, 8))?;
    area.draw_text(&caption.title, &font(15), (16, 36))?;
    area.draw_text(&caption.machine, &font(13).color(&RGBColor(90, 90, 90)), (16, 56))?;
    draw_legend(area, legend)?;
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

fn draw_legend<DB: DrawingBackend>(area: &DrawingArea<DB, Shift>, legend: &[(&str, Rgb)]) -> Drawn<DB> {
    let mut x = LEFT as i32;
    for (name, color) in legend {
        let square = [(x, 78), (x + 14, 92)];
        area.draw(&Rectangle::new(square, rgb(*color).filled()))?;
        area.draw(&Rectangle::new(square, RGBColor(120, 120, 120)))?;
        area.draw_text(name, &font(14), (x + 20, 78))?;
        x += 20 + area.estimate_text_size(name, &font(14))?.0 as i32 + 24;
    }
    Ok(())
}

/// A chart in a panel, with its name inside the frame's top.
pub fn builder<'a, DB: DrawingBackend>(
    area: &'a DrawingArea<DB, Shift>,
    name: &str,
    is_last: bool,
) -> ChartBuilder<'a, 'a, DB> {
    let mut builder = ChartBuilder::on(area);
    builder.caption(name, font(14)).margin_right(RIGHT).y_label_area_size(AXIS).x_label_area_size(if is_last {
        FOOT
    } else {
        6
    });
    builder
}
