//! The main job: a scene, an array program and a machine, run.

use std::io::Write;
use std::path::{Path, PathBuf};

use pcs_sim::error::InputError;
use pcs_sim::geometry::Ray;
use pcs_sim::host::{camera, image, ray_file};
use pcs_sim::isa::{InstructionCycles, Processor};
use pcs_sim::machine::{Array, MachineSpec};
use pcs_sim::program::cells::CellOptions;
use pcs_sim::program::{ArrayProgram, Kernel, Machine, MachineFile, Workload};
use pcs_sim::report::files::OutputFile;
use pcs_sim::report::plot::Caption;
use pcs_sim::report::stats::Configuration;
use pcs_sim::report::summary::{self, grouped};
use pcs_sim::report::{bottleneck, hits, stats};
use pcs_sim::scene::{ReadOptions, Scene, builtin};
use pcs_sim::seam::activity_trace::{Form, TraceWriter};
use pcs_sim::simulation::{self, Outcome, RunError};

use super::args::{CellArgs, CellsRun, MachineArgs, Mode, ProgramArgs, RunArgs, ShapeArgs};
use super::views::{Seen, Views};
use super::watch::{Live, Watch};
use super::{Failure, outputs, print, progress, unread};

/// The files that a run writes.
struct Outputs {
    stats: Option<OutputFile>,
    hits: Option<OutputFile>,
    ops: Option<OutputFile>,
    image: Option<OutputFile>,
    views: Views,
}

/// What a run is made of.
struct Setup {
    scene: Scene,
    program: ArrayProgram,
    machine_file: MachineFile,
    machine: Machine,
    rays: Vec<Ray>,
    workload: Workload,
}

/// `pcs-sim [--mode ...] [...]`
pub fn run(args: &RunArgs) -> Result<(), Failure> {
    let machine_file = machine_file(&args.machine)?;
    let machine = machine_file.build()?;
    let program = array_program(&args.program)?;
    unread::check_run(args, &program)?;
    let mut files = open_outputs(args)?;
    let spinner = progress::waiting("preparing the scene");
    let scene = scene(&args.scene.scene, &args.scene.shape)?;
    let rays = rays(args.scene.rays.as_deref(), &args.scene.shape, &scene)?;
    let workload = workload(&args.cells, &scene, &program, &machine, &rays)?;
    workload.check_memory(machine.spec.memory_words)?;
    workload.check_fifos(machine.spec.fifo_words)?;
    spinner.finish_and_clear();
    let setup = Setup { scene, program, machine_file, machine, rays, workload };
    notes(&setup);
    let outcome = simulate(
        &setup,
        (threads(args.tracing.threads), args.results.watch, args.tracing.ops_form.into()),
        &mut files,
    )?;
    print(&report(&setup, &outcome))?;
    let written = write_outputs(args, &setup, &outcome, files)?;
    print(&outputs::list(&written))
}

/// How many threads to use: so many, or one a core.
pub fn threads(count: Option<u16>) -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, |cores| cores.get());
    count.map_or_else(cores, usize::from)
}

/// The machine: PCS or a file's, changed by the flags.
pub fn machine_file(args: &MachineArgs) -> Result<MachineFile, InputError> {
    let mut file = args.machine.as_deref().map_or_else(MachineFile::standard, MachineFile::read)?;
    fn set<T: Copy>(field: &mut T, flag: Option<T>) {
        *field = flag.unwrap_or(*field);
    }
    set(&mut file.clock_ns, args.clock_ns);
    set(&mut file.word_bytes, args.word_bytes);
    set(&mut file.fifo_words, args.fifo_words);
    set(&mut file.link_mb_s, args.link_mb_s);
    set(&mut file.rate_counts, args.rate_counts);
    set(&mut file.latency_cycles, args.latency_cycles);
    file.memory_words = args.memory_words.or(file.memory_words);
    set(&mut file.host_ray_us, args.host_ray_us);
    set(&mut file.host_hit_us, args.host_hit_us);
    set(&mut file.times_us.grid_start, args.grid_start);
    set(&mut file.times_us.grid_voxel, args.grid_voxel);
    set(&mut file.times_us.slabs_start, args.slabs_start);
    set(&mut file.times_us.slabs_polygon, args.slabs_polygon);
    set(&mut file.times_us.intersection_start, args.intersection_start);
    set(&mut file.times_us.intersection_polygon, args.intersection_polygon);
    Ok(file)
}

