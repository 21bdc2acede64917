//! Two runs side by side: what is told first, the rest on demand, and a page of both.

use crate::support::command::Folder;
use serde_json::Value;

/// A folder with the statistics of two runs.
fn two_runs() -> Folder {
    let folder = Folder::new();
    folder.run("--scene room --size 8x6 --stats a.json").success();
    folder.run("--scene room --size 8x6 --fifo-words 4 --stats b.json").success();
    folder
}

#[test]
fn runs_that_do_not_differ_are_a_success() {
    let folder = two_runs();
    let same = folder.run("compare a.json a.json").success();
    assert!(same.contains("A and B are the same.") && same.contains("0 values differ"), "{same}");
}

#[test]
fn ten_lines_tell_what_matters_and_the_status_that_they_differ() {
    let folder = two_runs();
    let told = folder.run("compare a.json b.json");
    assert_eq!((told.status, told.stderr.as_str()), (1, ""));
    assert!(told.stdout.lines().count() <= 10 && told.stdout.lines().all(|line| line.chars().count() <= 80));
    insta::assert_snapshot!(told.stdout);
}

#[test]
fn all_that_differs_is_told_on_demand() {
    let folder = two_runs();
    let [a, b] = ["a.json", "b.json"].map(|name| serde_json::from_str::<Value>(&folder.read(name)).unwrap());
    let json: Value = serde_json::from_str(&folder.run("compare a.json b.json --json").stdout).unwrap();
    let differences = json["differences"].as_array().unwrap();
    assert!(differences.len() > 10);
    for difference in differences {
        let name = difference["name"].as_str().unwrap();
        let of = |stats: &Value| -> Value {
            name.split('.').fold(stats.clone(), |value, key| match &value {
                Value::Array(items) => match key.parse::<usize>() {
                    Ok(index) => items[index].clone(),
                    Err(_) => items.iter().find(|item| item["name"] == key).unwrap().clone(),
                },
                other => other[key].clone(),
            })
        };
        assert_eq!((&difference["a"], &difference["b"]), (&of(&a), &of(&b)), "{name}");
        assert_ne!(difference["a"], difference["b"], "{name}");
    }
    let csv = folder.run("compare a.json b.json --csv").stdout;
    assert_eq!(csv.lines().count(), differences.len() + 1);
    assert!(csv.contains("configuration.machine.fifo_words,512,4,-508,-0.9921875\n"), "{csv}");
    let all = folder.run("compare a.json b.json --all").stdout;
    assert!(differences.iter().all(|difference| all.contains(difference["name"].as_str().unwrap())), "{all}");
    assert!(all.lines().all(|line| line.chars().count() <= 80), "{all}");
}

#[test]
fn other_things_are_refused() {
    let folder = two_runs();
    folder.file("c.json", "{}");
    folder.file("d.json", "{");
    assert!(folder.run("compare a.json c.json").refused().contains("it has no cycles"));
    assert!(folder.run("compare a.json d.json").refused().contains("is no statistics file"));
    assert!(folder.run("compare - -").refused().contains("standard input cannot be both"));
    assert!(folder.run("compare a.json /dev/zero").refused().contains("no end was found"));
}

/// Both runs are on the page, and on axes of one length: that of the longer.
#[test]
fn a_page_has_both_runs_on_one_axis() {
    let folder = two_runs();
    folder.run("--scene room --size 8x6 --clock-ns 100 --link-mb-s 40 --page alone.html --stats c.json").success();
    let told = folder.run("compare a.json c.json --page pair.html");
    assert!(told.status == 1 && told.stdout.ends_with("wrote pair.html\n"), "{}", told.stderr);
    let page = folder.read("pair.html");
    assert_eq!(page.matches("<iframe").count(), 2);
    let ends: Vec<f64> =
        page.split("&quot;end&quot;:").skip(1).map(|rest| rest.split(',').next().unwrap().parse().unwrap()).collect();
    assert_eq!(ends.len(), 2);
    assert!((ends[0] / ends[1] - 1.0).abs() < 1e-4, "{ends:?}");
    // What joins them is a function of the pages.
    assert!(page.contains("function zoom(min, max)") && page.contains("contentWindow.zoom"));
    let error = folder.run("compare a.json c.json --page pair.html").refused();
    assert!(error.contains("the file exists already"), "{error}");
}
