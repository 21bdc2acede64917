//! `pcs-sim replay OPS`: a recorded trace under any machine.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::io::Write;

use pcs_sim::cancel::Cancel;
use pcs_sim::error::InputError;
use pcs_sim::machine::{Cycles, Machine};
use pcs_sim::program::work;
use pcs_sim::report::bottleneck;
use pcs_sim::report::plot::Caption;
use pcs_sim::report::stats::{self, Configuration};
use pcs_sim::report::summary::{self, grouped};
use pcs_sim::run::{self, ReplaySpec, RunError, RunOptions, Shuffled, Watching};
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
    let base = args.config.as_deref().map(ReplaySpec::read).transpose()?;
    let file = run::machine_file(&args.options(), base.as_ref().map(|base| &base.machine))?;
    let machine = file.build()?;
    // One of the two is required.
    let ops = args.ops.as_ref().or(base.as_ref().map(|base| &base.ops)).cloned().unwrap_or_default();
    let views = [args.views.page.as_ref(), args.views.trace.as_ref()];
    let inputs = [Some(ops.as_path()), args.config.as_deref(), args.machine_file.machine.as_deref()];
    outputs::check_distinct(&[args.results.stats.as_ref(), views[0], views[1]], &inputs)?;
    let stats_file = outputs::open(args.results.stats.as_deref(), args.results.force)?;
    let views = Views::open(&args.views, args.results.force)?;
    let spinner = progress::waiting("reading the trace");
    let mut trace = ActivityTrace::open(&ops, &work::cycles_vocabulary())?;
    let cells = trace.cells();
    let costs = costs(&args.options(), base.as_ref(), &machine, &trace)?;
    spinner.set_message("timing the trace");
    let mut live = Live::new(spinner, args.results.watch.then(|| Watch::new(machine.spec.clock(), Vec::new())));
    let moment = told.moment(machine.spec.clock())?;
    let watched = (&machine.spec, &Watching { moment, ..views.watching() });
    let (mut shuffled, cancel) = (Shuffled::new(cells), Cancel::default());
    let feed = |take: &mut dyn FnMut(OpBatch) -> Result<OpBatch, RunError<Infallible>>| {
        shuffled = Shuffled::new(cells);
        trace.for_each_batch(|batch| {
            shuffled.take(&batch);
            take(batch).map(drop)
        })
    };
    let (result, observed) = run::replay_watched(watched, (&costs, cells), &cancel, feed, |array| live.show(array))?;
    let losses = bottleneck::losses(&result, || shuffled.time(&machine.spec, &costs, &cancel));
    let losses = losses.as_ref();
    live.finish();
    machine.notes.iter().for_each(|note| eprintln!("note: {note}"));
    let caption = Caption {
        title: format!("replay of {} on {cells} cells: {} rays", ops.display(), grouped(trace.jobs())),
        machine: machine_line(&machine.spec),
    };
    let head = format!("{}\n{}\n{}\n", caption.title, caption.machine, summary::speed(&result, machine.spec.clock()));
    print(&report(head, told, (&result, losses, &[]), (&observed, machine.spec.clock()))?)?;
    let unit_cycles = match trace.form() {
        Form::Units => costs.by_name().map(|(name, cycles)| (name.to_owned(), cycles.0)).collect(),
        Form::Cycles => BTreeMap::new(),
    };
    let spec = ReplaySpec { version: env!("CARGO_PKG_VERSION").to_owned(), ops, unit_cycles, machine: file };
    let configuration = Configuration::Replay(Box::new(spec));
    let mut written = Vec::new();
    outputs::finish(stats_file, &mut written, |file| {
        let seen = (&result, observed.path.as_ref());
        let json = stats::to_json(seen, machine.spec.clock(), losses, None, &configuration)?;
        file.write_all(json.as_bytes())
    })?;
    let seen = Seen {
        caption: &caption,
        clock: machine.spec.clock(),
        stats: &result,
        losses,
        observed: &observed,
        cell_names: &[],
        configuration: &configuration,
        image: None,
    };
    views.write(&seen, &mut written)?;
    print(&outputs::list(&written))
}

/// What the trace's units cost: what they did when it was recorded, or in the replay that is repeated, but for what the
/// machine's file and the flags say.
pub fn costs(
    options: &RunOptions,
    base: Option<&ReplaySpec>,
    machine: &Machine,
    trace: &ActivityTrace,
) -> Result<Costs, InputError> {
    let recorded = trace.costs();
    if trace.form() == Form::Cycles {
        moot_flags::check_replay_of_cycles(options)?;
        return Ok(recorded.clone());
    }
    let asked = |name: &str| options.machine_file.machine.is_some() || moot_flags::prices(options, name);
    let price = |name: &str| work::price(name, &machine.times, machine.instructions.as_ref());
    Ok(Costs::new(recorded.vocabulary().clone(), |unit| {
        let name = recorded.vocabulary().unit(unit).map_or("", |unit| unit.name.as_str());
        let before = base.and_then(|base| base.unit_cycles.get(name)).map(|&cycles| Cycles(cycles));
        price(name).filter(|_| asked(name)).or(before).unwrap_or(recorded.of(unit))
    }))
}
