#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    pcs_sim_fuzz::scene("scene.cas", data);
});
