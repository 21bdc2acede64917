//! From a table to lines of points.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::Axes;
use super::choice::{FIRST, Look};
use crate::report::palette;
use crate::report::plot::MOST_PANELS;
use crate::report::plot::scale::Positions;
use crate::report::table::{Kind, Table};

/// More lines cannot be told apart: every colour with every marker.
const MOST_LINES: usize = 4 * palette::LINES.len();

/// Columns that advice names, at the most.
const MOST_NAMED: usize = 4;

/// All that is drawn.
#[derive(Debug)]
pub struct Curves {
    /// The panels, in the order in which the values of `facet` come first; one without a name if there is none.
    pub panels: Vec<Panel>,
    /// The names of the lines, in the order in which they come first.
    pub lines: Vec<String>,
    /// What stands along x.
    pub x: Positions,
    /// How many rows are left out, as they lack a value.
    pub left_out: usize,
    /// The column whose values have a line each.
    pub by: Option<usize>,
}

/// A panel.
#[derive(Debug)]
pub struct Panel {
    /// The value of `facet`.
    pub name: String,
    /// For each line its points from left to right.
    pub lines: Vec<Vec<Spot>>,
}

/// A point of a line.
pub type Spot = (f64, f64);

/// A row that has values: its place, its line and its panel.
struct Entry<'a> {
    row: &'a [String],
    spot: Spot,
    line: usize,
    panel: usize,
}

impl Curves {
    /// Takes the rows of a table apart.
    ///
    /// A point stands for one row, or for several that agree. Where rows that do not agree come to the same place, they get
    /// lines of their own if one column tells them apart and there are no lines yet; else it fails, and says what to do.
    pub fn new(table: &Table<'_>, axes: &Axes, look: &Look) -> Result<Curves, String> {
        let by = axes.by.or_else(|| apart(table, axes));
        let axes = Axes { by, ..*axes };
        let mut words = Words::default();
        let (mut lines, mut panels) = (Words::default(), Words::default());
        let in_numbers = table.columns[axes.x].is_number();
        let mut entries = Vec::new();
        for &row in &table.rows {
            let Some(y) = value(row, &axes) else { continue };
            let x = &row[axes.x];
            let x = if in_numbers { x.parse().unwrap_or(0.0) } else { words.number_of(x) as f64 };
            let text = |column: Option<usize>| column.map_or("", |column| row[column].as_str());
            let (line, panel) = (lines.number_of(text(axes.by)), panels.number_of(text(axes.facet)));
            entries.push(Entry { row, spot: (x, y), line, panel });
        }
        if entries.is_empty() {
            return Err("there is nothing to draw: no point has a value for it".to_owned());
        }
        if lines.words.len() > MOST_LINES {
            return Err(format!("by= gives {} lines; {MOST_LINES} can be told apart", lines.words.len()));
        }
        if panels.words.len() > MOST_PANELS {
            return Err(format!("facet= gives {} panels; a plot has {MOST_PANELS} at the most", panels.words.len()));
        }
        check_places(table, &axes, &entries)?;
        let mut found = vec![vec![Vec::new(); lines.words.len()]; panels.words.len()];
        entries.iter().for_each(|entry| found[entry.panel][entry.line].push(entry.spot));
        found.iter_mut().flatten().for_each(sort);
        if let Some(base) = &look.relative {
            relate(&mut found, base, &lines.words)?;
        }
        let named = panels.words.into_iter().zip(found);
        let panels: Vec<Panel> = named.map(|(name, lines)| Panel { name, lines }).collect();
        let x = if in_numbers { Positions::Numbers(numbers(&panels)) } else { Positions::Words(words.words) };
        let drawn = if look.relative.is_some() {
            panels.iter().flat_map(|p| &p.lines).flatten().count()
        } else {
            entries.len()
        };
        Ok(Curves { panels, lines: lines.words, x, left_out: table.rows.len() - drawn.min(table.rows.len()), by })
    }

    /// All points.
    pub fn spots(&self) -> impl Iterator<Item = &Spot> + Clone {
        self.panels.iter().flat_map(|panel| &panel.lines).flatten()
    }
}

/// A row's y, if it has one, and an x.
fn value(row: &[String], axes: &Axes) -> Option<f64> {
    let y = row[axes.y].parse::<f64>().ok().filter(|y| y.is_finite())?;
    (!row[axes.x].is_empty()).then_some(y)
}

