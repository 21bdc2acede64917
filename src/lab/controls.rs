//! The page's sliders and lists: one for each parameter of a run, as it is declared, with the paper's own value marked.

use std::collections::BTreeMap;

use minijinja::context;
use pcs_sim::machine::MachineFile;
use pcs_sim::parameters::{Kind, ParameterInfo};
use pcs_sim::program::ArrayProgram;
use pcs_sim::run::RunOptions;
use pcs_sim::scene::builtin;
use serde::Serialize;
use serde_json::Value;

use super::request::is_of_lab;

/// Some parameters under a heading.
#[derive(Debug)]
pub struct Group {
    heading: &'static str,
    /// Whether it is open from the start.
    open: bool,
    controls: Vec<Control>,
}

/// A parameter as the page has it.
#[derive(Debug)]
struct Control {
    name: &'static str,
    /// What it is, without its unit.
    label: &'static str,
    unit: Option<&'static str>,
    help: String,
    form: Form,
    /// What holds where it is not set; nothing where that depends on something else.
    default: String,
    /// The paper's value, and where it stands.
    paper: Option<(String, &'static str)>,
    /// The values of a list, or the places of a slider.
    values: Vec<Offered>,
}

/// How a parameter is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    List,
    Slider,
    Switch,
    Number,
}

/// A value that is offered.
#[derive(Debug)]
struct Offered {
    value: String,
    label: String,
    is_paper: bool,
}

/// What an array program makes of the number of cells.
#[derive(Debug, Serialize)]
pub struct Program {
    stages: usize,
    cells: usize,
    /// Whether there can be no other number.
    is_fixed: bool,
}

/// The headings, with the parameters under them. What is under none stands under the last.
const GROUPS: [(&str, bool, &[&str]); 5] = [
    ("Scene and rays", true, &["scene", "size", "order", "size_factor", "resolution"]),
    (
        "Array",
        true,
        &[
            "mode",
            "cells",
            "partition",
            "grid_coefficient",
            "stop_words",
            "mailbox",
            "forward_ahead",
            "rays_per_message",
        ],
    ),
    (
        "Links and FIFOs",
        true,
        &["fifo_words", "x_fifo_words", "y_fifo_words", "z_fifo_words", "link_mb_s", "latency_cycles", "rate_counts"],
    ),
    (
        "The six times",
        true,
        &["grid_start", "grid_voxel", "slabs_start", "slabs_polygon", "intersection_start", "intersection_polygon"],
    ),
    ("More", false, &[]),
];

/// Parameters that the page does not have: a run of primary rays refuses them.
pub const ELSEWHERE: [&str; 1] = ["host_hit_us"];

/// The paper's own values, and where they stand in it. Of the mode all are the paper's.
const PAPER: [(&str, &str, &str); 11] = [
    ("size", "512x512", "§2"),
    ("scene", "reference", "§2"),
    ("grid_coefficient", "50", "annex A.1"),
    ("fifo_words", "512", "§4.2"),
    ("link_mb_s", "80", "§4.2"),
    ("grid_start", "30", "Figure 7"),
    ("grid_voxel", "7.8", "Figure 7"),
    ("slabs_start", "9", "Figure 7"),
    ("slabs_polygon", "13", "Figure 7"),
    ("intersection_start", "1", "Figure 7"),
    ("intersection_polygon", "30", "Figure 7"),
];

/// All parameters under their headings. `help` says what one is.
pub fn groups(help: fn(&str) -> Option<String>) -> Vec<Group> {
    let machine = serde_json::to_value(MachineFile::standard().ok()).unwrap_or_default();
    let all = RunOptions::parameters().filter(|known| is_of_lab(known) && !ELSEWHERE.contains(&known.name));
    let all: Vec<&ParameterInfo> = all.collect();
    let control = |known: &&ParameterInfo| Control::new(known, help, &machine);
    let named = |name: &&str| all.iter().find(|known| known.name == *name);
    let is_shown = |known: &&&ParameterInfo| GROUPS.iter().any(|(_, _, names)| names.contains(&known.name));
    let groups = GROUPS.iter().map(|&(heading, open, names)| {
        let controls: Vec<Control> = match names.is_empty() {
            true => all.iter().filter(|known| !is_shown(known)).map(control).collect(),
            false => names.iter().filter_map(named).map(control).collect(),
        };
        Group { heading, open, controls }
    });
    groups.collect()
}

/// What each mode makes of the number of cells.
pub fn programs() -> BTreeMap<&'static str, Program> {
    let of = |name: &&'static str| {
        let program = ArrayProgram::standard(name)?.ok()?;
        let (stages, cells) = (program.stages.len(), program.cells());
        Some((*name, Program { stages, cells, is_fixed: *name == "pipeline" }))
    };
    MODES.iter().filter_map(of).collect()
}

