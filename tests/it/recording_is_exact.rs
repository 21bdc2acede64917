//! What a recorder saw, cycle by cycle, against the model that ticks every cycle.

use std::ops::Range;

use crate::support::random_ops::{batches_of, case, costs};
use crate::support::ticking::{self, History, Ticked};
use pcs_sim::machine::line::{IDLE, MOVING, waiting};
use pcs_sim::machine::{Array, Cycles, MachineSpec, Unfinished, Words};
use pcs_sim::measure::{
    Actor, FifoInfo, JobSpan, Measured, Moment, OpMoment, Recording, StateId, StationMoment, StationRecord, Stretch,
};
use pcs_sim::seam::{Channel, Costs, Op, OpBatch, OpKind, OpStream};
use proptest::prelude::*;

/// The whole run, and more.
const ALL: Range<Cycles> = Cycles(0)..Cycles(u64::MAX);

/// Times the ops in batches and records them. `None` if they are stuck.
fn record(
    (spec, costs): (&MachineSpec, &Costs),
    batches: &[OpBatch],
    window: Range<Cycles>,
    most_events: usize,
) -> Option<(Measured, Recording)> {
    let attempt = |limit: Cycles| {
        let array = Array::until(spec, costs, batches[0].cells.len(), limit);
        let mut array = array.recorded(window.clone(), most_events);
        for batch in batches {
            array.feed(batch.clone()).expect("an array can do it");
            array.run()?;
        }
        array.finish_observed()
    };
    let (stats, observed) = match attempt(Cycles(u64::MAX)) {
        Err(Unfinished::Outlived(cycles)) => attempt(cycles).expect("it ended before"),
        Err(Unfinished::Stuck(_)) => return None,
        Ok(result) => result,
    };
    Some((stats, observed.recording.expect("the array has a recorder")))
}

/// The state in each cycle. There must be no gap and no overlap.
fn states(activity: &StationRecord, window: &Range<Cycles>) -> Vec<StateId> {
    let mut next = window.start;
    let mut states = Vec::new();
    for stretch in &activity.states {
        assert_eq!(stretch.from, next);
        assert!(stretch.until > stretch.from);
        states.extend(std::iter::repeat_n(stretch.state, (stretch.until - stretch.from).0 as usize));
        next = stretch.until;
    }
    assert_eq!(next, window.end);
    states
}

/// The level at the end of each cycle; only changes may be recorded.
fn levels(levels: &[(Cycles, Words)], window: &Range<Cycles>) -> Vec<u64> {
    assert!(levels.windows(2).all(|pair| pair[0].0 < pair[1].0 && pair[0].1 != pair[1].1));
    let ends = levels.iter().skip(1).map(|level| level.0).chain([window.end]);
    let held = levels
        .iter()
        .zip(ends)
        .flat_map(|(&(from, Words(level)), until)| std::iter::repeat_n(level, (until - from).0 as usize));
    held.collect()
}

/// The visits of a cell's rays as the model has them.
fn naive_visits(batches: &[OpBatch], cell: usize, history: &History) -> Vec<JobSpan> {
    let lines = batches.iter().flat_map(|batch| batch.cells[cell].lines());
    let mut visits = Vec::new();
    let mut first_op = 0;
    for (job, ops) in lines {
        let its_ops = first_op..first_op + ops.len();
        first_op = its_ops.end;
        let cycles = history.at[cell].iter().zip(&history.states[cell]).enumerate();
        let at_work = cycles.filter(|(_, (at, state))| its_ops.contains(at) && **state != IDLE);
        let mut busy = at_work.skip_while(|(_, (_, state))| Channel::ALL.map(waiting).contains(state));
        if let Some((from, _)) = busy.next() {
            let last = busy.last().map_or(from, |(cycle, _)| cycle);
            visits.push(JobSpan { job, from: Cycles(from as u64), until: Cycles(last as u64 + 1) });
        }
    }
    visits
}

