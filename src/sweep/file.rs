//! The file of a sweep: for each parameter a value, a list of values or a range.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

use super::parameters::{MOST_VALUES, Parameter, SweepFile};
use crate::error::InputError;
use crate::input::fields;

/// The points of a sweep: every combination of its parameters' values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sweep {
    /// The parameters that it sets or varies.
    pub parameters: Vec<Parameter>,
    points: usize,
}

impl Sweep {
    /// Reads the file of a sweep.
    pub fn read(path: &Path) -> Result<Sweep, InputError> {
        let file: SweepFile = fields::parse(path, &fields::read_text(path)?)?;
        let parameters = file.parameters();
        let count = parameters.iter().try_fold(1usize, |count, parameter| count.checked_mul(parameter.values.len()));
        match count.filter(|&count| count <= MOST_VALUES) {
            Some(points) => Ok(Sweep { parameters, points }),
            None => {
                let error = InputError::in_file(path, format!("has more than {MOST_VALUES} points"));
                Err(error.help("a point is a combination of one value each"))
            }
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
    /// name.
    pub fn identity(&self) -> String {
        let parameters = self.parameters.iter().map(|parameter| (parameter.column.name, &parameter.values));
        let values = self.parameters.iter().flat_map(|parameter| &parameter.values);
        let files: Vec<(&String, u64)> = values.filter_map(|value| Some((value, digest(Path::new(value))?))).collect();
        format!("{} {:?} {files:x?}", env!("CARGO_PKG_VERSION"), parameters.collect::<Vec<_>>())
    }
}

/// A number that changes with a file's content; `None` if there is no such file.
fn digest(path: &Path) -> Option<u64> {
    let content = path.is_file().then(|| std::fs::read(path).ok())??;
    let mut hasher = DefaultHasher::new();
    content.hash(&mut hasher);
    Some(hasher.finish())
}