/// The array program: a standard one or a file's, changed by the flags.
pub fn array_program(args: &ProgramArgs) -> Result<ArrayProgram, InputError> {
    let mut program = match &args.program {
        Some(path) => named_program(path)?,
        None => standard_program(args.mode.unwrap_or(Mode::Pipeline).program())?,
    };
    let is_pipeline = program == standard_program(Mode::Pipeline.program())?;
    let stages = program.stages.len();
    if let Some(cells) = args.cells {
        if cells == 0 || !cells.is_multiple_of(stages) {
            let message = format!("{cells} cells are no whole number of groups of {stages}");
            let help = format!("program '{}' takes {stages}, {}, {}, ... cells", program.name, 2 * stages, 3 * stages);
            return Err(InputError::new(message).help(help));
        }
        program.groups = cells / stages;
    }
    program.groups = args.groups.unwrap_or(program.groups);
    if is_pipeline && program.groups != 1 {
        let message = format!("the macro-pipeline is one group of {stages} cells, not {} groups", program.groups);
        return Err(InputError::new(message).help("several macro-pipelines side by side are --program hybrid-3"));
    }
    program.partition = args.partition.unwrap_or(program.partition);
    program.grid_coefficient = args.grid_coefficient.unwrap_or(program.grid_coefficient);
    program.mailbox |= args.mailbox;
    program.stop_words = args.stop_words.or(program.stop_words);
    program.forward_ahead = args.forward_ahead.unwrap_or(program.forward_ahead);
    program.check()?;
    Ok(program)
}

fn standard_program(name: &str) -> Result<ArrayProgram, InputError> {
    ArrayProgram::standard(name).unwrap_or_else(|| Err(InputError::new(format!("there is no standard program {name}"))))
}

/// A program file, or a standard program where there is no such file.
fn named_program(path: &Path) -> Result<ArrayProgram, InputError> {
    match path.to_str().filter(|_| !path.exists()).and_then(ArrayProgram::standard) {
        Some(standard) => standard,
        None => ArrayProgram::read(path),
    }
}

/// The scene laid out for the array, with the cells' programs if they run any.
pub fn workload(
    args: &CellArgs,
    scene: &Scene,
    program: &ArrayProgram,
    machine: &Machine,
    rays: &[Ray],
) -> Result<Workload, InputError> {
    let workload = Workload::new(&scene.mesh, program, machine.times, rays)?;
    match args.cells_run {
        Some(CellsRun::Programs) => workload.with_programs(&cell_options(args, machine)?),
        Some(CellsRun::Timings) | None => Ok(workload),
    }
}

/// How the cells run programs.
fn cell_options(args: &CellArgs, machine: &Machine) -> Result<CellOptions, InputError> {
    let cycles = machine.instructions.ok_or_else(|| {
        let error =
            InputError::new("the machine file does not say what instructions cost: instruction_cycles is missing");
        error.help("`pcs-sim calibrate --machine FILE` adds it")
    })?;
    let instruction_limit = args.instruction_limit.unwrap_or(Processor::INSTRUCTION_LIMIT);
    Ok(CellOptions { cycles, folder: args.cell_programs.clone(), instruction_limit })
}

/// What instructions cost, which a machine file need not say.
pub fn instruction_cycles(machine: &Machine) -> Result<InstructionCycles, InputError> {
    machine.instructions.ok_or_else(|| {
        let error =
            InputError::new("the machine file does not say what instructions cost: instruction_cycles is missing");
        error.help("`pcs-sim calibrate --machine FILE` adds it")
    })
}

/// A built-in scene or a file's.
pub fn scene(scene: &str, args: &ShapeArgs) -> Result<Scene, InputError> {
    let path = Path::new(scene);
    if is_builtin(scene) {
        return builtin::generate(scene, args.size_factor, args.resolution);
    }
    if args.size_factor.is_some() {
        let error = InputError::new("--size-factor is for built-in scenes, not for files");
        return Err(error.help("`pcs-sim scenes` lists the built-in scenes"));
    }
    let default = ReadOptions::default();
    pcs_sim::scene::load(path, &ReadOptions { resolution: args.resolution.unwrap_or(default.resolution) })
}

/// Whether a scene is the name of a built-in one, not that of a file.
pub fn is_builtin(scene: &str) -> bool {
    !scene.contains(['.', '/', '\\'])
}

/// The rays: the camera's, or a file's.
pub fn rays(file: Option<&Path>, shape: &ShapeArgs, scene: &Scene) -> Result<Vec<Ray>, InputError> {
    match file {
        Some(path) => ray_file::read(path),
        None => Ok(camera::primary_rays(&scene.camera, shape.size)),
    }
}

