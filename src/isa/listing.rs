//! Programs as people read them: listings with cycles, and source text again.

use std::fmt::Write;
use std::ops::Range;

use super::encoding::Instruction;
use super::executable::Executable;
use super::program::Program;
use super::table::{Format, Opcode};
use crate::input::lines::{WIDTH, wrapped};

/// The listing of a program: every instruction with its address, word and cycles; the data; the loops.
///
/// Cycles are those of an instruction that need not wait for words, the words that it moves among them; those that it waits for
/// floating-point results stand behind a plus.
pub fn listing(executable: &Executable) -> String {
    let instructions = executable.instructions.len() as u32;
    rows(executable, 0..instructions) + &data(executable.program()) + &loops(executable)
}

/// The column in which the source of an instruction begins.
const SOURCE: usize = 57;

/// The instructions at some addresses: a row each, under the names of their files.
pub fn rows(executable: &Executable, addresses: Range<u32>) -> String {
    let program = executable.program();
    let mut text = String::from("address      word  cycles  instruction             line  source\n");
    let mut file = None;
    for address in addresses.start..addresses.end.min(program.code.len() as u32) {
        let place = program.lines.get(address as usize).map(|place| place.file);
        if place != file {
            file = place;
            let path =
                place.and_then(|file| program.files.get(file as usize)).map(|file| file.path.display().to_string());
            let _ = path
                .map(|path| writeln!(text, "{:1$}{path}", "", SOURCE.min(WIDTH.saturating_sub(path.chars().count()))));
        }
        text.push_str(&row(executable, address));
    }
    text
}

/// One instruction: address, word, cycles, what the word says, and the line of source that it comes from.
pub fn row(executable: &Executable, address: u32) -> String {
    let program = executable.program();
    let (cycles, instruction) = match executable.instructions.get(address as usize) {
        Some(Ok(instruction)) => (cycles(executable, address), instruction.display_at(address).to_string()),
        Some(Err(_)) => ("-".to_owned(), "no instruction".to_owned()),
        None => return format!("{address:>7}  the program ends before\n"),
    };
    let word = program.code[address as usize];
    let (line, source) = source(program, address);
    let line = line.map_or(String::new(), |line| line.to_string());
    let row = format!("{address:>7}  {word:08x}  {cycles:>6}  {instruction:<22} {line:>5}  ");
    let source = wrapped(&statement(source), WIDTH - SOURCE).replace('\n', &format!("\n{:SOURCE$}", ""));
    (row + &source).trim_end().to_owned() + "\n"
}

