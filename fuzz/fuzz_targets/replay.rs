#![no_main]

use libfuzzer_sys::fuzz_target;
use pcs_sim::error::InputError;
use pcs_sim::machine::{MachineFile, Stuck};
use pcs_sim::program::work;
use pcs_sim::seam::BatchError;
use pcs_sim::seam::activity_trace::ActivityTrace;
use pcs_sim::simulation;

/// Why a trace is no run.
struct Refused;

impl From<InputError> for Refused {
    fn from(_: InputError) -> Refused {
        Refused
    }
}

impl From<Stuck> for Refused {
    fn from(_: Stuck) -> Refused {
        Refused
    }
}

impl From<BatchError> for Refused {
    fn from(_: BatchError) -> Refused {
        Refused
    }
}

fuzz_target!(|data: &[u8]| {
    let Ok(mut trace) = ActivityTrace::open(&pcs_sim_fuzz::file("trace.ops", data), &work::cycles_vocabulary()) else { return };
    let Ok(machine) = MachineFile::standard().and_then(|machine| machine.build()) else { return };
    let (cells, costs) = (trace.cells(), trace.costs().clone());
    let _ = simulation::replay(&machine.spec, &costs, cells, |take| trace.for_each_batch::<Refused>(take));
});
