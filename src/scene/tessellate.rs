//! Spheres, cones and cylinders cut into convex polygons with smooth normals.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

use super::mesh::{Corner, Mesh};

/// Adds a sphere, as an object, of `slices` (at least 3) slices from pole to pole and half as many stacks (at least 2), its poles on
/// the z axis: quadrangles, and triangles at the poles.
///
/// Seen from outside the corners run counter-clockwise. A negative radius turns the sphere inside out: order and
/// normals are those of a hollow seen from inside. A radius of 0 adds nothing.
pub fn sphere(mesh: &mut Mesh, center: Vec3, radius: f32, slices: u32, material: u32) {
    if radius == 0.0 {
        return;
    }
    mesh.begin_object();
    let slices = slices.max(3);
    let stacks = (slices / 2).max(2);
    let rings: Vec<Vec<Corner>> =
        (0..=stacks).map(|stack| sphere_ring(mesh, center, radius, stack, stacks, slices)).collect();
    for pair in rings.windows(2) {
        add_band(mesh, &pair[0], &pair[1], radius < 0.0, material);
    }
}

/// Adds the curved side of a truncated cone, as an object, with `slices` (at least 3) quadrangles, or triangles where a radius is 0;
/// its ends stay open. Equal radii make a cylinder.
///
/// Seen from outside the corners run counter-clockwise. Negative radii turn it inside out, as they do a
/// [`sphere`]; both radii are to have the same sign. Coincident ends, or two radii of 0, add nothing.
pub fn cone(mesh: &mut Mesh, base: Vec3, base_radius: f32, apex: Vec3, apex_radius: f32, slices: u32, material: u32) {
    if base == apex || (base_radius == 0.0 && apex_radius == 0.0) {
        return;
    }
    mesh.begin_object();
    let slices = slices.max(3);
    let inside_out = base_radius + apex_radius < 0.0;
    let axis = apex.as_dvec3() - base.as_dvec3();
    let side = Side::new(axis, f64::from(base_radius.abs()) - f64::from(apex_radius.abs()), inside_out);
    let low = side.ring(mesh, base, base_radius.abs(), slices);
    let high = side.ring(mesh, apex, apex_radius.abs(), slices);
    add_band(mesh, &low, &high, inside_out, material);
}

/// One circle of latitude, from the south pole (stack 0) to the north pole: at a pole all corners are one point.
fn sphere_ring(mesh: &mut Mesh, center: Vec3, radius: f32, stack: u32, stacks: u32, slices: u32) -> Vec<Corner> {
    let latitude = PI * (f64::from(stack) / f64::from(stacks) - 0.5);
    let at_pole = stack == 0 || stack == stacks;
    let distinct = if at_pole { 1 } else { slices };
    let ring: Vec<Corner> = (0..distinct)
        .map(|slice| {
            let outward = direction(latitude, slice, slices, at_pole);
            let point = center.as_dvec3() + outward * f64::from(radius.abs());
            let normal = outward * f64::from(radius.signum());
            Corner { point: mesh.add_point(point.as_vec3()), normal: mesh.add_normal(normal.as_vec3()) }
        })
        .collect();
    ring.into_iter().cycle().take(slices as usize).collect()
}

/// The unit vector at a latitude; a pole is exact, so that its ring does not leave a pinhole.
fn direction(latitude: f64, slice: u32, slices: u32, at_pole: bool) -> DVec3 {
    if at_pole {
        return DVec3::Z * latitude.signum();
    }
    let (sin, cos) = (TAU * f64::from(slice) / f64::from(slices)).sin_cos();
    DVec3::new(latitude.cos() * cos, latitude.cos() * sin, latitude.sin())
}

/// The directions in which the side of a cone lies around its axis.
struct Side {
    right: DVec3,
    forward: DVec3,
    /// What is added to a radial unit vector to tilt it into the normal.
    tilt: DVec3,
    sign: f64,
}

impl Side {
    fn new(axis: DVec3, narrowing: f64, inside_out: bool) -> Self {
        let length = axis.length();
        let along = axis / length;
        let (right, forward) = along.any_orthonormal_pair();
        Side { right, forward, tilt: along * (narrowing / length), sign: if inside_out { -1.0 } else { 1.0 } }
    }

    /// The corners around one end. An end of radius 0 is a single point with a normal for every slice, that of the
    /// slice's middle.
    fn ring(&self, mesh: &mut Mesh, center: Vec3, radius: f32, slices: u32) -> Vec<Corner> {
        let tip = (radius == 0.0).then(|| mesh.add_point(center));
        (0..slices)
            .map(|slice| {
                let turn = if tip.is_some() { f64::from(slice) + 0.5 } else { f64::from(slice) };
                let radial = self.radial(turn / f64::from(slices));
                let point =
                    tip.unwrap_or_else(|| mesh.add_point((center.as_dvec3() + radial * f64::from(radius)).as_vec3()));
                let normal = (radial + self.tilt).normalize() * self.sign;
                Corner { point, normal: mesh.add_normal(normal.as_vec3()) }
            })
            .collect()
    }

    /// The unit vector away from the axis after a part of a full turn.
    fn radial(&self, turn: f64) -> DVec3 {
        let (sin, cos) = (TAU * turn).sin_cos();
        self.right * cos + self.forward * sin
    }
}

/// Joins two rings of corners with a face for every slice; a ring whose corners are all one point gives triangles.
fn add_band(mesh: &mut Mesh, low: &[Corner], high: &[Corner], inside_out: bool, material: u32) {
    for (slice, (&low_here, &high_here)) in low.iter().zip(high).enumerate() {
        let next = (slice + 1) % low.len();
        let mut face = vec![low_here];
        if low[next].point != low_here.point {
            face.push(low[next]);
        }
        if high[next].point != high_here.point {
            face.push(high[next]);
        }
        face.push(high_here);
        if inside_out {
            face.reverse();
        }
        mesh.add_smooth_face(&face, material);
    }
}
