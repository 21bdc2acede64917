//! A hypercube's nodes as nested squares, and the use of its links.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::Caption;
use super::chart::{self, font};
use super::regions::{RegionMap, shade};
use super::render::{Drawn, Figure};
use crate::measure::{Profile, StateTimes};
use crate::report::palette::{self, Rgb};

/// The nodes and their links.
pub struct Links<'a> {
    pub caption: &'a Caption,
    pub map: RegionMap<'a>,
    pub profile: &'a Profile,
}

/// The longer side of the cube, in pixels of the picture.
const SIDE: f64 = 640.0;
/// Around it.
const EDGE: i32 = 48;
/// Between nodes, as a part of one, for each dimension of the same direction before.
const GAP: f64 = 0.6;
/// How far links bend aside, as a part of their length.
const BEND: f64 = 0.12;

impl Figure for Links<'_> {
    fn size(&self) -> (u32, u32) {
        (chart::WIDTH, chart::HEAD + SIDE as u32 + 2 * EDGE as u32)
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let cycles = self.profile.cycles.0;
        let most = self.map.links.iter().map(|link| link.busy.0).max().unwrap_or(0);
        let share = 100.0 * most as f64 / cycles.max(1) as f64;
        let told = [
            (format!("a link's use, by its root: at the most {share:.2} % of the time"), palette::ANSWER),
            ("a node's computing: all of the time".to_owned(), palette::AMOUNT),
        ];
        let legend: Vec<(&str, Rgb)> = told.iter().map(|(told, color)| (told.as_str(), *color)).collect();
        chart::head(area, self.caption, "The hypercube's links", &legend)?;
        let (_, below) = area.split_vertically(chart::HEAD);
        let nodes = self.map.node_of.len();
        let bits = nodes.next_power_of_two().ilog2() as usize;
        let ends: Vec<(f64, f64)> = (0..nodes).map(place).collect();
        let far = ends.iter().fold(1.0, |far: f64, (x, y)| far.max(x + 1.0).max(y + 1.0));
        let scale = SIDE / far;
        let at = |(x, y): (f64, f64)| (EDGE + (x * scale).round() as i32, EDGE / 2 + (y * scale).round() as i32);
        for (node, bit) in (0..nodes).flat_map(|node| (0..bits).map(move |bit| (node, bit))) {
            let other = node ^ 1 << bit;
            let used = self.map.links.get(node * bits + bit).map_or(0, |link| link.busy.0);
            if other < nodes {
                let bow = bow(ends[node], ends[other]).map(at);
                below.draw(&PathElement::new(
                    bow.collect::<Vec<_>>(),
                    shade(palette::ANSWER, used, most).stroke_width(2),
                ))?;
            }
        }
        for (node, &(x, y)) in ends.iter().enumerate() {
            let times = StateTimes::sum(&self.profile.stations[node]);
            let works = self.profile.topology.states.works(&times).0;
            let corners = [at((x + 0.2, y + 0.2)), at((x + 0.8, y + 0.8))];
            below.draw(&Rectangle::new(corners, WHITE.filled()))?;
            below.draw(&Rectangle::new(
                corners,
                shade(palette::AMOUNT, works * works / cycles.max(1), cycles).filled(),
            ))?;
            below.draw(&Rectangle::new(corners, BLACK))?;
            below.draw_text(&node.to_string(), &font(chart::SMALL), (corners[0].0 + 3, corners[0].1 + 1))?;
        }
        Ok(())
    }
}

/// Where a node is: of its bits each second one leads to the right, the others down, each past all that those before it span, and a
/// little more.
fn place(node: usize) -> (f64, f64) {
    let along = |first: usize| {
        let (mut at, mut span) = (0.0, 1.0);
        for (step, bit) in (first..usize::BITS as usize).step_by(2).enumerate() {
            let over = span + GAP * step as f64;
            at += if node >> bit & 1 == 1 { over } else { 0.0 };
            span += over;
        }
        at
    };
    (along(0), along(1))
}

/// A link from the middle of a node to that of another, bent to the left, so that those of both directions lie side by side.
fn bow(from: (f64, f64), to: (f64, f64)) -> impl Iterator<Item = (f64, f64)> {
    const STEPS: u32 = 12;
    let middle = |(x, y): (f64, f64)| (x + 0.5, y + 0.5);
    let ((x, y), (to_x, to_y)) = (middle(from), middle(to));
    (0..=STEPS).map(move |step| {
        let t = f64::from(step) / f64::from(STEPS);
        let aside = 4.0 * BEND * t * (1.0 - t);
        let (across, down) = (to_x - x, to_y - y);
        (x + t * across + aside * down, y + t * down - aside * across)
    })
}