/// Visits as far as they lie in a window.
fn clipped(visits: &[JobSpan], window: &Range<Cycles>) -> Vec<JobSpan> {
    let clip =
        |visit: &JobSpan| JobSpan { from: visit.from.max(window.start), until: visit.until.min(window.end), ..*visit };
    visits.iter().map(clip).filter(|visit| visit.from < visit.until).collect()
}

/// The ops of a stream, each with the job that it is for.
fn ops_of<'a>(streams: impl Iterator<Item = &'a OpStream>) -> Vec<(Op, Option<u32>)> {
    let of = |stream: &'a OpStream| {
        let job = move |place| stream.locate(place).map(|(job, _)| job);
        stream.ops().iter().enumerate().map(move |(place, op)| (*op, job(place)))
    };
    streams.flat_map(of).collect()
}

/// What a station is at in each cycle is what the model has it at.
fn assert_ops(
    (recording, actor, costs): (&Recording, Actor, &Costs),
    ops: &[(Op, Option<u32>)],
    at: &[usize],
    moves: impl Fn(usize) -> bool,
) {
    for cycle in recording.window.start.0..recording.window.end.0 {
        let told = recording.op(actor, Cycles(cycle));
        let here = at[cycle as usize];
        let Some(&(op, job)) = ops.get(here).filter(|_| cycle < recording.ops_until.0) else {
            assert_eq!(told, None, "{actor} in cycle {cycle}");
            continue;
        };
        let of_it = at.partition_point(|&other| other < here)..at.partition_point(|&other| other <= here);
        let OpMoment { span, done, of } = told.unwrap_or_else(|| panic!("{actor} has no op in cycle {cycle}"));
        assert_eq!((span.op, span.job, span.from.0), (op, job, of_it.start as u64), "{actor} in cycle {cycle}");
        assert_eq!(span.until.0, (of_it.end as u64).min(recording.ops_until.0), "{actor} in cycle {cycle}");
        let (passed, count) = (of_it.start..cycle as usize + 1, u64::from(op.count()));
        let expected = match op.kind() {
            OpKind::Await => (0, 0),
            OpKind::Work(unit) => (passed.len() as u64, count * costs.of(unit).0),
            _ => (passed.filter(|&cycle| moves(cycle)).count() as u64, count),
        };
        assert_eq!((done, of), expected, "{actor} in cycle {cycle}");
    }
}

/// The stream that writes to a FIFO, and the link and the channel that it is at.
type Writer = (usize, usize, fn(&OpBatch, usize) -> &OpStream);

fn writer_of(info: &FifoInfo) -> Writer {
    let channel = Channel::ALL.into_iter().find(|channel| channel.to_string() == info.group).unwrap();
    let (link, stream): (usize, fn(&OpBatch, usize) -> &OpStream) = match info.from {
        Actor::Host => (0, |batch, _| &batch.host),
        Actor::Station(cell) if channel == Channel::Z => (cell, |batch, link| &batch.cells[link]),
        Actor::Station(cell) => (cell + 1, |batch, link| &batch.cells[link - 1]),
    };
    (link, channel as usize, stream)
}

/// The jobs of the words that a FIFO holds at the end of each cycle.
fn assert_words(recording: &Recording, fifo: usize, batches: &[OpBatch], history: &History) {
    let info = &recording.topology.fifos[fifo];
    let (link, channel, stream) = writer_of(info);
    let is_last = info.from == Actor::Station(batches[0].cells.len() - 1);
    let ops = ops_of(batches.iter().map(|batch| stream(batch, link)));
    let written = ops.iter().filter(|(op, _)| op.kind().writes().is_some_and(|c| c as usize == channel));
    let written = written.filter(|(op, _)| !(is_last && op.kind() == OpKind::PassX));
    let jobs: Vec<_> = written.flat_map(|(op, job)| std::iter::repeat_n(*job, op.count() as usize)).collect();
    let [writes, reads] = history.words.get(&(link, channel)).cloned().unwrap_or_default();
    for cycle in recording.window.start.0..recording.window.end.0 {
        let until = |times: &[u64]| times.partition_point(|&time| time <= cycle);
        let inside = &jobs[until(&reads)..until(&writes)];
        assert_eq!(recording.words(fifo, Cycles(cycle)).unwrap(), inside, "{} in cycle {cycle}", info.name);
    }
}

