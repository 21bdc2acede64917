//! The graphs of a run: read back, they have what the statistics have, and G_p is labelled as the chapter on graphs asks for.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use crate::support::command::Folder;

type Attributes = BTreeMap<String, String>;

/// A graph as a reader of GraphML finds it.
struct Read {
    vertices: BTreeMap<String, Attributes>,
    edges: Vec<(String, String, Attributes)>,
}

impl Read {
    /// Reads GraphML, and checks what its readers count on.
    fn graphml(text: &str) -> Read {
        let document = roxmltree::Document::parse(text).unwrap();
        let root = document.root_element();
        assert_eq!(root.tag_name().namespace(), Some("http://graphml.graphdrawing.org/xmlns"));
        let mut keys = BTreeMap::new();
        for key in root.children().filter(|node| node.has_tag_name("key")) {
            let of = |name| key.attribute(name).unwrap();
            assert!(["long", "double", "string", "boolean"].contains(&of("attr.type")));
            let known = (of("for").to_owned(), of("attr.name").to_owned(), of("attr.type").to_owned());
            assert!(keys.insert(of("id").to_owned(), known).is_none(), "each key once");
        }
        let graph = root.children().find(|node| node.has_tag_name("graph")).unwrap();
        assert_eq!(graph.attribute("edgedefault"), Some("directed"));
        let attributes = |node: roxmltree::Node<'_, '_>, of: &str| {
            let data = node.children().filter(|node| node.is_element());
            data.map(|data| {
                let (known_of, name, kind) = &keys[data.attribute("key").unwrap()];
                let text = data.text().unwrap_or_default().to_owned();
                assert_eq!(known_of, of);
                match kind.as_str() {
                    "long" => drop(text.parse::<i64>().unwrap()),
                    "double" => assert!(text.parse::<f64>().unwrap().is_finite()),
                    "boolean" => drop(text.parse::<bool>().unwrap()),
                    _ => {}
                }
                (name.clone(), text)
            })
            .collect::<Attributes>()
        };
        let mut read = Read { vertices: BTreeMap::new(), edges: Vec::new() };
        for node in graph.children().filter(|node| node.is_element()) {
            if node.has_tag_name("node") {
                let id = node.attribute("id").unwrap().to_owned();
                assert!(!id.contains(char::is_whitespace), "{id}");
                assert!(read.vertices.insert(id, attributes(node, "node")).is_none(), "each vertex once");
            } else {
                let end = |name| node.attribute(name).unwrap().to_owned();
                read.edges.push((end("source"), end("target"), attributes(node, "edge")));
            }
        }
        assert!(read.edges.iter().all(|(from, to, _)| [from, to].iter().all(|id| read.vertices.contains_key(*id))));
        read
    }

    fn vertex_sum(&self, name: &str) -> u64 {
        self.vertices.values().filter_map(|attributes| attributes.get(name)).map(|n| n.parse::<u64>().unwrap()).sum()
    }

    fn edge_sum(&self, name: &str) -> u64 {
        self.edges.iter().filter_map(|(.., attributes)| attributes.get(name)).map(|n| n.parse::<u64>().unwrap()).sum()
    }

    fn edges_of(&self, relation: &str, count: &str) -> u64 {
        let related =
            self.edges.iter().filter(|(.., attributes)| attributes.get("relation").is_some_and(|r| r == relation));
        related.map(|(.., attributes)| attributes[count].parse::<u64>().unwrap()).sum()
    }
}

/// A run with its graphs in all formats, and its statistics.
struct Run {
    folder: Folder,
    stats: Value,
}

impl Run {
    fn new(args: &str) -> Run {
        let folder = Folder::new();
        folder.run(&format!("{args} --graphs g --graph-format graphml,dot,json --stats s.json")).success();
        let stats = serde_json::from_str(&folder.read("s.json")).unwrap();
        Run { folder, stats }
    }

