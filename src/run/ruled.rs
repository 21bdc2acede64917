//! Whether rules change anything: an image's rays with them and without.

use super::render::{Picture, Seen, render};
use super::timed::RunError;
use super::trees::TreeRay;
use super::workers::Workers;
use crate::geometry::{Hit, Ray};
use crate::host::rules::Rules;
use crate::host::shading::RayKind;

/// A ray for which rules change something that they must not.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the rules {rules} change ray {ray} of the image, a {} ray: {what}", .kind.name())]
pub struct Broken {
    /// The rules.
    pub rules: Rules,
    /// Its number among all rays of the image, tree by tree.
    pub ray: usize,
    /// What it is for.
    pub kind: RayKind,
    /// What they change.
    pub what: &'static str,
}

/// What is kept of a ray without rules.
struct Known {
    ray: [u32; 7],
    hit: [u32; 4],
}

impl Known {
    fn new(ray: &Ray, hit: &Hit) -> Known {
        let [o, d] = [ray.origin, ray.direction].map(|v| v.to_array().map(f32::to_bits));
        Known {
            ray: [o[0], o[1], o[2], d[0], d[1], d[2], ray.t_max.to_bits()],
            hit: [hit.t.to_bits(), hit.polygon, hit.alpha.to_bits(), hit.beta.to_bits()],
        }
    }

    /// What the same ray has otherwise with rules.
    fn difference(&self, (ray, hit): (&TreeRay, &Hit)) -> Option<&'static str> {
        let ruled = Known::new(&ray.ray, hit);
        let does_hit = self.hit[1] != Hit::NO_POLYGON;
        match () {
            () if ruled.ray != self.ray => Some("another ray is there"),
            () if ray.is_sent && ruled.hit != self.hit => Some("it has another hit"),
            () if !ray.is_sent && hit.is_hit() != does_hit => {
                Some("it is not sent, and what they say of its hit is wrong")
            }
            () => None,
        }
    }
}

/// Traces all rays of a picture with its rules and without, and holds the one against the other: the same trees, each hit the same to the
/// bit, and of each ray that is not sent the truth. Returns how many rays there are, or the first for which that is not so.
///
/// # Errors
///
/// As [`render`], and if `observe` fails, which sees both grow.
pub fn check_rules<E>(
    picture: &Picture<'_>,
    workers: &Workers,
    mut observe: impl FnMut(&Seen<'_>) -> Result<(), E>,
) -> Result<Result<usize, Broken>, RunError<E>> {
    let mut known: Vec<Known> = Vec::new();
    let plain = render(&Picture { rules: Rules::default(), ..*picture }, None, workers, |seen| {
        if let Seen::Grown(trees, _) = &seen {
            known.extend(trees.rays.iter().zip(&trees.traced.hits).map(|(ray, hit)| Known::new(&ray.ray, hit)));
        }
        observe(&seen)
    })?;
    let (mut count, mut broken) = (0, None);
    let broke = |ray, kind, what| Broken { rules: picture.rules, ray, kind, what };
    let ruled = render(picture, None, workers, |seen| {
        if let Seen::Grown(trees, _) = &seen {
            for pair in trees.rays.iter().zip(&trees.traced.hits) {
                let difference =
                    known.get(count).map_or(Some("there is none without them"), |known| known.difference(pair));
                broken = broken.take().or(difference.map(|what| broke(count, pair.0.kind, what)));
                count += 1;
            }
        }
        observe(&seen)
    })?;
    let light =
        |pixels: &[glam::Vec3]| pixels.iter().flat_map(|pixel| pixel.to_array().map(f32::to_bits)).collect::<Vec<_>>();
    let is_same = count == known.len() && light(&plain.pixels) == light(&ruled.pixels);
    let beyond = (!is_same).then(|| broke(count, RayKind::Primary, "behind it the images differ"));
    Ok(broken.or(beyond).map_or(Ok(count), Err))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn any_bit_that_differs_is_told() {
        let hit = Hit { t: 2.0, polygon: 7, alpha: 0.25, beta: 0.5 };
        let ray = TreeRay {
            kind: RayKind::Shadow,
            generation: 1,
            shaded: false,
            children: (0, 0),
            tree: 0,
            mask_tests: 0,
            ray: Ray::new(Vec3::ZERO, Vec3::Z),
            busy: 0,
            is_sent: true,
        };
        let unsent = TreeRay { is_sent: false, ..ray };
        let known = Known::new(&ray.ray, &hit);
        let nearer = Hit { t: 2.0f32.next_down(), ..hit };
        let moved = TreeRay { ray: Ray { t_max: 5.0, ..ray.ray }, ..ray };
        assert_eq!(known.difference((&ray, &hit)), None);
        assert_eq!(known.difference((&ray, &nearer)), Some("it has another hit"));
        assert_eq!(known.difference((&moved, &hit)), Some("another ray is there"));
        assert_eq!(known.difference((&unsent, &nearer)), None, "of one that is not sent only whether it hits is known");
        let told = known.difference((&unsent, &Hit::MISS));
        assert_eq!(told, Some("it is not sent, and what they say of its hit is wrong"));
    }
}
