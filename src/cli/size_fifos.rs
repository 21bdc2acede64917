//! `pcs-sim size-fifos`: the fewest words that FIFOs need, for a run or for a recorded trace.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pcs_sim::error::InputError;
use pcs_sim::machine::{Machine, MachineFile, Words};
use pcs_sim::report::account;
use pcs_sim::report::sizing::{self, SizesTable};
use pcs_sim::report::summary::{grouped, prose};
use pcs_sim::report::table::{self, Table};
use pcs_sim::run::{
    self, Front, Layers, OutputFile, PlannedRun, Point, Recorded, Replay, RunSpec, SLOWER, Searching, Traced, Workers,
    moot,
};
use pcs_sim::seam::{Costs, OpBatch};

use super::args::Typed;
use super::why_args::SizeArgs;
use super::{Failure, outputs, print, progress};

/// The files that the command writes, beside each other.
struct Outputs {
    csv: Option<OutputFile>,
    parquet: Option<OutputFile>,
    /// A SVG and a PNG of each picture.
    pictures: Vec<[OutputFile; 2]>,
    /// One for each point of the front.
    machines: Vec<OutputFile>,
}

/// What is sized.
struct Recording {
    title: String,
    ops: Ops,
    costs: Costs,
    machine: Machine,
    file: MachineFile,
    least_z_words: Words,
}

/// What host and cells do: in a run that was traced, or in a trace that was read.
enum Ops {
    Traced(Arc<Traced>),
    Read(Vec<OpBatch>),
}

/// Records the run or reads the trace, and searches.
pub fn size_fifos(args: &SizeArgs, typed: &Typed) -> Result<(), Failure> {
    let speeds = speeds(&args.speed)?;
    let files = Outputs::open(args, &speeds)?;
    let workers = Workers::on_all_cores();
    let tables = args.table.as_ref().map(|table| ["csv", "parquet"].map(|ending| table.with_extension(ending)));
    let named: Vec<Option<&PathBuf>> = tables.iter().flatten().map(Some).collect();
    let recording = outputs::reading(&named, || match &args.ops {
        Some(path) => of_trace(args, typed, path),
        None => of_run(args, typed, &workers),
    })?;
    recording.machine.notes.iter().for_each(super::note);
    let Recording { title, ops, costs, machine, least_z_words, .. } = &recording;
    let batches = match ops {
        Ops::Traced(traced) => traced.batches(),
        Ops::Read(batches) => batches,
    };
    let (spec, least_z_words) = (&machine.spec, *least_z_words);
    let bar = progress::waiting("sizing the FIFOs");
    let note = |Searching { replays, points }| {
        bar.set_message(format!("sizing the FIFOs: {points} of {} machines found, {replays} replays", speeds.len()));
    };
    let front = run::size_fifos(Recorded { batches, costs, spec, least_z_words }, &speeds, &workers.cancel, note)?;
    bar.finish_and_clear();
    let (machine, table) = (account::machine_line(spec), sizing::to_text(&front));
    let head = prose(&format!("FIFOs of {title}\n{machine}"));
    print(&format!("{head}\n\n{table}\n{}", sizing::sentences(&front)))?;
    print(&outputs::list(&files.write(&front, &recording)?))
}

/// A run whose ops are recorded.
fn of_run(args: &SizeArgs, typed: &Typed, workers: &Workers) -> Result<Recording, Failure> {
    let options = args.asked.options(typed);
    let base = args.config.as_deref().map(RunSpec::read).transpose()?;
    if base.as_ref().is_some_and(|base| base.image.is_some()) {
        let error = InputError::new("the configuration is that of a whole image");
        return Err(error
            .help("record it by `pcs-sim image --config FILE --ops OPS`, and take the recording by --ops OPS")
            .into());
    }
    let run = PlannedRun::new(RunSpec::new(&options, base)?)?;
    moot::check_size_fifos(&options)?;
    moot::check_run(&options, &run.spec)?;
    let spinner = progress::waiting("tracing the rays");
    let mut layers = Layers::default();
    let traced = layers.traced(&run, workers)?;
    let (scene, prepared) = (layers.scene(&run)?, layers.prepared(&run)?);
    spinner.finish_and_clear();
    scene.notes.iter().for_each(super::note);
    let workload = traced.workload();
    Ok(Recording {
        title: account::run_title(&run.spec, &scene, workload, prepared.rays.len()),
        costs: workload.costs().clone(),
        least_z_words: workload.least_z_words(),
        ops: Ops::Traced(traced),
        machine: run.machine,
        file: run.spec.machine,
    })
}

