//! How far outside a triangle A.3's test of α and β in 32 bits can take a point for one inside: next to nothing for most, but
//! as far as the short edge of a sliver is long, if that edge is opposite to S0.
//!
//! Let (u1, v1) and (u2, v2) be the edges from S0 as A.3 has them, in 32 bits, and (u0, v0) the point from S0, likewise; what
//! rounding did to these is of the size of the triangle times [`UNIT`], and counted in [`rounding`](super::rounding). With exact
//! arithmetic on them let
//!
//! ```text
//! Nα = u0 v2 - v0 u2,  Nβ = u1 v0 - v1 u0,  D = u1 v2 - v1 u2,  so that α = Nα / D, β = Nβ / D.
//! ```
//!
//! In 32 bits each is off by u = 2^-24 of either product and of its own value. Write |Nα| for |u0 v2| + |v0 u2| and so on; |u0| and
//! |v0| are within the triangle's rectangle, against which A.3 tests exactly. With D > 0, or all signs turned round, a point that
//! passes α >= 0, β >= 0 and α + β <= 1 in 32 bits fulfils
//!
//! ```text
//! Nα >= -2 u |Nα|,   Nβ >= -2 u |Nβ|,   Nα + Nβ <= D + u (|Nα| + |Nβ| + |D|) + 4.1 u D.
//! ```
//!
//! The last: the sum of α and β is rounded, and so are they, D and both N; what u of u is, is within the 0.1. In each quadrant around S0
//! |u0| and |v0| have one sign, and these are half-planes. They cut a convex polygon out of the rectangle, and the distance from the
//! triangle is largest at one of its corners. If D is within its own error of 0, its sign may come out wrong; then Nα and Nβ are at
//! most D and the error of the sum, in absolute value, whichever sign they have.

use glam::DVec2;

use super::rounding::UNIT;

/// What products and quotients lose below the range of normal numbers, far below what any determinant that counts can be.
const UNDERFLOW: f64 = 1e-40;

/// A half-plane: the points at which `direction`.p is at most `most`.
struct HalfPlane {
    direction: DVec2,
    most: f64,
}

/// The edges of a triangle from S0, and what its determinant comes to.
struct Triangle {
    edges: [DVec2; 2],
    determinant: f64,
    /// |D|, the sum of both products.
    products: f64,
}

/// The largest distance, in the plane of projection, between the triangle of the edges `first` and `second` from S0 and a point
/// that A.3 takes to be inside. 0 if a rough bound shows that it is at most `enough`.
pub fn overshoot(first: [f32; 2], second: [f32; 2], enough: f64) -> f64 {
    let edges = [first, second].map(|[u, v]| DVec2::new(u.into(), v.into()));
    let [e1, e2] = edges;
    let products = (e1.x * e2.y).abs() + (e1.y * e2.x).abs();
    let triangle = Triangle { edges, determinant: e1.perp_dot(e2), products };
    let (low, high) = (e1.min(e2).min(DVec2::ZERO), e1.max(e2).max(DVec2::ZERO));
    if triangle.is_certain() && triangle.rough_overshoot(high.max(-low)) <= enough {
        return 0.0;
    }
    let quadrants = [DVec2::ONE, DVec2::new(1.0, -1.0), DVec2::new(-1.0, 1.0), DVec2::NEG_ONE];
    let in_quadrant = |signs: DVec2| {
        // A quadrant that the rectangle touches with its border alone adds nothing.
        let (low, high) = (low * signs, high * signs);
        let (near, far) = (low.min(high).max(DVec2::ZERO) * signs, low.max(high).max(DVec2::ZERO) * signs);
        let corners = vec![near, DVec2::new(far.x, near.y), far, DVec2::new(near.x, far.y)];
        let accepted = triangle.half_planes(signs, high.abs().max(low.abs()));
        accepted.iter().fold(corners, |part, half_plane| half_plane.cut(&part))
    };
    let accepted = quadrants.into_iter().flat_map(in_quadrant);
    accepted.map(|point| distance(point, [DVec2::ZERO, e1, e2])).fold(0.0, f64::max)
}

impl Triangle {
    /// Whether the determinant has its sign in 32 bits.
    fn is_certain(&self) -> bool {
        self.determinant.abs() > 2.0 * UNIT * self.products
    }

    /// The most that α and β of an accepted point sum up to, times D, but for what is off in Nα and Nβ.
    fn most(&self) -> f64 {
        let size = self.determinant.abs();
        size + UNIT * self.products + 4.1 * UNIT * size + UNDERFLOW * (1.0 + size)
    }

    /// |Nα| and |Nβ| at a point whose coordinates are positive, as vectors.
    fn products_of(&self, point: DVec2) -> [f64; 2] {
        let [e1, e2] = self.edges.map(DVec2::abs);
        [e2, e1].map(|edge| point.x * edge.y + point.y * edge.x)
    }

