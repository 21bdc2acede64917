//! Whitted's model of light with Phong's highlights: what a hit adds to its pixel, and which rays it asks for.
//!
//! Light adds up along the tree of rays, so every ray carries its `weight`: the share of the light it finds that reaches
//! the pixel. A hit under weight w on a surface of colour C with shares k_d, k_s and k_t adds
//!
//! - w C k_d [`AMBIENT`], at once;
//! - for each light of colour L, w L (C k_d (1 - [`AMBIENT`]) N.l + k_s (R.l)^n), if the shadow ray gets to the light;
//! - w k_s of what the reflected ray finds, and w k_t C of what the refracted one does. Where there is total internal
//!   reflection, the reflected ray takes the share of both.
//!
//! A blocker that lets light through filters it by k_t C, without bending it, and the shadow ray goes on behind it.

use glam::DVec3;

use super::occluders::{Occluders, Told};
use super::rules::Rules;
use super::shades::Shades;
use super::surface::Surface;
use crate::geometry::{Hit, Polygons, Ray};
use crate::scene::{Light, LightFrom, Scene};

/// Share of a surface's own colour that it shows where no light falls on it.
pub const AMBIENT: f64 = 0.15;

/// What a ray is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RayKind {
    /// From the eye through a pixel.
    Primary,
    /// From a hit to a light.
    Shadow,
    /// From a hit, as from a mirror.
    Reflected,
    /// From a hit, through the surface.
    Refracted,
}

impl RayKind {
    /// All kinds, in the order in which reports name them.
    pub const ALL: [RayKind; 4] = [RayKind::Primary, RayKind::Shadow, RayKind::Reflected, RayKind::Refracted];

    /// Its name in reports.
    pub fn name(self) -> &'static str {
        match self {
            RayKind::Primary => "primary",
            RayKind::Shadow => "shadow",
            RayKind::Reflected => "reflected",
            RayKind::Refracted => "refracted",
        }
    }
}

/// Where a tree of rays ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// How often light may be reflected or refracted on its way.
    pub depth: u8,
    /// A ray whose weight is smaller in all colours is not sent (but for shadow rays that have met no blocker yet).
    pub contribution: f64,
}

impl Default for Limits {
    /// Five times, down to less than one step of 8 bits.
    fn default() -> Self {
        Limits { depth: 5, contribution: 1.0 / 256.0 }
    }
}

/// A ray of a tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch {
    /// The ray.
    pub ray: Ray,
    /// What it is for.
    pub kind: RayKind,
    /// Its distance from the root, which has 0.
    pub generation: u8,
    /// For a shadow ray, the number of the light that it goes to.
    pub light: u32,
    /// The share of the light it finds that reaches the pixel; for a shadow ray, what it adds if it meets nothing.
    pub weight: DVec3,
    /// The polygon that it starts on, if a rule says that it does not hit it.
    pub own: Option<u32>,
    /// What a rule says of its hit, so that it is not sent: that there is none, or one of a shadow ray that need not be the first.
    pub foretold: Option<Hit>,
    /// How many objects a rule looked at for it, and how many polygons.
    pub rule_tests: [u32; 2],
}

impl Branch {
    /// The root of a tree.
    pub fn primary(ray: Ray) -> Branch {
        let (kind, weight) = (RayKind::Primary, DVec3::ONE);
        Branch { ray, kind, generation: 0, light: 0, weight, own: None, foretold: None, rule_tests: [0; 2] }
    }

    fn next(&self, kind: RayKind, origin: DVec3, direction: DVec3, weight: DVec3) -> Branch {
        let ray = Ray::new(origin.as_vec3(), direction.as_vec3());
        let generation = self.generation.saturating_add(1);
        Branch { ray, kind, generation, light: self.light, weight, own: None, foretold: None, rule_tests: [0; 2] }
    }
}

