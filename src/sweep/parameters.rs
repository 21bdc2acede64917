//! The parameters that a sweep can vary, and what their values may be.

use std::fmt;
use std::sync::LazyLock;

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Unexpected, Visitor};

use super::range::{MOST_VALUES, Range};
use super::{cube_point, farm_point, point};
use crate::error::InputError;
use crate::parameters::{Kind as Form, ParameterInfo, named};
use crate::report::table::{Column, Kind};
use crate::run::{CubeMode, CubeRunOptions, FarmRunOptions, RunOptions};

/// A parameter that a sweep sets, and the values that it takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// Its column in the table, named like the command's flag, but with underscores.
    pub column: Column<'static>,
    /// Its values, as the flag takes them.
    pub values: Vec<String>,
}

/// What the points of a sweep are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Points {
    /// Runs of an array.
    Arrays,
    /// Farms of workers.
    Farms,
    /// Images on hypercubes.
    Cubes,
}

/// The file of a sweep: the parameters that it sets, in the order of tables.
pub(super) struct SweepFile {
    pub points: Points,
    pub parameters: Vec<Parameter>,
}

/// Whether a point is a whole image. It is one, too, if it has a parameter that only images have.
pub(super) const IMAGE: ParameterInfo = ParameterInfo { name: "image", kind: Form::Truth, label: "whole image" };

/// Whether a point is a farm. It is one, too, if it has a parameter that only farms have.
pub(super) const FARM: ParameterInfo = ParameterInfo { name: "farm", kind: Form::Truth, label: "farm" };

/// On which machine an image is, whose nodes have regions or share a memory.
pub(super) const ON: ParameterInfo = ParameterInfo { name: "on", kind: Form::Text, label: "machine" };

impl Points {
    /// All kinds, those first that others are told apart from.
    pub(super) const ALL: [Points; 3] = [Points::Arrays, Points::Farms, Points::Cubes];

    /// All that a sweep of such points can set, in the order of tables.
    fn parameters(self) -> Vec<&'static ParameterInfo> {
        let images = || [&IMAGE].into_iter().chain(RunOptions::image_parameters());
        match self {
            Points::Arrays => RunOptions::parameters().chain(images()).collect(),
            Points::Farms => [&FARM].into_iter().chain(FarmRunOptions::parameters()).collect(),
            Points::Cubes => [&ON].into_iter().chain(CubeRunOptions::parameters()).collect(),
        }
    }

    /// What a table tells of such a point, behind its parameters and what the machine made of them.
    pub(super) fn results(self) -> &'static [Column<'static>] {
        match self {
            Points::Arrays => &point::COLUMNS,
            Points::Farms => &farm_point::COLUMNS,
            Points::Cubes => &cube_point::COLUMNS,
        }
    }

    /// What a column of such points' table is called, if there is one of that name.
    pub(super) fn label(self, name: &str) -> Option<&'static str> {
        let of_parameters = self.parameters().into_iter().find(|known| known.name == name).map(|known| known.label);
        of_parameters.or_else(|| self.results().iter().find(|column| column.name == name).map(|column| column.label))
    }

    /// What such points are called.
    fn noun(self) -> &'static str {
        match self {
            Points::Arrays => "arrays",
            Points::Farms => "farms of workers",
            Points::Cubes => "hypercubes",
        }
    }

    fn has(self, name: &str) -> bool {
        self.parameters().iter().any(|known| known.name == name)
    }

    /// The kind of points that have all of some parameters, of which `modes` are the values of the mode.
    fn of(names: &[&str], modes: &[String]) -> Result<Points, String> {
        let has_all = |points: &Points| names.iter().all(|name| points.has(name));
        let is_cube = |mode: &String| mode.parse::<CubeMode>().is_ok();
        if names.contains(&ON.name) && modes.iter().all(is_cube) && has_all(&Points::Cubes) {
            return Ok(Points::Cubes);
        }
        if let Some(points) = Points::ALL.into_iter().find(has_all) {
            return Ok(points);
        }
        let apart = |one: Points, other: Points| names.iter().find(|name| one.has(name) && !other.has(name));
        let pairs = [(Points::Farms, Points::Arrays), (Points::Cubes, Points::Arrays), (Points::Cubes, Points::Farms)];
        let told = pairs.into_iter().find_map(|(one, other)| {
            let (of_one, of_other) = (apart(one, other)?, apart(other, one)?);
            Some(format!("{of_one} is for {} and {of_other} for {}", one.noun(), other.noun()))
        });
        let told = told.unwrap_or_else(|| "these parameters are for points of several kinds".to_owned());
        Err(format!("{told}: a sweep is of one or the other"))
    }
}

