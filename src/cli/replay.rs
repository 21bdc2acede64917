//! `pcs-sim replay OPS`: a recorded trace under any machine.

use std::io::Write;

use pcs_sim::machine::Array;
use pcs_sim::report::activity::ActivityTrace;
use pcs_sim::report::plot::Caption;
use pcs_sim::report::summary::{self, grouped};
use pcs_sim::report::{bottleneck, stats};
use pcs_sim::simulation;

use super::args::ReplayArgs;
use super::run::machine_line;
use super::views::{Seen, Views};
use super::watch::{Live, Watch};
use super::{Failure, outputs, print, progress, unread};

/// Times the trace and reports as a run does, but for what only the scene tells.
pub fn replay(args: &ReplayArgs) -> Result<(), Failure> {
    unread::check_replay(&args.options())?;
    let machine = pcs_sim::run::machine_file(&args.options(), None)?.build()?;
    let views = [args.views.page.as_ref(), args.views.trace.as_ref()];
    let inputs = [Some(args.ops.as_path()), args.machine_file.machine.as_deref()];
    outputs::check_distinct(&[args.results.stats.as_ref(), views[0], views[1]], &inputs)?;
    let stats_file = outputs::open(args.results.stats.as_deref(), args.results.force)?;
    let views = Views::open(&args.views, args.results.force)?;
    let spinner = progress::waiting("reading the trace");
    let mut trace = ActivityTrace::open(&args.ops)?;
    let cells = trace.cells();
    spinner.set_message("timing the trace");
    let mut live = Live::new(spinner, args.results.watch.then(|| Watch::new(&machine.spec, Vec::new())));
    let array = |limit| views.fit(Array::until(&machine.spec, cells, limit));
    let feed = |take: &mut dyn FnMut(_) -> _| trace.for_each_batch::<Failure>(take);
    let (result, observed) = simulation::replay_in(array, feed, |array| live.show(array))?;
    live.finish();
    machine.notes.iter().for_each(|note| eprintln!("note: {note}"));
    let caption = Caption {
        title: format!("replay of {} on {cells} cells: {} rays", args.ops.display(), grouped(trace.rays())),
        machine: machine_line(&machine.spec),
    };
    print(&format!(
        "{}\n{}\n{}\n\n{}\n{}\n{}\n",
        caption.title,
        caption.machine,
        summary::speed(&result, &machine.spec),
        summary::cells(&result, &[]),
        summary::fifos(&result),
        bottleneck::sentence(&result, &machine.spec),
    ))?;
    let mut written = Vec::new();
    outputs::finish(stats_file, &mut written, |file| {
        let json = stats::to_json(&result, &machine.spec, None, None)?;
        file.write_all(json.as_bytes())
    })?;
    let seen = Seen {
        caption: &caption,
        spec: &machine.spec,
        stats: &result,
        observed: &observed,
        cell_names: &[],
        configuration: None,
        image: None,
    };
    views.write(&seen, &mut written)?;
    print(&outputs::list(&written))
}
