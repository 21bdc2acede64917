//! What the files of machines have in common: each parameter is declared once, and a value that cannot be is told in one way.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use crate::error::InputError;
use crate::input::fields::Fault;
use crate::quantities::Cycles;

/// Declares a machine's parameters, each once: the machine file and the changes that are laid over it come of it.
///
/// A field of the file that may be missing has its `#[serde(default)]`; those among `optional` may be `None`, those among `host`
/// are 0 where they are missing. What only the file has stands among `beside`. The file has a `standard` one, and a way to `convert` it
/// that fails if it is impossible. Among its times are Figure 7's six.
///
/// A file that names a `base`, which is "standard" or another file, has only what differs from it.
macro_rules! machine_parameters {
    (
        $(#[$file_meta:meta])* pub struct $File:ident;
        $(#[$times_meta:meta])* pub struct $Times:ident;
        $(#[$options_meta:meta])* pub struct $Options:ident;
        values { $($(#[$meta:meta])* $name:ident: $type:ty, $value:literal, $kind:ident, $label:literal;)* }
        optional {
            $($(#[$maybe_meta:meta])* $maybe:ident: $maybe_type:ty, $maybe_value:literal, $maybe_kind:ident, $maybe_label:literal;)*
        }
        host { $($(#[$host_meta:meta])* $host:ident: $host_label:literal;)* }
        times_us { $($(#[$time_meta:meta])* $time:ident: $time_label:literal;)* }
        beside { $($(#[$beside_meta:meta])* $beside:ident: $beside_type:ty;)* }
    ) => {
        $(#[$file_meta])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $File {
            $($(#[$meta])* pub $name: $type,)*
            $($(#[$maybe_meta])* #[serde(default, skip_serializing_if = "Option::is_none")] pub $maybe: Option<$maybe_type>,)*
            $($(#[$host_meta])* #[serde(default)] pub $host: f64,)*
            $(#[$times_meta])*
            pub times_us: $Times,
            $($(#[$beside_meta])* pub $beside: $beside_type,)*
        }

        $(#[$times_meta])*
        #[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $Times {
            $($(#[$time_meta])* pub $time: f64,)*
        }

        $crate::parameters::parameters! {
            $(#[$options_meta])*
            pub struct $Options under "Machine" {
                $($(#[$meta])* $name: $type, $value, $kind, $label;)*
                $($(#[$maybe_meta])* $maybe: $maybe_type, $maybe_value, $maybe_kind, $maybe_label;)*
                $($(#[$host_meta])* $host: f64, "US", Number, $host_label;)*
                $($(#[$time_meta])* $time: f64, "US", Number, $time_label;)*
            }
        }

        impl $File {
            /// Reads the file of a machine, which must be a possible one.
            pub fn read(path: &Path) -> Result<$File, InputError> {
                $File::parse(path, &fields::read_text(path)?)
            }

            /// Reads the text of a machine file; `path` is for the errors, and its folder is where the file's `base` is looked for.
            pub fn parse(path: &Path, text: &str) -> Result<$File, InputError> {
                $File::parse_on(path, text, 0)
            }

            /// The same of a file on which so many others stand.
            fn parse_on(path: &Path, text: &str, others: usize) -> Result<$File, InputError> {
                let file = match $File::based(path, text, others)? {
                    Some(file) => file,
                    None => fields::parse(path, text)?,
                };
                file.convert().map_err(|fault| fault.in_text(path, text))?;
                Ok(file)
            }

            /// The machine of a text that only has what differs from another, its `base`. `None` if it names none.
            fn based(path: &Path, text: &str, others: usize) -> Result<Option<$File>, InputError> {
                #[derive(serde::Deserialize)]
                struct Named {
                    #[serde(default)]
                    base: Option<String>,
                }
                #[derive(Default, serde::Deserialize)]
                #[serde(deny_unknown_fields, default)]
                struct Times {
                    $($time: Option<f64>,)*
                }
                #[derive(serde::Deserialize)]
                #[serde(deny_unknown_fields)]
                struct Changes {
                    base: String,
                    $(#[serde(default)] $name: Option<$type>,)*
                    $(#[serde(default)] $maybe: Option<$maybe_type>,)*
                    $(#[serde(default)] $host: Option<f64>,)*
                    #[serde(default)]
                    times_us: Times,
                    $(#[serde(default)] $beside: Option<$beside_type>,)*
                }
                // What makes no sense is told of by who reads all of it.
                if !fields::parse::<Named>(path, text).is_ok_and(|named| named.base.is_some()) {
                    return Ok(None);
                }
                let changes: Changes = fields::parse(path, text)?;
                let mut file = match changes.base.as_str() {
                    "standard" => $File::standard()?,
                    name => {
                        let below = base_of(path, name, others)?;
                        $File::parse_on(&below, &fields::read_text(&below)?, others + 1)?
                    }
                };
                $(file.$name = changes.$name.unwrap_or(file.$name);)*
                $(file.$maybe = changes.$maybe.or(file.$maybe);)*
                $(file.$host = changes.$host.unwrap_or(file.$host);)*
                $(file.times_us.$time = changes.times_us.$time.unwrap_or(file.times_us.$time);)*
                $(file.$beside = changes.$beside.unwrap_or(file.$beside);)*
                Ok(Some(file))
            }
        }

        impl $Times {
            /// What the kernels take, of which `cycles` tells each, given its name and what the file says. The host's times are left at 0.
            fn kernels(
                &self,
                mut cycles: impl FnMut(&'static str, f64) -> Result<$crate::quantities::Cycles, Fault>,
            ) -> Result<$crate::machine::KernelTimes, Fault> {
                use $crate::machine::{HostTimes, KernelTimes, Times};
                Ok(KernelTimes {
                    grid: Times {
                        start: cycles("grid_start", self.grid_start)?,
                        each: cycles("grid_voxel", self.grid_voxel)?,
                    },
                    slabs: Times {
                        start: cycles("slabs_start", self.slabs_start)?,
                        each: cycles("slabs_polygon", self.slabs_polygon)?,
                    },
                    intersection: Times {
                        start: cycles("intersection_start", self.intersection_start)?,
                        each: cycles("intersection_polygon", self.intersection_polygon)?,
                    },
                    host: HostTimes::default(),
                    message: None,
                })
            }
        }

        impl $Options {
            /// Lays the changes over a machine file.
            pub fn change(&self, file: &mut $File) {
                $(file.$name = self.$name.unwrap_or(file.$name);)*
                $(file.$maybe = self.$maybe.or(file.$maybe);)*
                $(file.$host = self.$host.unwrap_or(file.$host);)*
                $(file.times_us.$time = self.$time.unwrap_or(file.times_us.$time);)*
            }
        }
    };
}

pub(super) use machine_parameters;

/// Files stand on each other no deeper: more are a circle.
const MOST_BASES: usize = 16;

/// Where the base of a machine file is, on which so many others stand.
pub(super) fn base_of(path: &Path, name: &str, others: usize) -> Result<PathBuf, InputError> {
    if others >= MOST_BASES {
        let error = InputError::in_file(path, format!("more than {MOST_BASES} machine files stand on each other"));
        return Err(error.help("a base must not stand on the file that names it"));
    }
    Ok(path.parent().unwrap_or(Path::new("")).join(name))
}

/// Fails if a whole number is outside its range.
pub(super) fn within(name: &'static str, value: u64, range: RangeInclusive<u64>) -> Result<(), Fault> {
    match range.contains(&value) {
        true => Ok(()),
        false => Err(impossible(name, value, format!("from {} to {}", range.start(), range.end()))),
    }
}

/// A value that no machine can have, and what it must be.
pub(super) fn impossible(name: &'static str, value: impl std::fmt::Display, range: impl std::fmt::Display) -> Fault {
    Fault::new(name, format!("impossible machine: {name} is {value}, it must be {range}"))
}

/// A unit of time in which a machine file gives times, and the machine's ticks that it has.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimeUnit {
    /// The unit's name.
    pub name: &'static str,
    /// How many ticks it has.
    pub ticks: f64,
    /// What a tick is called.
    pub tick: &'static str,
}

/// A time in whole ticks, rounded up, which may be no longer than `most` of them.
pub(super) fn time(
    name: &'static str,
    value: f64,
    (unit, most): (TimeUnit, u64),
    notes: &mut Vec<String>,
) -> Result<Cycles, Fault> {
    let longest = most as f64 / unit.ticks;
    if !(value.is_finite() && (0.0..=longest).contains(&value)) {
        return Err(impossible(name, value, format!("from 0 to {longest}")));
    }
    let (time, is_rounded) = rounded(value * unit.ticks);
    if is_rounded {
        notes.push(format!("{name}: {value} {} are no whole number of {}; rounded up to {time}", unit.name, unit.tick));
    }
    Ok(Cycles(time))
}

/// A number rounded up, and whether it had to be: what arithmetic with fractions has left over is none.
pub(super) fn rounded(exact: f64) -> (u64, bool) {
    let nearest = exact.round();
    let is_whole = (exact - nearest).abs() <= 1e-9 * exact.max(1.0);
    (if is_whole { nearest } else { exact.ceil() } as u64, !is_whole)
}
