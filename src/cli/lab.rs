//! `pcs-sim lab`: a page on this machine.

use std::convert::Infallible;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};

use clap::Args;
use pcs_sim::run::RunError;

use super::args::GENERAL;
use super::{Failure, diagnostics, interrupt, manual, print, run};
use crate::lab::{self, Options, Words};

/// `pcs-sim lab`.
#[derive(Debug, Args)]
pub struct LabArgs {
    /// The address to listen on. On any but a loopback one whoever reaches this machine can run what they like in the lab.
    #[arg(long, value_name = "ADDRESS", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    pub listen: IpAddr,
    /// The port; 0 takes any that is free.
    #[arg(long, value_name = "N", default_value_t = 1989)]
    pub port: u16,
    /// The largest scene that may be dropped on the page, in Mbyte.
    #[arg(long, value_name = "MBYTE", default_value_t = 64, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub max_upload: u16,
    /// Threads that work on a run [default: all cores]. The results do not depend on it.
    #[arg(long, value_name = "N", help_heading = GENERAL, value_parser = clap::value_parser!(u16).range(1..))]
    pub threads: Option<u16>,
}

/// Serves the lab until the command is stopped.
pub fn lab(args: &LabArgs) -> Result<(), Failure> {
    let options = Options {
        listen: args.listen,
        port: args.port,
        max_upload: usize::from(args.max_upload) * 1_000_000,
        threads: run::workers(args.threads).threads,
        words: Words { failure, help },
    };
    lab::serve(&options, |at, folder| {
        interrupt::serving(folder);
        let _ = print(&format!("the lab is at http://{}/ until Ctrl-C ends it\n", named(at)));
    })?;
    Ok(())
}

/// Where it is, as a browser on this machine asks for it.
fn named(at: &SocketAddr) -> SocketAddr {
    match at.ip().is_unspecified() {
        true => SocketAddr::new(Ipv4Addr::LOCALHOST.into(), at.port()),
        false => *at,
    }
}

/// What a parameter is, as the help has it.
fn help(name: &str) -> Option<String> {
    let command = manual::command();
    let help = command.get_arguments().find(|arg| arg.get_id().as_str() == name)?.get_help()?;
    Some(help.to_string())
}

/// Why a run failed, as it stands in a terminal, without colours.
fn failure(error: RunError<Infallible>) -> String {
    diagnostics::plain(&error.into())
}
