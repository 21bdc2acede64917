#![no_main]

use libfuzzer_sys::fuzz_target;
use pcs_sim::isa::{Executable, InstructionCycles, Processor, Queues, object};
use pcs_sim::seam::OpStream;

thread_local! {
    static CYCLES: InstructionCycles = pcs_sim::machine::MachineFile::standard()
        .and_then(|machine| machine.build())
        .ok()
        .and_then(|machine| machine.instructions)
        .expect("the standard machine has instructions");
}

fuzz_target!(|data: &[u8]| {
    let Ok(program) = object::load(&pcs_sim_fuzz::file("program.s", data)) else { return };
    let executable = Executable::new(program, &CYCLES.with(Clone::clone));
    let mut queues = Queues::default();
    queues.restart(&[0, 1, u32::MAX, 0x3F80_0000, 0x7FC0_0000, 0x8000_0000, 7, 8]);
    let data = &executable.program().data;
    let _ = Processor::new(&executable, data, &[3, 4], 20_000).run(&mut queues, &mut OpStream::default());
});