/// What each station does and what each FIFO holds, in every cycle, is what the model has.
fn assert_steps(recording: &Recording, costs: &Costs, batches: &[OpBatch], history: &History) {
    for cell in 0..recording.stations.len() {
        let ops = ops_of(batches.iter().map(|batch| &batch.cells[cell]));
        let moves = |cycle: usize| history.states[cell][cycle] == MOVING;
        assert_ops((recording, Actor::Station(cell), costs), &ops, &history.at[cell], moves);
    }
    let ops = ops_of(batches.iter().map(|batch| &batch.host));
    let sends = |cycle: usize| history.sent.binary_search(&(cycle as u64)).is_ok();
    assert_ops((recording, Actor::Host, costs), &ops, &history.host_at, sends);
    (0..recording.fifos.len()).for_each(|fifo| assert_words(recording, fifo, batches, history));
}

/// The jobs whose words passed through a FIFO, as the model has them: from their first word's write to their last one's read.
fn naive_passages(batches: &[OpBatch], info: &FifoInfo, history: &History) -> Vec<JobSpan> {
    let last = batches[0].cells.len() - 1;
    let (link, channel, stream) = writer_of(info);
    let is_last = info.from == Actor::Station(last);
    let [writes, reads] = history.words.get(&(link, channel)).cloned().unwrap_or_default();
    let (mut passages, mut first) = (Vec::new(), 0);
    for (job, ops) in batches.iter().flat_map(|batch| stream(batch, link).lines()) {
        let written = ops.iter().filter(|op| !(is_last && op.kind() == OpKind::PassX));
        let words: u32 =
            written.filter(|op| op.kind().writes().is_some_and(|c| c as usize == channel)).map(|op| op.count()).sum();
        let end = first + words as usize;
        if let Some(&from) = writes.get(first).filter(|_| words > 0) {
            let until = reads.get(end - 1).map_or(u64::MAX, |read| read + 1);
            passages.push(JobSpan { job, from: Cycles(from), until: Cycles(until) });
        }
        first = end;
    }
    passages
}

/// Everything in a recording is what happened in its window.
fn assert_exact(recording: &Recording, batches: &[OpBatch], history: &History) {
    let window = &recording.window;
    let cycles = window.start.0 as usize..window.end.0 as usize;
    for (cell, activity) in recording.stations.iter().enumerate() {
        assert_eq!(states(activity, window), history.states[cell][cycles.clone()], "states of cell {cell}");
        let visits = clipped(&naive_visits(batches, cell, history), window);
        assert_eq!(activity.jobs, visits, "visits of cell {cell}");
        let crosses = |border: Cycles| activity.states.iter().any(|s| s.from < border && border < s.until);
        assert!(!visits.iter().any(|visit| crosses(visit.from) || crosses(visit.until)));
    }
    let fifos = recording.topology.fifos.iter().zip(&recording.fifos);
    for ((info, fifo), naive) in fifos.zip(&history.occupancies) {
        assert_eq!(levels(&fifo.levels, window), naive[cycles.clone()], "levels of {}", info.name);
        let passages = clipped(&naive_passages(batches, info, history), window);
        assert_eq!(fifo.jobs, passages, "jobs through {}", info.name);
    }
    let host = states(recording.host.as_ref().unwrap(), window);
    let moving = cycles.clone().zip(host).filter(|(_, state)| *state == MOVING).map(|(cycle, _)| cycle as u64);
    let sent = history.sent.iter().copied().filter(|&cycle| cycles.contains(&(cycle as usize)));
    assert_eq!(moving.collect::<Vec<_>>(), sent.collect::<Vec<_>>());
    let rays = batches.iter().flat_map(|batch| batch.host.lines()).map(|(ray, _)| ray);
    let hits = rays.zip(&history.returned).filter(|(_, returned)| cycles.contains(&(**returned as usize)));
    let hits: Vec<_> = hits.map(|(ray, &returned)| (ray, Cycles(returned + 1))).collect();
    let recorded = recording.answers.iter().map(|hit| (hit.job, hit.until));
    // The window may end within one.
    assert_eq!(recorded.take(hits.len()).collect::<Vec<_>>(), hits);
    assert!(recording.answers.len() <= hits.len() + 1);
}

