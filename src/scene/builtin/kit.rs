//! What several scenes need: colours, lights, cameras, boxes.

use glam::{DAffine3, DQuat, DVec3, Vec3, dvec3};

use crate::scene::solid::{Options, Shell, Solid, evaluate};
use crate::scene::{Camera, Light, Material, Mesh, Scene, tessellate};

/// The blue that the databases paint behind most scenes.
pub const SKY: Vec3 = Vec3::new(0.078, 0.361, 0.753);

/// A camera from the databases' figures.
pub fn camera(from: DVec3, at: DVec3, up: DVec3, angle: f32) -> Camera {
    Camera { from: from.as_vec3(), at: at.as_vec3(), up: up.as_vec3(), angle }
}

/// White lights, together as strong as the neutral file format says: each the root of their number, divided by it.
pub fn lights<const N: usize>(places: [DVec3; N]) -> Vec<Light> {
    let strength = 1.0 / (N as f64).sqrt();
    places.map(|at| Light::point(at.as_vec3(), Vec3::splat(strength as f32))).to_vec()
}

/// A surface without highlights.
pub fn matt(color: Vec3, diffuse: f32) -> Material {
    Material { color, diffuse, ..Material::default() }
}

/// A mirroring surface whose highlight has sunk to half its strength `angle` degrees from its middle: so the databases
/// give it. Phong's exponent is the logarithm of one half over that of the angle's cosine.
pub fn shiny(color: Vec3, diffuse: f32, specular: f32, angle: f64) -> Material {
    let shine = 0.5f64.ln() / angle.to_radians().cos().ln();
    Material { color, diffuse, specular, shine: shine as f32, ..Material::default() }
}

/// A scene without notes.
pub fn scene(
    name: &str,
    mesh: Mesh,
    materials: Vec<Material>,
    lights: Vec<Light>,
    camera: Camera,
    background: Vec3,
) -> Scene {
    Scene { name: name.to_owned(), mesh, materials, lights, background, camera, notes: Vec::new(), solids: Vec::new() }
}

/// Adds a flat face over new points, as an object.
pub fn polygon(mesh: &mut Mesh, points: &[DVec3], material: u32) {
    mesh.begin_object();
    let points: Vec<u32> = points.iter().map(|point| mesh.add_point(point.as_vec3())).collect();
    mesh.add_face(&points, material);
}

/// Adds a square around the z axis, seen from above.
pub fn ground(mesh: &mut Mesh, half: f64, z: f64, material: u32) {
    let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
    polygon(mesh, &corners.map(|[x, y]| dvec3(x * half, y * half, z)), material);
}

/// Adds a sphere in double precision.
pub fn sphere(mesh: &mut Mesh, center: DVec3, radius: f64, slices: u32, material: u32) {
    tessellate::sphere(mesh, center.as_vec3(), radius as f32, slices, material);
}

/// Adds a cone between two ends, each a point and a radius, in double precision.
pub fn cone(mesh: &mut Mesh, base: (DVec3, f64), apex: (DVec3, f64), slices: u32, material: u32) {
    let (base, base_radius) = (base.0.as_vec3(), base.1 as f32);
    let (apex, apex_radius) = (apex.0.as_vec3(), apex.1 as f32);
    tessellate::cone(mesh, base, base_radius, apex, apex_radius, slices, material);
}

/// Adds the six sides of an axis-parallel box, as an object, seen from outside.
pub fn cuboid(mesh: &mut Mesh, low: DVec3, high: DVec3, material: u32) {
    // Corner number: bit 0 is x, bit 1 is y, bit 2 is z.
    const SIDES: [[usize; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [3, 2, 6, 7], [2, 0, 4, 6], [1, 3, 7, 5]];
    mesh.begin_object();
    let points: Vec<u32> = (0..8)
        .map(|corner| {
            let pick = |bit: u32, low: f64, high: f64| if corner >> bit & 1 == 0 { low } else { high };
            let point = dvec3(pick(0, low.x, high.x), pick(1, low.y, high.y), pick(2, low.z, high.z));
            mesh.add_point(point.as_vec3())
        })
        .collect();
    for side in SIDES {
        mesh.add_face(&side.map(|corner| points[corner]), material);
    }
}

/// A scene of polygons and solids, with what the solids came to.
pub fn scene_of_solids(
    name: &str,
    mut mesh: Mesh,
    solids: &[Solid],
    (materials, lights): (Vec<Material>, Vec<Light>),
    camera: Camera,
    background: Vec3,
) -> Scene {
    let mut reports = Vec::new();
    for solid in solids {
        let Ok(evaluated) = evaluate(solid, Options::default()) else { continue };
        mesh.append(evaluated.mesh, |own| own);
        reports.push(evaluated.report);
    }
    let notes = reports.iter().map(|report| format!("solid: {}", report.sentence())).collect();
    Scene { notes, solids: reports, ..scene(name, mesh, materials, lights, camera, background) }
}

/// An axis-parallel box, as a solid.
pub fn block(low: DVec3, high: DVec3, material: u32) -> Solid {
    let map = DAffine3::from_translation(low) * DAffine3::from_scale(high - low);
    Solid::leaf(Shell::cube().of_material(material)).placed(map)
}

/// A cylinder that begins at a point and goes `along`, as a solid.
pub fn rod(base: DVec3, along: DVec3, radius: f64, slices: u32, material: u32) -> Solid {
    round(Shell::cylinder(slices), base, along, dvec3(radius, radius, along.length()), material)
}

/// A ball, as a solid.
pub fn ball(center: DVec3, radius: f64, slices: u32, material: u32) -> Solid {
    round(Shell::sphere(slices), center, DVec3::Z, DVec3::splat(radius), material)
}

/// A shape in unit position scaled, its z axis then turned `along` a direction, and moved.
pub fn round(shell: Shell, base: DVec3, along: DVec3, scale: DVec3, material: u32) -> Solid {
    let turn = DQuat::from_rotation_arc(DVec3::Z, along.normalize());
    let map = DAffine3::from_scale_rotation_translation(scale, turn, base);
    Solid::leaf(shell.of_material(material)).placed(map)
}
