//! Ranges of numbers, in decimal: 0.001 and a thousand more steps of 0.001 are 1.001, without the dust of binary fractions.

use serde::Deserialize;

/// More values are surely a mistake.
pub(super) const MOST_VALUES: usize = 1_000_000;

/// Values from one to another, both included.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Range {
    from: f64,
    to: f64,
    #[serde(default)]
    step: f64,
    #[serde(default = "one")]
    times: f64,
}

fn one() -> f64 {
    1.0
}

impl Range {
    /// The values: each is the one before times `times` plus `step`.
    pub fn values(&self) -> Result<Vec<f64>, String> {
        let Range { from, to, step, times } = *self;
        let next = |value: f64| value * times + step;
        if !(from <= to && next(from) > from && [to, step, times].into_iter().all(f64::is_finite)) {
            return Err("a range needs from, to, and a step above 0 or times above 1".to_owned());
        }
        let steps = if times == 1.0 { Steps::new(from, to, step) } else { None };
        let count = steps.as_ref().map_or_else(|| self.count(), |steps| steps.count as f64);
        if count > MOST_VALUES as f64 {
            return Err(format!("the range has {count} values, and a parameter may have up to {MOST_VALUES}"));
        }
        Ok(steps.and_then(|steps| steps.values()).unwrap_or_else(|| {
            // What is multiplied up misses its end by rounding alone.
            let end = to + 1e-9 * to.abs();
            let values = std::iter::successors(Some(from), |&value| Some(next(value)).filter(|next| *next > value));
            values.take_while(|&value| value <= end).map(rounded).collect()
        }))
    }

    /// About how many values there are.
    fn count(&self) -> f64 {
        let Range { from, to, step, times } = *self;
        let steps = match times == 1.0 {
            true => (to - from) / step,
            false => {
                let shift = step / (times - 1.0);
                ((to + shift) / (from + shift)).ln() / times.ln()
            }
        };
        (steps * (1.0 + 1e-9)).floor() + 1.0
    }
}

/// from, from + step, from + 2 step, ...: sums of decimal digits.
struct Steps {
    from: Decimal,
    step: i128,
    count: i128,
}

impl Steps {
    /// Those up to a number. `None` if the numbers are so far apart that their digits do not fit.
    fn new(from: f64, to: f64, step: f64) -> Option<Steps> {
        let numbers = [from, to, step].map(Decimal::of);
        let exponent = numbers.iter().map(|number| number.exponent).min()?;
        let [from, to, step] = numbers.map(|number| number.digits_at(exponent));
        let (from, to, step) = (from?, to?, step?);
        let count = to.checked_sub(from)?.checked_div(step)? + 1;
        Some(Steps { from: Decimal { digits: from, exponent }, step, count })
    }

    /// The number nearest to each of them.
    fn values(&self) -> Option<Vec<f64>> {
        let Decimal { digits, exponent } = self.from;
        (0..self.count).map(|n| Decimal { digits: digits + n * self.step, exponent }.value()).collect()
    }
}

/// A product without the dust of binary fractions.
fn rounded(value: f64) -> f64 {
    format!("{value:.12e}").parse().unwrap_or(value)
}

/// `digits` times 10^`exponent`.
#[derive(Clone, Copy)]
struct Decimal {
    digits: i128,
    exponent: i32,
}

impl Decimal {
    /// The shortest decimal that is read as this number: what its author wrote.
    fn of(number: f64) -> Decimal {
        let written = format!("{number:e}");
        let (mantissa, exponent) = written.split_once('e').unwrap_or((&written, "0"));
        let fraction = mantissa.split_once('.').map_or(0, |(_, fraction)| fraction.len() as i32);
        let digits = mantissa.replace('.', "").parse().unwrap_or(0);
        Decimal { digits, exponent: exponent.parse::<i32>().unwrap_or(0) - fraction }
    }

    /// Its digits, written out down to a lower exponent.
    fn digits_at(self, exponent: i32) -> Option<i128> {
        let places = if self.digits == 0 { 0 } else { u32::try_from(self.exponent - exponent).ok()? };
        self.digits.checked_mul(10i128.checked_pow(places)?)
    }

    fn value(self) -> Option<f64> {
        format!("{}e{}", self.digits, self.exponent).parse().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn range(from: f64, to: f64, step: f64, times: f64) -> Result<Vec<f64>, String> {
        Range { from, to, step, times }.values()
    }

    #[test]
    fn steps_gather_no_dust() {
        let values = range(0.001, 10.0, 0.001, 1.0).unwrap();
        assert_eq!(values.len(), 10_000);
        for (value, thousandths) in values.iter().zip(1..) {
            assert_eq!(value.to_string(), (f64::from(thousandths) / 1000.0).to_string());
        }
        assert_eq!(range(-0.3, 0.3, 0.1, 1.0).unwrap(), [-0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3]);
        assert_eq!(range(1e20, 1e20 + 1e5, 32768.0, 1.0).unwrap().len(), 4);
    }

    #[test]
    fn products_end_where_they_should() {
        assert_eq!(range(1.0, 64.0, 0.0, 2.0).unwrap(), [1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0]);
        assert_eq!(range(0.1, 100.0, 0.0, 10.0).unwrap(), [0.1, 1.0, 10.0, 100.0]);
        assert_eq!(range(1.0, 31.0, 1.0, 2.0).unwrap(), [1.0, 3.0, 7.0, 15.0, 31.0]);
        assert_eq!(range(1.0, 2.0, 0.0, 1.0594630943592953).unwrap().len(), 13, "an octave");
    }

    #[test]
    fn more_values_than_can_be_held_are_counted() {
        let refused = |result: Result<Vec<f64>, String>| result.expect_err("it has too many values");
        assert!(refused(range(1.0, 1e9, 1.0, 1.0)).contains("has 1000000000 values"));
        assert!(refused(range(0.0, 1.0, 1e-7, 1.0)).contains("has 10000001 values"));
        assert!(refused(range(1.0, 1e300, 0.0, 1.0001)).contains("has 69081"));
        for (from, to, step, times) in
            [(1.0, 9.0, 0.0, 1.0), (9.0, 1.0, 1.0, 1.0), (1.0, 9.0, -1.0, 1.0), (1.0, f64::INFINITY, 1.0, 1.0)]
        {
            assert!(refused(range(from, to, step, times)).contains("a range needs"));
        }
    }

    proptest! {
        /// Each value is the one that is read of its decimal digits, worked out in whole numbers.
        #[test]
        fn steps_are_exact(from in -100_000i64..100_000, step in 1i64..1000, count in 1i64..500, places in 0usize..8) {
            let written = |digits: i64| -> f64 { format!("{digits}e-{places}").parse().unwrap() };
            let values = range(written(from), written(from + (count - 1) * step), written(step), 1.0).unwrap();
            let expected: Vec<f64> = (0..count).map(|n| written(from + n * step)).collect();
            prop_assert_eq!(values, expected);
        }
    }
}
