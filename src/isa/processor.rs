//! The interpreter: a cell that executes a program, without a clock.

use bitvec::vec::BitVec;

use super::executable::{Executable, Moves, QUEUE_SLOTS, RESULT_SLOT, Step, Tally, UNCOUNTED, WAIT};
use super::fault::{Fault, FaultKind};
use super::kernels::{OTHER, float_wait, unit};
use super::queues::Queues;
use super::register::{Queue, Register};
use super::table::{Class, Opcode};
use crate::seam::{Activity, OpKind, OpStream, Unit};

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
    executable: &'a Executable,
    /// The data memory as it was loaded.
    loaded: &'a [u32],
    /// The rest of the memory, behind the data: the scene, which programs can only read.
    scene: &'a [u32],
    data: Vec<u32>,
    /// Addresses in the data memory that the message has changed, each once.
    changed: Vec<u32>,
    /// Which those are.
    is_changed: BitVec,
    /// As many as slots have numbers, so that none needs a check of bounds.
    registers: [u32; 256],
    address: u32,
    /// Why the instruction at its address has failed, until that is told.
    failed: Option<FaultKind>,
    /// It has executed the `done` or `halt` at its address.
    ended: bool,
    /// Instructions executed for the message, by class, and waits; and how many of each have been put down as ops.
    classes: Classes,
    noted: Classes,
    /// Whether all of them have.
    is_noted: bool,
    work: Activity,
    instruction_limit: u64,
    /// Instructions executed before the message.
    before: u64,
    executed: u64,
    counts: Vec<u64>,
}

