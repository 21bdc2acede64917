//! Rays in regions, and what follows from them.

use crate::program::cube::graph::{Share, TaskGraph};
use crate::program::cube::pool::Placing;

/// A ray in a region.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Visit {
    /// The ray.
    pub ray: u32,
    /// Its leg, among all.
    pub leg: u32,
}

/// What follows from a ray: itself in its next region, or one that its hit asks for where that starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Follower {
    /// The ray, and its leg.
    pub visit: Visit,
    /// The region.
    pub region: u16,
}

/// What is known of a visit before its node begins with it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ahead {
    /// What it makes the node do.
    pub share: Share,
    /// What follows from it first.
    pub follower: Option<Follower>,
}

impl TaskGraph {
    /// A ray where it starts.
    #[inline]
    pub(super) fn first_visit(&self, ray: u32) -> Visit {
        Visit { ray, leg: self.rays[ray as usize].first_leg }
    }

    #[inline]
    pub(super) fn ahead(&self, visit: Visit) -> Ahead {
        let follower = self.follower(Placing { visit, is_new: false, placed: 0 });
        Ahead { share: self.share(visit.ray, visit.leg), follower }
    }

    /// What of a placing comes next: the ray in its next region, or a ray that its hit asks for.
    #[inline]
    pub(super) fn follower(&self, Placing { visit, is_new, placed }: Placing) -> Option<Follower> {
        let Visit { ray, leg } = visit;
        let follows = if is_new {
            (placed == 0).then_some(visit)
        } else if leg + 1 < self.legs_end(ray) {
            (placed == 0).then_some(Visit { ray, leg: leg + 1 })
        } else {
            let (first, count) = self.rays[ray as usize].children;
            (placed < count).then(|| self.first_visit(first + placed))
        };
        follows.map(|visit| Follower { visit, region: self.legs[visit.leg as usize].region })
    }
}
