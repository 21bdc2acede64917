//! An axis: linear, logarithmic, or words side by side.

use std::ops::Range;

use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};

use super::chart;

/// Ticks that an axis has room for.
const MOST_TICKS: usize = 14;

/// Ticks that are no more than this share of the axis apart would run into each other.
const CLOSEST_TICKS: f64 = 0.03;

/// What stands along an axis.
#[derive(Clone, Debug, PartialEq)]
pub enum Positions {
    /// Numbers, rising.
    Numbers(Vec<f64>),
    /// Words, at 0, 1, 2, ...
    Words(Vec<String>),
}

/// How the numbers along an axis are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spread {
    /// As the numbers are themselves.
    OfItself,
    /// Evenly.
    Even,
    /// By powers.
    Logarithmic,
}

/// Numbers that are farther from 1 cannot be drawn: their products leave what numbers can be.
const FARTHEST: f64 = 1e150;

/// Why a number has no place on a logarithmic axis.
const NOT_ABOVE_0: &str = "a logarithmic axis has numbers above 0, and there are others: leave out log=";

/// A scale, its ticks and what they are called.
#[derive(Clone, Debug)]
pub struct Scale {
    low: f64,
    high: f64,
    is_log: bool,
    ticks: Vec<f64>,
    /// Whether ticks are so near each other that it takes all their digits to tell them apart.
    all_digits: bool,
    words: Vec<String>,
}

impl Scale {
    /// The scale of what stands along x. It is logarithmic where the numbers are spread like that, with a tick at each. Fails
    /// if it has to be and cannot.
    pub fn of_positions(positions: &Positions, spread: Spread) -> Result<Scale, String> {
        Ok(match positions {
            Positions::Words(words) => {
                let last = words.len() as f64 - 1.0;
                let ticks = (0..words.len()).map(|word| word as f64).collect();
                Scale { words: words.clone(), ..Scale::new((-0.5, last + 0.5), false, ticks) }
            }
            Positions::Numbers(numbers) => {
                let (first, last) = (numbers[0], numbers[numbers.len() - 1]);
                check(numbers.iter().copied())?;
                if spread == Spread::Logarithmic && first <= 0.0 {
                    return Err(NOT_ABOVE_0.to_owned());
                }
                if spread == Spread::Logarithmic || (spread == Spread::OfItself && is_geometric(numbers)) {
                    let air = (last / first).powf(0.03).max(1.01);
                    let scale = Scale::logarithmic(first / air, last * air);
                    let apart =
                        numbers.windows(2).all(|pair| scale.share(pair[1]) - scale.share(pair[0]) > CLOSEST_TICKS);
                    let at_each = apart && numbers.len() <= MOST_TICKS;
                    if at_each { Scale::new((scale.low, scale.high), true, numbers.clone()) } else { scale }
                } else {
                    let air = if last > first { 0.03 * (last - first) } else { 0.5 * last.max(1.0) };
                    Scale::linear(first - air, last + air)
                }
            }
        })
    }

    /// The scale of values from 0 up, or down; those above 0 may span several powers of ten.
    ///
    /// Fails if it has to be logarithmic and cannot.
    pub fn of_values(values: impl Iterator<Item = f64> + Clone, spread: Spread) -> Result<Scale, String> {
        check(values.clone())?;
        let low = values.clone().fold(f64::INFINITY, f64::min);
        let high = values.fold(f64::NEG_INFINITY, f64::max);
        if spread == Spread::Logarithmic && low <= 0.0 {
            return Err(NOT_ABOVE_0.to_owned());
        }
        let is_wide = low > 0.0 && high / low > 50.0;
        Ok(if spread == Spread::Logarithmic || (spread == Spread::OfItself && is_wide) {
            let air = (high / low).powf(0.05).max(1.1);
            Scale::logarithmic(low / air, high * air)
        } else {
            let beyond = |end: f64| if end == 0.0 { 0.0 } else { 1.08 * end };
            let (low, high) = (beyond(low.min(0.0)), beyond(high.max(0.0)));
            Scale::linear(low, if high > low { high } else { 1.0 })
        })
    }

    /// Evenly from one number to another.
    pub fn linear(low: f64, high: f64) -> Scale {
        let rough = (high - low) / 8.0;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power).into_iter().find(|step| *step >= rough);
        let step = step.unwrap_or(rough);
        let ticks = (low / step).ceil() as i64..=(high / step).floor() as i64;
        Scale::new((low, high), false, ticks.map(|tick| tick as f64 * step).collect())
    }

    /// By powers from one number above 0 to another.
    pub fn logarithmic(low: f64, high: f64) -> Scale {
        // So near each other there are hardly any powers.
        if high / low < 4.0 {
            return Scale { is_log: true, ..Scale::linear(low, high) };
        }
        let powers = low.log10().floor() as i32..=high.log10().ceil() as i32;
        let digits: &[f64] = if high / low > 1e4 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let all = powers.flat_map(|power| digits.iter().map(move |digit| digit * 10f64.powi(power)));
        let ticks = all.filter(|tick| (low..=high).contains(tick)).collect();
        Scale::new((low, high), true, ticks)
    }

    fn new((low, high): (f64, f64), is_log: bool, mut ticks: Vec<f64>) -> Scale {
        ticks.dedup();
        let all_digits = ticks.windows(2).any(|pair| number(pair[0]) == number(pair[1]));
        Scale { low, high, is_log, ticks, all_digits, words: Vec::new() }
    }

    /// Whether it is logarithmic.
    pub fn is_log(&self) -> bool {
        self.is_log
    }

    /// How many ticks it has.
    pub fn ticks(&self) -> usize {
        self.ticks.len()
    }

    /// Whether words stand along it.
    pub fn has_words(&self) -> bool {
        !self.words.is_empty()
    }

    /// The value that lies a share of the axis beside another.
    pub fn beside(&self, value: f64, share: f64) -> f64 {
        if self.is_log { value * (self.high / self.low).powf(share) } else { value + share * (self.high - self.low) }
    }

    /// What a number along it is called.
    pub fn name_of(&self, tick: f64) -> String {
        match self.words.get(tick.round().max(0.0) as usize) {
            Some(word) => word.clone(),
            None if self.words.is_empty() && self.all_digits => tick.to_string(),
            None if self.words.is_empty() => number(tick),
            None => String::new(),
        }
    }

    /// How far along the axis a value lies, from 0 to 1.
    fn share(&self, value: f64) -> f64 {
        let along = |value: f64| if self.is_log { value.max(f64::MIN_POSITIVE).ln() } else { value };
        (along(value) - along(self.low)) / (along(self.high) - along(self.low))
    }
}

