//! The rays on their way: time across, the array down, a stair for each ray. What holds it up is what is long.

use std::collections::BTreeMap;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::Caption;
use super::chart::{self, FOOT, HEAD, LEFT, SMALL, WIDTH, font, rgb};
use super::render::{Drawn, Figure};
use crate::measure::{Actor, Clock, JobSpan, Recording, StateKind, StationRecord};
use crate::quantities::Cycles;
use crate::report::palette::{self, Rgb};
use crate::report::summary::grouped;
use crate::report::time_unit::TimeUnit;

/// Rays that come back, and stretches and passages, that a picture shows at the most: what can be followed by eye.
const MOST_RAYS: usize = 64;
const MOST_SHAPES: usize = 40_000;

/// Height of all lanes together, about, and of one.
const LANES: u32 = 960;
const HIGHEST_LANE: u32 = 72;
const LOWEST_LANE: u32 = 4;
const LOWEST_WITH_FIFOS: u32 = 6;
/// Names stand no closer than this.
const NAME: u32 = 14;

/// The rays of a recording on their way.
pub struct SpaceTime<'a> {
    caption: &'a Caption,
    clock: Clock,
    recording: &'a Recording,
    shown: Range<Cycles>,
}

/// A row of the picture: who it is, what it was at, and when it was at each job.
struct Lane<'a> {
    name: String,
    actor: Actor,
    record: Option<&'a StationRecord>,
    jobs: &'a [JobSpan],
}

/// A way of a job through the picture: times, and depths in lanes.
type Way = Vec<(Cycles, f64)>;

/// The channel that rays go down on, and the one of their answers.
const RAYS: &str = "X";
const ANSWERS: &str = "Y";

/// What a station is at while it has a ray, as far as that is told apart.
const KINDS: [(&str, &[StateKind], Rgb); 3] = [
    ("works on a ray", &[StateKind::Works, StateKind::Moves], palette::RANGE),
    ("waits for words", &[StateKind::Waits], palette::WAITS[0]),
    ("blocked", &[StateKind::Blocked], palette::FULL),
];

impl<'a> SpaceTime<'a> {
    pub fn new(caption: &'a Caption, clock: Clock, recording: &'a Recording) -> SpaceTime<'a> {
        let ray = recording.answers.get(MOST_RAYS - 1).map_or(recording.window.end, |answer| answer.until);
        let end = ray.min(end_of_shapes(recording)).min(recording.window.end);
        SpaceTime { caption, clock, recording, shown: recording.window.start..end }
    }

    /// From the host as it sends, over the stations, to the host as it takes answers.
    fn lanes(&self) -> Vec<Lane<'a>> {
        let Recording { host, answers, stations, topology, .. } = self.recording;
        let sends = host.as_ref().map(|host| (host, &host.jobs));
        let lane = |name: String, actor, seen: Option<(&'a StationRecord, &'a Vec<JobSpan>)>| Lane {
            name,
            actor,
            record: seen.map(|seen| seen.0),
            jobs: seen.map_or(&[], |seen| seen.1),
        };
        let station = |(index, record): (usize, &'a StationRecord)| {
            lane(topology.station(index), Actor::Station(index), Some((record, &record.jobs)))
        };
        let first = lane("host sends".to_owned(), Actor::Host, sends);
        let last = Lane { jobs: answers, ..lane("host reads".to_owned(), Actor::Host, None) };
        [first].into_iter().chain(stations.iter().enumerate().map(station)).chain([last]).collect()
    }

    /// What is drawn in the lane of a station: its jobs, by what it is at.
    fn stretches(&self, lane: &Lane<'_>) -> Vec<(Cycles, Cycles, Rgb)> {
        let states = &self.recording.topology.states;
        let color = |kind: StateKind| KINDS.iter().find(|(_, kinds, _)| kinds.contains(&kind)).map(|kind| kind.2);
        let Some(record) = lane.record else {
            let works = |job: &JobSpan| (job.from, job.until.min(self.shown.end), palette::RANGE);
            return lane.jobs.iter().filter(|job| job.from < self.shown.end).map(works).collect();
        };
        let mut jobs = lane.jobs.iter().peekable();
        let mut drawn: Vec<(Cycles, Cycles, Rgb)> = Vec::new();
        for stretch in record.states.iter().filter(|stretch| stretch.from < self.shown.end) {
            while jobs.next_if(|job| job.until <= stretch.from).is_some() {}
            let of_job = jobs.peek().is_some_and(|job| job.from <= stretch.from);
            let kind = states.get(stretch.state).map(|state| state.kind);
            let Some(color) = kind.filter(|_| of_job).and_then(color) else { continue };
            let until = stretch.until.min(self.shown.end);
            match drawn.last_mut() {
                Some(last) if last.1 == stretch.from && last.2 == color => last.1 = until,
                _ => drawn.push((stretch.from, until, color)),
            }
        }
        drawn
    }

    /// The ways of all jobs on one channel: into each FIFO with the first word that is written to it; out of it as the reader
    /// begins with the job, or, where it has begun before, with the last word.
    fn ways(&self, group: &str, lanes: &[Lane<'_>]) -> Vec<Way> {
        let mut ways: BTreeMap<u32, Way> = BTreeMap::new();
        let station = station_part(lanes.len());
        for (index, pair) in lanes.windows(2).enumerate() {
            let Some(place) = self.recording.topology.fifo_of(group, pair[1].actor) else { continue };
            let begun: BTreeMap<u32, Cycles> = pair[1].jobs.iter().map(|job| (job.job, job.from)).collect();
            for job in &self.recording.fifos[place].jobs {
                let read = Cycles(job.until.0.saturating_sub(1));
                let read = begun.get(&job.job).copied().filter(|begun| *begun >= job.from).unwrap_or(read);
                let way = ways.entry(job.job).or_default();
                way.extend([(job.from, index as f64 + station), (read, (index + 1) as f64)]);
                way.extend((pair[1].actor == Actor::Host).then_some((read, (index + 1) as f64 + station)));
            }
        }
        ways.into_values().collect()
    }

    fn seconds(&self, cycles: Cycles, unit: TimeUnit) -> f64 {
        self.clock.seconds(cycles) / unit.seconds
    }
}

