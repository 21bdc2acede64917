//! In which order the host sends the rays of an image.
//!
//! Neighbours in an image mostly keep the same cells busy. Sent one after the other they load one cell after another, and what
//! the FIFOs between them cannot even out, the others wait for; far apart they load all cells alike.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::camera::ImageSize;
use crate::quantities::common_divisor;
use crate::random;

/// An order of the pixels of an image, or of the rays of a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Order {
    /// `raster`: line by line from the top left, as pixels are numbered. Rays of a file: as they stand there.
    #[default]
    Raster,
    /// `columns`: column by column from the top left.
    Columns,
    /// `tiles:N`: squares of N x N pixels, line by line; the pixels of each line by line. Those at the right and at the lower edge
    /// may be smaller.
    Tiles(u32),
    /// `hilbert`: along Hilbert's curve through the least square with a power of two on its sides that has the image in its
    /// top left corner; it begins there. Neighbours on the curve are neighbours in the image.
    Hilbert,
    /// `stride`: each so many rays behind the last, by the golden section of all (as near as a number can be that has no
    /// divisor in common with theirs), over and over: far apart, and evenly spread at any time.
    Stride,
    /// `shuffle:SEED`: in a random order, another one for each seed.
    Shuffle(u64),
}

impl Order {
    /// The rays of an image in this order.
    pub fn of_pixels(self, size: ImageSize) -> Sequence {
        let ImageSize { width, height } = size;
        let count = size.pixels();
        let pixel = |x: u32, y: u32| y * width + x;
        let numbers = match self {
            Order::Raster => return Sequence::in_order(count),
            Order::Columns => (0..width).flat_map(|x| (0..height).map(move |y| pixel(x, y))).collect(),
            Order::Tiles(side) => {
                let tile = |&(x, y): &(u32, u32)| (y / side, x / side);
                let mut pixels: Vec<(u32, u32)> = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).collect();
                pixels.sort_by_key(tile);
                pixels.into_iter().map(|(x, y)| pixel(x, y)).collect()
            }
            Order::Hilbert => {
                let side = width.max(height).next_power_of_two();
                sorted(count, |number| along_hilbert(side, number % width, number / width))
            }
            Order::Stride => {
                let step = stride(count as u64);
                (0..count as u64).map(|place| (place * step % count as u64) as u32).collect()
            }
            Order::Shuffle(seed) => sorted(count, |number| random::of_item(seed, number.into())),
        };
        Sequence { count, numbers: Some(numbers) }
    }

    /// So many rays of a file in this order; `None` if it is one of pixels.
    pub fn of_list(self, rays: usize) -> Option<Sequence> {
        let of_pixels = matches!(self, Order::Columns | Order::Tiles(_) | Order::Hilbert);
        // As if they were the pixels of a line.
        (!of_pixels).then(|| self.of_pixels(ImageSize { width: rays as u32, height: 1 }))
    }
}

/// The numbers below `count`, sorted by a key.
fn sorted(count: usize, key: impl Fn(u32) -> u64) -> Vec<u32> {
    let mut numbers: Vec<u32> = (0..count as u32).collect();
    numbers.sort_by_cached_key(|&number| key(number));
    numbers
}

/// How far along Hilbert's curve through a square of `side` x `side`, a power of two, a point is.
fn along_hilbert(side: u32, mut x: u32, mut y: u32) -> u64 {
    let mut along = 0;
    let mut half = side / 2;
    while half > 0 {
        let (right, below) = (u32::from(x & half > 0), u32::from(y & half > 0));
        along += u64::from(half) * u64::from(half) * u64::from((3 * right) ^ below);
        // The curve through a quarter is the whole one, turned or mirrored.
        if below == 0 {
            if right == 1 {
                (x, y) = (half - 1 - (x & (half - 1)), half - 1 - (y & (half - 1)));
            }
            (x, y) = (y, x);
        }
        half /= 2;
    }
    along
}

/// The golden section of a number, or the next number above that has no divisor in common with it.
fn stride(count: u64) -> u64 {
    let golden = (5f64.sqrt() - 1.0) / 2.0;
    let nearest = (count as f64 * golden).round() as u64;
    (nearest.max(1)..).find(|&step| common_divisor(step, count) == 1).unwrap_or(1)
}

impl FromStr for Order {
    type Err = String;

    /// `raster`, `tiles:8`, `shuffle:7`.
    fn from_str(text: &str) -> Result<Order, String> {
        let order = match text.split_once(':') {
            None => match text {
                "raster" => Some(Order::Raster),
                "columns" => Some(Order::Columns),
                "hilbert" => Some(Order::Hilbert),
                "stride" => Some(Order::Stride),
                _ => None,
            },
            Some(("tiles", side)) => side.parse().ok().filter(|&side| side > 0).map(Order::Tiles),
            Some(("shuffle", seed)) => seed.parse().ok().map(Order::Shuffle),
            Some(_) => None,
        };
        let expected = "raster, columns, tiles:N (N pixels a side), hilbert, stride or shuffle:SEED (a whole number)";
        order.ok_or_else(|| format!("expected {expected}"))
    }
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Order::Raster => f.write_str("raster"),
            Order::Columns => f.write_str("columns"),
            Order::Tiles(side) => write!(f, "tiles:{side}"),
            Order::Hilbert => f.write_str("hilbert"),
            Order::Stride => f.write_str("stride"),
            Order::Shuffle(seed) => write!(f, "shuffle:{seed}"),
        }
    }
}

impl TryFrom<String> for Order {
    type Error = String;

    fn try_from(text: String) -> Result<Order, String> {
        text.parse()
    }
}