    /// A graph, the same in all formats.
    fn graph(&self, name: &str) -> Read {
        let read = Read::graphml(&self.folder.read(&format!("g/{name}.graphml")));
        let json: Value = serde_json::from_str(&self.folder.read(&format!("g/{name}.json"))).unwrap();
        let (nodes, edges) = (json["nodes"].as_array().unwrap(), json["edges"].as_array().unwrap());
        let as_text = |value: &Value| value.as_str().map_or(value.to_string(), str::to_owned);
        for node in nodes {
            let attributes = &read.vertices[node["id"].as_str().unwrap()];
            let mut others = node.as_object().unwrap().iter().filter(|(name, _)| *name != "id");
            assert_eq!(node.as_object().unwrap().len(), attributes.len() + 1);
            assert!(others.all(|(name, value)| match value.as_f64() {
                Some(number) => attributes[name].parse() == Ok(number),
                None => attributes[name] == as_text(value),
            }));
        }
        assert_eq!((nodes.len(), edges.len()), (read.vertices.len(), read.edges.len()));
        let dot = self.folder.read(&format!("g/{name}.dot"));
        assert_eq!(dot.matches("\" -> \"").count(), edges.len());
        assert_eq!(dot.lines().count(), nodes.len() + edges.len() + 2);
        read
    }

    fn classification(&self) -> Value {
        serde_json::from_str(&self.folder.read("g/classification.json")).unwrap()
    }

    fn sum(&self, pointer: &str) -> u64 {
        self.stats.pointer(pointer).unwrap().as_u64().unwrap()
    }
}

const KINDS: [&str; 4] = ["real_object", "virtual_object", "calculation", "information"];

/// The cycles of kernels of all cells, or nodes.
fn busy(stations: &Value, names: &[&str]) -> u64 {
    let of = |station: &Value| names.iter().filter_map(|name| station["busy"][name].as_u64()).sum::<u64>();
    stations.as_array().unwrap().iter().map(of).sum()
}

#[test]
fn the_graphs_of_an_array_have_what_its_statistics_have() {
    for args in [
        "--scene room --size 20x15",
        "--scene room --size 20x15 --mode broadcast --cells 1",
        "--scene teapot --size-factor 3 --size 20x15 --mode broadcast --cells 6 --masks boxes",
        "--scene room --size 20x15 --program hybrid-3 --groups 3 --stop-words 4",
        "image room --size 16x12 -o i.png --mode hybrid --groups 3 --stop-words 1 --bounded-walk",
        "image gears --size 16x12 -o i.png --mode broadcast --cells 4 --rules own+a4b",
        "image room --size 12x9 -o i.png --samples 2 --adaptive --on ipsc2 --mode broadcast --cells 4",
    ] {
        let run = Run::new(args);
        let [real, rays, processes] = ["G_r", "G_v", "G_p"].map(|name| run.graph(name));
        let all = busy(&run.stats["cells"], &["grid", "slabs", "intersection"]);
        assert_eq!(real.vertex_sum("work_cycles"), all, "{args}");
        assert_eq!((rays.vertex_sum("rays"), rays.vertex_sum("cycles")), (run.sum("/rays"), all), "{args}");
        let hits = run.sum("/counts/hits");
        assert_eq!((rays.vertex_sum("hits"), rays.edges_of("hits", "rays")), (hits, hits), "{args}");
        let primary = rays.vertices.get("primary0").unwrap()["rays"].parse::<u64>().unwrap();
        assert_eq!(rays.edges_of("asks for", "rays") + primary, run.sum("/rays"), "{args}");
        for kind in KINDS {
            for what in ["messages", "words"] {
                let told = run.sum(&format!("/messages/{kind}/{}", if what == "words" { what } else { "sent" }));
                assert_eq!(processes.edge_sum(&format!("{kind}_{what}")), told, "{args}: {kind} {what}");
            }
        }
        let words =
            run.stats["fifos"].as_array().unwrap().iter().map(|fifo| fifo["words"].as_u64().unwrap()).sum::<u64>();
        assert_eq!(processes.edge_sum("words"), words, "{args}");
        assert_eq!(KINDS.map(|kind| processes.edge_sum(&format!("{kind}_words"))).iter().sum::<u64>(), words, "{args}");
        for cell in run.stats["cells"].as_array().unwrap().iter().zip(0..) {
            let vertex = &processes.vertices[&format!("cell{}", cell.1)];
            assert_eq!(vertex["moving_cycles"], cell.0["moving"].to_string());
        }
        let memory = run.stats["configuration"]["memory"].as_array().unwrap();
        let held = memory.iter().map(|cell| 4 * cell["total"].as_u64().unwrap()).sum::<u64>();
        assert_eq!(processes.vertex_sum("bytes_held"), held, "{args}");
    }
}

