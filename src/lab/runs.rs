//! A run, told while it goes: how far it is, with the picture as far as it is traced, and in the end what a page shows of it.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::Json;
use axum::extract::rejection::JsonRejection;
use axum::extract::{Query, State};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::Vec3;
use pcs_sim::cancel::Cancel;
use pcs_sim::error::InputError;
use pcs_sim::geometry::Hit;
use pcs_sim::host::image;
use pcs_sim::quantities::Cycles;
use pcs_sim::report::comparison::{Comparison, Figures};
use pcs_sim::report::page::{self, Page, Shown};
use pcs_sim::report::stats::Configuration;
use pcs_sim::report::{account, bottleneck, summary};
use pcs_sim::run::{Layers, Outcome, RunError, Setup, Shuffled, Watching, Workers};
use serde::Deserialize;
use serde_json::{Value, json};

use super::Lab;
use super::request::{Asked, Pairs, received};
use super::streams::{Events, answer, whole};

/// Until then a run tells nothing: most are over by then.
const FIRST_PAUSE: Duration = Duration::from_millis(150);
/// What must pass before the picture is told again, as a multiple of the time that it took.
const PAUSE_FACTOR: u32 = 20;

/// `GET /run?...`
pub async fn run(State(lab): State<Arc<Lab>>, Query(pairs): Query<Pairs>) -> Response {
    start(lab, &pairs, false)
}

/// `GET /why?...`: the same with the critical path.
pub async fn why(State(lab): State<Arc<Lab>>, Query(pairs): Query<Pairs>) -> Response {
    start(lab, &pairs, true)
}

fn start(lab: Arc<Lab>, pairs: &Pairs, path: bool) -> Response {
    let asked = match Asked::new(&lab, pairs) {
        Ok(asked) => asked,
        Err(error) => return (StatusCode::UNPROCESSABLE_ENTITY, lab.refusal(error)).into_response(),
    };
    answer(move |events, cancel| {
        if let Err(error) = told(&lab, &asked, path, events, cancel) {
            events.tell("failed", lab.failure(error));
        }
    })
}

/// Runs what is asked for, and tells of it.
fn told(lab: &Lab, asked: &Asked, path: bool, events: &Events, cancel: Cancel) -> Result<(), RunError<Infallible>> {
    let begun = Instant::now();
    let workers = Workers { threads: lab.threads, cancel };
    let mut layers = lab.benches.layers(&asked.planned);
    let replayed = layers.kept(&asked.planned).is_some();
    let done = done(lab, asked, path, events, &workers, &mut layers);
    // Also of one that was stopped: the next one has the same scene.
    lab.benches.keep(&asked.planned, layers);
    let Done { setup, outcome, shown, speed, bottleneck, stats } = done?;
    events.tell("text", shown.body);
    events.tell("figures", shown.data);
    let seconds = setup.machine.spec.seconds(outcome.stats.cycles);
    let told = json!({
        "title": account::title(&setup),
        "speed": speed,
        "bottleneck": bottleneck,
        "notes": setup.notes().collect::<Vec<_>>(),
        "command": asked.command,
        "moot": asked.moot,
        "cycles": outcome.stats.cycles.0,
        "seconds": seconds,
        "rays_per_second": if seconds > 0.0 { outcome.stats.jobs as f64 / seconds } else { 0.0 },
        "replayed": replayed,
        "took_ms": begun.elapsed().as_secs_f64() * 1e3,
        "stats": stats,
    });
    events.tell("done", told.to_string());
    // Whoever has stopped looking needs none of this.
    if let Some(recording) = outcome.observed.recording.as_ref().filter(|_| workers.cancel.check().is_ok()) {
        let looks = page::looks(&setup, recording).map_err(|error| InputError::new(error.to_string()))?;
        events.tell("looks", looks);
    }
    Ok(())
}

/// A run that is over.
struct Done {
    setup: Setup,
    outcome: Outcome,
    shown: Shown,
    speed: String,
    bottleneck: String,
    stats: Value,
}

