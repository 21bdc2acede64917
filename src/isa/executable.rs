//! A program made ready to run: decoded once, with what each instruction costs.

use std::collections::BTreeSet;

use super::chains::Chain;
use super::cycles::InstructionCycles;
use super::encoding::{Instruction, InvalidInstruction};
use super::field::Field;
use super::float_pipe::Waits;
use super::kernels::OTHER;
use super::program::Program;
use super::register::{Queue, Register};
use super::table::{Class, Opcode};
use super::tally::Tally;
use crate::seam::Activity;

/// Where an instruction finds a word that it has read from a queue, by the field that names the queue.
pub(super) const QUEUE_SLOTS: [u8; 3] = [60, 61, 62];

/// An address that no program has, nor the one before it; what leads beyond it leads there.
pub(super) const OUTSIDE: u32 = u32::MAX - 1;

/// Where a result goes that is for a queue, or for nobody (`r0`).
pub(super) const RESULT_SLOT: u8 = 63;

/// An instruction as the processor runs it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub opcode: Opcode,
    /// Places in the register file: what is written, or read, by the instruction's fields.
    pub slots: [u8; 3],
    pub work: Activity,
    /// Whether it needs more than its opcode says: an invalid word, queues, an end.
    pub special: bool,
    /// Whether something is to be done before it: it is special, or counted, or tallies are looked at. No chain goes on across it.
    pub is_edge: bool,
    /// The class that it is counted in, or [`UNCOUNTED`].
    pub class: u8,
    /// With which instructions behind it it is executed as one.
    pub chain: Chain,
    /// The constant, or the target's address.
    pub constant: i32,
}

/// The queues of an instruction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moves {
    /// Those that it reads, each by the slot where its word goes, from the first of them on.
    pub reads: [Option<Queue>; QUEUE_SLOTS.len()],
    pub writes: Option<Queue>,
    /// Whether they are all that the instruction does, and nothing of it is counted.
    pub are_all: bool,
}

impl Moves {
    fn new(instruction: &Instruction) -> Moves {
        let mut moves = Moves { writes: instruction.written().and_then(Register::queue), ..Moves::default() };
        for field in instruction.reads() {
            moves.reads[(queue_slot(field) - QUEUE_SLOTS[0]) as usize] = instruction.register(field).queue();
        }
        moves
    }
}

/// Up to where chains that begin at each address can go: to the next instruction that is an edge or works for another kernel.
fn ends(steps: &[Step]) -> Vec<usize> {
    let mut ends: Vec<usize> = (1..=steps.len()).collect();
    for (address, pair) in steps.windows(2).enumerate().rev() {
        if !pair[1].is_edge && pair[0].work == pair[1].work {
            ends[address] = ends[address + 1];
        }
    }
    ends
}

/// At how many instructions at most an edge follows the one before, so that tallies are looked at.
pub(super) const EDGE_EVERY: usize = 4096;

/// What it comes to, to leave the straight line behind an instruction for its target.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn {
    pub to: u32,
    pub tally: Tally,
}

/// The address of an instruction that is an event, and the number of its counter.
type Event = (u32, usize);

/// The place behind all classes: of waits for floating-point results.
pub(super) const WAIT: u8 = Class::ALL.len() as u8;

/// The place behind that: of instructions that take no time of their own.
pub(super) const UNCOUNTED: u8 = WAIT + 1;

/// A program that can be run.
#[derive(Clone, Debug)]
pub struct Executable {
    cycles: InstructionCycles,
    pub(super) program: Program,
    pub(super) steps: Vec<Step>,
    /// For each address, and the one behind the last, all instructions before it, with their waits and events.
    before: Vec<Tally>,
    /// For each address the turn that its instruction takes, if it is one that does.
    pub(super) turns: Vec<Turn>,
    /// The queues of each instruction.
    pub(super) moves: Vec<Moves>,
    /// The waits of each instruction; none where floating-point results have no latency.
    pub(super) waits: Vec<Waits>,
    /// The instructions, or why a word is none.
    pub(super) instructions: Vec<Result<Instruction, InvalidInstruction>>,
    /// The events that tallies do not count.
    pub(super) counted: Vec<Event>,
    counters: Vec<String>,
}

