//! What everybody does in one cycle, against the ticking model.

use crate::support::random_ops::{batches_of, case, costs};
use crate::support::ticking::{History, run_recorded};
use pcs_sim::machine::line::{MOVING, blocked, waiting, working};
use pcs_sim::machine::{Array, Cycles, MachineSpec, Observed, Unfinished};
use pcs_sim::measure::{Doing, StateId, Topology, What, When};
use pcs_sim::seam::{Channel, Costs, OpBatch, Unit};
use proptest::prelude::*;

/// What is seen of the batches when something is looked for. `None` if they are stuck.
fn look(spec: &MachineSpec, costs: &Costs, batches: &[OpBatch], when: When) -> Option<(Observed, Topology)> {
    let attempt = |limit: Cycles| {
        let mut array = Array::until(spec, costs, batches[0].cells.len(), limit).explained(50).looking_at(when);
        for batch in batches {
            array.feed(batch.clone()).expect("an array can do it");
            array.run()?;
        }
        array.finish_observed()
    };
    let mut result = attempt(Cycles(u64::MAX));
    if let Err(Unfinished::Outlived(cycles)) = result {
        result = attempt(cycles);
    }
    result.ok().map(|(measured, observed)| (observed, (*measured.topology).clone()))
}

/// The state that a cell is in that does something.
fn state(doing: &Doing, topology: &Topology, costs: &Costs) -> Option<StateId> {
    let channel = |fifo: usize| {
        let group = topology.fifos[fifo].group.as_str();
        Channel::ALL.into_iter().find(|channel| channel.to_string() == group).expect("there is such a channel")
    };
    Some(match doing.what {
        What::Works { unit, .. } => working(costs.activity(Unit(unit as u8))),
        What::Moves { .. } => MOVING,
        // Only FIFOs of Z may carry no word.
        What::WaitsForWord { fifo, .. } => waiting(fifo.map_or(Channel::Z, channel)),
        What::WaitsForSlot { fifo } | What::WaitsForWire { fifo } => blocked(channel(fifo)),
        What::WaitsForAnswer { .. } => panic!("only the host waits for answers"),
        What::Done => return None,
    })
}

/// The job of each op of a cell.
fn jobs(batches: &[OpBatch], cell: usize) -> Vec<u32> {
    let lines = batches.iter().flat_map(|batch| batch.cells[cell].lines());
    lines.flat_map(|(job, ops)| vec![job; ops.len()]).collect()
}

/// The cycles around one in which a cell stays at the same op and in the same state.
fn stretch(history: &History, cell: usize, at: usize) -> (u64, u64) {
    let (states, ops) = (&history.states[cell], &history.at[cell]);
    let same = |other: &usize| (states[*other], ops[*other]) == (states[at], ops[at]);
    let since = (0..=at).rev().take_while(same).last().unwrap_or(at);
    let until = (at..states.len()).take_while(same).last().unwrap_or(at) + 1;
    (since as u64, until as u64)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3_000, ..ProptestConfig::default() })]

    #[test]
    fn snapshots_equal_the_ticking_model((spec, cells, rays, per_batch) in case(), place in 0.0..1.0f64) {
        let (batches, costs) = (batches_of(cells, &rays, per_batch), costs());
        let Some((ticked, history)) = run_recorded(&spec, &costs, &batches) else { return Ok(()) };
        let at = (ticked.cycles.0 as f64 * place) as usize;
        let (seen, topology) = look(&spec, &costs, &batches, When::Cycle(Cycles(at as u64))).expect("it ends");
        let snapshot = seen.snapshot.expect("the cycle is known");
        for (cell, doing) in snapshot.stations.iter().enumerate() {
            let Some(state) = state(doing, &topology, &costs) else {
                prop_assert_eq!(history.at[cell][at], jobs(&batches, cell).len(), "cell {} is done", cell);
                continue;
            };
            prop_assert_eq!(state, history.states[cell][at], "cell {} at {}: {:?}", cell, at, doing);
            prop_assert_eq!(doing.job, Some(jobs(&batches, cell)[history.at[cell][at]]));
            let (since, until) = match doing.what {
                What::Moves { .. } => (at as u64, at as u64 + 1),
                _ => stretch(&history, cell, at),
            };
            prop_assert_eq!(doing.since, Cycles(since));
            // The history ends with the run, and what is under way then does not.
            prop_assert!(doing.until == Cycles(until) || until == ticked.cycles.0, "{:?} ends at {}", doing, until);
            let level = |fifo: usize| history.occupancies[fifo][at];
            match doing.what {
                What::WaitsForWord { fifo: Some(fifo), written } if written > Cycles(at as u64) => {
                    prop_assert_eq!(level(fifo), 0);
                }
                What::WaitsForWord { fifo: Some(fifo), .. } => prop_assert!(level(fifo) > 0),
                // In its last cycle the word before is read.
                What::WaitsForSlot { fifo } if doing.until.0 > at as u64 + 1 => {
                    prop_assert_eq!(level(fifo), topology.fifos[fifo].capacity.unwrap().0);
                }
                _ => {}
            }
        }
    }

    /// The moment that is found for a job lies in the longest wait of the cell while it is at the job.
    #[test]
    fn the_longest_wait_of_a_job_is_found((spec, cells, rays, per_batch) in case(), job in 0u32..24, cell in 0usize..4) {
        let (batches, costs) = (batches_of(cells, &rays, per_batch), costs());
        let (cell, job) = (cell % cells, job % rays.len() as u32);
        let Some((_, history)) = run_recorded(&spec, &costs, &batches) else { return Ok(()) };
        let (seen, topology) = look(&spec, &costs, &batches, When::Job { station: cell, job }).expect("it ends");
        prop_assert_eq!(seen.snapshot, None);
        let (jobs, states) = (jobs(&batches, cell), &history.states[cell]);
        let waits = |state: StateId| Channel::ALL.iter().any(|&c| state == waiting(c) || state == blocked(c));
        let of_job = (0..states.len()).filter(|&at| jobs.get(history.at[cell][at]) == Some(&job));
        let lengths = of_job.filter(|&at| waits(states[at])).map(|at| stretch(&history, cell, at));
        let Some(longest) = lengths.map(|(since, until)| until - since).max() else { return Ok(()) };
        let at = seen.looked_at.expect("the cell comes to the job").0;
        prop_assert!(waits(states[at as usize]), "{}", at);
        let (since, until) = stretch(&history, cell, at as usize);
        prop_assert_eq!(until - since, longest);
        let again = look(&spec, &costs, &batches, When::Cycle(Cycles(at))).expect("it ends").0;
        let doing = again.snapshot.expect("the cycle is known").stations[cell];
        prop_assert_eq!((doing.job, state(&doing, &topology, &costs)), (Some(job), Some(states[at as usize])));
    }
}
