//! The file of a sweep: for each parameter a value, a list of values or a range.

use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

use super::effective;
use super::parameters::{self, Parameter, Points, SweepFile};
use super::range::MOST_VALUES;
use crate::error::{InputError, Place};
use crate::input::fields;
use crate::input::reading::{self, FileRead};
use crate::isa::{Sources, assemble};
use crate::machine::{CapitanFile, Ipsc2File, MachineFile};
use crate::program::ArrayProgram;
use crate::report::table::{Column, Kind};
use crate::run::is_builtin;
use crate::scene::ReadOptions;

/// Letters of each half of a point's identity.
pub(super) const HALF: usize = 16;

/// The points of a sweep: every combination of its parameters' values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sweep {
    /// What its points are.
    pub of: Points,
    /// The parameters that it sets or varies.
    pub parameters: Vec<Parameter>,
    points: usize,
    /// The files that the points read, with what was in them when the sweep was read, by the value that names them.
    files: HashMap<(&'static str, String), Vec<FileRead>>,
}

impl Sweep {
    /// Reads the file of a sweep.
    pub fn read(path: &Path) -> Result<Sweep, InputError> {
        let file = fields::parse(path, &fields::read_text(path)?)?;
        let place = Some(Place { file: path.to_owned(), spot: None });
        Sweep::new(file).map_err(|error| InputError { place, ..error })
    }

    /// The sweep that JSON describes: an object as the file has it. `vet` sees each value with the name of its parameter, and may
    /// refuse it or put another in its place, before any file is looked for by it.
    pub fn from_json(
        value: serde_json::Value,
        mut vet: impl FnMut(&str, &mut String) -> Result<(), InputError>,
    ) -> Result<Sweep, InputError> {
        parameters::check(&value)?;
        let wrong = |error: serde_json::Error| InputError::new(error.to_string());
        let mut file: SweepFile = serde_json::from_value(value).map_err(wrong)?;
        for Parameter { column, values } in &mut file.parameters {
            values.iter_mut().try_for_each(|value| vet(column.name, value))?;
        }
        Sweep::new(file)
    }

    fn new(file: SweepFile) -> Result<Sweep, InputError> {
        let SweepFile { points: of, parameters } = file;
        let count: f64 = parameters.iter().map(|parameter| parameter.values.len() as f64).product();
        if count > MOST_VALUES as f64 {
            let error = InputError::new(format!("has {count} points, and may have up to {MOST_VALUES}"));
            return Err(error.help("a point is a combination of one value each"));
        }
        let files = files_of(&parameters);
        Ok(Sweep { of, parameters, points: count as usize, files })
    }

    /// The files that its points read, with those behind them, as they were when the sweep was read.
    pub fn files(&self) -> impl Iterator<Item = &FileRead> {
        self.files.values().flatten()
    }

    /// The columns of its table: the parameters, then the results.
    pub fn columns(&self) -> Vec<Column<'static>> {
        self.parameters.iter().map(|parameter| parameter.column).chain(self.results()).collect()
    }

    /// What its table tells of a point, behind the parameters: what the machine made of their values, and what came out.
    pub fn results(&self) -> Vec<Column<'static>> {
        [&effective::columns(self.of, &self.parameters), self.of.results()].concat()
    }

    /// How many points it has.
    pub fn points(&self) -> usize {
        self.points
    }

    /// The value of each parameter in a point. The last parameter changes fastest.
    pub fn point(&self, index: usize) -> Vec<String> {
        let mut rest = index;
        let mut values: Vec<String> = Vec::with_capacity(self.parameters.len());
        for Parameter { values: choices, .. } in self.parameters.iter().rev() {
            values.push(choices[rest % choices.len()].clone());
            rest /= choices.len();
        }
        values.reverse();
        values
    }

    /// What tells a point apart from all others: by its first half its values, by its second one what is in the files that they name
    /// and in those behind them. The same on any machine.
    pub fn identity(&self, index: usize) -> String {
        let names = self.parameters.iter().map(|parameter| parameter.column.name);
        let values: Vec<(&'static str, String)> = names.zip(self.point(index)).collect();
        let files: Vec<Option<&Vec<FileRead>>> = values.iter().map(|value| self.files.get(value)).collect();
        let half = |text: String| blake3::hash(text.as_bytes()).to_hex()[..HALF].to_owned();
        half(format!("{values:?}")) + &half(format!("{files:?}"))
    }

    /// The sweep as a file says it, its ranges written out.
    pub fn text(&self) -> String {
        let mut text = "(\n".to_owned();
        for Parameter { column, values } in &self.parameters {
            let quoted = values.iter().map(|value| match column.kind {
                Kind::Text => format!("{value:?}"),
                Kind::Truth | Kind::Whole | Kind::Number => value.clone(),
            });
            let list = quoted.collect::<Vec<_>>().join(", ");
            let _ = match values.len() {
                1 => writeln!(text, "    {}: {list},", column.name),
                _ => writeln!(text, "    {}: [{list}],", column.name),
            };
        }
        text + ")\n"
    }
}

/// The files that the points read, with what is in them.
fn files_of(parameters: &[Parameter]) -> HashMap<(&'static str, String), Vec<FileRead>> {
    let values = parameters
        .iter()
        .flat_map(|parameter| parameter.values.iter().map(|value| (parameter.column.name, value.clone())));
    let named = values.filter(|(name, value)| names_file(name, value) && Path::new(value).exists());
    named
        .map(|(name, value)| {
            let files = files_behind(name, Path::new(&value));
            ((name, value), files)
        })
        .collect()
}

/// Whether a value of a parameter is the name of a file.
fn names_file(name: &str, value: &str) -> bool {
    match name {
        "scene" => !is_builtin(value),
        "program" => ArrayProgram::standard(value).is_none(),
        _ => parameters::is_file(name),
    }
}

/// The files that a value of a parameter stands for. A pipe, which can be read but once, is left out.
fn files_behind(name: &str, path: &Path) -> Vec<FileRead> {
    if path.is_dir() {
        let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
        let mut files: Vec<FileRead> = entries.flat_map(|entry| files_behind(name, &entry.path())).collect();
        files.sort();
        return files;
    }
    if !path.is_file() {
        return Vec::new();
    }
    let (_, files) = reading::noting(|| match name {
        // A reader that fails has told what it read so far.
        "scene" => crate::scene::load(path, &ReadOptions::default()).map_or((), drop),
        "machine" => {
            // Of whichever kind it is: one that changes little of the standard file may be of several.
            let _ = (MachineFile::read(path).is_ok(), CapitanFile::read(path).is_ok(), Ipsc2File::read(path).is_ok());
        }
        "cell_programs" => assemble(path, Sources::Files, &[]).map_or((), drop),
        _ => fields::read_text(path).map_or((), drop),
    });
    files
}