impl Executable {
    /// Prepares a program whose instructions take so many cycles.
    pub fn new(program: Program, cycles: &InstructionCycles) -> Executable {
        let instructions: Vec<_> = program.code.iter().map(|&word| Instruction::decode(word)).collect();
        let counters: Vec<String> = program.counted.keys().cloned().collect();
        let addresses = |(number, name)| program.counted[name].iter().map(move |&address| (address, number));
        let counted: Vec<Event> = counters.iter().enumerate().flat_map(addresses).collect();
        let (tallied, counted) = in_tallies(counted);
        let step = |(address, decoded): (usize, &Result<Instruction, _>)| {
            let mut step = match decoded {
                Ok(instruction) => Step::new(instruction, address),
                Err(_) => Step::INVALID,
            };
            step.work = program.work.get(address).copied().unwrap_or(OTHER);
            let is_counted = counted.iter().any(|&(at, _)| at as usize == address);
            step.is_edge = step.special || is_counted || address % EDGE_EVERY == 0;
            step
        };
        let mut steps: Vec<Step> = instructions.iter().enumerate().map(step).collect();
        let waits = match cycles.float_latency {
            Some(_) => Waits::of(&instructions),
            None => vec![Waits::default(); steps.len()],
        };
        for (address, end) in ends(&steps).into_iter().enumerate() {
            if !steps[address].special {
                steps[address].chain = Chain::of(&steps[address..end]);
            }
        }
        let before = before(&steps, &waits, &tallied);
        let turns = steps.iter().enumerate().map(|(address, step)| Turn::new(address, step, &before)).collect();
        let moves = moves(&instructions, &before, &counted);
        Executable { cycles: *cycles, program, before, turns, steps, moves, waits, instructions, counted, counters }
    }

    /// The program.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The names of the events that are counted.
    pub fn counters(&self) -> &[String] {
        &self.counters
    }

    /// All instructions before an address: what is executed from one to another, one after the other, is what is before the other
    /// without what is before the one.
    #[inline(always)]
    pub(super) fn before(&self, address: u32) -> Tally {
        tally_before(&self.before, address)
    }

    /// What an instruction alone comes to.
    pub(super) fn tally_at(&self, address: u32) -> Tally {
        self.before(address + 1).without(self.before(address))
    }

    /// Cycles of an instruction of a class, by its place among them, or of a [`WAIT`].
    pub(super) fn cycles_of(&self, class: u8) -> u64 {
        if class == WAIT {
            return self.cycles.float_latency.unwrap_or(0).into();
        }
        Class::ALL.get(class as usize).map_or(0, |&class| self.cycles.of(class) as u64)
    }

    /// Cycles that an instruction computes, without those of the words that it moves.
    pub fn cycles_at(&self, address: u32) -> u64 {
        self.steps.get(address as usize).map_or(0, |step| self.cycles_of(step.class))
    }

    /// How often an instruction waits for floating-point results before it reads words, and how often behind what it computes.
    pub fn waits_at(&self, address: u32) -> (u64, u64) {
        let waits = self.waits.get(address as usize).copied().unwrap_or_default();
        (waits.before.into(), waits.behind.into())
    }

    /// Cycles of a wait for a floating-point result.
    pub fn wait_cycles(&self) -> u64 {
        self.cycles_of(WAIT)
    }

    /// How many words an instruction reads before it computes, and how many it writes behind that. One that is passed on is read.
    pub fn words_at(&self, address: u32) -> (usize, usize) {
        let moves = self.moves.get(address as usize);
        moves.map_or((0, 0), |moves| (moves.reads.iter().flatten().count(), usize::from(moves.writes.is_some())))
    }
}

