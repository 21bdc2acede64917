//! What `--watch` shows of a machine, as lines of text.

use console::{Style, truncate_str};
use pcs_sim::measure::{Clock, FifoInfo, SoFar, State, StateKind, StateTimes, States};
use pcs_sim::quantities::Cycles;
use pcs_sim::report::summary::{grouped, plural, time};

/// A machine between two looks at it.
pub struct View<'a> {
    pub clock: Clock,
    /// What each cell runs, as far as that is known.
    pub cell_names: &'a [String],
    pub before: &'a SoFar,
    pub now: &'a SoFar,
}

/// What one FIFO did between two looks.
struct Level<'a> {
    info: &'a FifoInfo,
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
        let rows = self.now.stations.len() + self.now.fifos.len() + 4;
        let lines = if rows <= height { self.rows(width) } else { self.columns(width) };
        lines.iter().take(height).map(|line| truncate_str(line, width.saturating_sub(1), "…").into_owned()).collect()
    }

    fn heading(&self) -> String {
        let seconds = |cycles: Cycles| self.clock.seconds(cycles);
        let passed = Cycles(self.now.cycles.0.saturating_sub(self.before.cycles.0));
        let rays = self.now.returned.saturating_sub(self.before.returned);
        let rate = |rays: u64, seconds: f64| {
            if seconds > 0.0 { grouped((rays as f64 / seconds).round() as u64) } else { "0".to_owned() }
        };
        let job = &self.now.topology.names.job;
        format!(
            "simulated {} at {} {job}s/s; below, its last {} at {} {job}s/s",
            time(seconds(self.now.cycles)),
            rate(self.now.returned, seconds(self.now.cycles)),
            time(seconds(passed)),
            rate(rays, seconds(passed)),
        )
    }

    fn rows(&self, width: usize) -> Vec<String> {
        let topology = &self.now.topology;
        let (states, names) = (&topology.states, &topology.names);
        let length = width.saturating_sub(BESIDE_BARS).clamp(10, LONGEST_BAR);
        let mut lines = vec![self.heading(), legend(states, &StateTimes::sum(&self.now.stations))];
        for (index, cell) in self.cells().iter().enumerate() {
            let name = self.cell_names.get(index).map_or(String::new(), |name| format!(" {name}"));
            let works = 100.0 * share(states.works(cell), cell.total());
            lines.push(format!(
                "{:NAME$} {} works {works:5.1} %",
                format!("{}{name}", topology.station(index)),
                bar_of(states, cell, length)
            ));
        }
        lines.push(String::new());
        for Level { info, mean, full } in self.levels() {
            let filled = (self.filled(info, mean) * length as f64).round() as usize;
            let bar = Style::new().for_stderr().blue().apply_to("#".repeat(filled.min(length)));
            let rest = "-".repeat(length - filled.min(length));
            let room = info.capacity.map_or(format!("{}s", names.word), |capacity| format!("of {}", capacity.0));
            let figures = format!("{mean:7.1} {room}, full {:5.1} %", 100.0 * full);
            // Some have the word in their names.
            let kind = if info.group == names.fifo { String::new() } else { format!("{} ", names.fifo) };
            lines.push(format!("{:NAME$} {bar}{rest} {figures}", format!("{kind}{}", info.name)));
        }
        lines
    }

    fn columns(&self, width: usize) -> Vec<String> {
        let cells = self.cells();
        let each = cells.len().div_ceil(width.saturating_sub(NAME + 17).max(8));
        let names = &self.now.topology.names;
        let cell = &names.station;
        let what = if each == 1 { format!("a column a {cell}") } else { format!("a column for each {each} {cell}s") };
        let states = &self.now.topology.states;
        let share_of = |some: &dyn Fn(&StateTimes) -> Cycles| {
            cells.iter().map(|cell| share(some(cell), cell.total())).collect::<Vec<f64>>()
        };
        let levels = |group: &str| {
            let all = self.levels().filter(|level| level.info.group == group);
            all.map(|level| self.filled(level.info, level.mean)).collect()
        };
        let mut lines = vec![
            self.heading(),
            format!("{}, {what}; least, mean and most to the right", plural(cells.len() as u64, cell)),
            sparks("works", share_of(&|cell| states.works(cell)), each, Style::new().green()),
            sparks("waits", share_of(&|cell| states.waits(cell)), each, Style::new().yellow()),
            sparks("blocked", share_of(&|cell| states.blocked(cell)), each, Style::new().red()),
        ];
        let mut groups: Vec<&str> = self.now.topology.fifos.iter().map(|info| info.group.as_str()).collect();
        groups.dedup();
        lines.extend(groups.into_iter().map(|group| {
            let name = match group == names.fifo {
                true => format!("{group}s' level"),
                false => format!("{group} {}s' level", names.fifo),
            };
            sparks(&name, levels(group), each, Style::new().blue())
        }));
        lines
    }

    /// How full a FIFO is with so many words: one that takes all, against the most that any has held.
    fn filled(&self, info: &FifoInfo, words: f64) -> f64 {
        let highest = || self.now.fifos.iter().map(|(held, _)| held.max).max().unwrap_or_default();
        words / info.capacity.unwrap_or_else(highest).0.max(1) as f64
    }

    /// What each cell did between the two looks.
    fn cells(&self) -> Vec<StateTimes> {
        let before = |index: usize| self.before.stations.get(index).copied().unwrap_or_default();
        let cells = self.now.stations.iter().enumerate();
        cells.map(|(index, cell)| cell.since(&before(index))).collect()
    }

    fn levels(&self) -> impl Iterator<Item = Level<'_>> {
        let infos = self.now.topology.fifos.iter();
        infos.zip(&self.now.fifos).enumerate().map(|(index, (info, (stats, until)))| {
            let (word_cycles, full, since) = self
                .before
                .fifos
                .get(index)
                .map_or((0, 0, 0), |(before, since)| (before.word_cycles, before.full.0, since.0));
            let passed = until.0.saturating_sub(since);
            let word_cycles = stats.word_cycles.saturating_sub(word_cycles);
            Level {
                info,
                // Both ends of the time are where this FIFO has come to, which is not quite where the words are counted.
                mean: (word_cycles as f64 / passed.max(1) as f64)
                    .min(info.capacity.map_or(f64::INFINITY, |words| words.0 as f64)),
                full: share(Cycles(stats.full.0.saturating_sub(full)), Cycles(passed)),
            }
        })
    }
}