/// What a line of source says, without its comment and the spaces that set its parts off.
fn statement(source: &str) -> String {
    let said = source.split(';').next().unwrap_or_default();
    said.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// What an instruction is, and the line of source that it comes from: its number and its text.
pub fn fields(executable: &Executable, address: u32) -> (String, Option<u32>, &str) {
    let instruction = match executable.instructions.get(address as usize) {
        Some(Ok(instruction)) => instruction.display_at(address).to_string(),
        _ => "no instruction".to_owned(),
    };
    let (line, source) = source(executable.program(), address);
    (instruction, line, source)
}

/// The line of source of an instruction.
fn source(program: &Program, address: u32) -> (Option<u32>, &str) {
    match program.lines.get(address as usize) {
        Some(&place) => (Some(place.line), program.text_of(place).trim_end()),
        None => (None, ""),
    }
}

/// Source text that assembles to the same words.
pub fn disassembly(program: &Program) -> String {
    let mut text = String::new();
    for (&word, address) in program.code.iter().zip(0..) {
        let source = match Instruction::decode(word) {
            Ok(instruction) => {
                let written = instruction.display_at(address).to_string();
                let (mnemonic, operands) = written.split_once(' ').unwrap_or((&written, ""));
                format!("{mnemonic:<7} {operands}")
            }
            // The assembler refuses it, as it should: no source text gives this word.
            Err(why) => format!("{why}"),
        };
        let _ = writeln!(text, "        {source:<31} ; {address:>5}  {word:08x}");
    }
    if !program.data.is_empty() {
        text.push_str("        .data\n");
    }
    for (word, address) in program.data.iter().zip(0..) {
        let _ = writeln!(text, "        .word   {:<23} ; {address:>5}", format!("{word:#010x}"));
    }
    text
}

fn data(program: &Program) -> String {
    if program.data.is_empty() {
        return String::new();
    }
    let mut text = String::from("\naddress      word          data\n");
    for (&word, address) in program.data.iter().zip(0..) {
        let labels = program.data_labels.iter().filter(|(_, at)| **at == address).map(|(name, _)| name.as_str());
        let labels = labels.collect::<Vec<_>>().join(" ");
        let row = format!("{address:>7}  {word:08x}          {:<24} {labels}", super::words::likely(word));
        let _ = writeln!(text, "{}", row.trim_end());
    }
    text
}

/// A row for every branch or jump that goes back, which is the end of a loop.
fn loops(executable: &Executable) -> String {
    let mut text = String::new();
    for last in 0..executable.instructions.len() as u32 {
        let Some(first) = target(executable, last).filter(|&first| first <= last) else { continue };
        let Some((least, most)) = cycles_of_pass(executable, first, last) else { continue };
        if text.is_empty() {
            text.push_str("\nloop               addresses  instructions  cycles a pass\n");
        }
        let name = match executable.program().label_before(first) {
            Some((name, 0)) => name.to_owned(),
            _ => first.to_string(),
        };
        let cycles = if least == most { most.to_string() } else { format!("{least} to {most}") };
        let addresses = format!("{first} to {last}");
        let _ = writeln!(text, "{name:<15}  {addresses:>11}  {:>12}  {cycles:>13}", last - first + 1);
    }
    text
}

/// The least and the most cycles from a loop's first instruction through its last, by way of the branches that go forward
/// inside it. Inner loops are passed once, and a call takes no more than itself. `None` if no way leads there.
fn cycles_of_pass(executable: &Executable, first: u32, last: u32) -> Option<(u64, u64)> {
    let mut before: Vec<Option<(u64, u64)>> = vec![None; (last - first + 1) as usize];
    before[0] = Some((0, 0));
    for address in first..=last {
        let Some((least, most)) = before[(address - first) as usize] else { continue };
        let cycles = cost(executable, address) + wait(executable, address);
        let after = (least + cycles, most + cycles);
        if address == last {
            return Some(after);
        }
        let opcode = executable.instructions[address as usize].ok()?.opcode;
        let next = (!matches!(opcode, Opcode::Jmp | Opcode::Jr | Opcode::Done | Opcode::Halt)).then_some(address + 1);
        let jump = target(executable, address).filter(|_| opcode != Opcode::Call);
        for way in [next, jump].into_iter().flatten().filter(|way| (address + 1..=last).contains(way)) {
            let known = &mut before[(way - first) as usize];
            let (least, most) = known.unwrap_or(after);
            *known = Some((least.min(after.0), most.max(after.1)));
        }
    }
    None
}

/// Where a branch, jump or call goes, if it is an address.
fn target(executable: &Executable, address: u32) -> Option<u32> {
    let instruction = executable.instructions.get(address as usize)?.ok()?;
    let jumps = matches!(instruction.opcode.entry().format, Format::Branch | Format::Jump | Format::Call);
    jumps.then(|| address.checked_add_signed(instruction.constant)).flatten()
}

/// Cycles of an instruction, as a row has them.
fn cycles(executable: &Executable, address: u32) -> String {
    let cost = cost(executable, address);
    match executable.waits_at(address) {
        (0, 0) => cost.to_string(),
        _ => format!("{cost}+{}", wait(executable, address)),
    }
}

/// Cycles that an instruction waits for floating-point results.
fn wait(executable: &Executable, address: u32) -> u64 {
    let (before, behind) = executable.waits_at(address);
    (before + behind) * executable.wait_cycles()
}

/// Cycles of an instruction that need not wait: what it computes, and the words that it moves.
fn cost(executable: &Executable, address: u32) -> u64 {
    let words = executable.instructions[address as usize].map_or(0, |instruction| instruction.words());
    executable.cycles_at(address) + words as u64
}
