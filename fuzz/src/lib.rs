//! What the targets share: the readers take files, so every input becomes one.

use std::path::PathBuf;

/// Writes an input into a folder of this process' own, in `TMPDIR`.
pub fn file(name: &str, contents: &[u8]) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("pcs-sim-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("the temporary folder can be written");
    let path = folder.join(name);
    std::fs::write(&path, contents).expect("the temporary folder can be written");
    path
}

/// Reads a scene, which keeps its promises or is refused with a message.
pub fn scene(name: &str, contents: &[u8]) {
    use pcs_sim::scene::{ReadOptions, load};
    match load(&file(name, contents), &ReadOptions { resolution: 3 }) {
        Ok(scene) => {
            let mesh = &scene.mesh;
            assert!(mesh.points.iter().chain(&mesh.normals).all(|point| point.is_finite()));
            assert!(mesh.faces().iter().all(|face| mesh.corners(face).len() >= 3));
        }
        Err(error) => assert!(!error.message.is_empty()),
    }
}
