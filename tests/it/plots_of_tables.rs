//! `pcs-sim plot`: pictures of tables that are there already.

use pcs_sim::report::table::StoredTable;

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
    assert!(text("Rooms") && text("Times as fast as one node over cells, by mode") && text("broadcast"), "{svg}");
    assert!(text("-2") && !text("70"), "rows of another scene are left out: {svg}");
    let error = folder.run("plot t.csv x=cells y=speed_up -o rooms").refused();
    assert!(error.contains("exists already"), "{error}");
}

/// Tables of several machines have a column of one name: what it is called follows from the others.
#[test]
fn a_column_is_called_as_in_tables_of_its_kind() {
    let folder = Folder::new();
    for (column, called) in [("tasks", "Times as fast as one worker"), ("nodes", "Times as fast as one node")] {
        folder.file("t.csv", format!("{column},speed_up\n1,1\n2,1.9\n"));
        folder.run(&format!("plot t.csv x={column} y=speed_up -o p --force")).success();
        assert!(folder.read("p.svg").contains(called), "{column}");
    }
}

/// Numbers next to each other have labels that differ; those at the ends of what numbers can be are refused.
#[test]
fn numbers_near_each_other_or_out_of_reach() {
    let folder = Folder::new();
    folder.file("near.csv", "x,y\n-44.621551513671875,1\n-44.62155151367187,2\n");
    folder.run("plot near.csv x=x y=y -o near").success();
    let svg = folder.read("near.svg");
    let labels: Vec<&str> = svg.lines().filter(|line| line.starts_with("-44.6")).collect();
    let distinct: std::collections::BTreeSet<&&str> = labels.iter().collect();
    assert!(labels.len() > 1 && distinct.len() == labels.len(), "{labels:?}");
    for (table, number) in [("1,0\n2,5e-324", "5e-324"), ("1,1\n2,1e300\n3,1e100", "1e300"), ("1,1\n1e200,2", "1e200")]
    {
        folder.file("far.csv", format!("x,y\n{table}\n"));
        let error = folder.run("plot far.csv x=x y=y -o far").refused();
        assert!(error.contains(&format!("{number} cannot be drawn")), "{error}");
    }
}

#[test]
fn mistakes_are_told() {
    let folder = Folder::new();
    folder.file("t.csv", TABLE);
    folder.file("torn.csv", "a,b\n1\n");
    folder.file("damaged.parquet", "PAR1 and nothing else");
    for (words, complaint) in [
        ("t.csv x=cell y=speed_up", "did you mean `cells`?"),
        ("t.csv x=cells y=mode", "column 'mode' holds no numbers"),
        ("t.csv x=cells by=mode", "expected x=COLUMN y=COLUMN"),
        ("t.csv x=cells y=speed_up y=cells", "not 'y=cells'"),
        ("t.csv x=cells y=speed_up log=up", "log= takes x, y, xy or none"),
        ("t.csv x=cells y=speed_up cm=16", "cm= takes a width and a height in cm"),
        ("t.csv x=cells y=speed_up cm=1x900", "a side has 4 to 100 cm"),
        ("t.csv x=cells y=speed_up log=y scene=room", "a logarithmic axis has numbers above 0"),
        ("t.csv x=cells y=speed_up relative=two scene=room", "relative= names no line 'two'"),
        ("t.csv x=cells y=speed_up by=mode", "differ in scene"),
        ("damaged.parquet x=cells y=speed_up", "is no table"),
        ("t.csv x=cells y=speed_up sene=room", "did you mean `scene`?"),
        ("t.csv x=cells y=speed_up scene=attic", "nothing to draw"),
        ("torn.csv x=a y=b", "is no table"),
        ("none.csv x=a y=b", "none.csv"),
    ] {
        let error = folder.run(&format!("plot {words} -o p")).refused();
        assert!(error.contains(complaint), "{words}: {error}");
        assert_eq!(folder.names(), ["damaged.parquet", "t.csv", "torn.csv"], "{words}");
    }
}

/// No damage of a Parquet file is more than a complaint: each byte of one that is turned over in some bit, and each that ends early.
#[test]
fn a_damaged_table_is_read_or_told() {
    let folder = Folder::new();
    folder.file("s.ron", "(scene: \"room\", size: 4, fifo_words: [8, 16])");
    folder.run("sweep s.ron -o t.csv").success();
    let whole = std::fs::read(folder.path("t.parquet")).unwrap();
    let read = |bytes: &[u8]| {
        std::fs::write(folder.path("damaged.parquet"), bytes).unwrap();
        StoredTable::read(&folder.path("damaged.parquet"), |_, _| None)
    };
    assert_eq!(read(&whole).unwrap().rows().len(), 2);
    for place in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[place] ^= 1 << (place % 8);
        let _ = read(&damaged);
    }
    assert!((4..whole.len()).step_by(7).all(|end| read(&whole[..end]).is_err()));
}

