//! The task graph of an image: what each ray makes the nodes do, recorded without a clock.

use super::messages::RAY_BYTES;
use crate::host::shading::RayKind;
use crate::machine::Cycles;
use crate::machine::KernelTimes;

/// The trees of all samples, as work in regions. It tells what is to be done and not when, so that machine, queues and mapping can be
/// changed without tracing a ray again.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TaskGraph {
    /// How many regions there are.
    pub regions: usize,
    /// All rays, tree by tree; in a tree, so that each one's children stand together behind it.
    pub rays: Vec<RayTask>,
    /// Their legs, ray by ray.
    pub legs: Vec<Leg>,
    /// The first ray of each tree. Trees have the numbers of their samples, pixel by pixel.
    pub trees: Vec<u32>,
    /// What each ray takes where all of the scene is one region, as one leg, if that is not what its legs add up to, as regions have
    /// grids of their own; else empty.
    pub in_one: Vec<Leg>,
    /// What each ray reads of a shared memory, if that was recorded.
    pub pages: Option<PageUses>,
    /// Whether a ray names the polygon that it starts on.
    pub names_own: bool,
}

/// A ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RayTask {
    /// Where its legs begin among all.
    pub first_leg: u32,
    /// The first of the rays that its hit asks for, and how many these are.
    pub children: (u32, u32),
    /// The tree that it is of.
    pub tree: u32,
    /// How many regions its line has met before it: the rest of a shadow ray behind a blocker has its line in common with it.
    pub hop: u16,
    /// How often light has turned on its way: each reflection and refraction, and the turn to a light.
    pub turns: u8,
    /// What it is for.
    pub kind: RayKind,
    /// Whether its hit is shaded.
    pub shaded: bool,
}

/// What a ray makes one region do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Leg {
    /// The region.
    pub region: u16,
    /// Voxels of it that the ray visits.
    pub voxels: u32,
    /// Polygons that are tested against slabs.
    pub slab_tests: u32,
    /// Polygons that are tested for intersection.
    pub intersection_tests: u32,
}

/// A leg, and whether its ray's hit is shaded in its region.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// The leg.
    pub leg: Leg,
    /// Whether the hit is shaded.
    pub shades: bool,
}

/// The pages that rays read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PageUses {
    /// How many pages the shared memory has.
    pub pages: u32,
    /// Bytes of a page.
    pub page_bytes: u32,
    /// The pages of all rays, ray by ray, each in the order in which the ray comes to it first, and how often it reads there.
    pub uses: Vec<(u32, u32)>,
    /// For each ray, where its pages end.
    pub ends: Vec<u32>,
}

/// What legs and rays take on a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WorkTimes {
    /// Those of the kernels.
    pub grid: Cycles,
    /// Of the slabs test.
    pub slabs: Cycles,
    /// Of the intersection test.
    pub intersection: Cycles,
    /// Of shading.
    pub shading: Cycles,
}

impl Leg {
    /// What it takes, without shading.
    #[inline]
    pub fn time(&self, times: &KernelTimes) -> WorkTimes {
        let started = |count: u32, kernel: crate::machine::Times| match count {
            0 => Cycles(0),
            count => Cycles(kernel.start.0 + u64::from(count) * kernel.each.0),
        };
        WorkTimes {
            grid: Cycles(times.grid.start.0 + u64::from(self.voxels) * times.grid.each.0),
            slabs: started(self.slab_tests, times.slabs),
            intersection: started(self.intersection_tests, times.intersection),
            shading: Cycles(0),
        }
    }

    /// Some legs as one, in the first region.
    pub fn sum(legs: &[Leg]) -> Leg {
        let sums = legs.iter().fold([0u64; 3], |[voxels, slab, intersection], leg| {
            [
                voxels + u64::from(leg.voxels),
                slab + u64::from(leg.slab_tests),
                intersection + u64::from(leg.intersection_tests),
            ]
        });
        let [voxels, slab_tests, intersection_tests] = sums.map(|sum| u32::try_from(sum).unwrap_or(u32::MAX));
        Leg { region: 0, voxels, slab_tests, intersection_tests }
    }
}

impl Share {
    /// What it takes.
    #[inline]
    pub fn time(&self, times: &KernelTimes) -> WorkTimes {
        let mut time = self.leg.time(times);
        if self.shades {
            time.shading = times.host.hit;
        }
        time
    }
}

impl WorkTimes {
    /// All of it.
    pub fn all(&self) -> Cycles {
        self.grid + self.slabs + self.intersection + self.shading
    }
}

impl PageUses {
    /// The pages that a ray reads.
    #[inline]
    pub fn of_ray(&self, ray: u32) -> &[(u32, u32)] {
        let start = (ray as usize).checked_sub(1).map_or(0, |before| self.ends[before] as usize);
        &self.uses[start..self.ends[ray as usize] as usize]
    }
}

/// Bytes of the name of a polygon.
const POLYGON_BYTES: u64 = 4;

