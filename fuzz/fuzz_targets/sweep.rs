#![no_main]

use libfuzzer_sys::fuzz_target;
use pcs_sim::sweep::Sweep;

fuzz_target!(|data: &[u8]| {
    let Ok(sweep) = Sweep::read(&pcs_sim_fuzz::file("sweep.ron", data)) else { return };
    let Some(last) = sweep.points().checked_sub(1) else { return };
    assert_eq!(sweep.point(last).len() + sweep.results().len(), sweep.columns().len());
    assert!(last == 0 || sweep.identity(0).len() == sweep.identity(last).len());
    // What is written beside a table is the same sweep.
    let again = Sweep::read(&pcs_sim_fuzz::file("again.ron", sweep.text().as_bytes())).expect("it can be read again");
    assert_eq!(again.points(), sweep.points());
    assert_eq!(again.point(last), sweep.point(last));
});