/// Standard output takes one picture, and no table, which is several files.
#[test]
fn what_standard_output_takes() {
    let folder = Folder::new();
    folder.file("t.csv", TABLE);
    folder.file("s.ron", "(scene: \"room\", size: \"4x4\")");
    let plot = "plot t.csv x=cells y=speed_up by=mode scene=room -o -";
    assert!(folder.run(plot).refused().contains("standard output takes one picture, and 2 are asked for"));
    let svg = folder.run(&format!("{plot} --plot-format svg")).success();
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"), "{svg}");
    for command in ["sweep s.ron", "size-fifos --scene room --size 4x4"] {
        assert!(folder.run(&format!("{command} -o -.csv")).refused().contains("a table is several files"), "{command}");
    }
    assert_eq!(folder.names(), ["s.ron", "t.csv"]);
}

/// The texts of a picture.
fn texts(svg: &str) -> Vec<&str> {
    svg.split("<text").skip(1).filter_map(|text| text.split('\n').nth(1)).collect()
}

#[test]
fn no_point_is_an_average_over_what_is_not_shown() {
    let folder = Folder::new();
    folder.file("t.csv", TABLE);
    // The scene alone tells the rows apart: it has lines.
    folder.run("plot t.csv x=cells y=speed_up -o scenes").success();
    let svg = folder.read("scenes.svg");
    assert!(
        ["Times as fast as one node over cells, by scene", "room", "lake"]
            .iter()
            .all(|text| texts(&svg).contains(text))
    );
    folder.run("plot t.csv x=cells y=speed_up by=mode facet=scene -o panels").success();
    let panels = folder.read("panels.svg");
    assert!(["scene room", "scene lake", "broadcast"].iter().all(|text| texts(&panels).contains(text)), "{panels}");
}

#[test]
fn sizes_are_in_cm_and_pictures_can_be_pages() {
    let folder = Folder::new();
    folder.file("t.csv", TABLE);
    let plot = "plot t.csv x=cells y=speed_up scene=room cm=16x9 relative=first --plot-format svg,pdf -o p";
    assert_eq!(folder.run(plot).success(), "wrote p.svg\nwrote p.pdf\n");
    assert!(folder.read("p.svg").contains("<svg width=\"16cm\" height=\"9cm\" viewBox=\"0 0 605 340\""));
    let pdf = std::fs::read(folder.path("p.pdf")).unwrap();
    assert!(pdf.starts_with(b"%PDF-") && pdf.ends_with(b"%%EOF"));
    let text = String::from_utf8_lossy(&pdf);
    // 16 cm are 454 points.
    let page = text.split("/MediaBox [0 0 ").nth(1).unwrap().split(']').next().unwrap();
    assert_eq!(page, "453.75 255", "{page}");
}

/// A sweep's tables in both formats give the same picture, which is the sweep's own.
#[test]
fn parquet_is_read_and_all_doors_speak_with_one_voice() {
    let folder = Folder::new();
    folder.file(
        "sweep.ron",
        r#"(scene: "room", size: 8, mode: "broadcast", cells: [1, 2], partition: ["regular", "work"])"#,
    );
    folder.run("sweep sweep.ron -o t.csv --plot x=cells y=rays_per_second by=partition log=y").success();
    let words = "x=cells y=rays_per_second by=partition log=y";
    folder.run(&format!("plot t.csv {words} -o csv")).success();
    folder.run(&format!("plot t.parquet {words} -o parquet")).success();
    let sweeps = folder.read("t-rays_per_second-over-cells-by-partition-log-y.svg");
    assert!(folder.read("csv.svg") == sweeps && folder.read("parquet.svg") == sweeps);
    let what = "4 points: scene room; size 8x8; mode broadcast; cells 1, 2; partition regular, work";
    assert!(texts(&sweeps).contains(&what), "{:?}", texts(&sweeps));
    assert!(texts(&sweeps).contains(&"rays a second of simulated time, logarithmic"));
}

