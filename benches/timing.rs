//! The timing half alone: words a second on one core, with all statistics on: alone, with a probe, and with the critical path;
//! how long a farm takes, and how much a hypercube does a second.
//!
//! `cargo bench --bench timing`

use std::convert::Infallible;
use std::hint::black_box;
use std::time::Instant;

use pcs_sim::cancel::Cancel;
use pcs_sim::machine::MachineFile;
use pcs_sim::machine::{Array, MachineSpec, Words};
use pcs_sim::measure::CriticalPath;
use pcs_sim::program::work::{self, GRID_START, GRID_VOXEL, INTERSECTION_POLYGON, SLABS_POLYGON, SLABS_START};
use pcs_sim::run::{CubeRunOptions, CubeSpec, FarmRunOptions, FarmSpec, Watching, Workers};
use pcs_sim::seam::{Costs, OpBatch, OpKind};

const RAYS: u32 = 1024;
const BATCHES: usize = 40;

/// Broadcast: every cell passes the ray on, works, merges the left neighbour's hit.
fn broadcast(cells: usize) -> OpBatch {
    let mut batch = OpBatch::new(cells);
    for ray in 0..RAYS {
        batch.host.push(OpKind::WriteX, 8);
        batch.host.end_line(ray);
        for cell in 0..cells {
            let ops = &mut batch.cells[cell];
            ops.push(OpKind::PassX, 8);
            ops.push(OpKind::Work(GRID_START), 1);
            ops.push(OpKind::Work(GRID_VOXEL), varying(ray, cell, 20));
            ops.push(OpKind::Work(SLABS_START), 1);
            ops.push(OpKind::Work(SLABS_POLYGON), varying(ray, cell + 50, 8));
            if cell > 0 {
                ops.push(OpKind::ReadY, 5);
            }
            ops.push(OpKind::WriteY, 5);
            ops.end_line(ray);
        }
    }
    batch
}

/// The macro-pipeline's cells begin with a ray.
fn begin_ray(batch: &mut OpBatch, ray: u32) {
    batch.host.push(OpKind::WriteX, 8);
    batch.host.end_line(ray);
    batch.cells.iter_mut().for_each(|cell| cell.push(OpKind::PassX, 8));
    batch.cells[0].push(OpKind::Work(GRID_START), 1);
    batch.cells[1].push(OpKind::Work(SLABS_START), 1);
}

/// They end with it: END, and the hit.
fn end_ray(batch: &mut OpBatch, ray: u32) {
    batch.cells[0].push(OpKind::WriteY, 1);
    batch.cells[1].push(OpKind::ReadY, 1);
    batch.cells[1].push(OpKind::WriteY, 1);
    batch.cells[2].push(OpKind::ReadY, 1);
    batch.cells[2].push(OpKind::WriteY, 5);
    batch.cells.iter_mut().for_each(|cell| cell.end_line(ray));
}

/// The macro-pipeline: single words on Y, each with its own computing.
fn pipeline() -> OpBatch {
    let mut batch = OpBatch::new(3);
    for ray in 0..RAYS {
        begin_ray(&mut batch, ray);
        for candidate in 0..30 {
            batch.cells[0].push(OpKind::Work(GRID_VOXEL), 1 + varying(ray, candidate, 6));
            batch.cells[0].push(OpKind::WriteY, 1);
            batch.cells[1].push(OpKind::ReadY, 1);
            batch.cells[1].push(OpKind::Work(SLABS_POLYGON), 1);
            if varying(ray, candidate, 10) == 0 {
                batch.cells[1].push(OpKind::WriteY, 1);
                batch.cells[2].push(OpKind::ReadY, 1);
                batch.cells[2].push(OpKind::Work(INTERSECTION_POLYGON), 1);
            }
        }
        end_ray(&mut batch, ray);
    }
    batch
}

/// How many voxels the grid's cell is ahead of the intersection's, in the pipeline with stop words.
const AHEAD: u64 = 4;

/// How far a cell of it is behind the voxel that it has just done.
fn lag(cell: u64) -> u64 {
    (AHEAD - 1) * (2 - cell) / 2
}

