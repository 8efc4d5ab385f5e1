//! Reproducible pseudo-random numbers.

/// A fixed hash (splitmix) in which every bit depends on every bit.
pub fn mix(value: u64) -> u64 {
    let value = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let value = (value ^ (value >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let value = (value ^ (value >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    value ^ (value >> 31)
}

/// A number from 0 to 1, from [`mix`].
pub fn uniform(value: u64) -> f64 {
    mix(value) as f64 / u64::MAX as f64
}
