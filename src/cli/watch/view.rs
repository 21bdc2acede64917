//! What `--watch` shows of an array, as lines of text.

use console::{Style, truncate_str};
use pcs_sim::machine::{CellState, CellStats, Channel, Cycles, FifoStats, MachineSpec, SoFar, Work};
use pcs_sim::report::summary::{grouped, time};

/// An array between two looks at it.
pub struct View<'a> {
    pub spec: &'a MachineSpec,
    /// What each cell runs, as far as that is known.
    pub cell_names: &'a [String],
    pub before: &'a SoFar,
    pub now: &'a SoFar,
}

/// What one FIFO did between two looks.
struct Level<'a> {
    stats: &'a FifoStats,
    /// Words on average.
    mean: f64,
    /// Share of the time.
    full: f64,
}

/// Room for what stands to the left and to the right of a bar.
const BESIDE_BARS: usize = 56;
const LONGEST_BAR: usize = 60;
const NAME: usize = 20;

/// How much of something, from nothing to all.
const STEPS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

impl View<'_> {
    /// The lines, as many as fit: a row for each cell and FIFO, or a column for each where there are too many.
    pub fn lines(&self, width: usize, height: usize) -> Vec<String> {
        let rows = self.now.cells.len() + self.now.fifos.len() + 4;
        let lines = if rows <= height { self.rows(width) } else { self.columns(width) };
        lines.iter().take(height).map(|line| truncate_str(line, width.saturating_sub(1), "…").into_owned()).collect()
    }

    fn heading(&self) -> String {
        let seconds = |cycles: Cycles| self.spec.seconds(cycles);
        let passed = Cycles(self.now.cycles.0.saturating_sub(self.before.cycles.0));
        let rays = self.now.returned.saturating_sub(self.before.returned);
        let rate = |rays: u64, seconds: f64| {
            if seconds > 0.0 { grouped((rays as f64 / seconds).round() as u64) } else { "0".to_owned() }
        };
        format!(
            "simulated {} at {} rays/s; below, its last {} at {} rays/s",
            time(seconds(self.now.cycles)),
            rate(self.now.returned, seconds(self.now.cycles)),
            time(seconds(passed)),
            rate(rays, seconds(passed)),
        )
    }

    fn rows(&self, width: usize) -> Vec<String> {
        let length = width.saturating_sub(BESIDE_BARS).clamp(10, LONGEST_BAR);
        let mut lines = vec![self.heading(), legend()];
        for (index, cell) in self.cells().iter().enumerate() {
            let name = self.cell_names.get(index).map_or(String::new(), |name| format!(" {name}"));
            let works = 100.0 * share(works(cell), total(cell));
            lines.push(format!("{:NAME$} {} works {works:5.1} %", format!("cell {index}{name}"), bar_of(cell, length)));
        }
        lines.push(String::new());
        for Level { stats, mean, full } in self.levels() {
            let filled = (mean / stats.capacity.0 as f64 * length as f64).round() as usize;
            let bar = Style::new().for_stderr().blue().apply_to("#".repeat(filled.min(length)));
            let rest = "-".repeat(length - filled.min(length));
            let figures = format!("{mean:7.1} of {}, full {:5.1} %", stats.capacity.0, 100.0 * full);
            lines.push(format!("{:NAME$} {bar}{rest} {figures}", format!("FIFO {}", stats.name)));
        }
        lines
    }

    fn columns(&self, width: usize) -> Vec<String> {
        let cells = self.cells();
        let each = cells.len().div_ceil(width.saturating_sub(NAME + 17).max(8));
        let what = if each == 1 { "a column a cell".to_owned() } else { format!("a column for each {each} cells") };
        let share_of = |some: fn(&CellStats) -> u64| cells.iter().map(|cell| share(some(cell), total(cell))).collect();
        let levels = |channel: char| {
            let all = self.levels().filter(|level| level.stats.name.starts_with(channel));
            all.map(|level| level.mean / level.stats.capacity.0 as f64).collect()
        };
        vec![
            self.heading(),
            format!("{} cells, {what}; least, mean and most to the right", cells.len()),
            sparks("works", share_of(works), each, Style::new().green()),
            sparks("waits", share_of(waits), each, Style::new().yellow()),
            sparks("blocked", share_of(blocked), each, Style::new().red()),
            sparks("X FIFOs' level", levels('X'), each, Style::new().blue()),
            sparks("Y FIFOs' level", levels('Y'), each, Style::new().blue()),
        ]
    }

    /// What each cell did between the two looks.
    fn cells(&self) -> Vec<CellStats> {
        let nothing = CellStats::default();
        let before = |index: usize| self.before.cells.get(index).unwrap_or(&nothing);
        let cells = self.now.cells.iter().enumerate();
        cells.map(|(index, cell)| difference(cell, before(index))).collect()
    }

    fn levels(&self) -> impl Iterator<Item = Level<'_>> {
        self.now.fifos.iter().enumerate().map(|(index, (stats, until))| {
            let (word_cycles, full, since) = self
                .before
                .fifos
                .get(index)
                .map_or((0, 0, 0), |(before, since)| (before.word_cycles, before.full.0, since.0));
            let passed = until.0.saturating_sub(since);
            let word_cycles = stats.word_cycles.saturating_sub(word_cycles);
            Level {
                stats,
                // Both ends of the time are where this FIFO has come to, which is not quite where the words are counted.
                mean: (word_cycles as f64 / passed.max(1) as f64).min(stats.capacity.0 as f64),
                full: share(stats.full.0.saturating_sub(full), passed),
            }
        })
    }
}

