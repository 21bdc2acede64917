//! A run as a value: what can be asked of one, and what it then is. Whoever wants a run (the command, a sweep's point, a
//! file) describes it here.

mod options;
mod spec;

pub use options::{
    CellsOptions, CellsRun, HostOptions, LightOptions, MachineFileOptions, Mode, ProgramOptions, RayOptions,
    RunOptions, SceneOptions, ShapeOptions, Switch,
};
pub use spec::{ImageSpec, RunSpec, array_program, is_builtin, machine_file};
