//! The pages of `reports/` against their tables, and their sweeps against what there is to run. Nothing is simulated here.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use pcs_sim::program::ArrayProgram;
use pcs_sim::scene::builtin;
use pcs_sim::sweep::Sweep;

/// A table: its headings and rows.
struct Table {
    name: String,
    headings: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// The experiments: the folders whose run.sh makes sweeps.
fn experiments() -> Vec<PathBuf> {
    let reports = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports");
    let folders = fs::read_dir(reports).unwrap().map(|entry| entry.unwrap().path());
    let is_experiment = |folder: &PathBuf| {
        fs::read_to_string(folder.join("run.sh")).is_ok_and(|script| script.contains("\n. ../sweeps.sh\n"))
    };
    let found: Vec<PathBuf> = folders.filter(is_experiment).collect();
    assert_eq!(found.len(), 9, "{found:?}");
    found
}

fn tables(folder: &Path) -> Vec<Table> {
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let csv = files.filter(|path| path.extension().is_some_and(|extension| extension == "csv"));
    csv.map(|path| {
        let mut reader = csv::Reader::from_path(&path).unwrap();
        let cells = |row: &csv::StringRecord| row.iter().map(str::to_owned).collect::<Vec<_>>();
        let headings = cells(reader.headers().unwrap());
        let rows = reader.records().map(|row| cells(&row.unwrap())).collect();
        Table { name: path.file_name().unwrap().to_string_lossy().into_owned(), headings, rows }
    })
    .collect()
}

/// A line of a table on a page, cell by cell.
fn cells(line: &str) -> Vec<String> {
    line.trim().trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()
}

/// The tables on a page: the heading and the rows of each.
fn page_tables(page: &str) -> Vec<Vec<Vec<String>>> {
    let lines: Vec<&str> = page.lines().collect();
    let blocks =
        lines.chunk_by(|a, b| a.starts_with('|') == b.starts_with('|')).filter(|block| block[0].starts_with('|'));
    blocks.map(|block| [&block[..1], &block[2..]].concat().into_iter().map(cells).collect()).collect()
}

/// Whether a number on a page is a table's, rounded to the digits that the page shows.
fn is_rounded(shown: &str, exact: &str) -> bool {
    let digits = shown.split_once('.').map_or(0, |(_, fraction)| fraction.len() as i32);
    match (shown.parse::<f64>(), exact.parse::<f64>()) {
        (Ok(shown), Ok(exact)) => (shown - exact).abs() <= 0.5000001 * 10f64.powi(-digits),
        _ => shown == exact,
    }
}

/// Whether all rows of a page's table are slices of a table's rows.
fn is_slice(shown: &[Vec<String>], table: &Table) -> Result<(), String> {
    let place = |heading: &String| {
        let name = heading.replace(' ', "_");
        table.headings.iter().position(|other| *other == name).ok_or(format!("no column {name}"))
    };
    let columns = shown[0].iter().map(place).collect::<Result<Vec<_>, _>>()?;
    let is_there = |row: &&Vec<String>| {
        table.rows.iter().any(|exact| row.iter().zip(&columns).all(|(cell, &column)| is_rounded(cell, &exact[column])))
    };
    match shown[1..].iter().find(|row| !is_there(row)) {
        Some(row) => Err(format!("{} has no row {row:?}", table.name)),
        None => Ok(()),
    }
}

#[test]
fn tables_on_pages_are_slices_of_the_folders_tables() {
    for folder in experiments() {
        let (tables, page) = (tables(&folder), fs::read_to_string(folder.join("README.md")).unwrap());
        let shown = page_tables(&page);
        assert!(!shown.is_empty(), "{} shows a table", folder.display());
        for table in shown {
            let tries: Vec<_> = tables.iter().map(|exact| is_slice(&table, exact)).collect();
            assert!(tries.iter().any(Result::is_ok), "{}: {:?}: {tries:?}", folder.display(), table[0]);
        }
    }
}

/// The figures of a page's sentences: numbers with a fraction, and percentages as shares.
fn figures(page: &str) -> BTreeSet<(String, bool)> {
    let prose: Vec<&str> =
        page.lines().filter(|line| !line.starts_with(['|', '!']) && !line.starts_with("    ")).collect();
    let prose = prose.join(" ");
    let words: Vec<&str> = prose.split_whitespace().collect();
    let number = |word: &str| {
        let word = word.trim_start_matches(|c: char| !c.is_ascii_digit() && c != '-');
        let word = word.trim_end_matches(|c: char| !c.is_ascii_digit());
        word.parse::<f64>().is_ok().then(|| word.to_owned())
    };
    let pairs = words.iter().zip(words.iter().skip(1).chain(&[""]));
    pairs
        .filter_map(|(word, next)| Some((number(word)?, next.starts_with('%'))))
        .filter(|(number, is_share)| *is_share || number.contains('.'))
        .collect()
}

/// Figure 7's and others that pages take from the paper, or that follow from its figures alone.
const GIVEN: [&str; 14] =
    ["7.8", "0.05", "0.65", "1.7", "2.3", "3.8", "30.65", "43", "8", "16.7", "80", "4.75", "0.4", "1.1"];

#[test]
fn figures_in_sentences_stand_in_the_folders_tables() {
    for folder in experiments() {
        let cells: Vec<String> = tables(&folder).into_iter().flat_map(|table| table.rows).flatten().collect();
        let figures = figures(&fs::read_to_string(folder.join("README.md")).unwrap());
        let stands = |(figure, is_share): &&(String, bool)| {
            let share =
                |cell: &str| cell.parse::<f64>().is_ok_and(|cell| is_rounded(figure, &(100.0 * cell).to_string()));
            GIVEN.contains(&figure.as_str())
                || cells.iter().any(|cell| is_rounded(figure, cell) || *is_share && share(cell))
        };
        let (_, missing): (Vec<_>, Vec<_>) = figures.iter().partition(stands);
        assert!(missing.is_empty(), "{}: {missing:?} stand in no table", folder.display());
    }
}

#[test]
fn pictures_on_pages_are_there() {
    for folder in experiments() {
        let page = fs::read_to_string(folder.join("README.md")).unwrap();
        for picture in page.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            assert!(folder.join(picture).exists(), "{}: {picture}", folder.display());
        }
    }
}

