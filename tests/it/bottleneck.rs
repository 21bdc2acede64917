//! The sentence names what really limits the machine: making just that faster must make the whole faster.

use crate::support::command::Folder;

/// The bottleneck sentence and the cycles of a replay.
fn replay(trace: &str, flags: &str) -> (String, u64) {
    let folder = Folder::new();
    folder.file("a.ops", trace);
    folder.run(&format!("replay a.ops --stats s.json {flags}")).success();
    let stats: serde_json::Value = serde_json::from_str(&folder.read("s.json")).unwrap();
    (stats["bottleneck"].as_str().unwrap().to_owned(), stats["cycles"].as_u64().unwrap())
}

fn rays(count: u32, line: impl Fn(u32) -> String) -> String {
    (0..count).map(line).collect()
}

#[test]
fn a_slow_cell() {
    let trace = rays(50, |ray| format!("{ray} host w8\n{ray} 0 x8 g100 o1\n{ray} 1 x8 i1 n900 o5\n"));
    let (sentence, cycles) = replay(&trace, "");
    insta::assert_snapshot!(sentence);
    assert!(replay(&trace.replace("n900", "n450"), "").1 < cycles * 6 / 10);
}

#[test]
fn a_slow_link() {
    let trace = rays(50, |ray| format!("{ray} host w8\n{ray} 0 x8 g10 o9\n{ray} 1 x8 i9 n10 o5\n"));
    let (sentence, cycles) = replay(&trace, "--link-mb-s 8");
    insta::assert_snapshot!(sentence);
    assert!(replay(&trace, "--link-mb-s 16").1 < cycles * 6 / 10);
}

#[test]
fn a_slow_host() {
    let trace = rays(50, |ray| format!("{ray} host c5000 w8\n{ray} 0 x8 g1000 o5\n"));
    insta::assert_snapshot!(replay(&trace, "").0);
}

#[test]
fn shallow_fifos() {
    // Two cells that take turns at being slow, for longer than the FIFOs can bridge.
    let slow = |ray: u32, first: bool| if (ray / 40).is_multiple_of(2) == first { 900 } else { 60 };
    let trace = rays(400, |ray| {
        let (first, second) = (slow(ray, true), slow(ray, false));
        format!("{ray} host w8\n{ray} 0 x8 g{first} o5\n{ray} 1 x8 g{second} i5 o5\n")
    });
    let (sentence, cycles) = replay(&trace, "--fifo-words 32");
    insta::assert_snapshot!(sentence);
    assert!(replay(&trace, "--fifo-words 4096").1 < cycles * 8 / 10);
}

/// Z's FIFOs block as all others do: cell 1 cannot begin its work before cell 0 has taken the words that go back to it.
#[test]
fn shallow_fifos_of_words_to_the_left() {
    let trace =
        rays(40, |ray| format!("{ray} host a{} w8\n{ray} 0 x8 g350 b9 o1\n{ray} 1 x8 z9 n300 i1 o5\n", ray.max(1) - 1));
    let trace = trace.replacen("a0 ", "", 1);
    let (sentence, cycles) = replay(&trace, "--z-fifo-words 4");
    assert!(sentence.contains("but cell 1 stands blocked for "), "{sentence}");
    assert!(sentence.contains(" as Z0 is full, which cell 0 reads: deeper FIFOs, "), "{sentence}");
    let (deep, fewer) = replay(&trace, "--z-fifo-words 16");
    assert!(!deep.contains("is full"), "{deep}");
    assert!(fewer < cycles * 7 / 10, "{fewer} against {cycles}");
}

#[test]
fn uneven_work() {
    let trace =
        rays(40, |ray| format!("{ray} host a{} w8\n{ray} 0 x8 g300 o1\n{ray} 1 x8 i1 n300 o5\n", ray.max(1) - 1));
    let trace = trace.replacen("a0 ", "", 1);
    insta::assert_snapshot!(replay(&trace, "").0);
}

/// Words that nobody reads hold nobody up, however long they take on their way.
#[test]
fn words_that_nobody_reads() {
    for (trace, rate) in
        [("0 host w20\n0 0 o5\n", 80), ("0 host w8\n0 0 o5\n", 80), ("0 host w8\n0 0 x8 o100\n0 1 x8 g300 o5\n", 8)]
    {
        let at = |rate: u32| replay(trace, &format!("--link-mb-s {rate}"));
        let (sentence, cycles) = at(rate);
        assert!(!sentence.contains("link"), "{sentence}");
        assert!(at(2 * rate).1 > cycles * 7 / 10, "{sentence}");
    }
}

/// There is nobody else to speak of.
#[test]
fn a_single_cell() {
    let waits = rays(20, |ray| format!("{ray} host c600 w8\n{ray} 0 x8 g500 o5\n"));
    let told = ["0 host w20\n0 0 o5\n", "0 host c10 w8\n0 0 o5\n", &waits].map(|trace| replay(trace, "").0);
    insta::assert_snapshot!(told.join("\n"));
    assert!(told.iter().all(|sentence| !sentence.contains("cells") && !sentence.contains("busiest")), "{told:?}");
}

/// On Z the one that a cell waits for is on the other side: words come from the right, and room from the left.
#[test]
fn neighbours_that_wait_on_z() {
    let full = rays(12, |ray| {
        format!("{ray} host w8\n{ray} 0 x8 g700 b12 o1\n{ray} 1 x8 z12 g30 i1 o1\n{ray} 2 x8 i1 g30 o5\n")
    });
    let empty = rays(12, |ray| {
        format!("{ray} host w8\n{ray} 0 x8 g20 b12 o1\n{ray} 1 x8 g20 b12 z12 i1 o1\n{ray} 2 x8 z12 g600 i1 o5\n")
    });
    let told = [full, empty].map(|trace| replay(&trace, "--z-fifo-words 4").0);
    insta::assert_snapshot!(told.join("\n"));
}
