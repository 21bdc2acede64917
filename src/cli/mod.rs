//! The command line: one file a command; each parses, calls the library, prints.

mod args;
mod asm;
mod calibrate;
mod calibrate_ipsc2;
mod cell_args;
mod commands;
mod compare;
mod diagnostics;
mod disasm;
mod engine_args;
mod farm;
mod farm_args;
mod figure7;
mod graphs;
mod image;
mod interrupt;
mod ipsc2;
mod ipsc2_args;
mod lab;
mod manual;
mod model;
mod model_ipsc2;
mod outputs;
mod plot;
mod progress;
mod replay;
mod run;
mod scenes;
mod shards;
mod size_fifos;
mod step;
mod sweep;
mod views;
mod watch;
mod why;
mod why_args;

use std::convert::Infallible;
use std::ffi::{OsStr, OsString};
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{ArgMatches, FromArgMatches};

use args::Typed;
use commands::{Cli, Command};
use pcs_sim::error::InputError;
use pcs_sim::input::{STREAM, is_stream};
use pcs_sim::isa::Fault;
use pcs_sim::machine::Stuck;
use pcs_sim::measure::{Actor, At, Clock, When};
use pcs_sim::program::NotLaidOut;
use pcs_sim::program::figure7::MeasureError;
use pcs_sim::run::{CubeRunOptions, RunError, RunOptions};

/// What of a run is printed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Told {
    /// Where the cycles of all cells went, and what the FIFOs held.
    All,
    /// Only why it took as long.
    Why {
        /// Whether the times of each cell are told apart.
        by_cell: bool,
    },
    /// Only what somebody did in one moment.
    Moment(Actor, MomentOf),
}

/// Which moment.
#[derive(Clone, Copy, Debug, PartialEq)]
enum MomentOf {
    At(At),
    /// The ray's in the cell.
    Ray(u32),
}

impl Told {
    /// The cycle of a machine with such a clock, if one is to be looked at.
    fn moment(self, clock: Clock) -> Result<Option<When>, InputError> {
        let when = match self {
            Told::Moment(_, MomentOf::At(at)) => When::Cycle(at.cycle(clock)),
            Told::Moment(Actor::Station(station), MomentOf::Ray(job)) => When::Job { station, job },
            Told::Moment(Actor::Host, MomentOf::Ray(_)) => {
                return Err(InputError::new("a ray is looked for in a cell").help("say which with --cell N"));
            }
            Told::All | Told::Why { .. } => return Ok(None),
        };
        Ok(Some(when))
    }
}

/// Why a command failed.
#[derive(Debug)]
enum Failure {
    /// Bad usage or input: exit status 2.
    Input(Box<InputError>),
    /// The array can go no further: exit status 1.
    Stuck(Stuck),
    /// A cell's program cannot go on: exit status 1.
    Fault(Box<Fault>),
    /// A result could not be written: exit status 1.
    Output(String),
    /// What is compared differs, as has been told: exit status 1.
    Differ,
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Failure {
        Failure::Input(Box::new(error))
    }
}

impl From<Fault> for Failure {
    fn from(fault: Fault) -> Failure {
        Failure::Fault(Box::new(fault))
    }
}

impl<E: std::fmt::Display> From<RunError<E>> for Failure {
    fn from(error: RunError<E>) -> Failure {
        match error {
            RunError::Stuck(stuck) => Failure::Stuck(stuck),
            RunError::Fault(fault) => fault.into(),
            RunError::Unfit(error) => error.into(),
            RunError::Batch(error) => InputError::new(error.to_string()).into(),
            RunError::Standstill(_)
            | RunError::Nodes(_)
            | RunError::Outlived(_)
            | RunError::Cancelled(_)
            | RunError::Observer(_) => Failure::Output(error.to_string()),
        }
    }
}

impl From<NotLaidOut> for Failure {
    fn from(not: NotLaidOut) -> Failure {
        RunError::<Infallible>::from(not).into()
    }
}

impl From<MeasureError> for Failure {
    fn from(error: MeasureError) -> Failure {
        match error {
            MeasureError::Input(error) => error.into(),
            MeasureError::Fault(fault) => Failure::Fault(fault),
        }
    }
}

/// Runs the command. Exit status 2 for bad usage or input, 1 for a run that failed, 130 for one that was stopped.
pub fn main() -> ExitCode {
    let all = manual::command();
    let typed = joined(ipsc2::spelled_out(std::env::args_os().collect()).into_iter(), &manual::switches(&all));
    let all = if typed.iter().any(|word| is_named_stream(word)) { manual::taking_streams(all) } else { all };
    let command_word = typed.get(1).map(|word| word.to_string_lossy().into_owned()).unwrap_or_default();
    let parsed = all.try_get_matches_from(typed).and_then(|matches| Ok((Cli::from_arg_matches(&matches)?, matches)));
    let (cli, matches) = match parsed {
        Ok(parsed) => parsed,
        Err(error) => {
            if let Some(error) = of_another_machine(&error, &command_word) {
                return report(&error.into());
            }
            let _ = error.print();
            let asked_for = matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
            return ExitCode::from(if asked_for { 0 } else { 2 });
        }
    };
    let cli = cli.spelled_out();
    if cli.quiet {
        be_quiet();
    }
    let ended = interrupt::listen().and_then(|()| command(&cli, &matches));
    interrupt::settle();
    match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => report(&failure),
    }
}