/// What the cells of the pipeline with stop words do before the first ray.
fn head_start() -> OpBatch {
    let mut batch = OpBatch::new(3);
    for (cell, ops) in (0..).zip(&mut batch.cells).skip(1) {
        ops.push(OpKind::WriteZ, lag(cell - 1) - lag(cell));
    }
    batch
}

/// The macro-pipeline with stop words: candidates in every third voxel, and an answer on Z for each voxel.
fn stopped() -> OpBatch {
    let mut batch = OpBatch::new(3);
    for ray in 0..RAYS {
        begin_ray(&mut batch, ray);
        for voxel in 0..30 {
            batch.cells[0].push(OpKind::Work(GRID_VOXEL), 1);
            if varying(ray, voxel, 3) == 0 {
                batch.cells[0].push(OpKind::WriteY, 1);
                batch.cells[1].push(OpKind::ReadY, 1);
                batch.cells[1].push(OpKind::Work(SLABS_POLYGON), 1);
            }
            // The voxel goes on from cell to cell, and a word comes back.
            for (cell, ops) in batch.cells.iter_mut().enumerate() {
                let (is_first, is_last) = (cell == 0, cell == 2);
                let both = [(OpKind::ReadY, !is_first), (OpKind::WriteY, !is_last)];
                let back = [(OpKind::ReadZ, !is_last), (OpKind::WriteZ, !is_first)];
                both.into_iter().chain(back).filter(|(_, does)| *does).for_each(|(kind, _)| ops.push(kind, 1));
            }
        }
        end_ray(&mut batch, ray);
    }
    batch
}

/// Nothing but words: what the links move at best.
fn stream(cells: usize) -> OpBatch {
    let mut batch = OpBatch::new(cells);
    for ray in 0..RAYS {
        batch.host.push(OpKind::WriteX, 8);
        batch.host.end_line(ray);
        for cell in 0..cells {
            batch.cells[cell].push(OpKind::PassX, 8);
            if cell > 0 {
                batch.cells[cell].push(OpKind::ReadY, 5);
            }
            batch.cells[cell].push(OpKind::WriteY, 5);
            batch.cells[cell].end_line(ray);
        }
    }
    batch
}

