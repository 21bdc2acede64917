//! What can be typed after the commands for cells that run programs.

use std::path::PathBuf;

use clap::Args;

/// `pcs-sim asm`.
#[derive(Debug, Args)]
pub struct AsmArgs {
    /// The source text, as pcs-programs/cells has them.
    pub file: PathBuf,
    /// Where the object file goes [default: stdout, if no listing is asked for].
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Lists addresses, words, source lines, and cycles of instructions and loops [default: to stdout].
    #[arg(long, value_name = "FILE", num_args = 0..=1)]
    pub listing: Option<Option<PathBuf>>,
    /// A machine file of your own, which says what instructions cost [default: PCS].
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// Replace files that exist.
    #[arg(long)]
    pub force: bool,
}

/// `pcs-sim disasm`.
#[derive(Debug, Args)]
pub struct DisasmArgs {
    /// The object file, as `pcs-sim asm` wrote it.
    pub file: PathBuf,
}

/// `pcs-sim step`.
#[derive(Debug, Args)]
pub struct StepArgs {
    /// The program: source text or an object file.
    pub file: PathBuf,
    /// Words that come on X: integers, 0x and hexadecimal digits, floating-point numbers; `-` for stdin.
    #[arg(long, value_name = "FILE")]
    pub x: Option<PathBuf>,
    /// Words that come on Y.
    #[arg(long, value_name = "FILE")]
    pub y: Option<PathBuf>,
    /// Commands, one a line [default: from stdin]; `help` among them lists them.
    #[arg(long, value_name = "FILE")]
    pub script: Option<PathBuf>,
    /// A machine file of your own, which says what instructions cost [default: PCS].
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// The most instructions that the program may execute for one message [default: 200000000].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub instruction_limit: Option<u64>,
}

/// `pcs-sim figure7`.
#[derive(Debug, Args)]
pub struct Figure7Args {
    /// A machine file of your own [default: PCS].
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// A folder of programs for the cells in place of the standard ones.
    #[arg(long, value_name = "DIR")]
    pub cell_programs: Option<PathBuf>,
    /// Tell what a recorded run of cells that run programs takes on the machines that fit: one that was written with --ops.
    #[arg(long, value_name = "FILE")]
    pub ops: Option<PathBuf>,
    /// Write a table of all machines that come within 10 %, with what their instructions cost: FILE.csv, and the same as
    /// FILE.parquet.
    #[arg(short = 'o', long, value_name = "FILE")]
    pub fits: Option<PathBuf>,
    /// Replace files that exist.
    #[arg(long)]
    pub force: bool,
}

/// `pcs-sim calibrate`.
#[derive(Debug, Args)]
pub struct CalibrateArgs {
    /// The machine file to which the costs are added, or in which they are replaced [default: PCS].
    #[arg(long, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// A folder of programs for the cells in place of the standard ones.
    #[arg(long, value_name = "DIR")]
    pub cell_programs: Option<PathBuf>,
    /// Where the new machine file goes [default: stdout].
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Replace a file that exists.
    #[arg(long)]
    pub force: bool,
}
