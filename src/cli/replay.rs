//! `pcs-sim replay OPS`: a recorded trace under any machine.

use std::io::Write;

use pcs_sim::cancel::Cancel;
use pcs_sim::measure::Shape;
use pcs_sim::report::stats::Configuration;
use pcs_sim::report::{account, bottleneck};
use pcs_sim::run::{self, Replay, ReplaySpec, Watching, moot};

use super::args::ReplayArgs;
use super::run::report;
use super::views::{Seen, Views};
use super::watch::{Live, Watch};
use super::{Failure, Told, outputs, print, progress};

/// Times the trace and reports as a run does, but for what only the scene tells.
pub fn replay(args: &ReplayArgs, told: Told) -> Result<(), Failure> {
    let options = args.options();
    moot::check_replay(&options)?;
    let base = args.config.as_deref().map(ReplaySpec::read).transpose()?;
    run::machine_file(&options, base.as_ref().map(|base| &base.machine))?.build()?;
    // One of the two is required.
    let ops = Replay::ops_of(args.ops.as_deref(), base.as_ref());
    let views = [args.views.page.as_ref(), args.views.trace.as_ref()];
    let inputs = [Some(ops.as_path()), args.config.as_deref(), args.machine_file.machine.as_deref()];
    outputs::check_distinct(&[args.results.stats.as_ref(), views[0], views[1]], &inputs)?;
    let stats_file = outputs::open(args.results.stats.as_deref(), args.results.force)?;
    let views = Views::open(&args.views, args.results.force)?;
    let spinner = progress::waiting("reading the trace");
    let mut replay = Replay::new(Some(&ops), &options, base.as_ref(), None)?;
    let clock = replay.machine.spec.clock();
    spinner.set_message("timing the trace");
    let mut live = Live::new(spinner, args.results.watch.then(|| Watch::new(clock, Vec::new())));
    let (moment, cancel) = (told.moment(clock)?, Cancel::default());
    let (result, observed, shuffled) =
        replay
            .time(&Watching { moment, ..views.watching(Shape::Line) }, &cancel, |array| live.show(|| array.so_far()))?;
    let losses = bottleneck::losses(&result, || shuffled.time(&replay.machine.spec, &replay.costs, &cancel));
    let losses = losses.as_ref();
    live.finish();
    replay.machine.notes.iter().for_each(super::note);
    let head = account::replay_head(&replay, &result);
    print(&report(head, told, (&result, losses, &[]), (&observed, clock))?)?;
    let mut written = Vec::new();
    outputs::finish(stats_file, &mut written, |file| {
        file.write_all(account::replay_stats_json(&replay, (&result, observed.path.as_ref()), losses)?.as_bytes())
    })?;
    let seen = Seen {
        caption: &account::replay_caption(&replay),
        clock,
        stats: &result,
        losses,
        observed: &observed,
        cell_names: &[],
        configuration: &Configuration::Replay(Box::new(replay.spec.clone())),
        regions: None,
        image: None,
        setup: None,
    };
    views.write(&seen, &mut written)?;
    print(&outputs::list(&written))
}