fn done(
    lab: &Lab,
    asked: &Asked,
    path: bool,
    events: &Events,
    workers: &Workers,
    layers: &mut Layers,
) -> Result<Done, RunError<Infallible>> {
    let planned = &asked.planned;
    let mut setup = Setup::new(planned.clone(), layers, &workers.cancel)?;
    // What is told of it names a file as its user does.
    setup.spec.scene = lab.uploads.as_named(&setup.spec.scene);
    let watching =
        Watching { profile: true, recording: Some(Cycles(0)..Cycles(u64::MAX)), path, ..Watching::default() };
    let mut growing = Growing::new(&setup, events);
    let room = lab.benches.room();
    let mut outcome = layers.run(planned, &watching, (workers, room.memory), |_, hits| growing.take(hits))?;
    let (spec, costs) = (&setup.machine.spec, setup.workload.costs());
    let losses = bottleneck::losses(&outcome.stats, || {
        let mut shuffled = Shuffled::new(setup.workload.cells());
        layers.kept(planned)?.batches().iter().for_each(|batch| shuffled.take(batch));
        shuffled.time(spec, costs, &workers.cancel)
    });
    let losses = losses.as_ref();
    let picture = growing.whole(&outcome.hits);
    let (configuration, clock) = (Configuration::new(&setup), spec.clock());
    let unmade = |error: &dyn std::fmt::Display| InputError::new(error.to_string());
    let Some(profile) = outcome.observed.profile.take() else { return Err(unmade(&"nothing was seen").into()) };
    let shown = page::shown(&Page {
        caption: &account::caption(account::title(&setup), &setup),
        clock,
        stats: &outcome.stats,
        losses,
        profile: &profile,
        recording: outcome.observed.recording.as_ref(),
        path: outcome.observed.path.as_ref(),
        cell_names: &account::cell_names(&setup.workload),
        configuration: &configuration,
        image: Some(&picture),
        setup: None,
    });
    let stats = account::stats_json(&setup, &outcome, losses).and_then(|text| serde_json::from_str(&text));
    Ok(Done {
        shown: shown.map_err(|error| unmade(&error))?,
        speed: summary::speed(&outcome.stats, clock),
        bottleneck: bottleneck::sentence(&outcome.stats),
        stats: stats.map_err(|error| unmade(&error))?,
        setup,
        outcome,
    })
}

/// The picture as far as it is traced.
struct Growing<'a> {
    setup: &'a Setup,
    events: &'a Events,
    pixels: Vec<Vec3>,
    traced: usize,
    due: Instant,
}

impl<'a> Growing<'a> {
    fn new(setup: &'a Setup, events: &'a Events) -> Growing<'a> {
        let pixels = vec![Vec3::ZERO; setup.prepared.count()];
        Growing { setup, events, pixels, traced: 0, due: Instant::now() + FIRST_PAUSE }
    }

    /// Takes the next rays' hits, and tells how far the picture is if that is due.
    fn take(&mut self, hits: &[Hit]) {
        let Setup { scene, workload, prepared, .. } = self.setup;
        let rays = &prepared.rays[self.traced..self.traced + hits.len()];
        for (at, pixel) in (self.traced..).zip(image::preview(scene, workload.polygons(), rays, hits)) {
            self.pixels[prepared.number(at)] = pixel;
        }
        self.traced += hits.len();
        if Instant::now() < self.due {
            return;
        }
        let start = Instant::now();
        let told = json!({ "rays": self.traced, "of": prepared.rays.len(), "image": STANDARD.encode(self.png()) });
        self.events.tell_now("progress", told.to_string());
        self.due = Instant::now() + (PAUSE_FACTOR * start.elapsed()).max(FIRST_PAUSE);
    }

    /// The whole picture, as PNG.
    fn whole(mut self, hits: &[Hit]) -> Vec<u8> {
        // Not all of it has been traced now, or some pixels' rays are never sent.
        if self.traced < self.pixels.len() {
            self.pixels = self.setup.preview(hits);
        }
        self.png()
    }

    fn png(&self) -> Vec<u8> {
        let mut png = Vec::new();
        match image::write_png(&mut png, self.setup.spec.size, &self.pixels) {
            Ok(()) => png,
            Err(_) => Vec::new(),
        }
    }
}

/// Two runs' statistics.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pair {
    a: Value,
    b: Value,
}

/// Bytes of two runs' statistics that are compared: those of arrays of thousands of cells have some.
pub const MOST_COMPARED: usize = 32_000_000;

/// `POST /compare`: in what two runs differ, as the command tells it.
pub async fn compare(State(lab): State<Arc<Lab>>, sent: Result<Json<Pair>, JsonRejection>) -> Response {
    let too_long = || {
        let error =
            InputError::new(format!("the lab compares up to {} Mbyte of statistics", MOST_COMPARED / 1_000_000));
        error.help("`pcs-sim compare` takes more")
    };
    let Pair { a, b } = match received(&lab, sent, too_long) {
        Ok(pair) => pair,
        Err(refusal) => return refusal.into_response(),
    };
    whole(lab.turns.clone(), move |_| Comparison::new(Figures::new(a), Figures::new(b)).summary().into_response()).await
}
