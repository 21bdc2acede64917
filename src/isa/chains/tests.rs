//! The plain interpreter is the judge of chains.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;

use super::*;
use crate::isa::kernels::float_wait;
use crate::isa::table::TABLE;
use crate::isa::{
    Class, Executable, FaultKind, Field, Format, Instruction, InstructionCycles, Operand, Program, Queues, Register,
    Sources, Stop, assemble,
};
use crate::seam::{Activity, OpStream};

/// Registers that pieces of programs are on.
const REGISTERS: u32 = 20;

fn register(number: u32) -> Register {
    Register::new(number).unwrap_or(Register::ZERO)
}

/// An instruction with registers for its first three fields.
fn instruction(opcode: Opcode, registers: [Register; 3], constant: i32) -> Instruction {
    let mut made = Instruction::new(opcode);
    for (field, register) in [Field::First, Field::Second, Field::Third].into_iter().zip(registers) {
        if opcode.fields().contains(&field) {
            made.set_register(field, register);
        }
    }
    if opcode.fields().iter().any(|field| matches!(field, Field::Short | Field::Long)) {
        made.constant = constant;
    }
    made
}

/// A chain's instructions, on registers that can be named so.
fn chain() -> impl Strategy<Value = Vec<Instruction>> {
    let registers = Just((1..=REGISTERS).collect::<Vec<u32>>()).prop_shuffle();
    let constants = prop::collection::vec(prop_oneof![9 => 1i32..9, 1 => -3i32..30], 20);
    (0..Chain::ALL.len(), registers, any::<u32>(), constants).prop_map(|(chain, registers, zeros, constants)| {
        let patterns = Chain::ALL[chain].1;
        let mut names: Vec<&str> = patterns.iter().flat_map(|pattern| pattern.names).copied().collect();
        names.sort_unstable();
        names.dedup();
        let is_written = |name: &str| patterns.iter().any(|pattern| pattern.writes && pattern.names[0] == name);
        // Of those that are only read, some are the same one.
        let register = |&name: &&str| match names.binary_search(&name) {
            Ok(place) if !is_written(name) && (name == "zero" || zeros >> place & 3 == 0) => Register::ZERO,
            Ok(place) => register(registers[place]),
            Err(_) => Register::ZERO,
        };
        let made = |(pattern, constant): (&Pattern, i32)| {
            let mut registers = [Register::ZERO; 3];
            registers.iter_mut().zip(pattern.names).for_each(|(slot, name)| *slot = register(name));
            instruction(pattern.opcode, registers, constant)
        };
        patterns.iter().zip(constants.into_iter().cycle()).map(made).collect()
    })
}

/// Any instruction, some of which move words.
fn any_instruction() -> impl Strategy<Value = Instruction> {
    let number = prop_oneof![8 => 0..=REGISTERS, 1 => 60u32..63];
    let registers = [number.clone(), number.clone(), number].map(|number| number.prop_map(register));
    let entry = prop::sample::select(TABLE);
    (entry, registers, prop_oneof![9 => 1i32..9, 1 => -30i32..0]).prop_map(|(entry, mut registers, constant)| {
        if registers[0] == Register::PASS_X {
            registers[0] = Register::Y;
        }
        instruction(entry.opcode, registers, constant)
    })
}

/// What puts a word of the data memory, or a small integer, into a register.
fn start() -> impl Strategy<Value = Instruction> {
    let load = (1..=REGISTERS, 0i32..19);
    let load = load.prop_map(|(to, at)| instruction(Opcode::Lw, [register(to), Register::ZERO, Register::ZERO], at));
    let small = (1..=REGISTERS, 0i32..12);
    let small = small.prop_map(|(to, value)| instruction(Opcode::Li, [register(to); 3], value));
    prop_oneof![load, small]
}