fn varying(ray: u32, salt: usize, range: u64) -> u64 {
    let mixed =
        (ray as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (salt as u64).wrapping_mul(0xD1B5_4A32_D192_ED03);
    (mixed.wrapping_mul(0x94D0_49BB_1331_11EB) >> 33) % range
}

/// Figure 7.
fn costs() -> Costs {
    let machine = MachineFile::standard().and_then(|file| file.build()).expect("the standard machine");
    work::costs(&work::vocabulary(false), &machine.times, None)
}

/// What an array is watched by.
#[derive(Clone, Copy, PartialEq)]
enum Watched {
    Not,
    Probed,
    Explained,
}

/// Links of an eighth of the standard rate, in 10^6 bytes a second: each word waits for the one before it.
const SLOW_LINK_MB_S: f64 = 10.0;

/// Seconds and words of a run over the same batch many times, behind what comes first.
fn run((first, batch): (&OpBatch, &OpBatch), spec: &MachineSpec, watched: Watched) -> (f64, u64) {
    let array = Array::new(spec, &costs(), batch.cells.len());
    let mut array = match watched {
        Watched::Not => array,
        Watched::Probed => array.probed(),
        Watched::Explained => array.explained(CriticalPath::MOST_OPS),
    };
    let batches: Vec<OpBatch> = std::iter::once(first).chain((0..BATCHES).map(|_| batch)).cloned().collect();
    let start = Instant::now();
    for batch in batches {
        array.feed(batch).expect("an array can do it");
        array.run().expect("it never gets stuck");
    }
    let (stats, observed) = array.finish_observed().expect("it ends");
    black_box(observed);
    let seconds = start.elapsed().as_secs_f64();
    (seconds, black_box(stats).fifos.iter().map(|fifo| fifo.words.0).sum())
}

fn median_rate(ops: (&OpBatch, &OpBatch), spec: &MachineSpec, watched: Watched) -> f64 {
    let rate = |(seconds, words): (f64, u64)| words as f64 / seconds / 1e6;
    let mut rates: Vec<f64> = (0..7).map(|_| rate(run(ops, spec, watched))).collect();
    rates.sort_by(f64::total_cmp);
    rates[rates.len() / 2]
}

fn main() {
    println!(
        "{:<32} {:>10} {:>16} {:>12} {:>12}",
        "program", "FIFO words", "million words/s", "with probe", "with path"
    );
    let standard = MachineSpec::default().link_mb_s;
    let programs = [
        ("pipeline", pipeline(), standard),
        ("broadcast, 8 cells", broadcast(8), standard),
        ("broadcast, 64 cells", broadcast(64), standard),
        ("words only, 8 cells", stream(8), standard),
        ("pipeline, stop words", stopped(), standard),
        ("pipeline, slow links", pipeline(), SLOW_LINK_MB_S),
        ("broadcast, 8 cells, slow links", broadcast(8), SLOW_LINK_MB_S),
    ];
    let only = std::env::args().nth(1).filter(|arg| !arg.starts_with("--"));
    for (name, batch, link_mb_s) in
        programs.iter().filter(|(name, ..)| only.as_ref().is_none_or(|only| name.contains(only.as_str())))
    {
        let first = if name.contains("stop words") { head_start() } else { OpBatch::new(batch.cells.len()) };
        for fifo_words in [512, 64, 8] {
            let spec = MachineSpec { fifo_words: Words(fifo_words), link_mb_s: *link_mb_s, ..MachineSpec::default() };
            let [alone, probed, explained] = [Watched::Not, Watched::Probed, Watched::Explained]
                .map(|watched| median_rate((&first, batch), &spec, watched));
            println!("{name:<32} {fifo_words:>10} {alone:>16.0} {probed:>12.0} {explained:>12.0}");
        }
    }
    if only.as_ref().is_none_or(|only| only == "farm") {
        println!("farm of 8 workers, 640 x 512 pixels, and of one: {:.3} s", median_farm());
    }
    if only.as_ref().is_none_or(|only| only == "cube") {
        cube();
    }
}

/// How long images on 32 nodes take: tracing them on one thread, and letting the nodes run, with how many things they do a second.
fn cube() {
    for (scene, size, node_kbyte) in [("teapot", "256x256", 4096), ("reference", "512x512", 16384)] {
        let mut options = CubeRunOptions::default();
        options.scene.scene = Some(scene.to_owned());
        options.set("size", size).expect("it is a size");
        options.machine.node_kbyte = Some(node_kbyte);
        let spec = CubeSpec::new(&options, None).expect("it is possible");
        let machine = spec.machine.build().expect("it is possible");
        let start = Instant::now();
        let laid_out = spec.lay_out(false, &Workers::new(1), |_| Ok::<_, Infallible>(())).expect("it fits");
        let traced = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let outcome = spec.run(&laid_out, &machine, &Watching::default(), &Cancel::default()).expect("it ends");
        let ran = start.elapsed().as_secs_f64();
        // Beginning a pixel; a leg; and each end of a message.
        let legs: u64 = outcome.seen.nodes.iter().map(|node| node.legs).sum();
        let messages: u64 = outcome.seen.messages.iter().map(|counts| counts.sent + counts.taken).sum();
        let events = laid_out.graph.trees.len() as u64 + legs + messages;
        let rays = laid_out.graph.rays.len();
        println!(
            "{scene} {size} on 32 nodes: {rays} rays traced in {traced:.2} s; nodes {ran:.2} s, {events} events, {:.1} million/s",
            events as f64 / ran / 1e6
        );
    }
}

/// Seconds in which the tasks of a farm run, and those of the one worker that it is compared with.
fn median_farm() -> f64 {
    let mut options = FarmRunOptions::default();
    options.set("size", "640x512").expect("it is a size");
    let spec = FarmSpec::new(&options, None).expect("it is possible");
    let machine = spec.machine.build().expect("it is possible");
    let scene = spec.lay_out(&Workers::new(1), |_| Ok::<_, Infallible>(())).expect("it fits");
    let items = spec.cut(&scene, &machine).expect("it can be counted");
    let seconds = || {
        let start = Instant::now();
        let outcome = spec.run((&scene, &machine, &items), &Watching::default(), &Cancel::default());
        black_box(outcome.expect("it ends"));
        start.elapsed().as_secs_f64()
    };
    let mut seconds: Vec<f64> = (0..7).map(|_| seconds()).collect();
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}
