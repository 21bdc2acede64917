//! Floating-point results that have a latency: what waits for them, and what that comes to.

use std::collections::{BTreeMap, BTreeSet};
use std::convert::Infallible;
use std::fmt::Write;
use std::path::Path;

use crate::programs_agree::folder_with;
use crate::support::command::{Folder, run_in};
use crate::support::{bits, cell_options, machine, ops, program, scene, spent};
use pcs_sim::geometry::Ray;
use pcs_sim::isa::{Executable, InstructionCycles, Queues, Sources, Stepper, Stop, assemble, kernels};
use pcs_sim::machine::{Machine, MachineFile, MachineSpec};
use pcs_sim::program::cells::CellOptions;
use pcs_sim::program::figure7::two_constants::two_constants;
use pcs_sim::program::figure7::{NUMBERS, mix, numbers, us};
use pcs_sim::program::{Workload, work};
use pcs_sim::run::{self, Outcome, Workers};
use pcs_sim::scene::Mesh;
use pcs_sim::seam::{Activity, Unit};
use proptest::prelude::*;

/// The machine file with two constants.
const FPU: &str = "pcs-programs/pcs-fpu.ron";

fn fpu() -> Machine {
    MachineFile::read(Path::new(FPU)).unwrap().build().unwrap()
}

/// A machine file that is the standard one but for its instructions: 4 cycles each, and a latency.
fn machine_file(latency: &str) -> String {
    let classes = "integer: 4, multiply: 4, divide: 4, load: 4, store: 4, float_add: 4, float_multiply: 4, float_divide: 4, \
                   float_compare: 4, branch: 4,";
    format!("(base: \"standard\", instruction_cycles: ({classes} {latency}))")
}

/// A folder with such a machine file, `m.ron`, and a program, `p.pcs`.
fn folder(latency: &str, text: &str) -> Folder {
    let folder = Folder::new();
    folder.file("m.ron", machine_file(latency));
    folder.file("p.pcs", text);
    folder
}

/// Cycles that can be counted on fingers: 4 an instruction, 1 a word, 28 a wait.
const COUNTED: &str = "        itof    r1, x           ; 1 + 4
        fadd    r2, r1, r1      ; 28 + 4: waits for r1
        fmul    r3, r1, r1      ; 4: it is there
        lw      r4, [two]       ; 4
        fsub    r5, r3, r2      ; 28 + 4: one wait for both
        fblt    r4, r5, more    ; 28 + 4 + 28: waits for r5, and to know where to go
        li      r7, 1           ; not executed
more:   fadd    r6, r5, r4      ; 4
        mov     y, r6           ; 28 + 1: waits, and moves a word
        done
        .data
two:    .float  2.0
";

#[test]
fn waits_are_counted_as_on_fingers() {
    let cycles = |latency: &str| {
        let folder = folder(latency, COUNTED);
        folder.file("x.txt", "3");
        folder.file("script.txt", "run\nqueues\n");
        let told = folder.run("step p.pcs --machine m.ron --x x.txt --script script.txt").success();
        assert!(told.contains("Y out  1 written: 5"), "{told}");
        let line = told.lines().find(|line| line.contains("done with the message")).unwrap().to_owned();
        line.split_once(", cycle ").unwrap().1.split_once(' ').unwrap().0.parse::<u64>().unwrap()
    };
    let without = 5 + 4 + 4 + 4 + 4 + 4 + 4 + 1;
    assert_eq!(cycles("float_latency: 28"), without + 5 * 28);
    assert_eq!(cycles("float_latency: 1"), without + 5);
    assert_eq!((cycles("float_latency: 0"), cycles("")), (without, without));
}

