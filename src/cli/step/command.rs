//! The commands of a session.

use pcs_sim::isa::Program;

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
            ("break" | "b", [place]) => Command::Break(address_of(place, program)?),
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

fn number(text: &str) -> Result<u32, String> {
    let number = match text.strip_prefix("0x") {
        Some(digits) => u32::from_str_radix(digits, 16),
        None => text.parse(),
    };
    number.map_err(|_| format!("`{text}` is no number from 0 to {}", u32::MAX))
}

/// The instruction at a label, at an address, or the first at or behind a line of the program's own file.
fn address_of(place: &str, program: &Program) -> Result<u32, String> {
    if let Some(&address) = program.code_labels.get(place) {
        return Ok(address);
    }
    if let Some(address) = place.strip_prefix('@') {
        let (address, end) = (number(address)?, program.code.len() as u32);
        return if address < end { Ok(address) } else { Err(format!("the program ends before address {end}")) };
    }
    if !place.starts_with(|c: char| c.is_ascii_digit()) {
        return Err(format!("the program has no label `{place}`"));
    }
    let line = number(place)?;
    let lines = program.lines.iter().zip(0..).filter(|(at, _)| at.file == 0 && at.line >= line);
    let first = lines.min_by_key(|&(at, address)| (at.line, address));
    first.map(|(_, address)| address).ok_or_else(|| format!("no instruction stands in line {line} or behind it"))
}

fn data_address(place: &str, program: &Program) -> Result<u32, String> {
    match program.data_labels.get(place) {
        Some(&address) => Ok(address),
        None if place.starts_with(|c: char| c.is_ascii_digit()) => number(place),
        None => Err(format!("the program's data has no label `{place}`")),
    }
}
