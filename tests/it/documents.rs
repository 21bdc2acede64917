//! The documents say what the code says.

use pcs_sim::machine::{CapitanFile, CapitanOptions, MachineFile, MachineOptions};
use serde_json::Value;

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

/// docs/farm.md lists the parameters of the farm's machine, in the order of tables, with the defaults of capitan.ron and their units.
#[test]
fn farm_md_lists_every_parameter_with_its_default() {
    let text = std::fs::read_to_string("docs/farm.md").unwrap();
    let (_, section) = text.split_once("\n## Parameters\n").unwrap();
    let section = section.split("\n## ").next().unwrap();
    let rows = section.lines().filter_map(|line| line.strip_prefix("| `"));
    let row = |line: &str| {
        let columns: Vec<String> = line.trim_end_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect();
        assert_eq!(columns.len(), 6, "{line}");
        (columns[0].trim_end_matches('`').to_owned(), columns[1].clone(), columns[2].clone())
    };
    let listed: Vec<_> = rows.map(row).collect();
    let file = serde_json::to_value(CapitanFile::standard().unwrap()).unwrap();
    let unit = |label: &str| {
        let unit = label.strip_suffix(')').and_then(|label| label.rsplit_once('(')).map(|(_, unit)| unit);
        unit.unwrap_or_default().to_owned()
    };
    let parameters = CapitanOptions::PARAMETERS.iter();
    let expected: Vec<_> =
        parameters.map(|it| (it.name.to_owned(), unit(it.label), default_of(&file, it.name))).collect();
    assert_eq!(listed, expected);
}
