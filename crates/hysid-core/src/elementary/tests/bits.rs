//! A checksum of the bits of many results: the same on every computer.

use super::*;
use crate::random::mix;

const COUNT: u64 = 100_000;

/// Arguments of all sizes, of moderate size, and any bits.
fn argument(k: u64) -> f64 {
    let bits = mix(k);
    let unit = (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
    match k % 4 {
        0 => f64::from_bits(bits),
        1 => 750.0 * unit,
        2 => 4.0 * unit,
        _ => unit * powi(2.0, (k / 4 % 120) as i32 - 80),
    }
}

fn checksum(function: impl Fn(u64) -> f64) -> u32 {
    let mut hash = crc32fast::Hasher::new();
    for k in 0..COUNT {
        let result = function(k);
        // The bits of NaN are not those of an operation.
        let result = if result.is_nan() { f64::NAN } else { result };
        hash.update(&result.to_bits().to_le_bytes());
    }
    hash.finalize()
}

#[test]
fn results_have_the_bits_of_every_computer() {
    let of_one = FUNCTIONS.map(|(name, function)| (name, checksum(|k| function(argument(k)))));
    let of_two = [("powf", powf as fn(f64, f64) -> f64), ("hypot", hypot)];
    let of_two =
        of_two.map(|(name, function)| (name, checksum(|k| function(argument(k).abs(), argument(k + COUNT)))));
    let found: Vec<(&str, u32)> = of_one.into_iter().chain(of_two).collect();
    assert_eq!(
        found,
        [
            ("exp", 0x3b81_12a1),
            ("exp_m1", 0xc9a5_20f6),
            ("ln", 0x35ac_25c5),
            ("ln_1p", 0x5e27_ecdc),
            ("tanh", 0xcd9c_e97d),
            ("sinh", 0x4039_2ea0),
            ("asinh", 0x6418_640d),
            ("sin", 0xa9d4_135a),
            ("cos", 0xcd1a_8fe3),
            ("powf", 0x710b_7c44),
            ("hypot", 0x0018_3b86),
        ]
    );
}

/// Those of the crate `libm` that are used here.
#[test]
fn rare_functions_have_the_bits_of_every_computer() {
    let functions: [(&str, Function); 9] = [
        ("acos", |x| acos(x % 1.0)),
        ("asin", |x| asin(x % 1.0)),
        ("atan", atan),
        ("atanh", |x| atanh(x % 1.0)),
        ("cbrt", cbrt),
        ("cosh", cosh),
        ("exp2", exp2),
        ("log2", log2),
        ("log10", log10),
    ];
    let mut found = functions.map(|(name, function)| (name, checksum(|k| function(argument(k))))).to_vec();
    found.push(("atan2", checksum(|k| atan2(argument(k), argument(k + COUNT)))));
    assert_eq!(
        found,
        [
            ("acos", 0x1a7c_739c),
            ("asin", 0x62bc_e472),
            ("atan", 0x336c_a032),
            ("atanh", 0xe8eb_fa9a),
            ("cbrt", 0x2e6f_3626),
            ("cosh", 0xfabf_8505),
            ("exp2", 0x52a0_f769),
            ("log2", 0xfafd_1917),
            ("log10", 0xd4cc_b4f4),
            ("atan2", 0x625e_4407),
        ]
    );
}
