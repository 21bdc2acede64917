//! Which pixels of a picture can show anything, by the rectangles of what is before the eye (Argence's thesis, chapter 2): through the
//! others the host sends no rays from the eye, as they could hit nothing.
//!
//! What stands behind unions alone needs no more than its rectangle, and scenes are evaluated to polygons before: so the thesis's lists of
//! rectangles with sub-trees come down to a union of rectangles here, line by line.

use std::collections::HashMap;

use bitvec::vec::BitVec;
use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::camera::{ImageSize, half_extent};
use crate::geometry::partition::reached;
use crate::geometry::{Eye, Polygons};
use crate::scene::{Object, Scene};

/// Of what there are rectangles on the screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum ScreenRectangles {
    /// Of nothing: every ray is sent.
    #[default]
    Off,
    /// One of the whole scene.
    Scene,
    /// One of each object.
    Objects,
}

/// A rectangle on a picture, in pixels from its top left corner; it may reach beyond the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelRectangle {
    /// Its upper left corner.
    pub low: DVec2,
    /// Its lower right one.
    pub high: DVec2,
}

impl PixelRectangle {
    /// The columns and lines of the picture's pixels that it reaches into.
    pub fn pixels(&self, size: ImageSize) -> [std::ops::Range<u32>; 2] {
        let within = |low: f64, high: f64, count: u32| {
            // `as` takes what is out of range, and what is no number, to the nearest end.
            let (first, end) = (low.floor().max(0.0) as u32, high.ceil().clamp(0.0, f64::from(count)) as u32);
            first.min(end)..end
        };
        [within(self.low.x, self.high.x, size.width), within(self.low.y, self.high.y, size.height)]
    }

    /// Whether it is less than a pixel wide and high.
    pub fn is_small(&self) -> bool {
        (self.high - self.low).cmplt(DVec2::ONE).all()
    }
}

/// The rectangles of a scene, or of each of its objects.
pub fn rectangles(scene: &Scene, polygons: &Polygons, size: ImageSize, of: ScreenRectangles) -> Vec<PixelRectangle> {
    let all = || (0..polygons.len() as u32).collect::<Vec<u32>>();
    let parts = match of {
        ScreenRectangles::Off => Vec::new(),
        ScreenRectangles::Scene => vec![all()],
        ScreenRectangles::Objects => by_object(scene, all()),
    };
    let eye = Eye::of(&scene.camera);
    let half = half_extent(&scene.camera, size);
    // Rays through the corners of the picture are off by the most.
    let off = Eye::rounding_at(half);
    let strayed = f64::from(polygons.beyond_margin(eye.at));
    let scale = DVec2::new(f64::from(size.width), f64::from(size.height)) / 2.0;
    let on_picture = |members: Vec<u32>| {
        let bounds = reached(polygons, &members);
        let seen = eye.rectangle(if bounds.is_empty() { bounds } else { bounds.grown(strayed) });
        let (low, high) = ((seen.low - off) / half, (seen.high + off) / half);
        // Lines are counted downwards.
        let flipped = |x: f64, y: f64| DVec2::new((x + 1.0) * scale.x, (1.0 - y) * scale.y);
        PixelRectangle { low: flipped(low.x, high.y), high: flipped(high.x, low.y) }
    };
    parts.into_iter().map(on_picture).collect()
}

/// Polygons by the objects that they belong to, in the order in which the objects come first.
fn by_object(scene: &Scene, polygons: Vec<u32>) -> Vec<Vec<u32>> {
    let mut places: HashMap<Object, usize> = HashMap::new();
    let mut parts: Vec<Vec<u32>> = Vec::new();
    for polygon in polygons {
        let object = scene.mesh.object(&scene.mesh.faces()[polygon as usize]);
        let place = *places.entry(object).or_insert(parts.len());
        if place == parts.len() {
            parts.push(Vec::new());
        }
        parts[place].push(polygon);
    }
    parts
}

/// The pixels of a picture that can show anything.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Screen {
    pixels: BitVec,
}

impl Screen {
    /// Those that some rectangle reaches into: a sweep from line to line, and along each.
    pub fn new(size: ImageSize, rectangles: &[PixelRectangle]) -> Screen {
        let (width, height) = (size.width as usize, size.height as usize);
        // For each line the rectangles that begin there, and those that end before it.
        let mut changes: Vec<Vec<(usize, i32)>> = vec![Vec::new(); height + 1];
        for rectangle in rectangles {
            let [columns, lines] = rectangle.pixels(size);
            for (line, change) in [(lines.start, 1), (lines.end, -1)] {
                changes[line as usize].extend([(columns.start as usize, change), (columns.end as usize, -change)]);
            }
        }
        let mut pixels = BitVec::repeat(false, width * height);
        let mut active = vec![0i32; width + 1];
        for (line, changes) in changes[..height].iter().enumerate() {
            changes.iter().for_each(|&(column, change)| active[column] += change);
            let mut open = 0;
            for (column, change) in active[..width].iter().enumerate() {
                open += change;
                if open > 0 {
                    pixels.set(line * width + column, true);
                }
            }
        }
        Screen { pixels }
    }

    /// Whether a pixel can show anything.
    pub fn shows(&self, pixel: usize) -> bool {
        self.pixels[pixel]
    }

    /// How many can.
    pub fn count(&self) -> usize {
        self.pixels.count_ones()
    }
}
