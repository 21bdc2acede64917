//! Drawing lines with markers.

use plotters::coord::Shift;
use plotters::coord::ranged1d::Ranged;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::Axes;
use super::choice::{FIRST, Look};
use super::series::{Curves, Panel, Spot};
use crate::report::palette;
use crate::report::plot::Caption;
use crate::report::plot::chart::{self, font, rgb};
use crate::report::plot::render::{self, Drawn, Figure};
use crate::report::plot::scale::Scale;
use crate::report::table::Column;

/// Height of the figure, in panels of the others; where there are facets, of each of these.
const PANELS: usize = 4;
const OF_FACET: usize = 2;
/// Width of the legend.
const LEGEND: u32 = 230;
/// Height of a line of the legend.
const LEGEND_LINE: i32 = 19;
/// Room for the numbers of the vertical axis and its name, and left of it.
const LEFT: u32 = 104;
const MARGIN: u32 = 12;
/// Height of its text, and of what the axes are called.
const TEXT: u32 = 14;
/// Height of the numbers along the axes, and what is free between two of them.
const NUMBERS: u32 = 13;
const GAP: i32 = 8;
/// Room below the panels for what the axis is called, and below each for its numbers.
const FOOT: u32 = 26;
const TICKS: u32 = 26;

/// A figure of a table.
pub struct Chart<'a> {
    curves: &'a Curves,
    what: String,
    caption: Caption,
    x: Scale,
    y: Scale,
    labels: [String; 2],
    /// What the lines differ in.
    by: Option<&'a str>,
    /// What the panels differ in.
    facet: Option<&'a str>,
    size: (u32, u32),
}

impl<'a> Chart<'a> {
    pub fn new(
        columns: &[Column<'a>],
        (axes, look): (&Axes, &Look),
        curves: &'a Curves,
        what_ran: &str,
    ) -> Result<Chart<'a>, String> {
        let [x_spread, y_spread] = look.spreads();
        let x = Scale::of_positions(&curves.x, x_spread)?;
        let y = Scale::of_values(curves.spots().map(|spot| spot.1), y_spread)?;
        let relative = match look.relative.as_deref() {
            None => String::new(),
            Some(FIRST) => ", relative to the first point of each line".to_owned(),
            Some(line) => format!(", relative to {line}"),
        };
        let y_name = columns[axes.y].label;
        let y_name = if relative.is_empty() { y_name.to_owned() } else { without_unit(y_name).to_owned() + &relative };
        let label = |name: &str, scale: &Scale| {
            let logarithmic = if scale.is_log() { ", logarithmic" } else { "" };
            format!("{name}{logarithmic}")
        };
        let labels = [label(columns[axes.x].label, &x), label(&y_name, &y)];
        let [by, facet] = [curves.by, axes.facet].map(|column| column.map(|column| columns[column].label));
        let of = |word: &str, label: Option<&str>| {
            label.map(|label| format!(", {word} {}", without_unit(label))).unwrap_or_default()
        };
        let mut what = format!(
            "{} over {}{}{}{relative}",
            without_unit(columns[axes.y].label),
            without_unit(columns[axes.x].label),
            of("by", by),
            of("for each", facet),
        );
        if let Some(first) = what.get_mut(..1) {
            first.make_ascii_uppercase();
        }
        let panels = curves.panels.len();
        let size = look.cm.map_or(chart::size(if panels > 1 { OF_FACET * panels } else { PANELS }), render::pixels);
        let caption = Caption { title: what_ran.to_owned(), partition: None, machine: remarks(curves) };
        Ok(Chart { curves, what, caption, x, y, labels, by, facet, size })
    }

    /// How far beside its place each line's markers stand over words, so that they do not hide each other: as a share of the axis.
    fn places(&self) -> Vec<f64> {
        let lines = self.curves.lines.len();
        let apart = (0.5 / self.x.ticks().max(1) as f64 / lines as f64).min(0.015);
        (0..lines).map(|line| apart * (line as f64 - (lines - 1) as f64 / 2.0)).collect()
    }

    fn draw_legend<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>, by: &str) -> Drawn<DB> {
        let draw = |text: &str, (x, y): (i32, i32)| {
            let (text, font) = chart::fitted(area, text, TEXT, LEGEND - x as u32 - 4)?;
            area.draw_text(&text, &font, (x, y))
        };
        draw(by, (8, 4))?;
        for (index, name) in self.curves.lines.iter().enumerate() {
            let y = 4 + LEGEND_LINE * (index as i32 + 1);
            let middle = y + LEGEND_LINE / 2 - 4;
            area.draw(&PathElement::new([(8, middle), (40, middle)], color_of(index).stroke_width(2)))?;
            area.draw(&(EmptyElement::at((24, middle)) + marker(index)))?;
            draw(name, (48, y))?;
        }
        Ok(())
    }

    /// What the ticks of the horizontal axis are called, which is so many pixels long: words as far as there is room for them, and as
    /// many of the numbers as stand side by side.
    fn x_names<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        axis: i32,
    ) -> Result<Vec<(f64, String)>, DrawingAreaErrorKind<DB::ErrorType>> {
        let mut names = Vec::new();
        let mut taken = i32::MIN;
        for tick in self.x.key_points(self.x.ticks()) {
            let name = self.x.name_of(tick);
            if self.x.has_words() {
                let room = (axis / self.x.ticks().max(1) as i32 - GAP).max(0) as u32;
                names.push((tick, chart::fitted(area, &name, NUMBERS, room)?.0));
                continue;
            }
            let (at, half) =
                (self.x.map(&tick, (0, axis)), area.estimate_text_size(&name, &font(NUMBERS))?.0 as i32 / 2);
            if at - half >= taken {
                taken = at + half + GAP;
                names.push((tick, name));
            }
        }
        Ok(names)
    }
}