/// Shades the hits of a scene.
#[derive(Clone, Debug)]
pub struct Shader<'a> {
    scene: &'a Scene,
    polygons: &'a Polygons,
    lights: Vec<Light>,
    limits: Limits,
    rules: Rules,
    /// What may shade anything, if a rule asks for that.
    occluders: Option<Occluders>,
    /// What shades for certain, if a rule asks for that.
    shades: Option<Shades>,
}

impl<'a> Shader<'a> {
    /// A shader; of a scene without lights, the eye carries one.
    pub fn new(scene: &'a Scene, polygons: &'a Polygons, limits: Limits) -> Shader<'a> {
        let mut lights = scene.lights.clone();
        if lights.is_empty() {
            lights.push(Light::point(scene.camera.from, glam::Vec3::ONE));
        }
        Shader { scene, polygons, lights, limits, rules: Rules::default(), occluders: None, shades: None }
    }

    /// The same where the host goes by rules. The light of a tree does not depend on them.
    pub fn with_rules(self, rules: Rules) -> Shader<'a> {
        let occluders = rules.a4b.then(|| Occluders::new(&self.scene.mesh, self.polygons, &self.lights));
        let shades = rules.a4c.then(|| Shades::new(self.scene, self.polygons, &self.lights));
        Shader { rules, occluders, shades, ..self }
    }

    /// A ray that leaves a polygon, with what the rules say of it.
    fn ruled(&self, branch: Branch, polygon: u32) -> Branch {
        let own = Some(polygon).filter(|&polygon| self.rules.own && self.polygons.surely_misses(&branch.ray, polygon));
        let ruled = Branch { own, ..branch };
        match branch.kind {
            RayKind::Shadow => self.foretold(ruled),
            _ => ruled,
        }
    }

    /// A shadow ray, with what the rules say of its hit.
    fn foretold(&self, branch: Branch) -> Branch {
        let (ray, light) = (&branch.ray, branch.light);
        let outside = self.occluders.as_ref().map(|occluders| occluders.look(self.polygons, ray, light));
        let Told { foretold, tests } = outside.unwrap_or_default();
        let inside = self.shades.as_ref().filter(|_| foretold.is_none());
        let shaded = inside.map(|shades| shades.look(self.polygons, ray, light)).unwrap_or_default();
        Branch { foretold: foretold.or(shaded.foretold), rule_tests: [tests, shaded.tests], ..branch }
    }

    /// The light of a ray from the eye that hits nothing.
    pub fn background(&self) -> DVec3 {
        self.scene.background.as_dvec3()
    }

    /// What a ray's hit adds to the pixel at once. Hands the rays that the hit asks for to `send`.
    pub fn shade(&self, branch: &Branch, hit: &Hit, mut send: impl FnMut(Branch)) -> DVec3 {
        let mut send = |child: Branch| send(self.ruled(child, hit.polygon));
        match (branch.kind, hit.is_hit()) {
            (RayKind::Shadow, false) => branch.weight,
            (_, false) => branch.weight * self.scene.background.as_dvec3(),
            (RayKind::Shadow, true) => {
                self.pass_blocker(branch, hit).into_iter().for_each(send);
                DVec3::ZERO
            }
            (_, true) => {
                let surface = Surface::at(self.scene, self.polygons, &branch.ray, hit);
                for (number, light) in (0..).zip(&self.lights) {
                    let shadow = self.shadow(branch, &surface, light);
                    shadow.map(|shadow| Branch { light: number, ..shadow }).into_iter().for_each(&mut send);
                }
                if branch.generation < self.limits.depth {
                    self.reflected_and_refracted(branch, &surface, send);
                }
                branch.weight * surface.material.color.as_dvec3() * surface.material.diffuse as f64 * AMBIENT
            }
        }
    }

    /// The ray to a light, if the light could be seen from this side of the surface.
    fn shadow(&self, branch: &Branch, surface: &Surface, light: &Light) -> Option<Branch> {
        let origin = surface.before();
        let (to_light, distance) = match light.from {
            LightFrom::Point(at) => {
                let away = at.as_dvec3() - origin;
                (away.normalize_or_zero(), away.length())
            }
            LightFrom::Direction(towards) => (towards.as_dvec3().normalize_or_zero(), f64::INFINITY),
        };
        let facing = surface.normal.dot(to_light);
        if facing <= 0.0 || surface.flat.dot(to_light) <= 0.0 {
            return None;
        }
        let material = &surface.material;
        let diffuse = material.color.as_dvec3() * (material.diffuse as f64 * (1.0 - AMBIENT) * facing);
        let mirrored = reflect(branch.ray.direction.as_dvec3().normalize_or_zero(), surface.normal);
        let highlight = material.specular as f64 * mirrored.dot(to_light).max(0.0).powf(material.shine as f64);
        let weight = branch.weight * light.color.as_dvec3() * (diffuse + highlight);
        if weight == DVec3::ZERO {
            return None;
        }
        let mut shadow = branch.next(RayKind::Shadow, origin, to_light, weight);
        shadow.ray.t_max = distance as f32;
        Some(shadow)
    }

    /// The rest of a shadow ray behind what it hit, if that lets light through.
    fn pass_blocker(&self, branch: &Branch, hit: &Hit) -> Option<Branch> {
        let surface = Surface::at(self.scene, self.polygons, &branch.ray, hit);
        let weight = branch.weight * surface.material.transmittance as f64 * surface.material.color.as_dvec3();
        if !self.counts(weight) {
            return None;
        }
        let mut rest = branch.next(RayKind::Shadow, surface.behind(), branch.ray.direction.as_dvec3(), weight);
        rest.ray.t_max = branch.ray.t_max - hit.t;
        (rest.ray.t_max > 0.0).then_some(rest)
    }

    fn reflected_and_refracted(&self, branch: &Branch, surface: &Surface, mut send: impl FnMut(Branch)) {
        let material = &surface.material;
        let direction = branch.ray.direction.as_dvec3().normalize_or_zero();
        let mut reflected = branch.weight * material.specular as f64;
        let through = branch.weight * material.transmittance as f64 * material.color.as_dvec3();
        if self.counts(through) {
            let index = material.refraction as f64;
            let ratio = if surface.from_outside { 1.0 / index } else { index };
            match refract(direction, surface.normal, ratio) {
                Some(bent) => {
                    // Between corners' normals a bent ray can come out on the wrong side of the polygon.
                    let bent = if bent.dot(surface.flat) < 0.0 { bent } else { direction };
                    send(branch.next(RayKind::Refracted, surface.behind(), bent, through));
                }
                None => reflected += through,
            }
        }
        if self.counts(reflected) {
            let mirrored = reflect(direction, surface.normal);
            let mirrored = if mirrored.dot(surface.flat) > 0.0 { mirrored } else { reflect(direction, surface.flat) };
            send(branch.next(RayKind::Reflected, surface.before(), mirrored, reflected));
        }
    }

    fn counts(&self, weight: DVec3) -> bool {
        weight.max_element() >= self.limits.contribution && weight.max_element() > 0.0
    }
}

/// A direction as a mirror with that normal sends it back.
pub fn reflect(direction: DVec3, normal: DVec3) -> DVec3 {
    direction - normal * (2.0 * direction.dot(normal))
}

/// A direction of unit length as a surface bends it (Snell), whose normal is on the side that the ray comes from; `ratio`
/// is that side's index of refraction over the other's. `None` if the surface reflects it totally.
pub fn refract(direction: DVec3, normal: DVec3, ratio: f64) -> Option<DVec3> {
    let cosine = -direction.dot(normal);
    let sine_squared = ratio * ratio * (1.0 - cosine * cosine);
    (sine_squared < 1.0).then(|| direction * ratio + normal * (ratio * cosine - (1.0 - sine_squared).sqrt()))
}
