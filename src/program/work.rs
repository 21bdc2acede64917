//! The units of work of the paper's programs, and what they cost (Figure 7).

use std::sync::Arc;

use super::messages;
use crate::isa::kernels::{FIRST_UNIT, KERNELS};
use crate::isa::{Class, InstructionCycles, kernels};
use crate::machine::KernelTimes;
use crate::quantities::Cycles;
use crate::seam::{Activity, Costs, Unit, UnitOfWork, Vocabulary};

/// The walk through the grid.
pub const GRID: Activity = Activity(0);
/// The slabs test.
pub const SLABS: Activity = Activity(1);
/// The intersection test.
pub const INTERSECTION: Activity = Activity(2);
/// Anything else.
pub const OTHER: Activity = kernels::OTHER;

/// The grid's start, once a ray: the test against the volume and the first voxel.
pub const GRID_START: Unit = Unit(0);
/// A voxel of the grid's walk.
pub const GRID_VOXEL: Unit = Unit(1);
/// The slabs' start: a ray's S_i and T_i.
pub const SLABS_START: Unit = Unit(2);
/// A polygon's slabs test.
pub const SLABS_POLYGON: Unit = Unit(3);
/// The intersection's start.
pub const INTERSECTION_START: Unit = Unit(4);
/// A polygon's intersection test.
pub const INTERSECTION_POLYGON: Unit = Unit(5);
/// What the host does for a ray before it sends it.
pub const HOST_RAY: Unit = Unit(6);
/// What the host does to shade a hit.
pub const HOST_HIT: Unit = Unit(7);

/// What the host does to tell whether a sample of the picture can hit anything.
pub const HOST_FILTER: Unit = Unit(8);
/// What the host does to tell whether a ray meets a sub-volume.
pub const HOST_MASK: Unit = Unit(9);

/// What a cell, or the host, does to send a message or to take one. Cells that run programs have an instruction by that number, and no
/// such messages.
pub const MESSAGE: Unit = Unit(FIRST_UNIT);

/// The units of cells that take Figure 7's times and of the host: code, name, activity.
const TIMED: [(&str, &str, Activity); FIRST_UNIT as usize] = [
    ("gs", "grid_start", GRID),
    ("gv", "grid_voxel", GRID),
    ("ss", "slabs_start", SLABS),
    ("sp", "slabs_polygon", SLABS),
    ("ns", "intersection_start", INTERSECTION),
    ("np", "intersection_polygon", INTERSECTION),
    ("hr", "host_ray", OTHER),
    ("hh", "host_hit", OTHER),
    ("hf", "host_filter", OTHER),
    ("hm", "host_mask", OTHER),
];

/// A wait of a program's grid for a floating-point result, where these have a latency. Behind it come those of the other kernels.
pub const FLOAT_WAIT: Unit = kernels::float_wait(GRID);

/// The activities' letters in activity traces.
const LETTERS: [char; KERNELS.len()] = ['g', 's', 'n', 'c'];

/// What an instruction's class adds to the letter of what it works for, in the order of [`Class::ALL`].
const CLASS_CODES: [&str; Class::ALL.len()] =
    ["int", "mul", "div", "load", "stor", "fadd", "fmul", "fdiv", "fcmp", "bra"];

/// What a wait for a floating-point result adds to the letter of what it is for.
const WAIT_CODE: &str = "lat";

/// The units of work of an array: those of Figure 7, and instructions too if the cells run programs. Its host sends each ray to all
/// cells.
pub fn vocabulary(runs_programs: bool) -> Arc<Vocabulary> {
    vocabulary_with(runs_programs, &[])
}