/// A recorded trace.
fn of_trace(args: &SizeArgs, typed: &Typed, path: &Path) -> Result<Recording, Failure> {
    let options = args.asked.options(typed);
    moot::check_size_fifos(&options)?;
    moot::check_size_fifos_of_trace(&options)?;
    let spinner = progress::waiting("reading the trace");
    let Replay { spec, machine, mut trace, costs } = Replay::new(Some(path), &options, None, None)?;
    let mut batches = Vec::new();
    trace.for_each_batch(|batch| {
        batches.push(batch);
        Ok::<_, InputError>(())
    })?;
    spinner.finish_and_clear();
    let title = format!("{} on {} cells: {} rays", path.display(), trace.cells(), grouped(trace.jobs()));
    Ok(Recording { title, ops: Ops::Read(batches), costs, machine, file: spec.machine, least_z_words: Words(1) })
}

/// The speeds that are asked for, as the thousandths by which a run may be slower: each once, the fastest first.
fn speeds(percent: &[f64]) -> Result<Vec<u64>, InputError> {
    if percent.is_empty() {
        return Ok(SLOWER.to_vec());
    }
    let slower = |&percent: &f64| {
        let thousandths = (1000.0 - 10.0 * percent).round();
        let possible = (50.0..=100.0).contains(&percent) && (1000.0 - thousandths - 10.0 * percent).abs() < 1e-9;
        possible.then_some(thousandths as u64).ok_or_else(|| {
            let error = InputError::new(format!("a speed of {percent} % cannot be asked for"));
            error.help("speeds are from 50 to 100 %, with one decimal at the most")
        })
    };
    let all: BTreeSet<u64> = percent.iter().map(slower).collect::<Result<_, _>>()?;
    Ok(all.into_iter().collect())
}

impl Outputs {
    fn open(args: &SizeArgs, speeds: &[u64]) -> Result<Outputs, InputError> {
        let Some(path) = &args.table else {
            return Ok(Outputs { csv: None, parquet: None, pictures: Vec::new(), machines: Vec::new() });
        };
        if !path.extension().is_some_and(|ending| ending == "csv" || ending == "parquet") {
            let error = InputError::in_file(path, "a table's name must end in .csv or .parquet");
            return Err(error.help("it is written as both, side by side"));
        }
        let create = |path: &Path| outputs::create(path, args.force);
        let beside = |ending: String| {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            path.with_file_name(format!("{stem}-{ending}"))
        };
        let picture = |name: &str| {
            Ok::<_, InputError>([create(&beside(format!("{name}.svg")))?, create(&beside(format!("{name}.png")))?])
        };
        let pictures = if args.plot { &sizing::PICTURES[..] } else { &[] };
        let machines = if args.machines { speeds } else { &[] };
        Ok(Outputs {
            csv: Some(create(&path.with_extension("csv"))?),
            parquet: Some(create(&path.with_extension("parquet"))?),
            pictures: pictures.iter().map(|name| picture(name)).collect::<Result<_, _>>()?,
            machines: machines
                .iter()
                .map(|&slower| create(&beside(format!("{}.ron", sizing::name(slower)))))
                .collect::<Result<_, _>>()?,
        })
    }

    fn write(self, front: &Front, recording: &Recording) -> Result<Vec<PathBuf>, Failure> {
        let mut written = Vec::new();
        let sizes = SizesTable::new(front, recording.machine.spec.clock());
        let (columns, rows) = (sizes.columns(), sizes.rows());
        let all = Table { columns: &columns, rows };
        outputs::finish(self.csv, &mut written, |file| table::write_csv(file, &all))?;
        outputs::finish(self.parquet, &mut written, |file| table::write_parquet(file, &all, &[]))?;
        if !self.pictures.is_empty() {
            let title = format!("FIFOs of {}", recording.title);
            let pictures = sizes.pictures(&title).map_err(|error| Failure::Output(error.to_string()))?;
            for (picture, [svg, png]) in pictures.into_iter().zip(self.pictures) {
                outputs::finish(Some(svg), &mut written, |file| file.write_all(picture.rendered.svg.as_bytes()))?;
                outputs::finish(Some(png), &mut written, |file| file.write_all(&picture.rendered.png))?;
            }
        }
        for (point, file) in front.points.iter().zip(self.machines) {
            let text = machine_text(front, point, recording)?;
            outputs::finish(Some(file), &mut written, |file| file.write_all(text.as_bytes()))?;
        }
        Ok(written)
    }
}

/// The machine file of a point of the front.
fn machine_text(front: &Front, point: &Point, recording: &Recording) -> Result<String, Failure> {
    let machine = front.machine(&point.depths.words, &recording.file);
    let text = machine.to_ron().map_err(|error| Failure::Output(format!("the machine cannot be written: {error}")))?;
    Ok(format!(
        "// The fewest words for {} % of the speed with unlimited FIFOs, found by `pcs-sim size-fifos` for\n\
         // {}: {} words, {} cycles.\n{text}",
        sizing::name(point.slower),
        recording.title,
        grouped(point.depths.total()),
        grouped(point.depths.cycles.0),
    ))
}
