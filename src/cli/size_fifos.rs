//! `pcs-sim size-fifos`: the fewest words that FIFOs need, for a run or for a recorded trace.

use std::io::Write;
use std::path::{Path, PathBuf};

use pcs_sim::error::InputError;
use pcs_sim::report::account;
use pcs_sim::report::sizing::{self, SizesTable};
use pcs_sim::report::summary::plural;
use pcs_sim::report::table::{self, Table};
use pcs_sim::run::{self, Front, KeptOps, Layers, OutputFile, PlannedRun, Replay, RunSpec, Searching, Workers, moot};

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
struct Sized {
    title: String,
    ops: KeptOps,
}

/// Records the run or reads the trace, and searches.
pub fn size_fifos(args: &SizeArgs, typed: &Typed) -> Result<(), Failure> {
    let speeds = run::slower(&args.speed)?;
    let files = Outputs::open(args, &speeds)?;
    let workers = Workers::on_all_cores();
    let tables = args.table.as_ref().map(|table| ["csv", "parquet"].map(|ending| table.with_extension(ending)));
    let named: Vec<Option<&PathBuf>> = tables.iter().flatten().map(Some).collect();
    let sized = outputs::reading(&named, || match &args.ops {
        Some(path) => of_trace(args, typed, path, &workers),
        None => of_run(args, typed, &workers),
    })?;
    let machine = &sized.ops.machine;
    machine.notes.iter().for_each(super::note);
    let bar = progress::waiting("sizing the FIFOs");
    let note = |Searching { replays, points }| {
        bar.set_message(format!(
            "sizing the FIFOs: {points} of {} found, {}",
            plural(speeds.len() as u64, "machine"),
            plural(replays, "replay")
        ));
    };
    let front = run::size_fifos(sized.ops.recorded(), &speeds, &workers.cancel, note)?;
    bar.finish_and_clear();
    print(&sizing::text(&front, &sized.title, machine))?;
    print(&outputs::list(&files.write(&front, &sized)?))
}

/// A run whose ops are recorded.
fn of_run(args: &SizeArgs, typed: &Typed, workers: &Workers) -> Result<Sized, Failure> {
    let options = args.asked.options(typed);
    let base = args.config.as_deref().map(RunSpec::read).transpose()?;
    let run = PlannedRun::new(RunSpec::of_sizing(&options, base)?)?;
    moot::check_size_fifos(&options)?;
    moot::check_run(&options, &run.spec)?;
    let spinner = progress::waiting("tracing the rays");
    let mut layers = Layers::default();
    let traced = layers.traced(&run, workers)?;
    let (scene, prepared) = (layers.scene(&run)?, layers.prepared(&run)?);
    spinner.finish_and_clear();
    scene.notes.iter().for_each(super::note);
    let title = account::run_title(&run.spec, &scene, traced.workload(), prepared.rays.len());
    Ok(Sized { title, ops: KeptOps::of_run(run, traced) })
}

/// A recorded trace.
fn of_trace(args: &SizeArgs, typed: &Typed, path: &Path, workers: &Workers) -> Result<Sized, Failure> {
    let options = args.asked.options(typed);
    moot::check_size_fifos(&options)?;
    moot::check_size_fifos_of_trace(&options)?;
    let spinner = progress::waiting("reading the trace");
    let replay = Replay::new(Some(path), &options, None, None)?;
    let title = account::sized_trace_title(&replay);
    let ops = KeptOps::of_trace(replay, &workers.cancel)?;
    spinner.finish_and_clear();
    Ok(Sized { title, ops })
}

impl Outputs {
    fn open(args: &SizeArgs, speeds: &[u64]) -> Result<Outputs, InputError> {
        let Some(path) = &args.table else {
            return Ok(Outputs { csv: None, parquet: None, pictures: Vec::new(), machines: Vec::new() });
        };
        table::check_name(path)?;
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

    fn write(self, front: &Front, sized: &Sized) -> Result<Vec<PathBuf>, Failure> {
        let mut written = Vec::new();
        let sizes = SizesTable::new(front, sized.ops.machine.spec.clock());
        let (columns, rows) = (sizes.columns(), sizes.rows());
        let all = Table { columns: &columns, rows };
        outputs::finish(self.csv, &mut written, |file| table::write_csv(file, &all))?;
        outputs::finish(self.parquet, &mut written, |file| table::write_parquet(file, &all, &[]))?;
        if !self.pictures.is_empty() {
            let pictures =
                sizes.pictures(&sizing::heading(&sized.title)).map_err(|error| Failure::Output(error.to_string()))?;
            for (picture, [svg, png]) in pictures.into_iter().zip(self.pictures) {
                outputs::finish(Some(svg), &mut written, |file| file.write_all(picture.rendered.svg.as_bytes()))?;
                outputs::finish(Some(png), &mut written, |file| file.write_all(&picture.rendered.png))?;
            }
        }
        for (point, file) in front.points.iter().zip(self.machines) {
            let text = sizing::machine_text(front, point, &sized.title, &sized.ops.file);
            let text = text.map_err(|error| Failure::Output(format!("the machine cannot be written: {error}")))?;
            outputs::finish(Some(file), &mut written, |file| file.write_all(text.as_bytes()))?;
        }
        Ok(written)
    }
}
