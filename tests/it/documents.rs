//! The documents say what the code says.

use std::collections::BTreeSet;

use pcs_sim::machine::{CapitanFile, CapitanOptions, FifoName, Ipsc2File, Ipsc2Options, MachineFile, MachineOptions};
use pcs_sim::parameters::ParameterInfo;
use pcs_sim::report::table::{Column, Kind};
use pcs_sim::run::{CubeRunOptions, FarmRunOptions, RunOptions};
use pcs_sim::sweep::Sweep;
use serde_json::Value;

use crate::support::command::Folder;

/// The rows of docs/machine.md's table of parameters, a name, a unit and a default each.
fn documented() -> Vec<[String; 3]> {
    let text = std::fs::read_to_string("docs/machine.md").unwrap();
    let (_, section) = text.split_once("\n## Parameters\n").unwrap();
    let section = section.split("\n## ").next().unwrap();
    let rows = section.lines().filter_map(|line| line.strip_prefix("| `"));
    let row = |line: &str| {
        let columns: Vec<&str> = line.trim_end_matches('|').split('|').map(str::trim).collect();
        assert_eq!(columns.len(), 5, "{line}");
        assert!(columns[3..].iter().all(|column| !column.is_empty()), "{line}");
        [columns[0].trim_end_matches('`'), columns[1], columns[2]].map(str::to_owned)
    };
    rows.map(row).collect()
}

/// A parameter's value in the standard machine file, as the table writes it.
fn default_of(file: &Value, name: &str) -> String {
    match file.get(name).or_else(|| file["times_us"].get(name)) {
        None | Some(Value::Null) => "none".to_owned(),
        Some(Value::String(text)) => text.to_lowercase(),
        Some(number) => number.as_f64().unwrap().to_string(),
    }
}

#[test]
fn machine_md_lists_every_parameter_with_its_default() {
    let file = serde_json::to_value(MachineFile::standard().unwrap()).unwrap();
    let parameters = MachineOptions::PARAMETERS.iter();
    let expected: Vec<(&str, String)> = parameters.map(|it| (it.name, default_of(&file, it.name))).collect();
    let rows = documented();
    let listed: Vec<(&str, String)> = rows.iter().map(|[name, _, default]| (name.as_str(), default.clone())).collect();
    assert_eq!(listed, expected);
}

/// A column of tables that names a unit names the document's.
#[test]
fn machine_md_has_the_units_of_the_tables() {
    for ([name, unit, _], parameter) in documented().iter().zip(MachineOptions::PARAMETERS) {
        let of_column =
            parameter.label.strip_suffix(')').and_then(|label| label.rsplit_once('(')).map(|(_, unit)| unit);
        let written = match unit.as_str() {
            "10^6 bytes/s" => "Mbyte/s",
            unit => unit,
        };
        assert_eq!(of_column.unwrap_or_default(), written, "{name}");
    }
}

/// The rows of the table of parameters of a document whose rows have so many cells: name, unit and default.
fn rows_of(path: &str, cells: usize) -> Vec<(String, String, String)> {
    let text = std::fs::read_to_string(path).unwrap();
    let (_, section) = text.split_once("\n## Parameters\n").unwrap();
    let section = section.split("\n## ").next().unwrap();
    let rows = section.lines().filter_map(|line| line.strip_prefix("| `"));
    let row = |line: &str| {
        let columns: Vec<String> = line.trim_end_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
        assert_eq!(columns.len(), cells, "{line}");
        (columns[0].trim_end_matches('`').to_owned(), columns[1].clone(), columns[2].clone())
    };
    rows.map(row).collect()
}

/// What such rows must be of some parameters, in the order of tables, with the defaults of a machine file and their units.
fn expected_rows(parameters: &[ParameterInfo], file: &Value) -> Vec<(String, String, String)> {
    let unit = |label: &str| {
        let unit = label.strip_suffix(')').and_then(|label| label.rsplit_once('(')).map(|(_, unit)| unit);
        unit.unwrap_or_default().to_owned()
    };
    parameters.iter().map(|it| (it.name.to_owned(), unit(it.label), default_of(file, it.name))).collect()
}

#[test]
fn farm_md_and_ipsc2_md_list_every_parameter_with_its_default() {
    let file = serde_json::to_value(CapitanFile::standard().unwrap()).unwrap();
    assert_eq!(rows_of("docs/farm.md", 6), expected_rows(CapitanOptions::PARAMETERS, &file));
    let file = serde_json::to_value(Ipsc2File::standard().unwrap()).unwrap();
    assert_eq!(rows_of("docs/ipsc2.md", 5), expected_rows(Ipsc2Options::PARAMETERS, &file));
}

/// The lines of a section of docs/tables.md whose heading begins so, without the head of its table.
fn listed(heading: &str) -> Vec<String> {
    let text = std::fs::read_to_string("docs/tables.md").unwrap();
    let (_, section) = text.split_once(&format!("\n## {heading}")).unwrap();
    let section = section.split("\n## ").next().unwrap();
    section.lines().filter(|line| line.starts_with("| `")).map(str::to_owned).collect()
}