fn piece() -> impl Strategy<Value = Vec<Instruction>> {
    let starts = prop::collection::vec(start(), 1..30);
    let other = any_instruction().prop_map(|made| vec![made]);
    // One instruction of it is another one.
    let broken = (chain(), any::<prop::sample::Index>(), any_instruction()).prop_map(|(mut chain, at, other)| {
        let at = at.index(chain.len());
        chain[at] = if other.opcode == chain[at].opcode {
            other
        } else {
            Instruction { registers: other.registers, ..chain[at] }
        };
        chain
    });
    let started = (starts, chain()).prop_map(|(starts, chain)| [starts, chain].concat());
    prop_oneof![3 => chain(), 5 => started, 1 => moves(), 1 => other, 1 => broken.prop_filter("a word", |made| made.iter().all(is_a_word))]
}

fn is_a_word(made: &Instruction) -> bool {
    Instruction::decode(made.encode()) == Ok(*made)
}

/// Costs that tell classes apart.
fn cycles() -> InstructionCycles {
    let mut cycles = InstructionCycles { float_latency: Some(11), ..InstructionCycles::default() };
    Class::ALL.into_iter().zip(1..).for_each(|(class, cost)| cycles.set(class, cost));
    cycles
}

/// How often a chain was executed to its end, left by a branch, and failed.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    ended: u64,
    left: u64,
    failed: u64,
}

/// What the plain interpreter has seen of the programs.
#[derive(Debug, Default)]
struct Judge {
    chains: BTreeMap<String, Seen>,
    waits: u64,
    ends: u64,
    limits: u64,
    /// The chain under way: where it begins.
    begun: Option<u32>,
}

impl Judge {
    /// An instruction stands at an address, and the cell is at another behind it; or it has failed.
    fn watch(&mut self, executable: &Executable, address: u32, behind: Option<u32>) {
        let step = |address: u32| executable.steps.get(address as usize);
        if self.begun.is_none() && step(address).is_some_and(|step| step.chain != Chain::One) {
            self.begun = Some(address);
        }
        let Some(begun) = self.begun else { return };
        let Some(chain) = step(begun).map(|step| step.chain) else { return };
        let seen = self.chains.entry(format!("{chain:?}")).or_default();
        let length = Chain::ALL.iter().find(|(any, _)| *any == chain).map_or(0, |(_, patterns)| patterns.len()) as u32;
        match behind {
            None => seen.failed += 1,
            Some(behind) if behind == begun + length => seen.ended += 1,
            Some(behind) if behind == address + 1 => return,
            Some(_) => seen.left += 1,
        }
        self.begun = None;
    }
}

thread_local! {
    static JUDGE: RefCell<Judge> = RefCell::default();
}

/// Waits for floating-point results among some ops.
fn waited(ops: &OpStream) -> u64 {
    let is_wait = |unit| (0..4).any(|kernel| unit == float_wait(Activity(kernel)));
    let waits = ops.ops().iter().filter(|op| op.unit().is_some_and(is_wait));
    waits.map(|op| u64::from(op.count())).sum()
}

/// The cycles that an instruction alone takes.
fn cycles_alone(executable: &Executable, address: u32) -> u64 {
    let (before, behind) = executable.waits_at(address);
    executable.cycles_at(address) + (before + behind) * executable.wait_cycles()
}

/// How often an instruction alone is each event.
fn events_alone(executable: &Executable, address: u32) -> impl Iterator<Item = u64> {
    let counted = executable.program().counted.values();
    counted.map(move |addresses| addresses.iter().filter(|&&at| at == address).count() as u64)
}

/// Whether the next instruction adds or multiplies two different values that are no numbers: which of them comes out is left open.
fn leaves_open(executable: &Executable, cell: &Processor<'_>) -> bool {
    let Some(step) = executable.steps.get(cell.address() as usize) else { return false };
    let [a, b] = [1, 2].map(|field| f32::from_bits(cell.registers[step.slots[field] as usize]));
    let both = a.is_nan() && b.is_nan() && a.to_bits() != b.to_bits();
    both && matches!(step.opcode, Opcode::Fadd | Opcode::Fmul)
}

