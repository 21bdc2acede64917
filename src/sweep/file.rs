//! The file of a sweep: for each parameter a value, a list of values or a range.

use std::fmt;
use std::path::Path;

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, SeqAccess, Visitor};

use crate::error::InputError;
use crate::input::fields;

/// The points of a sweep: every combination of its parameters' values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sweep {
    /// The parameters that vary or are set, named like the command's flags, but with underscores.
    pub names: Vec<&'static str>,
    /// For each point, the value of each parameter. The last parameter changes fastest.
    pub points: Vec<Vec<String>>,
}

/// More points are surely a mistake.
const MOST_POINTS: usize = 1_000_000;

macro_rules! parameters {
    ($($name:ident),* $(,)?) => {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct SweepFile {
            $(#[serde(default, deserialize_with = "given")] $name: Option<Values>,)*
        }

        impl SweepFile {
            /// The parameters that the file names, in the order of tables.
            fn given(self) -> Vec<(&'static str, Vec<String>)> {
                let all = [$((stringify!($name), self.$name)),*];
                all.into_iter().filter_map(|(name, values)| values.map(|values| (name, values.0))).collect()
            }
        }
    };
}

parameters! {
    scene, size_factor, resolution, size, rays,
    mode, program, cells, groups, partition, grid_coefficient, mailbox, cells_run,
    machine, clock_ns, word_bytes, fifo_words, link_mb_s, rate_counts, latency_cycles, memory_words,
    host_ray_us, host_hit_us,
    grid_start, grid_voxel, slabs_start, slabs_polygon, intersection_start, intersection_polygon,
}

impl Sweep {
    /// Reads the file of a sweep.
    pub fn read(path: &Path) -> Result<Sweep, InputError> {
        let file: SweepFile = fields::parse(path, &fields::read_text(path)?)?;
        let given = file.given();
        let count = given.iter().try_fold(1usize, |count, (_, values)| count.checked_mul(values.len()));
        if !count.is_some_and(|count| (1..=MOST_POINTS).contains(&count)) {
            let message = format!("has no point, or more than {MOST_POINTS}");
            return Err(InputError::in_file(path, message).help("a point is a combination of one value each"));
        }
        let names = given.iter().map(|(name, _)| *name).collect();
        let points = given.iter().fold(vec![Vec::new()], |points: Vec<Vec<String>>, (_, values)| {
            let with = |point: &Vec<String>, value: &String| [point.as_slice(), std::slice::from_ref(value)].concat();
            points.iter().flat_map(|point| values.iter().map(|value| with(point, value))).collect()
        });
        Ok(Sweep { names, points })
    }
}

/// A field that is there needs no `Some`.
fn given<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Values>, D::Error> {
    Values::deserialize(deserializer).map(Some)
}

/// The values of one parameter, as the command line takes them.
struct Values(Vec<String>);

impl<'de> Deserialize<'de> for Values {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Values, D::Error> {
        deserializer.deserialize_any(ValuesVisitor)
    }
}

struct ValuesVisitor;

impl<'de> Visitor<'de> for ValuesVisitor {
    type Value = Values;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a value, a list of values, or a range: (from: 1, to: 9, step: 2) or (from: 1, to: 64, times: 2)")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Values, E> {
        Ok(Values(vec![value.to_string()]))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Values, E> {
        Ok(Values(vec![value.to_string()]))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Values, E> {
        Ok(Values(vec![value.to_string()]))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Values, E> {
        Ok(Values(vec![value.to_string()]))
    }

    fn visit_str<E>(self, value: &str) -> Result<Values, E> {
        Ok(Values(vec![value.to_owned()]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Values, A::Error> {
        let mut values = Vec::new();
        while let Some(Values(value)) = list.next_element()? {
            values.extend(value);
        }
        Ok(Values(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Values, A::Error> {
        let range = Range::deserialize(serde::de::value::MapAccessDeserializer::new(map))?;
        range.values().map(Values).map_err(serde::de::Error::custom)
    }
}

/// Values from one to another, both included.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Range {
    from: f64,
    to: f64,
    #[serde(default)]
    step: f64,
    #[serde(default = "one")]
    times: f64,
}

fn one() -> f64 {
    1.0
}

impl Range {
    fn values(&self) -> Result<Vec<String>, String> {
        let next = |value: f64| value * self.times + self.step;
        let rises = |value: f64| next(value) > value;
        let end = self.to + 1e-9 * self.to.abs();
        let values = std::iter::successors(Some(self.from), |&value| rises(value).then(|| next(value)));
        let values: Vec<f64> = values.take_while(|&value| value <= end).take(MOST_POINTS).collect();
        match values.last() {
            Some(&last) if rises(last) => Ok(values.iter().map(|value| rounded(*value).to_string()).collect()),
            _ => Err("a range needs from, to, and a step above 0 or times above 1".to_owned()),
        }
    }
}

/// Sums of decimal fractions without the dust of binary ones.
fn rounded(value: f64) -> f64 {
    format!("{value:.12e}").parse().unwrap_or(value)
}