/// The events that tallies count, and all others.
fn in_tallies(counted: Vec<Event>) -> (BTreeSet<Event>, Vec<Event>) {
    let mut tallied = BTreeSet::new();
    // Whatever stands there twice is counted twice.
    let is_other = |event: &Event| event.1 >= Tally::EVENTS || !tallied.insert(*event);
    let others = counted.into_iter().filter(is_other).collect();
    (tallied, others)
}

/// All instructions before each address, and before the one behind the last.
fn before(steps: &[Step], waits: &[Waits], tallied: &BTreeSet<Event>) -> Vec<Tally> {
    let mut before = vec![Tally::default()];
    for ((step, waits), address) in steps.iter().zip(waits).zip(0..) {
        let events = tallied.range((address, 0)..(address + 1, 0)).map(|&(_, event)| Tally::event(event));
        let tally = before[before.len() - 1].with(Tally::one(step.class)).with(Tally::waits(waits.count()));
        before.push(events.fold(tally, Tally::with));
    }
    before
}

/// The queues of each instruction.
fn moves(instructions: &[Result<Instruction, InvalidInstruction>], before: &[Tally], counted: &[Event]) -> Vec<Moves> {
    let moves = |((decoded, tallies), address): ((&Result<Instruction, _>, &[Tally]), u32)| {
        let Ok(instruction) = decoded else { return Moves::default() };
        let is_counted = tallies[0] != tallies[1] || counted.iter().any(|&(at, _)| at == address);
        Moves { are_all: instruction.opcode == Opcode::Mov && !is_counted, ..Moves::new(instruction) }
    };
    instructions.iter().zip(before.windows(2)).zip(0..).map(moves).collect()
}

#[inline(always)]
fn tally_before(before: &[Tally], address: u32) -> Tally {
    before.get(address as usize).copied().unwrap_or_default()
}

impl Turn {
    fn new(address: usize, step: &Step, before: &[Tally]) -> Turn {
        let to = step.constant as u32;
        Turn { to, tally: before[address + 1].without(tally_before(before, to)) }
    }
}

impl Step {
    const INVALID: Step = Step {
        opcode: Opcode::Halt,
        slots: [RESULT_SLOT; 3],
        work: OTHER,
        special: true,
        is_edge: true,
        class: UNCOUNTED,
        chain: Chain::One,
        constant: 0,
    };

    fn new(instruction: &Instruction, address: usize) -> Step {
        use super::table::Format;
        let entry = instruction.opcode.entry();
        let queues = instruction.words() > 0;
        let mut slots = instruction.registers.map(|register| register.number() as u8);
        for ((slot, register), queue_slot) in slots.iter_mut().zip(instruction.registers).zip(QUEUE_SLOTS) {
            if register.queue().is_some() {
                *slot = queue_slot;
            }
        }
        if let Some(register) = instruction.written()
            && (register == Register::ZERO || register.queue().is_some())
        {
            slots[0] = RESULT_SLOT;
        }
        let targets = matches!(entry.format, Format::Branch | Format::Jump | Format::Call);
        let free = match instruction.opcode {
            Opcode::Mov => queues,
            // The sequencer is back at the first instruction when the last one ends.
            Opcode::Done | Opcode::Halt => true,
            _ => false,
        };
        Step {
            opcode: instruction.opcode,
            slots,
            work: OTHER,
            special: queues || matches!(instruction.opcode, Opcode::Done | Opcode::Halt),
            is_edge: true,
            class: if free { UNCOUNTED } else { entry.class as u8 },
            chain: Chain::One,
            constant: match instruction.constant.wrapping_add(address as i32) {
                target if targets => (target as u32).min(OUTSIDE) as i32,
                _ => instruction.constant,
            },
        }
    }
}

/// The slot that a word read for a field goes to.
fn queue_slot(field: Field) -> u8 {
    QUEUE_SLOTS[match field {
        Field::First => 0,
        Field::Second => 1,
        _ => 2,
    }]
}

/// Whether a queue operand reads the channel X.
pub(super) fn is_x(queue: Queue) -> bool {
    queue != Queue::Y
}
