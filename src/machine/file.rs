//! What the files of machines have in common: each parameter is declared once, and a value that cannot be is told in one way.

use std::ops::RangeInclusive;

use crate::input::fields::Fault;

/// Declares a machine's parameters, each once: the machine file and the changes that are laid over it come of it.
///
/// A field of the file that may be missing has its `#[serde(default)]`; those among `optional` may be `None`, those among `host`
/// are 0 where they are missing. What only the file has stands among `beside`.
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
