//! One sentence on what limits the machine.

use crate::machine::{CellStats, Cycles, RunStats, Work};

/// A cell that works for more than this share of the run is what the rest waits for.
const SATURATED: f64 = 0.85;

/// Names what limits the array, and why.
pub fn sentence(stats: &RunStats) -> String {
    let cycles = stats.cycles;
    let by_work = |a: &(usize, &CellStats), b: &(usize, &CellStats)| work(a.1).cmp(&work(b.1)).then(b.0.cmp(&a.0));
    let Some((index, busiest)) = stats.cells.iter().enumerate().max_by(by_work) else {
        return "There are no cells.".to_owned();
    };
    let share = percent(work(busiest), cycles);
    let blocked = busiest.blocked_x + busiest.blocked_y;
    if work(busiest).0 as f64 > SATURATED * cycles.0 as f64 {
        format!(
            "Cell {index} limits the array: it works {share} of the time, {}{}.",
            main_work(busiest),
            effect(stats, index)
        )
    } else if let Some(host) = host_limits(stats) {
        host
    } else if blocked.0 as f64 > 0.15 * cycles.0 as f64 {
        format!(
            "No cell limits the array by itself: the busiest, cell {index}, works {share} of the time, {}, and stands \
             blocked for {}; deeper FIFOs or faster links would let it go on.",
            main_work(busiest),
            percent(blocked, cycles),
        )
    } else {
        format!(
            "No cell limits the array by itself: the busiest, cell {index}, works {share} of the time, {}; the cells \
             take turns at being waited for, as the work of a ray is uneven over them.",
            main_work(busiest),
        )
    }
}

fn work(cell: &CellStats) -> Cycles {
    cell.busy.total() + cell.moving
}

/// "96.2 % on the slabs test", or moving words, whichever takes most.
fn main_work(cell: &CellStats) -> String {
    let names = ["walking the grid", "on slabs tests", "on intersection tests", "on other work"];
    let works = Work::ALL.into_iter().zip(names).map(|(kind, name)| (cell.busy.of(kind), name));
    let (most, name) = works.chain([(cell.moving, "moving words")]).max_by_key(|entry| entry.0).unwrap_or_default();
    format!("{} of it {name}", percent(most, work(cell)))
}

/// What the limiting cell does to its neighbours.
fn effect(stats: &RunStats, index: usize) -> String {
    let blocked = stats.cells[..index].iter().map(|cell| cell.blocked_x + cell.blocked_y).max().unwrap_or_default();
    let waiting = stats.cells[index + 1..].iter().map(|cell| cell.waiting_x + cell.waiting_y).max().unwrap_or_default();
    let part = |cycles: Cycles| percent(cycles, stats.cycles);
    let significant = |cycles: Cycles| cycles.0 as f64 > 0.05 * stats.cycles.0 as f64;
    match (significant(blocked), significant(waiting)) {
        (true, true) => format!(
            "; to its left a cell stands blocked for {}, to its right one waits for {}",
            part(blocked),
            part(waiting)
        ),
        (true, false) => format!("; to its left a cell stands blocked for {}", part(blocked)),
        (false, true) => format!("; to its right a cell waits for {}", part(waiting)),
        (false, false) => String::new(),
    }
}

/// The first cell waits for rays: the host, or its link, is too slow.
fn host_limits(stats: &RunStats) -> Option<String> {
    let waiting = stats.cells.first()?.waiting_x;
    (waiting.0 as f64 > 0.5 * stats.cycles.0 as f64).then(|| {
        format!("The host limits the array: cell 0 waits for rays {} of the time.", percent(waiting, stats.cycles))
    })
}

/// A share in percent with one decimal.
pub fn percent(part: Cycles, whole: Cycles) -> String {
    let share = if whole.0 == 0 { 0.0 } else { 100.0 * part.0 as f64 / whole.0 as f64 };
    format!("{share:.1} %")
}