impl From<Order> for String {
    fn from(order: Order) -> String {
        order.to_string()
    }
}

/// The numbers of things, in the order in which they are done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sequence {
    count: usize,
    /// `None` if they are done in the order of their numbers.
    numbers: Option<Vec<u32>>,
}

impl Sequence {
    /// The memory that it takes, in bytes.
    pub fn bytes(&self) -> u64 {
        self.numbers.as_ref().map_or(0, |numbers| size_of_val(&numbers[..]) as u64)
    }

    /// So many things in the order of their numbers.
    pub fn in_order(count: usize) -> Sequence {
        Sequence { count, numbers: None }
    }

    /// Some things, by their numbers.
    pub fn of_numbers(numbers: Vec<u32>) -> Sequence {
        Sequence { count: numbers.len(), numbers: Some(numbers) }
    }

    /// How many they are.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether they are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The number of the one in a place, from 0.
    #[inline]
    pub fn number(&self, place: usize) -> usize {
        self.numbers.as_ref().map_or(place, |numbers| numbers[place] as usize)
    }

    /// All numbers, in order.
    pub fn numbers(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.count).map(|place| self.number(place))
    }

    /// Puts what stands in the order of the numbers into this one.
    pub fn arrange<T: Copy>(&self, by_number: Vec<T>) -> Vec<T> {
        match &self.numbers {
            None => by_number,
            Some(numbers) => numbers.iter().map(|&number| by_number[number as usize]).collect(),
        }
    }

    /// Puts what stands in this order, one for each of all numbers, into the order of the numbers.
    pub fn by_number<T: Copy>(&self, arranged: &[T]) -> Vec<T> {
        let mut found = arranged.to_vec();
        for (number, thing) in self.numbers().zip(arranged) {
            found[number] = *thing;
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [(u32, u32); 9] = [(1, 1), (2, 1), (1, 7), (8, 8), (13, 7), (7, 13), (16, 64), (100, 3), (33, 32)];
    const ORDERS: [Order; 8] = [
        Order::Raster,
        Order::Columns,
        Order::Tiles(1),
        Order::Tiles(8),
        Order::Tiles(1000),
        Order::Hilbert,
        Order::Stride,
        Order::Shuffle(7),
    ];

    fn numbers(order: Order, width: u32, height: u32) -> Vec<usize> {
        order.of_pixels(ImageSize { width, height }).numbers().collect()
    }

    #[test]
    fn every_order_has_each_pixel_once_and_can_be_undone() {
        for order in ORDERS {
            for (width, height) in SIZES {
                let sequence = order.of_pixels(ImageSize { width, height });
                let mut all: Vec<usize> = sequence.numbers().collect();
                let arranged = sequence.arrange((0..all.len()).collect());
                assert_eq!(arranged, all, "{order} {width} x {height}");
                assert!(sequence.by_number(&arranged).into_iter().eq(0..all.len()), "{order} {width} x {height}");
                all.sort_unstable();
                assert!(all.into_iter().eq(0..sequence.len()), "{order} {width} x {height}");
            }
        }
    }

    #[test]
    fn small_images_by_hand() {
        assert_eq!(numbers(Order::Columns, 3, 2), [0, 3, 1, 4, 2, 5]);
        assert_eq!(numbers(Order::Tiles(2), 5, 3), [0, 1, 5, 6, 2, 3, 7, 8, 4, 9, 10, 11, 12, 13, 14]);
        assert_eq!(numbers(Order::Tiles(9), 5, 3), numbers(Order::Raster, 5, 3));
        // 8 / 1.618 = 4.9, and 5 has no divisor in common with 8.
        assert_eq!(numbers(Order::Stride, 4, 2), [0, 5, 2, 7, 4, 1, 6, 3]);
    }

    /// Steps of the curve lead to a pixel beside, above or below; outside the image, around which it leads, they are left out.
    #[test]
    fn hilberts_curve_goes_from_neighbour_to_neighbour() {
        for side in [2, 4, 32] {
            let curve = numbers(Order::Hilbert, side, side);
            assert_eq!(curve[0], 0);
            for step in curve.windows(2) {
                let [a, b] =
                    [step[0], step[1]].map(|number| (number as i64 % side as i64, number as i64 / side as i64));
                assert_eq!((a.0 - b.0).abs() + (a.1 - b.1).abs(), 1, "{side}: {a:?} {b:?}");
            }
        }
    }

    #[test]
    fn seeds_give_other_orders_and_the_same_one_again() {
        let of = |seed| numbers(Order::Shuffle(seed), 64, 64);
        assert_eq!(of(3), of(3));
        assert_ne!(of(3), of(4));
        // In a random order a number stays at its place but rarely: 1 of them on average.
        assert!(of(3).iter().enumerate().filter(|(place, number)| place == *number).count() < 8);
    }

    #[test]
    fn orders_are_read_as_they_are_written() {
        for order in ORDERS {
            assert_eq!(order.to_string().parse(), Ok(order));
        }
        for wrong in
            ["", "Raster", "tiles", "tiles:", "tiles:0", "tiles:-1", "tiles:2:3", "shuffle", "shuffle:x", "raster:1"]
        {
            assert!(wrong.parse::<Order>().unwrap_err().contains("tiles:N"), "{wrong}");
        }
    }

    #[test]
    fn a_list_has_no_pixels() {
        for order in ORDERS {
            let of_pixels = matches!(order, Order::Columns | Order::Tiles(_) | Order::Hilbert);
            assert_eq!(order.of_list(10).is_none(), of_pixels, "{order}");
        }
    }
}
