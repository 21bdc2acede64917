//! Closed meshes as leaves of solids.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use super::check::{self, Fault};
use super::shell::{Shell, ShellFace};
use crate::scene::mesh::{Face, Mesh, NO_NORMAL};
use crate::scene::split_concave;

impl Shell {
    /// A mesh as a closed shape, and whether it had to be turned over because it was inside out. Its materials and normals
    /// stay; each of its objects is a surface.
    ///
    /// Points at the same place are one. The error says at which edge the mesh is open, or crosses itself.
    pub fn of_mesh(mesh: Mesh) -> Result<(Shell, bool), String> {
        let (mesh, _) = split_concave(mesh);
        let mut shell = Shell::default();
        let mut places: HashMap<[u32; 3], u32> = HashMap::new();
        let mut surfaces = HashMap::new();
        for face in mesh.faces() {
            let next = surfaces.len() as u32;
            let surface = *surfaces.entry(mesh.part(face)).or_insert(next);
            shell.add_face(&mesh, face, surface, &mut places);
        }
        shell.faces.sort_by_key(|face| face.surface);
        check::closed(&shell).map_err(Fault::message)?;
        let (shell, turned) = shell.turn_outward();
        check::simple(&shell).map_err(Fault::message)?;
        Ok((shell, turned))
    }

    /// Adds a face of a mesh, in triangles unless it is quite flat; one that is a line or a point is left out.
    fn add_face(&mut self, mesh: &Mesh, face: &Face, surface: u32, places: &mut HashMap<[u32; 3], u32>) {
        let mut point = |point: Vec3| {
            // Zeros of either sign are one place.
            let point = point + Vec3::ZERO;
            *places.entry(point.to_array().map(f32::to_bits)).or_insert_with(|| {
                self.points.push(point.as_dvec3());
                (self.points.len() - 1) as u32
            })
        };
        let mut corners: Vec<(u32, DVec3)> = Vec::new();
        for corner in mesh.corners(face) {
            let normal = if corner.normal == NO_NORMAL { Vec3::ZERO } else { mesh.normals[corner.normal as usize] };
            let corner = (point(mesh.points[corner.point as usize]), normal.as_dvec3().normalize_or_zero());
            if corners.last().map(|last| last.0) != Some(corner.0) {
                corners.push(corner);
            }
        }
        while corners.len() > 1 && corners.first().map(|first| first.0) == corners.last().map(|last| last.0) {
            corners.pop();
        }
        let mut add = |corners: &[(u32, DVec3)]| {
            let smooth = corners.iter().all(|corner| corner.1 != DVec3::ZERO);
            let normals = if smooth { corners.iter().map(|corner| corner.1).collect() } else { Vec::new() };
            let corners = corners.iter().map(|corner| corner.0).collect();
            self.faces.push(ShellFace { corners, normals, surface, material: face.material });
        };
        match corners.as_slice() {
            [] | [_] | [_, _] => {}
            [first, rest @ ..] if !is_flat(mesh, face) => {
                rest.windows(2).for_each(|pair| add(&[*first, pair[0], pair[1]]));
            }
            whole => add(whole),
        }
    }
}

/// Whether a face's corners lie in one plane to the last digits.
fn is_flat(mesh: &Mesh, face: &Face) -> bool {
    let points: Vec<DVec3> = mesh.face_points(face).map(|point| point.as_dvec3()).collect();
    let ways = points.windows(2).map(|pair| (pair[0] - points[0]).cross(pair[1] - points[0]));
    let normal = ways.sum::<DVec3>().normalize_or_zero();
    let largest = points.iter().map(|point| (*point - points[0]).length()).fold(0.0, f64::max);
    points.iter().all(|&point| (point - points[0]).dot(normal).abs() <= 1e-12 * largest)
}