fn share(part: Cycles, whole: Cycles) -> f64 {
    if whole.0 == 0 { 0.0 } else { part.0 as f64 / whole.0 as f64 }
}

/// The colour of a state: what is worked on has colours by its place.
fn style(states: &States, state: &State) -> Style {
    let style = Style::new().for_stderr();
    let place = states.all().iter().filter(|other| other.kind == state.kind).position(|other| other.id == state.id);
    match (state.kind, place.unwrap_or_default() % 4) {
        (StateKind::Works, 0) => style.blue(),
        (StateKind::Works, 1) => style.green(),
        (StateKind::Works, 2) => style.cyan(),
        (StateKind::Works, _) => style.magenta(),
        (StateKind::Moves, _) => style.bold(),
        (StateKind::Waits, _) => style.yellow(),
        (StateKind::Blocked, _) => style.red(),
        (StateKind::Idle, _) => style,
    }
}

/// The letters of the states that cells have been in so far: waits and blocks have one each, wherever they are. A machine may have states
/// that its program knows nothing of.
fn legend(states: &States, so_far: &StateTimes) -> String {
    let mut letters = Vec::new();
    let mut is_new = |letter: char| {
        !letters.contains(&letter) && {
            letters.push(letter);
            true
        }
    };
    let is_shown = |state: &&State| state.kind != StateKind::Idle && so_far.of(state.id) > Cycles(0);
    let shown = states.all().iter().filter(is_shown).filter(|state| is_new(state.letter));
    let names = shown.map(|state| {
        let name = state.name.split(' ').next().unwrap_or(&state.name);
        format!("{} {name}", style(states, state).apply_to(state.letter))
    });
    names.collect::<Vec<_>>().join("  ")
}