#[test]
fn the_graphs_of_nodes_have_what_their_statistics_have() {
    for args in [
        "ipsc2 room --size 16x12 --nodes 1",
        "ipsc2 room --size 16x12 --nodes 6 --graph-of objects",
        "ipsc2 sombrero --size 16x12 --nodes 8 --grids own --graph-of polygons --termination token",
        "ipsc2 room --size 16x12 --nodes 5 --grant handshake --samples 2",
        "ipsc2 room --size 16x12 --nodes 4 --mode shared-memory",
        "ipsc2 room --size 16x12 --nodes 3 --mode shared-memory --distribution tiles",
    ] {
        let run = Run::new(args);
        let [real, rays, processes] = ["G_r", "G_v", "G_p"].map(|name| run.graph(name));
        let work = busy(&run.stats["tasks"], &["grid", "slabs", "intersection", "shading"]);
        assert_eq!((rays.vertex_sum("rays"), rays.vertex_sum("cycles")), (run.sum("/rays"), work), "{args}");
        let kinds = ["primary", "shadow", "reflected", "refracted"];
        let of_kinds =
            |what: &str| kinds.map(|kind| run.sum(&format!("/rays_by_kind/{kind}/{what}"))).iter().sum::<u64>();
        assert_eq!(
            (rays.vertex_sum("hits"), rays.edges_of("hits", "rays")),
            (of_kinds("hits"), of_kinds("hits")),
            "{args}"
        );
        assert_eq!(
            rays.edges_of("asks for", "rays") + run.sum("/rays_by_kind/primary/rays"),
            run.sum("/rays"),
            "{args}"
        );
        for kind in KINDS {
            assert_eq!(
                processes.edge_sum(&format!("{kind}_messages")),
                run.sum(&format!("/messages/{kind}/hops")),
                "{args}"
            );
        }
        let of_links = |name: &str| {
            let links = run.stats["links"].as_array().unwrap().iter();
            links.map(|link| link[name].as_u64().unwrap()).collect::<Vec<_>>()
        };
        let of_edges = |ending: &str| {
            let told =
                |(name, value): (&String, &String)| name.ends_with(ending).then(|| value.parse::<u64>().unwrap());
            processes.edges.iter().map(|(.., edge)| edge.iter().filter_map(told).sum()).collect::<Vec<u64>>()
        };
        assert_eq!(of_links("busy"), of_edges("busy_cycles"), "{args}");
        assert_eq!(of_links("messages"), of_edges("_messages"), "{args}");
        assert_eq!(of_links("bytes"), of_edges("_bytes"), "{args}");
        let tasks = run.stats["tasks"].as_array().unwrap();
        let counted = |name: &str| tasks.iter().filter_map(|task| task["counts"][name].as_u64()).sum::<u64>();
        assert_eq!(processes.vertex_sum("bytes_held"), counted("bytes"), "{args}");
        if args.contains("shared-memory") {
            let pages = run.sum("/messages/real_object/sent");
            assert_eq!((real.edge_sum("pages"), counted("pages_fetched")), (pages, pages), "{args}");
            continue;
        }
        assert_eq!(rays.vertex_sum("legs"), counted("legs"), "{args}");
        assert_eq!(real.edges_of("touches", "rays") + run.sum("/rays"), counted("legs"), "{args}");
        if args.contains("graph-of") {
            assert_eq!(real.edges_of("is in", "polygons"), counted("polygons"), "{args}");
        }
    }
}

/// What the chapter asks of the labels of G_p, on lines and cubes of all sizes; and how regular they are.
#[test]
fn processes_are_labelled_as_the_chapter_asks_for() {
    let hold = |run: &Run, border: &[&str], degree: u64| {
        let topology = &run.classification()["G_p"]["topology"];
        for law in ["one_edge_a_label", "no_cycle_of_a_label", "both_directions", "totally_regular"] {
            assert_eq!(topology[law], true, "{law}");
        }
        assert_eq!((&topology["border"], topology["degree"].as_u64()), (&serde_json::json!(border), Some(degree)));
    };
    for cells in 1..=8 {
        let run = Run::new(&format!("--scene room --size 4x3 --mode broadcast --cells {cells}"));
        let ends = ["cell0".to_owned(), format!("cell{}", cells - 1)];
        let ends = ends.each_ref().map(String::as_str);
        match cells {
            1 => hold(&run, &[], 0),
            2 => hold(&run, &[], 1),
            _ => hold(&run, &ends, 2),
        }
    }
    for nodes in [1, 2, 3, 4, 7, 8, 16] {
        let run = Run::new(&format!("ipsc2 room --size 16x12 --nodes {nodes}"));
        hold(&run, &[], u64::from((nodes as u32).next_power_of_two().ilog2()));
        let processes = run.graph("G_p");
        for (from, to, edge) in &processes.edges {
            let number = |id: &str| id.trim_start_matches(char::is_alphabetic).parse::<u32>().ok();
            let (Some(from), Some(to)) = (number(from), number(to)) else { continue };
            let (bit, sign) = edge["label"].split_at(edge["label"].len() - 1);
            assert_eq!((from ^ to, sign == "+"), (1 << bit.parse::<u32>().unwrap(), from < to));
        }
    }
}

