//! Parameters, each declared once: the flag, the field of a file and the column of a table are views of its declaration.

use crate::error::InputError;
use crate::input::ron_text::suggest;

/// What the values of a parameter look like.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A text.
    Text,
    /// The name of a file or a folder; a few have names for what comes with the simulator, too.
    File,
    /// Width and height of an image; a number is both.
    Size,
    /// True or false.
    Truth,
    /// A whole number.
    Whole,
    /// A whole number, or a word that stands for one.
    WholeOrWord,
    /// A number.
    Number,
}

/// What is known of a parameter beside its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParameterInfo {
    /// Its name: that of the flag, but with underscores.
    pub name: &'static str,
    /// What its values look like.
    pub kind: Kind,
    /// What it is, with its unit, in the words of a table's column.
    pub label: &'static str,
}

/// The one of some parameters that has a name, or what may have been meant by it.
pub fn named<'a>(
    known: impl IntoIterator<Item = &'a ParameterInfo>,
    name: &str,
) -> Result<&'a ParameterInfo, InputError> {
    let known: Vec<&ParameterInfo> = known.into_iter().collect();
    known.iter().find(|known| known.name == name).copied().ok_or_else(|| {
        let names: Vec<&str> = known.iter().map(|known| known.name).collect();
        suggest(InputError::new(format!("unknown parameter `{name}`")), name, &names, "parameters")
    })
}

/// Declares a group of parameters, of which any may be left out. For each: what it is (the help of its flag), its name,
/// the type of its value, the word that stands for the value in the help, what its values look like, and its column.
macro_rules! parameters {
    (
        $(#[$outer:meta])*
        pub struct $Group:ident under $heading:literal {
            $($(#[$meta:meta])* $name:ident: $type:ty, $value:literal, $kind:ident, $label:literal;)*
        }
    ) => {
        $(#[$outer])*
        #[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields, default)]
        #[cfg_attr(feature = "cli", derive(clap::Args), command(next_help_heading = $heading))]
        pub struct $Group {
            $(
                $(#[$meta])*
                #[serde(skip_serializing_if = "Option::is_none")]
                #[cfg_attr(feature = "cli", arg(long, value_name = $value))]
                pub $name: Option<$type>,
            )*
        }

        impl $Group {
            /// The parameters, in the order of tables.
            pub const PARAMETERS: &[$crate::parameters::ParameterInfo] = &[$(
                $crate::parameters::ParameterInfo {
                    name: stringify!($name),
                    kind: $crate::parameters::Kind::$kind,
                    label: $label,
                },
            )*];

            /// Gives a parameter the value that a text stands for. False if there is no such parameter.
            ///
            /// Fails if the text is no such value.
            pub fn set(&mut self, name: &str, text: &str) -> Result<bool, $crate::error::InputError> {
                match name {
                    $(stringify!($name) => self.$name = Some($crate::parameters::value(name, text)?),)*
                    _ => return Ok(false),
                }
                Ok(true)
            }

            /// Whether a parameter was given.
            pub fn has(&self, name: &str) -> bool {
                match name {
                    $(stringify!($name) => self.$name.is_some(),)*
                    _ => false,
                }
            }

            /// Takes back the parameters that are not to be kept.
            pub fn retain(&mut self, keep: impl Fn(&str) -> bool) {
                $(self.$name = self.$name.take().filter(|_| keep(stringify!($name)));)*
            }
        }
    };
}

pub(crate) use parameters;

/// The value that a text stands for.
pub(crate) fn value<T: std::str::FromStr>(name: &str, text: &str) -> Result<T, InputError>
where
    T::Err: std::fmt::Display,
{
    text.parse().map_err(|error| InputError::new(format!("invalid value '{text}' for {name}: {error}")))
}