/// The texts of a picture as they stand across it: from where to where, at the most, and what they say. Rotated ones are left out.
fn across(svg: &str) -> Vec<(f64, f64, &str)> {
    let texts = svg.split("<text ").skip(1).filter(|text| !text.split('>').next().unwrap().contains("rotate"));
    let attribute = |text: &str, name: &str| {
        text.split(&format!("{name}=\"")).nth(1).unwrap().split('"').next().unwrap().to_owned()
    };
    let place = |text: &'_ str| {
        let said = text.split('\n').nth(1).unwrap();
        let size = attribute(text, "font-size").trim_end_matches("px").parse::<f64>().unwrap();
        // Digits of the font are 0.636 of its size wide, and most letters narrower.
        let (x, width) = (attribute(text, "x").parse::<f64>().unwrap(), 0.636 * size * said.chars().count() as f64);
        match attribute(text, "text-anchor").as_str() {
            "middle" => (x - width / 2.0, x + width / 2.0),
            "end" => (x - width, x),
            _ => (x, x + width),
        }
    };
    texts
        .map(|text| {
            let (from, until) = place(text);
            (from, until, text.split('\n').nth(1).unwrap())
        })
        .collect()
}

/// Long numbers at the end of the axis are in the picture, stand apart, and are not cut.
#[test]
fn numbers_along_the_axis_have_room() {
    let folder = Folder::new();
    for numbers in [
        vec![0.0, 2e8, 4e8, 6e8, 8e8, 9.99e8],
        vec![1e7, 2e7, 4e7, 8e7, 1.6e8, 3.2e8, 6.4e8],
        vec![-44.621551513671875, -44.62155151367187],
        vec![123_456_000.0, 123_456_001.0, 123_456_002.0],
    ] {
        let rows: String =
            numbers.iter().enumerate().map(|(row, x)| format!("{x},{row},a\n{x},{},b\n", row + 1)).collect();
        folder.file("t.csv", format!("x,y,line\n{rows}"));
        for (words, width) in [("line=a", 1280.0), ("by=line", 1280.0 - 230.0), ("line=a cm=8x6", 302.0)] {
            folder.run(&format!("plot t.csv x=x y=y {words} -o p --force --plot-format svg")).success();
            let svg = folder.read("p.svg");
            let texts = across(&svg);
            // The numbers below the axis stand in one line, in the middle of their places.
            let is_number =
                |text: &str| !text.is_empty() && text.chars().all(|c| c.is_ascii_digit() || " .e-".contains(c));
            let mut below: Vec<_> = texts.iter().filter(|text| is_number(text.2) && text.1 > 130.0).collect();
            below.sort_by(|a, b| a.0.total_cmp(&b.0));
            assert!(below.len() > usize::from(width > 400.0), "{words}: {texts:?}");
            assert!(below.iter().all(|text| text.1 <= width), "{words}: {below:?}");
            assert!(below.windows(2).all(|pair| pair[0].1 < pair[1].0), "{words}: {below:?}");
            assert!(
                texts.iter().all(|text| !text.2.ends_with('…') || !is_number(text.2.trim_end_matches('…'))),
                "{texts:?}"
            );
        }
    }
}

/// What is too long for a line gets smaller letters, and ends with dots where these do not do.
#[test]
fn long_titles_stay_in_the_picture() {
    let folder = Folder::new();
    folder.file("t.csv", TABLE);
    for (length, is_cut) in [(100, false), (130, false), (400, true)] {
        let title: String = "0123456789".chars().cycle().take(length).collect();
        folder.run(&format!("plot t.csv x=cells y=speed_up scene=room -o p --force --title {title}")).success();
        let svg = folder.read("p.svg");
        let (_, until, told) = *across(&svg).iter().find(|text| text.2.starts_with("0123456789")).unwrap();
        assert!(until <= 1280.0, "{length}: {until}");
        assert_eq!(told.ends_with('…'), is_cut, "{told}");
    }
    // The captions of runs are as long as the names of files.
    let name = format!("{}.ops", "n".repeat(200));
    folder.file(&name, "0 host w8\n0 0 x8 g100 o5\n");
    folder.run(&format!("replay {name} --plot plots --plot-format svg")).success();
    let svg = std::fs::read_to_string(folder.path("plots/cells.svg")).unwrap();
    let (_, until, told) = *across(&svg).iter().find(|text| text.2.starts_with("replay of nnn")).unwrap();
    assert!(until <= 1280.0 && told.ends_with('…'), "{until} {told}");
}

/// The axis of relative values says to what.
#[test]
fn relative_axes_say_to_what() {
    let folder = Folder::new();
    folder.file("t.csv", TABLE);
    for (to, told) in [("first", "relative to the first point of each line"), ("room", "relative to room")] {
        folder.run(&format!("plot t.csv x=cells y=speed_up by=scene relative={to} -o p --force")).success();
        let svg = folder.read("p.svg");
        let axis = svg.split("<text ").find(|text| text.split('>').next().unwrap().contains("rotate")).unwrap();
        assert!(axis.contains(told), "{axis}");
    }
}
