//! Programs to words and back, words as programs, and source text that is wrong.

use std::path::{Path, PathBuf};

use crate::support::command::Folder;
use pcs_sim::isa::Field;
use pcs_sim::isa::table::TABLE;
use pcs_sim::isa::{
    Executable, FaultKind, Instruction, Processor, Program, Queues, Register, Sources, Stop, assemble, listing, object,
};
use pcs_sim::machine::MachineFile;
use pcs_sim::seam::OpStream;
use proptest::prelude::*;

/// Any valid instruction.
fn instruction() -> impl Strategy<Value = Instruction> {
    let registers = prop::array::uniform3(0u32..63);
    (0..TABLE.len(), registers, any::<i32>()).prop_map(|(entry, registers, constant)| {
        let opcode = TABLE[entry].opcode;
        let mut instruction = Instruction::new(opcode);
        for &field in opcode.fields() {
            let register = |place: usize| Register::new(registers[place]).unwrap();
            match field {
                Field::First => instruction.set_register(field, register(0)),
                Field::Second => instruction.set_register(field, register(1)),
                Field::Third => instruction.set_register(field, register(2)),
                // All of the field's values: the sign is what is above it.
                _ => instruction.constant = constant >> (32 - field.bits().len()),
            }
        }
        if instruction.written() == Some(Register::PASS_X) {
            instruction.set_register(Field::First, Register::X);
        }
        instruction
    })
}

/// Any word, and often one that is an instruction.
fn code_word() -> impl Strategy<Value = u32> {
    let plausible = (0..TABLE.len(), any::<u32>());
    prop_oneof![
        4 => instruction().prop_map(|instruction| instruction.encode()),
        // Short distances and small numbers, so that programs get somewhere.
        4 => instruction().prop_map(|mut instruction| { instruction.constant %= 8; instruction.encode() }),
        1 => plausible.prop_map(|(entry, word)| (TABLE[entry].opcode as u32) << 24 | word >> 8),
        1 => any::<u32>(),
    ]
}

fn written(text: &str) -> (Folder, PathBuf) {
    let folder = Folder::new();
    let path = folder.file("test.pcs", text);
    (folder, path)
}

/// The program that an object file of these words is.
fn from_words(code: Vec<u32>, data: Vec<u32>) -> Program {
    let (_folder, path) = written(&object::write(&Program { code, data, ..Program::default() }));
    object::load(&path).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn instructions_come_back_from_words(instruction in instruction()) {
        prop_assert_eq!(Instruction::decode(instruction.encode()), Ok(instruction));
    }

    #[test]
    fn programs_come_back_from_source_text_and_object_files(
        instructions in prop::collection::vec(instruction(), 0..40),
        data in prop::collection::vec(any::<u32>(), 0..10),
    ) {
        let code: Vec<u32> = instructions.iter().map(Instruction::encode).collect();
        let program = from_words(code.clone(), data.clone());
        prop_assert_eq!((&program.code, &program.data), (&code, &data));
        let (_folder, path) = written(&listing::disassembly(&program));
        let again = assemble(&path, Sources::Files, &[]).map_err(|error| TestCaseError::fail(error.to_string()))?;
        prop_assert_eq!((again.code, again.data), (code, data));
    }

    /// Whatever the words, a program ends its messages, halts, waits, or faults at a line.
    #[test]
    fn random_words_end_cleanly(
        code in prop::collection::vec(code_word(), 1..60),
        data in prop::collection::vec(any::<u32>(), 0..20),
        x in prop::collection::vec(any::<u32>(), 0..40),
        y in prop::collection::vec(any::<u32>(), 0..40),
    ) {
        let length = code.len() as u32;
        let costs = MachineFile::standard().unwrap().instruction_cycles.unwrap();
        let executable = Executable::new(from_words(code, data), &costs);
        listing::listing(&executable);
        let mut cell = Processor::new(&executable, &executable.program().data, &[1, 2, 3], 20_000);
        let mut queues = Queues { x, y, ..Queues::default() };
        for _message in 0..4 {
            match cell.run(&mut queues, &mut OpStream::default()) {
                Ok(Stop::Done) => {}
                Ok(Stop::Halted | Stop::Waiting(_)) => break,
                Err(fault) => {
                    let outside = fault.kind == FaultKind::OutsideProgram { length };
                    prop_assert_eq!(fault.address < length, !outside);
                    // `pcs object` and `code` are the first two lines.
                    let line = fault.source.as_ref().map(|source| source.line);
                    prop_assert_eq!(line, (!outside).then(|| fault.address + 3));
                    let says = fault.to_string();
                    prop_assert!(says.starts_with(&format!("cell 0, ray 0, address {}", fault.address)), "{}", says);
                    break;
                }
            }
        }
    }

    /// Whatever the text, the assembler makes a program of it or points into it.
    #[test]
    fn random_text_is_a_program_or_refused(
        lines in prop::collection::vec(prop::collection::vec(prop::sample::select(TOKENS), 0..8), 0..12),
    ) {
        let text: String = lines.iter().map(|line| line.join(" ") + "\n").collect();
        let (_folder, path) = written(&text);
        if let Err(error) = assemble(&path, Sources::Files, &[]) {
            let place = error.place.as_ref().map(|place| (place.file.as_path(), place.spot.is_some()));
            prop_assert_eq!(place, Some((path.as_path(), true)), "{}", error);
        }
    }
}