/// That a flag is one of another machine's, if it is why the command was not understood.
fn of_another_machine(error: &clap::Error, command: &str) -> Option<InputError> {
    let ContextValue::String(flag) = error.get(ContextKind::InvalidArg)? else { return None };
    let name = flag.strip_prefix("--").filter(|_| error.kind() == ErrorKind::UnknownArgument)?.replace('-', "_");
    let of_arrays = RunOptions::parameters().any(|known| known.name == name);
    let of_cubes = CubeRunOptions::parameters().any(|known| known.name == name);
    let is_of_array = matches!(command, "image" | "model") || command.starts_with('-');
    match (matches!(command, "ipsc2" | "model-ipsc2"), of_arrays, of_cubes) {
        (true, true, false) => {
            let error = InputError::new(format!("{flag} is about cells in a row, and this is a hypercube"));
            Some(error.help("leave it out, or --on ipsc2; nodes as a row of cells are --on ipsc2 --mode broadcast"))
        }
        (false, false, true) if is_of_array => {
            let error = InputError::new(format!("{flag} is about a hypercube, and these are cells in a row"));
            Some(error.help("leave it out, or ask for --on ipsc2"))
        }
        _ => None,
    }
}

/// What was typed, with streams that tell their format (`--image -.png`) joined to their flags: by themselves they look like flags.
/// `switches` take no value.
fn joined(typed: impl Iterator<Item = OsString>, switches: &[String]) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = Vec::new();
    let starts = |argument: &OsStr, with: &str| argument.as_encoded_bytes().starts_with(with.as_bytes());
    let takes_value = |word: &OsStr| {
        let is_switch = switches.iter().any(|switch| word == switch.as_str());
        starts(word, "-") && word != STREAM && !is_named_stream(word) && !is_switch
    };
    for argument in typed {
        match arguments.last_mut().filter(|flag| takes_value(flag) && is_named_stream(&argument)) {
            Some(flag) => {
                flag.push(if starts(flag, "--") { "=" } else { "" });
                flag.push(argument);
            }
            None => arguments.push(argument),
        }
    }
    arguments
}

/// Whether a word stands for a stream and tells its format: `-.png`.
fn is_named_stream(word: &OsStr) -> bool {
    word != STREAM && is_stream(Path::new(word))
}

fn command(cli: &Cli, matches: &ArgMatches) -> Result<(), Failure> {
    let typed = &Typed(matches.subcommand().map_or(matches, |(_, matches)| matches));
    match &cli.command {
        None => run::run(&cli.run, typed, Told::All),
        Some(Command::Image(args)) => image::image(args, typed),
        Some(Command::Farm(args)) => farm::farm(args, typed),
        Some(Command::Ipsc2(args)) => ipsc2::ipsc2(args, typed),
        Some(Command::Replay(args)) => replay::replay(args, Told::All),
        Some(Command::SizeFifos(args)) => size_fifos::size_fifos(args, typed),
        Some(Command::Why(args)) => why::why(args, typed),
        Some(Command::Sweep(args)) => sweep::sweep(args),
        Some(Command::Model(args)) => model::model(args, typed),
        Some(Command::ModelIpsc2(args)) => model_ipsc2::model(args, typed),
        Some(Command::Lab(args)) => lab::lab(args),
        Some(Command::Plot(args)) => plot::plot(args),
        Some(Command::Compare(args)) => compare::compare(args),
        Some(Command::Figure7(args)) => figure7::figure7(args),
        Some(Command::Calibrate(args)) => calibrate::calibrate(args),
        Some(Command::CalibrateIpsc2(args)) => calibrate_ipsc2::calibrate(args, typed),
        Some(Command::Asm(args)) => asm::asm(args),
        Some(Command::Disasm(args)) => disasm::disasm(args),
        Some(Command::Step(args)) => step::step(args),
        Some(Command::Scenes(args)) => scenes::scenes(args),
        Some(Command::Completions(args)) => manual::completions(args),
        Some(Command::Man(args)) => manual::man(args),
    }
}

fn report(failure: &Failure) -> ExitCode {
    eprint!("{}", diagnostics::drawn(failure));
    ExitCode::from(if matches!(failure, Failure::Input(_)) { 2 } else { 1 })
}

/// Whether standard output is for a result's file, or for nothing.
static TAKEN: AtomicBool = AtomicBool::new(false);

/// Whether only errors are told.
static QUIET: AtomicBool = AtomicBool::new(false);

/// From here on, nothing is printed to stdout: a result's file goes there.
fn take_stdout() {
    TAKEN.store(true, Ordering::Relaxed);
}

/// From here on, only errors are told.
fn be_quiet() {
    take_stdout();
    QUIET.store(true, Ordering::Relaxed);
}

fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// What the user should know beside the results.
fn note(text: impl std::fmt::Display) {
    if !is_quiet() {
        eprintln!("note: {text}");
    }
}

/// Whether the terminal can neither draw a line again nor show colours.
fn is_dumb() -> bool {
    std::env::var_os("TERM").is_some_and(|term| term == "dumb")
}

/// Prints to stdout, unless that is taken. A reader that has gone away (`| head`) is no failure.
fn print(text: &str) -> Result<(), Failure> {
    if TAKEN.load(Ordering::Relaxed) {
        return Ok(());
    }
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::Output(format!("cannot write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}
