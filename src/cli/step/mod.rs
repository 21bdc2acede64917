//! `pcs-sim step FILE`: a cell's program under one's hands.

mod command;
mod session;

use std::io::{BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};

use pcs_sim::error::InputError;
use pcs_sim::isa::{Class, Instruction, Processor, Program, Queues, object, words};
use pcs_sim::run::read_text;

use self::command::Command;
use self::session::Session;
use super::asm::executable;
use super::cell_args::StepArgs;
use super::{Failure, print};

/// Runs a session of commands, from a script or from stdin. If the program has faulted in it, so has the command.
pub fn step(args: &StepArgs) -> Result<(), Failure> {
    let stdin_words = [&args.x, &args.y].into_iter().flatten().filter(|path| path.as_path() == Path::new("-")).count();
    if stdin_words > usize::from(args.script.is_some()) {
        let error = InputError::new("stdin can be only one of: the words on X, the words on Y, the commands");
        return Err(error.help("--script FILE takes the commands from a file").into());
    }
    let executable = executable(object::load(&args.file)?, args.machine.as_deref())?;
    let floats = executable.program().code.iter().any(|word| computes_in_floating_point(*word));
    let read = |path: &Option<PathBuf>| {
        let Some(path) = path else { return Ok(Vec::new()) };
        let words = words::read(path)?;
        if floats && words.are_all_whole() {
            eprintln!(
                "note: no word of {} has a point: `5` is the integer 5, and `5.0` the number that floating-point \
                 instructions, which the program has, take for 5",
                path.display()
            );
        }
        Ok::<_, InputError>(words.words)
    };
    let queues = Queues { x: read(&args.x)?, y: read(&args.y)?, ..Queues::default() };
    let mut session = Session::new(&executable, queues, args.instruction_limit.unwrap_or(Processor::INSTRUCTION_LIMIT));
    match &args.script {
        Some(path) => run_script(path, executable.program(), &mut session)?,
        None => converse(executable.program(), &mut session)?,
    }
    session.into_fault().map_or(Ok(()), |fault| Err(fault.into()))
}

/// Whether a word of a program is an instruction that computes in floating point.
fn computes_in_floating_point(word: u32) -> bool {
    let floating = [Class::FloatAdd, Class::FloatMultiply, Class::FloatDivide, Class::FloatCompare];
    Instruction::decode(word).is_ok_and(|instruction| floating.contains(&instruction.opcode.entry().class))
}

/// Runs commands from a file, all of which must be possible before the first is run.
fn run_script(path: &Path, program: &Program, session: &mut Session) -> Result<(), Failure> {
    let text = read_text(path)?;
    let mut commands = Vec::new();
    for (line, number) in text.lines().zip(1..) {
        let command = Command::parse(line, program)
            .map_err(|message| InputError::in_text(path, &text, number, 1, line.chars().count(), message))?;
        commands.extend(command.map(|command| (line, command)));
    }
    print(&session.here())?;
    for (line, command) in commands {
        print(&format!("> {line}\n"))?;
        if command == Command::Quit {
            break;
        }
        print(&session.execute(command))?;
    }
    Ok(())
}

/// Runs commands as they come on stdin. One that cannot be is said on stderr, and left out.
fn converse(program: &Program, session: &mut Session) -> Result<(), Failure> {
    let typed = std::io::stdin().is_terminal();
    print(&session.here())?;
    for line in prompted(typed) {
        let line = line.map_err(|error| InputError::new(format!("cannot read the commands: {error}")))?;
        if !typed {
            print(&format!("> {line}\n"))?;
        }
        match Command::parse(&line, program) {
            Ok(Some(Command::Quit)) => break,
            Ok(Some(command)) => print(&session.execute(command))?,
            Ok(None) => {}
            Err(message) => eprintln!("error: {message}"),
        }
    }
    Ok(())
}

/// The lines of stdin, with a prompt before each if a person types them.
fn prompted(typed: bool) -> impl Iterator<Item = std::io::Result<String>> {
    let mut lines = std::io::stdin().lock().lines();
    std::iter::from_fn(move || {
        if typed {
            eprint!("> ");
            let _ = std::io::stderr().flush();
        }
        lines.next()
    })
}