impl Figure for Chart<'_> {
    fn size(&self) -> (u32, u32) {
        self.size
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let below = &chart::panels(area, &self.caption, &self.what, &[], 1)?[0];
        let (width, _) = below.dim_in_pixel();
        let (left, right) = below.split_horizontally(width.saturating_sub(if self.by.is_some() { LEGEND } else { 0 }));
        let count = self.curves.panels.len();
        let (plots, foot) = left.split_vertically(left.dim_in_pixel().1.saturating_sub(FOOT));
        for (index, (area, panel)) in plots.split_evenly((count, 1)).iter().zip(&self.curves.panels).enumerate() {
            self.draw_panel(area, panel, index + 1 == count)?;
        }
        let width = left.dim_in_pixel().0;
        let (label, font) = chart::fitted(&foot, &self.labels[0], TEXT, width.saturating_sub(LEFT))?;
        let style = font.pos(Pos::new(HPos::Center, VPos::Center));
        foot.draw_text(&label, &style, (((LEFT + width) / 2) as i32, FOOT as i32 / 2))?;
        self.by.map_or(Ok(()), |by| self.draw_legend(&right, by))
    }
}

impl Chart<'_> {
    fn draw_panel<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>, panel: &Panel, is_last: bool) -> Drawn<DB> {
        let name = self.facet.map(|facet| format!("{} {}", without_unit(facet), panel.name)).unwrap_or_default();
        let (width, height) = area.dim_in_pixel();
        let last = self.x.key_points(self.x.ticks()).last().map(|tick| self.x.name_of(*tick));
        let right = chart::right(area, last.as_deref().filter(|_| !self.x.has_words()).unwrap_or_default(), NUMBERS);
        let names = self.x_names(area, width.saturating_sub(MARGIN + LEFT + right) as i32)?;
        let (name, _) = chart::fitted(area, &name, TEXT, width.saturating_sub(LEFT))?;
        let mut builder = chart::builder(area, &name, true, &(0.0..1.0));
        builder.margin_left(MARGIN).margin_right(right).y_label_area_size(LEFT).x_label_area_size(TICKS);
        let mut chart = builder.build_cartesian_2d(self.x.clone(), self.y.clone())?;
        let mut mesh = chart.configure_mesh();
        let x_name = |tick: &f64| {
            let name = names.iter().find(|(named, _)| is_last && named == tick);
            name.map(|(_, name)| name.clone()).unwrap_or_default()
        };
        let y_name = |tick: &f64| self.y.name_of(*tick);
        mesh.x_label_formatter(&x_name).y_label_formatter(&y_name).max_light_lines(1);
        let (along, font_along) = chart::fitted(area, &self.labels[1], TEXT, height.saturating_sub(TICKS))?;
        mesh.label_style(font(NUMBERS)).axis_desc_style(font_along).y_desc(along).draw()?;
        for (index, spots) in panel.lines.iter().enumerate() {
            // Words have nothing between them that a line could lead through.
            let place = if self.x.has_words() { self.places()[index] } else { 0.0 };
            if !self.x.has_words() {
                chart.draw_series(LineSeries::new(spots.iter().copied(), color_of(index).stroke_width(2)))?;
            }
            let at = |&(x, y): &Spot| EmptyElement::at((self.x.beside(x, place), y));
            chart.draw_series(spots.iter().map(|spot| at(spot) + marker(index)))?;
        }
        Ok(())
    }
}

/// What has to be known to read the curves.
fn remarks(curves: &Curves) -> String {
    match curves.left_out {
        0 => String::new(),
        1 => "1 point that failed is left out".to_owned(),
        count => format!("{count} points that failed are left out"),
    }
}

fn color_of(line: usize) -> RGBColor {
    rgb(palette::LINES[line % palette::LINES.len()])
}

/// A line's marker: together with the colour it is no other's.
fn marker(line: usize) -> Polygon<(i32, i32)> {
    const _: () = assert!(palette::LINES.len() % 2 == 1);
    let shape: &[(i32, i32)] = match line % 4 {
        0 => &[(-2, -5), (2, -5), (5, -2), (5, 2), (2, 5), (-2, 5), (-5, 2), (-5, -2)],
        1 => &[(-4, -4), (4, -4), (4, 4), (-4, 4)],
        2 => &[(0, -6), (5, 4), (-5, 4)],
        _ => &[(0, -6), (6, 0), (0, 6), (-6, 0)],
    };
    Polygon::new(shape, color_of(line).filled())
}

/// A column's label without the unit in brackets.
fn without_unit(label: &str) -> &str {
    label.split(" (").next().unwrap_or(label)
}
