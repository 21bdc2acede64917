//! `pcs-sim why`: why a run, or a recorded trace, took as long as it did.

use super::args::{ReplayArgs, RunArgs, Typed, WhyArgs};
use super::{Failure, Told, moot_flags, replay, run};

/// Times the trace or the scene's rays, and tells the critical path.
pub fn why(args: &WhyArgs, typed: &Typed) -> Result<(), Failure> {
    let told = Told::Why { by_cell: args.by_cell };
    let mut of_run = args.run.clone();
    of_run.views.why = true;
    let Some(ops) = args.recorded.clone() else { return run::run(&of_run, typed, told) };
    moot_flags::check_why(&of_run, &of_run.options(typed))?;
    let RunArgs { machine_file, machine, results, views, .. } = of_run;
    replay::replay(&ReplayArgs { ops, machine_file, machine, results, views }, told)
}