/// What a station is at in each cycle of a window, of its state in each and of its jobs.
fn station_moments(states: &[StateId], jobs: &[JobSpan], window: &Range<Cycles>) -> Vec<StationMoment> {
    let job_at = |at: Cycles| jobs.iter().find(|job| job.from <= at && at < job.until).copied();
    let mut moments: Vec<StationMoment> = Vec::new();
    for (&state, cycle) in states.iter().zip(window.start.0..) {
        let (at, job) = (Cycles(cycle), job_at(Cycles(cycle)));
        let last = moments.last().filter(|last| (last.stretch.state, last.job) == (state, job));
        let from = last.map_or(at, |last| last.stretch.from);
        moments.push(StationMoment { stretch: Stretch { state, from, until: window.end }, job });
    }
    let mut until = window.end;
    for at in (1..moments.len()).rev() {
        moments[at].stretch.until = until;
        if moments[at].stretch.from.0 == window.start.0 + at as u64 {
            until = moments[at].stretch.from;
        }
    }
    moments.first_mut().into_iter().for_each(|first| first.stretch.until = until);
    moments
}

/// Each cycle's moment is the model's, and the changes are the cycles in which moments differ.
fn assert_moments(recording: &Recording, batches: &[OpBatch], history: &History) {
    let window = &recording.window;
    let cycles = window.start.0 as usize..window.end.0 as usize;
    let station = |cell: usize| {
        let visits = clipped(&naive_visits(batches, cell, history), window);
        station_moments(&history.states[cell][cycles.clone()], &visits, window)
    };
    let stations: Vec<_> = (0..recording.stations.len()).map(station).collect();
    let mut changes = Vec::new();
    let mut before: Option<Moment> = None;
    for (place, cycle) in cycles.clone().enumerate() {
        let moment = recording.moment(Cycles(cycle as u64)).expect("it lies in the window");
        assert_eq!(moment.stations, stations.iter().map(|cell| cell[place]).collect::<Vec<_>>(), "cycle {cycle}");
        let levels = history.occupancies.iter().map(|fifo| Words(fifo[cycle]));
        assert_eq!(moment.levels, levels.collect::<Vec<_>>(), "cycle {cycle}");
        assert_eq!(
            moment.host.unwrap().stretch.state == MOVING,
            history.sent.contains(&(cycle as u64)),
            "cycle {cycle}"
        );
        let ends = moment.answer.is_some_and(|answer| answer.until == moment.at + Cycles(1));
        // The window may end within one.
        let cut = ends && moment.at + Cycles(1) == window.end;
        assert_eq!(ends, cut || history.returned.contains(&(cycle as u64)), "cycle {cycle}");
        if before.is_some_and(|before| Moment { at: moment.at, ..before } != moment) {
            changes.push(moment.at);
        }
        before = Some(moment);
    }
    let next = std::iter::successors(recording.next_change(Cycles(0)), |&change| recording.next_change(change));
    assert_eq!(next.collect::<Vec<_>>(), changes);
    let end = Cycles(u64::MAX);
    let previous = std::iter::successors(recording.previous_change(end), |&change| recording.previous_change(change));
    changes.reverse();
    assert_eq!(previous.collect::<Vec<_>>(), changes);
    assert_eq!((recording.moment(window.end), recording.moment(end)), (None, None));
    assert!(window.start.0 == 0 || recording.moment(window.start - Cycles(1)).is_none());
}

fn events(recording: &Recording) -> usize {
    let activity = |activity: &StationRecord| activity.states.len() + activity.jobs.len();
    let activities =
        activity(recording.host.as_ref().unwrap()) + recording.stations.iter().map(activity).sum::<usize>();
    activities + recording.answers.len()
}

