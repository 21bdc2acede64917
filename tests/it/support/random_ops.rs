//! Random op streams for random machines.

use std::collections::BTreeMap;
use std::sync::Arc;

use pcs_sim::machine::{Cycles, FifoName, MachineSpec, RateCounts, Words};
use pcs_sim::seam::{Activity, Costs, OpBatch, OpKind, OpStream, Unit, UnitOfWork, Vocabulary};
use proptest::prelude::*;

/// What the units of the random programs cost: four activities have one each of a cycle, of seven, and of none.
const CYCLES: [u64; 3] = [1, 7, 0];

/// The units of random programs, with their prices.
pub fn costs() -> Costs {
    let unit = |place: u8| UnitOfWork {
        used: true,
        code: format!("u{}", char::from(b'a' + place)),
        name: format!("unit_{place}"),
        activity: Activity(place % 4),
    };
    let activities = [('g', "grid"), ('s', "slabs"), ('n', "intersection"), ('c', "other")];
    let vocabulary = Vocabulary {
        activities: activities.map(|(letter, name)| (letter, name.to_owned())).to_vec(),
        units: (0..12).map(unit).collect(),
        answer_words: 5,
    };
    Costs::new(Arc::new(vocabulary), |unit| Cycles(CYCLES[unit.0 as usize / 4]))
}

/// What a cell may do between its moves.
fn compute() -> impl Strategy<Value = (OpKind, u32)> {
    let work = (0u8..12).prop_map(Unit);
    (work, prop_oneof![0u32..4, 0u32..20]).prop_map(|(unit, count)| (OpKind::Work(unit), count))
}

/// For each ray: words on Y from each cell to the next and on Z to the one before, and an order in which each cell does
/// things.
#[derive(Clone, Debug)]
pub struct RayPlan {
    words: Vec<u32>,
    /// The left neighbour reads them with the next ray.
    back: Vec<u32>,
    seeds: Vec<u64>,
    computes: Vec<Vec<(OpKind, u32)>>,
    waits: bool,
    host_time: u32,
    /// What everybody does behind the last ray, if this is the last: nothing, or what the digits say.
    late: Option<u64>,
}

impl RayPlan {
    /// The same, but that the host waits for no answer before it.
    pub fn at_once(&self) -> RayPlan {
        RayPlan { waits: false, ..self.clone() }
    }
}

fn ray_plan(cells: usize) -> impl Strategy<Value = RayPlan> {
    (
        prop::collection::vec(0u32..7, cells),
        prop::collection::vec(prop_oneof![3 => Just(0u32), 2 => 1u32..5], cells),
        prop::collection::vec(any::<u64>(), cells),
        prop::collection::vec(prop::collection::vec(compute(), 0..4), cells),
        prop::bool::weighted(0.2),
        prop_oneof![Just(0u32), 0u32..40],
        prop::option::weighted(0.4, any::<u64>()),
    )
        .prop_map(|(words, back, seeds, computes, waits, host_time, late)| RayPlan {
            words,
            back,
            seeds,
            computes,
            waits,
            host_time,
            late,
        })
}

/// A shuffle that needs no generator: the seed's digits pick.
fn shuffle<T>(mut items: Vec<T>, mut seed: u64) -> Vec<T> {
    let mut out = Vec::new();
    while !items.is_empty() {
        let pick = (seed % items.len() as u64) as usize;
        seed = seed.rotate_left(7).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        out.push(items.remove(pick));
    }
    out
}

/// The ops of some of the rays.
pub fn batch_of(cells: usize, rays: &[RayPlan], range: std::ops::Range<usize>) -> OpBatch {
    let mut batch = OpBatch::new(cells);
    for index in range {
        let (plan, ray) = (&rays[index], index as u32);
        let before = index.checked_sub(1).map(|before| &rays[before]);
        if plan.waits && ray > 0 {
            batch.host.push(OpKind::Await, ray as u64 - 1);
        }
        batch.host.push(OpKind::Work(Unit(3)), plan.host_time as u64);
        batch.host.push(OpKind::WriteX, 8);
        let late = plan.late.filter(|_| index + 1 == rays.len());
        late.into_iter().for_each(|late| push_late(&mut batch.host, &[OpKind::WriteX], late));
        batch.host.end_line(ray);
        for cell in 0..cells {
            let last = cell + 1 == cells;
            push_line(&mut batch.cells[cell], plan, before, cell, last);
            let late = late.map(|late| late.rotate_right(9 * (cell as u32 + 1)));
            late.into_iter().for_each(|late| push_late(&mut batch.cells[cell], late_moves(cell, last), late));
            batch.cells[cell].end_line(ray);
        }
    }
    batch
}

