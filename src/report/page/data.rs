//! The figures that a page's script draws.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use super::Page;
use super::looks::Looks;
use super::window::Window;
use crate::measure::{
    Actor, CriticalPath, FifoInfo, FifoProfile, FifoStats, LinkStats, Measured, State as CellState, StateTimes,
};
use crate::quantities::Cycles;
use crate::report::palette;
use crate::report::time_unit::TimeUnit;

#[derive(Serialize)]
pub struct Data<'a> {
    unit: &'static str,
    /// Number of bins.
    bins: usize,
    /// Width of a bin, in that unit.
    bin: f64,
    /// Length of the run, in that unit.
    end: f64,
    /// Length of a cycle, in that unit.
    cycle: f64,
    /// Length of the run, in cycles.
    cycles: u64,
    states: Vec<State<'a>>,
    cells: Vec<Cell<'a>>,
    fifos: Vec<Fifo<'a>>,
    /// For each bus the share of the run in which it carries messages, in percent.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    buses: Vec<f64>,
    /// The links of a hypercube that carried anything.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    links: Vec<Link>,
    /// For each cell, and the host behind them, the critical path's share of each bin by state.
    path: Option<Vec<Vec<Shares>>>,
    /// Rays done in each bin, per unit of time.
    rays: Numbers,
    colors: Colors,
    /// What the page holds cycle by cycle.
    window: Option<Window<'a>>,
    /// What single rays of it come to.
    looks: Option<Looks>,
}

/// Colours on white and on black.
type OnBoth = [String; 2];

/// 32-bit floats, least byte first, in base 64.
#[derive(Serialize)]
struct Numbers(String);

/// Shares of each bin in hundredths of a percent, as 16-bit integers, likewise; nothing where all are 0.
#[derive(Serialize)]
struct Shares(Option<String>);

#[derive(Serialize)]
struct Colors {
    amount: OnBoth,
    range: OnBoth,
    full: OnBoth,
    waits: OnBoth,
    answer: OnBoth,
}

#[derive(Serialize)]
struct State<'a> {
    name: &'a str,
    color: OnBoth,
}

#[derive(Serialize)]
struct Cell<'a> {
    /// What it runs, as far as that is known, or its own name.
    name: &'a str,
    /// Share of the run in which it computes or moves words, in percent.
    works: f64,
    /// For each state, its share of each bin.
    states: Vec<Shares>,
}

#[derive(Serialize)]
struct Link {
    /// The places at its ends, by their numbers; none is the host's.
    from: Option<usize>,
    to: Option<usize>,
    /// Share of the run in which messages had it, in percent.
    busy: f64,
    messages: u64,
    bytes: u64,
    /// For how long messages waited for it, in the unit of time.
    waited: f64,
}

#[derive(Serialize)]
struct Fifo<'a> {
    name: &'a str,
    /// None if it takes all.
    capacity: Option<u64>,
    most: u64,
    /// Over the whole run.
    average: f64,
    /// In percent.
    full_share: f64,
    min: Numbers,
    mean: Numbers,
    max: Numbers,
    full: Shares,
}

