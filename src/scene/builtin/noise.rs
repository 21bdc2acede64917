//! Random numbers and noise that depend on integers alone: the same on every machine.

use glam::DVec2;

use crate::random;

/// A number in 0 to 1, below 1, that depends on a seed and a place.
pub fn unit(seed: u64, [x, y]: [i32; 2]) -> f64 {
    let place = u64::from(x as u32) << 32 | u64::from(y as u32);
    let bits = random::of_item(seed, place);
    (bits >> 11) as f64 / (1u64 << 53) as f64
}

/// Smooth noise in 0 to 1 with features of size 1.
pub fn smooth(seed: u64, at: DVec2) -> f64 {
    let cell = at.floor();
    let share = at - cell;
    let ease = share * share * share * (share * (share * 6.0 - 15.0) + 10.0);
    let corner = |x: i32, y: i32| unit(seed, [cell.x as i32 + x, cell.y as i32 + y]);
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    mix(mix(corner(0, 0), corner(1, 0), ease.x), mix(corner(0, 1), corner(1, 1), ease.x), ease.y)
}

/// Fractal noise in 0 to 1: `octaves` layers, each half as large and half as strong as the one before.
pub fn fractal(seed: u64, at: DVec2, octaves: u32) -> f64 {
    layers(octaves, |octave, scale| smooth(seed + u64::from(octave), at * scale))
}

/// Fractal noise in 0 to 1 with sharp ridges.
pub fn ridged(seed: u64, at: DVec2, octaves: u32) -> f64 {
    layers(octaves, |octave, scale| {
        let ridge = 1.0 - (2.0 * smooth(seed + u64::from(octave), at * scale) - 1.0).abs();
        ridge * ridge
    })
}

fn layers(octaves: u32, layer: impl Fn(u32, f64) -> f64) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for octave in 0..octaves {
        let scale = f64::from(1 << octave);
        sum += layer(octave, scale) / scale;
        weights += 1.0 / scale;
    }
    sum / weights
}

/// 0 up to `from`, 1 from `to` on, smooth between.
pub fn ramp(from: f64, to: f64, value: f64) -> f64 {
    let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
