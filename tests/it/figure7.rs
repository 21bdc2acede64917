//! Cycle counts worked out by hand from Figure 7 for single rays, in each mode.
//!
//! In cycles of 50 ns: grid 600 + 156 a voxel, slabs 180 + 260 a polygon, intersection 20 + 600 a polygon. The host
//! writes a ray's 8 words in cycles 0 to 7; cell 0 reads them in 1 to 8, cell 1 in 2 to 9, cell 2 in 3 to 10.

use std::convert::Infallible;

use crate::support::{fifo, machine, program, spent, workload};
use glam::Vec3;
use pcs_sim::geometry::Ray;
use pcs_sim::measure::Measured;
use pcs_sim::program::ArrayProgram;
use pcs_sim::run::{self, Workers};
use pcs_sim::scene::Mesh;

/// Squares one behind the other, from z = 0 on.
fn squares(count: u32) -> Mesh {
    let mut mesh = Mesh::default();
    for z in 0..count {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
        let points = corners.map(|[x, y]| mesh.add_point(Vec3::new(x, y, z as f32)));
        mesh.add_face(&points, 0);
    }
    mesh
}

/// One ray through a grid of just one voxel, in a program of so many groups.
fn run(mode: &str, groups: usize, mesh: &Mesh, ray: Ray) -> Measured {
    let polygons = mesh.faces().len() as f64;
    let program = ArrayProgram { grid_coefficient: 1.0 / polygons, ..program(mode, groups) };
    let workload = workload(mesh, &program, &[ray]);
    assert!(workload.grids().all(|grid| grid.voxel_count() == 1));
    run::run(&workload, &machine().spec, &[ray], &Workers::new(1), |_| Ok::<_, Infallible>(())).unwrap().stats
}

/// Along z through all squares.
fn through() -> Ray {
    Ray::new(Vec3::new(0.5, 0.7, -1.0), Vec3::Z)
}

/// Beside all squares.
fn beside() -> Ray {
    Ray::new(Vec3::new(9.0, 9.0, -1.0), Vec3::Z)
}

/// What each cell spent on the three kernels.
fn busy(run: &Measured) -> Vec<[u64; 3]> {
    let of = |cell: usize| ["grid", "slabs", "intersection"].map(|kernel| spent(run, cell, kernel));
    (0..run.stations.len()).map(of).collect()
}

/// What each cell spent in a state.
fn all(run: &Measured, state: &str) -> Vec<u64> {
    (0..run.stations.len()).map(|cell| spent(run, cell, state)).collect()
}

#[test]
fn pipeline_miss() {
    // P1: grid 9-608, END 609. P2: slabs start 10-189, waits from 190, END in 610, out 611.
    // P3: intersection start 11-30, waits from 31, END in 612, HIT 613-617. The host reads its last word in 618.
    let stats = run("pipeline", 1, &squares(1), beside());
    assert_eq!(stats.cycles.0, 619);
    assert_eq!(busy(&stats), [[600, 0, 0], [0, 180, 0], [0, 0, 20]]);
    assert_eq!(all(&stats, "moving"), [9, 10, 14]);
    assert_eq!(all(&stats, "waiting X"), [1, 2, 3]);
    assert_eq!(all(&stats, "waiting Y"), [0, 420, 581]);
    assert_eq!(all(&stats, "idle"), [9, 7, 1]);
}

#[test]
fn pipeline_one_voxel_with_one_polygon() {
    // P1: grid 9-764, candidate 765, END 766. P2: candidate in 766, slabs 767-1026, out 1027, END in 1028, out 1029.
    // P3: candidate in 1028, intersection 1029-1628, END in 1629, HIT 1630-1634. The host reads the last word in 1635.
    let stats = run("pipeline", 1, &squares(1), through());
    assert_eq!(stats.cycles.0, 1636);
    assert_eq!(busy(&stats), [[756, 0, 0], [0, 440, 0], [0, 0, 620]]);
}

#[test]
fn pipeline_three_candidates() {
    // P1: grid 9-764, candidates and END 765-768. P2: in 766, slabs 767-1026, out 1027; in 1028, 1029-1288, out 1289;
    // in 1290, 1291-1550, out 1551; END in 1552, out 1553. P3: in 1028, intersection 1029-1628; in 1629, 1630-2229;
    // in 2230, 2231-2830; END in 2831, HIT 2832-2836. The host reads the last word in 2837.
    let stats = run("pipeline", 1, &squares(3), through());
    assert_eq!(stats.cycles.0, 2838);
    assert_eq!(busy(&stats), [[756, 0, 0], [0, 960, 0], [0, 0, 1820]]);
    // From 1553 to 1628 Y2 holds the second and third candidate and END.
    assert_eq!(fifo(&stats, "Y2").max.0, 3);
}

#[test]
fn broadcast_of_one_cell() {
    // A miss: grid 9-608, HIT 609-613, read by 614.
    assert_eq!(run("broadcast", 1, &squares(1), beside()).cycles.0, 615);
    // A hit: grid 9-764, slabs 765-1204, intersection 1205-1824, HIT 1825-1829, read by 1830.
    assert_eq!(run("broadcast", 1, &squares(1), through()).cycles.0, 1831);
    // Three candidates: grid 9-764, then 180 + 20 + 3 x (260 + 600) cycles to 3544, HIT 3545-3549, read by 3550.
    assert_eq!(run("broadcast", 1, &squares(3), through()).cycles.0, 3551);
}

#[test]
fn broadcast_of_two_cells_miss() {
    // Cell 0: grid 9-608, HIT 609-613. Cell 1: grid 10-609, HIT in 610-614, out 615-619. The host reads it by 620.
    let stats = run("broadcast", 2, &squares(2), beside());
    assert_eq!(stats.cycles.0, 621);
    assert_eq!(all(&stats, "moving"), [13, 18]);
}

#[test]
fn broadcast_of_two_cells_one_square_each() {
    // Squares at z = 0 and 1, cut at z = 1/2. Cell 0 does one square as a single cell does: HIT 1825-1829.
    // Cell 1 is a cycle later: intersection to 1825, HIT in 1826-1830, out 1831-1835. The host reads it by 1836.
    let mut mesh = squares(2);
    mesh.points.iter_mut().for_each(|point| point.z *= 9.0);
    assert_eq!(run("broadcast", 2, &mesh, through()).cycles.0, 1837);
}

#[test]
fn hybrid_of_two_stages() {
    // A miss: cell 0: grid 9-608, END 609. Cell 1: start 10-29, END in 610, HIT 611-615, read by 616.
    assert_eq!(run("hybrid", 1, &squares(1), beside()).cycles.0, 617);
    // A hit: cell 0: grid 9-764, slabs 765-1204, candidate 1205, END 1206. Cell 1: in 1206, intersection 1207-1806,
    // END in 1807, HIT 1808-1812, read by 1813.
    assert_eq!(run("hybrid", 1, &squares(1), through()).cycles.0, 1814);
}

#[test]
fn hybrid_of_two_groups_passes_hits_on() {
    // A miss. Group 0 as above: HIT 611-615. Group 1, cell 2: grid 11-610, END 611, HIT in 612-616, out 617-621.
    // Cell 3: start 12-31, END in 612, HIT in 618-622, out 623-627, read by 628.
    let stats = run("hybrid", 2, &squares(2), beside());
    assert_eq!(stats.cycles.0, 629);
    assert_eq!(spent(&stats, 3, "waiting Y"), (612 - 32) + (618 - 613));
}
