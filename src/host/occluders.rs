//! Rule A4b: a point outside the cone of shadow around an object's box is not shaded by it.
//!
//! The cone's tip is the light, its axis leads to the box's centre, its angle is that to the box's farthest corner: below 90 degrees it is
//! convex, and holds the box as it holds its corners. Of a light that shines from one direction it is a cylinder. An object that is
//! farther from the light than the point does not shade it either.
//!
//! So that no rounding can break this, boxes hold all that A.3 could find on their polygons ([`reached`]), and of a point light they are
//! larger by as much as a ray may miss the light by, which is looked at ray by ray.

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};

use crate::geometry::partition::reached;
use crate::geometry::{Bounds, Hit, Polygons, Ray};
use crate::scene::{Light, LightFrom, Mesh};

/// The objects of a scene, as its lights see them.
#[derive(Clone, Debug)]
pub struct Occluders {
    lights: Vec<Shadows>,
}

/// What was told of a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Told {
    /// Its hit, if anything is known of that.
    pub foretold: Option<Hit>,
    /// How many objects, or polygons, were looked at.
    pub tests: u32,
}

#[derive(Clone, Debug)]
enum Shadows {
    Point { at: DVec3, slack: f64, cones: Vec<Cone> },
    Direction { towards: Vec3, cylinders: Vec<Cylinder> },
}

/// The cone of shadow of an object.
#[derive(Clone, Debug)]
struct Cone {
    /// From the light to the middle of the box, of unit length.
    axis: DVec3,
    /// The cosine of its angle, less what keeps rounding away; `None` if it is no cone that holds the box.
    cosine: Option<f64>,
    /// How near the box comes to the light.
    near: f64,
    /// Its polygon, if it has just one.
    single: Option<u32>,
}

/// The same of a light from one direction.
#[derive(Clone, Debug)]
struct Cylinder {
    /// A point of its axis.
    center: DVec3,
    radius: f64,
    /// How far the box reaches towards the light.
    far: f64,
    single: Option<u32>,
}

/// By how much cosines are taken to be smaller.
const COSINE_MARGIN: f64 = 1e-6;

/// By how much a ray may miss its light, as a share of the scene's size as the light sees it. 32 bits miss by some 2e-7.
const MISS: f64 = 1e-6;

/// What double precision may put lengths off by, as a share of them.
const ROUNDING: f64 = 1e-9;

impl Occluders {
    /// The objects of a mesh, the largest before the others for each light.
    pub fn new(mesh: &Mesh, polygons: &Polygons, lights: &[Light]) -> Occluders {
        let mut members: BTreeMap<u64, Vec<u32>> = BTreeMap::new();
        for (polygon, face) in (0..).zip(mesh.faces()) {
            members.entry(mesh.object(face).number()).or_default().push(polygon);
        }
        let boxes: Vec<(Bounds, Option<u32>)> = members
            .values()
            .map(|members| (reached(polygons, members), (members.len() == 1).then_some(members[0])))
            .filter(|(bounds, _)| !bounds.is_empty())
            .collect();
        Occluders { lights: lights.iter().map(|light| Shadows::new(&boxes, light)).collect() }
    }

    /// Tells that a ray to a light meets no object, if none may stand in its way.
    pub fn look(&self, polygons: &Polygons, ray: &Ray, light: u32) -> Told {
        let mut tests = 0;
        let mut counting = |may_meet: bool| {
            tests += 1;
            may_meet
        };
        // It cannot hit a polygon that it starts on, for which A.3's own arithmetic is asked.
        let misses = |single: Option<u32>| single.is_some_and(|polygon| polygons.surely_misses(ray, polygon));
        let origin = ray.origin.as_dvec3();
        let may_meet = match &self.lights[light as usize] {
            _ if polygons.beyond_margin(ray.origin) > 0.0 => true,
            Shadows::Point { at, slack, cones } => {
                let end = origin + ray.direction.as_dvec3() * f64::from(ray.t_max);
                let away = origin - *at;
                let goes_there = end.distance(*at) <= *slack;
                !goes_there || cones.iter().any(|cone| counting(cone.may_shade(away)) && !misses(cone.single))
            }
            Shadows::Direction { towards, cylinders } => {
                let goes_there = ray.direction == *towards;
                let axis = towards.as_dvec3().normalize_or_zero();
                let may_shade = |cylinder: &Cylinder| cylinder.may_shade(origin, axis);
                !goes_there || cylinders.iter().any(|one| counting(may_shade(one)) && !misses(one.single))
            }
        };
        Told { foretold: (!may_meet).then_some(Hit::MISS), tests }
    }
}

impl Shadows {
    fn new(boxes: &[(Bounds, Option<u32>)], light: &Light) -> Shadows {
        match light.from {
            LightFrom::Point(at) => {
                let at = at.as_dvec3();
                let all = boxes.iter().map(|(bounds, _)| *bounds).fold(Bounds::EMPTY, Bounds::union);
                let slack = MISS * corners(&all).map(|corner| corner.distance(at)).fold(0.0, f64::max);
                let cone = |(bounds, single): &(Bounds, Option<u32>)| Cone::new(at, &bounds.grown(slack), *single);
                let mut cones: Vec<Cone> = boxes.iter().map(cone).collect();
                cones.sort_by(|a, b| a.cosine.unwrap_or(-1.0).total_cmp(&b.cosine.unwrap_or(-1.0)));
                Shadows::Point { at, slack, cones }
            }
            LightFrom::Direction(towards) => {
                // As shadow rays have it.
                let towards = towards.as_dvec3().normalize_or_zero().as_vec3();
                let axis = towards.as_dvec3().normalize_or_zero();
                let cylinder = |(bounds, single): &(Bounds, Option<u32>)| Cylinder::new(axis, bounds, *single);
                let mut cylinders: Vec<Cylinder> = boxes.iter().map(cylinder).collect();
                cylinders.sort_by(|a, b| b.radius.total_cmp(&a.radius));
                Shadows::Direction { towards, cylinders }
            }
        }
    }
}