#[test]
fn sweeps_name_scenes_and_programs_that_exist() {
    for folder in experiments() {
        let script = fs::read_to_string(folder.join("run.sh")).unwrap();
        for name in script.lines().filter_map(|line| line.strip_prefix("sweep ")) {
            let sweep = Sweep::read(&folder.join(format!("{name}.ron"))).unwrap();
            let values = |parameter: &str| {
                let found = sweep.parameters.iter().find(|other| other.column.name == parameter);
                found.map(|parameter| parameter.values.clone()).unwrap_or_default()
            };
            for scene in values("scene") {
                assert!(builtin::all().iter().any(|other| other.name == scene), "{name}: {scene}");
            }
            for program in values("program") {
                let is_there = ArrayProgram::standard(&program).is_some() || folder.join(&program).exists();
                assert!(is_there, "{name}: {program}");
            }
            assert!(folder.join(format!("{name}.csv")).exists(), "{name} has its table");
        }
    }
}

#[test]
fn a_number_is_its_table_s_only_as_far_as_it_shows() {
    assert!(is_rounded("1.58", "1.5849") && !is_rounded("1.58", "1.5851"));
    assert!(is_rounded("43", "42.6") && !is_rounded("43", "43.6"));
    assert!(is_rounded("work", "work") && !is_rounded("work", "1"));
    let page = "Slabs gain 8.3 % of 1581.6 us.\n\n| a | b |\n| --- | ---: |\n| x | 2.5 |\n";
    assert_eq!(page_tables(page), [[["a", "b"], ["x", "2.5"]].map(|row| row.map(str::to_owned).to_vec()).to_vec()]);
    let found: Vec<_> = figures(page).into_iter().collect();
    assert_eq!(found, [("1581.6".to_owned(), false), ("8.3".to_owned(), true)]);
}
