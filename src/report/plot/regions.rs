//! A hypercube's regions: where the work is that they share, and where they send rays.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Caption;
use super::chart::{self, font, rgb};
use super::render::{Drawn, Figure};
use crate::geometry::regions;
use crate::host::camera::ImageSize;
use crate::measure::LinkStats;
use crate::report::palette::{self, Rgb};
use crate::report::summary::grouped;

/// The regions of a run.
#[derive(Clone, Copy, Debug)]
pub struct RegionMap<'a> {
    /// Cells along each side of the plane, and each one's work on the sample.
    pub cells: ([u32; 2], &'a [u64]),
    /// Each region's rectangle of cells.
    pub rectangles: &'a [regions::Rectangle],
    /// Each region's node.
    pub node_of: &'a [u16],
    /// Rays that each node sent to each, row by row.
    pub sent: &'a [u64],
    /// The image's size, and the node that each pixel belongs to, line by line.
    pub owners: (ImageSize, &'a [u16]),
    /// The links: those out of node 0 by bit, those out of node 1, ..., from the host, to the host.
    pub links: &'a [LinkStats],
}

/// The plane of cells with its regions, and the rays between nodes.
pub struct Regions<'a> {
    pub caption: &'a Caption,
    pub map: RegionMap<'a>,
}

/// Side of each of the two, in pixels, at the most.
const SIDE: i32 = 540;
/// Around them.
const EDGE: i32 = 48;

impl Figure for Regions<'_> {
    fn size(&self) -> (u32, u32) {
        (chart::WIDTH, chart::HEAD + (SIDE + 2 * EDGE) as u32)
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let (work, sent) = (self.map.cells.1, self.map.sent);
        let (all, most) = (work.iter().sum::<u64>(), work.iter().max().copied().unwrap_or(0));
        let share = 100.0 * most as f64 / all.max(1) as f64;
        let told = [
            (format!("sampled work of a cell, by its root: at the most {share:.2} % of all"), palette::AMOUNT),
            (
                format!(
                    "rays from a node to another: at the most {}",
                    grouped(sent.iter().max().copied().unwrap_or(0))
                ),
                palette::ANSWER,
            ),
        ];
        let legend: Vec<(&str, Rgb)> = told.iter().map(|(told, color)| (told.as_str(), *color)).collect();
        chart::head(area, self.caption, "Regions, and the rays between them", &legend)?;
        let (_, below) = area.split_vertically(chart::HEAD);
        self.draw_plane(&below)?;
        self.draw_rays(&below)
    }
}

impl Regions<'_> {
    fn draw_plane<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let RegionMap { cells: ([across, down], work), rectangles, node_of, .. } = self.map;
        let side = f64::from(SIDE) / f64::from(across.max(down).max(1));
        // What is high along the second axis is high in the picture.
        let at = |[x, y]: [u32; 2]| {
            (
                EDGE + (f64::from(x) * side).round() as i32,
                EDGE / 2 + (f64::from(down - y.min(down)) * side).round() as i32,
            )
        };
        let most = work.iter().max().copied().unwrap_or(0);
        for (cell, &amount) in work.iter().enumerate().filter(|(_, amount)| **amount > 0) {
            let (x, y) = (cell as u32 % across, cell as u32 / across);
            area.draw(&Rectangle::new(
                [at([x, y + 1]), at([x + 1, y])],
                shade(palette::AMOUNT, amount, most).filled(),
            ))?;
        }
        for (regions::Rectangle { low, high }, node) in rectangles.iter().zip(node_of) {
            let (top, foot) = (at([low[0], high[1]]), at([high[0], low[1]]));
            area.draw(&Rectangle::new([top, foot], BLACK))?;
            if foot.0 - top.0 >= 24 && foot.1 - top.1 >= 18 {
                let label = node.to_string();
                let (width, height) = area.estimate_text_size(&label, &font(chart::SMALL))?;
                let middle = ((top.0 + foot.0 - width as i32) / 2, (top.1 + foot.1 - height as i32) / 2);
                let back = [(middle.0 - 2, middle.1 - 1), (middle.0 + width as i32 + 2, middle.1 + height as i32 + 1)];
                area.draw(&Rectangle::new(back, WHITE.mix(0.7).filled()))?;
                area.draw_text(&label, &font(chart::SMALL), middle)?;
            }
        }
        area.draw_text("the plane of cells, and each region's node", &font(16), (EDGE, SIDE + EDGE))
    }

    fn draw_rays<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let nodes = self.map.node_of.len().max(1);
        let (left, top) = (EDGE + SIDE + 2 * EDGE, EDGE / 2);
        let at = |place: usize| (place as f64 * f64::from(SIDE) / nodes as f64).round() as i32;
        let most = self.map.sent.iter().max().copied().unwrap_or(0);
        for (pair, &rays) in self.map.sent.iter().enumerate().filter(|(_, rays)| **rays > 0) {
            let (from, to) = (pair / nodes, pair % nodes);
            let corners = [(left + at(to), top + at(from)), (left + at(to + 1), top + at(from + 1))];
            area.draw(&Rectangle::new(corners, shade(palette::ANSWER, rays, most).filled()))?;
        }
        area.draw(&Rectangle::new([(left, top), (left + SIDE, top + SIDE)], BLACK))?;
        let step = nodes.div_ceil(16);
        for node in (0..nodes).step_by(step) {
            area.draw_text(&node.to_string(), &font(chart::SMALL), (left - 26, top + at(node)))?;
            area.draw_text(&node.to_string(), &font(chart::SMALL), (left + at(node), top + SIDE + 2))?;
        }
        area.draw_text("rays sent: from the node of the row to that of the column", &font(16), (left, SIDE + EDGE))
    }
}

/// White for nothing, the colour for the most, by the root in between.
pub(super) fn shade(color: Rgb, amount: u64, most: u64) -> RGBColor {
    let share = (amount as f64 / most.max(1) as f64).sqrt();
    let mixed = |channel: u8| (255.0 - share * (255.0 - f64::from(channel))).round() as u8;
    rgb(Rgb(mixed(color.0), mixed(color.1), mixed(color.2)))
}
