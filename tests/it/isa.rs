//! The cell's processor: source text to words, words to cycles and words.

use crate::support::{instruction_costs, priced};
use pcs_sim::isa::{
    Class, Executable, FaultKind, InstructionCycles, Processor, Program, Queues, Sources, Stop, assemble,
};
use pcs_sim::seam::OpStream;

/// Assembles a program that stands in no file.
fn program(text: &str) -> Program {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("test.pcs");
    std::fs::write(&path, text).unwrap();
    assemble(&path, Sources::Files, &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// Each class has a number of its own.
fn cycles() -> InstructionCycles {
    let mut cycles = InstructionCycles {
        integer: 0,
        multiply: 0,
        divide: 0,
        load: 0,
        store: 0,
        float_add: 0,
        float_multiply: 0,
        float_divide: 0,
        float_compare: 0,
        branch: 0,
        float_latency: None,
    };
    for (class, number) in Class::ALL.into_iter().zip([1, 2, 4, 8, 16, 32, 64, 128, 256, 512]) {
        cycles.set(class, number);
    }
    cycles
}

fn ops(stream: &OpStream) -> String {
    priced(stream.ops(), &instruction_costs(&cycles()))
}

#[test]
fn a_sum_of_words_with_a_macro_and_data() {
    let program = program(
        "        .kernel grid
                 .macro accumulate into, word
                 add {into}, {into}, {word}
                 .end
                 .reg sum r1
                 .reg count r2
                 lw count, [words]
         next:   accumulate sum, xp
                 addi count, count, -1
                 bne count, r0, next
                 .kernel other
                 mov y, sum
                 done
                 .data
         words:  .word (1 + 2) * 1",
    );
    let executable = Executable::new(program, &cycles());
    let mut processor = Processor::new(&executable, &executable.program().data, &[], 1_000_000);
    let mut queues = Queues { x: vec![5, 6, 7], ..Queues::default() };
    let mut stream = OpStream::default();
    assert_eq!(processor.run(&mut queues, &mut stream), Ok(Stop::Done));
    assert_eq!(queues.y_out, [18]);
    assert_eq!(queues.x_out, [5, 6, 7]);
    assert_eq!(ops(&stream), "g8 x1 g514 x1 g514 x1 g514 o1");
}

#[test]
fn an_endless_loop_is_a_fault() {
    let executable = Executable::new(program("loop: jmp loop"), &cycles());
    let mut processor = Processor::new(&executable, &[], &[], 10_000);
    let fault = processor.run(&mut Queues::default(), &mut OpStream::default()).unwrap_err();
    assert_eq!(fault.kind, FaultKind::InstructionLimit(10_000));
    assert_eq!(fault.source.unwrap().line, 1);
}
