#![no_main]

use libfuzzer_sys::fuzz_target;
use pcs_sim::cancel::Cancel;
use pcs_sim::error::InputError;
use pcs_sim::machine::MachineFile;
use pcs_sim::program::work;
use pcs_sim::run::{self, RunError};
use pcs_sim::seam::activity_trace::ActivityTrace;

fuzz_target!(|data: &[u8]| {
    let file = pcs_sim_fuzz::file("trace.ops", data);
    let Ok(mut trace) = ActivityTrace::open(&file, &work::cycles_vocabulary()) else { return };
    let Ok(machine) = MachineFile::standard().and_then(|machine| machine.build()) else { return };
    let (cells, costs) = (trace.cells(), trace.costs().clone());
    let _ = run::replay::<InputError>(&machine.spec, &costs, cells, &Cancel::default(), |take| {
        trace.for_each_batch::<RunError<InputError>>(|batch| take(batch.into()))
    });
});
