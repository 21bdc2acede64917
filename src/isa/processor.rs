//! The interpreter: a cell that executes a program, without a clock.

use bitvec::vec::BitVec;

use super::effects::Effect;
use super::executable::{EDGE_EVERY, Executable, Moves, QUEUE_SLOTS, RESULT_SLOT, Step, WAIT};
use super::fault::{Fault, FaultKind};
use super::kernels::{OTHER, float_wait, unit};
use super::queues::Queues;
use super::register::{Queue, Register};
use super::table::{Class, Opcode};
use super::tally::Tally;
use crate::seam::{Activity, OpKind, OpStream};

/// Why a cell stands still.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// It is done with the message, and ready for the next.
    Done,
    /// It has halted.
    Halted,
    /// It reads a queue that has no word for it.
    Waiting(Queue),
}

/// Where an instruction leads.
#[derive(Clone, Copy, Debug)]
pub(super) enum Flow {
    /// To the one behind it.
    Next,
    /// To an address.
    To(u32),
    /// Nowhere: it has failed, for the reason that stands in `failed`.
    Failed,
}

/// A cell that runs a program.
#[derive(Clone, Debug)]
pub struct Processor<'a> {
    pub(super) executable: &'a Executable,
    /// The data memory as it was loaded.
    loaded: &'a [u32],
    /// The rest of the memory, behind the data: the scene, which programs can only read.
    pub(super) scene: &'a [u32],
    pub(super) data: Vec<u32>,
    /// Addresses in the data memory that the message has changed, each once.
    pub(super) changed: Vec<u32>,
    /// Which those are.
    pub(super) is_changed: BitVec,
    /// As many as slots have numbers, so that none needs a check of bounds.
    pub(super) registers: [u32; 256],
    pub(super) address: u32,
    /// Why the instruction at its address has failed, until that is told.
    failed: Option<FaultKind>,
    /// It has executed the `done` or `halt` at its address.
    ended: bool,
    pub(super) work: Activity,
    /// Instructions executed since they were counted up or put down as ops the last time.
    pub(super) tally: Tally,
    /// How many had been executed before those.
    counted_up: u64,
    /// Those that have been counted up, but not put down; if there are any.
    owed: Option<Classes>,
    /// Those of the message that have been put down.
    told: Classes,
    instruction_limit: u64,
    /// Instructions executed before the message.
    before: u64,
    pub(super) executed: u64,
    counts: Vec<u64>,
}

/// Instructions by class, and waits behind them.
type Classes = [u64; WAIT as usize + 1];

/// At how many instructions, and those up to an edge, the tally is counted up.
const COUNT_UP_EVERY: u64 = Tally::MOST - EDGE_EVERY as u64;

/// The most words that may be written for one message.
const WORD_LIMIT: u64 = 1 << 24;

impl<'a> Processor<'a> {
    /// Limit of instructions for one message, unless another is asked for: some ten seconds of PCS, or of ours.
    pub const INSTRUCTION_LIMIT: u64 = 200_000_000;

