//! A program made ready to run: decoded once, with what each instruction costs.

use super::chains::Chain;
use super::cycles::InstructionCycles;
use super::encoding::Instruction;
use super::field::Field;
use super::float_pipe::Waits;
use super::kernels::OTHER;
use super::program::Program;
use super::register::{Queue, Register};
use super::table::{Class, Opcode};
use crate::seam::Activity;

/// Where an instruction finds a word that it has read from a queue, by the field that names the queue.
pub(super) const QUEUE_SLOTS: [u8; 3] = [60, 61, 62];

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
    /// The class that it is counted in, or [`UNCOUNTED`].
    pub class: u8,
    /// With which instructions behind it, up to the end of its run, it is executed as one.
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

/// Instructions that are executed one after the other once the first of them is, unless one fails or branches: all work for the
/// same kernel, and none is special.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// How many; 0 if the first one is special.
    pub length: u32,
    pub work: Activity,
    /// Whether events are counted at the first one. None are at the others.
    pub is_counted: bool,
    /// How often they wait for floating-point results.
    pub waits: u16,
    /// How many of each class.
    pub classes: Tally,
}

/// Numbers of instructions by class, at most [`Tally::MOST`] of them in all: 12 bits a class, so that adding them all up is two
/// additions.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally([u64; 2]);

impl Tally {
    pub const MOST: u32 = (1 << Tally::BITS) - 1;
    const BITS: u32 = 12;
    const IN_A_WORD: u8 = 5;

    /// One instruction of a class.
    fn one(class: u8) -> Tally {
        let mut tally = Tally::default();
        tally.0[(class / Tally::IN_A_WORD) as usize] = 1 << (u32::from(class % Tally::IN_A_WORD) * Tally::BITS);
        tally
    }

    /// Both together.
    #[inline(always)]
    pub fn and(self, other: Tally) -> Tally {
        Tally([self.0[0] + other.0[0], self.0[1] + other.0[1]])
    }

    /// Without some that are part of it.
    pub fn without(self, other: Tally) -> Tally {
        Tally([self.0[0] - other.0[0], self.0[1] - other.0[1]])
    }

    /// How many of each class, in the order of [`Class::ALL`].
    pub fn numbers(self) -> [u64; Class::ALL.len()] {
        std::array::from_fn(|class| {
            let (word, place) = (class / Tally::IN_A_WORD as usize, class as u32 % u32::from(Tally::IN_A_WORD));
            self.0[word] >> (place * Tally::BITS) & u64::from(Tally::MOST)
        })
    }
}

/// The runs that begin at each address.
fn runs(steps: &[Step], waits: &[Waits], counted: &[(u32, usize)]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::with_capacity(steps.len());
    for (address, step) in steps.iter().enumerate().rev() {
        let is_counted = counted.iter().any(|&(at, _)| at as usize == address);
        let mut run = Run { length: 0, work: step.work, is_counted, waits: 0, classes: Tally::default() };
        if !step.special {
            (run.length, run.classes) = (1, Tally::one(step.class));
            run.waits = waits[address].count() as u16;
            let next = runs.last().filter(|next| !step.jumps() && !next.is_counted && next.work == run.work);
            if let Some(next) = next.filter(|next| next.length < LONGEST_RUN) {
                run.length += next.length;
                run.waits += next.waits;
                run.classes = run.classes.and(next.classes);
            }
        }
        runs.push(run);
    }
    runs.reverse();
    runs
}

/// The most instructions of a run.
const LONGEST_RUN: u32 = Tally::MOST / 16;

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
    /// For each address the run of instructions that begins there.
    pub(super) runs: Vec<Run>,
    /// The queues of each instruction.
    pub(super) moves: Vec<Moves>,
    /// The waits of each instruction; none where floating-point results have no latency.
    pub(super) waits: Vec<Waits>,
    /// The instructions, or why a word is none.
    pub(super) instructions: Vec<Result<Instruction, super::InvalidInstruction>>,
    /// Addresses whose execution is counted, with the number of the counter.
    pub(super) counted: Vec<(u32, usize)>,
    counters: Vec<String>,
}

impl Executable {
    /// Prepares a program whose instructions take so many cycles.
    pub fn new(program: Program, cycles: &InstructionCycles) -> Executable {
        let instructions: Vec<_> = program.code.iter().map(|&word| Instruction::decode(word)).collect();
        let counters: Vec<String> = program.counted.keys().cloned().collect();
        let addresses = |(number, name)| program.counted[name].iter().map(move |&address| (address, number));
        let counted: Vec<(u32, usize)> = counters.iter().enumerate().flat_map(addresses).collect();
        let step = |(address, decoded): (usize, &Result<Instruction, _>)| {
            let mut step = match decoded {
                Ok(instruction) => Step::new(instruction, address),
                Err(_) => Step::INVALID,
            };
            step.work = program.work.get(address).copied().unwrap_or(OTHER);
            step
        };
        let mut steps: Vec<Step> = instructions.iter().enumerate().map(step).collect();
        let waits = match cycles.float_latency {
            Some(_) => Waits::of(&instructions),
            None => vec![Waits::default(); steps.len()],
        };
        let runs = runs(&steps, &waits, &counted);
        for (address, run) in runs.iter().enumerate() {
            steps[address].chain = Chain::of(&steps[address..][..run.length as usize]);
        }
        let moves = |decoded: &Result<Instruction, _>| decoded.as_ref().map(Moves::new).unwrap_or_default();
        let moves = instructions.iter().map(moves).collect();
        Executable { cycles: *cycles, program, runs, steps, moves, waits, instructions, counted, counters }
    }

    /// The program.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The names of the events that are counted.
    pub fn counters(&self) -> &[String] {
        &self.counters
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

impl Step {
    const INVALID: Step = Step {
        opcode: Opcode::Halt,
        slots: [RESULT_SLOT; 3],
        work: OTHER,
        special: true,
        class: UNCOUNTED,
        chain: Chain::One,
        constant: 0,
    };

    /// Whether it never leads to the next address.
    fn jumps(&self) -> bool {
        matches!(self.opcode, Opcode::Jmp | Opcode::Call | Opcode::Jr)
    }

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
            class: if free { UNCOUNTED } else { entry.class as u8 },
            chain: Chain::One,
            constant: if targets { instruction.constant.wrapping_add(address as i32) } else { instruction.constant },
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