/// Moves of words.
fn moves() -> impl Strategy<Value = Vec<Instruction>> {
    let number = || prop_oneof![1..=REGISTERS, Just(60), Just(62)];
    let read = || prop_oneof![1..=REGISTERS, 60u32..63];
    let one = (number(), read())
        .prop_map(|(to, from)| instruction(Opcode::Mov, [register(to), register(from), register(0)], 0));
    prop::collection::vec(one, 1..4)
}

/// Runs a program for up to three messages, ahead and step by step, and compares all that there is to see.
fn compare(executable: &Executable, limit: u64, judge: &mut Judge) -> Result<(), TestCaseError> {
    let cell = || Processor::new(executable, &executable.program().data, &[7, 8, 9], limit);
    let (mut ahead, mut single) = (cell(), cell());
    let words = Queues { x: (0..20).collect(), y: (5..15).collect(), ..Queues::default() };
    let (mut ahead_queues, mut single_queues) = (words.clone(), words);
    let (mut ahead_ops, mut single_ops) = (OpStream::default(), OpStream::default());
    for _message in 0..3 {
        let by_chains = ahead.run(&mut ahead_queues, &mut ahead_ops);
        judge.begun = None;
        let (mut cycles, mut events) = (0, vec![0; executable.counters().len()]);
        let by_steps = loop {
            let (address, executed) = (single.address(), single.executed());
            if leaves_open(executable, &single) {
                return Ok(());
            }
            let step = single.step(&mut single_queues, &mut single_ops);
            if single.executed() > executed {
                cycles += cycles_alone(executable, address);
                events.iter_mut().zip(events_alone(executable, address)).for_each(|(all, here)| *all += here);
            }
            judge.watch(executable, address, step.is_ok().then_some(single.address()));
            match step {
                Ok(None) => {}
                Ok(Some(stop)) => break Ok(stop),
                Err(fault) => break Err(fault),
            }
        };
        prop_assert_eq!(&by_chains, &by_steps);
        let state = |cell: &Processor<'_>| (cell.executed(), cell.cycles(), cell.address());
        prop_assert_eq!(state(&ahead), state(&single));
        prop_assert_eq!(ahead.cycles(), cycles);
        for (counter, events) in events.into_iter().enumerate() {
            prop_assert_eq!((ahead.take_count(counter), single.take_count(counter)), (events, events));
        }
        prop_assert_eq!(&ahead_queues, &single_queues);
        prop_assert_eq!(&ahead_ops, &single_ops);
        for register in Register::all() {
            prop_assert_eq!(ahead.register(register), single.register(register), "{}", register);
        }
        for address in 0..19 {
            prop_assert_eq!(ahead.memory(address), single.memory(address));
        }
        judge.ends += u64::from(by_steps.is_ok());
        judge.limits += u64::from(by_steps.is_err_and(|fault| fault.kind == FaultKind::InstructionLimit(limit)));
        if by_chains != Ok(Stop::Done) {
            break;
        }
    }
    judge.waits += waited(&single_ops);
    Ok(())
}

