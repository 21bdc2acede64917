//! From a table to lines of points.

use std::collections::HashMap;

use super::Axes;
use crate::report::palette;
use crate::report::plot::scale::Positions;
use crate::report::table::Table;

/// More lines cannot be told apart: every colour with every marker.
const MOST_LINES: usize = 4 * palette::LINES.len();

/// All that is drawn.
#[derive(Debug)]
pub struct Curves {
    /// A line for each value of `by`, in the order in which they come first.
    pub lines: Vec<Line>,
    /// What stands along x.
    pub x: Positions,
    /// How many rows are left out, as they lack a value.
    pub left_out: usize,
    /// Whether some point stands for rows that differ.
    pub has_spread: bool,
}

/// A line.
#[derive(Debug, Default)]
pub struct Line {
    /// The value of `by`.
    pub name: String,
    /// Its points from left to right.
    pub spots: Vec<Spot>,
}

/// A point of a line: the rows that have the same x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    pub x: f64,
    pub mean: f64,
    pub low: f64,
    pub high: f64,
}

impl Curves {
    pub fn new(table: &Table<'_>, axes: &Axes) -> Result<Curves, String> {
        let mut words = Words::default();
        let in_numbers = table.columns[axes.x].is_number();
        let mut lines = Words::default();
        let mut found: Vec<Vec<(f64, f64)>> = Vec::new();
        for row in &table.rows {
            let (x, y) = (&row[axes.x], row[axes.y].parse::<f64>().ok().filter(|y| y.is_finite()));
            let (Some(y), false) = (y, x.is_empty()) else { continue };
            let x = if in_numbers { x.parse().unwrap_or(0.0) } else { words.number_of(x) as f64 };
            let line = lines.number_of(axes.by.map_or("", |by| row[by].as_str()));
            found.resize_with(found.len().max(line + 1), Vec::new);
            found[line].push((x, y));
        }
        if found.is_empty() {
            return Err("there is nothing to draw: no point has a value for it".to_owned());
        }
        if found.len() > MOST_LINES {
            return Err(format!("by= gives {} lines; {MOST_LINES} can be told apart", found.len()));
        }
        let drawn: usize = found.iter().map(Vec::len).sum();
        let lines: Vec<Line> =
            lines.words.into_iter().zip(found).map(|(name, rows)| Line { name, spots: spots(rows) }).collect();
        let x = if in_numbers { Positions::Numbers(numbers(&lines)) } else { Positions::Words(words.words) };
        let has_spread = lines.iter().flat_map(|line| &line.spots).any(|spot| spot.low < spot.high);
        Ok(Curves { lines, x, left_out: table.rows.len() - drawn, has_spread })
    }

    /// All points.
    pub fn spots(&self) -> impl Iterator<Item = &Spot> + Clone {
        self.lines.iter().flat_map(|line| &line.spots)
    }
}

/// Words in the order in which they come first.
#[derive(Default)]
struct Words {
    words: Vec<String>,
    numbers: HashMap<String, usize>,
}

impl Words {
    fn number_of(&mut self, word: &str) -> usize {
        if let Some(&number) = self.numbers.get(word) {
            return number;
        }
        self.numbers.insert(word.to_owned(), self.words.len());
        self.words.push(word.to_owned());
        self.words.len() - 1
    }
}

/// Rows with the same x as one point.
fn spots(mut rows: Vec<(f64, f64)>) -> Vec<Spot> {
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let spot = |rows: &[(f64, f64)]| Spot {
        x: rows[0].0,
        mean: rows.iter().map(|row| row.1).sum::<f64>() / rows.len() as f64,
        low: rows.iter().map(|row| row.1).fold(f64::INFINITY, f64::min),
        high: rows.iter().map(|row| row.1).fold(f64::NEG_INFINITY, f64::max),
    };
    rows.chunk_by(|a, b| a.0 == b.0).map(spot).collect()
}

/// All x, rising, each once.
fn numbers(lines: &[Line]) -> Vec<f64> {
    let mut all: Vec<f64> = lines.iter().flat_map(|line| &line.spots).map(|spot| spot.x).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::table::{Column, Kind};

    const COLUMNS: [Column; 3] = [
        Column { name: "cells", kind: Kind::Whole, label: "cells" },
        Column { name: "mode", kind: Kind::Text, label: "mode" },
        Column { name: "rate", kind: Kind::Number, label: "rate" },
    ];

    fn curves(rows: &[[&str; 3]], x: &str, by: Option<&str>) -> Result<Curves, String> {
        let rows: Vec<Vec<String>> = rows.iter().map(|row| row.map(str::to_owned).into()).collect();
        let table = Table { columns: &COLUMNS, rows: rows.iter().map(Vec::as_slice).collect() };
        Curves::new(&table, &Axes::new(&COLUMNS, x, "rate", by).unwrap())
    }

    #[test]
    fn rows_with_the_same_place_are_one_point() {
        let rows = [["8", "b", "3"], ["4", "p", "1"], ["8", "b", "5"], ["8", "b", ""], ["4", "b", "2"]];
        let curves = curves(&rows, "cells", Some("mode")).unwrap();
        assert_eq!(curves.lines.iter().map(|line| line.name.as_str()).collect::<Vec<_>>(), ["b", "p"]);
        let spot = |x, mean, low, high| Spot { x, mean, low, high };
        assert_eq!(curves.lines[0].spots, [spot(4.0, 2.0, 2.0, 2.0), spot(8.0, 4.0, 3.0, 5.0)]);
        assert_eq!(curves.lines[1].spots, [spot(4.0, 1.0, 1.0, 1.0)]);
        assert_eq!((curves.left_out, curves.has_spread), (1, true));
    }

    #[test]
    fn words_stand_side_by_side() {
        let curves = curves(&[["8", "p", "3"], ["4", "b", "1"], ["4", "p", "3"]], "mode", None).unwrap();
        let Positions::Words(words) = &curves.x else { panic!("{curves:?}") };
        assert_eq!(words, &["p", "b"]);
        assert_eq!(
            curves.lines[0].spots.iter().map(|spot| (spot.x, spot.mean)).collect::<Vec<_>>(),
            [(0.0, 3.0), (1.0, 1.0)]
        );
        assert!(!curves.has_spread);
    }

    #[test]
    fn nothing_and_too_much_are_refused() {
        assert!(curves(&[["8", "p", ""]], "cells", None).unwrap_err().contains("nothing to draw"));
        let names: Vec<String> = (0..29).map(|n| n.to_string()).collect();
        let rows: Vec<[&str; 3]> = names.iter().map(|name| ["1", name.as_str(), "1"]).collect();
        assert!(curves(&rows, "cells", Some("mode")).unwrap_err().contains("29 lines; 28"));
    }
}
