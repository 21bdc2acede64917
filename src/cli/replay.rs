//! `pcs-sim replay OPS`: a recorded trace under any machine.

use std::convert::Infallible;
use std::io::Write;

use pcs_sim::error::InputError;
use pcs_sim::machine::Machine;
use pcs_sim::program::work;
use pcs_sim::report::plot::Caption;
use pcs_sim::report::stats;
use pcs_sim::report::summary::{self, grouped};
use pcs_sim::run::{self, Cancel, RunError, Watching};
use pcs_sim::seam::activity_trace::{ActivityTrace, Form};
use pcs_sim::seam::{Costs, OpBatch};

use super::args::ReplayArgs;
use super::run::{machine_line, report};
use super::views::{Seen, Views};
use super::watch::{Live, Watch};
use super::{Failure, Told, moot_flags, outputs, print, progress};

/// Times the trace and reports as a run does, but for what only the scene tells.
pub fn replay(args: &ReplayArgs, told: Told) -> Result<(), Failure> {
    moot_flags::check_replay(&args.options())?;
    let machine = pcs_sim::run::machine_file(&args.options(), None)?.build()?;
    let views = [args.views.page.as_ref(), args.views.trace.as_ref()];
    let inputs = [Some(args.ops.as_path()), args.machine_file.machine.as_deref()];
    outputs::check_distinct(&[args.results.stats.as_ref(), views[0], views[1]], &inputs)?;
    let stats_file = outputs::open(args.results.stats.as_deref(), args.results.force)?;
    let views = Views::open(&args.views, args.results.force)?;
    let spinner = progress::waiting("reading the trace");
    let mut trace = ActivityTrace::open(&args.ops, &work::cycles_vocabulary())?;
    let cells = trace.cells();
    let costs = costs(args, &machine, &trace)?;
    spinner.set_message("timing the trace");
    let mut live = Live::new(spinner, args.results.watch.then(|| Watch::new(machine.spec.clock(), Vec::new())));
    let moment = told.moment(machine.spec.clock())?;
    let watched = (&machine.spec, &Watching { moment, ..views.watching() });
    let feed = |take: &mut dyn FnMut(OpBatch) -> Result<OpBatch, RunError<Infallible>>| {
        trace.for_each_batch(|batch| take(batch).map(drop))
    };
    let (result, observed) =
        run::replay_watched(watched, (&costs, cells), &Cancel::default(), feed, |array| live.show(array))?;
    live.finish();
    machine.notes.iter().for_each(|note| eprintln!("note: {note}"));
    let caption = Caption {
        title: format!("replay of {} on {cells} cells: {} rays", args.ops.display(), grouped(trace.jobs())),
        machine: machine_line(&machine.spec),
    };
    let head = format!("{}\n{}\n{}\n", caption.title, caption.machine, summary::speed(&result, machine.spec.clock()));
    print(&report(head, told, (&result, &[]), (&observed, machine.spec.clock()))?)?;
    let mut written = Vec::new();
    outputs::finish(stats_file, &mut written, |file| {
        let json = stats::to_json(&result, observed.path.as_ref(), machine.spec.clock(), None, None)?;
        file.write_all(json.as_bytes())
    })?;
    let seen = Seen {
        caption: &caption,
        clock: machine.spec.clock(),
        stats: &result,
        observed: &observed,
        cell_names: &[],
        configuration: None,
        image: None,
    };
    views.write(&seen, &mut written)?;
    print(&outputs::list(&written))
}

/// What the trace's units cost: what they did when it was recorded, but for what the machine's file and the flags say.
fn costs(args: &ReplayArgs, machine: &Machine, trace: &ActivityTrace) -> Result<Costs, InputError> {
    let recorded = trace.costs();
    if trace.form() == Form::Cycles {
        moot_flags::check_replay_of_cycles(&args.options())?;
        return Ok(recorded.clone());
    }
    let options = args.options();
    let asked = |name: &str| args.machine_file.machine.is_some() || moot_flags::prices(&options, name);
    let price = |name: &str| work::price(name, &machine.times, machine.instructions.as_ref());
    Ok(Costs::new(recorded.vocabulary().clone(), |unit| {
        let name = recorded.vocabulary().unit(unit).map_or("", |unit| unit.name.as_str());
        price(name).filter(|_| asked(name)).unwrap_or(recorded.of(unit))
    }))
}
