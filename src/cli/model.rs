//! `pcs-sim model SCENE`: what the cost model says of a run, and whether it is right.

use std::convert::Infallible;
use std::io::Write;

use pcs_sim::error::InputError;
use pcs_sim::geometry::Ray;
use pcs_sim::machine::Machine;
use pcs_sim::model::Survey;
use pcs_sim::program::{ArrayProgram, Workload};
use pcs_sim::report::losses::Losses;
use pcs_sim::report::summary::grouped;
use pcs_sim::report::{bottleneck, prediction};
use pcs_sim::run::{self, Outcome, RunSpec, Shuffled};
use pcs_sim::scene::Scene;

use super::args::{ModelArgs, Typed};
use super::run::{in_order, machine_line, plural, verdict, workers};
use super::{Failure, moot_flags, outputs, print, progress};

/// `pcs-sim model SCENE [...]`
pub fn model(args: &ModelArgs, typed: &Typed) -> Result<(), Failure> {
    let options = args.options(typed);
    let spec = RunSpec::new(&options, None)?;
    let (machine, program) = (spec.machine.build()?, &spec.program);
    moot_flags::check_model(args, &options, &spec)?;
    check_outputs(args)?;
    let stats = outputs::open(args.results.stats.as_deref(), args.results.force)?;
    let spinner = progress::waiting("surveying the scene");
    let scene = spec.load_scene()?;
    let rays = spec.load_rays(&scene)?;
    let array = prediction::array_model(program, &machine);
    let (polygons, sub_volumes) = Workload::sub_volumes(&scene.mesh, program, machine.times, &rays)?;
    let survey = Survey::new(&polygons, &sub_volumes, &rays);
    let too_large = |error| InputError::new(format!("{error}"));
    let predicted = survey.predict(&array, program.grid_coefficient).map_err(too_large)?;
    let best = survey.best_coefficient(&array).map_err(too_large)?;
    spinner.finish_and_clear();
    for note in machine.notes.iter().chain(&scene.notes) {
        eprintln!("note: {note}");
    }
    let outcome = if args.predict_only { None } else { Some(simulate(args, &scene, program, &machine, &rays)?) };
    let run = outcome.as_ref().map(|(workload, outcome, _)| prediction::Run {
        workload,
        counts: &outcome.counts,
        stats: &outcome.stats,
    });
    let rows = prediction::rows(&predicted, &array, run);
    print(&format!(
        "{}\n{}\n\n{}\n{}",
        title(&scene, &spec, polygons.len(), rays.len()),
        machine_line(&machine.spec),
        prediction::to_table(&rows),
        prediction::sentences(&predicted, &best, &array),
    ))?;
    if let Some((_, outcome, losses)) = &outcome {
        print(&format!("Measured: {}\n", verdict(&outcome.stats, losses.as_ref(), machine.spec.clock())))?;
    }
    let mut written = Vec::new();
    outputs::finish(stats, &mut written, |file| {
        let json = prediction::to_json((&scene.name, program), &rows, &predicted, &best, &array)?;
        file.write_all(json.as_bytes())
    })?;
    print(&outputs::list(&written))
}

fn check_outputs(args: &ModelArgs) -> Result<(), InputError> {
    let inputs = [
        Some(std::path::Path::new(&args.scene)),
        args.rays.rays.as_deref(),
        args.program.program.as_deref(),
        args.machine_file.machine.as_deref(),
    ];
    outputs::check_distinct(&[args.results.stats.as_ref()], &inputs)
}

/// The run that the model is held against.
fn simulate(
    args: &ModelArgs,
    scene: &Scene,
    program: &ArrayProgram,
    machine: &Machine,
    rays: &[Ray],
) -> Result<(Workload, Outcome, Option<Losses>), Failure> {
    let workload = Workload::new(&scene.mesh, program, machine.times, rays)?;
    let bar = progress::rays(rays.len() as u64);
    let (mut shuffled, workers) = (Shuffled::new(workload.cells()), workers(args.threads));
    let outcome = run::run(&workload, &machine.spec, rays, &workers, |batch| {
        shuffled.take(&batch.ops);
        bar.inc(batch.hits.len() as u64);
        Ok::<_, Infallible>(())
    });
    bar.finish_and_clear();
    let outcome = outcome?;
    let losses = bottleneck::losses(&outcome.stats, || shuffled.time(&machine.spec, workload.costs(), &workers.cancel));
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
