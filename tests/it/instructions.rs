//! Every instruction of the table: what it does, what it costs, how it faults; with registers and with queues.

use crate::support::{instruction_costs, priced};
use pcs_sim::isa::table::TABLE;
use pcs_sim::isa::{
    Class, Executable, FaultKind, InstructionCycles, Processor, Queue, Queues, Register, Sources, Stop, assemble,
};
use pcs_sim::seam::OpStream;

/// What an instruction does, which stands at address 2 of a program of five.
#[derive(Clone, Copy, Debug)]
enum Effect {
    /// `r3`, and on to the next instruction.
    Gives(u32),
    /// The word of memory at an address, and on to the next instruction.
    Stores(u32, u32),
    /// `r3`, and on at an address.
    Goes(u32, u32),
    Stops(Stop),
}
use Effect::*;

/// With `r1` and `r2` as given, the effect, and the class whose cycles it takes.
struct Case(&'static str, u32, u32, Effect, Option<Class>);

const fn f(value: f32) -> u32 {
    value.to_bits()
}

const MINUS: fn(u32) -> u32 = u32::wrapping_neg;
const NAN: u32 = f(f32::NAN);
const INF: u32 = f(f32::INFINITY);
const LEAST: u32 = 1 << 31;

fn cases() -> Vec<Case> {
    use Class::*;
    let (integer, branch) = (Some(Integer), Some(Branch));
    let (add, multiply, divide, compare) = (Some(FloatAdd), Some(FloatMultiply), Some(FloatDivide), Some(FloatCompare));
    vec![
        Case("mov r3, r1", 7, 0, Gives(7), integer),
        Case("li r3, -131072", 0, 0, Gives(MINUS(131072)), integer),
        Case("li r3, 131071", 0, 0, Gives(131071), integer),
        Case("lw r3, [r1 + 1]", 2, 0, Gives(40), Some(Load)),
        Case("lw r3, [r1 - 2]", 2, 0, Gives(10), Some(Load)),
        Case("sw r1, [r2 + 1]", 99, 2, Stores(3, 99), Some(Store)),
        Case("sw r1, [r2 - 1]", 99, 1, Stores(0, 99), Some(Store)),
        Case("add r3, r1, r2", 5, 7, Gives(12), integer),
        Case("add r3, r1, r2", u32::MAX, 2, Gives(1), integer),
        Case("addi r3, r1, -2048", 48, 0, Gives(MINUS(2000)), integer),
        Case("sub r3, r1, r2", 5, 7, Gives(MINUS(2)), integer),
        Case("mul r3, r1, r2", MINUS(3), 7, Gives(MINUS(21)), Some(Multiply)),
        Case("mul r3, r1, r2", 1 << 16, 3 << 16, Gives(0), Some(Multiply)),
        Case("div r3, r1, r2", MINUS(7), 2, Gives(MINUS(3)), Some(Divide)),
        Case("div r3, r1, r2", LEAST, MINUS(1), Gives(LEAST), Some(Divide)),
        Case("rem r3, r1, r2", MINUS(7), 2, Gives(MINUS(1)), Some(Divide)),
        Case("rem r3, r1, r2", LEAST, MINUS(1), Gives(0), Some(Divide)),
        Case("min r3, r1, r2", MINUS(1), 1, Gives(MINUS(1)), integer),
        Case("max r3, r1, r2", MINUS(1), 1, Gives(1), integer),
        Case("and r3, r1, r2", 0b1100, 0b1010, Gives(0b1000), integer),
        Case("or r3, r1, r2", 0b1100, 0b1010, Gives(0b1110), integer),
        Case("xor r3, r1, r2", 0b1100, 0b1010, Gives(0b0110), integer),
        Case("andi r3, r1, 6", 0b1100, 0, Gives(0b0100), integer),
        Case("andi r3, r1, -2", u32::MAX, 0, Gives(u32::MAX - 1), integer),
        Case("shl r3, r1, 4", 0xf000_0001, 0, Gives(0x10), integer),
        Case("shl r3, r1, 33", 1, 0, Gives(2), integer),
        Case("shr r3, r1, 4", 0xf000_0010, 0, Gives(0x0f00_0001), integer),
        Case("sar r3, r1, 4", 0xf000_0010, 0, Gives(0xff00_0001), integer),
        Case("seq r3, r1, r2", 4, 4, Gives(1), integer),
        Case("seq r3, r1, r2", 4, 5, Gives(0), integer),
        Case("slt r3, r1, r2", MINUS(1), 0, Gives(1), integer),
        Case("slt r3, r1, r2", 0, 0, Gives(0), integer),
        Case("sltu r3, r1, r2", MINUS(1), 0, Gives(0), integer),
        Case("sltu r3, r1, r2", 0, MINUS(1), Gives(1), integer),
        Case("fadd r3, r1, r2", f(1.5), f(2.25), Gives(f(3.75)), add),
        Case("fadd r3, r1, r2", f(16777216.0), f(1.0), Gives(f(16777216.0)), add),
        Case("fsub r3, r1, r2", f(1.5), f(2.25), Gives(f(-0.75)), add),
        Case("fmul r3, r1, r2", f(1.5), f(-2.0), Gives(f(-3.0)), multiply),
        Case("fdiv r3, r1, r2", f(1.0), f(3.0), Gives(f(1.0 / 3.0)), divide),
        Case("fdiv r3, r1, r2", f(-1.0), f(0.0), Gives(f(f32::NEG_INFINITY)), divide),
        Case("fmin r3, r1, r2", f(-1.0), f(1.0), Gives(f(-1.0)), add),
        Case("fmin r3, r1, r2", NAN, f(1.0), Gives(f(1.0)), add),
        Case("fmin r3, r1, r2", f(1.0), NAN, Gives(NAN), add),
        Case("fmax r3, r1, r2", f(-1.0), f(1.0), Gives(f(1.0)), add),
        Case("fmax r3, r1, r2", NAN, f(-1.0), Gives(f(-1.0)), add),
        Case("fabs r3, r1", f(-0.0), 0, Gives(0), add),
        Case("fneg r3, r1", f(2.0), 0, Gives(f(-2.0)), add),
        Case("ftoi r3, r1", f(-2.9), 0, Gives(MINUS(2)), add),
        Case("ftoi r3, r1", INF, 0, Gives(LEAST - 1), add),
        Case("ftoi r3, r1", NAN, 0, Gives(0), add),
        Case("itof r3, r1", MINUS(3), 0, Gives(f(-3.0)), add),
        Case("feq r3, r1, r2", f(-0.0), f(0.0), Gives(1), compare),
        Case("feq r3, r1, r2", NAN, NAN, Gives(0), compare),
        Case("flt r3, r1, r2", f(1.0), f(2.0), Gives(1), compare),
        Case("flt r3, r1, r2", f(1.0), f(1.0), Gives(0), compare),
        Case("fle r3, r1, r2", f(1.0), f(1.0), Gives(1), compare),
        Case("fle r3, r1, r2", f(1.0), NAN, Gives(0), compare),
        Case("beq r1, r2, 4", 4, 4, Goes(4, 0), branch),
        Case("beq r1, r2, 4", 4, 5, Goes(3, 0), branch),
        Case("bne r1, r2, 4", 4, 5, Goes(4, 0), branch),
        Case("bne r1, r2, 4", 4, 4, Goes(3, 0), branch),
        Case("blt r1, r2, 0", MINUS(1), 0, Goes(0, 0), branch),
        Case("blt r1, r2, 0", 0, 0, Goes(3, 0), branch),
        Case("bge r1, r2, 4", 0, 0, Goes(4, 0), branch),
        Case("bge r1, r2, 4", MINUS(1), 0, Goes(3, 0), branch),
        Case("bltu r1, r2, 4", 0, MINUS(1), Goes(4, 0), branch),
        Case("bltu r1, r2, 4", MINUS(1), 0, Goes(3, 0), branch),
        Case("bgeu r1, r2, 4", MINUS(1), 0, Goes(4, 0), branch),
        Case("bgeu r1, r2, 4", 0, MINUS(1), Goes(3, 0), branch),
        Case("fblt r1, r2, 4", f(-1.0), f(1.0), Goes(4, 0), compare),
        Case("fblt r1, r2, 4", f(1.0), f(1.0), Goes(3, 0), compare),
        Case("fble r1, r2, 4", f(1.0), f(1.0), Goes(4, 0), compare),
        Case("fble r1, r2, 4", NAN, f(1.0), Goes(3, 0), compare),
        Case("jmp 4", 0, 0, Goes(4, 0), branch),
        Case("call r3, 4", 0, 0, Goes(4, 3), branch),
        Case("jr r1", 4, 0, Goes(4, 0), branch),
        Case("done", 0, 0, Stops(Stop::Done), None),
        Case("halt", 0, 0, Stops(Stop::Halted), None),
    ]
}

/// Each class has a number of its own.
fn costs() -> InstructionCycles {
    let mut cycles = pcs_sim::machine::MachineFile::standard().unwrap().instruction_cycles.unwrap();
    Class::ALL.into_iter().zip(0..).for_each(|(class, place)| cycles.set(class, 1 << place));
    cycles
}

fn cost(class: Option<Class>) -> u64 {
    class.map_or(0, |class| costs().of(class).into())
}

fn executable(text: &str) -> Executable {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("test.pcs");
    std::fs::write(&path, text).unwrap();
    Executable::new(assemble(&path, Sources::Files, &[]).unwrap_or_else(|error| panic!("{error}")), &costs())
}

/// The instruction between two that read its operands and two that end the program.
fn framed(instruction: &str) -> Executable {
    executable(&format!("mov r1, x\nmov r2, x\n{instruction}\nhalt\nhalt\n.data\n.word 10, 20, 30, 40\n"))
}

#[test]
fn every_instruction_of_the_table_has_a_case() {
    for entry in TABLE {
        let named = |case: &Case| case.0.split(' ').next() == Some(entry.mnemonic);
        assert!(cases().iter().any(named), "`{}` has no case", entry.mnemonic);
    }
}

#[test]
fn effects_and_cycles_with_registers() {
    for Case(source, a, b, effect, class) in cases() {
        let executable = framed(source);
        let mut cell = Processor::new(&executable, &executable.program().data, &[], 1_000_000);
        let mut queues = Queues { x: vec![a, b], ..Queues::default() };
        let mut ops = OpStream::default();
        for _ in 0..2 {
            cell.step(&mut queues, &mut ops).unwrap();
        }
        let stop = cell.step(&mut queues, &mut ops).unwrap();
        let (r3, address) = (cell.register(Register::new(3).unwrap()), cell.address());
        match effect {
            Gives(value) => assert_eq!((r3, address, stop), (value, 3, None), "{source}"),
            Stores(at, value) => assert_eq!((cell.memory(at), address, stop), (Some(value), 3, None), "{source}"),
            Goes(to, value) => assert_eq!((r3, address, stop), (value, to, None), "{source}"),
            Stops(why) => assert_eq!((address, stop), (2, Some(why)), "{source}"),
        }
        assert_eq!(cell.cycles(), cost(class), "{source}");
    }
}

/// Operands come from X in the order in which they are written, then the instruction computes, then its result goes out.
#[test]
fn effects_and_ops_with_queues() {
    for Case(source, a, b, effect, class) in cases() {
        let Gives(value) = effect else { continue };
        let executable = executable(&format!(
            "{}\nhalt\n.data\n.word 10, 20, 30, 40\n",
            source.replace("r1", "x").replace("r2", "xp").replace("r3", "y")
        ));
        let mut cell = Processor::new(&executable, &executable.program().data, &[], 1_000_000);
        let mut queues = Queues { x: vec![a, b], ..Queues::default() };
        let mut ops = OpStream::default();
        assert_eq!(cell.run(&mut queues, &mut ops), Ok(Stop::Halted), "{source}");
        assert_eq!(queues.y_out, [value], "{source}");
        let mut expected = Vec::new();
        if source.contains("r1") {
            expected.push("r1".to_owned());
        }
        if source.contains("r2") {
            expected.push("x1".to_owned());
            assert_eq!(queues.x_out, [b], "{source}");
        }
        if !source.starts_with("mov") {
            expected.push(format!("c{}", cost(class)));
        }
        expected.push("o1".to_owned());
        assert_eq!(priced(ops.ops(), &instruction_costs(&costs())), expected.join(" "), "{source}");
    }
}

#[test]
fn what_is_written_to_r0_is_lost() {
    let executable = executable("li r0, 5\nmov y, r0\nhalt");
    let mut queues = Queues::default();
    Processor::new(&executable, &[], &[], 1_000).run(&mut queues, &mut OpStream::default()).unwrap();
    assert_eq!(queues.y_out, [0]);
}

#[test]
fn faults_name_the_instruction_and_its_line() {
    let outside = FaultKind::OutsideProgram { length: 5 };
    let faults = [
        ("lw r3, [r1 + 1]", 3, 0, FaultKind::Load { address: 4, words: 4 }),
        ("lw r3, [r1 - 1]", 0, 0, FaultKind::Load { address: u32::MAX, words: 4 }),
        ("sw r1, [r2 + 0]", 0, 4, FaultKind::Store { address: 4, words: 4 }),
        ("div r3, r1, r2", 1, 0, FaultKind::DivisionByZero),
        ("rem r3, r1, r2", 1, 0, FaultKind::DivisionByZero),
        ("jmp 2", 0, 0, FaultKind::InstructionLimit(10_000)),
        ("jr r1", 5, 0, outside),
        ("jr r1", 1 << 31, 0, outside),
    ];
    for (source, a, b, kind) in faults {
        let executable = framed(source);
        let mut cell = Processor::new(&executable, &executable.program().data, &[], 10_000);
        let mut queues = Queues { x: vec![a, b], ..Queues::default() };
        let fault = cell.run(&mut queues, &mut OpStream::default()).unwrap_err();
        assert_eq!((fault.kind, fault.cell), (kind, 0), "{source}");
        if kind == outside {
            assert_eq!((fault.address, fault.source), (a, None), "{source}");
        } else {
            assert_eq!((fault.address, fault.source.map(|at| at.line)), (2, Some(3)), "{source}");
        }
    }
}

#[test]
fn an_instruction_waits_until_all_its_words_have_come() {
    let executable = executable("add y, x, x\nhalt");
    let mut cell = Processor::new(&executable, &[], &[], 1_000);
    let mut queues = Queues { x: vec![1], ..Queues::default() };
    let mut ops = OpStream::default();
    assert_eq!(cell.run(&mut queues, &mut ops), Ok(Stop::Waiting(Queue::X)));
    assert_eq!((queues.x_read, cell.address(), ops.ops().len()), (0, 0, 0));
    queues.x.push(2);
    assert_eq!(cell.run(&mut queues, &mut ops), Ok(Stop::Halted));
    assert_eq!(queues.y_out, [3]);
}
