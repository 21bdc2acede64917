#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    pcs_sim_fuzz::file("materials.mtl", data);
    pcs_sim_fuzz::scene("scene.obj", b"mtllib materials.mtl\nusemtl a\nv 0 0 0\nf 1 1 1\n");
});