/// All parameters by their names, those of arrays first.
static KNOWN: LazyLock<Vec<&'static ParameterInfo>> = LazyLock::new(|| {
    let mut all: Vec<&'static ParameterInfo> = Vec::new();
    for known in Points::ALL.into_iter().flat_map(Points::parameters) {
        if all.iter().all(|earlier| earlier.name != known.name) {
            all.push(known);
        }
    }
    all
});

/// Whether there is a parameter of that name.
pub(super) fn is_known(name: &str) -> bool {
    KNOWN.iter().any(|known| known.name == name)
}

/// Whether the values of the parameter of that name are names of files.
pub(super) fn is_file(name: &str) -> bool {
    KNOWN.iter().any(|known| known.name == name && known.kind == Form::File)
}

/// Their names.
static NAMES: LazyLock<Vec<&'static str>> = LazyLock::new(|| KNOWN.iter().map(|known| known.name).collect());

/// Says what is wrong with the values of a sweep that stands in no file, and with which.
pub(super) fn check(sweep: &serde_json::Value) -> Result<(), InputError> {
    let fields =
        sweep.as_object().ok_or_else(|| InputError::new("a sweep is a value, a list or a range by parameter"))?;
    fields.iter().try_for_each(|(name, value)| {
        let known = named(KNOWN.iter().copied(), name)?;
        let values = known.kind.deserialize(value);
        values.map(drop).map_err(|error| InputError::new(format!("{name}: {error}")))
    })
}

impl<'de> Deserialize<'de> for SweepFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<SweepFile, D::Error> {
        struct Fields;
        impl<'de> Visitor<'de> for Fields {
            type Value = SweepFile;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the parameters of a sweep")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<SweepFile, A::Error> {
                let mut given: Vec<Option<Vec<String>>> = vec![None; NAMES.len()];
                while let Some(Name(index)) = map.next_key()? {
                    if given[index].is_some() {
                        return Err(A::Error::duplicate_field(NAMES[index]));
                    }
                    given[index] = Some(map.next_value_seed(KNOWN[index].kind)?);
                }
                SweepFile::new(given).map_err(A::Error::custom)
            }
        }
        deserializer.deserialize_struct("SweepFile", &NAMES, Fields)
    }
}

impl SweepFile {
    /// Takes the values of the parameters, in the order of [`KNOWN`].
    fn new(mut given: Vec<Option<Vec<String>>>) -> Result<SweepFile, String> {
        let named = KNOWN.iter().zip(&given).filter(|(_, values)| values.is_some());
        let names: Vec<&str> = named.map(|(known, _)| known.name).collect();
        let modes = NAMES.iter().position(|name| *name == "mode").and_then(|place| given[place].clone());
        let points = Points::of(&names, &modes.unwrap_or_default())?;
        let mut take = |known: &ParameterInfo| given[NAMES.iter().position(|name| *name == known.name)?].take();
        let all = points.parameters().into_iter();
        let parameter = |known: &'static ParameterInfo| {
            let values = take(known)?;
            let has_words = known.kind == Form::WholeOrWord && values.iter().any(|value| value.parse::<u64>().is_err());
            let kind = if has_words { Kind::Text } else { known.kind.into() };
            let column = Column { name: known.name, kind, label: known.label };
            Some(Parameter { column, values })
        };
        let parameters: Vec<Parameter> = all.filter_map(parameter).collect();
        let no_farm = |parameter: &Parameter| {
            parameter.column.name == FARM.name && parameter.values.iter().any(|value| value != "true")
        };
        match parameters.iter().any(no_farm) {
            true => Err("farm can only be true: leave it out for arrays".to_owned()),
            false => Ok(SweepFile { points, parameters }),
        }
    }
}

