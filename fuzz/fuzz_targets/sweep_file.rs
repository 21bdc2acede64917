#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    if let Ok(sweep) = pcs_sim::sweep::Sweep::read(&pcs_sim_fuzz::file("sweep.ron", data)) {
        assert!((0..sweep.points().min(16)).all(|point| sweep.point(point).len() == sweep.parameters.len()));
    }
});
