//! Runs done, with their progress told and their ops written.

use std::path::PathBuf;

use pcs_sim::geometry::Hit;
use pcs_sim::machine::Observed;
use pcs_sim::measure::Measured;
use pcs_sim::report::bottleneck;
use pcs_sim::report::losses::Losses;
use pcs_sim::run::{self, Outcome, OutputFile, Rendered, Replay, Seen, Setup, Shuffled, Switch, Timed, Watching};
use pcs_sim::seam::activity_trace::{Form, TraceWriter};

use crate::outputs;
use crate::trouble::Trouble;
use crate::work::Task;

/// Where the ops go while they are worked out.
pub struct Ops {
    pub path: PathBuf,
    pub form: Form,
    pub force: bool,
}

/// What is lost against the busiest cell's work, if that is worth a word.
pub type Lost = Option<Losses>;

/// Traces primary rays and times them.
pub fn trace(
    setup: &Setup,
    watching: &Watching,
    ops: Option<(&Ops, OutputFile)>,
    task: &Task,
) -> Result<(Outcome, Lost, Option<OutputFile>), Trouble> {
    let mut writer = writer(setup, ops)?;
    let (rays, mut shuffled) = (&setup.prepared.rays, Shuffled::new(setup.workload.cells()));
    task.set(0, rays.len() as u64);
    let outcome =
        run::run_watched(&setup.workload, (&setup.machine.spec, watching), rays, &task.workers, |batch, _| {
            task.add(batch.hits.len() as u64);
            shuffled.take(&batch.ops);
            writer.as_mut().map_or(Ok(()), |writer| writer.write(&batch.ops))
        })?;
    let losses = losses(setup, &outcome.stats, &shuffled, task);
    Ok((outcome, losses, writer.map(TraceWriter::into_inner)))
}

fn losses(setup: &Setup, stats: &Measured, shuffled: &Shuffled, task: &Task) -> Lost {
    let (spec, costs) = (&setup.machine.spec, setup.workload.costs());
    bottleneck::losses(stats, || shuffled.time(spec, costs, &task.workers.cancel))
}

fn writer(setup: &Setup, ops: Option<(&Ops, OutputFile)>) -> Result<Option<TraceWriter<OutputFile>>, Trouble> {
    let (cells, costs) = (setup.workload.cells(), setup.workload.costs());
    let new = |(ops, file): (&Ops, OutputFile)| {
        TraceWriter::new(file, cells, costs.clone(), ops.form).map_err(|error| outputs::unwritten(&ops.path, error))
    };
    ops.map(new).transpose()
}

/// Makes an image: with the hits, in the order in which the host sent the rays.
pub fn render(
    setup: &Setup,
    watching: &Watching,
    ops: Option<(&Ops, OutputFile)>,
    task: &Task,
) -> Result<(Rendered, Lost, Vec<Hit>, Option<OutputFile>), Trouble> {
    let mut shuffled = Shuffled::new(setup.workload.cells());
    let (mut writer, mut hits, image) = (writer(setup, ops)?, Vec::new(), setup.image());
    let timed = (image.timing == Switch::On).then(|| Timed {
        spec: &setup.machine.spec,
        rules: image.host_rules(setup.spec.order),
        watching: watching.clone(),
    });
    let rendered = run::render(&setup.picture(), timed, &task.workers, |seen| match seen {
        Seen::Samples { done, of, .. } => {
            task.set(done as u64, of as u64);
            Ok(())
        }
        Seen::Grown(..) => Ok(()),
        Seen::Sent(ops, hit, _) => {
            hits.push(*hit);
            shuffled.take(ops);
            writer.as_mut().map_or(Ok(()), |writer| writer.write(ops))
        }
    })?;
    let losses = rendered.timing.as_ref().and_then(|timing| losses(setup, &timing.stats, &shuffled, task));
    Ok((rendered, losses, hits, writer.map(TraceWriter::into_inner)))
}

/// Times a trace.
pub fn time(replay: &mut Replay, watching: &Watching, task: &Task) -> Result<(Measured, Lost, Observed), Trouble> {
    let cancel = &task.workers.cancel;
    let (stats, observed, shuffled) = replay.time(watching, cancel, |_| ())?;
    let losses = bottleneck::losses(&stats, || shuffled.time(&replay.machine.spec, &replay.costs, cancel));
    Ok((stats, losses, observed))
}
