//! §4.2: what each cell, each link and the host have to do for a ray, and how many rays a second that allows at most.
//!
//! A cell does its work and moves its words one after the other, a link carries one word after the other: whatever has
//! most to do for a ray bounds the array. Deep FIFOs and even work come near to the bound; nothing passes it.

use super::cost::KernelTime;
use super::sketch::RayWork;

/// Words of a ray on X (id, origin, direction, t_max).
pub const RAY_WORDS: f64 = 8.0;
/// Words of a candidate, and of the END behind the last, on Y.
pub const CANDIDATE_WORDS: f64 = 1.0;
/// Words of a hit on Y (ray, polygon, t, alpha, beta).
pub const HIT_WORDS: f64 = 5.0;

/// What one cell of a group runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stage {
    /// Filter 1.
    pub grid: bool,
    /// Filter 2.
    pub slabs: bool,
    /// The intersection test.
    pub intersection: bool,
}

/// Figure 7, in cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Times {
    /// The grid's.
    pub grid: KernelTime,
    /// The slabs'.
    pub slabs: KernelTime,
    /// The intersection test's.
    pub intersection: KernelTime,
    /// What the host spends on a ray before it sends it.
    pub host_ray: f64,
}

/// The links between neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Links {
    /// Cycles from one word to the next, at least 1.
    pub cycles_per_word: f64,
    /// Whether both channels share that rate.
    pub shared: bool,
}

/// An array, as far as the model is concerned: groups of stages, one group for each sub-volume.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArrayModel {
    /// The cells of a group, from left to right: the grid in the first, the intersection in the last.
    pub stages: Vec<Stage>,
    /// What the kernels cost.
    pub times: Times,
    /// The links.
    pub links: Links,
    /// Words of a ray's mask, behind the others on X.
    pub mask_words: f64,
    /// Cycles in a second.
    pub cycles_per_second: f64,
}

/// What a cell does for a ray, in cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellLoad {
    /// Walking the grid.
    pub grid: f64,
    /// On slabs tests.
    pub slabs: f64,
    /// On intersection tests.
    pub intersection: f64,
    /// Moving words.
    pub moving: f64,
    /// Waiting between the words of a message for a link that is slower than the cell.
    pub link_wait: f64,
}

impl CellLoad {
    /// All of it.
    pub fn total(&self) -> f64 {
        self.works() + self.link_wait
    }

    /// All but the waiting.
    pub fn works(&self) -> f64 {
        self.grid + self.slabs + self.intersection + self.moving
    }
}

/// What the link into a cell (the last one: into the host) carries for a ray, in words.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkLoad {
    /// Rays.
    pub x: f64,
    /// Candidates and hits.
    pub y: f64,
}

impl LinkLoad {
    /// Cycles for which it carries words.
    pub fn cycles(&self, links: Links) -> f64 {
        let counted = if links.shared { self.x + self.y } else { self.x.max(self.y) };
        counted * links.cycles_per_word
    }
}

/// What bounds an array.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Limit {
    /// The host has most to do.
    #[default]
    Host,
    /// The link into this cell (into the host, if there is no such cell).
    Link(usize),
    /// This cell.
    Cell(usize),
}

/// The least time for a ray, and what takes it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bound {
    /// No array does a ray in fewer cycles, on average over many.
    pub cycles_per_ray: f64,
    /// What has so much to do.
    pub limit: Limit,
}

impl Bound {
    /// The largest of all loads.
    pub fn new(host: f64, cells: &[CellLoad], links: &[LinkLoad], rate: Links) -> Bound {
        let host = Bound { cycles_per_ray: host, limit: Limit::Host };
        let links =
            links.iter().map(|link| link.cycles(rate)).enumerate().map(|(index, load)| (load, Limit::Link(index)));
        let cells = cells.iter().map(CellLoad::total).enumerate().map(|(index, load)| (load, Limit::Cell(index)));
        links.chain(cells).fold(host, |most, (cycles_per_ray, limit)| {
            if cycles_per_ray > most.cycles_per_ray { Bound { cycles_per_ray, limit } } else { most }
        })
    }
}

impl ArrayModel {
    /// Whether the grid's cell knows the hits and can stop its walk at one.
    pub fn walks_stop(&self) -> bool {
        self.stages.len() == 1
    }

    /// Whether slabs are tested.
    pub fn has_slabs(&self) -> bool {
        self.stages.iter().any(|stage| stage.slabs)
    }