impl TaskGraph {
    /// Bytes of a ray, as a message and in a slot.
    pub fn ray_bytes(&self) -> u64 {
        RAY_BYTES + if self.names_own { POLYGON_BYTES } else { 0 }
    }

    /// Where a ray's legs end among all.
    #[inline]
    pub fn legs_end(&self, ray: u32) -> u32 {
        self.rays.get(ray as usize + 1).map_or(self.legs.len() as u32, |next| next.first_leg)
    }

    /// A ray's legs.
    #[inline]
    pub fn legs_of(&self, ray: u32) -> &[Leg] {
        &self.legs[self.rays[ray as usize].first_leg as usize..self.legs_end(ray) as usize]
    }

    /// The rays of a tree, by their numbers.
    pub fn tree(&self, tree: usize) -> std::ops::Range<u32> {
        self.trees[tree]..self.trees.get(tree + 1).copied().unwrap_or(self.rays.len() as u32)
    }

    /// The region in which a ray starts.
    #[inline]
    pub fn start_of(&self, ray: u32) -> u16 {
        self.legs[self.rays[ray as usize].first_leg as usize].region
    }

    /// What a ray makes a region do in one of its legs, with the shading of its hit if that is the last.
    #[inline]
    pub fn share(&self, ray: u32, leg: u32) -> Share {
        let shades = self.rays[ray as usize].shaded & (leg + 1 == self.legs_end(ray));
        Share { leg: self.legs[leg as usize], shades }
    }

    /// What a leg takes, with the shading of its ray's hit if it is the last.
    pub fn time(&self, ray: u32, leg: u32, times: &KernelTimes) -> WorkTimes {
        self.share(ray, leg).time(times)
    }

    /// What a ray takes where all of the scene is one region.
    pub fn time_in_one(&self, ray: u32, times: &KernelTimes) -> WorkTimes {
        let whole = self.in_one(ray);
        let shading = if self.rays[ray as usize].shaded { times.host.hit } else { Cycles(0) };
        WorkTimes { shading, ..whole.time(times) }
    }

    /// What a ray does there, as one leg.
    pub(super) fn in_one(&self, ray: u32) -> Leg {
        self.in_one.get(ray as usize).copied().unwrap_or_else(|| Leg::sum(self.legs_of(ray)))
    }

    /// Tells what is wrong with a graph that was read from a file: nothing in it may lead out of it.
    pub fn check(&self) -> Result<(), String> {
        let count = self.rays.len() as u32;
        let rises = |numbers: &[u32], end: u32| {
            numbers.first().is_none_or(|&first| first == 0)
                && numbers.windows(2).all(|pair| pair[0] < pair[1])
                && numbers.last().is_none_or(|&last| last < end)
        };
        if !rises(&self.trees, count) || (self.trees.is_empty() && count > 0) {
            return Err("its trees do not follow each other".to_owned());
        }
        let legs: Vec<u32> = self.rays.iter().map(|ray| ray.first_leg).collect();
        if !rises(&legs, self.legs.len() as u32) {
            return Err("its rays do not follow each other".to_owned());
        }
        // Each ray but the first of a tree is asked for once, by one before it.
        let mut asked = vec![0u8; self.rays.len()];
        for tree in 0..self.trees.len() {
            let rays = self.tree(tree);
            for ray in rays.clone() {
                let RayTask { children: (first, more), tree: of, .. } = self.rays[ray as usize];
                let end = first.checked_add(more).filter(|&end| more == 0 || (first > ray && end <= rays.end));
                let Some(end) = end.filter(|_| of as usize == tree) else {
                    return Err("a ray asks for one that does not stand behind it in its tree".to_owned());
                };
                if more > 0 {
                    (first..end).for_each(|child| asked[child as usize] = asked[child as usize].saturating_add(1));
                }
            }
            if asked[rays.start as usize] != 0 || rays.skip(1).any(|ray| asked[ray as usize] != 1) {
                return Err("a ray is asked for by none, or by several".to_owned());
            }
        }
        if !self.in_one.is_empty() && self.in_one.len() != self.rays.len() {
            return Err("its rays' whole ways do not fit".to_owned());
        }
        let Some(uses) = &self.pages else { return Ok(()) };
        let ends = uses.ends.iter().try_fold(0, |before, &end| (end >= before).then_some(end));
        let fits = uses.ends.len() == self.rays.len() && ends.is_some_and(|end| end as usize == uses.uses.len());
        match fits && uses.page_bytes > 0 && uses.uses.iter().all(|&(page, _)| page < uses.pages) {
            true => Ok(()),
            false => Err("its pages do not fit".to_owned()),
        }
    }

    /// The most regions that the line of a ray meets, and how often light turns at the most.
    pub fn most_regions_and_turns(&self) -> (u32, u32) {
        let ends = self.rays.iter().skip(1).map(|ray| ray.first_leg).chain([self.legs.len() as u32]);
        self.rays.iter().zip(ends).fold((1, 0), |(regions, turns), (ray, end)| {
            let met = u32::from(ray.hop) + (end - ray.first_leg);
            (regions.max(met), turns.max(u32::from(ray.turns)))
        })
    }
}
