//! Whose pixels they are, on a hypercube whose nodes have a region each.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Caption;
use super::chart::{self, font};
use super::regions::RegionMap;
use super::render::{Drawn, Figure};

/// The image, its pixels coloured by the nodes that they belong to.
pub struct Owners<'a> {
    pub caption: &'a Caption,
    pub map: RegionMap<'a>,
}

/// The longer side of the image, in pixels of the picture.
const SIDE: u32 = 540;
/// Beside it.
const EDGE: i32 = 48;
/// A row of a node's pixels must be so long for its number.
const NAMED: f64 = 24.0;

impl Figure for Owners<'_> {
    fn size(&self) -> (u32, u32) {
        (chart::WIDTH, chart::HEAD + SIDE + EDGE as u32)
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        chart::head(
            area,
            self.caption,
            "Whose pixels they are: by colours, and the numbers of nodes that have many",
            &[],
        )?;
        let (_, below) = area.split_vertically(chart::HEAD);
        let (size, owners) = self.map.owners;
        let (width, height) = (size.width.max(1), size.height.max(1));
        let scale = f64::from(SIDE) / f64::from(width.max(height));
        let at = |x: u32, y: u32| (EDGE + (f64::from(x) * scale).round() as i32, (f64::from(y) * scale).round() as i32);
        let line_of = |y: u32| owners.iter().skip((y * width) as usize).take(width as usize);
        for y in 0..height {
            let line: Vec<u16> = line_of(y).copied().collect();
            let mut x = 0;
            for run in line.chunk_by(|a, b| a == b) {
                let end = x + run.len() as u32;
                below.draw(&Rectangle::new([at(x, y), at(end, y + 1)], color(run[0]).filled()))?;
                x = end;
            }
        }
        self.numbers(&below, (width, scale))
    }
}

impl Owners<'_> {
    /// The numbers of nodes, on the longest row of pixels that each has without another's.
    fn numbers<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>, (width, scale): (u32, f64)) -> Drawn<DB> {
        // For each node how many pixels that are, and where it begins.
        let mut longest = vec![(0usize, (0u32, 0u32)); self.map.node_of.len()];
        for (y, line) in (0u32..).zip(self.map.owners.1.chunks(width as usize)) {
            let mut x = 0;
            for run in line.chunk_by(|a, b| a == b) {
                if let Some(known) = longest.get_mut(usize::from(run[0])).filter(|known| known.0 < run.len()) {
                    *known = (run.len(), (x, y));
                }
                x += run.len() as u32;
            }
        }
        for (node, (count, (x, y))) in longest.into_iter().enumerate() {
            let middle = (f64::from(x) + count as f64 / 2.0) * scale;
            if count as f64 * scale >= NAMED {
                let at = (EDGE + middle.round() as i32 - 6, ((f64::from(y) + 0.5) * scale).round() as i32 - 8);
                area.draw_text(&node.to_string(), &font(chart::SMALL), at)?;
            }
        }
        Ok(())
    }
}

/// Colours of nodes whose numbers follow each other are far apart.
fn color(node: u16) -> RGBColor {
    let turn = f64::from(node) * 0.618_033_988_75;
    let lightness = [0.78, 0.66, 0.86][usize::from(node % 3)];
    let (red, green, blue) = HSLColor(turn.fract(), 0.45, lightness).to_backend_color().rgb;
    RGBColor(red, green, blue)
}
