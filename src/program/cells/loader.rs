//! The host's loader: a cell's part of the scene as words of its memory.
//!
//! Addresses count words. The data memory comes first: the program's own data, and for a mailbox a word for each
//! polygon. The scene follows, which programs can only read, with what the cell's kernels need of:
//!
//! | part | words |
//! | --- | --- |
//! | planes between voxels, along x, y and z | voxels along the axis + 1, each |
//! | voxel table (equation 4): the address of each voxel's list, and of the last one's end | voxels + 1 |
//! | index lists (equation 4): numbers of polygons | references |
//! | slabs (equation 6): d_min and d_max in directions 1 to 7 | 14 a polygon |
//! | addresses of the polygons' records | 1 a polygon |
//! | records: N, d, the number in the scene, 4 x corners + plane of projection (0: yz, 1: zx, 2: xy), the corners | 6 + 3 a corner |
//!
//! A cell's polygons are numbered from 0, in the order of their numbers in the scene: these are the numbers in the lists
//! and in CANDIDATE messages of its group.

use std::collections::BTreeMap;

use crate::error::InputError;
use crate::geometry::{Grid, Hit, Polygons};
use crate::isa::Program;
use crate::program::array_program::Kernel;
use crate::program::layout::{Group, Surfaces};

/// A cell's place in the array: its part of the scene, and what it does there.
pub struct Place<'a> {
    /// The scene.
    pub surfaces: &'a Surfaces,
    /// The group's part of it.
    pub group: &'a Group,
    /// What the cell runs.
    pub kernels: &'a [Kernel],
    /// Whether its grid sends no polygon twice for a ray.
    pub mailbox: bool,
}

/// The words of a cell's data memory and of the scene behind it.
pub fn load(place: &Place<'_>, program: &Program) -> Result<(Vec<u32>, Vec<u32>), InputError> {
    let Place { surfaces, group, kernels, mailbox } = place;
    let polygons = &surfaces.polygons;
    let mut memory = Memory { data: program.data.clone(), scene: Vec::new(), known: BTreeMap::new() };
    memory.number("scene", polygons.largest_coordinate() as f32);
    if kernels.contains(&Kernel::Grid) {
        if *mailbox {
            memory.mailbox(group.members.len());
        }
        memory.grid(polygons, group);
    }
    if kernels.contains(&Kernel::Slabs) {
        memory.here("slabs");
        let words = |&polygon: &u32| surfaces.slabs.words(polygon).map(f32::to_bits);
        memory.scene.extend(group.members.iter().flat_map(words));
    }
    if kernels.contains(&Kernel::Intersection) {
        memory.polygons(polygons, group);
    }
    for (name, &address) in &program.loaded {
        let Some(&value) = memory.known.get(name.as_str()) else {
            let path = program.files.first().map(|file| file.path.clone()).unwrap_or_default();
            let known: Vec<&str> = memory.known.keys().copied().collect();
            let message = format!("the loader has nothing to fill in for `{name}`");
            return Err(
                InputError::in_file(&path, message).help(format!("for this cell there are {}", known.join(", ")))
            );
        };
        memory.data[address as usize] = value;
    }
    Ok((memory.data, memory.scene))
}

struct Memory {
    data: Vec<u32>,
    scene: Vec<u32>,
    /// What can be filled in, by name.
    known: BTreeMap<&'static str, u32>,
}

impl Memory {
    /// Lets the program know an integer or an address.
    fn word(&mut self, name: &'static str, value: u32) {
        self.known.insert(name, value);
    }

    /// Lets the program know a floating-point number.
    fn number(&mut self, name: &'static str, value: f32) {
        self.word(name, value.to_bits());
    }

    /// Lets the program know where in memory the next word of the scene stands.
    fn here(&mut self, name: &'static str) {
        self.word(name, self.next());
    }

    fn next(&self) -> u32 {
        (self.data.len() + self.scene.len()) as u32
    }

    /// Room to note for each polygon the last ray that it was sent on for.
    fn mailbox(&mut self, polygons: usize) {
        self.word("marks", self.data.len() as u32);
        self.data.extend(std::iter::repeat_n(u32::MAX, polygons));
    }

    fn grid(&mut self, polygons: &Polygons, group: &Group) {
        let Group { grid, members, .. } = group;
        self.word("references", grid.reference_count() as u32);
        self.number("reach", polygons.reach() as f32);
        let axes = |grid: &Grid| [0, 1, 2].map(|axis| (grid.size()[axis], grid.low()[axis], grid.per_edge()[axis]));
        let names = [
            ["planes_x", "count_x", "low_x", "per_edge_x"],
            ["planes_y", "count_y", "low_y", "per_edge_y"],
            ["planes_z", "count_z", "low_z", "per_edge_z"],
        ];
        for (axis, ([planes, count, low, per_edge], (voxels, corner, inverse))) in
            names.into_iter().zip(axes(grid)).enumerate()
        {
            self.here(planes);
            self.scene.extend(grid.planes(axis).iter().map(|plane| plane.to_bits()));
            self.word(count, voxels);
            self.number(low, corner);
            self.number(per_edge, inverse);
        }
        self.here("voxels");
        let lists = self.next() + grid.table().len() as u32;
        self.scene.extend(grid.table().iter().map(|&start| lists + start));
        self.word("voxels_end", lists - 1);
        let number = |polygon: &u32| members.binary_search(polygon).map_or(Hit::NO_POLYGON, |number| number as u32);
        self.scene.extend(grid.lists().flatten().map(number));
    }

    fn polygons(&mut self, polygons: &Polygons, group: &Group) {
        self.here("polygons");
        let mut record = self.next() + group.members.len() as u32;
        for &polygon in &group.members {
            self.scene.push(record);
            record += polygons.record_words(polygon) as u32;
        }
        for &polygon in &group.members {
            let (normal, corners) = (polygons.normal(polygon), polygons.vertices(polygon));
            let [i1, _] = polygons.projection(polygon);
            // i1 is 1, 2 or 0 where the plane is across x, y or z.
            let plane = (i1 as u32 + 2) % 3;
            self.scene.extend(normal.to_array().map(f32::to_bits));
            self.scene.extend([polygons.d(polygon).to_bits(), polygon, 4 * corners.len() as u32 + plane]);
            self.scene.extend(corners.iter().flat_map(|corner| corner.to_array()).map(f32::to_bits));
        }
    }
}
