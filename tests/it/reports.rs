//! The pages of `reports/` against their tables, and their sweeps against what there is to run. Nothing is simulated here.

mod page;
mod source;
mod table;

use std::fs;
use std::path::{Path, PathBuf};

use pcs_sim::program::ArrayProgram;
use pcs_sim::run::FarmSpec;
use pcs_sim::scene::builtin;
use pcs_sim::sweep::Sweep;

use page::{Figure, figures, paragraphs};
use source::Sources;
use table::{Table, Tables};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folders with a page.
fn reports() -> Vec<PathBuf> {
    let folders = fs::read_dir(root().join("reports")).unwrap().map(|entry| entry.unwrap().path());
    let mut found: Vec<PathBuf> = folders.filter(|folder| folder.join("README.md").exists()).collect();
    found.sort();
    assert_eq!(found.len(), 19, "{found:?}");
    found
}

/// The experiments: the folders whose run.sh makes sweeps.
fn experiments() -> Vec<PathBuf> {
    let is_experiment = |folder: &PathBuf| {
        fs::read_to_string(folder.join("run.sh")).is_ok_and(|script| script.contains("\n. ../sweeps.sh\n"))
    };
    let found: Vec<PathBuf> = reports().into_iter().filter(is_experiment).collect();
    assert_eq!(found.len(), 17, "{found:?}");
    found
}

fn tables(folder: &Path) -> Vec<Table> {
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let csv = files.filter(|path| path.extension().is_some_and(|extension| extension == "csv"));
    csv.map(|path| Table::read(&path).unwrap()).collect()
}

/// Text whose figures have sources, and the folder from which these are named.
struct Page {
    folder: PathBuf,
    text: String,
}

/// All reports, their index, and the findings in the README.
fn pages() -> Vec<Page> {
    let read = |folder: PathBuf| Page { text: fs::read_to_string(folder.join("README.md")).unwrap(), folder };
    let mut pages: Vec<Page> = reports().into_iter().chain([root().join("reports")]).map(read).collect();
    let readme = read(root().to_owned());
    let findings = readme.text.split("\n## What the paper never showed\n").nth(1).unwrap();
    pages.push(Page { text: findings.split("\n## ").next().unwrap().to_owned(), ..readme });
    pages
}