/// Eight words of X (passed on, or read and written by themselves), what the left cell sent, what the right one gets, what
/// goes back to the left, and what the right cell sent back for the ray before.
fn push_line(stream: &mut OpStream, plan: &RayPlan, before: Option<&RayPlan>, cell: usize, last: bool) {
    let seed = plan.seeds[cell];
    let mut items: Vec<Vec<(OpKind, u32)>> = plan.computes[cell].iter().map(|&op| vec![op]).collect();
    items.push(match seed % 4 {
        0 => vec![(OpKind::PassX, 3), (OpKind::PassX, 5)],
        1 if !last => vec![(OpKind::ReadX, 8), (OpKind::WriteX, 8)],
        _ => vec![(OpKind::PassX, 8)],
    });
    if cell > 0 {
        items.extend(split(plan.words[cell - 1], seed).map(|count| vec![(OpKind::ReadY, count)]));
        items.extend(split(plan.back[cell], seed >> 24).map(|count| vec![(OpKind::WriteZ, count)]));
    }
    if let Some(before) = before.filter(|_| !last) {
        items.extend(split(before.back[cell + 1], seed >> 32).map(|count| vec![(OpKind::ReadZ, count)]));
    }
    let sent = if last { 5 } else { plan.words[cell] };
    items.extend(split(sent, seed >> 8).map(|count| vec![(OpKind::WriteY, count)]));
    for (kind, count) in shuffle(items, seed >> 16).into_iter().flatten() {
        stream.push(kind, count as u64);
    }
}

/// Work and words that outlive the run, or stay in a FIFO: what the digits of a number say.
fn push_late(stream: &mut OpStream, moves: &[OpKind], late: u64) {
    stream.push(OpKind::Work(Unit(3)), if late & 1 == 0 { 0 } else { (late >> 3) % 60 });
    if let Some(&kind) = moves.get(late as usize / 2 % 4) {
        stream.push(kind, 1 + (late >> 5) % 12);
    }
}

/// What a cell may move of which nobody else need know: words that it writes stay where they are. What it reads must have
/// been written late too.
fn late_moves(cell: usize, last: bool) -> &'static [OpKind] {
    match (cell, last) {
        (0, true) => &[],
        (0, false) => &[OpKind::WriteX, OpKind::WriteY, OpKind::ReadX],
        (_, true) => &[OpKind::WriteZ],
        (_, false) => &[OpKind::WriteX, OpKind::WriteY, OpKind::WriteZ],
    }
}

fn split(words: u32, seed: u64) -> impl Iterator<Item = u32> {
    let first = if words == 0 { 0 } else { (seed % words as u64) as u32 };
    [first, words - first].into_iter().filter(|&count| count > 0)
}

fn machine() -> impl Strategy<Value = MachineSpec> {
    let rate = prop_oneof![3 => Just(80.0), 1 => prop::sample::select(vec![160.0, 40.0, 30.0, 13.0])];
    let counts = prop::sample::select(vec![RateCounts::Link, RateCounts::Channel]);
    (prop_oneof![1u64..=16, 1u64..=600], depths(), prop_oneof![Just(1u64), 1u64..=20], rate, counts).prop_map(
        |(fifo_words, (channel_words, own_words), latency, link_mb_s, rate_counts)| MachineSpec {
            fifo_words: Words(fifo_words),
            channel_words,
            own_words,
            latency: Cycles(latency),
            link_mb_s,
            rate_counts,
            ..MachineSpec::default()
        },
    )
}

/// Depths of the FIFOs of single channels, and of single FIFOs: of some that the row has not, too.
fn depths() -> impl Strategy<Value = ([Option<Words>; 3], BTreeMap<FifoName, Words>)> {
    let words = || (1u64..=40).prop_map(Words);
    let channels = prop::array::uniform3(prop::option::weighted(0.2, words()));
    let names = prop::sample::select(vec!["X0", "X1", "X2", "Y1", "Y2", "Y3", "Yhost", "Z0", "Z1", "Z2"]);
    let names = names.prop_map(|name| name.parse::<FifoName>().unwrap());
    (channels, prop_oneof![Just(BTreeMap::new()), prop::collection::btree_map(names, words(), 1..6)])
}

/// The ops of all rays, so many rays a batch.
pub fn batches_of(cells: usize, rays: &[RayPlan], per_batch: usize) -> Vec<OpBatch> {
    let end = |first: usize| rays.len().min(first + per_batch);
    (0..rays.len()).step_by(per_batch).map(|first| batch_of(cells, rays, first..end(first))).collect()
}

/// A machine, its number of cells, rays, and how many of them a batch has.
pub fn case() -> impl Strategy<Value = (MachineSpec, usize, Vec<RayPlan>, usize)> {
    (machine(), 1usize..5).prop_flat_map(|(spec, cells)| {
        (Just(spec), Just(cells), prop::collection::vec(ray_plan(cells), 1..24), 1usize..9)
    })
}
