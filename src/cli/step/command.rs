//! The commands of a session.

use pcs_sim::isa::{Program, number};

/// What `help` says.
pub const HELP: &str = "\
step [N]          execute an instruction, or N
run               go on to a breakpoint, or until the cell stands still
break [PLACE]     set a breakpoint, or take it away: LABEL, LINE of the
                  program's own file, @ADDRESS; alone: list them
list              the next instructions and their lines of source
registers         all registers that are not 0
queues            the words that come, and those written
memory PLACE [N]  N words of memory from an address or a label of data on
help              this
quit              the end
A semicolon begins a comment. `s`, `r`, `b`, `l`, `q` stand for step, run, break,
list, quit.
";

/// Words of memory that are shown if it is not said how many.
const MEMORY_WORDS: u32 = 8;

/// What can be asked of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    Step(u64),
    Run,
    /// Sets or removes the breakpoint at an address.
    Break(u32),
    Breakpoints,
    List,
    Registers,
    Queues,
    /// An address, and how many words.
    Memory(u32, u32),
    Help,
    Quit,
}

impl Command {
    /// The command that a line is, if it is not empty; or why it is none.
    pub fn parse(line: &str, program: &Program) -> Result<Option<Command>, String> {
        let words: Vec<&str> = line.split(';').next().unwrap_or("").split_whitespace().collect();
        let [name, operands @ ..] = words.as_slice() else { return Ok(None) };
        let command = match (*name, operands) {
            ("step" | "s", []) => Command::Step(1),
            ("step" | "s", [count]) => Command::Step(number(count)?.into()),
            ("run" | "r", []) => Command::Run,
            ("break" | "b", []) => Command::Breakpoints,
            ("break" | "b", [place]) => Command::Break(program.address_of(place)?),
            ("list" | "l", []) => Command::List,
            ("registers", []) => Command::Registers,
            ("queues", []) => Command::Queues,
            ("memory", [place]) => Command::Memory(data_address(place, program)?, MEMORY_WORDS),
            ("memory", [place, count]) => Command::Memory(data_address(place, program)?, number(count)?),
            ("help", []) => Command::Help,
            ("quit" | "q", []) => Command::Quit,
            _ => return Err(unknown(name)),
        };
        Ok(Some(command))
    }
}

/// What is wrong with a line that is no command: its name, or what follows.
fn unknown(name: &str) -> String {
    match HELP.lines().find(|line| line.split_whitespace().next() == Some(name)) {
        Some(usage) => format!("`{name}` is used so: {}", usage.split_whitespace().collect::<Vec<_>>().join(" ")),
        None => format!("there is no command `{name}`; `help` lists those that there are"),
    }
}

fn data_address(place: &str, program: &Program) -> Result<u32, String> {
    match program.data_labels.get(place) {
        Some(&address) => Ok(address),
        None if place.starts_with(|c: char| c.is_ascii_digit()) => number(place),
        None => Err(format!("the program's data has no label `{place}`")),
    }
}