impl Cone {
    fn new(light: DVec3, bounds: &Bounds, single: Option<u32>) -> Cone {
        let axis = ((bounds.low + bounds.high) / 2.0 - light).normalize_or_zero();
        let cosine = corners(bounds).map(|corner| (corner - light).normalize_or_zero().dot(axis)).fold(1.0, f64::min);
        let near = light.clamp(bounds.low, bounds.high).distance(light);
        let cosine = (cosine > 0.0 && near > 0.0).then_some(cosine - COSINE_MARGIN);
        Cone { axis, cosine, near, single }
    }

    /// Whether the object may shade the point that lies there, as seen from the light.
    fn may_shade(&self, away: DVec3) -> bool {
        let distance = away.length();
        let is_inside = self.cosine.is_none_or(|cosine| away.dot(self.axis) >= cosine * distance);
        is_inside && self.near <= distance * (1.0 + ROUNDING)
    }
}

impl Cylinder {
    fn new(axis: DVec3, bounds: &Bounds, single: Option<u32>) -> Cylinder {
        let center = (bounds.low + bounds.high) / 2.0;
        let radius = corners(bounds).map(|corner| off(axis, corner - center)).fold(0.0, f64::max);
        let far = corners(bounds).map(|corner| corner.dot(axis)).fold(f64::NEG_INFINITY, f64::max);
        Cylinder { center, radius, far, single }
    }

    fn may_shade(&self, at: DVec3, axis: DVec3) -> bool {
        let margin = ROUNDING * (at.length() + self.center.length() + self.radius);
        off(axis, at - self.center) <= self.radius + margin && at.dot(axis) <= self.far + margin
    }
}

/// How far a point is off an axis through the origin.
fn off(axis: DVec3, at: DVec3) -> f64 {
    (at - axis * at.dot(axis)).length()
}

fn corners(bounds: &Bounds) -> impl Iterator<Item = DVec3> + use<> {
    let ends = [bounds.low, bounds.high];
    (0..8).map(move |corner: usize| DVec3::new(ends[corner & 1].x, ends[corner >> 1 & 1].y, ends[corner >> 2].z))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box(at: DVec3) -> Bounds {
        Bounds { low: at, high: at + 1.0 }
    }

    #[test]
    fn what_is_beside_or_before_a_box_is_not_shaded_and_what_is_behind_may_be() {
        let cone = Cone::new(DVec3::ZERO, &unit_box(DVec3::new(-0.5, -0.5, 2.0)), None);
        assert!(cone.may_shade(DVec3::new(0.0, 0.0, 5.0)));
        assert!(!cone.may_shade(DVec3::new(0.0, 0.0, 1.9)), "it is before the box");
        // The farthest corner seen from the light is a near one, at 0.5, 0.5, 2.
        let edge = (0.5f64.hypot(0.5)).atan2(2.0);
        let at = |angle: f64| DVec3::new(angle.sin(), 0.0, angle.cos()) * 9.0;
        assert!(cone.may_shade(at(edge)) && !cone.may_shade(at(edge + 1e-4)));
        assert!(!cone.may_shade(DVec3::new(0.0, 0.0, -5.0)));
    }

    /// A4b, counter-example: where the angle is 90 degrees or more, what is outside the "cone" may well be shaded. The light is near
    /// the edge of a box, and over it.
    #[test]
    fn a_light_near_a_box_has_no_cone_that_holds_it() {
        let bounds = Bounds { low: DVec3::new(-4.0, -4.0, -1.0), high: DVec3::new(4.0, 4.0, 0.0) };
        let light = DVec3::new(3.9, 0.0, 0.01);
        let axis = ((bounds.low + bounds.high) / 2.0 - light).normalize();
        let angle = corners(&bounds).map(|corner| (corner - light).angle_between(axis)).fold(0.0, f64::max);
        // A point farther out, from which the light is seen through the box.
        let point = light + DVec3::new(3.0, 0.0, -0.33);
        let on_the_way = light + (point - light) * 0.031;
        assert!(bounds.low.cmple(on_the_way).all() && on_the_way.cmple(bounds.high).all());
        assert!(
            angle > 90f64.to_radians() && (point - light).angle_between(axis) > angle,
            "the rule would spare the ray"
        );
        let cone = Cone::new(light, &bounds, None);
        assert!(cone.cosine.is_none() && cone.may_shade(point - light));
        // With the light inside the box, all that is outside is behind the box.
        let inside = Cone::new(DVec3::new(0.0, 0.0, -0.5), &bounds, None);
        assert_eq!((inside.cosine, inside.near), (None, 0.0));
        assert!(inside.may_shade(DVec3::new(0.0, 0.0, 9.0)) && inside.may_shade(DVec3::new(9.0, 0.0, 0.0)));
    }

    #[test]
    fn a_cylinder_shades_what_is_behind_its_box_alone() {
        let axis = DVec3::Z;
        let cylinder = Cylinder::new(axis, &unit_box(DVec3::new(-0.5, -0.5, 2.0)), None);
        let radius = 0.5f64.hypot(0.5);
        assert!(cylinder.may_shade(DVec3::ZERO, axis));
        assert!(cylinder.may_shade(DVec3::new(radius, 0.0, 0.0), axis));
        assert!(!cylinder.may_shade(DVec3::new(radius + 1e-6, 0.0, 0.0), axis));
        assert!(!cylinder.may_shade(DVec3::new(0.0, 0.0, 3.1), axis), "the box is not towards the light");
    }
}