/// The column that tells rows apart which come to the same place without it, if there are such rows: the first that does, as
/// tables begin with what their rows were made of. None if no column does it alone.
fn apart(table: &Table<'_>, axes: &Axes) -> Option<usize> {
    let rows: Vec<&[String]> = table.rows.iter().copied().filter(|row| value(row, axes).is_some()).collect();
    let agrees = |by: Option<usize>| {
        let mut places = HashMap::new();
        let key =
            |row: &[String]| [Some(axes.x), axes.facet, by].map(|column| column.map(|column| row[column].clone()));
        rows.iter().all(|&row| *places.entry(key(row)).or_insert(&row[axes.y]) == &row[axes.y])
    };
    if agrees(None) {
        return None;
    }
    let mut free =
        (0..table.columns.len()).filter(|column| !axes.uses(*column) && is_given(table, axes, *column, &rows));
    free.find(|&column| agrees(Some(column)))
}

/// Whether a column may be what rows were made of, and not what came out as y did: it stands before y, and has words, or numbers
/// that come again.
fn is_given(table: &Table<'_>, axes: &Axes, column: usize, rows: &[&[String]]) -> bool {
    let values: HashSet<&String> = rows.iter().map(|row| &row[column]).collect();
    column < axes.y
        && values.len() > 1
        && (matches!(table.columns[column].kind, Kind::Text | Kind::Truth) || 2 * values.len() <= rows.len())
}

/// Fails if rows that do not agree come to the same place.
fn check_places(table: &Table<'_>, axes: &Axes, entries: &[Entry<'_>]) -> Result<(), String> {
    let mut places: BTreeMap<(u64, usize, usize), Vec<&Entry<'_>>> = BTreeMap::new();
    for entry in entries {
        places.entry((entry.spot.0.to_bits(), entry.line, entry.panel)).or_default().push(entry);
    }
    let differ = |place: &&Vec<&Entry<'_>>| place.iter().any(|entry| entry.spot.1 != place[0].spot.1);
    let Some(place) = places.values().find(differ) else { return Ok(()) };
    let rows: Vec<&[String]> = entries.iter().map(|entry| entry.row).collect();
    let differs = |column: &usize| place.iter().any(|entry| entry.row[*column] != place[0].row[*column]);
    let columns = (0..table.columns.len()).filter(|column| !axes.uses(*column)).filter(differs);
    let given: Vec<usize> = columns.clone().filter(|column| is_given(table, axes, *column, &rows)).collect();
    let told: Vec<usize> = if given.is_empty() { columns.collect() } else { given };
    let names: Vec<&str> = told.iter().map(|column| table.columns[*column].name).take(MOST_NAMED).collect();
    let column = &table.columns[axes.x].name;
    let here = format!("{} rows have the same place at {column}={}", place.len(), place[0].row[axes.x]);
    let Some(first) = told.first() else { return Err(format!("{here} and nothing but y in which they differ")) };
    let one = format!("{}={}", names[0], place[0].row[*first]);
    let ways = [
        axes.by.is_none().then(|| format!("by={} for a line each", names[0])),
        axes.facet.is_none().then(|| format!("facet={} for a panel each", names[0])),
        Some(format!("{one} for just these")),
    ];
    let ways = ways.into_iter().flatten().collect::<Vec<_>>().join(", ");
    Err(format!("{here}, and differ in {}: a point that averages would hide that. Say {ways}", names.join(", ")))
}

/// Sorts a line's points; those that agree are one.
fn sort(line: &mut Vec<Spot>) {
    line.sort_by(|a, b| a.0.total_cmp(&b.0));
    line.dedup();
}