fn open_outputs(args: &RunArgs) -> Result<Outputs, InputError> {
    let named = [
        args.results.stats.as_ref(),
        args.tracing.hits.as_ref(),
        args.tracing.ops.as_ref(),
        args.image.as_ref(),
        args.views.page.as_ref(),
        args.views.trace.as_ref(),
    ];
    let inputs = [
        Some(Path::new(&args.scene.scene)),
        args.scene.rays.as_deref(),
        args.program.program.as_deref(),
        args.machine.machine.as_deref(),
    ];
    outputs::check_distinct(&named, &inputs)?;
    let open = |path: &Option<PathBuf>| outputs::open(path.as_deref(), args.results.force);
    Ok(Outputs {
        stats: open(&args.results.stats)?,
        hits: open(&args.tracing.hits)?,
        ops: open(&args.tracing.ops)?,
        image: open(&args.image)?,
        views: Views::open(&args.views, args.results.force)?,
    })
}

/// What the user should know before the figures: what had to be rounded, cut or assumed.
fn notes(setup: &Setup) {
    for note in setup.machine.notes.iter().chain(&setup.scene.notes) {
        eprintln!("note: {note}");
    }
}

fn simulate(
    setup: &Setup,
    (threads, watch, form): (usize, bool, Form),
    files: &mut Outputs,
) -> Result<Outcome, Failure> {
    let spec = &setup.machine.spec;
    let mut live = Live::new(
        progress::rays(setup.rays.len() as u64),
        watch.then(|| Watch::new(spec.clock(), cell_names(&setup.workload))),
    );
    let failed = |error: std::io::Error| Failure::Output(format!("cannot write the ops: {error}"));
    let Outputs { ops, views, .. } = files;
    let (cells, costs) = (setup.workload.cells(), setup.workload.costs());
    let writer = ops.as_mut().map(|file| TraceWriter::new(file, cells, costs.clone(), form));
    let mut writer = writer.transpose().map_err(failed)?;
    let array = views.fit(Array::new(spec, costs, cells));
    let outcome = simulation::run_in(array, &setup.workload, &setup.rays, threads, |batch, array| {
        live.inc(batch.hits.len() as u64);
        live.show(array);
        writer.as_mut().map_or(Ok(()), |writer| writer.write(&batch.ops))
    });
    live.finish();
    outcome.map_err(|error| match error {
        RunError::Stuck(stuck) => stuck.into(),
        RunError::Fault(fault) => fault.into(),
        RunError::Unfit(error) => error.into(),
        RunError::Batch(error) => error.into(),
        RunError::Observer(error) => failed(error),
    })
}

fn report(setup: &Setup, outcome: &Outcome) -> String {
    let Setup { machine, rays, workload, .. } = setup;
    let spec = &machine.spec;
    let hits = outcome.counts.hits;
    let names = cell_names(workload);
    let mut lines = vec![
        title(setup),
        machine_line(spec),
        summary::speed(&outcome.stats, spec.clock()),
        format!(
            "{} rays hit ({:.1} %); {} voxels, {} slabs tests and {} intersection tests a ray",
            grouped(hits),
            100.0 * hits as f64 / rays.len().max(1) as f64,
            per_ray(outcome.counts.voxels, rays.len()),
            per_ray(outcome.counts.slab_tests, rays.len()),
            per_ray(outcome.counts.intersection_tests, rays.len()),
        ),
    ];
    lines.push(memory_line(workload));
    format!(
        "{}\n\n{}\n{}\n{}\n",
        lines.join("\n"),
        summary::cells(&outcome.stats, &names),
        summary::fifos(&outcome.stats),
        bottleneck::sentence(&outcome.stats),
    )
}

/// What runs, in one line.
fn title(setup: &Setup) -> String {
    let Setup { scene, program, rays, workload, .. } = setup;
    format!(
        "{} on {} cells in {} of {}: scene {} ({} polygons), {} rays",
        program.name,
        workload.cells(),
        plural(workload.groups(), "group"),
        program.stages.len(),
        scene.name,
        grouped(workload.polygons().len() as u64),
        grouped(rays.len() as u64),
    )
}

/// The machine in one line.
pub fn machine_line(spec: &MachineSpec) -> String {
    format!(
        "machine: {} ns a cycle, {}-word FIFOs, {} Mbyte/s links ({}), latency {}",
        spec.clock_ns,
        spec.fifo_words.0,
        spec.link_mb_s,
        match spec.link_rate().cycles_per_word {
            1 => "a word a cycle".to_owned(),
            cycles => format!("a word in {cycles} cycles"),
        },
        spec.latency,
    )
}

