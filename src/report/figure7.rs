//! How well Figure 7 tells what instructions cost.

use crate::isa::Class;
use crate::machine::MachineSpec;
use crate::program::figure7::NUMBERS;
use crate::program::figure7::calibrate::{BOUNDS, whole_cycles};
use crate::program::figure7::fits::Within;
use crate::report::summary::{WIDTH, aligned, grouped, plural, table, wrapped};

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