    /// A cell that has done nothing yet. `data` is its data memory, from address 0 on, and `scene` what follows.
    pub fn new(executable: &'a Executable, data: &'a [u32], scene: &'a [u32], instruction_limit: u64) -> Processor<'a> {
        Processor {
            executable,
            loaded: data,
            scene,
            data: data.to_vec(),
            changed: Vec::new(),
            is_changed: BitVec::repeat(false, data.len()),
            registers: [0; 256],
            address: 0,
            failed: None,
            ended: false,
            work: OTHER,
            tally: Tally::default(),
            owed: None,
            counted_up: 0,
            told: Classes::default(),
            instruction_limit,
            before: 0,
            executed: 0,
            counts: vec![0; executable.counters().len()],
        }
    }

    /// What a register holds.
    pub fn register(&self, register: Register) -> u32 {
        if register.queue().is_some() { 0 } else { self.registers[register.number() as usize] }
    }

    /// The address of the instruction that comes next, or of the `done` or `halt` that it stands at.
    pub fn address(&self) -> u32 {
        self.address
    }

    /// Cycles computed for the message so far, without those of the words moved.
    pub fn cycles(&self) -> u64 {
        let owed = self.owed.unwrap_or_default();
        let mut cycles: u64 = (0..=WAIT)
            .map(|class| (self.told[class as usize] + owed[class as usize]) * self.executable.cycles_of(class))
            .sum();
        self.tally.for_each_class(|class, number| cycles += number * self.executable.cycles_of(class));
        cycles
    }

    /// Instructions executed since the cell was made.
    pub fn executed(&self) -> u64 {
        self.executed
    }

    /// How often an event has happened since it was asked for last, by its place in [`Executable::counters`].
    pub fn take_count(&mut self, counter: usize) -> u64 {
        self.take_events();
        self.counts.get_mut(counter).map_or(0, std::mem::take)
    }

    /// A word of memory.
    #[inline(always)]
    pub fn memory(&self, address: u32) -> Option<u32> {
        let behind = address.wrapping_sub(self.data.len() as u32) as usize;
        self.scene.get(behind).or_else(|| self.data.get(address as usize)).copied()
    }

    /// Runs until the message is done, the cell halts, or a word is missing. Adds what it does to `ops`.
    pub fn run(&mut self, queues: &mut Queues, ops: &mut OpStream) -> Result<Stop, Fault> {
        loop {
            if !self.executable.steps.get(self.address as usize).is_some_and(|step| step.special) {
                self.run_ahead(ops);
            }
            if let Some(stop) = self.not_plain(queues, ops)? {
                return Ok(stop);
            }
        }
    }

    /// Executes one instruction, unless it has to wait; tells if the cell stands still then.
    pub fn step(&mut self, queues: &mut Queues, ops: &mut OpStream) -> Result<Option<Stop>, Fault> {
        let plain =
            self.executable.steps.get(self.address as usize).filter(|step| !step.special && self.failed.is_none());
        let Some(&step) = plain else { return self.not_plain(queues, ops) };
        self.count_events();
        self.charge(step, self.executable.tally_at(self.address), ops);
        match self.go(&step) {
            true => Ok(None),
            false => self.not_plain(queues, ops),
        }
    }

    /// Executes the instruction at the address and goes on to where it leads; false, with the reason in `failed`, if it fails.
    fn go(&mut self, step: &Step) -> bool {
        match self.execute(step, self.address) {
            Flow::Next => self.address += 1,
            Flow::To(_) if self.is_beyond_limit() => return false,
            Flow::To(to) => self.address = to,
            Flow::Failed => return false,
        }
        true
    }

    /// Executes an instruction at an address.
    #[inline(always)]
    pub(super) fn execute(&mut self, step: &Step, address: u32) -> Flow {
        let fields = step.slots.map(|slot| self.registers[slot as usize]);
        match self.effect(step.opcode, fields, step.constant as u32) {
            Effect::Gives(result) => self.registers[step.slots[0] as usize] = result,
            Effect::Passes => {}
            Effect::Leads(to) => {
                if step.opcode == Opcode::Call {
                    self.registers[step.slots[0] as usize] = address + 1;
                }
                return Flow::To(to);
            }
            Effect::Fails(kind) => return self.fail(kind),
        }
        Flow::Next
    }

    #[cold]
    fn fail(&mut self, kind: FaultKind) -> Flow {
        self.failed = Some(kind);
        Flow::Failed
    }

    /// Whether more instructions than may be have been executed for the message; `failed` tells it then. Every loop has a branch that
    /// is taken, so the limit is held there.
    pub(super) fn is_beyond_limit(&mut self) -> bool {
        let is_beyond = self.executed - self.before > self.instruction_limit;
        if is_beyond {
            self.fail(FaultKind::InstructionLimit(self.instruction_limit));
        }
        is_beyond
    }

    /// The number of executed instructions beyond which there is something to do: the limit is passed, or the tally may overflow.
    pub(super) fn horizon(&self) -> u64 {
        self.before.saturating_add(self.instruction_limit).min(self.counted_up + COUNT_UP_EVERY)
    }

    /// Counts the tally up if that is due.
    pub(super) fn count_up_in_time(&mut self) {
        if self.executed > self.counted_up + COUNT_UP_EVERY {
            self.count_up();
        }
    }

    /// Begins a new tally.
    #[cold]
    fn count_up(&mut self) {
        self.counted_up = self.executed;
        self.take_events();
        let owed = self.owed.get_or_insert_default();
        std::mem::take(&mut self.tally).for_each_class(|class, number| owed[class as usize] += number);
    }

    /// Counts the events up that are in the tally.
    fn take_events(&mut self) {
        self.tally.take_events(|event, number| {
            if let Some(count) = self.counts.get_mut(event) {
                *count += number;
            }
        });
    }

    /// Counts the events that happen at the address and are in no tally.
    pub(super) fn count_events(&mut self) {
        for &(_, counter) in self.executable.counted.iter().filter(|(at, _)| *at == self.address) {
            self.counts[counter] += 1;
        }
    }

    /// What [`Processor::run_ahead`] stops at.
    fn not_plain(&mut self, queues: &mut Queues, ops: &mut OpStream) -> Result<Option<Stop>, Fault> {
        if self.failed.is_some() {
            return Err(self.take_fault());
        }
        let Some(&step) = self.executable.steps.get(self.address as usize) else {
            let length = self.executable.steps.len() as u32;
            return Err(self.fault(FaultKind::OutsideProgram { length }));
        };
        if !step.special {
            return Ok(None);
        }
        self.special(step, queues, ops).map_err(|kind| self.fault(kind))
    }

    /// The fault of the instruction that has failed.
    #[cold]
    fn take_fault(&mut self) -> Fault {
        let kind = self.failed.take().unwrap_or(FaultKind::Halted);
        self.fault(kind)
    }

    /// An instruction that moves words, ends the message, or is none.
    fn special(&mut self, step: Step, queues: &mut Queues, ops: &mut OpStream) -> Result<Option<Stop>, FaultKind> {
        let (executable, address) = (self.executable, self.address);
        let moves = &executable.moves[address as usize];
        if moves.are_all {
            return self.move_word(&step, moves, queues, ops);
        }
        if let Err(why) = executable.instructions[address as usize] {
            return Err(FaultKind::Invalid(executable.program.code[address as usize], why));
        }
        if self.ended {
            return Ok(self.go_on(step.opcode));
        }
        if let Some(queue) = queues.missing(moves) {
            self.note(ops);
            return Ok(Some(Stop::Waiting(queue)));
        }
        self.count_events();
        let mut tally = executable.tally_at(address);
        if executable.waits[address as usize].before {
            let wait = Tally::waits(1);
            tally = tally.without(wait);
            self.turn_to(step.work, ops);
            self.tally = self.tally.with(wait);
        }
        self.read_queues(moves, queues, ops);
        self.charge(step, tally, ops);
        match step.opcode {
            Opcode::Done | Opcode::Halt => {
                self.note(ops);
                self.ended = true;
                return Ok(Some(if step.opcode == Opcode::Done { Stop::Done } else { Stop::Halted }));
            }
            _ if self.go(&step) => {}
            _ => return Err(self.failed.take().unwrap_or(FaultKind::Halted)),
        }
        self.write_queue(moves, queues, ops)?;
        Ok(None)
    }

    /// An instruction that only moves a word.
    fn move_word(
        &mut self,
        step: &Step,
        moves: &Moves,
        queues: &mut Queues,
        ops: &mut OpStream,
    ) -> Result<Option<Stop>, FaultKind> {
        let [to, from, _] = step.slots;
        if let Some(queue) = moves.reads[1] {
            if queues.missing(moves).is_some() {
                self.note(ops);
                return Ok(Some(Stop::Waiting(queue)));
            }
            self.read_queue(queue, from, queues, ops);
        }
        self.turn_to(step.work, ops);
        self.executed += 1;
        self.registers[to as usize] = self.registers[from as usize];
        self.address += 1;
        self.write_queue(moves, queues, ops)?;
        Ok(None)
    }

    fn read_queues(&mut self, moves: &Moves, queues: &mut Queues, ops: &mut OpStream) {
        for (slot, queue) in QUEUE_SLOTS.into_iter().zip(moves.reads) {
            if let Some(queue) = queue {
                self.read_queue(queue, slot, queues, ops);
            }
        }
    }

    fn read_queue(&mut self, queue: Queue, slot: u8, queues: &mut Queues, ops: &mut OpStream) {
        let (word, op) = match queue {
            Queue::X => (queues.next_x(), OpKind::ReadX),
            Queue::PassX => (queues.next_x(), OpKind::PassX),
            Queue::Y => (queues.next_y(), OpKind::ReadY),
        };
        if queue == Queue::PassX {
            queues.x_out.push(word);
        }
        self.note(ops);
        ops.push(op, 1);
        self.registers[slot as usize] = word;
    }

    fn write_queue(&mut self, moves: &Moves, queues: &mut Queues, ops: &mut OpStream) -> Result<(), FaultKind> {
        let Some(queue) = moves.writes else { return Ok(()) };
        let (out, op) = match queue {
            Queue::X | Queue::PassX => (&mut queues.x_out, OpKind::WriteX),
            Queue::Y => (&mut queues.y_out, OpKind::WriteY),
        };
        if out.len() as u64 >= WORD_LIMIT {
            return Err(FaultKind::WordLimit(WORD_LIMIT));
        }
        out.push(self.registers[RESULT_SLOT as usize]);
        self.note(ops);
        ops.push(op, 1);
        Ok(())
    }

    /// Counts an instruction, after putting those of another kernel down.
    fn charge(&mut self, step: Step, tally: Tally, ops: &mut OpStream) {
        self.turn_to(step.work, ops);
        self.count_up_in_time();
        self.tally = self.tally.with(tally);
        self.executed += 1;
    }

    /// Puts down what has been done for another kernel than that which is worked for now.
    pub(super) fn turn_to(&mut self, work: Activity, ops: &mut OpStream) {
        if work != self.work {
            self.note(ops);
            self.work = work;
        }
    }

    /// Puts the instructions executed so far down as ops, one a class, and one of their waits.
    fn note(&mut self, ops: &mut OpStream) {
        if self.owed.is_some() {
            return self.note_owed(ops);
        }
        self.counted_up = self.executed;
        self.take_events();
        let work = self.work;
        std::mem::take(&mut self.tally).for_each_class(|class, number| {
            self.told[class as usize] += number;
            ops.push(work_of(work, class), number);
        });
    }

    #[cold]
    fn note_owed(&mut self, ops: &mut OpStream) {
        self.count_up();
        let owed = self.owed.take().unwrap_or_default();
        for (class, number) in (0..).zip(owed).filter(|&(_, number)| number > 0) {
            self.told[class as usize] += number;
            ops.push(work_of(self.work, class), number);
        }
    }

    /// Behind `done`, puts the cell into the state in which every message finds it.
    fn go_on(&mut self, opcode: Opcode) -> Option<Stop> {
        if opcode == Opcode::Halt {
            return Some(Stop::Halted);
        }
        self.ended = false;
        self.registers = [0; 256];
        self.address = 0;
        self.told = Classes::default();
        self.before = self.executed;
        for address in self.changed.drain(..) {
            self.data[address as usize] = self.loaded[address as usize];
            self.is_changed.set(address as usize, false);
        }
        None
    }

    /// A fault of the instruction that the cell is at.
    pub fn fault(&self, kind: FaultKind) -> Fault {
        Fault::new(kind, self.address, &self.executable.program)
    }
}

/// The op that puts instructions of a class down, or waits.
fn work_of(kernel: Activity, class: u8) -> OpKind {
    OpKind::Work(Class::ALL.get(class as usize).map_or(float_wait(kernel), |&class| unit(kernel, class)))
}