const MODES: [&str; 3] = ["pipeline", "broadcast", "hybrid"];

impl Group {
    /// The group as the page's template reads it.
    pub fn value(&self) -> minijinja::Value {
        let controls: Vec<minijinja::Value> = self.controls.iter().map(Control::value).collect();
        context! { heading => self.heading, open => self.open, controls }
    }
}

impl Form {
    fn name(self) -> &'static str {
        match self {
            Form::List => "list",
            Form::Slider => "slider",
            Form::Switch => "switch",
            Form::Number => "number",
        }
    }
}

impl Control {
    fn value(&self) -> minijinja::Value {
        let Control { name, label, unit, help, form, default, paper, values } = self;
        let offered = |offered: &Offered| {
            context! { value => offered.value.as_str(), label => offered.label.as_str(), is_paper => offered.is_paper }
        };
        context! {
            name => *name,
            label => *label,
            unit => *unit,
            help => help.as_str(),
            default => default.as_str(),
            form => form.name(),
            paper => paper.as_ref().map(|(value, place)| vec![value.clone(), place.to_string()]),
            stops => values.iter().map(|offered| offered.value.as_str()).collect::<Vec<_>>().join("|"),
            last => values.len().saturating_sub(1),
            values => values.iter().map(offered).collect::<Vec<_>>(),
        }
    }

    fn new(known: &ParameterInfo, help: fn(&str) -> Option<String>, machine: &Value) -> Control {
        let name = known.name;
        let (label, unit) = match known.label.strip_suffix(')').and_then(|label| label.rsplit_once(" (")) {
            Some((label, unit)) => (label, Some(unit)),
            None => (known.label, None),
        };
        let paper = PAPER.iter().find(|paper| paper.0 == name).map(|&(_, value, place)| (value.to_owned(), place));
        let default = default_of(name, machine);
        let choices = choices_of(name);
        let values = if choices.is_empty() { stops_of(name, &default) } else { choices };
        let form = match known.kind {
            Kind::Truth => Form::Switch,
            _ if !choices_of(name).is_empty() => Form::List,
            _ if !values.is_empty() => Form::Slider,
            _ => Form::Number,
        };
        let is_paper = |value: &String| name == "mode" || paper.as_ref().is_some_and(|paper| paper.0 == *value);
        let offered = |value: String| Offered { label: label_of(name, &value), is_paper: is_paper(&value), value };
        let values = values.into_iter().map(offered).collect();
        Control { name, label, unit, help: help(name).unwrap_or_default(), form, default, paper, values }
    }
}

/// The value that holds where a parameter is not set.
fn default_of(name: &str, machine: &Value) -> String {
    let of_machine = machine.get(name).or_else(|| machine.get("times_us")?.get(name)).filter(|value| !value.is_null());
    let of_run = match name {
        "scene" => "teapot",
        "size" => "256x256",
        "order" => "raster",
        "mode" => "pipeline",
        "partition" => "regular",
        "grid_coefficient" => "50",
        "forward_ahead" => "0",
        "rays_per_message" => "1",
        "edges" => "paper",
        "cells_run" => "timings",
        "instruction_limit" => "200000000",
        "on" => "pcs",
        "mailbox" | "bounded_walk" | "early_slabs" | "stepped_walk" => "false",
        "screen_rectangles" | "masks" => "off",
        "numbering" => "cut",
        "host_filter_us" | "host_mask_us" | "message_us" => "0",
        _ => "",
    };
    let told = of_machine.map(|value| match value {
        Value::String(text) => text.to_lowercase(),
        Value::Number(number) => number.as_f64().unwrap_or_default().to_string(),
        other => other.to_string(),
    });
    told.unwrap_or_else(|| of_run.to_owned())
}

/// The values of a parameter that has few.
fn choices_of(name: &str) -> Vec<String> {
    let choices: &[&str] = match name {
        "scene" => return builtin::all().iter().map(|scene| scene.name.to_owned()).collect(),
        "size" => &["32x32", "64x64", "128x128", "256x256", "512x512", "1024x1024"],
        "order" => &["raster", "columns", "tiles:8", "tiles:16", "tiles:32", "hilbert", "stride", "shuffle:1"],
        "mode" => &MODES,
        "program" => &["", "pipeline", "broadcast", "hybrid", "hybrid-3"],
        "partition" => &["regular", "polygons", "work", "measured"],
        "numbering" => &["cut", "front"],
        "screen_rectangles" => &["off", "scene", "objects"],
        "masks" => &["off", "rectangles", "boxes"],
        "edges" => &["paper", "closed"],
        "cells_run" => &["timings", "programs"],
        "on" => &["pcs", "ipsc2"],
        "rate_counts" => &["link", "channel"],
        _ => &[],
    };
    choices.iter().map(|choice| choice.to_string()).collect()
}

