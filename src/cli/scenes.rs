//! `pcs-sim scenes`: what can be traced without a file, and what a scene has.

use std::path::Path;

use pcs_sim::error::InputError;
use pcs_sim::report::summary::{WIDTH, aligned, grouped, plural, table, wrapped};
use pcs_sim::run::load_scene;
use pcs_sim::scene::{builtin, write_ply};

use super::args::ScenesArgs;
use super::{Failure, note, outputs, print};

/// Columns of a scene's name.
const NAME: usize = 11;

/// Lists the built-in scenes with their sizes, or tells what one has, and exports it.
pub fn scenes(args: &ScenesArgs) -> Result<(), Failure> {
    match &args.scene {
        Some(scene) => one(scene, args),
        None => list(),
    }
}

fn one(name: &str, args: &ScenesArgs) -> Result<(), Failure> {
    let named = [args.export.as_ref()];
    outputs::check_distinct(&named, &[Some(Path::new(name))])?;
    let file = args.export.as_deref().map(|path| outputs::create(checked(path)?, args.force)).transpose()?;
    let scene = outputs::reading(&named, || load_scene(name, args.size_factor, args.resolution))?;
    scene.notes.iter().for_each(note);
    let (faces, points) = (scene.mesh.faces().len() as u64, scene.mesh.points.len() as u64);
    let (materials, lights) = (scene.materials.len(), scene.lights.len());
    print(&format!(
        "scene {}: {} over {}; materials: {materials}, lights: {lights}, solids: {}\n",
        scene.name,
        plural(faces, "polygon"),
        plural(points, "point"),
        scene.solids.len(),
    ))?;
    let mut written = Vec::new();
    outputs::finish(file, &mut written, |file| write_ply(&scene.mesh, file))?;
    print(&outputs::list(&written))
}

fn checked(path: &Path) -> Result<&Path, InputError> {
    match path.extension() {
        Some(extension) if extension.eq_ignore_ascii_case("ply") => Ok(path),
        _ => Err(InputError::in_file(path, "polygons are written as PLY")
            .help("give it a name that ends in .ply; -.ply is standard output")),
    }
}

fn list() -> Result<(), Failure> {
    let mut rows = table(&["scene", "size factor", "from - to", "primitives", "polygons", "slices"]);
    let mut about = String::new();
    for scene in builtin::all() {
        let size = scene.default_size;
        rows.add_row([
            scene.name.to_owned(),
            size.to_string(),
            format!("{} - {}", scene.size_range.start(), scene.size_range.end()),
            grouped(scene.primitives(size).total()),
            grouped(scene.faces(size, None)),
            scene.default_resolution.map_or("-".to_owned(), |slices| slices.to_string()),
        ]);
        let lines = wrapped(scene.about, WIDTH - NAME).replace('\n', &format!("\n{:NAME$}", ""));
        about.push_str(&format!("{:<NAME$}{lines}\n", scene.name));
    }
    print(&format!("{}\n{about}\nSpheres and cones are cut into as many slices as --resolution says.\n", aligned(rows)))
}