impl Ranged for Scale {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (start, end): (i32, i32)) -> i32 {
        start + (self.share(*value) * (end - start) as f64).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

/// Fails if a number cannot be drawn.
fn check(mut numbers: impl Iterator<Item = f64>) -> Result<(), String> {
    let is_beyond = |number: &f64| *number != 0.0 && !(1.0 / FARTHEST..=FARTHEST).contains(&number.abs());
    match numbers.find(is_beyond) {
        None => Ok(()),
        Some(number) => {
            Err(format!("{number:e} cannot be drawn, which takes numbers from {:e} to {FARTHEST:e}", 1.0 / FARTHEST))
        }
    }
}

/// Whether numbers are spread as products rather than as sums: their ratios differ less than their differences do.
fn is_geometric(numbers: &[f64]) -> bool {
    let first = numbers[0];
    if numbers.len() < 3 || first <= 0.0 || numbers[numbers.len() - 1] / first < 4.0 {
        return false;
    }
    let unevenness = |step: fn(&[f64]) -> f64| {
        let steps = numbers.windows(2).map(step);
        steps.clone().fold(0.0, f64::max) / steps.fold(f64::INFINITY, f64::min)
    };
    unevenness(|pair| (pair[1] / pair[0]).ln()) < unevenness(|pair| pair[1] - pair[0])
}

/// A number as an axis shows it: thousands set off, very large and very small ones with a power of ten.
fn number(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e9).contains(&value.abs()) {
        return format!("{value:e}");
    }
    let text = chart::number(&value);
    match text.split_once('.') {
        None if text.len() > 4 => crate::report::summary::grouped(value.round().max(0.0) as u64),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn spread_tells_the_scale() {
        assert!(is_geometric(&[1.0, 2.0, 4.0, 8.0]));
        assert!(is_geometric(&[5.0, 10.0, 20.0, 80.0]));
        assert!(!is_geometric(&[4.0, 8.0, 12.0, 16.0, 20.0]));
        assert!(!is_geometric(&[0.0, 1.0, 10.0]));
        assert!(!is_geometric(&[1.0, 64.0]));
    }

    #[test]
    fn ticks_lie_on_the_axis() {
        let scale = Scale::of_positions(&Positions::Numbers(vec![16.0, 64.0, 256.0]), Spread::OfItself).unwrap();
        assert_eq!(scale.ticks, [16.0, 64.0, 256.0]);
        assert_eq!(scale.map(&64.0, (0, 100)), 50);
        let crowded =
            Scale::of_positions(&Positions::Numbers(vec![1.0, 40.0, 41.0, 1000.0]), Spread::OfItself).unwrap();
        assert_eq!(crowded.ticks, [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0]);
        let scale = Scale::of_values([3.0, 950.0].into_iter(), Spread::OfItself).unwrap();
        assert!(scale.is_log);
        assert_eq!(scale.ticks, [5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0]);
        let scale = Scale::of_values([700.0, 1234.0].into_iter(), Spread::OfItself).unwrap();
        assert_eq!(scale.ticks, [0.0, 200.0, 400.0, 600.0, 800.0, 1000.0, 1200.0]);
        let near = Scale::of_positions(&Positions::Numbers(vec![1.0, 1.0 + f64::EPSILON]), Spread::OfItself).unwrap();
        let names: BTreeSet<String> = near.ticks.iter().map(|&tick| near.name_of(tick)).collect();
        assert!(names.len() == near.ticks.len() && names.len() > 1, "{names:?}");
        for beyond in [5e-324, 1e300, f64::INFINITY] {
            assert!(Scale::of_positions(&Positions::Numbers(vec![1.0, beyond]), Spread::OfItself).is_err());
            assert!(Scale::of_values([1.0, beyond].into_iter(), Spread::OfItself).is_err());
        }
        let single = Scale::of_positions(&Positions::Numbers(vec![7.0]), Spread::OfItself).unwrap();
        assert!(single.ticks.contains(&7.0), "{single:?}");
    }

    #[test]
    fn numbers_are_short() {
        let shown = [0.0, 0.25, 512.0, 4096.0, 20_000.0, 1_500_000.0, 2e9, 0.00002].map(number);
        assert_eq!(shown, ["0", "0.25", "512", "4096", "20 000", "1 500 000", "2e9", "2e-5"]);
    }
}
