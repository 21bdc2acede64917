//! `pcs-sim scenes`: what can be traced without a file.

use pcs_sim::report::summary::{WIDTH, aligned, grouped, table, wrapped};
use pcs_sim::scene::builtin;

use super::{Failure, print};

/// Columns of a scene's name.
const NAME: usize = 11;

/// Lists the built-in scenes with their sizes.
pub fn scenes() -> Result<(), Failure> {
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