/// The place of a parameter among all.
struct Name(usize);

impl<'de> Deserialize<'de> for Name {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Name, D::Error> {
        struct Known;
        impl Visitor<'_> for Known {
            type Value = Name;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the name of a parameter")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<Name, E> {
                let place = NAMES.iter().position(|known| *known == name);
                place.map(Name).ok_or_else(|| E::unknown_field(name, &NAMES))
            }
        }
        deserializer.deserialize_identifier(Known)
    }
}

impl From<Form> for Kind {
    /// What the cells of a table's column hold, but for words in place of numbers.
    fn from(form: Form) -> Kind {
        match form {
            Form::Text | Form::File | Form::Size => Kind::Text,
            Form::Truth => Kind::Truth,
            Form::Whole | Form::WholeOrWord => Kind::Whole,
            Form::Number => Kind::Number,
        }
    }
}

impl Form {
    /// A whole number as a value.
    fn of_whole(self, value: u64) -> Option<String> {
        match self {
            Form::Whole | Form::WholeOrWord => i64::try_from(value).ok().map(|value| value.to_string()),
            Form::Number => Some(value.to_string()),
            Form::Size => Some(format!("{value}x{value}")),
            Form::Text | Form::File | Form::Truth => None,
        }
    }

    /// A number as a value.
    fn of_number(self, value: f64) -> Option<String> {
        match self {
            Form::Number => value.is_finite().then(|| value.to_string()),
            Form::Whole | Form::WholeOrWord | Form::Size if value.fract() == 0.0 && (0.0..9e15).contains(&value) => {
                self.of_whole(value as u64)
            }
            _ => None,
        }
    }
}

impl<'de> DeserializeSeed<'de> for Form {
    type Value = Vec<String>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Vec<String>, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Form {
    type Value = Vec<String>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Form::Text | Form::File => "a text in quotes, or a list of texts",
            Form::Size => "a size such as \"640x480\", a number of pixels for both sides, a list or a range",
            Form::Truth => "true, false, or a list of both",
            Form::Whole => {
                "a whole number, a list, or a range: (from: 1, to: 9, step: 2) or (from: 1, to: 64, times: 2)"
            }
            Form::WholeOrWord => "a whole number or a word in quotes, a list of them, or a range",
            Form::Number => "a number, a list, or a range: (from: 1, to: 9, step: 2) or (from: 1, to: 64, times: 2)",
        })
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Vec<String>, E> {
        match self {
            Form::Truth => Ok(vec![value.to_string()]),
            _ => Err(E::invalid_type(Unexpected::Bool(value), &self)),
        }
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Vec<String>, E> {
        let text = u64::try_from(value).map_or_else(|_| self.of_number(value as f64), |value| self.of_whole(value));
        text.map(|text| vec![text]).ok_or_else(|| E::invalid_value(Unexpected::Signed(value), &self))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Vec<String>, E> {
        let text = self.of_whole(value).map(|text| vec![text]);
        text.ok_or_else(|| E::invalid_value(Unexpected::Unsigned(value), &self))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Vec<String>, E> {
        let text = self.of_number(value).map(|text| vec![text]);
        text.ok_or_else(|| E::invalid_value(Unexpected::Float(value), &self))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Vec<String>, E> {
        match self {
            Form::Text | Form::File | Form::Size | Form::WholeOrWord if !value.is_empty() => Ok(vec![value.to_owned()]),
            _ => Err(E::invalid_type(Unexpected::Str(value), &self)),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<String>, A::Error> {
        let mut values = Vec::new();
        while let Some(more) = list.next_element_seed(self)? {
            values.extend(more);
            if values.len() > MOST_VALUES {
                return Err(A::Error::custom(format!("a parameter may have up to {MOST_VALUES} values")));
            }
        }
        if values.is_empty() { Err(A::Error::custom("a list needs at least one value")) } else { Ok(values) }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Vec<String>, A::Error> {
        let values = Range::deserialize(MapAccessDeserializer::new(map))?.values().map_err(A::Error::custom)?;
        let misfit = |value: f64| A::Error::invalid_value(Unexpected::Float(value), &self);
        values.into_iter().map(|value| self.of_number(value).ok_or_else(|| misfit(value))).collect()
    }
}
