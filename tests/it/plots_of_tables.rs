//! `pcs-sim plot`: pictures of tables that are there already.

use crate::support::command::Folder;

const TABLE: &str = "\
scene,cells,mode,speed_up
room,1,broadcast,1
room,2,broadcast,1.5
room,4,broadcast,-2
lake,1,broadcast,77
";

#[test]
fn any_table_is_drawn() {
    let folder = Folder::new();
    folder.file("t.csv", TABLE);
    let stdout = folder.run("plot t.csv x=cells y=speed_up by=mode scene=room -o rooms --title Rooms").success();
    assert_eq!(stdout, "wrote rooms.svg\nwrote rooms.png\n");
    let svg = folder.read("rooms.svg");
    let text = |text: &str| svg.contains(&format!("\n{text}\n"));
    assert!(text("Rooms") && text("Speed up over cells, by mode") && text("broadcast"), "{svg}");
    assert!(text("-2") && !text("70"), "rows of another scene are left out: {svg}");
    let error = folder.run("plot t.csv x=cells y=speed_up -o rooms").refused();
    assert!(error.contains("exists already"), "{error}");
}

#[test]
fn mistakes_are_told() {
    let folder = Folder::new();
    folder.file("t.csv", TABLE);
    folder.file("torn.csv", "a,b\n1\n");
    for (words, complaint) in [
        ("t.csv x=cell y=speed_up", "did you mean `cells`?"),
        ("t.csv x=cells y=mode", "column 'mode' holds no numbers"),
        ("t.csv x=cells by=mode", "expected x=COLUMN y=COLUMN"),
        ("t.csv x=cells y=speed_up sene=room", "did you mean `scene`?"),
        ("t.csv x=cells y=speed_up scene=attic", "nothing to draw"),
        ("torn.csv x=a y=b", "is no table"),
        ("none.csv x=a y=b", "none.csv"),
    ] {
        let error = folder.run(&format!("plot {words} -o p")).refused();
        assert!(error.contains(complaint), "{words}: {error}");
        assert_eq!(folder.names(), ["t.csv", "torn.csv"], "{words}");
    }
}