/// The same of a host that does more than send and shade: [`HOST_FILTER`], [`HOST_MASK`]; of messages that take time: [`MESSAGE`];
/// and of programs whose floating-point results do: [`FLOAT_WAIT`].
pub fn vocabulary_with(runs_programs: bool, more: &[Unit]) -> Arc<Vocabulary> {
    let timed = TIMED.iter().map(|&(code, name, activity)| (code.to_owned(), name, activity));
    let instructions = LETTERS.iter().zip(0..).flat_map(|(letter, activity)| {
        let code = move |code: &str| format!("{letter}{code}");
        Class::ALL.iter().zip(CLASS_CODES).map(move |(class, add)| (code(add), class.name(), Activity(activity)))
    });
    let message = more.contains(&MESSAGE).then(|| ("ms".to_owned(), "message", OTHER));
    let waits = LETTERS.iter().zip(0..).map(|(letter, activity)| {
        let code = format!("{letter}{WAIT_CODE}");
        (code, kernels::FLOAT_LATENCY, Activity(activity))
    });
    let has_waits = runs_programs && more.contains(&FLOAT_WAIT);
    let units = timed.chain(instructions.filter(|_| runs_programs)).chain(waits.filter(|_| has_waits)).chain(message);
    let used =
        |place: usize| ![HOST_FILTER, HOST_MASK].contains(&Unit(place as u8)) || more.contains(&Unit(place as u8));
    let unit = |(place, (code, name, activity)): (usize, (String, &str, Activity))| UnitOfWork {
        code,
        name: name.to_owned(),
        activity,
        used: used(place),
    };
    Arc::new(Vocabulary {
        activities: LETTERS.into_iter().zip(KERNELS.map(str::to_owned)).collect(),
        units: units.enumerate().map(unit).collect(),
        answer_words: messages::HIT_WORDS,
    })
}

/// The vocabulary of activity traces that count in cycles.
pub fn cycles_vocabulary() -> Arc<Vocabulary> {
    let activities: Vec<(char, &str)> = LETTERS.into_iter().zip(KERNELS).collect();
    Arc::new(Vocabulary::of_cycles(&activities, messages::HIT_WORDS))
}

/// What a unit costs, by its name; `None` for a name that is none of a unit's, or of an instruction or a wait whose cost is not
/// told.
pub fn price(name: &str, times: &KernelTimes, instructions: Option<&InstructionCycles>) -> Option<Cycles> {
    match name {
        "grid_start" => Some(times.grid.start),
        "grid_voxel" => Some(times.grid.each),
        "slabs_start" => Some(times.slabs.start),
        "slabs_polygon" => Some(times.slabs.each),
        "intersection_start" => Some(times.intersection.start),
        "intersection_polygon" => Some(times.intersection.each),
        "host_ray" => Some(times.host.ray),
        "host_hit" => Some(times.host.hit),
        "host_filter" => Some(times.host.filter),
        "host_mask" => Some(times.host.mask),
        "message" => Some(times.message.unwrap_or_default()),
        _ => Some(Cycles(instructions?.of_unit(name)?.into())),
    }
}

/// A vocabulary with the prices of a machine. A unit that the machine has no price for costs nothing.
pub fn costs(vocabulary: &Arc<Vocabulary>, times: &KernelTimes, instructions: Option<&InstructionCycles>) -> Costs {
    let price = |unit| vocabulary.unit(unit).and_then(|unit| price(&unit.name, times, instructions));
    Costs::new(Arc::clone(vocabulary), |unit| price(unit).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_the_numbers_by_which_they_are_called() {
        let vocabulary = vocabulary_with(true, &[FLOAT_WAIT]);
        for (unit, (_, name, activity)) in TIMED.iter().enumerate() {
            assert_eq!((vocabulary.units[unit].name.as_str(), vocabulary.units[unit].activity), (*name, *activity));
        }
        for activity in [GRID, SLABS, INTERSECTION, OTHER] {
            for class in Class::ALL {
                let unit = vocabulary.unit(kernels::unit(activity, class)).unwrap();
                assert_eq!((unit.name.as_str(), unit.activity), (class.name(), activity));
            }
            let wait = vocabulary.unit(kernels::float_wait(activity)).unwrap();
            assert_eq!((wait.name.as_str(), wait.activity), (kernels::FLOAT_LATENCY, activity));
        }
        assert!(vocabulary.units.len() <= Vocabulary::MOST_UNITS);
        let codes: std::collections::BTreeSet<&str> = vocabulary.units.iter().map(|unit| unit.code.as_str()).collect();
        assert_eq!(codes.len(), vocabulary.units.len(), "each has a code of its own");
    }
}
