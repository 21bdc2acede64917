//! One sentence on what limits the machine.

use crate::machine::{CellStats, Cycles, MachineSpec, RateCounts, RunStats, Work};

/// What works for more than this share of the run is what the rest waits for.
const SATURATED: f64 = 0.85;

/// A share of the run that is worth a word.
const NOTABLE: f64 = 0.10;

/// Names what limits the array, and why.
pub fn sentence(stats: &RunStats, spec: &MachineSpec) -> String {
    let by_work = |a: &(usize, &CellStats), b: &(usize, &CellStats)| work(a.1).cmp(&work(b.1)).then(b.0.cmp(&a.0));
    let Some((index, busiest)) = stats.cells.iter().enumerate().max_by(by_work) else {
        return "There are no cells.".to_owned();
    };
    let works = format!("works {} of the time, {}", percent(work(busiest), stats.cycles), main_work(busiest));
    if share(work(busiest), stats) > SATURATED {
        return format!("Cell {index} limits the array: it {works}{}.", effect(stats, index));
    }
    if let Some(sentence) = link_limits(stats, spec).or_else(|| host_limits(stats)) {
        return sentence;
    }
    let blocked = stats.cells.iter().map(|cell| cell.blocked_x + cell.blocked_y).max().unwrap_or_default();
    let why = if share(blocked, stats) > NOTABLE {
        let blocked = percent(blocked, stats.cycles);
        format!("but full FIFOs block a cell for {blocked}: deeper ones, or work cut more evenly, would let it go on")
    } else {
        "and the cells take turns at being waited for, as the work of a ray is uneven over them".to_owned()
    };
    format!("No cell limits the array by itself: the busiest, cell {index}, {works}, {why}.")
}

fn share(part: Cycles, stats: &RunStats) -> f64 {
    if stats.cycles.0 == 0 { 0.0 } else { part.0 as f64 / stats.cycles.0 as f64 }
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
    // On Z, which leads to the left, it is the left one that lacks words.
    let blocked = |cell: &CellStats| cell.blocked_x + cell.blocked_y + cell.waiting_z;
    let blocked = stats.cells[..index].iter().map(blocked).max().unwrap_or_default();
    let waiting = |cell: &CellStats| cell.waiting_x + cell.waiting_y + cell.blocked_z;
    let waiting = stats.cells[index + 1..].iter().map(waiting).max().unwrap_or_default();
    let part = |cycles: Cycles| percent(cycles, stats.cycles);
    let significant = |cycles: Cycles| share(cycles, stats) > NOTABLE;
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

/// A link that carries words for nearly all of the run.
fn link_limits(stats: &RunStats, spec: &MachineSpec) -> Option<String> {
    let rate = spec.link_rate();
    let words = |name: String| stats.fifos.iter().find(|fifo| fifo.name == name).map_or(0, |fifo| fifo.words.0);
    let links = (0..=stats.cells.len()).map(|index| {
        let reader = if index == stats.cells.len() { "host".to_owned() } else { index.to_string() };
        let (x, y) = (words(format!("X{reader}")), words(format!("Y{reader}")));
        let counted = match rate.counts {
            RateCounts::Link => x + y,
            RateCounts::Channel => x.max(y),
        };
        (Cycles(counted.saturating_mul(rate.cycles_per_word)), std::cmp::Reverse(index))
    });
    let (busy, std::cmp::Reverse(index)) = links.max()?;
    let leads_to =
        if index == stats.cells.len() { "back to the host".to_owned() } else { format!("into cell {index}") };
    (share(busy, stats) > SATURATED).then(|| {
        format!(
            "The link {leads_to} limits the array: it carries words for {} of the time.",
            percent(busy, stats.cycles)
        )
    })
}

/// The first cell waits for rays: the host, or its link, is too slow.
fn host_limits(stats: &RunStats) -> Option<String> {
    let waiting = stats.cells.first()?.waiting_x;
    (share(waiting, stats) > 0.5).then(|| {
        format!("The host limits the array: cell 0 waits for rays {} of the time.", percent(waiting, stats.cycles))
    })
}

/// A share in percent with one decimal.
pub fn percent(part: Cycles, whole: Cycles) -> String {
    let share = if whole.0 == 0 { 0.0 } else { 100.0 * part.0 as f64 / whole.0 as f64 };
    format!("{share:.1} %")
}
