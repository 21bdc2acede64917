//! The commands that there are.

use std::path::PathBuf;

use clap::{Parser, Subcommand};
use pcs_sim::input::STREAM;

use super::args::{
    CompareArgs, CompletionsArgs, GENERAL, ImageArgs, ManArgs, ModelArgs, PlotArgs, ReplayArgs, RunArgs, ScenesArgs,
    SweepArgs,
};
use super::cell_args::{AsmArgs, CalibrateArgs, DisasmArgs, Figure7Args, StepArgs};
use super::farm_args::FarmArgs;
use super::ipsc2_args::{CalibrateIpsc2Args, Ipsc2Args, ModelIpsc2Args};
use super::lab::LabArgs;
use super::why_args::{SizeArgs, WhyArgs};

/// Simulates ray tracing on a linear array of PCS processors (INRIA RR-0992, 1989), exact to the cycle.
///
/// Without a command it traces a scene: `pcs-sim --mode broadcast --cells 8 --scene reference`.
#[derive(Debug, Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub run: RunArgs,
    /// Print nothing but errors: neither results, nor notes, nor progress.
    #[arg(short, long, global = true, help_heading = GENERAL)]
    pub quiet: bool,
}

impl Cli {
    /// What is typed, and what it is short for.
    pub fn spelled_out(mut self) -> Cli {
        let (json, stats) = match &mut self.command {
            None => (self.run.results.json, &mut self.run.results.stats),
            Some(Command::Image(args)) => (args.results.json, &mut args.results.stats),
            Some(Command::Farm(args)) => (args.json, &mut args.stats),
            Some(Command::Ipsc2(args)) => (args.json, &mut args.stats),
            Some(Command::Replay(args)) => (args.results.json, &mut args.results.stats),
            Some(Command::Why(args)) => (args.run.results.json, &mut args.run.results.stats),
            Some(Command::Model(args)) => (args.results.json, &mut args.results.stats),
            Some(Command::ModelIpsc2(args)) => (args.json, &mut args.stats),
            Some(_) => return self,
        };
        if json {
            *stats = Some(PathBuf::from(STREAM));
        }
        self
    }
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Makes a whole image: the host shades the hits and sends shadow, reflected and refracted rays.
    Image(Box<ImageArgs>),
    /// Runs a farm of workers on the machine CAPITAN: a master hands out parts of an image, and each worker has the scene.
    Farm(Box<FarmArgs>),
    /// Makes an image on the nodes of an iPSC/2, a hypercube: image SCENE --on ipsc2.
    Ipsc2(Box<Ipsc2Args>),
    /// Times a recorded activity trace again, under any machine, without its scene.
    Replay(Box<ReplayArgs>),
    /// Finds the fewest words that the FIFOs need, each by itself, for 90 to 100 % of the speed that they could give.
    SizeFifos(Box<SizeArgs>),
    /// Tells why a run, or a recorded activity trace, took as long as it did, and what would make it faster.
    Why(Box<WhyArgs>),
    /// Runs every combination of parameters that a file lists, and writes one table.
    Sweep(Box<SweepArgs>),
    /// Predicts a run by the paper's cost model, and tells how far off the prediction is.
    Model(Box<ModelArgs>),
    /// Predicts an image on an iPSC/2 by its sub-sample, and tells how far off that is: model SCENE --on ipsc2.
    #[command(name = "model-ipsc2")]
    ModelIpsc2(Box<ModelIpsc2Args>),
    /// Serves a page on this machine, on which runs are changed by sliders, seen and compared.
    Lab(LabArgs),
    /// Draws one column of a table over another.
    Plot(PlotArgs),
    /// Tells in what two statistics files differ, and by how much: exit status 1 where they do.
    Compare(CompareArgs),
    /// Measures Figure 7's six numbers on both kinds of cell, and holds them against the paper.
    Figure7(Figure7Args),
    /// Fits what instructions cost to Figure 7, and writes a machine file.
    Calibrate(CalibrateArgs),
    /// Fits the times of an iPSC/2's nodes to what an image took: calibrate SCENE --on ipsc2.
    #[command(name = "calibrate-ipsc2")]
    CalibrateIpsc2(Box<CalibrateIpsc2Args>),
    /// Assembles a cell's program to an object file, and lists it with its cycles.
    Asm(AsmArgs),
    /// Turns an object file back into source text.
    Disasm(DisasmArgs),
    /// Runs a cell's program step by step, on words of your own.
    Step(StepArgs),
    /// Lists the built-in scenes, or tells what one scene has, or a file, and writes its polygons for other programs.
    Scenes(ScenesArgs),
    /// Prints what makes a shell complete this command and its flags.
    Completions(CompletionsArgs),
    /// Writes the manual's pages, one for each command.
    Man(ManArgs),
}
