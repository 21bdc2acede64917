//! Random numbers that depend on integers alone: the same on every machine, and on any number of threads.

/// Scatters the bits of a number, as the generator splitmix64 does after each step.
pub(crate) fn scatter(number: u64) -> u64 {
    let a = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let b = (a ^ a >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let c = (b ^ b >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    c ^ c >> 31
}

/// The number that a seed gives to an item. Sorted by it, items are in a random order.
pub(crate) fn of_item(seed: u64, item: u64) -> u64 {
    scatter(item ^ scatter(seed))
}
