//! The flags as others need them: defaults in the help, completions for shells, pages of the manual.

use std::io::Write;

use clap::{Arg, ArgAction, Command, CommandFactory};
use clap_mangen::Man;
use pcs_sim::machine::{CapitanFile, Ipsc2File, MachineFile};
use pcs_sim::run::moot;
use serde_json::Value;

use super::args::{CompletionsArgs, ManArgs};
use super::commands::Cli;
use super::{Failure, outputs, print};

/// All that can be typed, with the defaults that machine files give, and without flags that a command always refuses.
pub fn command() -> Command {
    let standard = serde_json::to_value(MachineFile::standard().ok()).unwrap_or_default();
    let capitan = serde_json::to_value(CapitanFile::standard().ok()).unwrap_or_default();
    let ipsc2 = serde_json::to_value(Ipsc2File::standard().ok()).unwrap_or_default();
    let mut command = told(Cli::command(), &standard);
    for name in ["image", "replay", "model", "size-fifos", "why"] {
        command = command.mut_subcommand(name, |command| told(command, &standard));
    }
    command = command.mut_subcommand("farm", |command| told(command, &capitan));
    for name in ["ipsc2", "model-ipsc2"] {
        command = command.mut_subcommand(name, |command| told(command, &ipsc2));
    }
    moot::ALWAYS_REFUSED.into_iter().fold(command, |command, (name, refused)| match name {
        "run" => hidden(command, refused),
        _ => command.mut_subcommand(name, |command| hidden(command, refused)),
    })
}

/// The flags of all commands that take no value, as they are typed.
pub fn switches(command: &Command) -> Vec<String> {
    let bare = command.get_arguments().filter(|arg| !arg.is_positional() && !arg.get_action().takes_values());
    let typed = bare.flat_map(|arg| {
        let long = arg.get_long().map(|long| format!("--{long}"));
        long.into_iter().chain(arg.get_short().map(|short| format!("-{short}")))
    });
    typed.chain(command.get_subcommands().flat_map(switches)).collect()
}

/// The same commands, whose files without a flag may be streams that tell their format (`-.obj`), though these look like flags.
pub fn taking_streams(command: Command) -> Command {
    let is_file = |arg: &Arg| arg.is_positional() && matches!(arg.get_action(), ArgAction::Set);
    let command = command.mut_args(|arg| if is_file(&arg) { arg.allow_hyphen_values(true) } else { arg });
    command.mut_subcommands(taking_streams)
}

fn hidden(command: Command, arguments: &[&str]) -> Command {
    arguments.iter().fold(command, |command, name| command.mut_arg(name, |arg| arg.hide(true)))
}

/// Tells the defaults of a machine's parameters.
fn told(command: Command, machine: &Value) -> Command {
    command.mut_args(|arg| {
        let name = arg.get_id().as_str();
        let default = machine.get(name).or_else(|| machine.get("times_us")?.get(name)).map(Value::to_string);
        let default = default.or_else(|| left_out(name).map(str::to_owned));
        match (default, arg.get_help()) {
            (Some(default), Some(help)) => {
                let default = default.trim_matches('"').to_lowercase();
                let default = default.strip_suffix(".0").unwrap_or(&default);
                let help = format!("{help} [default: the machine file's; {default} in the standard one]");
                arg.help(help)
            }
            _ => arg,
        }
    })
}

/// What holds for a parameter that the standard machine file does not have.
fn left_out(name: &str) -> Option<&'static str> {
    match name {
        "memory_words" => Some("as many as it takes"),
        "x_fifo_words" | "y_fifo_words" | "z_fifo_words" => Some("fifo_words"),
        "host_filter_us" | "host_mask_us" | "message_us" => Some("0"),
        _ => None,
    }
}

/// `pcs-sim completions SHELL`
pub fn completions(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command(), "pcs-sim", &mut script);
    print(&String::from_utf8_lossy(&script))
}

/// `pcs-sim man DIR`
pub fn man(args: &ManArgs) -> Result<(), Failure> {
    let failed = |error: std::io::Error| Failure::Output(format!("cannot write {}: {error}", args.folder.display()));
    let _folder = outputs::folder(&args.folder).map_err(failed)?;
    let mut all = command().disable_help_subcommand(true);
    all.build();
    let of_commands = all.get_subcommands().map(|command| {
        let name = format!("pcs-sim-{}", command.get_name());
        command.clone().name(name.clone()).display_name(name)
    });
    let pages: Vec<Command> = std::iter::once(all.clone()).chain(of_commands).collect();
    let mut written = Vec::new();
    for page in pages {
        let path = args.folder.join(format!("{}.1", page.get_name()));
        let file = outputs::create(&path, args.force)?;
        outputs::finish(Some(file), &mut written, |file| {
            let mut text = Vec::new();
            Man::new(page).render(&mut text)?;
            file.write_all(&text)
        })?;
    }
    print(&outputs::list(&written))
}
