//! FIFOs are sized by exact replays: what is found is as fast as asked for, and with a word fewer in any FIFO it is not.

use std::sync::Arc;

use crate::support::command::Folder;
use crate::support::random_ops::{RayPlan, batches_of, case, costs};
use crate::support::ticking;
use pcs_sim::cancel::Cancel;
use pcs_sim::machine::{Array, FifoName, MachineSpec, Unfinished, Words};
use pcs_sim::run::{Fewer, Front, Recorded, SLOWER, SizingError, size_fifos};
use pcs_sim::seam::{OpBatch, OpKind, Unit};
use proptest::prelude::*;
use serde_json::Value;

fn sized(spec: &MachineSpec, batches: &[OpBatch]) -> Result<Front, SizingError> {
    let costs = costs();
    let batches: Vec<Arc<OpBatch>> = batches.iter().cloned().map(Arc::new).collect();
    let recorded = Recorded { batches: &batches, costs: &costs, spec, least_z_words: Words(1) };
    size_fifos(recorded, &SLOWER, &Cancel::default(), |_| ())
}

/// The machine with these depths.
fn deep(front: &Front, words: &[Words], spec: &MachineSpec) -> MachineSpec {
    let own_words = front.fifos.iter().copied().zip(words.iter().copied()).collect();
    MachineSpec { own_words, ..spec.clone() }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    /// Against the ticking model, on random machines and op streams.
    #[test]
    fn each_machine_is_as_fast_as_asked_for_and_none_with_a_word_fewer((spec, cells, rays, per_batch) in case()) {
        let batches = batches_of(cells, &rays, per_batch);
        let ticked = |spec: &MachineSpec| ticking::run(spec, &costs(), &batches);
        let all = |words: u64| {
            MachineSpec { fifo_words: Words(words), channel_words: [None; 3], own_words: Default::default(), ..spec.clone() }
        };
        // Deeper than all words of all rays together.
        let unlimited = ticked(&all(1 << 17));
        let Ok(front) = sized(&spec, &batches) else {
            prop_assert!(unlimited.is_none());
            return Ok(());
        };
        let unlimited = unlimited.expect("it ends");
        prop_assert_eq!(front.unlimited.cycles, unlimited.cycles);
        let with = |words: &[Words]| ticked(&deep(&front, words, &spec));
        // With the unlimited depths nothing changes, and with one word fewer something does.
        let seen = |words: &[Words]| with(words).map(|run| {
            let fifos: Vec<_> = run.fifos.iter().map(|(name, _, held)| (name.clone(), held.max, held.word_cycles, held.empty)).collect();
            (run.cycles, run.stations, fifos)
        });
        // What happens after the host's last read is in no statistics.
        let mut array = Array::new(&deep(&front, &front.unlimited.words, &spec), &costs(), cells);
        batches.iter().for_each(|batch| array.feed(batch.clone()).expect("an array can do it"));
        let outlived = matches!(array.finish(), Err(Unfinished::Outlived(_)));
        let nothing_waits = seen(&front.unlimited.words);
        for index in 0..front.fifos.len() {
            let mut fewer = front.unlimited.words.clone();
            if fewer[index] > Words(1) && !outlived {
                fewer[index] = fewer[index] - Words(1);
                prop_assert_ne!(&seen(&fewer), &nothing_waits, "{}", front.fifos[index]);
            }
            let mut more = front.unlimited.words.clone();
            more[index] += Words(5);
            prop_assert_eq!(&seen(&more), &nothing_waits, "{}", front.fifos[index]);
        }
        prop_assert_eq!(front.points.len(), SLOWER.len());
        for point in &front.points {
            let most = front.unlimited.cycles.0 + front.unlimited.cycles.0 * point.slower / 1000;
            let cycles = with(&point.depths.words).expect("it ends").cycles;
            prop_assert_eq!(cycles, point.depths.cycles);
            prop_assert!(cycles.0 <= most);
            for (index, fewer) in point.fewer.iter().enumerate() {
                prop_assert_eq!(fewer.is_none(), point.depths.words[index] == Words(1));
                let mut words = point.depths.words.clone();
                words[index] = Words(words[index].0.saturating_sub(1).max(1));
                match fewer {
                    None => (),
                    Some(Fewer::Cycles(cycles)) => {
                        prop_assert!(cycles.0 > most);
                        prop_assert_eq!(Some(*cycles), with(&words).map(|run| run.cycles));
                    }
                    Some(Fewer::Stuck(_)) => prop_assert!(with(&words).is_none()),
                }
            }
        }
        // Who may be slower needs no more words.
        prop_assert!(front.points.windows(2).all(|pair| pair[1].depths.total() <= pair[0].depths.total()));
        let (least, end) = &front.least;
        prop_assert_eq!(with(least).is_none(), matches!(end, Fewer::Stuck(_)));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    /// In runs of many more words than a FIFO without a limit remembers at once, whatever the batches.
    #[test]
    fn as_deep_as_is_enough_no_word_waits((spec, cells, rays, per_batch) in case()) {
        let rays: Vec<_> = rays.iter().map(RayPlan::at_once).cycle().take(700).collect();
        let deepest = Words(1 << 17);
        let spec = MachineSpec { fifo_words: deepest, channel_words: [None; 3], own_words: Default::default(), ..spec };
        let run = |array: Array, per_batch: usize| {
            let mut array = array;
            for batch in batches_of(cells, &rays, per_batch) {
                array.feed(batch).expect("an array can do it");
                array.run().ok()?;
            }
            array.finish().ok()
        };
        let told = |per_batch: usize| run(Array::new(&spec, &costs(), cells).beside_unlimited(&spec, &costs()), per_batch);
        let Some(at_once) = told(rays.len()) else { return Ok(()) };
        // 64 rays have as many words on X as what holds them has places.
        for per_batch in [per_batch, 64, 97] {
            let told = told(per_batch);
            prop_assert_eq!(told.as_ref(), Some(&at_once));
        }
        let names = at_once.topology.fifos.iter().map(|fifo| fifo.name.parse::<FifoName>().expect("it is a FIFO's"));
        let enough: Vec<(FifoName, Words)> =
            names.zip(&at_once.fifos).map(|(name, fifo)| (name, fifo.enough.expect("it is told"))).collect();
        // Where words lay, and for how long.
        let seen = |depths: &[(FifoName, Words)]| {
            let spec = MachineSpec { own_words: depths.iter().copied().collect(), ..spec.clone() };
            let measured = run(Array::new(&spec, &costs(), cells), rays.len())?;
            let fifos: Vec<_> = measured.fifos.iter().map(|fifo| (fifo.max, fifo.word_cycles, fifo.empty)).collect();
            Some((measured.cycles, measured.stations, fifos))
        };
        let nothing_waits = seen(&[]);
        prop_assert_eq!(&seen(&enough), &nothing_waits);
        for index in (0..enough.len()).filter(|&index| enough[index].1 > Words(1)) {
            let mut fewer = enough.clone();
            fewer[index].1 = fewer[index].1 - Words(1);
            prop_assert_ne!(&seen(&fewer), &nothing_waits, "{}", enough[index].0);
        }
    }
}

/// Batches of as many words as what holds them has places, each of which is read before the next is written: words are forgotten as
/// soon as they may be.
#[test]
fn what_is_enough_is_the_same_where_each_batch_fills_what_remembers_it() {
    let unit = Unit(3);
    let batch = |rays: u32| {
        let mut batch = OpBatch::new(3);
        for ray in 0..rays {
            batch.host.push(OpKind::WriteX, 8);
            batch.host.end_line(ray);
            for cell in 0..3 {
                let ops = &mut batch.cells[cell];
                ops.push(OpKind::PassX, 8);
                ops.push(OpKind::Work(unit), 40 - 10 * cell as u64);
                if cell > 0 {
                    ops.push(OpKind::ReadY, 2);
                }
                ops.push(OpKind::WriteY, if cell < 2 { 2 } else { 5 });
                ops.end_line(ray);
            }
        }
        batch
    };
    let enough = |rays_per_batch: u32| {
        let spec = MachineSpec::default();
        let mut array = Array::unlimited(&spec, &costs(), 3);
        for _ in 0..1024 / rays_per_batch {
            array.feed(batch(rays_per_batch)).unwrap();
            array.run().unwrap();
        }
        array.enough()
    };
    let at_once = enough(1024);
    assert!(at_once[1..].iter().all(|words| *words < Words(64)), "{at_once:?}");
    for rays_per_batch in [32, 64, 128, 512] {
        assert_eq!(enough(rays_per_batch)[1..], at_once[1..], "{rays_per_batch}");
    }
}

/// The table's rows, each as columns and cells.
fn rows(folder: &Folder, name: &str) -> Vec<std::collections::BTreeMap<String, String>> {
    let text = folder.read(name);
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let columns = reader.headers().unwrap().clone();
    let row = |row: csv::StringRecord| columns.iter().map(str::to_owned).zip(row.iter().map(str::to_owned)).collect();
    reader.records().map(|record| row(record.unwrap())).collect()
}

fn cycles(folder: &Folder, run: &str) -> String {
    folder.run(&format!("{run} --stats s.json --force")).success();
    let stats: Value = serde_json::from_str(&folder.read("s.json")).unwrap();
    stats["cycles"].to_string()
}

#[test]
fn the_machines_it_writes_are_what_it_says() {
    for mode in ["--mode pipeline", "--mode broadcast --cells 3 --order stride", "--mode pipeline --stop-words 6"] {
        let folder = Folder::new();
        let run = format!("{mode} --scene teapot --size-factor 3 --size 40x30");
        let text = folder.run(&format!("size-fifos {run} -o t.csv --plot --machines")).success();
        assert!(text.ends_with("wrote t-90.ron\n") && text.contains("Each machine is least FIFO by FIFO"), "{text}");
        let table = rows(&folder, "t.csv");
        let of = |what: &'static str| table.iter().filter(move |row| row["depths"] == what);
        assert_eq!([of("unlimited").count(), of("fewest").count(), of("least").count()], [1, 5, 1]);
        let unlimited: u64 = of("unlimited").next().unwrap()["cycles"].parse().unwrap();
        assert_eq!(unlimited.to_string(), cycles(&folder, &format!("{run} --fifo-words 1048576")));
        for (row, name) in of("fewest").zip(["100", "99.9", "99", "95", "90"]) {
            assert_eq!(row["cycles"], cycles(&folder, &format!("{run} --machine t-{name}.ron")), "{mode} {name}");
            let (speed, wanted): (f64, f64) = (row["speed"].parse().unwrap(), row["speed_wanted"].parse().unwrap());
            assert!(speed >= wanted && (100.0 * wanted).to_string() == name, "{mode} {name}");
            for fewer in of("one fewer").filter(|fewer| fewer["speed_wanted"] == row["speed_wanted"]) {
                let fifo = &fewer["one_fewer"];
                let [depth, less] = [row, fewer].map(|row| row[fifo].parse::<u64>().unwrap());
                assert_eq!(depth, less + 1);
                let most = unlimited as f64 * (2.0 - wanted);
                assert!(
                    fewer["cycles"].parse::<f64>().is_ok_and(|cycles| cycles > most.floor()),
                    "{mode} {name} {fifo}"
                );
            }
        }
        // The same from a recording, but for what only the scene tells.
        folder.run(&format!("{run} --ops a.ops")).success();
        if !mode.contains("stop-words") {
            folder.run("size-fifos --ops a.ops -o o.csv").success();
            assert_eq!(folder.read("o.csv"), folder.read("t.csv"));
        }
    }
}

/// Any run tells the depths from which nothing changes any more: those that sizing finds, and with them nothing does.
#[test]
fn what_is_enough_is_told_beside_any_run() {
    let folder = Folder::new();
    let stats = |name: &str| -> Value { serde_json::from_str(&folder.read(name)).unwrap() };
    let of = |name: &str, what: &str| -> Vec<(String, u64)> {
        let fifos = stats(name)["fifos"].as_array().unwrap().clone();
        fifos.iter().map(|fifo| (fifo["name"].as_str().unwrap().to_owned(), fifo[what].as_u64().unwrap())).collect()
    };
    let machine = "--fifo-words 9 --latency-cycles 3 --link-mb-s 30";
    for run in [
        "--mode broadcast --cells 3 --scene teapot --size-factor 3 --size 24x18".to_owned(),
        "image room -o a.png --size 12x9 --mode hybrid --cells 4 --in-flight 6 --stop-words 2".to_owned(),
    ] {
        let told = folder.run(&format!("{run} {machine} --ops a.ops --stats a.json --force --enough")).success();
        assert!(told.contains("  enough  "), "{told}");
        let enough = of("a.json", "enough");
        let unlimited = "--latency-cycles 3 --link-mb-s 30";
        folder.run(&format!("size-fifos --ops a.ops {unlimited} --speed 50 -o t.csv --force")).success();
        let rows = rows(&folder, "t.csv");
        for (name, words) in enough.iter().filter(|(name, _)| rows[0].contains_key(name)) {
            assert_eq!(rows[0][name], words.to_string(), "{run} {name}");
        }
        // The same whatever the run's own depths are, and beside a critical path.
        for words in [1 << 10, 1 << 20] {
            let replay = format!("why a.ops {unlimited} --fifo-words {words} --stats b.json --force --enough");
            assert!(folder.run(&replay).success().contains("  enough  "));
            assert_eq!(of("b.json", "enough"), enough, "{run}");
        }
        let least = &rows[0]["cycles"];
        assert_eq!(&stats("b.json")["cycles"].to_string(), least);
        folder.run(&format!("{run} {machine} --stats c.json --force")).success();
        let mut told = stats("a.json");
        told["fifos"].as_array_mut().unwrap().iter_mut().for_each(|fifo| {
            fifo.as_object_mut().unwrap().remove("enough");
        });
        assert_eq!(told, stats("c.json"), "nothing else changes");
    }
    for refused in [
        "image room -o b.png --size 4x4 --timing off --enough",
        "farm rectangles --size 8x8 --enough",
        "why a.ops --cell 0 --at 5 --enough",
    ] {
        assert!(folder.run(refused).refused().contains("--enough is about"), "{refused}");
    }
}

#[test]
fn speeds_can_be_chosen() {
    let folder = Folder::new();
    let run = "size-fifos --scene room --size 24x18 --mode pipeline";
    folder.run(&format!("{run} --speed 97.5 --speed 99 --speed 97.5 -o t.csv --machines")).success();
    let fewest: Vec<_> = rows(&folder, "t.csv").into_iter().filter(|row| row["depths"] == "fewest").collect();
    assert_eq!(fewest.iter().map(|row| row["speed_wanted"].as_str()).collect::<Vec<_>>(), ["0.99", "0.975"]);
    let number = |row: &std::collections::BTreeMap<String, String>, name: &str| row[name].parse::<f64>().unwrap();
    assert!(fewest.iter().all(|row| number(row, "speed") >= number(row, "speed_wanted")));
    assert!(folder.path("t-99.ron").exists() && folder.path("t-97.5.ron").exists());
}

#[test]
fn a_depth_that_can_never_do_is_a_row_that_says_so() {
    let folder = Folder::new();
    // Cell 1 wants its ray before the words on Y, which cell 0 sends before the ray.
    let ray = |ray: u32| format!("{ray} host w8\n{ray} 0 r8 o60 g500 w8\n{ray} 1 r8 i60 o5\n");
    folder.file("a.ops", (0..40).map(ray).collect::<String>());
    insta::assert_snapshot!(folder.run("size-fifos --ops a.ops -o t.csv").success());
    let table = rows(&folder, "t.csv");
    let stuck: Vec<_> = table.iter().filter(|row| !row["error"].is_empty()).collect();
    assert_eq!(stuck.iter().filter(|row| row["one_fewer"] == "Y1" && row["Y1"] == "59").count(), 5);
    assert!(stuck.iter().all(|row| row["error"].starts_with("deadlock: ") && row["cycles"].is_empty()), "{stuck:?}");
    assert_eq!(stuck.last().unwrap()["depths"], "least");
}

#[test]
fn the_manual_shows_a_real_search() {
    let manual = include_str!("../../docs/using.md");
    let (_, section) = manual.split_once("\n## How deep must FIFOs be?\n").unwrap();
    let (command, shown) = section.split_once("$ pcs-sim ").unwrap().1.split_once('\n').unwrap();
    let found = Folder::new().run(command).success();
    assert_eq!(found.split("\nFound by").next().unwrap(), shown.split("```").next().unwrap());
}

#[test]
fn what_it_would_not_look_at_is_refused() {
    let folder = Folder::new();
    folder.run("--scene room --size 8x6 --ops a.ops").success();
    for (args, why) in [
        ("--scene room --fifo-words 64", "--fifo-words is what is sought here"),
        ("--scene room --y-fifo-words 64", "--y-fifo-words is what is sought here"),
        ("--ops a.ops --scene room", "--scene is about what the trace has recorded"),
        ("--ops a.ops --order stride", "--order is about what the trace has recorded"),
        ("--ops a.ops --memory-words 5", "--memory-words is about what the trace has recorded"),
        ("--scene room --speed 101", "speeds are from 50 to 100 %"),
        ("--scene room --speed 99.95", "with one decimal"),
        ("--scene room -o table.txt", "must end in .csv or .parquet"),
        ("--scene room --plot", "--table"),
    ] {
        let error = folder.run(&format!("size-fifos {args}")).refused();
        assert!(error.contains(why), "{args}: {error}");
    }
}
