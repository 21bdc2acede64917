//! A program made ready to run: decoded once, with what each instruction costs.

use super::cycles::InstructionCycles;
use super::encoding::Instruction;
use super::field::Field;
use super::kernels::OTHER;
use super::program::Program;
use super::register::{Queue, Register};
use super::table::{Class, Opcode};
use crate::seam::Activity;

/// Where an instruction finds a word that it has read from a queue, by the field that names the queue.
const QUEUE_SLOTS: [u8; 3] = [60, 61, 62];

/// Where a result goes that is for a queue, or for nobody (`r0`).
pub(super) const RESULT_SLOT: u8 = 63;

/// An instruction as the processor runs it: 16 bytes, four to a cache line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub opcode: Opcode,
    /// Places in the register file: what is written, or read, by the instruction's fields.
    pub slots: [u8; 3],
    pub work: Activity,
    /// Whether it needs more than its opcode says: an invalid word, queues, an event that is counted, an end.
    pub special: bool,
    /// The class that it is counted in, or [`UNCOUNTED`].
    pub class: u8,
    /// The constant, or the target's address.
    pub constant: i32,
}

/// The place behind all classes: of instructions that take no time of their own.
pub(super) const UNCOUNTED: u8 = Class::ALL.len() as u8;

/// A program that can be run.
#[derive(Clone, Debug)]
pub struct Executable {
    cycles: InstructionCycles,
    pub(super) program: Program,
    pub(super) steps: Vec<Step>,
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
            step.special |= counted.iter().any(|&(at, _)| at as usize == address);
            step
        };
        let steps = instructions.iter().enumerate().map(step).collect();
        Executable { cycles: *cycles, program, steps, instructions, counted, counters }
    }

    /// The program.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// The names of the events that are counted.
    pub fn counters(&self) -> &[String] {
        &self.counters
    }

    /// Cycles of an instruction of a class, by its place among them.
    pub(super) fn cycles_of(&self, class: u8) -> u64 {
        Class::ALL.get(class as usize).map_or(0, |&class| self.cycles.of(class) as u64)
    }

    /// Cycles that an instruction computes, without those of the words that it moves.
    pub fn cycles_at(&self, address: u32) -> u64 {
        self.steps.get(address as usize).map_or(0, |step| self.cycles_of(step.class))
    }
}

impl Step {
    const INVALID: Step = Step {
        opcode: Opcode::Halt,
        slots: [RESULT_SLOT; 3],
        work: OTHER,
        special: true,
        class: UNCOUNTED,
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
            class: if free { UNCOUNTED } else { entry.class as u8 },
            constant: if targets { instruction.constant.wrapping_add(address as i32) } else { instruction.constant },
        }
    }
}

/// The slot that a word read for a field goes to.
pub(super) fn queue_slot(field: Field) -> usize {
    QUEUE_SLOTS[match field {
        Field::First => 0,
        Field::Second => 1,
        _ => 2,
    }] as usize
}

/// Whether a queue operand reads the channel X.
pub(super) fn is_x(queue: Queue) -> bool {
    queue != Queue::Y
}
