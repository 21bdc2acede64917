//! `pcs-sim why`: why a run, or a recorded trace, took as long as it did.

use pcs_sim::error::InputError;
use pcs_sim::run::moot;

use super::args::{Asked, ReplayArgs, RunArgs, Typed};
use super::why_args::WhyArgs;
use super::{Failure, MomentOf, Told, replay, run};

/// Times the trace or the scene's rays, and tells the critical path, or what happens in one moment.
pub fn why(args: &WhyArgs, typed: &Typed) -> Result<(), Failure> {
    let told = told(args)?;
    let mut of_run = args.run.clone();
    of_run.views.why = true;
    let Some(ops) = args.recorded.clone() else { return run::run(&of_run, typed, told) };
    check_others(&of_run)?;
    moot::check_why(&of_run.asked.options(typed))?;
    let RunArgs { asked: Asked { machine_file, machine, .. }, results, views, .. } = of_run;
    replay::replay(&ReplayArgs { ops: Some(ops), config: None, machine_file, machine, results, views }, told)
}

/// Refuses the results of a run beside a trace that is timed again.
fn check_others(args: &RunArgs) -> Result<(), InputError> {
    let others = [
        ("--config", args.config.is_some()),
        ("--image", args.image.is_some()),
        ("--hits", args.tracing.hits.is_some()),
        ("--ops", args.tracing.ops.is_some()),
        ("--threads", args.tracing.threads.is_some()),
    ];
    match others.iter().find(|(_, typed)| *typed) {
        Some((flag, _)) => {
            Err(InputError::new(format!("{flag} {}", moot::WITHOUT_SCENE)).help("leave out one of the two"))
        }
        None => Ok(()),
    }
}

fn told(args: &WhyArgs) -> Result<Told, InputError> {
    let moment = args.at.map(MomentOf::At).or(args.ray.map(MomentOf::Ray));
    match (args.cell, moment) {
        (Some(_), Some(_)) if args.run.views.enough => {
            Err(InputError::new("--enough is about the whole run, and --cell about one moment")
                .help("leave out one of the two"))
        }
        (Some(cell), Some(moment)) => Ok(Told::Moment(cell, moment)),
        (Some(_), None) => {
            let error = InputError::new("--cell is about one moment, and none is given");
            Err(error.help("say which: --at 12.3ms, --at CYCLE or --ray N; the times of all cells tells --by-cell"))
        }
        (None, _) => Ok(Told::Why { by_cell: args.by_cell }),
    }
}
