//! Runs that can never end are told apart, and say who waits for whom.

use crate::support::command::Folder;

fn replay(trace: &str, flags: &str) -> crate::support::command::Finished {
    let folder = Folder::new();
    folder.file("a.ops", trace);
    let finished = folder.run(&format!("replay a.ops --stats s.json {flags}"));
    if finished.status != 0 {
        assert_eq!(folder.names(), ["a.ops"], "nothing half-written is left");
    }
    finished
}

/// Cell 0 sends more candidates than the FIFO holds before the ray that cell 1 waits for.
const LOOP: &str = "0 host w8\n0 0 r8 o600 w8\n0 1 r8 i600 o5\n";

#[test]
fn two_cells_wait_for_each_other() {
    insta::assert_snapshot!(replay(LOOP, "").failed());
}

#[test]
fn deeper_fifos_break_the_loop() {
    replay(LOOP, "--fifo-words 600").success();
}

/// Cell 0 wants to hear from cell 1 of a word that it has not sent yet.
#[test]
fn two_cells_wait_for_each_others_words() {
    insta::assert_snapshot!(replay("0 host w8\n0 0 x8 b1 o1\n0 1 x8 i1 z1 o5\n", "").failed());
}

/// More words go to the left than anybody reads, and the FIFO cannot hold the rest.
#[test]
fn words_to_the_left_find_no_room() {
    insta::assert_snapshot!(replay("0 host w8\n0 0 x8 b2 o1\n0 1 x8 z9 i1 o5\n", "--fifo-words 4").failed());
}

#[test]
fn the_host_waits_for_a_hit_that_waits_for_the_host() {
    insta::assert_snapshot!(replay("0 host a1 w8\n1 host w8\n0 0 x8 o5\n1 0 x8 o5\n", "").failed());
}

#[test]
fn a_cell_starves_when_its_neighbour_is_done() {
    insta::assert_snapshot!(replay("0 host w8\n0 0 x8 g20 o2\n0 1 x8 i3 o5\n", "").failed());
}

#[test]
fn the_host_writes_too_few_rays() {
    insta::assert_snapshot!(replay("4 host w8\n4 0 x8 o5\n5 0 x8 o5\n", "").failed());
}

#[test]
fn a_loop_through_many_cells_names_only_the_loop() {
    let mut trace = String::from("0 host w8\n");
    trace.push_str("0 0 x8 o1\n0 1 r8 i1 o9 w8\n0 2 r8 i9 w8 o1\n0 3 r8 i1 o5\n");
    insta::assert_snapshot!(replay(&trace, "--fifo-words 8").failed());
}

/// Ops that take more cycles than 64 bits can count come to no end, rather than to one that is too early.
#[test]
fn time_does_not_begin_again() {
    let units = "unit gv grid_voxel grid 1000000000\nunit ss slabs_start slabs 1000000000\n";
    let work = "gv33554431 ss1 ".repeat(600);
    let trace = format!("pcs-sim trace 2 cells 1 answer 5\n{units}0 host w8\n0 0 x8 {work}o5\n");
    let error = replay(&trace, "").failed();
    assert!(error.contains("cell 0") && error.contains("op 1099 of ray 0"), "{error}");
}
