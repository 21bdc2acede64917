//! What is asked of a plot of a table, in words that the command and sweeps share.

use super::{Axes, find};
use crate::error::InputError;
use crate::report::plot::scale::Spread;
use crate::report::table::{Column, Table};

/// What of a table is drawn, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The columns.
    pub axes: Axes,
    /// Columns by their numbers, and the values that rows must have there.
    pub only: Vec<(usize, String)>,
    /// How it looks.
    pub look: Look,
}

/// How a plot looks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Look {
    /// Which axes are logarithmic, if that is not left to the numbers.
    pub log: Option<Log>,
    /// What values are relative to, if to anything.
    pub relative: Option<String>,
    /// Width and height in cm, if they are not left to the plot.
    pub cm: Option<(f64, f64)>,
}

/// The axes that are logarithmic; if neither is, both are even.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Log {
    /// From left to right.
    pub x: bool,
    /// From bottom to top.
    pub y: bool,
}

/// What `relative=` names for the first point of each line.
pub const FIRST: &str = "first";

/// The words that are no columns.
const WORDS: [&str; 7] = ["x", "y", "by", "facet", "log", "relative", "cm"];

/// The sides of a plot, in cm.
const SIDES: std::ops::RangeInclusive<f64> = 4.0..=100.0;

impl Choice {
    /// Reads words: `x=COLUMN y=COLUMN`, and as far as they are wanted `by=COLUMN facet=COLUMN log=y relative=first cm=16x10` and
    /// `COLUMN=VALUE`.
    ///
    /// # Errors
    ///
    /// If a word is none of these or comes twice, if x or y is missing, and if there is no such column.
    pub fn new(words: &[String], columns: &[Column]) -> Result<Choice, InputError> {
        let mut given: [Option<&str>; WORDS.len()] = Default::default();
        let mut only = Vec::new();
        for word in words {
            let (key, value) = word.split_once('=').ok_or_else(|| misplaced(word))?;
            match WORDS.iter().position(|known| *known == key) {
                Some(place) if given[place].is_none() && !value.is_empty() => given[place] = Some(value),
                Some(_) => return Err(misplaced(word)),
                None => only.push((find(columns, key)?, value.to_owned())),
            }
        }
        let [x, y, by, facet, log, relative, cm] = given;
        let (Some(x), Some(y)) = (x, y) else { return Err(misplaced(&words.join(" "))) };
        let look = Look {
            log: log.map(Log::new).transpose()?,
            relative: relative.map(str::to_owned),
            cm: cm.map(sides).transpose()?,
        };
        Ok(Choice { axes: Axes::new(columns, x, y, by)?.faceted(columns, facet)?, only, look })
    }

    /// The rows that are drawn.
    pub fn rows<'a>(&self, rows: &[&'a [String]]) -> Vec<&'a [String]> {
        let has_all = |row: &&&'a [String]| self.only.iter().all(|(column, value)| row[*column] == *value);
        rows.iter().filter(has_all).copied().collect()
    }

    /// What the plot shows, as a file's name: `rays_per_second-over-cells-by-mode`.
    pub fn name(&self, columns: &[Column]) -> String {
        let only: String =
            self.only.iter().map(|(column, value)| format!("-{}-{value}", columns[*column].name)).collect();
        let only = only.replace(|letter: char| !letter.is_alphanumeric() && !"-_.".contains(letter), "-");
        let how = [
            self.look.log.map(|log| format!("-log-{}", log.axes())),
            self.look.relative.as_ref().map(|_| "-relative".to_owned()),
        ];
        format!("{}{only}{}", self.axes.name(columns), how.into_iter().flatten().collect::<String>())
    }

    /// The drawn rows of a table.
    pub fn of<'a>(&self, table: &Table<'a>) -> Table<'a> {
        Table { columns: table.columns, rows: self.rows(&table.rows) }
    }
}

impl Log {
    fn new(axes: &str) -> Result<Log, InputError> {
        match axes {
            "x" => Ok(Log { x: true, y: false }),
            "y" => Ok(Log { x: false, y: true }),
            "xy" => Ok(Log { x: true, y: true }),
            "none" => Ok(Log { x: false, y: false }),
            _ => {
                let error = InputError::new(format!("log= takes x, y, xy or none, not '{axes}'"));
                Err(error.help("without it an axis is logarithmic where its numbers are spread like that"))
            }
        }
    }

    fn axes(self) -> &'static str {
        match (self.x, self.y) {
            (true, true) => "xy",
            (true, false) => "x",
            (false, true) => "y",
            (false, false) => "none",
        }
    }
}

impl Look {
    /// How numbers are spread along x, and along y: what is not named is left to them.
    pub fn spreads(&self) -> [Spread; 2] {
        let spread = |is_log: bool| if is_log { Spread::Logarithmic } else { Spread::OfItself };
        match self.log {
            None => [Spread::OfItself; 2],
            Some(Log { x: false, y: false }) => [Spread::Even; 2],
            Some(log) => [spread(log.x), spread(log.y)],
        }
    }
}

/// Two sides in cm: `16x10`.
fn sides(text: &str) -> Result<(f64, f64), InputError> {
    let side = |text: &str| text.parse::<f64>().ok().filter(|side| SIDES.contains(side));
    text.split_once('x').and_then(|(width, height)| Some((side(width)?, side(height)?))).ok_or_else(|| {
        let error = InputError::new(format!("cm= takes a width and a height in cm, such as 16x10, not '{text}'"));
        error.help(format!("a side has {} to {} cm", SIDES.start(), SIDES.end()))
    })
}

fn misplaced(words: &str) -> InputError {
    let error = InputError::new(format!("expected x=COLUMN y=COLUMN, not '{words}'"));
    error.help(
        "for example x=cells y=speed_up by=partition scene=teapot; also facet=COLUMN, log=y, relative=first, cm=16x10",
    )
}
