//! `--watch`: the points that were done last, above the progress bar.

use std::collections::VecDeque;

use console::{Term, truncate_str};
use indicatif::ProgressBar;
use pcs_sim::report::summary::grouped;
use pcs_sim::sweep::{Points, Sweep};

/// Points that are shown at the most.
const MOST_LINES: usize = 16;

/// The points that were done last.
pub struct Latest<'a> {
    bar: &'a ProgressBar,
    /// The parameters that vary: their places in a row, and their names.
    varying: Vec<(usize, &'static str)>,
    /// The place of the figure that is shown, and its unit.
    told: (usize, &'static str),
    error: usize,
    lines: VecDeque<String>,
    is_shown: bool,
}

impl Latest<'_> {
    /// On a pipe nothing is shown.
    pub fn new<'a>(sweep: &Sweep, bar: &'a ProgressBar, watch: bool) -> Latest<'a> {
        let parameters = sweep.parameters.iter().enumerate();
        let varying = parameters.filter(|(_, parameter)| parameter.values.len() > 1);
        let columns = sweep.columns();
        let place = |name: &str| columns.iter().position(|column| column.name == name).unwrap_or(0);
        let (told, unit) = match sweep.of {
            Points::Arrays => ("rays_per_second", "rays/s"),
            Points::Farms | Points::Cubes => ("seconds", "s"),
        };
        Latest {
            bar,
            varying: varying.map(|(index, parameter)| (index, parameter.column.name)).collect(),
            told: (place(told), unit),
            error: place("error"),
            lines: VecDeque::new(),
            is_shown: watch && !bar.is_hidden(),
        }
    }

    /// A point is done: its row.
    pub fn add(&mut self, row: &[String]) {
        if !self.is_shown {
            return;
        }
        let (height, width) = Term::stderr().size();
        let line = truncate_str(&self.line(row), (width as usize).saturating_sub(1), "…").into_owned();
        self.lines.push_back(line + "\n");
        while self.lines.len() > MOST_LINES.min((height as usize).saturating_sub(2)) {
            self.lines.pop_front();
        }
        self.bar.set_prefix(self.lines.iter().map(String::as_str).collect::<String>());
    }

    fn line(&self, row: &[String]) -> String {
        let point: Vec<String> = self.varying.iter().map(|(index, name)| format!("{name} {}", row[*index])).collect();
        let (place, unit) = self.told;
        let result = match row[place].parse::<f64>() {
            Ok(seconds) if unit == "s" => format!("{seconds:.3} s"),
            Ok(figure) => format!("{} {unit}", grouped(figure.round() as u64)),
            Err(_) => format!("failed: {}", row[self.error]),
        };
        format!("{}: {result}", point.join(", "))
    }
}
