#![no_main]

use libfuzzer_sys::fuzz_target;
use pcs_sim::isa::{Sources, assemble};

fuzz_target!(|data: &[u8]| {
    let _ = assemble(&pcs_sim_fuzz::file("program.s", data), Sources::Files, &[]);
});