/// Divides all values by those of a line at the same x, or each line's by its first.
fn relate(found: &mut [Vec<Vec<Spot>>], base: &str, names: &[String]) -> Result<(), String> {
    let line = names.iter().position(|name| name == base);
    if line.is_none() && base != FIRST {
        let names = names.iter().filter(|name| !name.is_empty()).map(String::as_str);
        let known: Vec<&str> = [FIRST].into_iter().chain(names).take(MOST_LINES).collect();
        return Err(format!("relative= names no line '{base}'; there are {}", known.join(", ")));
    }
    for panel in found {
        let bases = line.map(|line| panel[line].clone());
        for line in panel.iter_mut() {
            let first = line.first().map(|spot| spot.1);
            let base = |x: f64| match &bases {
                Some(bases) => bases.iter().find(|spot| spot.0 == x).map(|spot| spot.1),
                None => first,
            };
            let related = |&(x, y): &Spot| Some((x, y / base(x).filter(|base| *base != 0.0)?));
            *line = line.iter().filter_map(related).collect();
        }
    }
    Ok(())
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

/// All x, rising, each once.
fn numbers(panels: &[Panel]) -> Vec<f64> {
    let mut all: Vec<f64> = panels.iter().flat_map(|panel| &panel.lines).flatten().map(|spot| spot.0).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::plot::curves::Choice;
    use crate::report::table::Column;

    const COLUMNS: [Column; 4] = [
        Column { name: "cells", kind: Kind::Whole, label: "cells" },
        Column { name: "mode", kind: Kind::Text, label: "mode" },
        Column { name: "scene", kind: Kind::Text, label: "scene" },
        Column { name: "rate", kind: Kind::Number, label: "rate" },
    ];

    fn curves(rows: &[[&str; 4]], words: &str) -> Result<Curves, String> {
        let rows: Vec<Vec<String>> = rows.iter().map(|row| row.map(str::to_owned).into()).collect();
        let table = Table { columns: &COLUMNS, rows: rows.iter().map(Vec::as_slice).collect() };
        let words: Vec<String> = words.split(' ').map(str::to_owned).collect();
        let choice = Choice::new(&words, &COLUMNS).unwrap();
        Curves::new(&choice.of(&table), &choice.axes, &choice.look)
    }

    #[test]
    fn rows_that_agree_are_one_point() {
        let rows = [
            ["8", "b", "r", "3"],
            ["4", "p", "r", "1"],
            ["8", "b", "r", "3"],
            ["8", "b", "r", ""],
            ["4", "b", "r", "2"],
        ];
        let curves = curves(&rows, "x=cells y=rate by=mode").unwrap();
        assert_eq!(curves.lines, ["b", "p"]);
        assert_eq!(curves.panels[0].lines, [vec![(4.0, 2.0), (8.0, 3.0)], vec![(4.0, 1.0)]]);
        assert_eq!(curves.left_out, 1);
    }

    const TWO_SCENES: [[&str; 4]; 6] = [
        ["4", "b", "room", "1"],
        ["8", "b", "room", "2"],
        ["4", "b", "lake", "10"],
        ["8", "b", "lake", "30"],
        ["4", "p", "room", "5"],
        ["4", "p", "lake", "6"],
    ];

    #[test]
    fn no_point_is_a_mean_of_rows_that_differ() {
        // One column tells the rows apart: its values have a line each.
        let one = curves(&TWO_SCENES, "x=cells y=rate mode=b").unwrap();
        assert_eq!((one.lines, one.by), (vec!["room".to_owned(), "lake".to_owned()], Some(2)));
        let refused = curves(&TWO_SCENES, "x=cells y=rate by=mode").unwrap_err();
        assert!(
            refused.contains("differ in scene") && refused.contains("facet=scene") && refused.contains("scene=room")
        );
        let refused = curves(&TWO_SCENES, "x=cells y=rate").unwrap_err();
        assert!(refused.contains("differ in mode, scene") && refused.contains("by=mode"), "{refused}");
        let panels = curves(&TWO_SCENES, "x=cells y=rate by=mode facet=scene").unwrap().panels;
        assert_eq!(panels.iter().map(|panel| panel.name.as_str()).collect::<Vec<_>>(), ["room", "lake"]);
        assert_eq!(panels[1].lines, [vec![(4.0, 10.0), (8.0, 30.0)], vec![(4.0, 6.0)]]);
    }

    #[test]
    fn values_are_relative_to_the_first_or_to_a_line() {
        let relative = |to: &str| curves(&TWO_SCENES, &format!("x=cells y=rate by=scene mode=b relative={to}"));
        assert_eq!(
            relative("first").unwrap().panels[0].lines,
            [vec![(4.0, 1.0), (8.0, 2.0)], vec![(4.0, 1.0), (8.0, 3.0)]]
        );
        assert_eq!(
            relative("room").unwrap().panels[0].lines,
            [vec![(4.0, 1.0), (8.0, 1.0)], vec![(4.0, 10.0), (8.0, 15.0)]]
        );
        assert!(relative("attic").unwrap_err().contains("there are first, room, lake"));
    }

    #[test]
    fn words_stand_side_by_side() {
        let rows = [["8", "p", "r", "3"], ["4", "b", "r", "1"]];
        let curves = curves(&rows, "x=mode y=rate").unwrap();
        let Positions::Words(words) = &curves.x else { panic!("{curves:?}") };
        assert_eq!(words, &["p", "b"]);
        assert_eq!(curves.panels[0].lines, [vec![(0.0, 3.0), (1.0, 1.0)]]);
    }

    #[test]
    fn nothing_and_too_much_are_refused() {
        assert!(curves(&[["8", "p", "r", ""]], "x=cells y=rate").unwrap_err().contains("nothing to draw"));
        let names: Vec<String> = (0..29).map(|n| n.to_string()).collect();
        let rows: Vec<[&str; 4]> = names.iter().map(|name| ["1", name.as_str(), name.as_str(), "1"]).collect();
        assert!(curves(&rows, "x=cells y=rate by=mode").unwrap_err().contains("29 lines; 28"));
        assert!(curves(&rows, "x=cells y=rate facet=scene").unwrap_err().contains("29 panels; a plot has 8"));
    }
}
