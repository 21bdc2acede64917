//! The file of a sweep: for each parameter a value, a list of values or a range.

use std::path::Path;

use super::parameters::{MOST_VALUES, Parameter, Points, SweepFile};
use super::{farm_point, point};
use crate::error::InputError;
use crate::input::fields;
use crate::input::reading::{self, FileRead};
use crate::isa::{Sources, assemble};
use crate::report::table::Column;
use crate::scene::ReadOptions;

/// The points of a sweep: every combination of its parameters' values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sweep {
    /// What its points are.
    pub of: Points,
    /// The parameters that it sets or varies.
    pub parameters: Vec<Parameter>,
    points: usize,
}

impl Sweep {
    /// Reads the file of a sweep.
    pub fn read(path: &Path) -> Result<Sweep, InputError> {
        let file: SweepFile = fields::parse(path, &fields::read_text(path)?)?;
        let SweepFile { points: of, parameters } = file;
        let count = parameters.iter().try_fold(1usize, |count, parameter| count.checked_mul(parameter.values.len()));
        match count.filter(|&count| count <= MOST_VALUES) {
            Some(points) => Ok(Sweep { of, parameters, points }),
            None => {
                let error = InputError::in_file(path, format!("has more than {MOST_VALUES} points"));
                Err(error.help("a point is a combination of one value each"))
            }
        }
    }

    /// What its table tells of a point, behind the parameters.
    pub fn results(&self) -> &'static [Column<'static>] {
        match self.of {
            Points::Arrays => &point::COLUMNS,
            Points::Farms => &farm_point::COLUMNS,
        }
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

    /// What tells the sweep apart from all others: the program's version, the values, and what is in the files that they
    /// name and in those behind them.
    pub fn identity(&self) -> String {
        let parameters = self.parameters.iter().map(|parameter| (parameter.column.name, &parameter.values));
        let parameters: Vec<_> = parameters.collect();
        let files = self.files();
        let all = format!("{parameters:?} {files:?}");
        format!("{} {}", env!("CARGO_PKG_VERSION"), blake3::hash(all.as_bytes()).to_hex())
    }

    /// The files that the points read, with what is in them.
    fn files(&self) -> Vec<FileRead> {
        let named = self.parameters.iter().flat_map(|parameter| {
            parameter
                .values
                .iter()
                .filter(|value| Path::new(value).exists())
                .map(|value| (parameter.column.name, value))
        });
        named.flat_map(|(name, value)| files_behind(name, Path::new(value))).collect()
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
        "cell_programs" => assemble(path, Sources::Files, &[]).map_or((), drop),
        _ => fields::read_text(path).map_or((), drop),
    });
    files
}