/// Messages by kind, counted otherwise: by what the kernels did.
#[test]
fn the_kinds_of_messages_are_those_of_the_words_sent() {
    let run = Run::new("--scene room --size 20x15");
    let (rays, count) = (run.sum("/rays"), |name: &str| run.sum(&format!("/counts/{name}")));
    let sent = |run: &Run, kind: &str| run.sum(&format!("/messages/{kind}/sent"));
    // Each candidate from grid to slabs, each that is left from there on, and two ENDs a ray.
    assert_eq!(sent(&run, "real_object"), count("slab_tests") + count("intersection_tests") + 2 * rays);
    assert_eq!((sent(&run, "virtual_object"), sent(&run, "calculation")), (3 * rays, rays));
    assert_eq!(sent(&run, "information"), 0);
    // A word there and one back for each voxel and pair of neighbours, and those before the first ray.
    let run = Run::new("--scene room --size 20x15 --stop-words 7");
    assert_eq!(sent(&run, "information"), 4 * run.sum("/counts/voxels") + 6);
}

#[test]
fn single_rays_make_trees_that_end_in_what_they_hit() {
    for args in ["image room --size 16x12 -o i.png", "ipsc2 room --size 16x12 --nodes 4"] {
        let run = Run::new(&format!("{args} --graph-pixels 3..7,2..5 --hits h.csv"));
        let rays = run.graph("G_v");
        let (of_rays, objects): (Vec<_>, Vec<_>) = rays.vertices.iter().partition(|(id, _)| id.starts_with("ray"));
        assert!(objects.iter().all(|(id, _)| id.starts_with("object")));
        let pixels: BTreeSet<(u32, u32)> =
            of_rays.iter().map(|(_, ray)| (ray["x"].parse().unwrap(), ray["y"].parse().unwrap())).collect();
        assert!(pixels.iter().copied().eq((3..7).flat_map(|x| (2..5).map(move |y| (x, y)))), "{args}");
        let mut asked = BTreeMap::new();
        let (asks, hits): (Vec<_>, Vec<_>) = rays.edges.iter().partition(|(.., edge)| edge["relation"] == "asks for");
        for (from, to, _) in asks {
            assert!(asked.insert(to, from).is_none(), "{args}: a ray is asked for once");
        }
        for (id, ray) in &of_rays {
            let generation = |ray: &Attributes| ray["generation"].parse::<u32>().unwrap();
            match asked.get(id) {
                Some(parent) => assert_eq!(generation(&rays.vertices[*parent]) + 1, generation(ray)),
                None => assert_eq!((ray["kind"].as_str(), generation(ray)), ("primary", 0)),
            }
        }
        let hit: BTreeSet<&String> = hits.iter().map(|(from, ..)| from).collect();
        let with_t: BTreeSet<&String> =
            of_rays.iter().filter(|(_, ray)| ray.contains_key("t")).map(|(id, _)| *id).collect();
        assert_eq!((hit.len(), hit), (hits.len(), with_t), "{args}: f is a function");
    }
}

