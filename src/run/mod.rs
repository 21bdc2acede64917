//! A run: described, as a value ([`RunOptions`] are what can be asked of one, a [`RunSpec`] is what it then is), and done:
//! primary rays by [`run()`], whole images by [`render()`], recorded ops by [`replay()`].
//!
//! Whatever runs a workload first checks that the machine can.

mod ahead;
mod closed_loop;
mod cube;
mod farm;
mod fitting;
mod in_step;
mod kept;
mod layers;
mod modelled;
pub mod moot;
mod one_cell;
mod options;
mod outputs;
mod recording_memory;
mod render;
mod replayed;
mod ruled;
mod setup;
mod shown;
mod shuffled;
mod sizing;
mod spec;
mod timed;
mod trace;
mod trees;
mod workers;

pub use cube::{
    Calibrated, CellCuts, CubeForecast, CubeMode, CubeOptions, CubeOutcome, CubeRunOptions, CubeScene, CubeSetup,
    CubeSpec, Cut, Distribution, First, FlowKind, Found, Grant, Grids, Known, KnownTime, Mapping, Percent, PixelOrder,
    PixelsOf, QueueRays, RegionSpec, Termination,
};
pub use farm::{FarmOptions, FarmOutcome, FarmRays, FarmRunOptions, FarmScene, FarmSetup, FarmSpec, TaskRange};
pub use fitting::{Fitting, Range};
pub use in_step::InStep;
pub use kept::KeptOps;
pub use layers::{Key, Keys, Layers, PlannedRun, Prepared, Traced};
pub use modelled::{CountedLoads, Forecast, array_model, few, fifos};
pub use options::{
    CellsOptions, CellsRun, HostOptions, LightOptions, MachineFileOptions, Mode, On, ProgramOptions, RayOptions,
    RunOptions, SceneOptions, SendingOptions, ShapeOptions, Switch,
};
#[cfg(feature = "report")]
pub(crate) use outputs::make_readable;
pub use outputs::{OutputFile, OutputFolder, Outputs};
pub use recording_memory::RecordingMemory;
pub use render::{KindLatencies, Picture, Rendered, Seen, Timed, Timing, render, render_lines};
pub use replayed::Replay;
pub use ruled::{Broken, check_rules};
pub use setup::Setup;
pub use shuffled::{Reordered, Shuffled};
pub use sizing::{Depths, Fewer, Front, Point, Recorded, SLOWER, Searching, SizingError, size_fifos, slower};
pub use spec::{ImageSpec, ReplaySpec, RunSpec, array_program, is_builtin, load_scene, machine_file};
pub use timed::{Outcome, RunError, TakeBatch, Watching, replay, replay_watched, run, run_watched};
pub use trace::{TracedBatch, trace};
pub use trees::{ByKind, KindCounts, TreeBatch, TreeRay, computing};
pub use workers::Workers;

pub use crate::input::fields::read_text;
pub use crate::input::reading::{FileRead, noting, within};
