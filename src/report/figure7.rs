//! How well Figure 7 tells what instructions cost.

use crate::isa::Class;
use crate::machine::MachineSpec;
use crate::measure::Clock;
use crate::program::figure7::calibrate::{BOUNDS, whole_cycles};
use crate::program::figure7::fits::Within;
use crate::program::figure7::two_constants::TwoConstants;
use crate::program::figure7::{NUMBERS, us};
use crate::quantities::Cycles;
use crate::report::summary::{WIDTH, aligned, grouped, plural, table, time, wrapped};
use crate::run::Range;

/// How many machines come near Figure 7, and what each class of instructions costs in them, in cycles.
pub fn within(all: &[Within], spec: &MachineSpec) -> String {
    let percents: Vec<String> = all.iter().map(|within| format!("{} %", within.percent)).collect();
    let header: Vec<&str> =
        ["machines within", "plausible"].into_iter().chain(percents.iter().map(String::as_str)).collect();
    let mut rows = table(&header);
    let counts = all.iter().map(|within| grouped(within.machines));
    rows.add_row(["how many".to_owned(), String::new()].into_iter().chain(counts));
    for class in Class::ALL {
        let ranges = all.iter().map(|within| range(within.ranges[class as usize]));
        rows.add_row([format!("{}, cycles", class.name()), plausible(class, spec)].into_iter().chain(ranges));
    }
    format!("{}\n{}", aligned(rows), sentence(all))
}

/// What the best two constants make of Figure 7.
pub fn by_two_constants(best: &TwoConstants, spec: &MachineSpec) -> String {
    let mut rows = table(&["Figure 7, µs", "paper", "two constants", "off"]);
    for (number, made) in NUMBERS.iter().zip(best.numbers) {
        let made = us(made, spec);
        let off = format!("{:+.1} %", 100.0 * (made / number.paper_us - 1.0));
        rows.add_row([number.name.to_owned(), number.paper_us.to_string(), format!("{made:.2}"), off]);
    }
    let text = format!(
        "Of two constants those come nearest to the {} numbers: {} for each instruction (multiplications of integers and divisions as in \
         the machine's file) and {} for each wait for a floating-point result. The worst number is {:.1} % off. The machines that \
         follow have a cost for each class and no waits.",
        NUMBERS.len(),
        plural(best.instruction.into(), "cycle"),
        plural(best.latency.into(), "cycle"),
        100.0 * best.off,
    );
    format!("{}\n{}\n", aligned(rows), wrapped(&text, WIDTH))
}

/// What a recorded run takes on the machine as it is, if that has costs of instructions, and on those that come near Figure 7.
pub fn run_times(here: Option<Cycles>, ranges: &[Range], clock: Clock) -> String {
    let seconds = |cycles: Cycles| time(clock.seconds(cycles));
    let against = |cycles: Cycles| match here {
        Some(here) => format!(" ({:+.1} %)", 100.0 * (cycles.0 as f64 / here.0.max(1) as f64 - 1.0)),
        None => String::new(),
    };
    let cell = |cycles: Option<Cycles>| cycles.map_or("-".to_owned(), |cycles| seconds(cycles) + &against(cycles));
    let mut rows = table(&["the run, on machines within", "at the least", "at the most"]);
    for range in ranges {
        let (least, most) = (range.cycles.map(|cycles| cycles.0), range.cycles.map(|cycles| cycles.1));
        rows.add_row([format!("{} %", range.percent), cell(least), cell(most)]);
    }
    let told = here.map_or(String::new(), |here| format!(" On this machine it takes {}.", seconds(here)));
    let text =
        format!("The least and the most are timed on those on which the busiest cell works least and most.{told}");
    format!("{}\n{}\n", aligned(rows), wrapped(&text, WIDTH))
}

/// From the least to the most cycles that a class can have cost in 1988.
fn plausible(class: Class, spec: &MachineSpec) -> String {
    let bound = BOUNDS.iter().find(|bound| bound.class == class);
    range(bound.map(|bound| (whole_cycles(bound.least_ns, spec), whole_cycles(bound.most_ns, spec))))
}

fn range(cycles: Option<(u32, u32)>) -> String {
    match cycles {
        None => "-".to_owned(),
        Some((least, most)) if least == most => least.to_string(),
        Some((least, most)) => format!("{least}-{most}"),
    }
}

fn sentence(all: &[Within]) -> String {
    let costs = |within: &Within| within.ranges.iter().flatten().count();
    let Some(best) = all.iter().find(|within| within.machines > 0) else {
        return "No machine of whole cycles within what is plausible comes within 10 %.\n".to_owned();
    };
    let counts: Vec<String> = all
        .iter()
        .filter(|within| within.machines > 0)
        .map(|within| format!("{} within {} %", plural(within.machines, "machine"), within.percent))
        .collect();
    let text = format!(
        "{} numbers do not determine {} costs: there are {}. A cost is determined as far as its range is narrow; the others are determined \
         only together.",
        NUMBERS.len(),
        costs(best),
        counts.join(", ")
    );
    wrapped(&text, WIDTH) + "\n"
}