/// Where a slider stops. An empty place is where the parameter is not set.
fn stops_of(name: &str, default: &str) -> Vec<String> {
    let powers = |most: u32| (0..=most).map(|power| (1u64 << power).to_string());
    let told = |stops: &[f64]| stops.iter().map(f64::to_string).collect();
    let unset = || std::iter::once(String::new());
    match name {
        "cells" => told(&[1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0]),
        "grid_coefficient" => {
            told(&[0.5, 1.0, 2.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0, 50.0, 75.0, 100.0, 150.0, 200.0, 400.0, 800.0])
        }
        "stop_words" => unset().chain(powers(8)).collect(),
        "forward_ahead" => told(&[0.0, 1.0, 2.0, 3.0, 4.0, 8.0, 16.0, 32.0]),
        "rays_per_message" => powers(6).collect(),
        "fifo_words" => powers(16).collect(),
        "x_fifo_words" | "y_fifo_words" | "z_fifo_words" => unset().chain(powers(16)).collect(),
        "link_mb_s" => told(&[1.0, 2.0, 4.0, 5.0, 8.0, 10.0, 16.0, 20.0, 40.0, 80.0]),
        "latency_cycles" => told(&[1.0, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0]),
        "clock_ns" => told(&[10.0, 20.0, 25.0, 50.0, 100.0, 200.0]),
        "word_bytes" => told(&[2.0, 4.0, 8.0]),
        "memory_words" => unset().chain((12..=24).map(|power| (1u64 << power).to_string())).collect(),
        "host_ray_us" => told(&[0.0, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0]),
        _ if PAPER.iter().any(|(paper, _, place)| *paper == name && *place == "Figure 7") => times_about(default),
        _ => Vec::new(),
    }
}

/// From nothing to five times a time, in whole cycles of 50 ns.
fn times_about(default: &str) -> Vec<String> {
    const SHARES: [f64; 15] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.25, 1.5, 2.0, 5.0];
    let time: f64 = default.parse().unwrap_or_default();
    let mut stops: Vec<f64> = SHARES.iter().map(|share| (share * time * 20.0).round() / 20.0).collect();
    stops.dedup();
    stops.iter().map(f64::to_string).collect()
}

/// What a value is called.
fn label_of(name: &str, value: &str) -> String {
    let about = match (name, value) {
        (_, "") => "not set",
        ("mode", "pipeline") => "macro-pipeline (§4.2)",
        ("mode", "broadcast") => "parallel broadcast (§4.2)",
        ("mode", "hybrid") => "both together (§5)",
        _ => value,
    };
    about.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> Vec<Control> {
        groups(|_| None).into_iter().flat_map(|group| group.controls).collect()
    }

    #[test]
    fn every_parameter_of_a_run_has_one_control_unless_it_names_a_file() {
        let mut names: Vec<&str> = all().iter().map(|control| control.name).collect();
        names.sort();
        let known = RunOptions::parameters().filter(|known| is_of_lab(known) && !ELSEWHERE.contains(&known.name));
        let mut known: Vec<&str> = known.map(|known| known.name).collect();
        known.sort();
        assert_eq!(names, known);
    }

    #[test]
    fn what_is_offered_is_a_value_and_the_default_and_the_papers_are_among_it() {
        for control in all() {
            let offered: Vec<&str> = control.values.iter().map(|offered| offered.value.as_str()).collect();
            for value in offered.iter().filter(|value| !value.is_empty()) {
                RunOptions::default().set(control.name, value).unwrap();
            }
            if !offered.is_empty() && control.name != "cells" {
                assert!(offered.contains(&control.default.as_str()), "{}: {offered:?}", control.name);
            }
            if let Some((paper, _)) = &control.paper {
                assert!(offered.contains(&paper.as_str()), "{}: {offered:?}", control.name);
            }
        }
    }

    /// The paper's figures stand in one place for all documents.
    #[test]
    fn the_papers_values_are_those_of_the_reports() {
        let given = std::fs::read_to_string("reports/given.csv").unwrap();
        for (name, value, place) in PAPER.iter().filter(|(name, ..)| *name != "scene") {
            let named = if *name == "size" { "image" } else { name };
            assert!(given.contains(&format!("paper {place},{named},{value},")), "{name}");
        }
        assert!(given.contains("paper §2,polygons,100000,"));
    }
}