/// A cell's states, each as long as its share of the time.
fn bar_of(states: &States, cell: &StateTimes, length: usize) -> String {
    let (whole, mut passed, mut drawn) = (cell.total(), Cycles(0), 0);
    let mut bar = String::new();
    for state in states.all() {
        passed += cell.of(state.id);
        let end = (share(passed, whole) * length as f64).round() as usize;
        if end > drawn {
            bar += &style(states, state).apply_to(state.letter.to_string().repeat(end - drawn)).to_string();
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
    use std::sync::Arc;

    use pcs_sim::machine::line::{MOVING, blocked, waiting, working};
    use pcs_sim::machine::{Array, KernelTimes, MachineSpec};
    use pcs_sim::measure::{Actor, FifoStats, Topology};
    use pcs_sim::program::work;
    use pcs_sim::quantities::Words;
    use pcs_sim::seam::{Activity, Channel};

    fn cell(grid: u64, moving: u64, waiting_y: u64, blocked_x: u64) -> StateTimes {
        let mut times = StateTimes::default();
        let y = waiting(Channel::Y);
        for (state, cycles) in
            [(working(Activity(0)), grid), (MOVING, moving), (y, waiting_y), (blocked(Channel::X), blocked_x)]
        {
            *times.of_mut(state) = Cycles(cycles);
        }
        times
    }

    fn fifo(word_cycles: u128, full: u64, until: u64) -> (FifoStats, Cycles) {
        (FifoStats { word_cycles, full: Cycles(full), ..FifoStats::default() }, Cycles(until))
    }

    /// Cells with the states that an array has, and FIFOs with these names.
    fn topology(cells: usize, fifos: &[String]) -> Arc<Topology> {
        let costs = work::costs(&work::vocabulary(false), &KernelTimes::default(), None);
        let states = Array::new(&MachineSpec::default(), &costs, 1).so_far().topology.states.clone();
        let info = |name: &String| FifoInfo {
            name: name.clone(),
            group: name[..1].to_owned(),
            from: Actor::Host,
            to: Actor::Host,
            capacity: Some(Words(512)),
        };
        Arc::new(Topology { stations: cells, fifos: fifos.iter().map(info).collect(), states, ..Topology::default() })
    }

    fn lines(before: &SoFar, now: &SoFar, width: usize, height: usize) -> String {
        let clock = MachineSpec::default().clock();
        let cell_names = &["grid".to_owned()];
        View { clock, cell_names, before, now }.lines(width, height).join("\n")
    }

    #[test]
    fn few_cells_have_a_row_each() {
        let topology = topology(1, &["X0".to_owned(), "Yhost".to_owned()]);
        let before = SoFar {
            topology: topology.clone(),
            cycles: Cycles(1_000_000),
            returned: 30,
            stations: vec![cell(500, 0, 500, 0)],
            fifos: vec![fifo(512_000, 1000, 1000), fifo(0, 0, 1000)],
        };
        let now = SoFar {
            topology,
            cycles: Cycles(3_000_000),
            returned: 90,
            stations: vec![cell(1000, 100, 700, 200)],
            fifos: vec![fifo(768_000, 1000, 2000), fifo(1000, 0, 2000)],
        };
        insta::assert_snapshot!(lines(&before, &now, 77, 24), @"
        simulated 150.000 ms at 600 rays/s; below, its last 100.000 ms at 600 rays/s
        g grid  m moving  . waiting  ! blocked
        cell 0 grid          gggggggggggmm....!!!! works  60.0 %

        FIFO X0              ###########----------   256.0 of 512, full   0.0 %
        FIFO Yhost           ---------------------     1.0 of 512, full   0.0 %
        ");
        assert_eq!(lines(&before, &now, 77, 3).lines().count(), 3, "no more than fit");
        assert!(lines(&now, &before, 30, 10).lines().all(|line| line.chars().count() < 30), "nor wider; nor earlier");
    }

    #[test]
    fn waits_and_blocks_on_words_to_the_left_are_seen() {
        let mut cell = StateTimes::default();
        for (state, cycles) in [(working(Activity(0)), 25), (waiting(Channel::Z), 25), (blocked(Channel::Z), 50)] {
            *cell.of_mut(state) = Cycles(cycles);
        }
        let shown = |cells: usize, width: usize| {
            let fifos = vec!["X0".to_owned()];
            let topology = topology(cells, &fifos);
            let stations = vec![cell; cells];
            let now = SoFar { topology, cycles: Cycles(100), returned: 0, stations, fifos: vec![fifo(0, 0, 100)] };
            lines(&SoFar::default(), &now, width, 24)
        };
        let few = shown(1, 77);
        assert!(few.contains(" ggggg......!!!!!!!!!! "), "{few}");
        let many = shown(64, 110);
        let row = |name: &str| many.lines().find(|line| line.starts_with(name)).unwrap_or_default().to_owned();
        assert!(row("waits").ends_with("25  25  25 %"), "{many}");
        assert!(row("blocked").ends_with("50  50  50 %"), "{many}");
    }

    #[test]
    fn many_cells_have_a_column_each() {
        let cells = (0..64).map(|index| cell(index, 0, 63 - index, 0)).collect();
        let names = (0..64).map(|index| format!("X{index}")).chain((1..=64).map(|index| format!("Y{index}")));
        let fifos = (0..64).map(|index| fifo(512 * (index % 2), 0, 1)).chain((1..=64).map(|_| fifo(0, 0, 1)));
        let topology = topology(64, &names.collect::<Vec<_>>());
        let now = SoFar { topology, cycles: Cycles(63), returned: 0, stations: cells, fifos: fifos.collect() };
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
