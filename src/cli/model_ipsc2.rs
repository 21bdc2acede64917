//! `pcs-sim model-ipsc2 SCENE`, or `pcs-sim model SCENE --on ipsc2`: what a sub-sample says of an image on a hypercube, and whether it is
//! right.

use std::convert::Infallible;
use std::io::Write;
use std::path::Path;

use pcs_sim::cancel::Cancel;
use pcs_sim::report::forecast::{self, Made};
use pcs_sim::run::{CubeOutcome, CubeSetup, CubeSpec, Watching, moot};

use super::args::Typed;
use super::ipsc2_args::ModelIpsc2Args;
use super::run::workers;
use super::{Failure, outputs, print, progress};

/// `pcs-sim model-ipsc2 SCENE [...]`
pub fn model(args: &ModelIpsc2Args, typed: &Typed) -> Result<(), Failure> {
    let options = args.options(typed);
    let spec = CubeSpec::new(&options, args.config.as_deref().map(CubeSpec::read).transpose()?)?;
    moot::check_cube(&options, &spec)?;
    let inputs = [Some(Path::new(&spec.scene)), args.cube.machine.as_deref(), args.config.as_deref()];
    outputs::check_distinct(&[args.stats.as_ref()], &inputs)?;
    let stats = outputs::open(args.stats.as_deref(), args.force)?;
    let spinner = progress::waiting("tracing the sub-sample");
    let named = [args.stats.as_ref()];
    let workers = workers(args.threads);
    let (machine, expected) =
        (spec.machine.build()?, outputs::reading(&named, || spec.forecast(&workers).map_err(Failure::from))?);
    spinner.finish_and_clear();
    machine.notes.iter().chain(&expected.sample.notes).map(String::as_str).for_each(super::note);
    let run = if args.predict_only { None } else { Some(simulate(spec.clone(), args.threads)?) };
    let bounds = run.as_ref().map(|(setup, outcome)| setup.bounds(outcome));
    let made = run.as_ref().zip(bounds.as_ref()).map(|((setup, outcome), bounds)| Made { setup, outcome, bounds });
    print(&forecast::text(&spec, &machine, &expected, made))?;
    let mut written = Vec::new();
    outputs::finish(stats, &mut written, |file| {
        let rows = forecast::rows(&expected, &machine, made);
        file.write_all(forecast::to_json(&spec, &expected.sample.name, &rows)?.as_bytes())
    })?;
    print(&outputs::list(&written))
}

/// The image that the model is held against.
fn simulate(spec: CubeSpec, threads: Option<u16>) -> Result<(CubeSetup, CubeOutcome), Failure> {
    let bar = progress::samples();
    bar.set_length(spec.samples() as u64);
    let setup = CubeSetup::new(spec, false, &workers(threads), |done| {
        bar.set_position(done as u64);
        Ok::<_, Infallible>(())
    });
    bar.finish_and_clear();
    let setup = setup?;
    let spinner = progress::waiting("running the nodes");
    let outcome = setup.run(&Watching::default(), &Cancel::default());
    spinner.finish_and_clear();
    Ok((setup, outcome?))
}
