//! The elementary functions of exports to C have the results of those of `hysid-core`, bit for bit.

use std::fs;
use std::process::Command;

use hysid_core::elementary::{asinh, exp, exp_m1, hypot, ln, ln_1p, powf, powi, tanh};
use hysid_core::random::{mix, uniform};
use hysid_export::all_elementary_functions;
use tempfile::TempDir;

use super::c::{STRICT, compilers};
use super::tools::succeeds;

const ARGUMENTS: u64 = 1_000_000;

type Function = fn(f64, f64) -> f64;

const FUNCTIONS: [(&str, Function); 8] = [
    ("hysid_exp(a)", |a, _| exp(a)),
    ("hysid_exp_m1(a)", |a, _| exp_m1(a)),
    ("hysid_ln(a)", |a, _| ln(a)),
    ("hysid_ln_1p(a)", |a, _| ln_1p(a)),
    ("hysid_tanh(a)", |a, _| tanh(a)),
    ("hysid_asinh(a)", |a, _| asinh(a)),
    ("hysid_hypot(a, b)", hypot),
    ("hysid_powf(a, b)", powf),
];

const SPECIAL: [f64; 30] = [
    0.0,
    1.0,
    2.0,
    3.0,
    0.5,
    1.5,
    -1.0,
    1e-300,
    5e-324,
    f64::MIN_POSITIVE,
    f64::MAX,
    f64::INFINITY,
    f64::NAN,
    1.0 + f64::EPSILON,
    1.0 - 0.5 * f64::EPSILON,
    0.171875,
    3e-9,
    5e-17,
    20.0,
    40.0,
    50.0,
    709.782712893384,
    709.7827128933841,
    745.1332191019411,
    745.1332191019412,
    1e9,
    1e18,
    0.7109375,
    9_007_199_254_740_991.0,
    9_007_199_254_740_993.0,
];

/// All pairs of special numbers with both signs, and then pairs of random bits, of all sizes, and of moderate size.
fn arguments() -> Vec<[f64; 2]> {
    let special: Vec<f64> = SPECIAL.iter().flat_map(|value| [*value, -value]).collect();
    let mut arguments: Vec<[f64; 2]> =
        special.iter().flat_map(|a| special.iter().map(move |b| [*a, *b])).collect();
    let unit = |seed: u64| 2.0 * uniform(seed) - 1.0;
    for k in 0..ARGUMENTS {
        arguments.push(match k % 4 {
            0 => [f64::from_bits(mix(2 * k)), f64::from_bits(mix(2 * k + 1))],
            1 => [unit(2 * k) * powi(2.0, (k / 4 % 120) as i32 - 60), 40.0 * unit(2 * k + 1)],
            2 => [1.0 + 0.3 * unit(2 * k), 1000.0 * unit(2 * k + 1)],
            _ => [750.0 * unit(2 * k), 3.0 * unit(2 * k + 1)],
        });
    }
    arguments
}

fn program() -> String {
    let calls: String = FUNCTIONS
        .iter()
        .enumerate()
        .map(|(k, (call, _))| format!("        results[{k}] = {call};\n"))
        .collect();
    format!(
        "#include <math.h>
#include <stdint.h>
#include <stdio.h>
{}int main(void)
{{
    double row[2], results[{}];
    while (fread(row, sizeof(double), 2, stdin) == 2) {{
        const double a = row[0], b = row[1];
{calls}        fwrite(results, sizeof results, 1, stdout);
    }}
    return 0;
}}
",
        all_elementary_functions(),
        FUNCTIONS.len()
    )
}

#[test]
fn elementary_functions_equal_those_of_the_library_to_the_last_bit() {
    let arguments = arguments();
    let folder = TempDir::new().unwrap();
    let rows: Vec<u8> = arguments.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
    fs::write(folder.path().join("rows"), rows).unwrap();
    fs::write(folder.path().join("functions.c"), program()).unwrap();
    for compiler in compilers() {
        for level in ["-O2", "-O3"] {
            let files = [level, "functions.c", "-lm", "-o", "functions"];
            succeeds(Command::new(&compiler).current_dir(folder.path()).args(STRICT).args(files));
            let input = fs::File::open(folder.path().join("rows")).unwrap();
            let output = succeeds(Command::new(folder.path().join("functions")).stdin(input));
            let found = output.stdout.as_chunks::<8>().0;
            assert_eq!(found.len(), FUNCTIONS.len() * arguments.len());
            for (found, [a, b]) in found.chunks_exact(FUNCTIONS.len()).zip(&arguments) {
                for (found, (call, function)) in found.iter().zip(FUNCTIONS) {
                    let (found, expected) = (f64::from_le_bytes(*found), function(*a, *b));
                    let is_equal =
                        found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan());
                    assert!(
                        is_equal,
                        "{compiler} {level}, {call} of {a:e}, {b:e}: {found:e}, not {expected:e}"
                    );
                }
            }
        }
    }
}