fn difference(now: &CellStats, before: &CellStats) -> CellStats {
    let less = |state: CellState| Cycles(now.of(state).0.saturating_sub(before.of(state).0));
    CellStats {
        busy: pcs_sim::machine::Busy(Work::ALL.map(|work| less(CellState::Busy(work)))),
        moving: less(CellState::Moving),
        waiting_x: less(CellState::Waiting(Channel::X)),
        waiting_y: less(CellState::Waiting(Channel::Y)),
        waiting_z: less(CellState::Waiting(Channel::Z)),
        blocked_x: less(CellState::Blocked(Channel::X)),
        blocked_y: less(CellState::Blocked(Channel::Y)),
        blocked_z: less(CellState::Blocked(Channel::Z)),
        idle: Cycles(0),
    }
}

fn total(cell: &CellStats) -> u64 {
    cell.active().0
}

fn works(cell: &CellStats) -> u64 {
    (cell.busy.total() + cell.moving).0
}

fn waits(cell: &CellStats) -> u64 {
    (cell.waiting_x + cell.waiting_y).0
}

fn blocked(cell: &CellStats) -> u64 {
    (cell.blocked_x + cell.blocked_y).0
}

fn share(part: u64, whole: u64) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}

/// A state's letter, as activity traces have them, and its colour.
fn mark(state: CellState) -> (char, Style) {
    let style = Style::new().for_stderr();
    match state {
        CellState::Busy(Work::Grid) => ('g', style.blue()),
        CellState::Busy(Work::Slabs) => ('s', style.green()),
        CellState::Busy(Work::Intersection) => ('n', style.cyan()),
        CellState::Busy(Work::Other) => ('c', style.magenta()),
        CellState::Moving => ('m', style.bold()),
        CellState::Waiting(_) => ('.', style.yellow()),
        CellState::Blocked(_) => ('!', style.red()),
        CellState::Idle => (' ', style),
    }
}

fn legend() -> String {
    let states = [
        CellState::Busy(Work::Grid),
        CellState::Busy(Work::Slabs),
        CellState::Busy(Work::Intersection),
        CellState::Busy(Work::Other),
        CellState::Moving,
        CellState::Waiting(Channel::X),
        CellState::Blocked(Channel::X),
    ];
    let names = states.map(|state| {
        let (letter, style) = mark(state);
        let name = state.name();
        format!("{} {}", style.apply_to(letter), name.split(' ').next().unwrap_or(name))
    });
    names.join("  ")
}

/// A cell's states, each as long as its share of the time.
fn bar_of(cell: &CellStats, length: usize) -> String {
    let (whole, mut passed, mut drawn) = (total(cell), 0, 0);
    let mut bar = String::new();
    for state in CellState::ALL {
        passed += cell.of(state).0;
        let end = (share(passed, whole) * length as f64).round() as usize;
        let (letter, style) = mark(state);
        if end > drawn {
            bar += &style.apply_to(letter.to_string().repeat(end - drawn)).to_string();
            drawn = end;
        }
    }
    bar + &" ".repeat(length - drawn.min(length))
}

