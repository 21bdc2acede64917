//! Stop words and rays forwarded ahead: what they change, what they leave as it was, and how deep their FIFOs must be.

use std::convert::Infallible;

use crate::support::ticking::{self, Ticked};
use crate::support::{bits, machine, ops, priced, program, scene};
use pcs_sim::geometry::Ray;
use pcs_sim::host::camera::ImageSize;
use pcs_sim::host::policy::HostRules;
use pcs_sim::host::sampling::Sampling;
use pcs_sim::host::shading::Limits;
use pcs_sim::machine::{Array, MachineSpec, Words};
use pcs_sim::program::work;
use pcs_sim::program::{ArrayProgram, Counts, Kernel, Workload};
use pcs_sim::run::{self, Picture, Rendered, RunError, Seen, Timed, Watching, Workers};
use pcs_sim::scene::Scene;
use pcs_sim::seam::{OpBatch, OpKind};

const SCENES: [(&str, u32); 3] = [("room", 1), ("teapot", 4), ("reference", 2)];

fn with_words(program: ArrayProgram, ahead: u32) -> ArrayProgram {
    ArrayProgram { stop_words: Some(ahead), ..program }
}

/// Every way to spread the kernels over the cells of a group.
fn spreads() -> [ArrayProgram; 4] {
    let filters_last = vec![vec![Kernel::Grid], vec![Kernel::Slabs, Kernel::Intersection]];
    let no_slabs = vec![vec![Kernel::Grid], vec![Kernel::Intersection]];
    let spread = |stages| ArrayProgram { stages, ..program("hybrid", 2) };
    [program("pipeline", 1), program("hybrid-3", 2), spread(filters_last), spread(no_slabs)]
}

/// Hits and counts of a run under a machine, or why it failed.
fn run(workload: &Workload, spec: &MachineSpec, rays: &[Ray]) -> Result<(Vec<[u32; 4]>, Counts), RunError<Infallible>> {
    let outcome = run::run(workload, spec, rays, &Workers::new(1), |_| Ok::<_, Infallible>(()))?;
    Ok((outcome.hits.iter().map(bits).collect(), outcome.counts))
}

fn workload(scene: &Scene, program: &ArrayProgram, rays: &[Ray]) -> Workload {
    crate::support::workload(&scene.mesh, program, rays)
}

fn depth(fifo_words: u64) -> MachineSpec {
    MachineSpec { fifo_words: Words(fifo_words), ..MachineSpec::default() }
}

/// The shallowest FIFOs that a workload accepts.
fn least_depth(workload: &Workload) -> u64 {
    (1..).find(|&words| workload.check(&depth(words)).is_ok()).unwrap()
}

#[test]
fn stop_words_keep_the_hits_in_fifos_as_deep_as_they_need() {
    for (name, size) in SCENES {
        let (scene, rays) = scene(name, size, 14);
        for program in spreads() {
            let (hits, free) = run(&workload(&scene, &program, &rays), &depth(512), &rays).unwrap();
            let mut walked = 0;
            for ahead in [1, 2, 3, 8, 21, 100] {
                let workload = workload(&scene, &with_words(program.clone(), ahead), &rays);
                let least = least_depth(&workload);
                for fifo_words in [least, 2 * least, 512] {
                    let (found, counts) = run(&workload, &depth(fifo_words), &rays).unwrap();
                    assert!(found == hits, "{name}, {:?}, {ahead} ahead, {fifo_words} words", program.stages);
                    assert!(counts.voxels >= walked, "farther ahead, farther beyond the hit");
                    assert!(counts.voxels <= free.voxels && counts.slab_tests <= free.slab_tests);
                    assert!(counts.intersection_tests <= free.intersection_tests);
                    walked = counts.voxels;
                }
                assert!(least <= 1 || run(&workload, &depth(least - 1), &rays).is_err(), "{least} words are too many");
            }
        }
    }
}

/// With one voxel ahead the grid's cell walks just as far as one that has the intersection too.
#[test]
fn one_voxel_ahead_walks_no_voxel_in_vain() {
    for (name, size) in SCENES {
        let (scene, rays) = scene(name, size, 20);
        let counts = |program: &ArrayProgram| run(&workload(&scene, program, &rays), &depth(512), &rays).unwrap().1;
        let alone = counts(&program("broadcast", 1));
        assert!(alone.voxels < counts(&program("pipeline", 1)).voxels, "{name} has nothing to gain");
        assert_eq!(counts(&with_words(program("pipeline", 1), 1)), alone);
        let farther = counts(&with_words(program("pipeline", 1), 4)).voxels;
        assert!(alone.voxels < farther && farther <= alone.voxels + 3 * rays.len() as u64);
    }
}

fn text(batch: &OpBatch, cell: usize, line: usize) -> String {
    priced(batch.cells[cell].line(line), &work::costs(&work::vocabulary(false), &machine().times, None))
}

/// A ray through a wall of one square, in a grid of four voxels, and then another.
#[test]
fn what_the_cells_say_to_each_other() {
    let folder = crate::support::command::Folder::new();
    folder.file("wall.obj", "v 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nv 0 4 0\nv 0 4 4\nv 4 4 4\nf 1 2 3 4\nf 5 6 7\n");
    folder.file("rays.csv", "ox,oy,oz,dx,dy,dz\n1,-1,3,0,1,0\n1,9,1,0,-1,0\n");
    let run =
        "--scene wall.obj --rays rays.csv --grid-coefficient 32 --mode pipeline --ops a.ops --ops-form priced --force";
    folder.run(run).success();
    insta::assert_snapshot!("without stop words", folder.read("a.ops"));
    folder.run(&format!("{run} --stop-words 2")).success();
    insta::assert_snapshot!("with stop words", folder.read("a.ops"));
}