const TOKENS: &[&str] = &[
    "add",
    "li",
    "lw",
    "sw",
    "jmp",
    "beq",
    "mov",
    "done",
    "r1",
    "r2",
    "r59",
    "x",
    "xp",
    "y",
    "name",
    "other",
    "name:",
    ":",
    ",",
    ",",
    ",",
    "=",
    "[",
    "]",
    "+",
    "-",
    "*",
    "/",
    "(",
    ")",
    "<<",
    "~",
    "0",
    "1",
    "4096",
    "0xffffffff",
    "1.5",
    "9223372036854775807",
    "inf",
    ";",
    "\"a\"",
    "{p}",
    "é",
    ".data",
    ".code",
    ".word",
    ".float",
    ".space",
    ".loaded",
    ".macro",
    ".if",
    ".else",
    ".end",
    ".reg",
    ".option",
    ".count",
    ".kernel",
    ".include",
    ".wrod",
];

#[test]
fn all_standard_programs_come_back() {
    for entry in std::fs::read_dir("pcs-programs/cells").unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "pcs") {
            let program = object::load(&path).unwrap_or_else(|error| panic!("{error}"));
            let (_folder, source) = written(&listing::disassembly(&program));
            let again = assemble(&source, Sources::Files, &[]).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!((again.code, again.data), (program.code, program.data), "{}", path.display());
        }
    }
}

#[test]
fn asm_and_disasm_on_the_command_line() {
    let folder = Folder::new();
    folder.file("sum.pcs", "next: add r1, r1, x\n mov y, r1\n jmp next\n");
    let object = folder.run("asm sum.pcs").success();
    insta::assert_snapshot!("object", object);
    assert_eq!(folder.run("asm sum.pcs -o sum.obj --listing sum.lst").success(), "wrote sum.obj\nwrote sum.lst\n");
    assert_eq!(folder.read("sum.obj"), object);
    assert_eq!(folder.run("asm sum.pcs --listing").success(), folder.read("sum.lst"));
    folder.run("asm sum.pcs -o sum.obj").refused();
    folder.run("asm sum.pcs -o sum.pcs --force").refused();
    let source = folder.run("disasm sum.obj").success();
    insta::assert_snapshot!("disassembly", source);
    folder.file("again.pcs", source);
    assert_eq!(folder.run("asm again.pcs").success(), object);
}

#[test]
fn a_listing_counts_loops_with_two_ways_through_them() {
    let folder = Folder::new();
    folder.file("ways.pcs", "next: mov r1, x\n bge r1, r0, on\n fneg r1, r1\n mul r1, r1, r1\non: jmp next\n");
    insta::assert_snapshot!(folder.run("asm ways.pcs --listing").success());
}

macro_rules! refusals {
    ($($command:literal $name:ident: $text:literal;)*) => {
        $(#[test]
        fn $name() {
            let folder = Folder::new();
            folder.file("bad.pcs", $text);
            insta::assert_snapshot!(stringify!($name), folder.run($command).refused());
            assert_eq!(folder.names().len(), 1, "nothing is written");
        })*
    };
}

refusals! {
    "asm bad.pcs" source_unknown_instruction: "        fmull r1, r2, r3\n";
    "asm bad.pcs" source_unknown_label: "loop:   addi r1, r1, 1\n        jmp lop\n";
    "asm bad.pcs" source_unknown_register: "        .reg sample r1\n        mov r2, smaple\n";
    "asm bad.pcs" source_too_few_operands: "        add r1, r2\n";
    "asm bad.pcs" source_too_many_operands: "        fneg r1, r2, r3\n";
    "asm bad.pcs" source_constant_too_large: "        addi r1, r1, 2048\n";
    "asm bad.pcs" source_jump_too_far: "        beq r0, r0, 5000\n";
    "asm bad.pcs" source_label_twice: "a:      done\na:      halt\n";
    "asm bad.pcs" source_writes_xp: "        mov xp, r1\n";
    "asm bad.pcs" source_word_in_code: "        .word 5\n";
    "asm bad.pcs" source_instruction_in_data: "        .data\n        li r1, 5\n";
    "asm bad.pcs" source_macro_argument: "        .macro twice reg\n        add {reg}, {reg}, {reg}\n        .end\n        twice 5\n";
    "asm bad.pcs" source_block_not_closed: "        .if 1\n        done\n";
    "asm bad.pcs" source_include_missing: "        .include \"nowhere.pcs\"\n";
    "asm bad.pcs" source_not_a_number: "        li r1, 0xfg\n";
    "asm bad.pcs" source_unknown_directive: "        .dtaa\n";
    "disasm bad.pcs" object_bad_word: "pcs object\ncode\n0103c00\n";
    "disasm bad.pcs" object_no_section: "pcs object\n0103c000\n";
}

#[test]
fn files_that_are_no_text_are_refused() {
    let folder = Folder::new();
    folder.file("bad.pcs", b"\xff\xfe\x00\x01".as_slice());
    insta::assert_snapshot!(folder.run("disasm bad.pcs").refused());
    assert!(object::load(Path::new("nowhere.pcs")).is_err());
}
