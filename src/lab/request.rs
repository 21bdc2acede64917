//! What is asked for: the query of a URL, whose names and values are those of a run's parameters.

use std::sync::Arc;

use axum::Json;
use axum::extract::rejection::JsonRejection;
use axum::http::StatusCode;
use pcs_sim::error::InputError;
use pcs_sim::host::camera::ImageSize;
use pcs_sim::parameters::{Kind, ParameterInfo, named};
use pcs_sim::program::ArrayProgram;
use pcs_sim::run::{PlannedRun, RunOptions, RunSpec, moot};
use serde_json::{Map, Value};

use super::Lab;

/// Names with their values, in the order of the query.
pub type Pairs = Vec<(String, String)>;

/// Pixels that a picture may have: more are no matter of moments.
const MOST_PIXELS: u64 = 1 << 22;

/// A run that is asked for.
pub struct Asked {
    /// What is run.
    pub planned: PlannedRun,
    /// Parameters that it does not look at, with the reason.
    pub moot: Map<String, Value>,
    /// The command that does the same.
    pub command: String,
}

impl Asked {
    /// The run of a query.
    ///
    /// # Errors
    ///
    /// If a parameter is unknown, given twice, or no such value; if they make no run; if they name a file.
    pub fn new(lab: &Arc<Lab>, pairs: &Pairs) -> Result<Asked, InputError> {
        let mut options = RunOptions::default();
        for (at, (name, value)) in pairs.iter().enumerate() {
            let known = named(RunOptions::parameters(), name)?;
            if pairs[..at].iter().any(|(other, _)| other == name) {
                return Err(InputError::new(format!("{name} is given twice")));
            }
            check(known, value)?;
            options.set(name, value)?;
        }
        let mut spec = RunSpec::new(&options, None)?;
        let moot = moot_of(pairs, &options, &spec);
        let command = command(pairs.iter().filter(|(name, _)| !moot.contains_key(name)));
        spec.scene = lab.uploads.scene(spec.scene)?;
        Ok(Asked { planned: PlannedRun::new(spec)?, moot, command })
    }
}

/// Fails if the lab does not take a value of a parameter: names of files, so that nobody gets to see through it those of the machine
/// that it is on, and pictures that are too large.
pub fn check(known: &ParameterInfo, value: &str) -> Result<(), InputError> {
    let name = known.name;
    if known.kind == Kind::File && !(is_program(known) && ArrayProgram::standard(value).is_some()) {
        let error = InputError::new(format!("{name} names a file, and the lab reads none but scenes dropped on it"));
        return Err(error.help("the command takes it as a flag"));
    }
    let pixels = |size: ImageSize| u64::from(size.width) * u64::from(size.height);
    if name == "size" && value.parse().is_ok_and(|size| pixels(size) > MOST_PIXELS) {
        let error = InputError::new(format!("the lab's pictures have at most {MOST_PIXELS} pixels"));
        return Err(error.help("the command makes larger ones"));
    }
    Ok(())
}

/// What the body of a request says, or the answer to one that says nothing. One that is too long gets the error in the lab's words.
pub fn received<T>(
    lab: &Lab,
    body: Result<Json<T>, JsonRejection>,
    too_long: impl FnOnce() -> InputError,
) -> Result<T, (StatusCode, String)> {
    match body {
        Ok(Json(said)) => Ok(said),
        Err(error) if error.status() == StatusCode::PAYLOAD_TOO_LARGE => {
            Err((StatusCode::PAYLOAD_TOO_LARGE, lab.refusal(too_long())))
        }
        Err(error) => Err((error.status(), error.body_text())),
    }
}

/// Whether a parameter has values in the lab: those that name nothing but files have none.
pub fn is_of_lab(known: &ParameterInfo) -> bool {
    known.kind != Kind::File || is_program(known)
}

/// Whether its values may be the names of standard programs.
fn is_program(known: &ParameterInfo) -> bool {
    known.name == "program"
}

/// The parameters that the command would refuse beside the others, as the run would not look at them.
fn moot_of(pairs: &Pairs, options: &RunOptions, spec: &RunSpec) -> Map<String, Value> {
    let reason = |name: &str| {
        let mut alone = options.clone();
        alone.retain(|other| other == name);
        let resolution = spec.resolution.filter(|_| name == "resolution");
        let error = moot::check_run(&alone, &RunSpec { resolution, ..spec.clone() }).err()?;
        Some(Value::String(error.message))
    };
    pairs.iter().filter_map(|(name, _)| Some((name.clone(), reason(name)?))).collect()
}

/// The command line that runs the same.
fn command<'a>(pairs: impl Iterator<Item = &'a (String, String)>) -> String {
    let flags = pairs.filter(|(_, value)| value != "false").map(|(name, value)| {
        let flag = name.replace('_', "-");
        // A scene that was dropped is a file of its user's.
        let value = if name == "scene" { value.rsplit('/').next().unwrap_or(value) } else { value };
        if value == "true" { format!(" --{flag}") } else { format!(" --{flag} {}", quoted(value)) }
    });
    format!("pcs-sim{}", flags.collect::<String>())
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "_-./:,+@%".contains(letter);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_quoted_where_a_shell_would_read_more_into_them() {
        let pairs = [("scene", "ab12/a b.obj"), ("mailbox", "true"), ("order", "tiles:8"), ("fifo_words", "16")];
        let pairs: Pairs = pairs.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
        assert_eq!(command(pairs.iter()), "pcs-sim --scene 'a b.obj' --mailbox --order tiles:8 --fifo-words 16");
        assert_eq!(quoted("it's"), r"'it'\''s'");
    }
}