/// What is written to Z and never read is what was written before the first ray.
#[test]
fn one_word_goes_back_for_each_voxel() {
    let (scene, rays) = scene("teapot", 4, 9);
    for (program, stages) in [(program("hybrid-3", 2), 3), (program("hybrid", 3), 2)] {
        let batches = ops(&workload(&scene, &with_words(program, 12), &rays), &rays);
        let count = |cell: usize, kind: OpKind| -> u64 {
            let all = batches.iter().flat_map(|batch| batch.cells[cell].ops());
            all.filter(|op| op.kind() == kind).map(|op| op.count() as u64).sum()
        };
        for cell in 1..batches[0].cells.len() {
            let (written, read) = (count(cell, OpKind::WriteZ), count(cell - 1, OpKind::ReadZ));
            match (cell % stages, stages) {
                (0, _) => assert_eq!((written, read), (0, 0), "groups do not talk"),
                (1, 3) => assert_eq!(written - read, 6),
                (2, 3) => assert_eq!(written - read, 5),
                _ => assert_eq!(written - read, 11),
            }
        }
    }
}

#[test]
fn rays_go_ahead_and_each_goes_once() {
    let (scene, rays) = scene("teapot", 4, 4);
    let plain = ops(&workload(&scene, &program("broadcast", 2), &rays), &rays).remove(0);
    for ahead in [1, 5, 15, 16, 40] {
        let program = ArrayProgram { forward_ahead: ahead, ..program("broadcast", 2) };
        let batch = ops(&workload(&scene, &program, &rays), &rays).remove(0);
        let first = 8 * (ahead as usize + 1).min(16);
        for cell in 0..2 {
            for line in 0..16 {
                let rest = text(&plain, cell, line).strip_prefix("x8 ").unwrap().to_owned();
                let expected = match line {
                    0 => format!("x{first} {rest}"),
                    line if line + (ahead as usize) < 16 => format!("x8 {rest}"),
                    _ => rest,
                };
                assert_eq!(text(&batch, cell, line), expected, "{ahead} ahead, cell {cell}, ray {line}");
            }
        }
    }
}

/// A broadcast cell begins a ray only when its left neighbour has merged the one before it, and then goes on to this one: what
/// comes ahead of that just waits. Rays in memory do what X would do with so many more words, and a FIFO that holds more rays
/// than the cells ever lag needs none.
#[test]
fn rays_ahead_cost_memory_and_gain_a_broadcast_nothing() {
    let (scene, rays) = scene("reference", 2, 12);
    for (groups, fifo_words) in [(6, 512), (12, 512), (3, 8)] {
        let timed = |forward_ahead: u32| {
            let workload = workload(&scene, &ArrayProgram { forward_ahead, ..program("broadcast", groups) }, &rays);
            let mut array = Array::new(&depth(fifo_words), workload.costs(), workload.cells());
            for batch in ops(&workload, &rays) {
                array.feed(batch).unwrap();
                array.run().unwrap();
            }
            (array.finish().unwrap().cycles, workload.memory_of(0).rays)
        };
        let (cycles, _) = timed(0);
        for ahead in [1, 3, 50] {
            assert_eq!(timed(ahead), (cycles, Words(8 * ahead as u64)), "{groups} cells, {fifo_words} words");
        }
    }
}

/// An image timed in a closed loop, and the ops of all its rays.
fn image(
    scene: &Scene,
    workload: &Workload,
    spec: &MachineSpec,
) -> Result<(Rendered, Vec<OpBatch>), RunError<Infallible>> {
    let size = ImageSize { width: 12, height: 9 };
    let sampling = Sampling { side: 1, adaptive: None };
    let picture =
        Picture { scene, workload, size, sampling, limits: Limits::default(), screen: None, rules: Default::default() };
    let mut batches = Vec::new();
    let rendered = run::render(
        &picture,
        Some(Timed { spec, rules: HostRules::default(), watching: Watching::default() }),
        &Workers::new(2),
        |seen| {
            if let Seen::Sent(ops, ..) = seen {
                batches.push(ops.clone());
            }
            Ok(())
        },
    )?;
    Ok((rendered, batches))
}

#[test]
fn a_host_that_waits_for_hits_gets_on_with_stop_words() {
    let (scene, rays) = scene("room", 1, 4);
    for (program, ahead) in [(program("pipeline", 1), 2), (program("hybrid", 2), 1)] {
        let plain = image(&scene, &workload(&scene, &program, &rays), &depth(512)).unwrap().0;
        let workload = workload(&scene, &with_words(program, ahead), &rays);
        let spec = depth(least_depth(&workload));
        let (rendered, batches) = image(&scene, &workload, &spec).unwrap();
        assert_eq!(rendered.pixels, plain.pixels);
        assert!(rendered.counts.voxels < plain.counts.voxels);
        let ticked = ticking::run(&spec, workload.costs(), &batches).unwrap();
        assert_eq!(Ticked::from(&rendered.timing.unwrap().stats), ticked);
    }
}

#[test]
fn a_host_that_waits_for_hits_sends_no_rays_ahead() {
    let (scene, rays) = scene("room", 1, 4);
    let workload = workload(&scene, &ArrayProgram { forward_ahead: 1, ..program("broadcast", 2) }, &rays);
    assert!(matches!(image(&scene, &workload, &depth(512)), Err(RunError::Unfit(_))));
}
