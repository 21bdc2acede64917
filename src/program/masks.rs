//! Masks: the host tells each ray which sub-volumes it can meet, a bit each; the cells of the others pass it on. Beyond the paper, in
//! which every cell pays the grid's start for every ray.
//!
//! A bit that is not set means that the ray has no hit in that sub-volume's grid, so that hits do not depend on masks.

use crate::geometry::{Eye, Grid, Polygons, Ray, ScreenRectangle};
use crate::scene::Camera;

use super::array_program::Masks;
use super::messages::MASK_BITS;

/// What tells the host which sub-volumes rays can meet.
#[derive(Clone, Debug)]
pub(crate) enum Screening {
    /// The sub-volumes' boxes, against which every ray is tested.
    Boxes,
    /// Their rectangles before an eye, against which its rays are tested.
    Rectangles(Eye, Vec<ScreenRectangle>),
    /// Nothing: rectangles without an eye that they would be seen from.
    Unseen,
}

impl Screening {
    pub fn new(masks: Masks) -> Option<Screening> {
        match masks {
            Masks::Off => None,
            Masks::Boxes => Some(Screening::Boxes),
            Masks::Rectangles => Some(Screening::Unseen),
        }
    }

    /// The rectangles of sub-volumes that a camera sees, if they are to be seen.
    pub fn seen_by<'a>(
        self,
        camera: &Camera,
        polygons: &Polygons,
        grids: impl IntoIterator<Item = &'a Grid>,
    ) -> Screening {
        if matches!(self, Screening::Boxes) {
            return self;
        }
        let eye = Eye::of(camera);
        let strayed = polygons.beyond_margin(eye.at);
        let rectangles = grids.into_iter().map(|grid| eye.rectangle(grid.entered(strayed)));
        Screening::Rectangles(eye, rectangles.collect())
    }

    /// Against how many sub-volumes the host tests a ray.
    pub fn tests(&self, ray: &Ray, groups: usize) -> u64 {
        match self {
            Screening::Boxes => groups as u64,
            Screening::Rectangles(eye, _) if eye.at == ray.origin => groups as u64,
            _ => 0,
        }
    }

    /// Whether a ray can meet a group's sub-volume, which has this grid.
    pub fn admits(&self, ray: &Ray, polygons: &Polygons, (group, grid): (usize, &Grid)) -> bool {
        match self {
            Screening::Boxes => grid.meets(ray, polygons.beyond_margin(ray.origin)),
            Screening::Rectangles(eye, rectangles) => {
                eye.place_of(ray).is_none_or(|place| rectangles[group].holds(place))
            }
            Screening::Unseen => true,
        }
    }
}

impl Masks {
    /// Words that a RAY has more, for so many groups.
    pub fn words(self, groups: usize) -> u64 {
        if self == Masks::Off { 0 } else { (groups as u64).div_ceil(MASK_BITS) }
    }
}
