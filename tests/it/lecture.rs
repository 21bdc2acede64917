//! docs/lecture.md: its runs give its pictures, and print what it says.
//!
//! `UPDATE_DOCS=1 cargo test --release --test it lecture` puts the pictures there anew.

use std::path::Path;

use crate::support::command::Folder;

const LECTURE: &str = "docs/lecture.md";

/// What stands between two marks, each time.
fn between<'a>(text: &'a str, open: &str, close: &str) -> Vec<&'a str> {
    text.split(open).skip(1).filter_map(|rest| rest.split_once(close)).map(|(inside, _)| inside).collect()
}

#[test]
fn the_lectures_runs_show_what_it_says() {
    let text = std::fs::read_to_string(LECTURE).unwrap();
    let folder = Folder::new();
    std::fs::copy("docs/lecture/grid.ron", folder.path("grid.ron")).unwrap();
    let sections: Vec<&str> = text.split("\n## ").skip(1).collect();
    assert_eq!(sections.len(), 5);
    for section in sections {
        let commands: Vec<&str> = section.lines().filter_map(|line| line.strip_prefix("$ pcs-sim ")).collect();
        assert!(!commands.is_empty(), "{section}");
        let told: String = commands.iter().map(|command| folder.run(command).success()).collect();
        for said in section.split("**").skip(1).step_by(2) {
            assert!(told.contains(said), "{said} is not in {told}");
        }
        let pictures = between(section, "](lecture/", ")");
        assert!(!pictures.is_empty(), "{section}");
        for picture in pictures {
            // A plot's folder is the first part of the picture's name.
            let made = match picture.split_once('-') {
                Some((plot, name)) if folder.path(plot).is_dir() => folder.path(plot).join(name),
                _ => folder.path(picture),
            };
            let (kept, made) = (Path::new("docs/lecture").join(picture), std::fs::read(made).unwrap());
            if std::env::var_os("UPDATE_DOCS").is_some() {
                std::fs::write(kept, made).unwrap();
            } else {
                assert!(std::fs::read(kept).unwrap() == made, "{picture} is another; UPDATE_DOCS=1 writes it anew");
            }
        }
    }
}