/// Counts by class; behind them waits, and instructions that take no time; as many as need no check of bounds.
type Classes = [u64; 16];

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
            classes: Classes::default(),
            noted: Classes::default(),
            is_noted: true,
            work: OTHER,
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
        (0..UNCOUNTED).map(|class| self.classes[class as usize] * self.executable.cycles_of(class)).sum()
    }

    /// Instructions executed since the cell was made.
    pub fn executed(&self) -> u64 {
        self.executed
    }

    /// How often an event has happened since it was asked for last, by its place in [`Executable::counters`].
    pub fn take_count(&mut self, counter: usize) -> u64 {
        self.counts.get_mut(counter).map_or(0, std::mem::take)
    }

    /// How often each event of [`Executable::counters`] has happened since they were taken.
    pub fn counts(&self) -> &[u64] {
        &self.counts
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
            self.run_ahead(ops);
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
        self.charge(step, ops);
        self.wait(self.executable.waits[self.address as usize].count());
        match self.go(&step) {
            true => Ok(None),
            false => self.not_plain(queues, ops),
        }
    }

    /// Executes the instruction at the address and goes on to where it leads; false, with the reason in `failed`, if it fails.
    fn go(&mut self, step: &Step) -> bool {
        let flow = self.execute(step.opcode, step, self.address);
        match self.lead(flow, self.executed - self.before) {
            Flow::Next => self.address += 1,
            Flow::To(to) => self.address = to,
            Flow::Failed => return false,
        }
        true
    }

    /// Executes instructions that work between registers and memory, as far as the next one is such: run by run, each of which is
    /// charged at once.
    fn run_ahead(&mut self, ops: &mut OpStream) {
        let executable = self.executable;
        let (mut address, mut executed) = (self.address, self.executed);
        let (mut classes, mut waits, mut tallied) = (Tally::default(), 0, 0);
        while let Some(run) = executable.runs.get(address as usize).filter(|run| run.length > 0) {
            if tallied + run.length > Tally::MOST || run.work != self.work {
                self.settle(std::mem::take(&mut classes), std::mem::take(&mut waits));
                tallied = 0;
                if run.work != self.work {
                    self.note(ops);
                    self.work = run.work;
                }
            }
            if run.is_counted {
                self.address = address;
                self.count_events();
            }
            classes = classes.and(run.classes);
            waits += u64::from(run.waits);
            tallied += run.length;
            executed += u64::from(run.length);
            let (done, flow) = self.execute_all(&executable.steps[address as usize..][..run.length as usize], address);
            address += done as u32;
            // What is behind the one that leads elsewhere has not been executed.
            if !matches!(flow, Flow::Next) && done + 1 < run.length as usize {
                let behind = &executable.runs[address as usize + 1];
                classes = classes.without(behind.classes);
                waits -= u64::from(behind.waits);
                executed -= u64::from(behind.length);
            }
            match self.lead(flow, executed - self.before) {
                Flow::Next => {}
                Flow::To(to) => address = to,
                Flow::Failed => break,
            }
        }
        if tallied > 0 {
            self.settle(classes, waits);
        }
        (self.address, self.executed) = (address, executed);
    }

    /// Executes steps, the first of which is at an address, chain by chain, until one does not lead to the next. Tells how many have
    /// led to the next, and where the one behind them leads.
    #[inline(always)]
    fn execute_all(&mut self, steps: &[Step], address: u32) -> (usize, Flow) {
        let mut done = 0;
        while done < steps.len() {
            let (more, flow) = self.execute_chain(&steps[done..], address + done as u32);
            done += more;
            if !matches!(flow, Flow::Next) {
                return (done, flow);
            }
        }
        (done, Flow::Next)
    }

    /// Where an instruction leads, the last of `executed` for the message. Every loop has a branch that is taken, so the limit is
    /// held here.
    #[inline(always)]
    fn lead(&mut self, flow: Flow, executed: u64) -> Flow {
        match flow {
            // Beyond all programs in any case.
            Flow::To(to) if executed <= self.instruction_limit => Flow::To(to.min(u32::MAX - 1)),
            Flow::To(_) => self.fail(FaultKind::InstructionLimit(self.instruction_limit)),
            _ => flow,
        }
    }

    /// Charges what has been tallied.
    fn settle(&mut self, classes: Tally, waits: u64) {
        self.is_noted = false;
        self.classes[WAIT as usize] += waits;
        self.classes.iter_mut().zip(classes.numbers()).for_each(|(counted, number)| *counted += number);
    }

    /// Counts the events that happen at the address.
    fn count_events(&mut self) {
        for &(_, counter) in self.executable.counted.iter().filter(|(at, _)| *at == self.address) {
            self.counts[counter] += 1;
        }
    }

    /// What [`Processor::run_ahead`] stops at.
    fn not_plain(&mut self, queues: &mut Queues, ops: &mut OpStream) -> Result<Option<Stop>, Fault> {
        if let Some(kind) = self.failed.take() {
            return Err(self.fault(kind));
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

    /// An instruction that moves words, is counted, ends the message, or is none.
    fn special(&mut self, step: Step, queues: &mut Queues, ops: &mut OpStream) -> Result<Option<Stop>, FaultKind> {
        let (executable, address) = (self.executable, self.address);
        if let Err(why) = executable.instructions[address as usize] {
            return Err(FaultKind::Invalid(executable.program.code[address as usize], why));
        }
        if self.ended {
            return Ok(self.go_on(step.opcode));
        }
        let moves = &executable.moves[address as usize];
        if let Some(queue) = queues.missing(moves) {
            self.note(ops);
            return Ok(Some(Stop::Waiting(queue)));
        }
        let waits = executable.waits[address as usize];
        self.count_events();
        if waits.before {
            self.turn_to(step.work, ops);
            self.wait(1);
        }
        self.read_queues(moves, queues, ops);
        self.charge(step, ops);
        self.wait(waits.behind.into());
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

    fn read_queues(&mut self, moves: &Moves, queues: &mut Queues, ops: &mut OpStream) {
        for (slot, queue) in QUEUE_SLOTS.into_iter().zip(moves.reads) {
            let Some(queue) = queue else { continue };
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
    fn charge(&mut self, step: Step, ops: &mut OpStream) {
        self.turn_to(step.work, ops);
        self.classes[step.class as usize] += 1;
        self.is_noted &= step.class == UNCOUNTED;
        self.executed += 1;
    }

    /// Puts down what has been done for another kernel than that which is worked for now.
    fn turn_to(&mut self, work: Activity, ops: &mut OpStream) {
        if work != self.work {
            self.note(ops);
            self.work = work;
        }
    }

    /// Counts waits for floating-point results.
    fn wait(&mut self, waits: u64) {
        self.classes[WAIT as usize] += waits;
        self.is_noted &= waits == 0;
    }

    /// Puts the instructions executed so far down as ops, one a class, and one of their waits.
    fn note(&mut self, ops: &mut OpStream) {
        if std::mem::replace(&mut self.is_noted, true) {
            return;
        }
        let mut put = |place: usize, unit: Unit| {
            let (counted, noted) = (self.classes[place], &mut self.noted[place]);
            if counted > *noted {
                ops.push(OpKind::Work(unit), counted - *noted);
                *noted = counted;
            }
        };
        for class in Class::ALL {
            put(class as usize, unit(self.work, class));
        }
        put(WAIT as usize, float_wait(self.work));
    }

    /// Behind `done`, puts the cell into the state in which every message finds it.
    fn go_on(&mut self, opcode: Opcode) -> Option<Stop> {
        if opcode == Opcode::Halt {
            return Some(Stop::Halted);
        }
        self.ended = false;
        self.registers = [0; 256];
        self.address = 0;
        (self.classes, self.noted, self.is_noted) = (Classes::default(), Classes::default(), true);
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

    /// Does what an instruction at an address does, between registers and memory.
    #[inline(always)]
    pub(super) fn execute(&mut self, opcode: Opcode, step: &Step, address: u32) -> Flow {
        let [first, second, third] = step.slots.map(|slot| self.registers[slot as usize]);
        let (a, b, i) = (second, third, step.constant as u32);
        let (fa, fb) = (f32::from_bits(a), f32::from_bits(b));
        let to_if = |taken: bool| if taken { Flow::To(i) } else { Flow::Next };
        let value = match opcode {
            Opcode::Mov => a,
            Opcode::Li => i,
            Opcode::Lw => match self.memory(a.wrapping_add(i)) {
                Some(word) => word,
                None => return self.fail_to_load(a.wrapping_add(i)),
            },
            Opcode::Sw => return self.store(a.wrapping_add(i), first),
            Opcode::Add => a.wrapping_add(b),
            Opcode::Addi => a.wrapping_add(i),
            Opcode::Sub => a.wrapping_sub(b),
            Opcode::Mul => a.wrapping_mul(b),
            Opcode::Div | Opcode::Rem if b == 0 => return self.fail(FaultKind::DivisionByZero),
            Opcode::Div => (a as i32).wrapping_div(b as i32) as u32,
            Opcode::Rem => (a as i32).wrapping_rem(b as i32) as u32,
            Opcode::Min => (a as i32).min(b as i32) as u32,
            Opcode::Max => (a as i32).max(b as i32) as u32,
            Opcode::And => a & b,
            Opcode::Or => a | b,
            Opcode::Xor => a ^ b,
            Opcode::Andi => a & i,
            Opcode::Shl => a << (i & 31),
            Opcode::Shr => a >> (i & 31),
            Opcode::Sar => ((a as i32) >> (i & 31)) as u32,
            Opcode::Seq => (a == b) as u32,
            Opcode::Slt => ((a as i32) < b as i32) as u32,
            Opcode::Sltu => (a < b) as u32,
            Opcode::Fadd => (fa + fb).to_bits(),
            Opcode::Fsub => (fa - fb).to_bits(),
            Opcode::Fmul => (fa * fb).to_bits(),
            Opcode::Fdiv => (fa / fb).to_bits(),
            Opcode::Fmin => (if fa < fb { fa } else { fb }).to_bits(),
            Opcode::Fmax => (if fa > fb { fa } else { fb }).to_bits(),
            Opcode::Fabs => a & !SIGN,
            Opcode::Fneg => a ^ SIGN,
            // Rust's `as` is just what the instruction is to do.
            Opcode::Ftoi => fa as i32 as u32,
            Opcode::Itof => (a as i32 as f32).to_bits(),
            Opcode::Feq => (fa == fb) as u32,
            Opcode::Flt => (fa < fb) as u32,
            Opcode::Fle => (fa <= fb) as u32,
            Opcode::Beq => return to_if(first == second),
            Opcode::Bne => return to_if(first != second),
            Opcode::Blt => return to_if((first as i32) < second as i32),
            Opcode::Bge => return to_if(first as i32 >= second as i32),
            Opcode::Bltu => return to_if(first < second),
            Opcode::Bgeu => return to_if(first >= second),
            Opcode::Fblt => return to_if(f32::from_bits(first) < f32::from_bits(second)),
            Opcode::Fble => return to_if(f32::from_bits(first) <= f32::from_bits(second)),
            Opcode::Jmp => return Flow::To(i),
            Opcode::Jr => return Flow::To(first),
            Opcode::Call => {
                self.registers[step.slots[0] as usize] = address + 1;
                return Flow::To(i);
            }
            Opcode::Done | Opcode::Halt => return Flow::Next,
        };
        self.registers[step.slots[0] as usize] = value;
        Flow::Next
    }

    #[inline(always)]
    fn store(&mut self, address: u32, value: u32) -> Flow {
        let words = self.data.len() as u32;
        match self.data.get_mut(address as usize) {
            Some(word) => {
                *word = value;
                if !self.is_changed.replace(address as usize, true) {
                    self.changed.push(address);
                }
                Flow::Next
            }
            None => self.fail(FaultKind::Store { address, words }),
        }
    }

    #[cold]
    fn fail_to_load(&mut self, address: u32) -> Flow {
        let words = (self.data.len() + self.scene.len()) as u32;
        self.fail(FaultKind::Load { address, words })
    }

    #[cold]
    fn fail(&mut self, kind: FaultKind) -> Flow {
        self.failed = Some(kind);
        Flow::Failed
    }
}

const SIGN: u32 = 1 << 31;
