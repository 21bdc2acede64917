//! What sizing the FIFOs has found: for people, as a table, as pictures.

use super::account::machine_line;
use super::plot::curves::{self, Axes, Look};
use super::plot::{Picture, PlotError};
use super::summary::{aligned, grouped, prose, table};
use super::table::{Column, Kind, Table};
use crate::machine::{Machine, MachineFile, MachineSpec};
use crate::measure::Clock;
use crate::quantities::{Cycles, Words};
use crate::run::{Fewer, Front, Point};

/// Depths, and what comes of them: a row of the table.
struct Row<'a> {
    /// What they are: `unlimited`, `fewest`, `one fewer`, `least`.
    what: &'static str,
    /// The point of the front that they belong to.
    point: Option<&'a Point>,
    /// The FIFO with a word fewer.
    fewer: Option<usize>,
    words: Vec<Words>,
    end: Fewer,
}

/// The names of the pictures.
pub const PICTURES: [&str; 2] = ["front", "depths"];

/// The columns before those of the FIFOs, which hold words.
const COLUMNS: [Column<'static>; 7] = [
    column("depths", Kind::Text, "what the depths are"),
    column("speed_wanted", Kind::Number, "speed asked for (share of that with unlimited FIFOs)"),
    column("one_fewer", Kind::Text, "FIFO with a word fewer"),
    column("words", Kind::Whole, "words of all FIFOs together"),
    column("cycles", Kind::Whole, "simulated time (cycles)"),
    column("seconds", Kind::Number, "simulated time (s)"),
    column("speed", Kind::Number, "speed (share of that with unlimited FIFOs)"),
];

const fn column(name: &'static str, kind: Kind, label: &'static str) -> Column<'static> {
    Column { name, kind, label }
}

/// The table of a front: a row for the unlimited depths, one for each of its points, one for each FIFO of a point with a word fewer, and
/// one for the least machine.
#[derive(Debug)]
pub struct SizesTable {
    /// Each FIFO's name, and what its column holds.
    fifos: Vec<[String; 2]>,
    rows: Vec<Vec<String>>,
}

impl SizesTable {
    /// The table of a front.
    pub fn new(front: &Front, clock: Clock) -> SizesTable {
        let fifo = |name: String| [name.clone(), format!("depth of {name} (words)")];
        SizesTable {
            fifos: front.fifos.iter().map(|name| fifo(name.to_string())).collect(),
            rows: rows(front).iter().map(|row| row.cells(front, clock)).collect(),
        }
    }

    /// Its columns.
    pub fn columns(&self) -> Vec<Column<'_>> {
        let fifos = self.fifos.iter().map(|[name, label]| Column { name, kind: Kind::Whole, label });
        COLUMNS.into_iter().chain(fifos).chain([column("error", Kind::Text, "why the run never ends")]).collect()
    }

    /// All rows.
    pub fn rows(&self) -> Vec<&[String]> {
        self.rows.iter().map(Vec::as_slice).collect()
    }

    /// Pictures of it: the speed over the words of all FIFOs, and the depth of each FIFO for each speed.
    pub fn pictures(&self, title: &str) -> Result<[Picture; 2], PlotError> {
        let columns = self.columns();
        let of_front = self.rows.iter().filter(|row| row[0] != ONE_FEWER).map(Vec::as_slice);
        let front = Table { columns: &columns, rows: of_front.collect() };
        let depths: Vec<Vec<String>> =
            self.rows.iter().filter(|row| row[0] == FEWEST).flat_map(|row| self.depths(row)).collect();
        let of_depths = [
            column("fifo", Kind::Text, "FIFO"),
            column("words", Kind::Whole, "depth (words)"),
            column("speed_wanted", Kind::Text, "speed"),
        ];
        let depths = Table { columns: &of_depths, rows: depths.iter().map(Vec::as_slice).collect() };
        let [of_speed, of_fifos] = PICTURES;
        let draw = |name: &str, table: &Table<'_>, axes: [&str; 2], by: Option<&str>| {
            let axes =
                Axes::new(table.columns, axes[0], axes[1], by).map_err(|error| PlotError::new(error.to_string()))?;
            Ok(Picture { name: name.to_owned(), rendered: curves::render(table, &axes, &Look::default(), title)? })
        };
        Ok([
            draw(of_speed, &front, ["words", "speed"], None)?,
            draw(of_fifos, &depths, ["fifo", "words"], Some("speed_wanted"))?,
        ])
    }

    /// A point of the front as rows of FIFO, depth, speed.
    fn depths(&self, row: &[String]) -> Vec<Vec<String>> {
        let speed: f64 = row[1].parse().unwrap_or_default();
        let depths = self.fifos.iter().zip(&row[COLUMNS.len()..]);
        depths.map(|([name, _], words)| vec![name.clone(), words.clone(), share(speed)]).collect()
    }
}

