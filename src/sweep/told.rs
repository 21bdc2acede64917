//! What the points of a table are, in a line above its plots.

use std::cmp::Reverse;

use super::{Points, effective, parameters};
use crate::report::summary::plural;
use crate::report::table::{Column, Table};

/// The column that tells how many cells the array of a point has, if the sweep does not say so.
const CELLS: (&str, &str) = ("array_cells", "cells");

/// More values than these are told by the first and the last.
const MOST_VALUES: usize = 4;

/// All parameters in the rows of a table with their values, those that all rows share first: `9 points: scene room; cells 8`.
/// The number of cells is told in any case.
pub fn what_ran(table: &Table<'_>) -> String {
    let mut told: Vec<(&str, Vec<&str>)> = table
        .columns
        .iter()
        .enumerate()
        .filter_map(|(index, column)| {
            let name = called(table.columns, column.name)?;
            let mut values: Vec<&str> = Vec::new();
            table.column(index).filter(|value| !value.is_empty()).for_each(|value| {
                if !values.contains(&value) {
                    values.push(value);
                }
            });
            (!values.is_empty()).then_some((name, values))
        })
        .collect();
    told.sort_by_key(|(_, values)| values.len() > 1);
    let told: Vec<String> = told.iter().map(|(name, values)| format!("{name} {}", listed(values))).collect();
    let points = plural(table.rows.len() as u64, "point");
    if told.is_empty() { points } else { format!("{points}: {}", told.join("; ")) }
}

/// What a column is called here, if it is one of a parameter.
fn called<'a>(columns: &[Column<'a>], name: &'a str) -> Option<&'a str> {
    let has_cells = || columns.iter().any(|column| column.name == CELLS.1);
    match name {
        _ if name == CELLS.0 => (!has_cells()).then_some(CELLS.1),
        _ => parameters::is_known(name).then_some(name),
    }
}

fn listed(values: &[&str]) -> String {
    match values {
        [first, .., last] if values.len() > MOST_VALUES => format!("{first} to {last}"),
        _ => values.join(", "),
    }
}

/// What a column of a sweep's table is called on an axis, if there is one of that name. Where tables of several kinds of points have
/// one, it is that of the kind that has most of the table's headings.
pub fn label(headings: &[String], name: &str) -> Option<&'static str> {
    let known = |points: &Points| headings.iter().filter(|heading| points.label(heading).is_some()).count();
    let mut kinds = Points::ALL;
    kinds.sort_by_key(|points| Reverse(known(points)));
    let effective = || effective::all().find(|column| column.name == name).map(|column| column.label);
    kinds.into_iter().find_map(|points| points.label(name)).or_else(effective)
}
