//! What a person reads after a run.

use std::ops::Range;

use comfy_table::{CellAlignment, Table};

use super::time_unit::TimeUnit;
use crate::measure::{Clock, FifoInfo, FifoStats, Measured, State, StateTimes};
use crate::quantities::Cycles;

pub use crate::input::lines::{WIDTH, grouped, plural, wrapped};

/// Sentences as people read them: a line that is longer than [`WIDTH`] goes on in another one.
pub fn prose(text: &str) -> String {
    text.split('\n').map(|line| wrapped(line, WIDTH)).collect::<Vec<_>>().join("\n")
}

/// A time in the unit that suits it: `1.234 ms`.
pub fn time(seconds: f64) -> String {
    let unit = TimeUnit::of(seconds);
    format!("{:.3} {}", seconds / unit.seconds, unit.name)
}

/// Simulated time and throughput, in one line.
pub fn speed(run: &Measured, clock: Clock) -> String {
    let seconds = clock.seconds(run.cycles);
    let rate = if seconds > 0.0 { run.jobs as f64 / seconds } else { 0.0 };
    format!(
        "simulated time {} ({} of {} ns), {} {}s/s",
        time(seconds),
        plural(run.cycles.0, "cycle"),
        clock.cycle_ns,
        grouped(rate.round() as u64),
        run.topology.names.job,
    )
}

/// A table: what its columns are called, and its rows.
#[derive(Clone, Debug)]
pub struct Rows {
    /// The columns.
    pub header: Vec<String>,
    /// As many values a row.
    pub rows: Vec<Vec<String>>,
}

/// Where every station's cycles went: a row a station. `names` tells what each runs, as far as that is known.
pub fn cell_rows(run: &Measured, names: &[String]) -> Rows {
    let states: Vec<&State> = run.topology.states.used().collect();
    let row = |(index, times): (usize, &StateTimes)| {
        let number = run.topology.station_number(index);
        let name = names.get(index).map_or_else(|| number.clone(), |name| format!("{number} {name}"));
        let shares = states.iter().map(|state| percent(times.of(state.id), run.cycles));
        std::iter::once(name).chain(shares).collect()
    };
    Rows {
        header: std::iter::once(run.topology.names.station.clone())
            .chain(states.iter().map(|state| state.name.clone()))
            .collect(),
        rows: run.stations.iter().enumerate().map(row).collect(),
    }
}

/// What every FIFO held: a row a FIFO.
pub fn fifo_rows(run: &Measured) -> Rows {
    let row = |(info, fifo): (&FifoInfo, &FifoStats)| {
        let named = [info.name.clone(), grouped(fifo.words.0)];
        let capacity = info.capacity.map(|words| words.0.to_string());
        let enough = fifo.enough.map(|words| words.0.to_string());
        let [full, empty] = [fifo.full, fifo.empty].map(|cycles| percent(cycles, run.cycles));
        let held = [format!("{:.2}", fifo.mean(run.cycles)), full, empty];
        named.into_iter().chain(capacity).chain([fifo.max.0.to_string()]).chain(enough).chain(held).collect()
    };
    let names = &run.topology.names;
    let through = format!("{}s through", names.word);
    let holds = run.topology.fifos.iter().any(|info| info.capacity.is_some()).then_some("holds");
    let enough = run.fifos.iter().any(|fifo| fifo.enough.is_some()).then_some("enough");
    let header = [names.fifo.as_str(), through.as_str()].into_iter().chain(holds).chain(["max"]).chain(enough);
    Rows {
        header: header.chain(["mean", "full", "empty"]).map(str::to_owned).collect(),
        rows: run.topology.fifos.iter().zip(&run.fifos).map(row).collect(),
    }
}

/// The cells' table as text: in percent, without the states in which no cell ever was. What does not fit beside the names stands
/// in a table of its own below.
pub fn cells(run: &Measured, names: &[String]) -> String {
    let Rows { header, rows } = cell_rows(run, names);
    let seen = |state: &State| run.stations.iter().any(|times| times.of(state.id).0 > 0);
    let shown: Vec<bool> = std::iter::once(true).chain(run.topology.states.used().map(seen)).collect();
    let shown = |row: Vec<String>, as_shown: fn(&str) -> String| {
        let cells = row.iter().zip(&shown).filter(|(_, shown)| **shown);
        cells.map(|(cell, _)| as_shown(cell)).collect::<Vec<_>>()
    };
    let mut header = shown(header, narrow);
    header[0] += ", %";
    let rows: Vec<Vec<String>> = rows.into_iter().map(|row| shown(row, |cell| cell.replace(" %", ""))).collect();
    let tables = fitting(&header, &rows).into_iter().map(|columns| {
        let of = |row: &[String]| std::iter::once(&row[0]).chain(&row[columns.clone()]).cloned().collect::<Vec<_>>();
        let mut table = table(&of(&header).iter().map(String::as_str).collect::<Vec<_>>());
        table.add_rows(rows.iter().map(|row| of(row)));
        spaced(table, &[], (1, 0))
    });
    tables.collect::<Vec<_>>().join("\n")
}

/// The columns behind the first, in stretches that fit beside it.
fn fitting(header: &[String], rows: &[Vec<String>]) -> Vec<Range<usize>> {
    let width = |column: usize| {
        let cells = std::iter::once(&header[column]).chain(rows.iter().map(|row| &row[column]));
        cells.flat_map(|cell| cell.lines()).map(|line| line.chars().count()).max().unwrap_or(0)
    };
    let (mut stretches, mut start, mut taken) = (Vec::new(), 1, width(0));
    for column in 1..header.len() {
        let more = 1 + width(column);
        if taken + more > WIDTH && column > start {
            stretches.push(start..column);
            (start, taken) = (column, width(0));
        }
        taken += more;
    }
    stretches.push(start..header.len());
    stretches
}

/// A heading in two lines, if it has two words or a long one.
fn narrow(heading: &str) -> String {
    match heading {
        "intersection" => "inter-\nsection".to_owned(),
        _ => heading.replacen(' ', "\n", 1),
    }
}

/// The FIFOs' table as text.
pub fn fifos(run: &Measured) -> String {
    text(fifo_rows(run))
}

/// A table as text.
pub fn text(rows: Rows) -> String {
    let header: Vec<&str> = rows.header.iter().map(String::as_str).collect();
    let mut table = table(&header);
    table.add_rows(rows.rows);
    aligned(table)
}

/// A table without lines, for terminals and logs alike.
pub fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(comfy_table::presets::NOTHING);
    table.set_header(header);
    table
}

/// The table as text, names to the left and figures to the right.
pub fn aligned(table: Table) -> String {
    aligned_with(table, &[])
}

/// The same, with more columns of text.
pub fn aligned_with(table: Table, texts: &[usize]) -> String {
    spaced(table, texts, (1, 1))
}

/// The same, with so many spaces to the left and to the right of a column.
fn spaced(mut table: Table, texts: &[usize], (left, right): (u16, u16)) -> String {
    for (index, column) in table.column_iter_mut().enumerate() {
        let is_text = index == 0 || texts.contains(&index);
        column.set_cell_alignment(if is_text { CellAlignment::Left } else { CellAlignment::Right });
        column.set_padding((if index == 0 { 0 } else { left }, right));
    }
    let text = table.to_string();
    text.lines().map(|line| format!("{}\n", line.trim_end())).collect()
}

/// A share in percent with one decimal.
pub fn percent(part: Cycles, whole: Cycles) -> String {
    let share = if whole.0 == 0 { 0.0 } else { 100.0 * part.0 as f64 / whole.0 as f64 };
    format!("{share:.1} %")
}
