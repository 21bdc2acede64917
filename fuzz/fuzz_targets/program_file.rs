#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let program = pcs_sim::program::ArrayProgram::read(&pcs_sim_fuzz::file("program.ron", data));
    let _ = program.map(|program| program.check());
});