const UNLIMITED: &str = "unlimited";
const FEWEST: &str = "fewest";
const ONE_FEWER: &str = "one fewer";
const LEAST: &str = "least";

fn rows(front: &Front) -> Vec<Row<'_>> {
    let row = |what, point, words: &[Words], cycles| Row {
        what,
        point,
        fewer: None,
        words: words.to_vec(),
        end: Fewer::Cycles(cycles),
    };
    let mut rows = vec![row(UNLIMITED, None, &front.unlimited.words, front.unlimited.cycles)];
    rows.extend(front.points.iter().map(|point| row(FEWEST, Some(point), &point.depths.words, point.depths.cycles)));
    for point in &front.points {
        let fewer = point.fewer.iter().enumerate().filter_map(|(index, end)| Some((index, end.as_ref()?)));
        rows.extend(fewer.map(|(index, end)| {
            let mut words = point.depths.words.clone();
            words[index] = words[index] - Words(1);
            Row { what: ONE_FEWER, point: Some(point), fewer: Some(index), words, end: end.clone() }
        }));
    }
    rows.push(Row { what: LEAST, point: None, fewer: None, words: front.least.0.clone(), end: front.least.1.clone() });
    rows
}

impl Row<'_> {
    fn cells(&self, front: &Front, clock: Clock) -> Vec<String> {
        let (cycles, error) = match &self.end {
            Fewer::Cycles(cycles) => (Some(*cycles), String::new()),
            Fewer::Stuck(stuck) => (None, standstill(stuck)),
        };
        let of_cycles = |cell: &dyn Fn(Cycles) -> String| cycles.map(cell).unwrap_or_default();
        let fixed = [
            self.what.to_owned(),
            self.point.map(|point| speed_wanted(point).to_string()).unwrap_or_default(),
            self.fewer.map(|index| front.fifos[index].to_string()).unwrap_or_default(),
            self.words.iter().map(|words| words.0).sum::<u64>().to_string(),
            of_cycles(&|cycles| cycles.0.to_string()),
            of_cycles(&|cycles| clock.seconds(cycles).to_string()),
            of_cycles(&|cycles| speed(front, cycles).to_string()),
        ];
        fixed.into_iter().chain(self.words.iter().map(|words| words.0.to_string())).chain([error]).collect()
    }
}

/// Who waits for whom, in a line.
fn standstill(stuck: &crate::machine::Stuck) -> String {
    let waits: Vec<String> = stuck.waits.iter().map(|wait| wait.to_string()).collect();
    format!("{}: {}", stuck.kind, waits.join("; "))
}

fn speed_wanted(point: &Point) -> f64 {
    (1000 - point.slower) as f64 / 1000.0
}

/// The speed of a run of so many cycles, as a share of that with unlimited FIFOs.
fn speed(front: &Front, cycles: Cycles) -> f64 {
    if cycles.0 == 0 { 1.0 } else { front.unlimited.cycles.0 as f64 / cycles.0 as f64 }
}

/// `99.9 %`: how a point of the front is called.
fn share(speed: f64) -> String {
    format!("{} %", (1000.0 * speed).round() / 10.0)
}

/// How a point of the front is called, as part of a file's name: `99.9`. `slower` is by how many thousandths it may be slower.
pub fn name(slower: u64) -> String {
    share(1.0 - slower as f64 / 1000.0).trim_end_matches(" %").to_owned()
}

/// Machines that stand side by side, as far as there is room for them.
const SIDE_BY_SIDE: usize = 4;

/// What is sized, above all that is told of it.
pub fn heading(title: &str) -> String {
    format!("FIFOs of {title}")
}

