//! The cell's manual says what the program says: its tables are the table of instructions, its sessions what is printed.
//!
//! `UPDATE_DOCS=1 cargo test --release --test it manual` writes both anew.

use std::fmt::Write;
use std::process::Command;

use pcs_sim::isa::Field;
use pcs_sim::isa::table::{Format, TABLE};
use pcs_sim::isa::{Class, Operand};
use pcs_sim::machine::MachineFile;

const MANUAL: &str = "docs/cell.md";

#[test]
fn the_manual_is_true() {
    let text = std::fs::read_to_string(MANUAL).unwrap();
    let fresh = remade(&text);
    if std::env::var_os("UPDATE_DOCS").is_some() {
        std::fs::write(MANUAL, fresh).unwrap();
        return;
    }
    for (number, (is, should_be)) in (1..).zip(text.lines().zip(fresh.lines())) {
        assert_eq!(is, should_be, "line {number} of {MANUAL}; UPDATE_DOCS=1 writes it anew");
    }
    assert_eq!(text.len(), fresh.len(), "{MANUAL} has another end; UPDATE_DOCS=1 writes it anew");
}

/// The manual with each table and each command's output as they are now.
fn remade(text: &str) -> String {
    let mut fresh = String::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let _ = writeln!(fresh, "{line}");
        let (made, end) = if let Some(name) = line.strip_prefix("<!-- table: ") {
            (table(name.trim_end_matches(" -->")), "<!-- end -->")
        } else if let Some(command) = line.strip_prefix("$ pcs-sim ") {
            (output(command), "```")
        } else {
            continue;
        };
        fresh.push_str(&made);
        lines.by_ref().find(|line| *line == end).expect("what is made has an end");
        let _ = writeln!(fresh, "{end}");
    }
    fresh
}

fn output(command: &str) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_pcs-sim")).args(command.split(' ')).output().unwrap();
    assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn table(name: &str) -> String {
    match name {
        "classes" => classes(),
        "fields" => fields(),
        "formats" => formats(),
        "instructions" => instructions(),
        _ => panic!("there is no table `{name}`"),
    }
}

fn classes() -> String {
    let cycles = MachineFile::standard().unwrap().instruction_cycles.unwrap();
    let mut text = "| class | cycles | instructions |\n| --- | ---: | --- |\n".to_owned();
    for class in Class::ALL {
        let members = TABLE.iter().filter(|entry| entry.class == class);
        let members: Vec<String> = members.map(|entry| format!("`{}`", entry.mnemonic)).collect();
        let _ = writeln!(text, "| {} | {} | {} |", class.name(), cycles.of(class), members.join(" "));
    }
    text
}

fn fields() -> String {
    use Field::*;
    let mut text = "| field | bits | holds |\n| --- | --- | --- |\n".to_owned();
    let fields = [
        ("opcode", Opcode, "which instruction"),
        ("first", First, "a register or queue"),
        ("second", Second, "a register or queue"),
        ("third", Third, "a register or queue"),
        ("short", Short, "a constant or distance"),
        ("long", Long, "a constant or distance"),
    ];
    for (name, field, holds) in fields {
        let bits = field.bits();
        let range = match field {
            Short | Long => format!(", from {} to {}", field.range().start(), field.range().end()),
            _ => String::new(),
        };
        let _ = writeln!(text, "| {name} | {} to {} | {holds}{range} |", bits.end - 1, bits.start);
    }
    text
}

fn formats() -> String {
    let mut seen: Vec<Format> = Vec::new();
    let mut text = "| operands | fields |\n| --- | --- |\n".to_owned();
    for entry in TABLE {
        if seen.contains(&entry.format) {
            continue;
        }
        seen.push(entry.format);
        let operands: Vec<String> = entry.format.operands().iter().map(place).collect();
        let syntax = if operands.is_empty() { "none".to_owned() } else { format!("`{}`", entry.format.syntax()) };
        let _ = writeln!(text, "| {syntax} | {} |", operands.join(", "));
    }
    text
}

/// The fields of an operand, in the manual's words.
fn place(operand: &Operand) -> String {
    let name = |field: &Field| format!("{field:?}").to_lowercase();
    match operand {
        Operand::Write(field) => format!("{} (written)", name(field)),
        Operand::Read(field) | Operand::Constant(field) | Operand::Target(field) => name(field),
        Operand::Memory(register, constant) => format!("{} and {}", name(register), name(constant)),
    }
}

fn instructions() -> String {
    let mut text =
        "| instruction | opcode | class | effect | faults if |\n| --- | --- | --- | --- | --- |\n".to_owned();
    for entry in TABLE {
        let written = format!("{} {}", entry.mnemonic, entry.format.syntax());
        let (class, code) = (entry.class.name(), entry.opcode as u8);
        let _ =
            writeln!(text, "| `{}` | {code:#04x} | {class} | {} | {} |", written.trim(), entry.effect, entry.faults);
    }
    text
}
