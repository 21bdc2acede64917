//! A program under way, and what can be seen of it.

use std::collections::BTreeSet;
use std::fmt::Write;

use pcs_sim::isa::listing::{row, rows};
use pcs_sim::isa::words::likely;
use pcs_sim::isa::{Executable, Fault, Queue, Queues, Register, Stepper, Stop};

use super::command::{Command, HELP};

/// Instructions that `list` shows.
const LISTED: u32 = 10;

/// Words of a queue that are shown.
const QUEUE_WORDS: usize = 8;

/// A cell that runs a program on given words, and where it is to stop.
pub struct Session<'a> {
    executable: &'a Executable,
    cell: Stepper<'a>,
    breakpoints: BTreeSet<u32>,
    fault: Option<Fault>,
}

impl<'a> Session<'a> {
    pub fn new(executable: &'a Executable, queues: Queues, instruction_limit: u64) -> Session<'a> {
        let cell = Stepper::new(executable, queues, instruction_limit);
        Session { executable, cell, breakpoints: BTreeSet::new(), fault: None }
    }

    /// The fault that the program ended in.
    pub fn into_fault(self) -> Option<Fault> {
        self.fault
    }

    /// The instruction that comes next.
    pub fn here(&self) -> String {
        row(self.executable, self.cell.address())
    }

    /// Does what is asked, and tells what there is to see.
    pub fn execute(&mut self, command: Command) -> String {
        match command {
            Command::Step(count) => self.advance(count),
            Command::Run => self.advance(u64::MAX),
            Command::Break(address) => {
                let set = self.breakpoints.insert(address);
                if !set {
                    self.breakpoints.remove(&address);
                }
                format!("{}\n{}", if set { "set:" } else { "removed:" }, row(self.executable, address))
            }
            Command::Breakpoints => self.breakpoints.iter().map(|&address| row(self.executable, address)).collect(),
            Command::List => {
                let address = self.cell.address();
                rows(self.executable, address..address.saturating_add(LISTED))
            }
            Command::Registers => self.registers(),
            Command::Queues => self.show_queues(),
            Command::Memory(address, count) => self.memory(address, count),
            Command::Help => HELP.to_owned(),
            Command::Quit => String::new(),
        }
    }

    /// Executes so many instructions at the most, and tells where the program is then, and why.
    fn advance(&mut self, most: u64) -> String {
        let before = self.cell.processor().executed();
        let why = self.until_stopped(most);
        let executed = self.cell.processor().executed() - before;
        let (cycles, message) = (self.cell.cycles(), self.cell.message());
        let instructions = if executed == 1 { "1 instruction" } else { &format!("{executed} instructions") };
        format!("{instructions}, cycle {cycles} of message {message}{why}\n{}", self.here())
    }

    fn until_stopped(&mut self, most: u64) -> String {
        if let Some(fault) = &self.fault {
            return format!(": it can go no further: {}", fault.kind);
        }
        let last = self.cell.processor().executed().saturating_add(most);
        while self.cell.processor().executed() < last {
            match self.cell.step() {
                Err(fault) => {
                    let text = format!(": fault: {}", fault.kind);
                    self.fault = Some(fault);
                    return text;
                }
                Ok(Some(Stop::Done)) => return ": done with the message".to_owned(),
                Ok(Some(Stop::Halted)) => return ": halted".to_owned(),
                Ok(Some(Stop::Waiting(queue))) => {
                    return format!(": waits for {}, where no more words come", name(queue));
                }
                Ok(None) if self.breakpoints.contains(&self.cell.processor().address()) => {
                    return ": breakpoint".to_owned();
                }
                Ok(None) => {}
            }
        }
        String::new()
    }

    fn registers(&self) -> String {
        let mut text = String::new();
        for register in Register::all().filter(|register| register.queue().is_none()) {
            let word = self.cell.processor().register(register);
            if word != 0 {
                let _ = writeln!(text, "{:<4} {}", register.to_string(), forms(word));
            }
        }
        if text.is_empty() { "all registers are 0\n".to_owned() } else { text }
    }

    fn show_queues(&self) -> String {
        let Queues { x, y, x_read, y_read, x_out, y_out } = &self.cell.queues;
        let coming = |name: &str, words: &[u32], read: usize| {
            let next = &words[read..];
            let shown: Vec<String> = next.iter().take(QUEUE_WORDS).map(|&word| likely(word)).collect();
            let more = if next.len() > QUEUE_WORDS { " ..." } else { "" };
            format!("{name}  {read} read, {} to come: {}{more}", next.len(), shown.join(" "))
        };
        let written = |name: &str, words: &[u32]| {
            let last = &words[words.len().saturating_sub(QUEUE_WORDS)..];
            let shown: Vec<String> = last.iter().map(|&word| likely(word)).collect();
            let more = if words.len() > QUEUE_WORDS { "... " } else { "" };
            format!("{name}  {} written: {more}{}", words.len(), shown.join(" "))
        };
        let lines = [
            coming("X in ", x, *x_read),
            coming("Y in ", y, *y_read),
            written("X out", x_out),
            written("Y out", y_out),
        ];
        lines.iter().map(|line| format!("{}\n", line.trim_end().trim_end_matches(':'))).collect()
    }

    fn memory(&self, address: u32, count: u32) -> String {
        let mut text = String::new();
        for address in address..address.saturating_add(count) {
            let Some(word) = self.cell.processor().memory(address) else {
                let _ = writeln!(text, "{address:>7}  the memory ends before");
                break;
            };
            let _ = writeln!(text, "{address:>7}  {}", forms(word));
        }
        text
    }
}

/// A word's bits, the integer that it is, and the floating-point number if it is likely to be one.
fn forms(word: u32) -> String {
    let (integer, likely) = (word as i32, likely(word));
    let float = if likely.contains(['.', 'e', 'i']) { likely.as_str() } else { "" };
    format!("{word:#010x}  {integer:>11}  {float}").trim_end().to_owned()
}

fn name(queue: Queue) -> &'static str {
    match queue {
        Queue::X | Queue::PassX => "X",
        Queue::Y => "Y",
    }
}
