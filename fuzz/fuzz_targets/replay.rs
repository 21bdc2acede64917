#![no_main]

use libfuzzer_sys::fuzz_target;
use pcs_sim::error::InputError;
use pcs_sim::machine::Stuck;
use pcs_sim::program::MachineFile;
use pcs_sim::report::activity::ActivityTrace;
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

fuzz_target!(|data: &[u8]| {
    let Ok(mut trace) = ActivityTrace::open(&pcs_sim_fuzz::file("trace.ops", data)) else { return };
    let Ok(machine) = MachineFile::standard().and_then(|machine| machine.build()) else { return };
    let cells = trace.cells();
    let _ = simulation::replay(&machine.spec, cells, |take| trace.for_each_batch::<Refused>(take));
});
