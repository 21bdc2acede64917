//! Drawing lines with markers.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Axes;
use super::series::{Curves, Line, Spot};
use crate::report::palette;
use crate::report::plot::Caption;
use crate::report::plot::chart::{self, font, rgb};
use crate::report::plot::render::{Drawn, Figure};
use crate::report::plot::scale::Scale;
use crate::report::table::Column;

/// Height of the figure, in panels of the others.
const PANELS: usize = 4;
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
}

impl<'a> Chart<'a> {
    pub fn new(columns: &[Column<'a>], axes: &Axes, curves: &'a Curves, what_ran: &str) -> Chart<'a> {
        let x = Scale::of_positions(&curves.x);
        let y = Scale::of_values(curves.spots().flat_map(|spot| [spot.low, spot.high]));
        let label = |column: usize, scale: &Scale| {
            let logarithmic = if scale.is_log() { ", logarithmic" } else { "" };
            format!("{}{logarithmic}", columns[column].label)
        };
        let labels = [label(axes.x, &x), label(axes.y, &y)];
        let by = axes.by.map(|by| columns[by].label);
        let by_what = by.map(|by| format!(", by {}", without_unit(by))).unwrap_or_default();
        let mut what =
            format!("{} over {}{by_what}", without_unit(columns[axes.y].label), without_unit(columns[axes.x].label));
        if let Some(first) = what.get_mut(..1) {
            first.make_ascii_uppercase();
        }
        let caption = Caption { title: cut(what_ran, CAPTION_LETTERS), machine: remarks(curves) };
        Chart { curves, what: cut(&what, 110), caption, x, y, labels, by }
    }

    /// How far beside its place each line's bars stand, so that they do not hide each other: as a share of the axis.
    fn places(&self) -> Vec<f64> {
        let lines = self.curves.lines.len();
        // Numbers' bars stay behind their markers where there are few.
        let (width, most) = if self.x.has_words() { (0.5 / self.x.ticks() as f64, 0.015) } else { (0.04, 0.004) };
        let apart = (width / lines as f64).min(most);
        (0..lines).map(|line| apart * (line as f64 - (lines - 1) as f64 / 2.0)).collect()
    }

    fn draw_legend<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>, by: &str) -> Drawn<DB> {
        area.draw_text(&cut(by, LEGEND_LETTERS), &font(14), (8, 4))?;
        for (index, line) in self.curves.lines.iter().enumerate() {
            let y = 4 + LEGEND_LINE * (index as i32 + 1);
            let middle = y + LEGEND_LINE / 2 - 4;
            area.draw(&PathElement::new([(8, middle), (40, middle)], color_of(index).stroke_width(2)))?;
            area.draw(&(EmptyElement::at((24, middle)) + marker(index)))?;
            area.draw_text(&cut(&line.name, LEGEND_LETTERS), &font(14), (48, y))?;
        }
        Ok(())
    }
}

impl Figure for Chart<'_> {
    fn size(&self) -> (u32, u32) {
        chart::size(PANELS)
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let panel = &chart::panels(area, &self.caption, &self.what, &[], 1)?[0];
        let (width, _) = panel.dim_in_pixel();
        let (left, right) = panel.split_horizontally(width - if self.by.is_some() { LEGEND } else { 0 });
        let mut builder = chart::builder(&left, "", true);
        builder.margin_left(12).y_label_area_size(LEFT);
        let mut chart = builder.build_cartesian_2d(self.x.clone(), self.y.clone())?;
        let mut mesh = chart.configure_mesh();
        let letters = (AXIS_LETTERS / self.x.ticks().max(1)).max(4);
        let (x_name, y_name) = (|tick: &f64| cut(&self.x.name_of(*tick), letters), |tick: &f64| self.y.name_of(*tick));
        mesh.x_label_formatter(&x_name).y_label_formatter(&y_name).max_light_lines(1);
        mesh.label_style(font(13)).axis_desc_style(font(14));
        mesh.x_desc(&self.labels[0]).y_desc(&self.labels[1]).draw()?;
        let places = self.places();
        let bar = |at, spot: &Spot, color: RGBColor| {
            PathElement::new([(at, spot.low), (at, spot.high)], color.mix(0.45).stroke_width(2))
        };
        for (index, Line { spots, .. }) in self.curves.lines.iter().enumerate() {
            let spread = spots.iter().filter(|spot| spot.low < spot.high);
            chart.draw_series(spread.map(|spot| bar(self.x.beside(spot.x, places[index]), spot, color_of(index))))?;
        }
        for (index, Line { spots, .. }) in self.curves.lines.iter().enumerate() {
            // Words have nothing between them that a line could lead through.
            let place = if self.x.has_words() { places[index] } else { 0.0 };
            if !self.x.has_words() {
                let line = spots.iter().map(|spot| (spot.x, spot.mean));
                chart.draw_series(LineSeries::new(line, color_of(index).stroke_width(2)))?;
            }
            let at = |spot: &Spot| EmptyElement::at((self.x.beside(spot.x, place), spot.mean));
            chart.draw_series(spots.iter().map(|spot| at(spot) + marker(index)))?;
        }
        self.by.map_or(Ok(()), |by| self.draw_legend(&right, by))
    }
}

/// What has to be known to read the curves.
fn remarks(curves: &Curves) -> String {
    let spread = "points are means over the other parameters, bars go from the least to the most";
    let left_out = match curves.left_out {
        0 => None,
        1 => Some("1 point that failed is left out".to_owned()),
        count => Some(format!("{count} points that failed are left out")),
    };
    let spread = curves.has_spread.then(|| spread.to_owned());
    spread.into_iter().chain(left_out).collect::<Vec<_>>().join("; ")
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