/// A row of shares as characters of different height, each for the mean of `each` of them.
fn sparks(name: &str, shares: Vec<f64>, each: usize, style: Style) -> String {
    let mean = |shares: &[f64]| shares.iter().sum::<f64>() / shares.len().max(1) as f64;
    let step = |share: f64| STEPS[(share.clamp(0.0, 1.0) * 8.0).round() as usize];
    let row: String = shares.chunks(each.max(1)).map(|shares| step(mean(shares))).collect();
    let least = shares.iter().copied().fold(1.0, f64::min);
    let most = shares.iter().copied().fold(0.0, f64::max);
    let figures = [least, mean(&shares), most].map(|share| format!("{:3.0}", 100.0 * share)).join(" ");
    format!("{name:NAME$} {} {figures} %", style.for_stderr().apply_to(row))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcs_sim::machine::{Busy, Words};

    fn cell(grid: u64, moving: u64, waiting_y: u64, blocked_x: u64) -> CellStats {
        CellStats {
            busy: Busy([Cycles(grid), Cycles(0), Cycles(0), Cycles(0)]),
            moving: Cycles(moving),
            waiting_y: Cycles(waiting_y),
            blocked_x: Cycles(blocked_x),
            ..CellStats::default()
        }
    }

    fn fifo(name: &str, word_cycles: u64, full: u64, until: u64) -> (FifoStats, Cycles) {
        let (capacity, full) = (Words(512), Cycles(full));
        let (words, max, empty) = (Words(0), Words(0), Cycles(0));
        (FifoStats { name: name.to_owned(), capacity, words, max, word_cycles, full, empty }, Cycles(until))
    }

    fn lines(before: &SoFar, now: &SoFar, width: usize, height: usize) -> String {
        let spec = MachineSpec::default();
        let cell_names = &["grid".to_owned()];
        View { spec: &spec, cell_names, before, now }.lines(width, height).join("\n")
    }

    #[test]
    fn few_cells_have_a_row_each() {
        let before = SoFar {
            cycles: Cycles(1_000_000),
            returned: 30,
            cells: vec![cell(500, 0, 500, 0)],
            fifos: vec![fifo("X0", 512_000, 1000, 1000), fifo("Yhost", 0, 0, 1000)],
        };
        let now = SoFar {
            cycles: Cycles(3_000_000),
            returned: 90,
            cells: vec![cell(1000, 100, 700, 200)],
            fifos: vec![fifo("X0", 768_000, 1000, 2000), fifo("Yhost", 1000, 0, 2000)],
        };
        insta::assert_snapshot!(lines(&before, &now, 77, 24), @"
        simulated 150.000 ms at 600 rays/s; below, its last 100.000 ms at 600 rays/s
        g grid  s slabs  n intersection  c other  m moving  . waiting  ! blocked
        cell 0 grid          gggggggggggmm....!!!! works  60.0 %

        FIFO X0              ###########----------   256.0 of 512, full   0.0 %
        FIFO Yhost           ---------------------     1.0 of 512, full   0.0 %
        ");
        assert_eq!(lines(&before, &now, 77, 3).lines().count(), 3, "no more than fit");
        assert!(lines(&now, &before, 30, 10).lines().all(|line| line.chars().count() < 30), "nor wider; nor earlier");
    }

    #[test]
    fn many_cells_have_a_column_each() {
        let cells = (0..64).map(|index| cell(index, 0, 63 - index, 0)).collect();
        let fifos = (0..64).map(|index| fifo(&format!("X{index}"), 512 * (index % 2), 0, 1));
        let fifos = fifos.chain((1..=64).map(|index| fifo(&format!("Y{index}"), 0, 0, 1))).collect();
        let now = SoFar { cycles: Cycles(63), returned: 0, cells, fifos };
        insta::assert_snapshot!(lines(&SoFar::default(), &now, 110, 24), @"
        simulated 3.150 µs at 0 rays/s; below, its last 3.150 µs at 0 rays/s
        64 cells, a column a cell; least, mean and most to the right
        works                    ▁▁▁▁▁▁▁▁▂▂▂▂▂▂▂▂▃▃▃▃▃▃▃▃▄▄▄▄▄▄▄▄▅▅▅▅▅▅▅▅▆▆▆▆▆▆▆▆▇▇▇▇▇▇▇▇████   0  50 100 %
        waits                ████▇▇▇▇▇▇▇▇▆▆▆▆▆▆▆▆▅▅▅▅▅▅▅▅▄▄▄▄▄▄▄▄▃▃▃▃▃▃▃▃▂▂▂▂▂▂▂▂▁▁▁▁▁▁▁▁       0  50 100 %
        blocked                                                                                 0   0   0 %
        X FIFOs' level        █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █ █   0  50 100 %
        Y FIFOs' level                                                                          0   0   0 %
        ");
        let narrow = lines(&SoFar::default(), &now, 80, 24);
        assert!(narrow.contains("a column for each 2 cells"), "{narrow}");
    }
}