/// All that people read of a front.
pub fn text(front: &Front, title: &str, machine: &Machine) -> String {
    let (heading, machine) = (heading(title), machine_line(&machine.spec));
    let head = prose(&format!("{heading}\n{machine}"));
    format!("{head}\n\n{}\n{}", to_text(front), sentences(front))
}

/// The machine file of a point of the front.
pub fn machine_text(front: &Front, point: &Point, title: &str, file: &MachineFile) -> Result<String, ron::Error> {
    let text = front.machine(&point.depths.words, file).to_ron()?;
    Ok(format!(
        "// The fewest words for {} % of the speed with unlimited FIFOs, found by `pcs-sim size-fifos` for\n\
         // {title}: {} words, {} cycles.\n{text}",
        name(point.slower),
        grouped(point.depths.total()),
        grouped(point.depths.cycles.0),
    ))
}

/// The front for people: a column for each of its machines, a row for each FIFO.
pub fn to_text(front: &Front) -> String {
    let rows = rows(front);
    let rows: Vec<&Row<'_>> = rows.iter().filter(|row| row.what != ONE_FEWER).collect();
    rows.chunks(SIDE_BY_SIDE).map(|some| block(front, some)).collect::<Vec<_>>().join("\n")
}

/// Some of the machines.
fn block(front: &Front, rows: &[&Row<'_>]) -> String {
    let header = rows.iter().map(|row| row.point.map_or(row.what.to_owned(), |point| share(speed_wanted(point))));
    let header: Vec<String> = ["speed".to_owned()].into_iter().chain(header).collect();
    let mut text = table(&header.iter().map(String::as_str).collect::<Vec<_>>());
    let mut line = |name: &str, cell: &dyn Fn(&Row<'_>) -> String| {
        text.add_row([name.to_owned()].into_iter().chain(rows.iter().map(|row| cell(row))).collect::<Vec<_>>());
    };
    let of_cycles = |row: &Row<'_>, cell: &dyn Fn(Cycles) -> String| match &row.end {
        Fewer::Cycles(cycles) => cell(*cycles),
        Fewer::Stuck(_) => "never ends".to_owned(),
    };
    line("cycles", &|row| of_cycles(row, &|cycles| grouped(cycles.0)));
    line("in fact", &|row| of_cycles(row, &|cycles| format!("{:.3} %", 100.0 * speed(front, cycles))));
    line("words", &|row| grouped(row.words.iter().map(|words| words.0).sum()));
    for (index, fifo) in front.fifos.iter().enumerate() {
        line(&fifo.to_string(), &|row| grouped(row.words[index].0));
    }
    aligned(text)
}

/// What holds of the front, in sentences.
pub fn sentences(front: &Front) -> String {
    let mut text = format!(
        "Found by {} exact replays. Each machine is least FIFO by FIFO: with one word fewer in any of them it is slower than that. \
         Several depths changed at once may still do with fewer words in all.\n",
        grouped(front.replays)
    );
    let deepest =
        front.fifos.iter().zip(&front.unlimited.words).filter(|(_, words)| words.0 >= MachineSpec::MAX_FIFO_WORDS);
    let deepest: Vec<String> = deepest.map(|(fifo, _)| fifo.to_string()).collect();
    if !deepest.is_empty() {
        text += &format!("{} would hold more than the deepest FIFO that can be simulated.\n", deepest.join(", "));
    }
    for (index, fifo) in front.fifos.iter().enumerate() {
        let stuck = |point: &Point| match &point.fewer[index] {
            Some(Fewer::Stuck(stuck)) => Some((share(speed_wanted(point)), standstill(stuck))),
            _ => None,
        };
        let stuck: Vec<(String, String)> = front.points.iter().filter_map(stuck).collect();
        if let Some((_, first)) = stuck.first() {
            let speeds: Vec<&str> = stuck.iter().map(|(speed, _)| speed.as_str()).collect();
            text += &format!("With one word fewer in {fifo} the run never ends ({}): {first}.\n", speeds.join(", "));
        }
    }
    if let Fewer::Stuck(stuck) = &front.least.1 {
        text += &format!("With the least depths it never ends: {}.\n", standstill(stuck));
    }
    prose(&text)
}
