//! Bad usage and bad files: one clear error each, exit status 2, nothing written.

use crate::support::command::Folder;

/// Runs in a folder that holds one file, and expects to be refused.
#[track_caller]
fn refused(file: &str, content: &str, args: &str) -> String {
    let folder = Folder::new();
    folder.file(file, content);
    folder.file("rays_ok.csv", "ox,oy,oz,dx,dy,dz\n0,0,0,0,0,1\n");
    let error = folder.run(args).refused();
    assert_eq!(folder.names().len(), 2, "nothing is written");
    error
}

macro_rules! refusals {
    ($($name:ident: $file:literal, $content:expr, $args:literal;)*) => {
        $(#[test]
        fn $name() {
            insta::assert_snapshot!(refused($file, $content, $args));
        })*
    };
}

const MACHINE: &str = include_str!("../../pcs-programs/pcs.ron");
const PROGRAM: &str = include_str!("../../pcs-programs/hybrid.ron");

refusals! {
    machine_unknown_field: "m.ron", &MACHINE.replace("fifo_words", "fifo_wrods"), "--machine m.ron --scene room";
    machine_wrong_type: "m.ron", &MACHINE.replace("512", "\"many\""), "--machine m.ron --scene room";
    machine_missing_field: "m.ron", &MACHINE.replace("word_bytes: 4,", ""), "--machine m.ron --scene room";
    machine_truncated: "m.ron", &MACHINE[..MACHINE.len() - 40], "--machine m.ron --scene room";
    machine_zero_words: "m.ron", &MACHINE.replace("512", "0"), "--machine m.ron --scene room";
    machine_not_a_number: "m.ron", &MACHINE.replace("clock_ns: 50.0,\n\n", "clock_ns: NaN,\n\n"), "--machine m.ron --scene room";
    machine_infinite_time: "m.ron", &MACHINE.replace("7.8", "inf"), "--machine m.ron --scene room";
    machine_field_behind_one_that_ends_like_it: "m.ron", &MACHINE.replace("  multiply: 8,", "").replace("float_multiply: 4,", "float_multiply: 4, multiply: 99999,"), "--machine m.ron --scene room";
    machine_float_latency_out_of_range: "m.ron", &MACHINE.replace("float_add: 2,", "float_add: 2, float_latency: 10001,"), "--machine m.ron --scene room";
    machine_float_latency_below_zero: "m.ron", &MACHINE.replace("float_add: 2,", "float_add: 2,\n        float_latency: -1,"), "--machine m.ron --scene room";
    machine_mistyped_float_latency: "m.ron", &MACHINE.replace("float_add: 2,", "float_add: 2, float_latancy: 28,"), "--machine m.ron --scene room";
    machine_missing_file: "x", "", "--machine nowhere.ron --scene room";
    program_unknown_kernel: "p.ron", &PROGRAM.replace("slabs", "slab"), "--program p.ron --scene room";
    program_wrong_order: "p.ron", &PROGRAM.replace("grid, slabs", "slabs, grid"), "--program p.ron --scene room";
    program_no_groups: "p.ron", &PROGRAM.replace("groups: 4", "groups: 0"), "--program p.ron --scene room";
    program_bad_coefficient: "p.ron", &PROGRAM.replace("50.0", "-1.0"), "--program p.ron --scene room";
    flag_zero_words: "x", "", "--fifo-words 0 --scene room";
    flag_zero_cells: "x", "", "--mode broadcast --cells 0 --scene room";
    flag_cells_of_a_hybrid: "x", "", "--mode hybrid --cells 5 --scene room";
    flag_pipeline_of_six_cells: "x", "", "--mode pipeline --cells 6 --scene room";
    flag_too_many_cells: "x", "", "--mode broadcast --cells 5000 --scene reference";
    flag_more_groups_than_polygons: "x", "", "--mode broadcast --cells 64 --scene room";
    flag_memory_too_small: "x", "", "--mode pipeline --scene room --memory-words 1000";
    flag_grid_too_large: "x", "", "--scene reference --grid-coefficient 100000 --size 2x2";
    flag_mistyped_scene: "x", "", "--scene teapto";
    flag_size_factor_out_of_range: "x", "", "--scene tetra --size-factor 40";
    flag_bad_size: "x", "", "--size 12 --scene room";
    flag_zero_threads: "x", "", "--threads 0 --scene room";
    rays_wrong_header: "r.csv", "x,y,z,dx,dy,dz\n0,0,0,0,0,1\n", "--rays r.csv --scene room";
    rays_too_few_numbers: "r.csv", "ox,oy,oz,dx,dy,dz\n0,0,0,0,0,1\n0,0,0\n", "--rays r.csv --scene room";
    rays_not_a_number: "r.csv", "ox,oy,oz,dx,dy,dz\n0,0, zero,0,0,1\n", "--rays r.csv --scene room";
    rays_nan: "r.csv", "ox,oy,oz,dx,dy,dz\n0,NaN,0,0,0,1\n", "--rays r.csv --scene room";
    rays_infinite: "r.csv", "ox,oy,oz,dx,dy,dz\n0,0,0,0,inf,1\n", "--rays r.csv --scene room";
    rays_no_direction: "r.csv", "ox,oy,oz,dx,dy,dz\n0,0,0,0,0,0\n", "--rays r.csv --scene room";
    rays_none: "r.csv", "ox,oy,oz,dx,dy,dz\n", "--rays r.csv --scene room";
    scene_without_faces: "s.obj", "v 0 0 0\n", "--scene s.obj";
    scene_missing_vertex: "s.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "--scene s.obj";
    scene_missing_file: "x", "", "--scene nowhere.ply";
    trace_not_a_trace: "a.ops", "once upon a time\n", "replay a.ops";
    trace_unknown_op: "a.ops", "0 host w8\n0 0 x8 q600 o5\n", "replay a.ops";
    trace_host_op: "a.ops", "0 host x8\n0 0 x8 o5\n", "replay a.ops";
    trace_no_count: "a.ops", "0 host w8\n0 0 x8 g o5\n", "replay a.ops";
    trace_negative_count: "a.ops", "0 host w8\n0 0 x8 g-5 o5\n", "replay a.ops";
    trace_huge_count: "a.ops", "0 host w8\n0 0 x8 g99999999999999999999 o5\n", "replay a.ops";
    trace_huge_cell: "a.ops", "0 host w8\n0 99999 x8 o5\n", "replay a.ops";
    trace_awaits_unsent_ray: "a.ops", "0 host w8 a9\n0 0 x8 o5\n", "replay a.ops";
    trace_without_host: "a.ops", "0 0 x8 o5\n", "replay a.ops";
    trace_ray_sent_twice: "a.ops", "0 host w8\n0 host w8\n0 0 x8 o5\n", "replay a.ops";
    output_unwritable: "x", "", "--scene room --size 4x4 --stats nowhere/s.json";
    output_is_a_folder: "x", "", "--scene room --size 4x4 --stats .";
    output_named_twice: "x", "", "--scene room --size 4x4 --stats s.out --hits s.out";
    output_named_twice_in_two_ways: "x", "", "--scene room --size 4x4 --stats s.out --hits ./s.out";
    output_is_an_input: "m.ron", MACHINE, "--scene room --size 4x4 --machine m.ron --stats ./m.ron --force";
    machine_link_too_slow: "m.ron", &MACHINE.replace("80.0", "1e-13"), "--machine m.ron --scene room";
    trace_last_cell_writes_x: "a.ops", "0 host w8\n0 0 x8 w8 o5\n", "replay a.ops";
    trace_endless_line: "a.ops", &"0 ".repeat(9_000_000), "replay a.ops";
    flag_pipeline_program_of_three_groups: "x", "", "--program pipeline --groups 3 --scene room";
    unread_partition_of_one_group: "x", "", "--scene room --partition work";
    unread_size_of_a_ray_file: "x", "", "--scene room --rays rays_ok.csv --size 4x4";
    unread_resolution_of_a_builtin: "x", "", "--scene room --resolution 8";
    unread_resolution_of_a_file: "s.obj", "v 0 0 0\n", "--scene s.obj --resolution 8";
    unread_host_time_of_primary_rays: "x", "", "--scene room --host-hit-us 5";
    unread_slabs_time: "p.ron", &PROGRAM.replace("slabs", "").replace("[grid, ]", "[grid]"), "--scene room --program p.ron --slabs-start 5";
    unread_adaptive: "x", "", "image room -o i.png --adaptive";
    unread_policy: "x", "", "image room -o i.png --timing off --policy primaries";
    unread_fifos: "x", "", "image room -o i.png --timing off --fifo-words 4";
    unread_stats: "x", "", "image room -o i.png --timing off --stats s.json";
    unread_kernel_time_of_a_replay: "a.ops", "0 host w8\n0 0 x8 o5\n", "replay a.ops --grid-start 3";
    unread_memory_of_a_replay: "a.ops", "0 host w8\n0 0 x8 o5\n", "replay a.ops --memory-words 3";
    trace_first_cell_writes_z: "a.ops", "0 host w8\n0 0 x8 z1 o5\n", "replay a.ops";
    trace_last_cell_reads_z: "a.ops", "0 host w8\n0 0 x8 o1\n0 1 x8 i1 b1 o5\n", "replay a.ops";
    program_stop_words_of_0: "p.ron", &PROGRAM.replace("stop_words: None", "stop_words: Some(0)"), "--program p.ron --scene room";
    flag_stop_words_to_itself: "x", "", "--mode broadcast --stop-words 4 --scene room";
    flag_stop_words_need_deeper_fifos: "x", "", "--mode pipeline --stop-words 64 --fifo-words 31 --scene room";
    flag_bounded_walk_of_one_group: "x", "", "--mode pipeline --bounded-walk --scene room";
    flag_numbering_of_one_group: "x", "", "--mode broadcast --cells 1 --numbering front --scene room";
    flag_unknown_numbering: "x", "", "--mode broadcast --numbering back --scene room";
    image_of_rays_ahead: "x", "", "image room -o i.png --size 4x4 --mode broadcast --cells 2 --forward-ahead 2";
    image_of_a_ray_file: "x", "", "--scene room --rays rays_ok.csv --image i.png";
}
