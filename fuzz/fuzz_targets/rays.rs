#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let _ = pcs_sim::host::ray_file::read(&pcs_sim_fuzz::file("rays.csv", data));
});
