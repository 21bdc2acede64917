//! Task graphs in files: what an image makes the nodes do, to be timed again under another machine without its scene.
//!
//! A file begins with the line `pcs-tasks 1`, then has a line of JSON that tells what was recorded, then numbers, the lowest byte first:
//! for each tree its first ray (4 bytes); for each ray its first leg, the first of its children and how many (4 each), its tree (4), its hop (2),
//! its turns (1), its kind (1; and 128 if its hit is shaded); for each leg its region (2), voxels, slabs tests and intersection tests (4 each);
//! of regions with grids of their own, for each ray the same three numbers where the scene has one grid (4 each);
//! of a shared memory, for each ray where its pages end (4), and for each of these the page and how often it is read (4 each).

use std::io::{self, Read, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::{CubeScene, CubeSpec, Cut, Grids};
use crate::error::InputError;
use crate::host::shading::RayKind;
use crate::input::file;
use crate::program::Spared;
use crate::program::cube::{Leg, PageUses, RayTask, TaskGraph};
use crate::run::ByKind;

/// The first line of such a file.
const MAGIC: &str = "pcs-tasks 1";

/// The largest file that is read, in GiB.
const LARGEST: u64 = 16;

/// No scene has more pages that can be simulated.
const MOST_PAGES: u32 = 1 << 22;

/// A ray whose hit is shaded has this bit in its kind.
const SHADED: u8 = 128;

/// What was recorded, beside the graph.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    spec: CubeSpec,
    name: String,
    polygons: usize,
    kinds: ByKind<(u64, u64)>,
    #[serde(default)]
    spared: Spared,
    cut: Cut,
    trees: u32,
    rays: u32,
    legs: u32,
    pages: Option<Pages>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Pages {
    pages: u32,
    page_bytes: u32,
    uses: u32,
}

impl CubeScene {
    /// Writes what is to be done, for [`CubeScene::read_tasks`].
    pub fn write_tasks(&self, spec: &CubeSpec, out: &mut impl Write) -> io::Result<()> {
        let graph = &self.graph;
        let pages = graph.pages.as_ref().map(|uses| Pages {
            pages: uses.pages,
            page_bytes: uses.page_bytes,
            uses: uses.uses.len() as u32,
        });
        let header = Header {
            spec: spec.clone(),
            name: self.name.clone(),
            polygons: self.polygons,
            kinds: self.kinds,
            spared: self.spared,
            cut: self.cut.clone(),
            trees: graph.trees.len() as u32,
            rays: graph.rays.len() as u32,
            legs: graph.legs.len() as u32,
            pages,
        };
        writeln!(out, "{MAGIC}\n{}", serde_json::to_string(&header)?)?;
        graph.trees.iter().try_for_each(|first| out.write_all(&first.to_le_bytes()))?;
        graph.rays.iter().try_for_each(|ray| write_ray(ray, out))?;
        graph.legs.iter().try_for_each(|leg| {
            out.write_all(&leg.region.to_le_bytes())?;
            write_counts(leg, out)
        })?;
        graph.in_one.iter().try_for_each(|leg| write_counts(leg, out))?;
        let Some(uses) = &graph.pages else { return Ok(()) };
        uses.ends.iter().try_for_each(|end| out.write_all(&end.to_le_bytes()))?;
        uses.uses
            .iter()
            .flat_map(|&(page, reads)| [page, reads])
            .try_for_each(|number| out.write_all(&number.to_le_bytes()))
    }

    /// Reads a file of tasks: what is to be done, and the image that it was recorded of. Its pixels are not in it.
    ///
    /// Fails if the file cannot be read, or has no such tasks.
    pub fn read_tasks(path: &Path) -> Result<(CubeSpec, CubeScene), InputError> {
        let bytes = file::read(path, LARGEST)?;
        let wrong = |what: String| {
            InputError::in_file(path, what).help("record it with `pcs-sim image SCENE --on ipsc2 --tasks FILE`")
        };
        let mut lines = bytes.splitn(3, |&byte| byte == b'\n');
        let (magic, header, rest) = (lines.next(), lines.next().unwrap_or_default(), lines.next().unwrap_or_default());
        if magic != Some(MAGIC.as_bytes()) {
            return Err(wrong(format!("is no file of tasks: its first line is not `{MAGIC}`")));
        }
        let header: Header =
            serde_json::from_slice(header).map_err(|error| wrong(format!("tells nothing of its tasks: {error}")))?;
        let expected = header.bytes();
        if rest.len() as u64 != expected {
            return Err(wrong(format!("has {} bytes of tasks, there should be {expected}", rest.len())));
        }
        let graph = read_graph(&header, rest).map_err(|error| wrong(format!("its tasks cannot be read: {error}")))?;
        header.check(&graph).map_err(wrong)?;
        let Header { spec, name, polygons, kinds, spared, cut, .. } = header;
        let (pixels, found, notes) = (Vec::new(), None, Vec::new());
        Ok((spec, CubeScene { name, polygons, graph, cut, pixels, found, kinds, spared, notes }))
    }
}

impl Header {
    /// How many bytes the graph takes.
    fn bytes(&self) -> u64 {
        let count = u64::from;
        let pages = self.pages.map_or(0, |pages| 4 * count(self.rays) + 8 * count(pages.uses));
        let in_one = if self.has_own_grids() { 12 * count(self.rays) } else { 0 };
        4 * count(self.trees) + 20 * count(self.rays) + 14 * count(self.legs) + in_one + pages
    }

    fn has_own_grids(&self) -> bool {
        self.spec.regions.is_some_and(|regions| regions.grids == Grids::Own)
    }

    /// Tells what is wrong with a graph, or with what is told of it: nothing in it may lead out of it.
    fn check(&self, graph: &TaskGraph) -> Result<(), String> {
        let regions = self.cut.regions.count();
        let nodes = match self.spec.regions {
            Some(_) => self.spec.machine.nodes as usize,
            None => 1,
        };
        let is_square = self.cut.between.len() == regions * regions || self.spec.regions.is_none();
        if regions != nodes || !self.cut.regions.is_whole() || self.cut.parts.len() != regions || !is_square {
            return Err("its regions do not fit together".to_owned());
        }
        if self.spec.regions.is_some() == graph.pages.is_some() || self.spec.samples() != graph.trees.len() {
            return Err("its tasks are none of the image that it tells of".to_owned());
        }
        if graph.pages.as_ref().is_some_and(|uses| uses.pages > MOST_PAGES) {
            return Err(format!("its memory has more than {MOST_PAGES} pages"));
        }
        if graph.legs.iter().any(|leg| usize::from(leg.region) >= regions) {
            return Err("a leg is in a region that there is not".to_owned());
        }
        graph.check()
    }
}

fn write_counts(leg: &Leg, out: &mut impl Write) -> io::Result<()> {
    let counts = [leg.voxels, leg.slab_tests, leg.intersection_tests];
    counts.iter().try_for_each(|count| out.write_all(&count.to_le_bytes()))
}

fn write_ray(ray: &RayTask, out: &mut impl Write) -> io::Result<()> {
    for number in [ray.first_leg, ray.children.0, ray.children.1, ray.tree] {
        out.write_all(&number.to_le_bytes())?;
    }
    out.write_all(&ray.hop.to_le_bytes())?;
    out.write_all(&[ray.turns, ray.kind as u8 | if ray.shaded { SHADED } else { 0 }])
}

fn read_graph(header: &Header, mut from: &[u8]) -> io::Result<TaskGraph> {
    let from = &mut from;
    let trees = (0..header.trees).map(|_| number(from)).collect::<io::Result<_>>()?;
    let rays = (0..header.rays).map(|_| read_ray(from)).collect::<io::Result<_>>()?;
    let legs = (0..header.legs).map(|_| short(from).and_then(|region| read_leg(region, from)));
    let legs = legs.collect::<io::Result<_>>()?;
    let whole = if header.has_own_grids() { header.rays } else { 0 };
    let in_one = (0..whole).map(|_| read_leg(0, from)).collect::<io::Result<_>>()?;
    let pages = header.pages.map(|Pages { pages, page_bytes, uses }| {
        let ends = (0..header.rays).map(|_| number(from)).collect::<io::Result<_>>()?;
        let uses = (0..uses).map(|_| Ok((number(from)?, number(from)?))).collect::<io::Result<_>>()?;
        Ok::<_, io::Error>(PageUses { pages, page_bytes, uses, ends })
    });
    let (regions, names_own) = (header.cut.regions.count(), header.spec.rules.own);
    Ok(TaskGraph { regions, rays, legs, trees, in_one, pages: pages.transpose()?, names_own })
}

fn read_leg(region: u16, from: &mut &[u8]) -> io::Result<Leg> {
    Ok(Leg { region, voxels: number(from)?, slab_tests: number(from)?, intersection_tests: number(from)? })
}

fn read_ray(from: &mut &[u8]) -> io::Result<RayTask> {
    let (first_leg, child, children, tree) = (number(from)?, number(from)?, number(from)?, number(from)?);
    let hop = short(from)?;
    let mut last = [0; 2];
    from.read_exact(&mut last)?;
    let kind = RayKind::ALL.get(usize::from(last[1] & !SHADED)).copied();
    let kind = kind.ok_or_else(|| io::Error::other("a ray is of no kind"))?;
    let shaded = last[1] & SHADED != 0;
    Ok(RayTask { first_leg, children: (child, children), tree, hop, turns: last[0], kind, shaded })
}

fn number(from: &mut &[u8]) -> io::Result<u32> {
    let mut bytes = [0; 4];
    from.read_exact(&mut bytes)?;
    Ok(u32::from_le_bytes(bytes))
}

fn short(from: &mut &[u8]) -> io::Result<u16> {
    let mut bytes = [0; 2];
    from.read_exact(&mut bytes)?;
    Ok(u16::from_le_bytes(bytes))
}
