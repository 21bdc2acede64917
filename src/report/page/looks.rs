//! What single rays come to, for who looks at one: its way through the scene, test by test, and the instructions that cells execute
//! for it. A page has those of the first rays of its window.

use std::collections::{BTreeMap, BTreeSet};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::Vec3;
use serde::Serialize;

use super::packed::{Packed, folded};
use super::sides::{Side, sides};
use crate::geometry::{Hit, Ray};
use crate::isa::Executable;
use crate::isa::listing::fields;
use crate::measure::Recording;
use crate::program::cells::InstructionStep;
use crate::program::{Said, Visit, Workload};
use crate::quantities::Cycles;
use crate::run::Setup;

/// Voxels and tests that a page holds at the most, coordinates of the polygons that they are of, and instructions: about a quarter of
/// a megabyte each.
const MOST_TESTS: usize = 60_000;
const MOST_COORDINATES: usize = 40_000;
const MOST_INSTRUCTIONS: usize = 30_000;

/// Instructions that are told of a cell for one ray, at the most.
pub const MOST_STEPS: usize = 20_000;

/// What a page holds of single rays.
#[derive(Serialize)]
pub struct Looks {
    /// The picture's size, if the rays are those of one.
    size: Option<[u32; 2]>,
    /// The pixels of the rays from number `first` on, as far as the window has any.
    first: u32,
    pixels: Packed,
    /// The scene from its sides.
    sides: [Side; 3],
    /// For each group its volume and its grid.
    volumes: Vec<Volume>,
    visits: BTreeMap<u32, Look>,
    /// The corners of the polygons that the visits tell of.
    polygons: BTreeMap<u32, Corners>,
    /// For each cell the place of its program; nothing if cells run none.
    programs: Vec<usize>,
    listings: Vec<Listing>,
    /// Instructions by the cell and the ray: `3 17`.
    instructions: BTreeMap<String, Steps>,
}

#[derive(Serialize)]
struct Volume {
    low: [f64; 3],
    high: [f64; 3],
    size: [u32; 3],
}

/// A ray's way.
#[derive(Serialize)]
pub struct Look {
    origin: [f32; 3],
    direction: [f32; 3],
    /// Its first hit: the polygon, and t.
    hit: Option<(u32, f32)>,
    /// For each group and each voxel on the way its number against the one before it, how many candidates it has, and of each the
    /// polygon, what became of it, and t in bits if it is hit.
    groups: Vec<Packed>,
}

/// x, y, z of each corner: 32-bit floats, least byte first, in base 64.
#[derive(Serialize)]
struct Corners(String);

#[derive(Serialize)]
struct Listing {
    name: String,
    rows: Vec<Row>,
}

/// An instruction: what it is, the line of source and its text, the cycles that it computes and waits for results, the words that it
/// reads before and writes behind that.
#[derive(Serialize)]
struct Row(String, u32, String, u64, usize, usize);

/// For each instruction the address against the one behind the last, and, folded into the lowest bit, whether a register has changed; if
/// one has, which, and what it holds.
#[derive(Serialize)]
pub struct Steps(Packed);

/// A ray's way, and the corners of the polygons on it: what a page asks for that does not hold it.
#[derive(Serialize)]
pub struct LookedAt {
    look: Look,
    polygons: BTreeMap<u32, Corners>,
}

impl LookedAt {
    /// Of ray number `ray` in the order in which they are sent; `None` if there is none.
    pub fn new(setup: &Setup, ray: u32) -> Option<LookedAt> {
        let sent = setup.prepared.rays.get(ray as usize)?;
        let visit = setup.workload.visit(sent);
        let polygons = polygons_of(&visit).into_iter().map(|polygon| (polygon, corners(&setup.workload, polygon)));
        Some(LookedAt { polygons: polygons.collect(), look: Look::new(sent, &visit) })
    }
}

impl Looks {
    /// Those of the rays of a recording's cycles before `until`. Of images there are none: which rays their hosts send is not known
    /// before.
    pub fn new(setup: &Setup, recording: &Recording, until: Cycles) -> Option<Looks> {
        if setup.spec.image.is_some() {
            return None;
        }
        let (workload, rays) = (&setup.workload, &setup.prepared.rays);
        let seen: BTreeSet<u32> = jobs(recording, until).filter(|&job| (job as usize) < rays.len()).collect();
        let (first, last) = (seen.first().copied().unwrap_or(0), seen.last().copied().unwrap_or(0));
        let pixels = (first..=last).filter(|&ray| (ray as usize) < rays.len());
        let volume = |grid: &crate::geometry::Grid| Volume {
            low: grid.volume().low.to_array(),
            high: grid.volume().high.to_array(),
            size: grid.size(),
        };
        let mut looks = Looks {
            size: setup.spec.rays.is_none().then_some([setup.spec.size.width, setup.spec.size.height]),
            first,
            pixels: Packed::new(pixels.map(|ray| setup.prepared.number(ray as usize) as u64)),
            sides: sides(workload),
            volumes: workload.grids().map(volume).collect(),
            visits: BTreeMap::new(),
            polygons: BTreeMap::new(),
            programs: Vec::new(),
            listings: Vec::new(),
            instructions: BTreeMap::new(),
        };
        looks.list(workload);
        looks.visit(workload, rays, &seen);
        looks.execute(workload, rays, &seen);
        Some(looks)
    }