impl Page {
    /// The figures of its sentences.
    fn figures(&self) -> Vec<Figure> {
        let of = |text: &String| figures(text).unwrap_or_else(|error| panic!("{}: {error}", self.folder.display()));
        paragraphs(&self.text).iter().flat_map(of).collect()
    }
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

/// Whether each row of a page's table is a slice of one row of a table.
fn is_slice(shown: &[Vec<String>], table: &Table) -> Result<(), String> {
    let place = |heading: &String| {
        let name = heading.replace(' ', "_");
        table.headings.iter().position(|other| *other == name).ok_or(format!("no column {name}"))
    };
    let columns = shown[0].iter().map(place).collect::<Result<Vec<_>, _>>()?;
    let is_row = |row: &[String], exact: &[String]| {
        row.iter().zip(&columns).all(|(cell, &column)| page::is_rounded(cell, &exact[column], 1.0))
    };
    let is_one = |row: &&Vec<String>| table.rows.iter().filter(|exact| is_row(row, exact)).count() == 1;
    match shown[1..].iter().find(|row| !is_one(row)) {
        Some(row) => Err(format!("{} has not just one row {row:?}", table.name)),
        None => Ok(()),
    }
}

#[test]
fn tables_on_pages_are_slices_of_the_folders_tables() {
    for folder in reports() {
        let (tables, page) = (tables(&folder), fs::read_to_string(folder.join("README.md")).unwrap());
        let shown = page_tables(&page);
        assert!(!shown.is_empty(), "{} shows a table", folder.display());
        for table in shown {
            let tries: Vec<_> = tables.iter().map(|exact| is_slice(&table, exact)).collect();
            assert!(tries.iter().any(Result::is_ok), "{}: {:?}: {tries:?}", folder.display(), table[0]);
        }
    }
}

/// What is wrong on each page, by a test of a figure.
fn assert_all(mut wrong_with: impl FnMut(&Figure, &mut Sources) -> Option<String>) {
    let mut tables = Tables::default();
    let mut wrong = Vec::new();
    for page in pages() {
        let mut sources = Sources { tables: &mut tables, folder: &page.folder };
        let found = page.figures().into_iter().filter_map(|figure| wrong_with(&figure, &mut sources));
        wrong.extend(found.map(|wrong| format!("{}: {wrong}", page.folder.display())));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn figures_are_what_their_sources_say() {
    assert_all(|figure, sources| figure.check(&figure.shown, sources).err());
}

/// Numbers that differ from one in a digit.
fn mutants(shown: &str) -> Vec<String> {
    let places = shown.char_indices().filter(|(_, digit)| digit.is_ascii_digit());
    let others = |(at, digit): (usize, char)| {
        let other = move |other: char| format!("{}{other}{}", &shown[..at], &shown[at + 1..]);
        ('0'..='9').filter(move |other| *other != digit).map(other)
    };
    places.flat_map(others).collect()
}

#[test]
fn no_other_figure_passes() {
    assert_all(|figure, sources| {
        let passes = |other: &String| figure.check(other, sources).is_ok();
        mutants(&figure.shown).into_iter().find(passes).map(|other| format!("{other} would pass for {figure:?}"))
    });
}

/// Of all percentages in tenths only the true one passes.
#[test]
fn no_percentage_passes_by_chance() {
    assert_all(|figure, sources| {
        let passes = |shown: &String| figure.check(shown, sources).is_ok();
        let all = (0..=1000).map(|tenths| format!("{:.1}", tenths as f64 / 10.0));
        let passed: Vec<String> = if figure.unit == 0.01 { all.filter(passes).collect() } else { Vec::new() };
        (passed.len() > 1).then(|| format!("{passed:?} would pass for {figure:?}"))
    });
}

#[test]
fn pictures_on_pages_are_there() {
    for folder in reports() {
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
                let is_builtin = builtin::all().iter().any(|other| other.name == scene);
                let is_there = is_builtin || scene == FarmSpec::RECTANGLES || folder.join(&scene).exists();
                assert!(is_there, "{name}: {scene}");
            }
            for program in values("program") {
                let is_there = ArrayProgram::standard(&program).is_some() || folder.join(&program).exists();
                assert!(is_there, "{name}: {program}");
            }
            assert!(folder.join(format!("{name}.csv")).exists(), "{name} has its table");
        }
    }
}

/// The sources of a page that names its cells well, and not.
#[test]
fn a_figure_needs_a_source_that_says_so() {
    let folder = root().join("reports/broadcast");
    let mut tables = Tables::default();
    let mut check = |paragraph: &str| {
        let mut sources = Sources { tables: &mut tables, folder: &folder };
        figures(paragraph)?.iter().try_for_each(|figure| figure.check(&figure.shown, &mut sources))
    };
    for right in [
        "It is 25.4 %<!-- losses scene=reference partition=work cells=16 efficiency --> with 16 cells of P1's.",
        "A ray takes 0.65<!-- 0.05 * ( chosen ray_words + chosen hit_words ) --> us.",
        "The 512<!-- paper §4.2 fifo_words --> words of a FIFO.",
        "It is -0.953<!-- losses scene=tree partition=regular cells=8 extra -->.",
        "Over 100 000<!-- max one-cell scene=reference|tree polygons --> polygons.",
        "All 256 x 256<!-- chosen image --> rays in `16` [cells](16), 512x512.",
    ] {
        assert_eq!(check(right), Ok(()), "{right}");
    }
    let wrong = [
        "It is 25.5 %<!-- losses scene=reference partition=work cells=16 efficiency -->.",
        "It is 25.4<!-- losses scene=reference partition=work cells=16 efficiency -->.",
        "It is 25.4 %.",
        "It is 25.4 %<!-- losses scene=reference cells=16 efficiency --> with 16 cells.",
        "It is 25.4 %<!-- losses scene=reference partition=work cells=16 speed -->.",
        "It is 25.4 %<!-- losses scene=nowhere efficiency -->.",
        "It is 25.4 %<!-- 0.254 -->.",
        "It is 25.4 %<!-- losses scene=reference partition=work cells=16 efficiency --> with 17 cells.",
        "It is much<!-- losses scene=reference partition=work cells=16 efficiency -->.",
        "The 512<!-- paper §4.1 fifo_words --> words of a FIFO.",
        "The 512<!-- chosen fifo_words --> words of a FIFO.",
    ];
    let errors: Vec<String> = wrong.iter().map(|wrong| check(wrong).expect_err(wrong)).collect();
    insta::assert_snapshot!(errors.join("\n"));
}

#[test]
fn numbers_are_found_in_sentences() {
    let shown = |paragraph| {
        figures(paragraph).unwrap().into_iter().map(|figure| (figure.shown, figure.unit)).collect::<Vec<_>>()
    };
    let found = shown(
        "A 5.5 % of 1 048 576, -3 (7) P1 T0 iPSC/2 §4 Figure 5 hybrid-3 512-word 3 million 5-10 1 x 2 at 20 ms, 8.",
    );
    let numbers = ["5.5", "1048576", "-3", "7", "512", "3", "5", "10", "1x2", "20", "8"];
    assert_eq!(found.iter().map(|(shown, _)| shown.as_str()).collect::<Vec<_>>(), numbers);
    assert_eq!((found[0].1, found[5].1, found[6].1), (0.01, 1e6, 1.0));
    let page =
        "Title 1\n=======\n\nOne 2.\nTwo 3.\n\n1. Three 4.\n- Four 5.\n\n    code 6\n\n```\n7\n```\n| 8 |\n![9](9)\n";
    assert_eq!(paragraphs(page), ["Title 1 ======= ", "One 2. Two 3. ", "Three 4. ", "- Four 5. "]);
}

#[test]
fn a_number_is_its_table_s_only_as_far_as_it_shows() {
    let is_rounded = |shown, exact| page::is_rounded(shown, exact, 1.0);
    assert!(is_rounded("1.58", "1.5849") && !is_rounded("1.58", "1.5851") && !is_rounded("1.58", "1.5749"));
    assert!(is_rounded("4.8", "4.75") && !is_rounded("4.7", "4.75"));
    assert!(is_rounded("43", "42.6") && !is_rounded("43", "43.6"));
    assert!(is_rounded("work", "work") && !is_rounded("work", "1"));
    assert!(page::is_rounded("25.4", "0.254", 0.01) && page::is_rounded("5.7", "5709874", 1e6));
    let page = "Slabs.\n\n| a | b |\n| --- | ---: |\n| x | 2.5 |\n";
    assert_eq!(page_tables(page), [[["a", "b"], ["x", "2.5"]].map(|row| row.map(str::to_owned).to_vec()).to_vec()]);
}