fn ops(recording: &Recording) -> usize {
    recording.host.iter().chain(&recording.stations).map(|station| station.ops.len()).sum()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3_000, ..ProptestConfig::default() })]

    #[test]
    fn every_cycle_equals_the_ticking_models(
        (spec, cells, rays, per_batch) in case(),
        (start, length, most_events) in (0.0..1.1f64, 0.0..1.0f64, 40usize..2000),
    ) {
        let batches = batches_of(cells, &rays, per_batch);
        let costs = costs();
        let machine = (&spec, &costs);
        let ticked = ticking::run_recorded(&spec, &costs, &batches);
        let recorded = record(machine, &batches, ALL, usize::MAX / 2);
        prop_assert_eq!(recorded.is_some(), ticked.is_some());
        let (Some((stats, whole)), Some((ticked, history))) = (recorded, ticked) else { return Ok(()) };
        prop_assert_eq!(&Ticked::from(&stats), &ticked);
        prop_assert_eq!((&whole.window, whole.cut), (&(Cycles(0)..stats.cycles), false));
        assert_exact(&whole, &batches, &history);

        let from = (start * stats.cycles.0 as f64) as u64;
        let window = Cycles(from)..Cycles(from + 1 + (length * stats.cycles.0 as f64) as u64);
        let (_, part) = record(machine, &batches, window.clone(), usize::MAX / 2).unwrap();
        let inside = window.start.min(stats.cycles)..window.end.min(stats.cycles);
        prop_assert_eq!((&part.window, part.cut, part.ops_until), (&inside, false, inside.end));
        assert_exact(&part, &batches, &history);
        assert_steps(&part, &costs, &batches, &history);
        assert_moments(&part, &batches, &history);

        let (_, short) = record(machine, &batches, window.clone(), most_events).unwrap();
        prop_assert_eq!(short.cut, short.window != part.window);
        prop_assert!(events(&short) <= most_events && ops(&short) <= most_events);
        assert_exact(&short, &batches, &history);
        assert_steps(&short, &costs, &batches, &history);
        assert_moments(&short, &batches, &history);
        // Where it was cut depends on nothing but what happened.
        let other = batches_of(cells, &rays, 1 + per_batch % 5);
        prop_assert_eq!(short, record(machine, &other, window, most_events).unwrap().1);
    }
}

/// Real programs: the states of the whole run sum up to its statistics.
#[test]
fn states_sum_up_to_the_statistics() {
    let (scene, rays) = crate::support::scene("room", 1, 9);
    for (mode, groups) in [("pipeline", 1), ("broadcast", 3), ("hybrid", 2)] {
        let workload = crate::support::workload(&scene.mesh, &crate::support::program(mode, groups), &rays);
        let batches = crate::support::ops(&workload, &rays);
        let spec = MachineSpec { fifo_words: Words(24), ..MachineSpec::default() };
        let (stats, recording) = record((&spec, workload.costs()), &batches, ALL, usize::MAX / 2).unwrap();
        for (activity, stats) in recording.stations.iter().zip(&stats.stations) {
            for state in (0..16).map(StateId) {
                let stretches = activity.states.iter().filter(|stretch| stretch.state == state);
                assert_eq!(stretches.map(|stretch| stretch.until - stretch.from).sum::<Cycles>(), stats.of(state));
            }
            assert_eq!(activity.jobs.len(), rays.len());
        }
        assert_eq!(recording.answers.len(), rays.len());
    }
}

/// A run may be as long as it likes: what is recorded of it, and when the recorder stops, stays the same.
#[test]
fn a_longer_run_records_no_more() {
    let (scene, rays) = crate::support::scene("room", 1, 10);
    let workload = crate::support::workload(&scene.mesh, &crate::support::program("hybrid", 2), &rays);
    let batch = crate::support::ops(&workload, &rays).remove(0);
    let repeated = |repeats: usize| {
        let batches: Vec<OpBatch> = (0..repeats).map(|_| batch.clone()).collect();
        record((&MachineSpec::default(), workload.costs()), &batches, ALL, 5_000).unwrap().1
    };
    let (short, long) = (repeated(20), repeated(200));
    assert!(short.cut && events(&short) < 5_000);
    assert_eq!(short, Recording { cycles: short.cycles, ..long });
}