/// The fullest cell's memory, in one line; of cells that run programs, with its parts.
pub fn memory_line(workload: &Workload) -> String {
    let largest = (0..workload.cells()).map(|cell| (workload.memory_of(cell).total(), std::cmp::Reverse(cell))).max();
    let (words, std::cmp::Reverse(cell)) = largest.unwrap_or_default();
    let line = format!("memory: {} words in the fullest cell, {cell}", grouped(words.0));
    if workload.cell_options().is_none() {
        return line;
    }
    let memory = workload.memory_of(cell);
    format!(
        "{line}: grid {} (equation 4), slabs {} (equation 6), planes and vertices {}, program and its tables {}",
        grouped(memory.grid.0),
        grouped(memory.slabs.0),
        grouped(memory.polygons.0),
        grouped(memory.program.0),
    )
}

/// What a cell runs, in a word or two.
fn kernel_names(kernels: &[Kernel]) -> String {
    let name = |kernel: &Kernel| match kernel {
        Kernel::Grid => "grid",
        Kernel::Slabs => "slabs",
        Kernel::Intersection => "intersection",
    };
    if kernels.len() == 3 { "all".to_owned() } else { kernels.iter().map(name).collect::<Vec<_>>().join("+") }
}

fn per_ray(count: u64, rays: usize) -> String {
    format!("{:.2}", count as f64 / rays.max(1) as f64)
}

/// `1 group`, `2 groups`.
pub fn plural(count: usize, noun: &str) -> String {
    if count == 1 { format!("1 {noun}") } else { format!("{count} {noun}s") }
}

fn write_outputs(args: &RunArgs, setup: &Setup, outcome: &Outcome, files: Outputs) -> Result<Vec<PathBuf>, Failure> {
    let mut written = Vec::new();
    let polygons = setup.workload.polygons();
    let Setup { scene, program, machine_file, workload, .. } = setup;
    let configuration = Configuration::new(scene, workload, program, machine_file);
    outputs::finish(files.stats, &mut written, |file| {
        let spec = &setup.machine.spec;
        let json = stats::to_json(&outcome.stats, spec.clock(), Some(&outcome.counts), Some(&configuration))?;
        file.write_all(json.as_bytes())
    })?;
    outputs::finish(files.hits, &mut written, |file| hits::write(file, polygons, &outcome.hits))?;
    outputs::finish(files.ops, &mut written, |_| Ok::<(), std::io::Error>(()))?;
    outputs::finish(files.image, &mut written, |file| {
        let pixels = image::preview(&setup.scene, polygons, &setup.rays, &outcome.hits);
        image::write_png(file, args.scene.shape.size, &pixels)
    })?;
    write_views(args, setup, outcome, &configuration, files.views, &mut written)?;
    Ok(written)
}

fn write_views(
    args: &RunArgs,
    setup: &Setup,
    outcome: &Outcome,
    configuration: &Configuration,
    views: Views,
    written: &mut Vec<PathBuf>,
) -> Result<(), Failure> {
    let spec = &setup.machine.spec;
    let caption = &Caption { title: title(setup), machine: machine_line(spec) };
    let cell_names = &cell_names(&setup.workload);
    let image = page_image(args, setup, outcome, &views)?;
    let seen = Seen {
        caption,
        clock: spec.clock(),
        stats: &outcome.stats,
        observed: &outcome.observed,
        cell_names,
        configuration: Some(configuration),
        image: image.as_deref(),
    };
    views.write(&seen, written)
}

/// The traced picture, if a view shows it and the rays are those of a picture.
fn page_image(args: &RunArgs, setup: &Setup, outcome: &Outcome, views: &Views) -> Result<Option<Vec<u8>>, Failure> {
    if !views.show_image() || args.scene.rays.is_some() {
        return Ok(None);
    }
    let (polygons, mut png) = (setup.workload.polygons(), Vec::new());
    let pixels = image::preview(&setup.scene, polygons, &setup.rays, &outcome.hits);
    image::write_png(&mut png, args.scene.shape.size, &pixels)
        .map_err(|error| Failure::Output(format!("the picture cannot be made: {error}")))?;
    Ok(Some(png))
}

/// What each cell runs.
pub fn cell_names(workload: &Workload) -> Vec<String> {
    (0..workload.cells()).map(|cell| kernel_names(workload.kernels_of(cell))).collect()
}