/// The cycle before which no more stretches and passages begin than can be drawn.
fn end_of_shapes(recording: &Recording) -> Cycles {
    let states = recording.stations.iter().flat_map(|station| station.states.iter().map(|stretch| stretch.from));
    let passages = recording.fifos.iter().flat_map(|fifo| fifo.jobs.iter().map(|job| job.from));
    let mut starts: Vec<Cycles> = states.chain(passages).collect();
    if starts.len() <= MOST_SHAPES { recording.window.end } else { *starts.select_nth_unstable(MOST_SHAPES).1 }
}

fn lane_height(lanes: usize) -> u32 {
    (LANES / lanes.max(1) as u32).clamp(LOWEST_LANE, HIGHEST_LANE)
}

/// The part of a lane that is the station's, in whole pixels, so that all are as high; the rest is that of the FIFOs behind it,
/// for which low lanes have no room.
fn station_part(lanes: usize) -> f64 {
    match lane_height(lanes) {
        height if height < LOWEST_WITH_FIFOS => 1.0,
        height => f64::from(2 * height / 5) / f64::from(height),
    }
}

impl Figure for SpaceTime<'_> {
    fn size(&self) -> (u32, u32) {
        let lanes = self.recording.stations.len() + 2;
        (WIDTH, HEAD + 8 + lanes as u32 * lane_height(lanes) + FOOT)
    }

    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB> {
        let job = &self.recording.topology.names.job;
        let what = format!(
            "{}s on their way: cycles {} to {} of {}",
            super::rays::capital(job),
            grouped(self.shown.start.0),
            grouped(self.shown.end.0),
            grouped(self.recording.cycles.0)
        );
        let (ray, hit) = (format!("{job} on X"), "its words on Y".to_owned());
        let told: Vec<(&str, Rgb)> = KINDS.iter().map(|&(name, _, color)| (name, color)).collect();
        let legend = [(ray.as_str(), palette::AMOUNT), (hit.as_str(), palette::ANSWER)];
        chart::head(area, self.caption, &what, &[&legend[..], &told].concat())?;
        let lanes = self.lanes();
        let station = station_part(lanes.len());
        let (height, unit) = (lane_height(lanes.len()), TimeUnit::of(self.clock.seconds(self.shown.end)));
        let (start, end) = (self.seconds(self.shown.start, unit), self.seconds(self.shown.end, unit));
        let mut builder = ChartBuilder::on(area);
        let across = start..end.max(start + f64::MIN_POSITIVE.max(start * 1e-9));
        let right = chart::right_of(area, &across);
        builder.margin_top(HEAD + 8).margin_right(right).y_label_area_size(LEFT).x_label_area_size(FOOT);
        // From the top down.
        let mut chart = builder.build_cartesian_2d(across, lanes.len() as f64..0.0)?;
        let mut mesh = chart.configure_mesh();
        mesh.disable_y_mesh().light_line_style(WHITE).x_label_formatter(&chart::number).label_style(font(SMALL));
        let cycles = grouped((unit.seconds / self.clock.seconds(Cycles(1))).round() as u64);
        let label = format!("simulated time ({}, of {cycles} cycles)", unit.name);
        mesh.axis_desc_style(font(SMALL)).x_labels(chart::ACROSS).y_labels(0).x_desc(label).draw()?;
        let style = font(SMALL.min(height.max(NAME - 1))).pos(Pos::new(HPos::Right, VPos::Center));
        for (index, lane) in lanes.iter().enumerate().step_by(NAME.div_ceil(height).max(1) as usize) {
            let (x, y) = chart.backend_coord(&(start, index as f64 + station / 2.0));
            area.draw_text(&lane.name, &style, (x - 8, y))?;
        }
        for (index, lane) in lanes.iter().enumerate() {
            let (top, bottom) = (index as f64, index as f64 + station);
            for (from, until, color) in self.stretches(lane) {
                let corners = [(self.seconds(from, unit), top), (self.seconds(until, unit), bottom)];
                chart.draw_series([Rectangle::new(corners, rgb(color).filled())])?;
            }
        }
        for (group, color) in [(RAYS, palette::AMOUNT), (ANSWERS, palette::ANSWER)] {
            for way in self.ways(group, &lanes) {
                let inside = way.into_iter().take_while(|place| place.0 <= self.shown.end);
                let places: Vec<_> = inside.map(|(at, depth)| (self.seconds(at, unit), depth)).collect();
                chart.draw_series([PathElement::new(places, rgb(color))])?;
            }
        }
        Ok(())
    }
}
