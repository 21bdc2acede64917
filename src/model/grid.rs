//! A.1: the grid.

use glam::DVec3;

/// nb_voxel = coeff_grid P.
pub fn voxels(coefficient: f64, polygons: f64) -> f64 {
    coefficient * polygons
}

/// nb_steps <= cbrt(coeff_grid P): the voxels that a ray walks through.
///
/// The paper calls it a bound, as a walk may stop at a hit. It is the mean of whole walks of random lines (see
/// [`steps_of_random_line`]); a camera's rays may walk up to √3 as far.
pub fn steps_bound(coefficient: f64, polygons: f64) -> f64 {
    voxels(coefficient, polygons).cbrt()
}

/// The mean number of voxels on lines that meet a grid of `size` voxels with edges `edge`, all such lines being equally
/// likely.
///
/// Such a line meets a flat piece of area a inside a convex body of surface S with probability 2 a / S (Crofton), which
/// gives the planes that it crosses. In a cube of n x n x n voxels it makes n, as Devillers has it.
pub fn steps_of_random_line(size: DVec3, edge: DVec3) -> f64 {
    let extent = size * edge;
    let faces = extent.element_product() / extent;
    1.0 + (size - 1.0).dot(faces) / faces.element_sum()
}

/// nb_voxel/poly by augmented volumes (Cleary & Wyvill): the mean number of cubic voxels with edge `edge` that meet a
/// convex polygon, over all its places and directions: 1 + 3/4 perimeter / edge + 3/2 area / edge².
pub fn voxels_per_polygon(area: f64, perimeter: f64, edge: f64) -> f64 {
    1.0 + 0.75 * perimeter / edge + 1.5 * area / (edge * edge)
}

/// nb_poly/voxel = nb_voxel/poly / coeff_grid.
pub fn polygons_per_voxel(voxels_per_polygon: f64, coefficient: f64) -> f64 {
    voxels_per_polygon / coefficient
}

/// nb_filter1 = nb_steps nb_poly/voxel: the polygons that the grid lets through for a ray. Exact on average for random
/// lines; a camera looks where the polygons are.
pub fn candidates(steps: f64, polygons_per_voxel: f64) -> f64 {
    steps * polygons_per_voxel
}

/// Equation (4): mem_grid = (coeff_grid + nb_voxel/poly) P, in words.
pub fn memory_words(coefficient: f64, voxels_per_polygon: f64, polygons: f64) -> f64 {
    (coefficient + voxels_per_polygon) * polygons
}
