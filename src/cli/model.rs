//! `pcs-sim model SCENE`: what the cost model says of a run, and whether it is right.

use std::convert::Infallible;
use std::io::Write;
use std::path::Path;

use pcs_sim::cancel::Cancel;
use pcs_sim::error::InputError;
use pcs_sim::program::Workload;
use pcs_sim::report::losses::Losses;
use pcs_sim::report::summary::prose;
use pcs_sim::report::{account, bottleneck, prediction};
use pcs_sim::run::{self, Layers, Outcome, PlannedRun, RunSpec, Shuffled, moot};

use super::args::{ModelArgs, Typed};
use super::run::workers;
use super::{Failure, outputs, print, progress};

/// `pcs-sim model SCENE [...]`
pub fn model(args: &ModelArgs, typed: &Typed) -> Result<(), Failure> {
    let options = args.options(typed);
    let base = args.config.as_deref().map(RunSpec::read).transpose()?;
    let run = PlannedRun::new(RunSpec::of_model(&options, base)?)?;
    let PlannedRun { spec, machine, .. } = &run;
    check_threads(args)?;
    moot::check_model(&options, spec, args.predict_only)?;
    check_outputs(args, spec)?;
    let stats = outputs::open(args.results.stats.as_deref(), args.results.force)?;
    let spinner = progress::waiting("surveying the scene");
    let mut layers = Layers::default();
    let forecast = outputs::reading(&[args.results.stats.as_ref()], || layers.forecast(&run, &Cancel::default()))?;
    let scene = layers.scene(&run)?;
    spinner.finish_and_clear();
    for note in machine.notes.iter().chain(&scene.notes) {
        super::note(note);
    }
    let outcome = if args.predict_only { None } else { Some(simulate(&mut layers, &run, args.threads)?) };
    let run = outcome.as_ref().map(|(workload, outcome, _)| prediction::Run {
        workload,
        counts: &outcome.counts,
        stats: &outcome.stats,
    });
    let rows = prediction::rows(&forecast, run);
    print(&account::model_text((&scene, spec, machine), &forecast, &rows))?;
    if let Some((_, outcome, losses)) = &outcome {
        let verdict = account::verdict(&outcome.stats, losses.as_ref(), machine.spec.clock());
        print(&prose(&format!("Measured: {verdict}\n")))?;
    }
    let mut written = Vec::new();
    outputs::finish(stats, &mut written, |file| {
        let json = prediction::to_json((&scene.name, spec), &rows, &forecast)?;
        file.write_all(json.as_bytes())
    })?;
    print(&outputs::list(&written))
}

/// Refuses threads for what is not simulated.
fn check_threads(args: &ModelArgs) -> Result<(), InputError> {
    match args.threads.filter(|_| args.predict_only) {
        Some(_) => Err(InputError::new(format!("--threads {}", moot::WITHOUT_RUN)).help("leave out one of the two")),
        None => Ok(()),
    }
}

fn check_outputs(args: &ModelArgs, spec: &RunSpec) -> Result<(), InputError> {
    let inputs = [
        Some(Path::new(&spec.scene)),
        spec.rays.as_deref(),
        args.config.as_deref(),
        args.program.program.as_deref(),
        args.machine_file.machine.as_deref(),
    ];
    outputs::check_distinct(&[args.results.stats.as_ref()], &inputs)
}

/// The run that the model is held against.
fn simulate(
    layers: &mut Layers,
    run: &PlannedRun,
    threads: Option<u16>,
) -> Result<(Workload, Outcome, Option<Losses>), Failure> {
    let workers = workers(threads);
    let (workload, prepared) = (layers.workload(run, &workers.cancel)?, layers.prepared(run)?);
    let bar = progress::rays(prepared.rays.len() as u64);
    let mut shuffled = Shuffled::new(workload.cells());
    let outcome = run::run(&workload, &run.machine.spec, &prepared.rays, &workers, |batch| {
        shuffled.take(&batch.ops);
        bar.inc(batch.hits.len() as u64);
        Ok::<_, Infallible>(())
    });
    bar.finish_and_clear();
    let (outcome, spec) = (outcome?, &run.machine.spec);
    let losses = bottleneck::losses(&outcome.stats, || shuffled.time(spec, workload.costs(), &workers.cancel));
    Ok((workload, outcome, losses))
}
