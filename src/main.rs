//! The door: hands the command line to `cli`; `lab` is what its command of that name serves.

mod cli;
mod lab;

fn main() -> std::process::ExitCode {
    cli::main()
}
