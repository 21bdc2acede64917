//! The judge of a farm's critical path: from what is done last back to time 0, deed by deed, through all that the ticking model
//! did.

use std::collections::BTreeMap;

use super::farm_ticking::{Deed, History};

/// A path in words: which task and what, how long and how often.
pub type Parts = BTreeMap<(usize, String), (u64, u64)>;

/// Where the walk is: a task that has done so much, or a passage that has arrived.
enum At {
    Task(usize, usize),
    Arrival(usize),
}

/// The critical path by the rule of docs/farm.md, of a run that took so long.
pub fn look_back(history: &History, time: u64) -> Parts {
    let mut parts = Parts::new();
    let mut add = |task: usize, what: &str, time: u64| {
        let part = parts.entry((task, what.to_owned())).or_default();
        *part = (part.0 + time, part.1 + 1);
    };
    let ends_last = |deeds: &Vec<(Deed, u64)>| deeds.last().map_or(0, |deed| deed.1) == time;
    let last = history.deeds.iter().position(ends_last).expect("somebody does something last");
    let mut at = At::Task(last, history.deeds[last].len());
    loop {
        at = match at {
            At::Task(_, 0) => return parts,
            At::Task(task, done) => {
                let (deed, until) = history.deeds[task][done - 1];
                match deed {
                    Deed::Worked(what, time) => {
                        add(task, what, time);
                        At::Task(task, done - 1)
                    }
                    Deed::Took { passage, since } if since < until => At::Arrival(passage),
                    Deed::Took { .. } => At::Task(task, done - 1),
                    Deed::WasTaken { passage } if history.passages[passage].arrives == until => At::Arrival(passage),
                    Deed::WasTaken { passage } => {
                        let (taker, number) = history.passages[passage].taken.expect("it was");
                        At::Task(taker, number + 1)
                    }
                }
            }
            At::Arrival(number) => {
                let passage = history.passages[number];
                add(passage.from, "bus_message", passage.arrives - passage.starts);
                if passage.starts > passage.ready {
                    let before = history.passages[..number].iter().rposition(|other| other.bus == passage.bus);
                    At::Arrival(before.expect("the bus was not free"))
                } else {
                    At::Task(passage.from, passage.after)
                }
            }
        };
    }
}
