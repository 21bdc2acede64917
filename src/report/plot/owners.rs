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
/// A node whose pixels are one in so many of all, or more, has its number on them.
const NAMED: usize = 100;

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
    /// The numbers of nodes, in the middle of their pixels.
    fn numbers<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>, (width, scale): (u32, f64)) -> Drawn<DB> {
        let owners = self.map.owners.1;
        for node in 0..self.map.node_of.len() as u16 {
            let own = owners.iter().enumerate().filter(|(_, owner)| **owner == node);
            let (mut count, mut sums) = (0usize, [0.0f64; 2]);
            for (pixel, _) in own {
                count += 1;
                sums[0] += (pixel as u32 % width) as f64;
                sums[1] += (pixel as u32 / width) as f64;
            }
            if count > 0 && count * NAMED >= owners.len() {
                let [x, y] = sums.map(|sum| (sum / count as f64 * scale).round() as i32);
                area.draw_text(&node.to_string(), &font(chart::SMALL), (EDGE + x - 6, y - 8))?;
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
