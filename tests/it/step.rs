//! `pcs-sim step`, and the two programs that teach.

use std::path::Path;

use crate::support::command::Folder;
use pcs_sim::isa::{Executable, Processor, Queue, Queues, Stop, object};
use pcs_sim::machine::MachineFile;
use pcs_sim::seam::{OpKind, OpStream};
use proptest::prelude::*;

const FIR: &str = include_str!("../../pcs-programs/cells/fir.pcs");

/// What a standard program writes on X for words on X, when it waits for more.
fn filtered(name: &str, x: Vec<u32>) -> (Vec<u32>, OpStream) {
    let program = object::load(&Path::new("pcs-programs/cells").join(name)).unwrap();
    let executable = Executable::new(program, &MachineFile::standard().unwrap().instruction_cycles.unwrap());
    let mut cell = Processor::new(&executable, &executable.program().data, &[], 1_000_000);
    let mut queues = Queues { x, ..Queues::default() };
    let mut ops = OpStream::default();
    let stop = cell.run(&mut queues, &mut ops);
    assert!(matches!(stop, Ok(Stop::Waiting(Queue::X | Queue::PassX))), "{stop:?}");
    (queues.x_out, ops)
}

/// The same sum, in the filter's order: the oldest word first.
fn plain_fir(taps: &[f32], x: &[f32], n: usize) -> f32 {
    (0..taps.len()).rev().fold(0.0, |sum, k| taps[k] * n.checked_sub(k).map_or(0.0, |at| x[at]) + sum)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_fir_filter_is_the_plain_sum(x in prop::collection::vec(-1e6f32..1e6, 0..200)) {
        let (words, _) = filtered("fir.pcs", x.iter().map(|value| value.to_bits()).collect());
        let expected: Vec<f32> = (0..x.len()).map(|n| plain_fir(&[0.5, 0.25, 0.125, 0.125], &x, n)).collect();
        prop_assert_eq!(words.into_iter().map(f32::from_bits).collect::<Vec<_>>(), expected);
    }
}

#[test]
fn the_pass_through_passes_each_word_on_as_it_comes() {
    let (words, ops) = filtered("pass-through.pcs", vec![3, 1, 2]);
    assert_eq!(words, [3, 1, 2]);
    let passes = ops.ops().iter().filter(|op| op.kind() == OpKind::PassX && op.count() == 1);
    assert_eq!(passes.count(), 3, "{ops:?}");
}

/// Runs a session on `fir.pcs`, or on the program given.
fn session(program: &str, x: &str, script: &str) -> crate::support::command::Finished {
    let folder = Folder::new();
    folder.file("program.pcs", program);
    folder.file("x.txt", x);
    folder.file("script.txt", script);
    folder.run("step program.pcs --x x.txt --script script.txt")
}

#[test]
fn a_session() {
    let script = "break tap\nbreak\nrun\nrun\nregisters\nbreak tap\nbreak @11\nrun\nqueues\nmemory taps 3\nbreak 27\nrun\n\
                  list\nstep 2 ; comment\nbreak 27\nbreak @11\nrun\nqueues\nquit\nrun\n";
    insta::assert_snapshot!(session(FIR, "1.0, 0 0x0\n-2.5 ; the end", script).success());
}

#[test]
fn messages_done_and_begun_again() {
    let program = "mov r1, x\nadd y, r1, r1\ndone\n";
    insta::assert_snapshot!(session(program, "1 2", "run\nregisters\nstep\nrun\nqueues\nrun\n").success());
}

#[test]
fn a_session_whose_program_faults_fails() {
    let finished = session("li r1, 1\ndiv r1, r1, r0\n", "", "run\nregisters\nmemory 0\nrun\n");
    insta::assert_snapshot!(finished.stdout.clone());
    insta::assert_snapshot!(finished.failed());
}

#[test]
fn object_files_run_as_well() {
    let folder = Folder::new();
    folder.file("fir.pcs", FIR);
    folder.file("x.txt", "1 2 3");
    folder.file("script.txt", "run\nqueues\n");
    folder.run("asm fir.pcs -o fir.obj").success();
    let queues = |program: &str| {
        let session = folder.run(&format!("step {program} --x x.txt --script script.txt")).success();
        session.split_once("> queues").unwrap().1.to_owned()
    };
    assert_eq!(queues("fir.obj"), queues("fir.pcs"));
}

macro_rules! refusals {
    ($($name:ident: $x:literal, $script:literal;)*) => {
        $(#[test]
        fn $name() {
            insta::assert_snapshot!(stringify!($name), session(FIR, $x, $script).refused());
        })*
    };
}

refusals! {
    unknown_command: "1.0", "step\nstpe 2\n";
    command_used_wrongly: "1.0", "step 2 3\n";
    breakpoint_at_no_label: "1.0", "break tpa\n";
    breakpoint_behind_the_end: "1.0", "break 1000\n";
    breakpoint_outside_the_program: "1.0", "break @1000\n";
    memory_at_no_label: "1.0", "memory tap\n";
    word_too_large: "1 4294967296", "run\n";
    word_that_is_none: "1, 2\n3, x ; x", "run\n";
}

/// As a person types them: what cannot be is said, and the session goes on.
#[test]
fn commands_come_from_stdin() {
    let folder = Folder::new();
    let program = folder.file("fir.pcs", FIR);
    let script = folder.file("script.txt", "step\nstpe\n\nregisters\n");
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_pcs-sim"));
    command.args([Path::new("step"), &program]).stdin(std::fs::File::open(script).unwrap());
    let output = command.output().unwrap();
    assert!(output.status.success());
    insta::assert_snapshot!(String::from_utf8(output.stdout).unwrap());
    insta::assert_snapshot!(String::from_utf8(output.stderr).unwrap());
}

#[test]
fn a_word_that_is_no_instruction_is_shown_and_faults() {
    let folder = Folder::new();
    folder.file("bad.obj", "pcs object\ncode\n01f00000\nff000000\n");
    folder.file("script.txt", "run\nlist\nqueues\n");
    let source = folder.run("disasm bad.obj").success();
    let session = folder.run("step bad.obj --script script.txt");
    insta::assert_snapshot!(format!("{source}\n{}\n{}", session.stdout.clone(), session.failed()));
}

#[test]
fn stdin_is_one_thing_at_a_time() {
    let folder = Folder::new();
    folder.file("fir.pcs", FIR);
    insta::assert_snapshot!(folder.run("step fir.pcs --x -").refused());
}

/// `1` is an integer and no floating-point number: said where it may be meant as one.
#[test]
fn words_without_a_point_are_said() {
    let folder = Folder::new();
    folder.file("float.pcs", "fadd r2, x, x\ndone\n");
    folder.file("whole.pcs", "add r2, x, x\ndone\n");
    folder.file("script.txt", "run\n");
    for (program, words, is_said) in
        [("float", "1 2", true), ("float", "1.0 2", false), ("float", "0x3f800000 1", false), ("whole", "1 2", false)]
    {
        folder.file("x.txt", words);
        let session = folder.run(&format!("step {program}.pcs --x x.txt --script script.txt"));
        assert_eq!(session.stderr.contains("no word of x.txt has a point"), is_said, "{}", session.stderr);
    }
}
