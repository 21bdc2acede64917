#![no_main]

use libfuzzer_sys::fuzz_target;
use pcs_sim::isa::{Executable, Sources, assemble, listing, object};

thread_local! {
    static CYCLES: pcs_sim::isa::InstructionCycles = pcs_sim::machine::MachineFile::standard()
        .and_then(|machine| machine.build())
        .ok()
        .and_then(|machine| machine.instructions)
        .expect("the standard machine has instructions");
}

fuzz_target!(|data: &[u8]| {
    let object = [b"pcs object\n", data].concat();
    let Ok(program) = object::load(&pcs_sim_fuzz::file("program.obj", &object)) else { return };
    let source = listing::disassembly(&program);
    // A word that is no instruction has no source text.
    if let Ok(again) = assemble(&pcs_sim_fuzz::file("program.s", source.as_bytes()), Sources::Files, &[]) {
        assert_eq!((&again.code, &again.data), (&program.code, &program.data));
    }
    let _ = listing::listing(&Executable::new(program, &CYCLES.with(Clone::clone)));
});
