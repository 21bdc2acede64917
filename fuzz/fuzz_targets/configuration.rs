#![no_main]

use libfuzzer_sys::fuzz_target;
use pcs_sim::run::{CubeSpec, FarmSpec, PlannedRun, ReplaySpec, RunSpec};

fuzz_target!(|data: &[u8]| {
    let file = pcs_sim_fuzz::file("run.json", data);
    let _ = RunSpec::read(&file).and_then(PlannedRun::new);
    let _ = ReplaySpec::read(&file);
    let _ = FarmSpec::read(&file);
    let _ = CubeSpec::read(&file);
});