/// docs/tables.md lists every column of a sweep's table, with what it holds, what it means, and its unit.
#[test]
fn tables_md_lists_every_column() {
    let folder = Folder::new();
    let results = |text: &str| Sweep::read(&folder.file("sweep.ron", text)).unwrap().results();
    let line = |name: &str, kind: Kind, label: &str| {
        let holds = match kind {
            Kind::Text => "text",
            Kind::Truth => "true or false",
            Kind::Whole => "whole",
            Kind::Number => "number",
        };
        format!("| `{name}` | {holds} | {label} |")
    };
    let lines = |columns: &[Column]| columns.iter().map(|it| line(it.name, it.kind, it.label)).collect::<Vec<_>>();
    let (arrays, farms) = (
        results(r#"(machine: "pcs.ron", host_filter_us: 1, host_mask_us: 1, message_us: 1)"#),
        results("(farm: true, bus_mb_s: 10)"),
    );
    let cubes = results(r#"(nodes: 4, machine: "my.ron")"#);
    let (rounded, of_arrays) = arrays.split_at(12);
    let (bus, of_farms) = farms.split_at(1);
    let (nodes, of_cubes) = cubes.split_at(6);
    // A column that arrays have, too, is listed once.
    let nodes: Vec<Column> =
        nodes.iter().filter(|column| rounded.iter().all(|other| other.name != column.name)).copied().collect();
    assert_eq!(listed("A sweep's table: the results of an array"), lines(of_arrays));
    assert_eq!(listed("A sweep's table: the results of a farm"), lines(of_farms));
    assert_eq!(listed("A sweep's table: what the machine"), [lines(rounded), lines(bus), lines(&nodes)].concat());
    assert_eq!(listed("A sweep's table: the results of a hypercube"), lines(of_cubes));
    let known = RunOptions::parameters().chain(RunOptions::image_parameters()).chain(FarmRunOptions::parameters());
    let known = known.chain(CubeRunOptions::parameters());
    let known = known.map(|it| line(it.name, it.kind.into(), it.label));
    let known: BTreeSet<String> =
        known.chain([line("image", Kind::Truth, "whole image"), line("farm", Kind::Truth, "farm")]).collect();
    assert_eq!(listed("A sweep's table: the parameters").into_iter().collect::<BTreeSet<_>>(), known);
}

/// The paths of the values of some JSON.
fn paths(value: &Value, path: &str, into: &mut BTreeSet<String>) {
    match value {
        _ if path == "configuration" => drop(into.insert(path.to_owned())),
        Value::Object(fields) => fields.iter().for_each(|(name, value)| {
            let name = if path == "rays_by_kind" { "KIND" } else { name };
            let dot = if path.is_empty() { "" } else { "." };
            paths(value, &format!("{path}{dot}{name}"), into);
        }),
        Value::Array(values) => values.iter().for_each(|value| paths(value, &format!("{path}[]"), into)),
        _ => drop(into.insert(path.to_owned())),
    }
}

/// docs/tables.md lists every field of statistics, and no other.
#[test]
fn tables_md_lists_every_field() {
    let folder = Folder::new();
    let written = |commands: &[&str]| {
        let mut fields = BTreeSet::new();
        for command in commands {
            folder.run(&format!("{command} --stats s.json --force")).success();
            paths(&serde_json::from_str(&folder.read("s.json")).unwrap(), "", &mut fields);
        }
        fields
    };
    let runs = [
        "--scene room --size 8x6 --mode broadcast --cells 2 --why --enough --ops a.ops",
        "replay a.ops",
        "image room --size 8x6 -o i.png --samples 2 --adaptive --screen-rectangles scene --rules own+a4b+a4c",
        "--scene tetra --size-factor 3 --size 8x8 --cells-run programs",
        "--mode broadcast --cells 8 --partition work --scene teapot --size 48x48",
        "--scene room --size 8x6 --mode pipeline --stop-words 2",
    ];
    assert_eq!(written(&runs), names("Statistics\n"));
    let farms = ["farm rectangles --size 20x10 --tasks 2 --why", "farm room --size 8x6 --tasks 2"];
    assert_eq!(written(&farms), names("Statistics of a farm"));
    let cubes = [
        "ipsc2 room --size 8x8 --nodes 2 --why --rules own+a4b+a4c",
        "ipsc2 room --size 8x8 --nodes 2 --mode shared-memory",
    ];
    assert_eq!(written(&cubes), names("Statistics of an image on a hypercube"));
    assert_eq!(written(&["model room --size 8x8"]), names("Predictions"));
}

/// The names in the first column of a section's table.
fn names(heading: &str) -> BTreeSet<String> {
    let lines = listed(heading);
    let name = |line: &String| line.trim_start_matches("| `").split('`').next().unwrap().to_owned();
    lines.iter().map(name).collect()
}

/// docs/tables.md lists what else commands write: hits, comparisons, the sizes of FIFOs.
#[test]
fn tables_md_lists_every_other_column() {
    let folder = Folder::new();
    let columns = |csv: &str| csv.lines().next().unwrap().split(',').map(str::to_owned).collect::<BTreeSet<_>>();
    let run = "--scene room --size 8x6 --mode broadcast";
    folder.run(&format!("{run} --cells 2 --hits h.csv --stats a.json")).success();
    folder.run(&format!("{run} --cells 3 --stats b.json")).success();
    assert_eq!(columns(&folder.read("h.csv")), names("Hits"));
    assert_eq!(columns(&folder.run("compare a.json b.json --csv").stdout), names("A comparison\n"));
    let mut fields = BTreeSet::new();
    let json = folder.run("compare a.json b.json --json").stdout;
    paths(&serde_json::from_str(&json).unwrap(), "", &mut fields);
    assert_eq!(fields, names("A comparison as JSON"));
    folder.run("size-fifos --scene room --size 8x6 --mode broadcast --cells 2 -o s.csv").success();
    let sizes = columns(&folder.read("s.csv"));
    let is_other_fifo = |name: &str| name != "X0" && name.parse::<FifoName>().is_ok();
    assert!(sizes.iter().any(|name| is_other_fifo(name)));
    assert_eq!(
        sizes.into_iter().filter(|name| !is_other_fifo(name)).collect::<BTreeSet<_>>(),
        names("The sizes of FIFOs")
    );
}