/// From when to when each ray was under way. An array's latencies are told by kind in its statistics; whoever is asked for comes later.
#[test]
fn single_rays_tell_when_they_were_under_way() {
    let image = "image room --size 14x10 -o i.png --graph-pixels 0..14,0..10";
    for args in [
        image,
        &format!("{image} --mode broadcast --cells 4 --rules own+a4b --policy primaries --order shuffle:3"),
        &format!("{image} --samples 2 --adaptive --in-flight 7 --policy generation --screen-rectangles scene"),
        &format!("{image} --on ipsc2 --mode broadcast --cells 4"),
        "ipsc2 room --size 14x10 --nodes 4 --graph-pixels 0..14,0..10",
        "ipsc2 room --size 14x10 --nodes 3 --graph-pixels 0..14,0..10 --mode shared-memory",
        "--scene room --size 14x10 --graph-pixels 0..14,0..10 --mode broadcast --cells 4 --fifo-words 16",
    ] {
        let run = Run::new(args);
        let rays = run.graph("G_v");
        let count = |ray: &Attributes, name: &str| ray[name].parse::<u64>().unwrap();
        let span = |ray: &Attributes| (count(ray, "start_cycle"), count(ray, "end_cycle"));
        for (from, to, edge) in &rays.edges {
            if edge["relation"] == "asks for" {
                assert!(span(&rays.vertices[to]).0 >= span(&rays.vertices[from]).1, "{args}: {from} {to}");
            }
        }
        let of_rays = || rays.vertices.values().filter(|vertex| vertex.contains_key("generation"));
        assert_eq!(of_rays().count() as u64, run.sum("/rays"), "{args}");
        let last = of_rays().map(|ray| span(ray).1).max().unwrap();
        if args.contains("ipsc2 room") {
            // One leg after the other; the end is told to the host behind the last.
            assert!(of_rays().all(|ray| span(ray).1 - span(ray).0 >= count(ray, "cycles")), "{args}");
            assert!(last < run.sum("/cycles"), "{args}");
            continue;
        }
        assert_eq!(last, run.sum("/cycles"), "{args}");
        let Some(kinds) = run.stats.get("rays_by_kind") else { continue };
        for (kind, told) in kinds.as_object().unwrap() {
            let of_kind = of_rays().filter(|ray| ray["kind"] == *kind);
            let mut latencies: Vec<u64> = of_kind.map(|ray| span(ray).1 - span(ray).0).collect();
            latencies.sort_unstable();
            let at = |percent: usize| {
                let rank = (latencies.len() * percent).div_ceil(100).max(1);
                latencies.get(rank - 1).copied().unwrap_or(0)
            };
            for (name, percent) in [("min", 0), ("p50", 50), ("p90", 90), ("p99", 99), ("max", 100)] {
                assert_eq!(told["latency"][name], at(percent), "{args}: {kind} {name}");
            }
        }
    }
    let rays = Run::new("--scene room --size 14x10").graph("G_v");
    assert!(rays.vertices.values().all(|vertex| !vertex.contains_key("start_cycle")), "many rays have no one time");
}

#[test]
fn graphs_that_cannot_be_are_refused() {
    let folder = Folder::new();
    for (args, told) in [
        ("--scene room --size 8x6 --graphs g --graph-pixels 4..9,0..2", "reach beyond the image, which has 8x6"),
        ("--scene room --size 8x6 --graphs g --graph-pixels 4..4,0..2", "expected columns and lines"),
        ("image room --size 90x90 -o i.png --graphs g --graph-pixels 0..90,0..90", "at most 10000"),
        ("--scene tree --size 8x6 --graphs g --graph-of polygons", "a graph has at most 10000 polygons"),
        ("image room --size 8x6 -o i.png --timing off --graphs g", "--graphs is about the machine at work"),
        (
            "ipsc2 room --size 16x12 --nodes 2 --mode shared-memory --graphs g --graph-of objects",
            "these nodes share pages",
        ),
        ("--scene room --size 8x6 --graphs -", "standard output is no folder"),
        ("--scene room --size 8x6 --graph-of objects", "--graphs"),
    ] {
        let refused = folder.run(args).refused();
        let flat = refused.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(flat.contains(told), "{args}: {refused}");
        assert_eq!(folder.names(), [""; 0], "{args}");
    }
    folder.run("ipsc2 room --size 16x12 --nodes 2 --tasks t.tasks").success();
    let refused = folder.run("replay t.tasks --on ipsc2 --graphs g").refused();
    assert!(refused.contains("--graphs is about tracing a scene"), "{refused}");
    folder.run("--scene room --size 8x6 --graphs g").success();
    let refused = folder.run("--scene room --size 8x6 --graphs g").refused();
    assert!(refused.contains("the file exists already"), "{refused}");
    folder.run("--scene room --size 8x6 --graphs g --force").success();
}
