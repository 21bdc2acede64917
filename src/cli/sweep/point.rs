//! One point of a sweep, and what it shares with others.

use std::rc::Rc;

use pcs_sim::error::InputError;
use pcs_sim::geometry::Ray;
use pcs_sim::machine::{Array, OpBatch, RunStats, Stuck};
use pcs_sim::program::{ArrayProgram, Counts, Machine, Workload};
use pcs_sim::scene::Scene;
use pcs_sim::simulation::{self, TracedBatch};

use crate::cli::args::{RunArgs, SceneArgs};
use crate::cli::run;

/// What the table tells of a point, behind its parameters.
pub const COLUMNS: [&str; 14] = [
    "array_cells",
    "ray_count",
    "cycles",
    "seconds",
    "rays_per_second",
    "hits",
    "voxels",
    "slab_tests",
    "intersection_tests",
    "busiest_cell",
    "busiest_cell_works",
    "fullest_fifo",
    "fullest_fifo_words",
    "error",
];

/// All that a point is made of.
pub struct Setting {
    scene: SceneKey,
    args: RunArgs,
    program: ArrayProgram,
    machine: Machine,
}

/// What a scene and its rays depend on.
type SceneKey = String;

/// What a point gives.
pub struct Outcome {
    stats: RunStats,
    counts: Counts,
    seconds: f64,
}

impl Setting {
    pub fn new(args: &RunArgs) -> Result<Setting, String> {
        let machine = run::machine_file(&args.machine).and_then(|file| file.build()).map_err(reason)?;
        let program = run::array_program(&args.program).map_err(reason)?;
        Ok(Setting { scene: format!("{:?}", args.scene), args: args.clone(), program, machine })
    }

    /// Whether the cells do the same ops, if not in the same time.
    pub fn does_the_same_work(&self, other: &Setting) -> bool {
        let cells = |setting: &Setting| format!("{:?} {:?}", setting.args.cells, setting.machine.instructions);
        self.scene == other.scene
            && self.program == other.program
            && self.machine.times == other.machine.times
            && cells(self) == cells(other)
    }
}

/// Shared by the recordings of a scene.
type SceneAndRays = Rc<(Scene, Vec<Ray>)>;

/// The scene that was built last: points of one scene follow each other.
#[derive(Default)]
pub struct Scenes {
    last: Option<(SceneKey, SceneAndRays)>,
}

impl Scenes {
    /// The scene and the rays of a setting.
    pub fn get(&mut self, setting: &Setting) -> Result<SceneAndRays, String> {
        if let Some((key, scene)) = &self.last
            && *key == setting.scene
        {
            return Ok(scene.clone());
        }
        let SceneArgs { scene, shape, .. } = &setting.args.scene;
        let scene = run::scene(scene, shape).map_err(reason)?;
        let rays = run::rays(&setting.args.scene, &scene).map_err(reason)?;
        let both = Rc::new((scene, rays));
        self.last = Some((setting.scene.clone(), both.clone()));
        Ok(both)
    }
}

/// The ops of a run, to be timed under any machine.
pub struct Recording {
    batches: Vec<OpBatch>,
    counts: Counts,
    workload: Workload,
}

impl Recording {
    /// Works the ops out, on all cores.
    pub fn new(setting: &Setting, scene: &(Scene, Vec<Ray>)) -> Result<Recording, String> {
        let (scene, rays) = scene;
        let workload =
            run::workload(&setting.args.cells, scene, &setting.program, &setting.machine, rays).map_err(reason)?;
        let (mut batches, mut counts) = (Vec::new(), Counts::default());
        let threads = run::threads(setting.args.tracing.threads);
        simulation::trace(&workload, rays, threads, |batch| {
            batch.fault.map_or(Ok(()), |fault| Err(fault.to_string()))?;
            counts += batch.counts;
            batches.push(batch.ops);
            Ok::<_, String>(TracedBatch::default())
        })?;
        Ok(Recording { batches, counts, workload })
    }

    /// Times the ops under a machine.
    pub fn time(&self, setting: &Setting) -> Result<Outcome, String> {
        let spec = &setting.machine.spec;
        self.workload.check_memory(spec.memory_words).map_err(reason)?;
        let mut array = Array::new(spec, self.workload.cells());
        let stuck = |stuck: Stuck| stuck.to_string();
        for batch in &self.batches {
            let mut copy = array.take_spent().unwrap_or_default();
            copy.clone_from(batch);
            array.feed(copy);
            array.run().map_err(stuck)?;
        }
        let stats = array.finish().map_err(|unfinished| unfinished.to_string())?;
        let seconds = spec.seconds(stats.cycles);
        Ok(Outcome { stats, counts: self.counts, seconds })
    }
}

fn reason(error: InputError) -> String {
    error.to_string()
}

/// The columns of a point that is done, or that failed.
pub fn columns(result: Result<Outcome, String>) -> Vec<String> {
    let Outcome { stats, counts, seconds } = match result {
        Ok(outcome) => outcome,
        Err(reason) => {
            let mut row = vec![String::new(); COLUMNS.len() - 1];
            row.push(reason);
            return row;
        }
    };
    let work = |cell: usize| stats.cells[cell].busy.total() + stats.cells[cell].moving;
    let busiest = (0..stats.cells.len()).max_by_key(|&cell| (work(cell), std::cmp::Reverse(cell))).unwrap_or(0);
    let fullest = stats.fifos.iter().rev().max_by_key(|fifo| fifo.max);
    let share = work(busiest).0 as f64 / stats.cycles.0.max(1) as f64;
    let rate = if seconds > 0.0 { stats.rays as f64 / seconds } else { 0.0 };
    vec![
        stats.cells.len().to_string(),
        stats.rays.to_string(),
        stats.cycles.0.to_string(),
        seconds.to_string(),
        rate.to_string(),
        counts.hits.to_string(),
        counts.voxels.to_string(),
        counts.slab_tests.to_string(),
        counts.intersection_tests.to_string(),
        busiest.to_string(),
        share.to_string(),
        fullest.map(|fifo| fifo.name.clone()).unwrap_or_default(),
        fullest.map(|fifo| fifo.max.0.to_string()).unwrap_or_default(),
        String::new(),
    ]
}