/// A session shows which instruction waits, and the listing what a loop waits.
#[test]
fn waits_are_shown() {
    let text = "        li r5, 4\nnext:   fmul r1, r1, r2\n fadd r3, r3, r1\n addi r5, r5, -1\n bne r5, r0, next\n mov y, r3\n done\n";
    let folder = folder("float_latency: 28", text);
    folder.file("script.txt", "list\nstep 2\nstep\nrun\n");
    let session = folder.run("step p.pcs --machine m.ron --script script.txt").success();
    let listing = folder.run("asm p.pcs --machine m.ron --listing").success();
    insta::assert_snapshot!(format!("{session}\n{listing}"));
    folder.file("n.ron", machine_file(""));
    let without = folder.run("asm p.pcs --machine n.ron --listing").success();
    assert!(!without.contains('+'), "{without}");
}

/// The waits of each instruction of a program: before it, and behind it.
fn waits(text: &str) -> Vec<(u64, u64)> {
    let executable = executable(text, &InstructionCycles { float_latency: Some(1), ..InstructionCycles::default() });
    (0..executable.program().code.len() as u32).map(|address| executable.waits_at(address)).collect()
}

fn executable(text: &str, cycles: &InstructionCycles) -> Executable {
    let folder = Folder::new();
    let path = folder.file("p.pcs", text);
    Executable::new(assemble(&path, Sources::Files, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")), cycles)
}

#[test]
fn what_waits_and_what_does_not() {
    for (text, expected) in [
        // Whatever names the register waits: a load by it, an integer, a store of it, one that writes it.
        ("fadd r1, r2, r2\n lw r3, [r1]\n done", vec![(0, 0), (1, 0), (0, 0)]),
        ("flt r1, r2, r2\n and r3, r3, r1\n done", vec![(0, 0), (1, 0), (0, 0)]),
        ("fmul r1, r2, r2\n sw r1, [r3]\n done", vec![(0, 0), (1, 0), (0, 0)]),
        ("fmul r1, r2, r2\n li r1, 3\n done", vec![(0, 0), (1, 0), (0, 0)]),
        // Not another register, not `r0`, and not twice.
        (
            "fadd r1, r2, r2\n fmul r3, r2, r2\n add r4, r1, r3\n add r4, r3, r3\n done",
            vec![(0, 0), (0, 0), (1, 0), (0, 0), (0, 0)],
        ),
        ("fadd r0, r2, r2\n add r1, r0, r0\n done", vec![(0, 0); 3]),
        // A wait lets all that is under way arrive, and not what comes behind it.
        ("fadd r1, r2, r2\n fadd r3, r1, r2\n mov r4, r3\n done", vec![(0, 0), (1, 0), (1, 0), (0, 0)]),
        // A division takes what it takes, and waits for what it divides.
        ("fdiv r1, r2, r2\n mov r3, r1\n done", vec![(0, 0); 3]),
        ("fadd r1, r2, r2\n fdiv r3, r1, r2\n mov r4, r3\n done", vec![(0, 0), (1, 0), (0, 0), (0, 0)]),
        // Nothing is under way behind a branch that is taken or not, a call, an end.
        ("fadd r1, r2, r2\n beq r5, r5, on\n on: done", vec![(0, 0), (1, 0), (0, 0)]),
        ("fadd r1, r2, r2\n done", vec![(0, 0), (1, 0)]),
        ("fadd r1, r2, r2\n call r9, on\n on: jr r9", vec![(0, 0), (1, 0), (0, 0)]),
        // A branch by a comparison waits for its outcome, and for what it compares.
        ("fblt r1, r2, on\n on: done", vec![(0, 1), (0, 0)]),
        ("fadd r1, r2, r2\n fble r3, r2, on\n on: done", vec![(0, 0), (0, 1), (0, 0)]),
        ("fadd r1, r2, r2\n fble r1, r2, on\n on: done", vec![(0, 0), (1, 1), (0, 0)]),
        // What falls into a loop waits before it, not in it.
        ("fadd r1, r2, r2\n li r3, 1\n on: mov r4, r1\n jmp on", vec![(0, 0), (0, 1), (0, 0), (0, 0)]),
        // Nor is anything under way where a word is moved; a result for a queue is waited for.
        ("fadd r1, r2, r2\n mov r3, x\n mov r4, r1\n done", vec![(0, 0), (1, 0), (0, 0), (0, 0)]),
        ("fadd r1, x, x\n mov r4, r1\n done", vec![(0, 0), (1, 0), (0, 0)]),
        ("fadd y, r1, x\n mov y, r1\n done", vec![(0, 1), (0, 0), (0, 0)]),
    ] {
        assert_eq!(waits(text), expected, "{text}");
    }
}

/// The wait before a word is read comes before it, and that for a result before it is written.
#[test]
fn waits_stand_among_words() {
    let cycles = machine().instructions.unwrap();
    let cycles = InstructionCycles { float_latency: Some(28), ..cycles };
    let executable = executable("fadd r1, r2, r2\n fmul y, x, x\n done", &cycles);
    let mut cell = pcs_sim::isa::Processor::new(&executable, &[], &[], 100);
    let mut queues = Queues { x: vec![1, 2], ..Queues::default() };
    let mut done = pcs_sim::seam::OpStream::default();
    assert_eq!(cell.run(&mut queues, &mut done), Ok(Stop::Done));
    let vocabulary = work::vocabulary_with(true, &[work::FLOAT_WAIT]);
    let code = |unit: Unit| vocabulary.unit(unit).unwrap().code.clone();
    let told: Vec<String> = done
        .ops()
        .iter()
        .map(|op| format!("{}{}", op.unit().map_or_else(|| op.kind().letter().unwrap().to_string(), code), op.count()))
        .collect();
    assert_eq!(told.join(" "), "cfadd1 clat1 r2 cfmul1 clat1 o1");
}

/// An instruction as the test knows it: its text, what it reads and writes, and what it is.
struct Line {
    text: String,
    reads: Vec<u32>,
    writes: Option<u32>,
    moves: u64,
    cost: u64,
    kind: Kind,
    to: Option<usize>,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Piped,
    PipedBranch,
    PipedOut,
    Branch,
    Other,
}

const COSTS: InstructionCycles = InstructionCycles {
    integer: 1,
    multiply: 2,
    divide: 3,
    load: 4,
    store: 5,
    float_add: 6,
    float_multiply: 7,
    float_divide: 8,
    float_compare: 9,
    branch: 10,
    float_latency: Some(1000),
};

fn line((kind, [a, b, c], skip): (u32, [u32; 3], usize), place: usize, length: usize) -> Line {
    let to = (place + 1 + skip).min(length);
    let line = |text: String, reads: &[u32], writes: Option<u32>, cost: u64, kind: Kind| Line {
        text,
        reads: reads.to_vec(),
        writes,
        moves: 0,
        cost,
        kind,
        to: None,
    };
    match kind {
        0..=3 => line(format!("fadd r{a}, r{b}, r{c}"), &[b, c], Some(a), 6, Kind::Piped),
        4 | 5 => line(format!("fmul r{a}, r{b}, r{c}"), &[b, c], Some(a), 7, Kind::Piped),
        6 => line(format!("fle r{a}, r{b}, r{c}"), &[b, c], Some(a), 9, Kind::Piped),
        7 => line(format!("fdiv r{a}, r{b}, r{c}"), &[b, c], Some(a), 8, Kind::Other),
        8 | 9 => line(format!("or r{a}, r{b}, r{c}"), &[b, c], Some(a), 1, Kind::Other),
        10 => line(format!("lw r{a}, [r0 + {b}]"), &[], Some(a), 4, Kind::Other),
        11 => line(format!("sw r{a}, [r0 + {b}]"), &[a], None, 5, Kind::Other),
        12 => Line { to: Some(to), ..line(format!("beq r{a}, r{b}, l{to}"), &[a, b], None, 10, Kind::Branch) },
        13 => Line { to: Some(to), ..line(format!("fblt r{a}, r{b}, l{to}"), &[a, b], None, 9, Kind::PipedBranch) },
        14 => Line { moves: 1, ..line(format!("mov r{a}, x"), &[], Some(a), 0, Kind::Other) },
        15 => Line { moves: 1, ..line(format!("mov y, r{a}"), &[a], None, 0, Kind::Other) },
        16 => Line { moves: 3, ..line("fadd y, x, x".to_owned(), &[], None, 6, Kind::PipedOut) },
        _ => Line { moves: 1, ..line(format!("fsub r{a}, xp, r{b}"), &[b], Some(a), 6, Kind::Piped) },
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// What an instruction waits by its address is what a pipeline makes it wait that is watched while the program runs.
    #[test]
    fn waits_are_those_of_a_pipeline(
        drawn in prop::collection::vec((0u32..18, [0u32..5, 0u32..5, 0u32..5], 0usize..4), 1..40)
    ) {
        let length = drawn.len();
        let lines: Vec<Line> = drawn.into_iter().enumerate().map(|(place, drawn)| line(drawn, place, length)).collect();
        let entries: BTreeSet<usize> = lines.iter().filter_map(|line| line.to).collect();
        let mut text = String::new();
        lines.iter().enumerate().for_each(|(place, line)| writeln!(text, "l{place}: {}", line.text).unwrap());
        let executable = executable(&format!("{text}l{length}: halt\n .data\n .word 0, 1, 5, 7, 9\n"), &COSTS);
        let mut cell = Stepper::new(&executable, Queues { x: vec![3; 200], ..Queues::default() }, 1000);
        let mut under_way: BTreeSet<u32> = BTreeSet::new();
        loop {
            let (place, before) = (cell.address() as usize, cell.cycles());
            let stop = cell.step().unwrap();
            let Some(line) = lines.get(place) else {
                prop_assert_eq!((stop, cell.cycles() - before), (Some(Stop::Halted), 1000 * u64::from(!under_way.is_empty())));
                break;
            };
            let mut waits = 0;
            let mut wait = |under_way: &mut BTreeSet<u32>| {
                waits += 1;
                under_way.clear();
            };
            let is_named = line.reads.iter().chain(&line.writes).any(|register| under_way.contains(register));
            if is_named || ((line.moves > 0 || line.kind == Kind::Branch) && !under_way.is_empty()) {
                wait(&mut under_way);
            }
            match line.kind {
                Kind::Piped => under_way.extend(line.writes.filter(|&register| register > 0)),
                Kind::PipedBranch | Kind::PipedOut => wait(&mut under_way),
                Kind::Branch | Kind::Other => {}
            }
            if entries.contains(&(place + 1)) && !under_way.is_empty() {
                wait(&mut under_way);
            }
            prop_assert_eq!(cell.cycles() - before, line.cost + line.moves + 1000 * waits, "{} in\n{}", line.text, text);
        }
    }
}

fn options(latency: Option<u32>) -> CellOptions {
    let cycles = InstructionCycles { float_latency: latency, ..machine().instructions.unwrap() };
    CellOptions { cycles, ..cell_options() }
}

fn run(workload: &Workload, rays: &[Ray]) -> Outcome {
    run::run(workload, &machine().spec, rays, &Workers::new(2), |_| Ok::<_, Infallible>(())).unwrap()
}

/// Waits by cell and by the kernel that they are for.
fn waits_of(workload: &Workload, rays: &[Ray]) -> BTreeMap<(usize, u8), u64> {
    let mut waits = BTreeMap::new();
    for batch in ops(workload, rays) {
        for (cell, stream) in batch.cells.iter().enumerate() {
            for op in stream.ops() {
                let kernel = (0..4).find(|&kernel| op.unit() == Some(kernels::float_wait(Activity(kernel))));
                kernel
                    .into_iter()
                    .for_each(|kernel| *waits.entry((cell, kernel)).or_default() += u64::from(op.count()));
            }
        }
    }
    waits
}

/// Cycles with a latency are those without, and the latency for each wait, in every cell and for every kernel; and no bit of a hit
/// is another.
#[test]
fn a_latency_takes_its_waits_and_changes_nothing_else() {
    for (name, size, width) in [("teapot", 3, 12), ("gears", 1, 8)] {
        let (scene, rays) = scene(name, size, width);
        for (mode, groups) in [("pipeline", 1), ("broadcast", 3), ("hybrid", 2)] {
            let of = |latency: Option<u32>| {
                let workload = Workload::new(&scene.mesh, &program(mode, groups), machine().times, &rays).unwrap();
                workload.with_programs(&options(latency)).unwrap()
            };
            let [without, zero, long] = [None, Some(0), Some(31)].map(|latency| run(&of(latency), &rays));
            assert_eq!(
                (&without.stats.cycles, &without.stats.stations),
                (&zero.stats.cycles, &zero.stats.stations),
                "{name} {mode}"
            );
            for other in [&zero, &long] {
                let hits = |outcome: &Outcome| outcome.hits.iter().map(bits).collect::<Vec<_>>();
                assert_eq!((hits(&without), without.counts), (hits(other), other.counts), "{name} {mode}");
            }
            assert!(waits_of(&of(None), &rays).is_empty());
            let waits = waits_of(&of(Some(31)), &rays);
            assert_eq!(waits, waits_of(&of(Some(0)), &rays), "what waits does not hang on what it costs");
            assert!(waits.values().sum::<u64>() > 1000, "{waits:?}");
            for cell in 0..without.stats.stations.len() {
                for (kernel, state) in kernels::KERNELS.into_iter().enumerate() {
                    let waits = waits.get(&(cell, kernel as u8)).copied().unwrap_or(0);
                    let [before, after] = [&without, &long].map(|outcome| spent(&outcome.stats, cell, state));
                    assert_eq!(after, before + 31 * waits, "{name} {mode}, cell {cell}, {state}");
                }
            }
        }
    }
}

/// A trace that counts waits can be timed under any latency; one that does not is refused where there is one.
#[test]
fn traces_count_waits() {
    let folder = folder("float_latency: 28", "");
    folder.file("zero.ron", machine_file("float_latency: 0"));
    folder.file("none.ron", machine_file(""));
    let cycles = |command: &str| {
        folder.run(&format!("{command} --stats s.json --force")).success();
        let stats: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
        (stats["cycles"].as_u64().unwrap(), stats["cells"].clone())
    };
    let scene = "--scene teapot --size-factor 2 --size 8x8 --cells-run programs";
    let made = ["m", "zero", "none"].map(|name| cycles(&format!("{scene} --machine {name}.ron --ops {name}.ops")));
    assert!(made[0].0 > made[1].0 && made[1] == made[2]);
    assert!(folder.read("m.ops").contains("unit slat float_latency slabs 28\n"));
    assert!(!folder.read("none.ops").contains("float_latency"));
    for (machine, expected) in ["m", "zero", "none"].into_iter().zip(&made) {
        for trace in ["m", "zero"] {
            assert_eq!(cycles(&format!("replay {trace}.ops --machine {machine}.ron")), *expected, "{trace} {machine}");
        }
    }
    assert_eq!(cycles("replay m.ops"), made[0]);
    assert_eq!(cycles("replay none.ops --machine zero.ron"), made[1]);
    for command in ["replay none.ops --machine m.ron", "figure7 --ops none.ops --machine m.ron"] {
        let refused = folder.run(command).refused();
        assert!(refused.contains("counts no waits") && refused.contains("float_latency"), "{refused}");
    }
    let told = folder.run("figure7 --ops m.ops --machine m.ron").success();
    let run = folder.run(&format!("{scene} --machine m.ron")).success();
    let time = run.split_once("simulated time ").unwrap().1.split_once(" (").unwrap().0;
    assert!(told.replace('\n', " ").contains(&format!("On this machine it takes {time}.")), "{told}\n{time}");
    let why = folder.run(&format!("why {scene} --mode broadcast --cells 2 --machine m.ron")).success();
    assert!(why.contains("floating-point latency") && why.contains("waits of"), "{why}");
}

/// What the machine file says of Figure 7 is what it makes of it.
#[test]
fn figure_7_by_a_pipeline() {
    let machine = fpu();
    let cycles = machine.instructions.unwrap();
    let made = numbers(&machine.times, Some(&CellOptions { cycles, ..cell_options() })).unwrap();
    let text = std::fs::read_to_string(FPU).unwrap();
    for (number, made) in NUMBERS.iter().zip(made) {
        let made = us(made, &machine.spec);
        let off = 100.0 * (made / number.paper_us - 1.0);
        let row = format!("    //   {:<24} {:>7.2}  {made:>7.2}  {off:>+8.1} %\n", number.name, number.paper_us);
        assert!(text.contains(&row), "{FPU} has another row than\n{row}");
        let row = format!("| {} | {} | {made:.2} | {off:+.1} % |\n", number.name, number.paper_us);
        assert!(
            include_str!("../../docs/cell-programs.md").contains(&row),
            "docs/cell-programs.md has another row than\n{row}"
        );
    }
    insta::assert_snapshot!(run_in(Path::new("."), &format!("figure7 --machine {FPU}")).success());
}

/// No other pair of whole cycles is nearer than the one that is told.
#[test]
fn the_two_constants_are_the_nearest() {
    let machine = fpu();
    let cycles = machine.instructions.unwrap();
    let best = two_constants(&machine.spec, &cycles, None).unwrap();
    let told = format!(
        "with {} cycles ({} ns) for an instruction and {} for a wait, the nearest of all pairs of whole cycles,\nthe worst number is {:.1} % off",
        best.instruction,
        50 * best.instruction,
        best.latency,
        100.0 * best.off
    );
    assert!(include_str!("../../docs/cell-programs.md").contains(&told), "docs/cell-programs.md has other than {told}");
    let told = format!("none of two constants (an instruction, a latency) within {:.0} %", (100.0 * best.off).floor());
    assert!(include_str!("../../README.md").contains(&told), "README.md has other than {told}");
    let with = |instruction: u32, latency: u32| {
        let iterated = InstructionCycles { multiply: 20, divide: 40, float_divide: 20, ..cycles };
        let [i, latency] = [instruction, latency];
        let all = InstructionCycles { integer: i, load: i, store: i, float_add: i, float_multiply: i, ..iterated };
        let cycles = InstructionCycles { float_compare: i, branch: i, float_latency: Some(latency), ..all };
        let made = numbers(&machine.times, Some(&CellOptions { cycles, ..cell_options() })).unwrap();
        let off = |(made, paper): (f64, f64)| (us(made, &machine.spec) / paper - 1.0).abs();
        (made, made.into_iter().zip(NUMBERS.map(|number| number.paper_us)).map(off).fold(0.0, f64::max))
    };
    let (made, off) = with(best.instruction, best.latency);
    assert!(
        (off - best.off).abs() < 1e-9 && made.iter().zip(best.numbers).all(|(made, told)| (made - told).abs() < 1e-9)
    );
    for (instruction, latency) in (1..=6).flat_map(|i| [0, 1, 2, 3, 4, 8, 28].map(|latency| (i, latency))) {
        assert!(with(instruction, latency).1 >= best.off - 1e-9, "{instruction} {latency}");
    }
}

/// What is behind the six numbers, as docs/cell-programs.md tells: in microinstructions of 200 ns.
#[test]
fn what_waits_behind_figure_7_is_documented() {
    let counted = mix(Some(&options(Some(0)))).unwrap();
    let vocabulary = work::vocabulary_with(true, &[work::FLOAT_WAIT]);
    let mut table = String::from(
        "| number | paper | instructions | additions and comparisons | waits | these and 7 for each wait |\n\
         | --- | ---: | ---: | ---: | ---: | ---: |\n",
    );
    for (number, row) in NUMBERS.iter().zip(counted) {
        let sum = |is: &dyn Fn(&str) -> bool| {
            let units = vocabulary.units.iter().zip(row).skip(usize::from(kernels::FIRST_UNIT));
            units.filter(|(unit, _)| is(&unit.name)).map(|(_, count)| count).sum::<f64>()
        };
        let all = sum(&|name| name != kernels::FLOAT_LATENCY);
        let added = sum(&|name| ["float_add", "float_compare"].contains(&name));
        let waits = sum(&|name| name == kernels::FLOAT_LATENCY);
        let _ = writeln!(
            table,
            "| {} | {} | {all:.0} | {added:.0} | {waits:.0} | {:.0} |",
            number.name,
            number.paper_us / 0.2,
            added + 7.0 * waits
        );
    }
    assert!(
        include_str!("../../docs/cell-programs.md").contains(&table),
        "docs/cell-programs.md has another table than\n{table}"
    );
}

/// The slabs' test with its seven directions side by side: each step of all of them before the next.
fn side_by_side(text: &str) -> String {
    let head = text.split("        slab_of 1,").next().unwrap();
    let directions = [
        ("ox", "per_dx"),
        ("oy", "per_dy"),
        ("oz", "per_dz"),
        ("s_4", "t_4"),
        ("s_5", "t_5"),
        ("s_6", "t_6"),
        ("s_7", "t_7"),
    ];
    let enter = ["g", "h", "i", "j", "k", "l", "m"];
    let leave = ["n", "o", "p", "q", "r", "s", "u"];
    let mut made = head.to_owned();
    let mut each = |step: &dyn Fn(usize) -> String| (0..7).for_each(|i| made += &step(i));
    each(&|i| {
        format!(
            "        fadd {}, {}, margin\n        fsub {}, {}, margin\n",
            enter[i], directions[i].0, leave[i], directions[i].0
        )
    });
    for (names, word) in [(enter, 0), (leave, 1)] {
        each(&|i| format!("        lw a, [slab + {}]\n        fsub {}, a, {}\n", 2 * i + word, names[i], names[i]));
    }
    for names in [enter, leave] {
        each(&|i| format!("        fmul {}, {}, {}\n", names[i], names[i], directions[i].1));
    }
    // The lesser of two goes where the one before has been read.
    let lesser = |i: usize| if i == 0 { "a" } else { enter[i - 1] };
    each(&|i| {
        format!(
            "        fmin {}, {}, {}\n        fmax {}, {}, {}\n",
            lesser(i),
            enter[i],
            leave[i],
            leave[i],
            enter[i],
            leave[i]
        )
    });
    each(&|i| format!("        fmax near, {}, near\n        fmin far, {}, far\n", lesser(i), leave[i]));
    made + "        fblt far, near, next_polygon\n"
}

fn run_from(mesh: &Mesh, rays: &[Ray], options: &CellOptions) -> Outcome {
    let workload = Workload::new(mesh, &program("pipeline", 1), machine().times, rays).unwrap();
    run(&workload.with_programs(options).unwrap(), rays)
}

/// What an order of instructions that minds the pipeline gains, as docs/cell-programs.md tells: the same bits, and fewer waits.
#[test]
fn side_by_side_slabs_wait_less() {
    let test = std::fs::read_to_string("pcs-programs/cells/kernels/slabs-test.pcs").unwrap();
    let folder = folder_with("kernels/slabs-test.pcs", &side_by_side(&test));
    let spec: MachineSpec = fpu().spec;
    let cycles = fpu().instructions.unwrap();
    let standard = CellOptions { cycles, ..cell_options() };
    let other = CellOptions { folder: Some(folder.path("cells")), ..standard.clone() };
    let (scene, rays) = scene("tree", 3, 24);
    let [before, after] = [&standard, &other].map(|options| run_from(&scene.mesh, &rays, options));
    let hits = |outcome: &Outcome| outcome.hits.iter().map(bits).collect::<Vec<_>>();
    assert_eq!((hits(&before), before.counts), (hits(&after), after.counts));
    assert!(before.counts.slab_tests > 1000 && after.stats.cycles < before.stats.cycles);
    let of = |options: &CellOptions| us(numbers(&fpu().times, Some(options)).unwrap()[3], &spec);
    let told = format!("{:.1} µs instead of {:.1}", of(&other), of(&standard));
    assert!(include_str!("../../docs/cell-programs.md").contains(&told), "docs/cell-programs.md has other than {told}");
}
