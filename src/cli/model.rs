//! `pcs-sim model SCENE`: what the cost model says of a run, and whether it is right.

use std::convert::Infallible;
use std::io::Write;
use std::path::Path;

use pcs_sim::cancel::Cancel;
use pcs_sim::error::InputError;
use pcs_sim::model::Survey;
use pcs_sim::program::Workload;
use pcs_sim::report::losses::Losses;
use pcs_sim::report::summary::grouped;
use pcs_sim::report::{bottleneck, prediction};
use pcs_sim::run::{self, CellsRun, Layers, Outcome, PlannedRun, Prepared, RunSpec, Shuffled};
use pcs_sim::scene::Scene;

use super::args::{ModelArgs, Typed};
use super::run::{in_order, machine_line, plural, verdict, workers};
use super::{Failure, moot_flags, outputs, print, progress};

/// `pcs-sim model SCENE [...]`
pub fn model(args: &ModelArgs, typed: &Typed) -> Result<(), Failure> {
    let options = args.options(typed);
    let run = PlannedRun::new(RunSpec::new(&options, base(args)?)?)?;
    let PlannedRun { spec, machine, .. } = &run;
    let program = &spec.program;
    moot_flags::check_model(args, &options, spec)?;
    check_outputs(args, spec)?;
    let stats = outputs::open(args.results.stats.as_deref(), args.results.force)?;
    let spinner = progress::waiting("surveying the scene");
    let mut layers = Layers::default();
    let (scene, prepared) = (layers.scene(&run)?, layers.prepared(&run)?);
    let Prepared { rays, surfaces } = &*prepared;
    let array = run::array_model(program, machine);
    let sub_volumes = surfaces.sub_volumes(program, machine.times, rays, &Cancel::default())?;
    let survey = Survey::new(surfaces.polygons(), &sub_volumes, rays);
    let too_large = |error| InputError::new(format!("{error}"));
    let predicted = survey.predict(&array, program.grid_coefficient).map_err(too_large)?;
    let best = survey.best_coefficient(&array).map_err(too_large)?;
    spinner.finish_and_clear();
    for note in machine.notes.iter().chain(&scene.notes) {
        eprintln!("note: {note}");
    }
    let outcome = if args.predict_only { None } else { Some(simulate(&mut layers, &run, args.threads)?) };
    let run = outcome.as_ref().map(|(workload, outcome, _)| prediction::Run {
        workload,
        counts: &outcome.counts,
        stats: &outcome.stats,
    });
    let rows = prediction::rows(&predicted, &array, run);
    print(&format!(
        "{}\n{}\n\n{}\n{}",
        title(&scene, spec, surfaces.polygons().len(), rays.len()),
        machine_line(&machine.spec),
        prediction::to_table(&rows),
        prediction::sentences(&predicted, &best, &array),
    ))?;
    if let Some((_, outcome, losses)) = &outcome {
        print(&format!("Measured: {}\n", verdict(&outcome.stats, losses.as_ref(), machine.spec.clock())))?;
    }
    let mut written = Vec::new();
    outputs::finish(stats, &mut written, |file| {
        let json = prediction::to_json((&scene.name, spec), &rows, &predicted, &best, &array)?;
        file.write_all(json.as_bytes())
    })?;
    print(&outputs::list(&written))
}

/// The run that is predicted, if a file describes it.
fn base(args: &ModelArgs) -> Result<Option<RunSpec>, InputError> {
    let base = args.config.as_deref().map(RunSpec::read).transpose()?;
    match &base {
        Some(base) if base.image.is_some() => {
            let error = InputError::new("the configuration is that of a whole image");
            Err(error.help("the model is about primary rays: take the configuration of a run"))
        }
        Some(base) if base.cells_run == CellsRun::Programs => {
            let error = InputError::new("the configuration is that of cells that run programs");
            Err(error.help("the model is about Figure 7's times: take the configuration of a run with those"))
        }
        _ => Ok(base),
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

fn title(scene: &Scene, spec: &RunSpec, polygons: usize, rays: usize) -> String {
    let program = &spec.program;
    format!(
        "{} on {} cells in {} of {}, grid coefficient {}: scene {} ({} polygons), {} rays{}",
        program.name,
        program.cells(),
        plural(program.groups, "group"),
        program.stages.len(),
        program.grid_coefficient,
        scene.name,
        grouped(polygons as u64),
        grouped(rays as u64),
        in_order(spec.order),
    )
}
