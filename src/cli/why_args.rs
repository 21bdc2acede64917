//! What can be typed to find out why a run took so long, and how deep its FIFOs must be.

use std::path::PathBuf;

use clap::Args;
use pcs_sim::measure::{Actor, At};

use super::args::{Asked, RunArgs};

/// `pcs-sim size-fifos`.
#[derive(Debug, Args)]
pub struct SizeArgs {
    /// A recorded trace, as --ops wrote it, in place of a run.
    #[arg(long, value_name = "FILE", conflicts_with = "config")]
    pub ops: Option<PathBuf>,
    /// The run that a file describes: statistics, or their configuration. Flags beside it change that.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// A speed, in percent of that with unlimited FIFOs; may be given several times [default: 100, 99.9, 99, 95 and 90].
    #[arg(long, value_name = "PERCENT")]
    pub speed: Vec<f64>,
    /// Write a table of what was found: FILE.csv, and the same as FILE.parquet.
    #[arg(short = 'o', long, value_name = "FILE", help_heading = "Results")]
    pub table: Option<PathBuf>,
    /// Draw it, as SVG and PNG beside the table: speed over words, and the depths of the FIFOs.
    #[arg(long, help_heading = "Results", requires = "table")]
    pub plot: bool,
    /// Write the machine of each speed, as FILE-99.ron, ... beside the table.
    #[arg(long, help_heading = "Results", requires = "table")]
    pub machines: bool,
    /// Replace result files that exist.
    #[arg(long, help_heading = "Results")]
    pub force: bool,
    #[command(flatten)]
    pub asked: Asked,
}

/// `pcs-sim why`.
#[derive(Debug, Args)]
pub struct WhyArgs {
    /// An activity trace, as --ops wrote it, to be timed again. Without one a scene is traced: all flags are those of a run.
    #[arg(value_name = "OPS")]
    pub recorded: Option<PathBuf>,
    /// Tell the times of each cell by themselves.
    #[arg(long)]
    pub by_cell: bool,
    /// Tell of one moment instead: what that cell (or host) does then, and who waits for whom.
    #[arg(long, value_name = "N", conflicts_with = "by_cell")]
    pub cell: Option<Actor>,
    /// The moment: a cycle, or a simulated time as in 12.3ms.
    #[arg(long, value_name = "TIME", requires = "cell", conflicts_with = "ray")]
    pub at: Option<At>,
    /// The moment: the middle of the longest wait of the cell while it is at that ray, counted from 0.
    #[arg(long, value_name = "N", requires = "cell")]
    pub ray: Option<u32>,
    #[command(flatten)]
    pub run: RunArgs,
}