    /// The polygons that are tested for intersection: what the last filter lets through.
    pub fn tested(&self, work: &RayWork) -> f64 {
        if self.has_slabs() { work.survivors } else { work.candidates }
    }

    /// What the host does for a ray.
    pub fn host_load(&self) -> f64 {
        self.times.host_ray + self.ray_words() + self.wait_within(self.ray_words())
    }

    /// Words of a ray on X, with its mask.
    fn ray_words(&self) -> f64 {
        RAY_WORDS + self.mask_words
    }

    /// What each cell does for a ray, from left to right. `groups` is what each group finds in its sub-volume.
    pub fn cell_loads(&self, groups: &[RayWork]) -> Vec<CellLoad> {
        let cells = groups.len() * self.stages.len();
        let index = |group: usize, stage: usize| group * self.stages.len() + stage;
        let load = |(group, work): (usize, &RayWork)| -> Vec<CellLoad> {
            let cell = |stage: usize| self.cell_load(stage, work, group > 0, index(group, stage) + 1 == cells);
            (0..self.stages.len()).map(cell).collect()
        };
        groups.iter().enumerate().flat_map(load).collect()
    }

    fn cell_load(&self, stage: usize, work: &RayWork, has_earlier_group: bool, is_last_cell: bool) -> CellLoad {
        let runs = self.stages[stage];
        let Times { grid, slabs, intersection, .. } = self.times;
        // A kernel starts on the ray if it is its cell's first, else at the first polygon that reaches it.
        let begun = work.begun();
        let slabs_start = if runs.grid { work.finds } else { begun };
        let reached = if self.has_slabs() { work.meets } else { work.finds };
        let intersection_start = if runs.grid || runs.slabs { reached } else { begun };
        let cost = |runs: bool, time: KernelTime, started: f64, count: f64| {
            if runs { time.start * started + time.each * count } else { 0.0 }
        };
        let passed_on = if is_last_cell { 0.0 } else { self.ray_words() };
        CellLoad {
            grid: cost(runs.grid, grid, begun, work.voxels),
            slabs: cost(runs.slabs, slabs, slabs_start, work.candidates),
            intersection: cost(runs.intersection, intersection, intersection_start, self.tested(work)),
            // A ray's word is passed on in the cycle in which it is read.
            moving: self.ray_words()
                + self.words_in(stage, work, has_earlier_group)
                + self.words_out(stage, work, has_earlier_group),
            link_wait: self.wait_within(passed_on)
                + if self.sends_hit(stage, has_earlier_group) { self.wait_within(HIT_WORDS) } else { 0.0 },
        }
    }

    /// What each link carries for a ray: into each cell, then into the host.
    pub fn link_loads(&self, groups: &[RayWork]) -> Vec<LinkLoad> {
        let mut links = vec![LinkLoad { x: self.ray_words(), y: 0.0 }];
        for (group, work) in groups.iter().enumerate() {
            for stage in 0..self.stages.len() {
                links.push(LinkLoad { x: self.ray_words(), y: self.words_out(stage, work, group > 0) });
            }
        }
        if let Some(last) = links.last_mut() {
            last.x = 0.0;
        }
        links
    }

    /// Words that a stage reads from Y.
    fn words_in(&self, stage: usize, work: &RayWork, has_earlier_group: bool) -> f64 {
        let candidates = if stage == 0 { 0.0 } else { self.candidates_out(stage - 1, work) };
        candidates + if has_earlier_group { HIT_WORDS } else { 0.0 }
    }

    /// Words that a stage writes to Y.
    fn words_out(&self, stage: usize, work: &RayWork, has_earlier_group: bool) -> f64 {
        self.candidates_out(stage, work) + if self.sends_hit(stage, has_earlier_group) { HIT_WORDS } else { 0.0 }
    }

    fn sends_hit(&self, stage: usize, has_earlier_group: bool) -> bool {
        has_earlier_group || stage + 1 == self.stages.len()
    }

    /// Words of candidates, and of the END behind them, that a stage writes.
    fn candidates_out(&self, stage: usize, work: &RayWork) -> f64 {
        if stage + 1 == self.stages.len() {
            return 0.0;
        }
        let filtered = self.stages[..=stage].iter().any(|stage| stage.slabs);
        (if filtered { work.survivors } else { work.candidates } + work.begun()) * CANDIDATE_WORDS
    }

    /// What a message waits between its words.
    fn wait_within(&self, words: f64) -> f64 {
        (words - 1.0).max(0.0) * (self.links.cycles_per_word - 1.0)
    }
}
