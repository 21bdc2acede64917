//! A.2: the slabs.

/// Equation (6): 2 x directions x P, in words.
pub fn memory_words(directions: f64, polygons: f64) -> f64 {
    2.0 * directions * polygons
}
