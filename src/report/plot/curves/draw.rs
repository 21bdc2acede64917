//! Drawing lines with markers.

use plotters::coord::Shift;
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
/// Room for the numbers of the vertical axis and its name.
const LEFT: u32 = 104;
/// Characters that fit into a line of the caption, into one of the legend, and along the axis.
const CAPTION_LETTERS: usize = 160;
const LEGEND_LETTERS: usize = 30;
const AXIS_LETTERS: usize = 120;
const WHAT_LETTERS: usize = 110;
/// Width of a letter of an axis's name.
const LETTER: u32 = 7;
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
        let y_name =
            if relative.is_empty() { y_name.to_owned() } else { format!("{}, relative", without_unit(y_name)) };
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

    /// How many letters there is room for, of so many in a figure as wide as most.
    fn letters(&self, most: usize) -> usize {
        (most * self.size.0 as usize / chart::WIDTH as usize).max(8)
    }

    /// How far beside its place each line's markers stand over words, so that they do not hide each other: as a share of the axis.
    fn places(&self) -> Vec<f64> {
        let lines = self.curves.lines.len();
        let apart = (0.5 / self.x.ticks().max(1) as f64 / lines as f64).min(0.015);
        (0..lines).map(|line| apart * (line as f64 - (lines - 1) as f64 / 2.0)).collect()
    }

    fn draw_legend<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>, by: &str) -> Drawn<DB> {
        area.draw_text(&cut(by, LEGEND_LETTERS), &font(14), (8, 4))?;
        for (index, name) in self.curves.lines.iter().enumerate() {
            let y = 4 + LEGEND_LINE * (index as i32 + 1);
            let middle = y + LEGEND_LINE / 2 - 4;
            area.draw(&PathElement::new([(8, middle), (40, middle)], color_of(index).stroke_width(2)))?;
            area.draw(&(EmptyElement::at((24, middle)) + marker(index)))?;
            area.draw_text(&cut(name, LEGEND_LETTERS), &font(14), (48, y))?;
        }
        Ok(())
    }
}

impl Figure for Chart<'_> {
    fn size(&self) -> (u32, u32) {
        self.size
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let caption =
            Caption { title: cut(&self.caption.title, self.letters(CAPTION_LETTERS)), ..self.caption.clone() };
        let what = cut(&self.what, self.letters(WHAT_LETTERS));
        let below = &chart::panels(area, &caption, &what, &[], 1)?[0];
        let (width, _) = below.dim_in_pixel();
        let (left, right) = below.split_horizontally(width.saturating_sub(if self.by.is_some() { LEGEND } else { 0 }));
        let count = self.curves.panels.len();
        let (plots, foot) = left.split_vertically(left.dim_in_pixel().1.saturating_sub(FOOT));
        for (index, (area, panel)) in plots.split_evenly((count, 1)).iter().zip(&self.curves.panels).enumerate() {
            self.draw_panel(area, panel, index + 1 == count)?;
        }
        let middle = ((LEFT + left.dim_in_pixel().0) / 2) as i32;
        let style = font(14).pos(Pos::new(HPos::Center, VPos::Center));
        foot.draw_text(&self.labels[0], &style, (middle, FOOT as i32 / 2))?;
        self.by.map_or(Ok(()), |by| self.draw_legend(&right, by))
    }
}

impl Chart<'_> {
    fn draw_panel<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>, panel: &Panel, is_last: bool) -> Drawn<DB> {
        let name = self.facet.map(|facet| format!("{} {}", without_unit(facet), panel.name)).unwrap_or_default();
        let mut builder = chart::builder(area, &cut(&name, self.letters(AXIS_LETTERS)), true);
        builder.margin_left(12).y_label_area_size(LEFT).x_label_area_size(TICKS);
        let mut chart = builder.build_cartesian_2d(self.x.clone(), self.y.clone())?;
        let mut mesh = chart.configure_mesh();
        let letters = (self.letters(AXIS_LETTERS) / self.x.ticks().max(1)).max(4);
        let x_name = |tick: &f64| if is_last { cut(&self.x.name_of(*tick), letters) } else { String::new() };
        let y_name = |tick: &f64| self.y.name_of(*tick);
        mesh.x_label_formatter(&x_name).y_label_formatter(&y_name).max_light_lines(1);
        mesh.label_style(font(13)).axis_desc_style(font(14));
        let along = (area.dim_in_pixel().1.saturating_sub(TICKS) / LETTER) as usize;
        mesh.y_desc(cut(&self.labels[1], along.max(8))).draw()?;
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

/// Text that is not too long.
fn cut(text: &str, letters: usize) -> String {
    match text.char_indices().nth(letters) {
        None => text.to_owned(),
        Some(_) => text.chars().take(letters.saturating_sub(1)).chain(['…']).collect(),
    }
}