    /// The programs of all cells, each once.
    fn list(&mut self, workload: &Workload) {
        let mut listed: Vec<&Executable> = Vec::new();
        for executable in (0..workload.cells()).map_while(|cell| workload.executable(cell)) {
            let place = listed.iter().position(|other| std::ptr::eq(*other, executable)).unwrap_or(listed.len());
            if place == listed.len() {
                listed.push(executable);
            }
            self.programs.push(place);
        }
        self.listings = listed.into_iter().map(Listing::new).collect();
    }

    fn visit(&mut self, workload: &Workload, rays: &[Ray], seen: &BTreeSet<u32>) {
        let (mut tests, mut coordinates) = (0, 0);
        for &ray in seen {
            let visit = workload.visit(&rays[ray as usize]);
            let new: Vec<u32> =
                polygons_of(&visit).into_iter().filter(|polygon| !self.polygons.contains_key(polygon)).collect();
            tests +=
                visit.groups.iter().flat_map(|group| &group.voxels).map(|voxel| 1 + voxel.tests.len()).sum::<usize>();
            coordinates += new.iter().map(|&polygon| 3 * workload.polygons().vertices(polygon).len()).sum::<usize>();
            if tests > MOST_TESTS || coordinates > MOST_COORDINATES {
                return;
            }
            self.polygons.extend(new.into_iter().map(|polygon| (polygon, corners(workload, polygon))));
            self.visits.insert(ray, Look::new(&rays[ray as usize], &visit));
        }
    }

    fn execute(&mut self, workload: &Workload, rays: &[Ray], seen: &BTreeSet<u32>) {
        let mut left = MOST_INSTRUCTIONS;
        for &ray in seen.iter().filter(|_| !self.programs.is_empty()) {
            for cell in 0..workload.cells() {
                let steps = workload.instructions(cell, ray, &rays[ray as usize], left + 1);
                if steps.len() > left {
                    return;
                }
                left -= steps.len();
                self.instructions.insert(format!("{cell} {ray}"), Steps::new(&steps));
            }
        }
    }
}

/// The rays that host or cells work on before `until`.
fn jobs(recording: &Recording, until: Cycles) -> impl Iterator<Item = u32> {
    let stations = recording.host.iter().chain(&recording.stations);
    stations.flat_map(|station| &station.jobs).filter(move |span| span.from < until).map(|span| span.job)
}

/// The polygons that a visit tells of, each once.
fn polygons_of(visit: &Visit) -> BTreeSet<u32> {
    let voxels = visit.groups.iter().flat_map(|group| &group.voxels);
    voxels.flat_map(|voxel| &voxel.tests).map(|test| test.polygon).collect()
}

fn corners(workload: &Workload, polygon: u32) -> Corners {
    let corners = workload.polygons().vertices(polygon).iter().flat_map(Vec3::to_array);
    Corners(STANDARD.encode(corners.flat_map(f32::to_le_bytes).collect::<Vec<u8>>()))
}

impl Look {
    fn new(ray: &Ray, visit: &Visit) -> Look {
        let Hit { polygon, t, .. } = visit.hit;
        let groups = visit.groups.iter().map(|group| {
            let mut last = 0;
            Packed::new(group.voxels.iter().flat_map(|voxel| {
                let number = voxel.voxel as i64;
                let head = [folded(number - last), voxel.tests.len() as u64];
                last = number;
                let tests = voxel.tests.iter().flat_map(|test| {
                    let (code, t) = said(test.said);
                    [u64::from(test.polygon), code].into_iter().chain(t.map(|t| u64::from(t.to_bits())))
                });
                head.into_iter().chain(tests).collect::<Vec<u64>>()
            }))
        });
        Look {
            origin: ray.origin.to_array(),
            direction: ray.direction.to_array(),
            hit: visit.hit.is_hit().then_some((polygon, t)),
            groups: groups.collect(),
        }
    }
}

/// What became of a candidate, in the order of [`Said`], and where it is hit.
fn said(said: Said) -> (u64, Option<f32>) {
    match said {
        Said::Known => (0, None),
        Said::Stopped => (1, None),
        Said::Dropped => (2, None),
        Said::Missed => (3, None),
        Said::Behind(t) => (4, Some(t)),
        Said::Nearest(t) => (5, Some(t)),
    }
}

impl Listing {
    fn new(executable: &Executable) -> Listing {
        let program = executable.program();
        let row = |address: u32| {
            let (instruction, line, source) = fields(executable, address);
            let (reads, writes) = executable.words_at(address);
            let (before, behind) = executable.waits_at(address);
            // What comes before a word that is read is over when it is read.
            let waits = if reads > 0 { behind } else { before + behind };
            let cycles = executable.cycles_at(address) + waits * executable.wait_cycles();
            Row(instruction, line.unwrap_or(0), source.to_owned(), cycles, reads, writes)
        };
        Listing {
            name: program.files.first().map_or(String::new(), |file| file.path.display().to_string()),
            rows: (0..program.code.len() as u32).map(row).collect(),
        }
    }
}

impl Steps {
    /// Some instructions, one after the other.
    pub fn new(steps: &[InstructionStep]) -> Steps {
        let mut next = 0;
        Steps(Packed::new(steps.iter().flat_map(|step| {
            let address = folded(i64::from(step.address) - next);
            next = i64::from(step.address) + 1;
            let head = 2 * address + u64::from(step.changed.is_some());
            let changed = step.changed.map(|(register, word)| [register.number().into(), u64::from(word)]);
            [head].into_iter().chain(changed.into_iter().flatten())
        })))
    }
}
