//! Writes polygons as PLY, for other programs to look at.

use std::io::{self, Write};

use crate::scene::mesh::Mesh;

/// Writes a mesh's points and faces as a PLY text file. Each number has as many digits as its 32 bits need, so that they are
/// read back to the bit.
pub fn write(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "ply\nformat ascii 1.0\nelement vertex {}", mesh.points.len())?;
    writeln!(out, "property float x\nproperty float y\nproperty float z")?;
    writeln!(out, "element face {}\nproperty list int int vertex_indices\nend_header", mesh.faces().len())?;
    for point in &mesh.points {
        writeln!(out, "{} {} {}", point.x, point.y, point.z)?;
    }
    for face in mesh.faces() {
        let corners = mesh.corners(face);
        write!(out, "{}", corners.len())?;
        corners.iter().try_for_each(|corner| write!(out, " {}", corner.point))?;
        writeln!(out)?;
    }
    Ok(())
}
