//! What a pixel shows, as a number that is the same where the same is seen: what adaptive sampling compares.

use bitvec::vec::BitVec;
use glam::DVec3;

use super::render::Picture;
use super::trees::TreeRay;
use crate::geometry::Hit;
use crate::host::image;
use crate::host::sampling::{Criterion, Shown, key_of};
use crate::host::screen::{self, ScreenRectangles};
use crate::host::shading::{Branch, RayKind};
use crate::random;
use crate::scene::surfaces;

/// What a criterion looks at in a scene.
pub(super) struct Look {
    criterion: Criterion,
    /// Of each face, what it is a part of.
    parts: Vec<u64>,
}

impl Look {
    /// What the picture's criterion looks at, if it has one.
    pub fn new(picture: &Picture<'_>) -> Option<Look> {
        let criterion = picture.sampling.adaptive.filter(|_| picture.sampling.side > 1)?;
        let mesh = &picture.scene.mesh;
        let parts = match criterion {
            Criterion::Object => mesh.faces().iter().map(|face| mesh.object(face).number()).collect(),
            Criterion::Surface | Criterion::Lao => surfaces(mesh).into_iter().map(u64::from).collect(),
            Criterion::Whitted { .. } => Vec::new(),
        };
        Some(Look { criterion, parts })
    }

    /// Nothing seen so far.
    pub fn blank(&self, picture: &Picture<'_>) -> Shown {
        let small = (self.criterion == Criterion::Lao).then(|| small_objects(picture));
        Shown { keys: vec![0; picture.size.pixels()], small }
    }

    /// What a sample shows whose tree has these rays; children are numbered from `first` on.
    pub fn key(&self, (rays, hits, branches, first): (&[TreeRay], &[Hit], &[Branch], usize), color: DVec3) -> u64 {
        match self.criterion {
            Criterion::Object | Criterion::Surface => hits.first().map_or(NOTHING, |hit| self.part(hit)),
            Criterion::Lao if hits.is_empty() => NOTHING,
            Criterion::Lao => self.path(rays, hits, branches, first),
            Criterion::Whitted { .. } => image::on_screen(&[color.as_vec3()]).first().map_or(0, |&color| key_of(color)),
        }
    }

    fn part(&self, hit: &Hit) -> u64 {
        if hit.is_hit() { self.parts[hit.polygon as usize] + 1 } else { NOTHING }
    }

    /// The surface that is seen, the lights that reach it, and the same of what is reflected and refracted: from the last rays back to the
    /// first, as children stand behind their parents.
    fn path(&self, rays: &[TreeRay], hits: &[Hit], branches: &[Branch], first: usize) -> u64 {
        let mut keys = vec![NOTHING; rays.len()];
        for at in (0..rays.len()).rev() {
            let (child, count) = (rays[at].children.0 as usize - first, rays[at].children.1 as usize);
            keys[at] = if rays[at].kind == RayKind::Shadow {
                match (hits[at].is_hit(), count) {
                    (false, _) => random::of_item(LIGHT, branches[at].light.into()),
                    (true, 0) => NOTHING,
                    (true, _) => keys[child],
                }
            } else {
                let of =
                    |kind: RayKind| (child..child + count).filter(move |&at| rays[at].kind == kind).map(|at| keys[at]);
                // A set: in whichever order the lights stand.
                let lights = of(RayKind::Shadow).fold(0u64, u64::wrapping_add);
                let one = |kind| of(kind).next().unwrap_or(NOTHING);
                match self.part(&hits[at]) {
                    NOTHING => NOTHING,
                    part => [lights, one(RayKind::Reflected), one(RayKind::Refracted)]
                        .into_iter()
                        .fold(part, random::of_item),
                }
            };
        }
        keys[0]
    }
}

/// The key of what hits nothing.
const NOTHING: u64 = 0;

/// The seed of lights' keys.
const LIGHT: u64 = 1;

/// The pixels into which objects reach that are smaller than a pixel.
fn small_objects(picture: &Picture<'_>) -> BitVec {
    let size = picture.size;
    let mut small = BitVec::repeat(false, size.pixels());
    let all = screen::rectangles(picture.scene, picture.workload.polygons(), size, ScreenRectangles::Objects);
    for rectangle in all.iter().filter(|rectangle| rectangle.is_small()) {
        let [columns, lines] = rectangle.pixels(size);
        for line in lines {
            columns.clone().for_each(|column| small.set((line * size.width + column) as usize, true));
        }
    }
    small
}