impl<'a> Data<'a> {
    pub fn new(page: &Page<'a>) -> Data<'a> {
        let Page { clock, stats, profile, path, .. } = *page;
        let places = path.map(CriticalPath::places);
        let (all, names) = (&stats.topology.states, &stats.topology.names.stations);
        let unit = TimeUnit::of(clock.seconds(profile.cycles));
        let cycle = clock.seconds(Cycles(1)) / unit.seconds;
        let lengths: Vec<u64> = (0..profile.jobs.len() as u64)
            .map(|bin| profile.bin.0.min(profile.cycles.0 - bin * profile.bin.0))
            .collect();
        let of_path = places.iter().flatten().flatten();
        let occurs = |state: &&CellState| {
            stats.stations.iter().chain(of_path.clone()).any(|times| times.of(state.id) > Cycles(0))
        };
        let states: Vec<&CellState> = all.all().iter().filter(occurs).collect();
        let cells = profile.stations.iter().zip(&stats.stations).enumerate().map(|(index, (bins, whole))| Cell {
            name: page.cell_names.get(index).or(names.get(index)).map_or("", String::as_str),
            works: percent(all.works(whole), stats.cycles),
            states: states.iter().map(|state| Shares::new(bins, &lengths, |bin| bin.of(state.id))).collect(),
        });
        let by_state = |bins: &Vec<StateTimes>| {
            states.iter().map(|state| Shares::new(bins, &lengths, |bin| bin.of(state.id))).collect()
        };
        let fifos = stats.topology.fifos.iter().zip(profile.fifos.iter().zip(&stats.fifos));
        let buses = stats.links.iter().filter(|link| link.into.is_none());
        let rate = |(&rays, &cycles): (&u64, &u64)| rays as f64 / (cycles as f64 * cycle);
        Data {
            unit: unit.name,
            bins: lengths.len(),
            bin: profile.bin.0 as f64 * cycle,
            end: profile.cycles.0 as f64 * cycle,
            cycle,
            cycles: profile.cycles.0,
            states: states
                .iter()
                .map(|s| State { name: &s.name, color: palette::on_both(palette::of_state(all, s)) })
                .collect(),
            cells: cells.collect(),
            fifos: fifos.map(|(info, (fifo, whole))| Fifo::new(info, fifo, (whole, stats.cycles), &lengths)).collect(),
            buses: buses.map(|bus| percent(bus.busy, stats.cycles)).collect(),
            links: stats.links.iter().filter_map(|link| Link::new(link, stats, cycle)).collect(),
            path: places.as_ref().map(|places| places.iter().map(by_state).collect()),
            rays: Numbers::new(profile.jobs.iter().zip(&lengths).map(rate)),
            colors: Colors {
                amount: palette::on_both(palette::AMOUNT),
                range: palette::on_both(palette::RANGE),
                full: palette::on_both(palette::FULL),
                waits: palette::on_both(palette::WAITS[0]),
                answer: palette::on_both(palette::ANSWER),
            },
            looks: page
                .setup
                .zip(page.recording)
                .and_then(|(setup, recording)| Looks::new(setup, recording, super::window::end(recording))),
            window: page.recording.map(Window::new),
        }
    }
}

impl Link {
    /// `None` for what is no link of a hypercube, and for one that nothing passed. `cycle` is a cycle's length in the unit of time.
    fn new(link: &LinkStats, stats: &Measured, cycle: f64) -> Option<Link> {
        let place = |actor: Actor| match actor {
            Actor::Station(place) => Some(place),
            Actor::Host => None,
        };
        let messages = link.messages.filter(|messages| messages.sent > 0)?;
        Some(Link {
            from: place(link.from?),
            to: place(link.into?),
            busy: percent(link.busy, stats.cycles),
            messages: messages.sent,
            bytes: messages.bytes,
            waited: messages.waited.0 as f64 * cycle,
        })
    }
}

impl<'a> Fifo<'a> {
    fn new(info: &'a FifoInfo, fifo: &FifoProfile, (whole, cycles): (&FifoStats, Cycles), lengths: &[u64]) -> Fifo<'a> {
        let bins = || fifo.bins.iter();
        Fifo {
            name: &info.name,
            capacity: info.capacity.map(|words| words.0),
            most: whole.max.0,
            average: whole.mean(cycles),
            full_share: percent(whole.full, cycles),
            min: Numbers::new(bins().map(|bin| bin.min.0 as f64)),
            mean: Numbers::new(bins().zip(lengths).map(|(bin, &cycles)| bin.word_cycles as f64 / cycles as f64)),
            max: Numbers::new(bins().map(|bin| bin.max.0 as f64)),
            full: Shares::new(&fifo.bins, lengths, |bin| bin.full),
        }
    }
}

impl Numbers {
    fn new(values: impl Iterator<Item = f64>) -> Numbers {
        Numbers(STANDARD.encode(values.flat_map(|value| (value as f32).to_le_bytes()).collect::<Vec<u8>>()))
    }
}

impl Shares {
    fn new<B>(bins: &[B], lengths: &[u64], part: impl Fn(&B) -> Cycles) -> Shares {
        let hundredths = |(bin, &cycles): (&B, &u64)| (100.0 * percent(part(bin), Cycles(cycles))).round() as u16;
        let all_zero = bins.iter().all(|bin| part(bin) == Cycles(0));
        let bytes = || bins.iter().zip(lengths).flat_map(|pair| hundredths(pair).to_le_bytes()).collect::<Vec<u8>>();
        Shares((!all_zero).then(|| STANDARD.encode(bytes())))
    }
}

fn percent(part: Cycles, whole: Cycles) -> f64 {
    100.0 * part.0 as f64 / whole.0.max(1) as f64
}
