//! What a user of the library may hand to an array by hand: nothing of it panics or hangs.

use std::sync::Arc;

use pcs_sim::machine::{Array, Cycles, MachineSpec, Words};
use pcs_sim::seam::{BatchError, Costs, OpBatch, OpKind, Vocabulary};

fn costs() -> Costs {
    Costs::new(Arc::new(Vocabulary::of_cycles(&[('t', "think")], 5)), |_| Cycles(1))
}

/// Two jobs for one cell.
fn jobs() -> OpBatch {
    let mut batch = OpBatch::new(1);
    for job in 0..2 {
        batch.host.push(OpKind::WriteX, 8);
        batch.host.end_line(job);
        batch.cells[0].push(OpKind::PassX, 8);
        batch.cells[0].push(OpKind::WriteY, 5);
        batch.cells[0].end_line(job);
    }
    batch
}

/// The cycles of the two jobs on a machine.
fn cycles_on(spec: &MachineSpec) -> Cycles {
    let mut array = Array::new(spec, &costs(), 1).probed().recorded(Cycles(0)..Cycles(100), 1000);
    array.feed(jobs()).expect("one cell can do it");
    array.finish_observed().expect("it comes to an end").0.cycles
}

#[test]
fn an_impossible_machine_is_the_nearest_possible_one() {
    let pcs = MachineSpec::default;
    let most = MachineSpec::MAX_LATENCY_CYCLES;
    for (impossible, nearest) in [
        (MachineSpec { fifo_words: Words(0), ..pcs() }, MachineSpec { fifo_words: Words(1), ..pcs() }),
        (MachineSpec { channel_words: [Some(Words(0)); 3], ..pcs() }, MachineSpec { fifo_words: Words(1), ..pcs() }),
        (MachineSpec { fifo_words: Words(u64::MAX), ..pcs() }, pcs()),
        (MachineSpec { latency: Cycles(0), ..pcs() }, pcs()),
        (MachineSpec { latency: Cycles(u64::MAX), ..pcs() }, MachineSpec { latency: Cycles(most), ..pcs() }),
        (MachineSpec { link_mb_s: f64::NAN, ..pcs() }, pcs()),
        (MachineSpec { clock_ns: 0.0, link_mb_s: f64::INFINITY, ..pcs() }, pcs()),
    ] {
        assert_eq!(cycles_on(&impossible), cycles_on(&nearest), "{impossible:?}");
    }
    // A link that never carries a word carries one in a million cycles.
    let slowest = cycles_on(&MachineSpec { link_mb_s: 0.0, ..pcs() });
    assert!(slowest > Cycles(16 * MachineSpec::MAX_WORD_CYCLES), "{slowest}");
}

#[test]
fn an_array_takes_only_what_its_cells_can_do() {
    let mut array = Array::new(&MachineSpec::default(), &costs(), 0);
    let found = OpBatch::new(0);
    assert_eq!(array.feed(found), Err(BatchError::Cells { found: 0, expected: 1 }), "no cells are one");
    assert_eq!(array.feed(OpBatch::new(2)), Err(BatchError::Cells { found: 2, expected: 1 }));
    let mut batch = jobs();
    batch.cells[0].push(OpKind::Await, 0);
    batch.cells[0].end_line(2);
    assert_eq!(array.feed(batch), Err(BatchError::Await { cell: 0 }));
    // What was refused has left nothing behind.
    array.feed(jobs()).expect("one cell can do it");
    assert_eq!(array.finish().expect("it comes to an end").cycles, cycles_on(&MachineSpec::default()));
}

/// The waits of an array of so many cells that can go no further, as a person reads them.
fn standstill(cells: usize, ops: &[(usize, OpKind)]) -> String {
    let mut batch = OpBatch::new(cells);
    batch.host.push(OpKind::WriteX, 8);
    batch.host.end_line(0);
    for &(cell, kind) in ops {
        batch.cells[cell].push(kind, 1);
        batch.cells[cell].end_line(0);
    }
    let mut array = Array::new(&MachineSpec::default(), &costs(), cells);
    array.feed(batch).expect("the ops are some of a cell's");
    array.finish().expect_err("nobody ever writes what is read").to_string()
}

#[test]
fn a_standstill_tells_how_many_wait() {
    insta::assert_snapshot!(
        standstill(1, &[(0, OpKind::ReadY)]),
        @"starved: the host has done all its ops, one still waiting"
    );
    insta::assert_snapshot!(standstill(2, &[(0, OpKind::ReadZ), (1, OpKind::ReadY)]), @"deadlock, 2 still waiting");
}