/// The interpreter that takes one instruction after the other is the judge of the one that runs ahead: whether chains end, are
/// left, or fail in the middle, and where the limit of instructions falls into one.
#[test]
fn running_ahead_does_what_single_steps_do() {
    let asked = ProptestConfig::default();
    let config = ProptestConfig { cases: asked.cases.max(20_000), failure_persistence: None, ..asked };
    let mut runner = proptest::test_runner::TestRunner::new(config);
    let word = prop_oneof![4 => 0u32..12, 1 => any::<u32>(), 3 => (-2.0f32..2.0).prop_map(f32::to_bits),
        1 => Just(f32::INFINITY.to_bits())];
    let data = prop::collection::vec(word, 16);
    let pieces = prop::collection::vec(piece(), 1..12);
    let cases = (pieces, data, prop::collection::vec(0u32..200, 0..8), 20u64..900);
    let result = runner.run(&cases, |(pieces, data, marks, limit)| {
        let code: Vec<u32> = pieces.concat().iter().map(Instruction::encode).collect();
        let length = code.len() as u32;
        let work = (0..length).map(|address| Activity((address / 53 % 3) as u8)).collect();
        // Of the counters that tallies have, and of others.
        let counted =
            |(mark, name): (u32, usize)| (name.to_string(), vec![mark % length, mark / 3 % length, mark / 5 % length]);
        let counted = marks.into_iter().zip([0, 1, 3, 4, 6, 7, 8].into_iter().cycle()).map(counted).collect();
        let executable = Executable::new(Program { code, work, data, counted, ..Program::default() }, &cycles());
        JUDGE.with_borrow_mut(|judge| compare(&executable, limit, judge))
    });
    result.unwrap_or_else(|error| panic!("{error}"));
    let judge = JUDGE.take();
    for (chain, patterns) in Chain::ALL {
        let seen = judge.chains.get(&format!("{chain:?}")).copied().unwrap_or_default();
        let has = |opcodes: &[Opcode]| patterns.iter().any(|pattern| opcodes.contains(&pattern.opcode));
        let branches = patterns.iter().any(|pattern| !pattern.writes);
        assert!(seen.ended > 20 || has(&[Opcode::Jmp]), "{chain:?}: {seen:?}");
        assert!(seen.left > 5 || !branches, "{chain:?}: {seen:?}");
        assert!(seen.failed > 20 || !has(&[Opcode::Lw]), "{chain:?}: {seen:?}");
    }
    let Judge { waits, ends, limits, .. } = judge;
    assert!(waits > 3_000 && ends > 100 && limits > 100, "{waits} waits, {ends} ends, {limits} limits");
}

/// More instructions than a tally can count, in a straight line and in a loop, with nothing put down before the end.
#[test]
fn long_ways_are_counted_exactly() {
    let add = |by: i32| instruction(Opcode::Addi, [register(1); 3], by);
    let fadd = instruction(Opcode::Fadd, [register(2); 3], 0);
    let line = std::iter::repeat_n([add(1), add(1), add(1), fadd], 30_000).flatten();
    let back = instruction(Opcode::Bne, [register(1), Register::ZERO, Register::ZERO], -8);
    let looped = [add(-7), add(1), add(1), add(1), add(1), add(1), add(1), fadd, back];
    let code: Vec<Instruction> = line.chain(looped).chain([Instruction::new(Opcode::Done)]).collect();
    let code = code.iter().map(Instruction::encode).collect();
    let executable = Executable::new(Program { code, ..Program::default() }, &cycles());
    let mut judge = Judge::default();
    for limit in [1_000_000, 199_000, 120_008, 120_009] {
        compare(&executable, limit, &mut judge).unwrap_or_else(|error| panic!("{error}"));
    }
    assert_eq!((judge.ends, judge.limits), (3, 3));
}

/// No chain is there for nothing.
#[test]
fn each_chain_begins_in_a_standard_program() {
    let mut begun = BTreeSet::new();
    for file in std::fs::read_dir("pcs-programs/cells").unwrap().map(|entry| entry.unwrap().path()) {
        let Some("pcs") = file.extension().and_then(|extension| extension.to_str()) else { continue };
        let executable = Executable::new(assemble(&file, Sources::Files, &[]).unwrap(), &cycles());
        begun.extend(executable.steps.iter().map(|step| format!("{:?}", step.chain)));
    }
    for (chain, _) in Chain::ALL {
        assert!(begun.contains(&format!("{chain:?}")), "{chain:?} begins nowhere");
    }
}

/// A block is executed once more when it fails, so it may do nothing that cannot be done twice; and what ends one cannot fail.
#[test]
fn blocks_only_compute_and_only_branches_end_them() {
    for pattern in Chain::ALL.iter().flat_map(|(_, patterns)| *patterns) {
        let format = pattern.opcode.entry().format;
        let computes = matches!(format.operands(), [Operand::Write(_), ..]) && format != Format::Call;
        let branches = matches!(format, Format::Branch | Format::Jump);
        assert_eq!((computes, branches), (pattern.writes, !pattern.writes), "{:?}", pattern.opcode);
    }
}