    /// A bound for the overshoot: α and β of an accepted point are off by no more than some part of 1, and the point by as much of
    /// the edges.
    fn rough_overshoot(&self, farthest: DVec2) -> f64 {
        let [n_alpha, n_beta] = self.products_of(farthest);
        let size = self.determinant.abs();
        let off = 3.0 * UNIT * (n_alpha + n_beta) + self.most() - size;
        let [e1, e2] = self.edges.map(DVec2::length);
        2.0 * off / size * e1.max(e2)
    }

    /// Where accepted points lie in one quadrant. None is farther from S0 than `farthest`.
    fn half_planes(&self, signs: DVec2, farthest: DVec2) -> [HalfPlane; 4] {
        let [e1, e2] = self.edges;
        // Nα and Nβ are these times the point, and |Nα| and |Nβ| those.
        let (alpha, beta) = (DVec2::new(e2.y, -e2.x), DVec2::new(-e1.y, e1.x));
        let [off_alpha, off_beta] = [alpha, beta].map(|n| n.abs() * signs * UNIT);
        let sign = self.determinant.signum();
        let least = UNDERFLOW * (1.0 + self.determinant.abs());
        if self.is_certain() {
            return [
                HalfPlane { direction: -alpha * sign - 2.0 * off_alpha, most: least },
                HalfPlane { direction: -beta * sign - 2.0 * off_beta, most: least },
                HalfPlane { direction: (alpha + beta) * sign - off_alpha - off_beta, most: self.most() },
                HalfPlane { direction: DVec2::ZERO, most: 0.0 },
            ];
        }
        let most = self.most() + 2.0 * UNIT * self.products_of(farthest).iter().sum::<f64>();
        [alpha, -alpha, beta, -beta].map(|direction| HalfPlane { direction, most })
    }
}

impl HalfPlane {
    /// The part of a convex polygon that lies in it.
    fn cut(&self, polygon: &[DVec2]) -> Vec<DVec2> {
        let beyond = |point: DVec2| self.direction.dot(point) - self.most;
        let mut part = Vec::with_capacity(polygon.len() + 1);
        for (index, &from) in polygon.iter().enumerate() {
            let to = polygon[(index + 1) % polygon.len()];
            let (here, there) = (beyond(from), beyond(to));
            if here <= 0.0 {
                part.push(from);
            }
            if (here <= 0.0) != (there <= 0.0) {
                part.push(from + (to - from) * (here / (here - there)));
            }
        }
        part
    }
}

/// The distance of a point from a triangle; 0 inside.
fn distance(point: DVec2, triangle: [DVec2; 3]) -> f64 {
    let edges = [0, 1, 2].map(|k| (triangle[k], triangle[(k + 1) % 3] - triangle[k]));
    let sides = edges.map(|(from, edge)| edge.perp_dot(point - from));
    if sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0) {
        // On the line of a triangle without area, a point is beside it.
        let area = edges[0].1.perp_dot(edges[1].1);
        if area != 0.0 {
            return 0.0;
        }
    }
    let to_edge = |(from, edge): (DVec2, DVec2)| {
        let along = (point - from).dot(edge) / edge.length_squared();
        let along = if along.is_finite() { along.clamp(0.0, 1.0) } else { 0.0 };
        (point - from - edge * along).length()
    };
    edges.map(to_edge).into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordinary_triangles_are_left_by_next_to_nothing() {
        for (first, second) in [([1.0, 0.0], [0.0, 1.0]), ([1.0, 1.0], [1.0, 0.9]), ([0.3, -0.7], [0.2, 0.9])] {
            let found = overshoot(first, second, 0.0);
            assert!(found < 64.0 * UNIT, "{first:?} {second:?}: {found}");
        }
    }

    /// The short edge is opposite to S0, and the rectangle reaches half its length beyond it.
    #[test]
    fn a_sliver_is_left_beyond_its_short_edge() {
        let found = overshoot([5001.0, 4999.5], [5000.0, 5001.0], 0.0);
        assert!((0.5..1.5).contains(&found), "{found}");
        // From the other end the edges that meet the short one are well told.
        let found = overshoot([1.0, -1.5], [-5000.0, -5001.0], 0.0);
        assert!(found < 0.01, "{found}");
    }

    #[test]
    fn without_area_a_triangle_is_left_within_its_rectangle() {
        assert!(overshoot([1.0, 1.0], [2.0, 2.0], 0.0) < 1e-5);
        assert!(overshoot([1.0, 1.0], [-2.0, -2.0], 0.0) < 1e-5);
        assert!(overshoot([0.0, 0.0], [0.0, 0.0], 0.0) < 1e-5);
    }
}
