//! Cutting the scene into sub-volumes, one a group of cells (§4.2).

use std::str::FromStr;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::bounds::Bounds;
use super::polygon::{Polygons, flat_bounds, hit_bounds};
use super::ray::Ray;

/// How the scene is cut into sub-volumes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Partition {
    /// Equal boxes, as cubic as their number allows.
    #[default]
    Regular,
    /// Boxes with equal numbers of polygons.
    Polygons,
    /// Boxes with equal work, measured on a sub-sample of the rays (§4.1) in one cell that has the whole scene.
    Work,
    /// The same, then measured in the groups themselves, and cut again as long as that helps the one that works the most.
    Measured,
}

impl FromStr for Partition {
    type Err = String;

    fn from_str(name: &str) -> Result<Partition, String> {
        match name {
            "regular" => Ok(Partition::Regular),
            "polygons" => Ok(Partition::Polygons),
            "work" => Ok(Partition::Work),
            "measured" => Ok(Partition::Measured),
            _ => Err(format!("there is no partition '{name}'; there are: regular, polygons, work, measured")),
        }
    }
}

impl std::fmt::Display for Partition {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Partition::Regular => "regular",
            Partition::Polygons => "polygons",
            Partition::Work => "work",
            Partition::Measured => "measured",
        })
    }
}

/// In which order the sub-volumes of a cut are dealt out to the groups, from left to right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Numbering {
    /// As the cut comes upon them.
    #[default]
    Cut,
    /// As rays do, those first that are in front of others.
    Front,
}

/// A point of the scene and its share of what is to be divided equally.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight {
    /// Where.
    pub at: DVec3,
    /// How much.
    pub amount: f64,
}

/// One sub-volume.
#[derive(Clone, Debug, PartialEq)]
pub struct SubVolume {
    /// Its box. The boxes of a partition fill the scene's.
    pub volume: Bounds,
    /// The polygons that reach into it, in rising order. A polygon on a cut is in both sides.
    pub members: Vec<u32>,
}

/// The part of space that some polygons reach: outside it no ray hits them.
pub fn reached(polygons: &Polygons, members: &[u32]) -> Bounds {
    let hit = |&&p: &&u32| polygons.can_be_hit(p);
    let all = members.iter().filter(hit).map(|&p| hit_bounds(polygons, p)).fold(Bounds::EMPTY, Bounds::union);
    if all.is_empty() { all } else { all.grown(polygons.margin()) }
}

/// Equal boxes: `count` is split into factors along the axes so that they are as cubic as can be.
pub fn regular(volume: Bounds, count: usize) -> Vec<Bounds> {
    let extent = volume.extent();
    let longest_edge = |size: [usize; 3]| (0..3).map(|axis| extent[axis] / size[axis] as f64).fold(0.0, f64::max);
    let size = factorings(count).min_by(|a, b| longest_edge(*a).total_cmp(&longest_edge(*b))).unwrap_or([count, 1, 1]);
    let edge = |axis: usize, n: usize| match n {
        n if n == size[axis] => volume.high[axis],
        n => volume.low[axis] + extent[axis] * n as f64 / size[axis] as f64,
    };
    let corner = |at: [usize; 3]| DVec3::new(edge(0, at[0]), edge(1, at[1]), edge(2, at[2]));
    let cells = (0..count).map(|n| [n % size[0], n / size[0] % size[1], n / size[0] / size[1]]);
    cells.map(|at| Bounds { low: corner(at), high: corner(at.map(|n| n + 1)) }).collect()
}

/// All ways to write a number as a product of three.
fn factorings(count: usize) -> impl Iterator<Item = [usize; 3]> {
    let divisors = move |n: usize| (1..=n).filter(move |d| n.is_multiple_of(*d));
    divisors(count).flat_map(move |x| divisors(count / x).map(move |y| [x, y, count / x / y]))
}

/// Boxes of equal weight: the volume is cut in two across its longest side where the weight divides as the numbers of
/// boxes on either side do, and so on with the halves.
pub fn weighted(volume: Bounds, weights: &mut [Weight], count: usize) -> Vec<Bounds> {
    if count <= 1 {
        return vec![volume];
    }
    let extent = volume.extent();
    let axis = (0..3).fold(0, |longest, axis| if extent[axis] > extent[longest] { axis } else { longest });
    weights.sort_by(|a, b| a.at[axis].total_cmp(&b.at[axis]));
    let left_count = count / 2;
    let share = left_count as f64 / count as f64;
    let at = cut_at(weights, axis, share)
        .filter(|at| *at > volume.low[axis] && *at < volume.high[axis])
        .unwrap_or(volume.low[axis] + extent[axis] * share);
    let (left, right) = volume.cut(axis, at);
    let split = weights.partition_point(|weight| weight.at[axis] <= at);
    let (left_weights, right_weights) = weights.split_at_mut(split);
    let mut boxes = weighted(left, left_weights, left_count);
    boxes.extend(weighted(right, right_weights, count - left_count));
    boxes
}

/// A coordinate between the sorted weights that make up the share and the others.
fn cut_at(weights: &[Weight], axis: usize, share: f64) -> Option<f64> {
    let total: f64 = weights.iter().map(|weight| weight.amount).sum();
    let mut sum = 0.0;
    let last = weights.iter().position(|weight| {
        sum += weight.amount;
        sum >= total * share
    })?;
    let next = weights.get(last + 1).unwrap_or(&weights[last]);
    Some((weights[last].at[axis] + next.at[axis]) / 2.0)
}

/// Numbers boxes from front to back: by how many others a ray has been in before it reaches them, on average over the rays that do.
pub fn front_to_back(boxes: Vec<Bounds>, rays: &[Ray]) -> Vec<Bounds> {
    let mut before = vec![0; boxes.len()];
    let mut reached = vec![0; boxes.len()];
    for ray in rays {
        let enters = |(index, volume): (usize, &Bounds)| Some((volume.entered_by(ray)?, index));
        let mut met: Vec<(f64, usize)> = boxes.iter().enumerate().filter_map(enters).collect();
        met.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (place, (_, index)) in met.into_iter().enumerate() {
            before[index] += place;
            reached[index] += 1;
        }
    }
    let mean = |index: usize| before[index] as f64 / reached[index].max(1) as f64;
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&a, &b| mean(a).total_cmp(&mean(b)));
    order.into_iter().map(|index| boxes[index]).collect()
}

/// Every polygon's middle, with weight 1.
pub fn polygon_weights(polygons: &Polygons) -> Vec<Weight> {
    let middle = |polygon| {
        let bounds = flat_bounds(polygons, polygon);
        (bounds.low + bounds.high) / 2.0
    };
    (0..polygons.len() as u32).map(|polygon| Weight { at: middle(polygon), amount: 1.0 }).collect()
}

/// Finds the members of each box.
pub fn assign(polygons: &Polygons, boxes: &[Bounds]) -> Vec<SubVolume> {
    let margin = polygons.margin();
    let mut volumes: Vec<SubVolume> = boxes.iter().map(|&volume| SubVolume { volume, members: Vec::new() }).collect();
    for polygon in 0..polygons.len() as u32 {
        let reach = hit_bounds(polygons, polygon).grown(margin);
        for sub_volume in &mut volumes {
            if !reach.intersection(sub_volume.volume).is_empty() {
                sub_volume.members.push(polygon);
            }
        }
    }
    volumes
}
