#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let machine = pcs_sim::machine::MachineFile::read(&pcs_sim_fuzz::file("machine.ron", data));
    let _ = machine.map(|machine| machine.build());
});
