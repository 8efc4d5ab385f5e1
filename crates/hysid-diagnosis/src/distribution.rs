//! Tails of the distributions of test statistics: chi-square, Student's t and Fisher's F.
//!
//! ```text
//! P(χ²_k > x)     = Q(k/2, x/2)                     regularised incomplete gamma function
//! P(F_{m,n} > f)  = I_z(n/2, m/2),  z = n/(n + m f) regularised incomplete beta function
//! P(|t_n| > t)    = P(F_{1,n} > t²)
//! ```
//!
//! The series and continued fractions are those of the NIST Digital Library of Mathematical Functions (8.7.1, 8.9.2,
//! 8.17.22), the logarithm of the gamma function is the approximation of Lanczos (1964).

use hysid_core::elementary::{exp, ln, ln_1p, sin};

/// Largest number of terms of a series or continued fraction.
const TERMS: usize = 20_000;

/// Relative change below which a series or fraction has converged.
const PRECISION: f64 = 1e-15;

/// Stands in for a denominator of 0 in a continued fraction.
const TINY: f64 = 1e-300;

/// The probability that a chi-square number with `degrees` degrees of freedom exceeds `x`.
pub fn chi_square_tail(x: f64, degrees: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let (a, x) = (0.5 * degrees, 0.5 * x);
    let factor = exp(a * ln(x) - x - ln_gamma(a));
    let tail = if x < a + 1.0 { 1.0 - factor * lower_gamma(a, x) } else { factor * upper_gamma(a, x) };
    tail.clamp(0.0, 1.0)
}

/// The probability that an F number with `above` and `below` degrees of freedom exceeds `f`.
pub fn f_tail(f: f64, above: f64, below: f64) -> f64 {
    if f <= 0.0 {
        return 1.0;
    }
    incomplete_beta(0.5 * below, 0.5 * above, below / (below + above * f))
}

/// The probability that the magnitude of a t number with `degrees` degrees of freedom exceeds `t`.
pub fn t_tail(t: f64, degrees: f64) -> f64 {
    f_tail(t * t, 1.0, degrees)
}

/// The magnitude that a t number with `degrees` degrees of freedom exceeds with the given probability.
pub fn t_quantile(probability: f64, degrees: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while t_tail(high, degrees) > probability && high < 1e12 {
        high *= 2.0;
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if t_tail(middle, degrees) > probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Logarithm of the gamma function of a positive number, to 15 digits.
fn ln_gamma(z: f64) -> f64 {
    const G: f64 = 7.0;
    const COEFFICIENTS: [f64; 9] = [
        0.999_999_999_999_809_9,
        676.520_368_121_885_1,
        -1_259.139_216_722_402_8,
        771.323_428_777_653_1,
        -176.615_029_162_140_6,
        12.507_343_278_686_905,
        -0.138_571_095_265_720_12,
        9.984_369_578_019_572e-6,
        1.505_632_735_149_311_6e-7,
    ];
    if z < 0.5 {
        // Reflection.
        let pi = std::f64::consts::PI;
        return ln(pi / sin(pi * z)) - ln_gamma(1.0 - z);
    }
    let z = z - 1.0;
    let terms = COEFFICIENTS.iter().enumerate().skip(1).map(|(i, c)| c / (z + i as f64));
    let sum = COEFFICIENTS[0] + terms.sum::<f64>();
    let t = z + G + 0.5;
    0.5 * ln(2.0 * std::f64::consts::PI) + (z + 0.5) * ln(t) - t + ln(sum)
}

/// Series of the lower incomplete gamma function over `x^a e^{-x} / Γ(a)`.
fn lower_gamma(a: f64, x: f64) -> f64 {
    let (mut term, mut sum) = (1.0 / a, 1.0 / a);
    for n in 1..TERMS {
        term *= x / (a + n as f64);
        sum += term;
        if term < PRECISION * sum {
            break;
        }
    }
    sum
}

/// Continued fraction of the upper incomplete gamma function over the same, by the method of Lentz.
fn upper_gamma(a: f64, x: f64) -> f64 {
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1.0 / TINY, 1.0 / b);
    let mut fraction = d;
    for n in 1..TERMS {
        let n = n as f64;
        let numerator = -n * (n - a);
        b += 2.0;
        d = 1.0 / apart(numerator * d + b);
        c = apart(b + numerator / c);
        fraction *= c * d;
        if (c * d - 1.0).abs() < PRECISION {
            break;
        }
    }
    fraction
}

/// Regularised incomplete beta function `I_x(a, b)`.
fn incomplete_beta(a: f64, b: f64, x: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    let factor = exp(ln_gamma(a + b) - ln_gamma(a) - ln_gamma(b) + a * ln(x) + b * ln_1p(-x));
    let value = if x < (a + 1.0) / (a + b + 2.0) {
        factor * beta_fraction(a, b, x) / a
    } else {
        1.0 - factor * beta_fraction(b, a, 1.0 - x) / b
    };
    value.clamp(0.0, 1.0)
}

/// Continued fraction of the incomplete beta function, by the method of Lentz.
fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
    let (mut c, mut d) = (1.0, 1.0 / apart(1.0 - (a + b) * x / (a + 1.0)));
    let mut fraction = d;
    for m in 1..TERMS {
        let m = m as f64;
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / apart(1.0 + even * d);
        c = apart(1.0 + even / c);
        fraction *= c * d;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / apart(1.0 + odd * d);
        c = apart(1.0 + odd / c);
        fraction *= c * d;
        if (c * d - 1.0).abs() < PRECISION {
            break;
        }
    }
    fraction
}

fn apart(value: f64) -> f64 {
    if value.abs() < TINY { TINY } else { value }
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::powf;

    use super::*;

    /// Abramowitz and Stegun, tables 26.8 and 26.10, and the NIST/SEMATECH handbook, section 1.3.6.7.
    #[test]
    fn tails_are_those_of_the_tables() {
        for (x, degrees, tail) in
            [(3.841_46, 1.0, 0.05), (18.307_0, 10.0, 0.05), (37.566_2, 20.0, 0.01), (124.342, 100.0, 0.05)]
        {
            approx::assert_relative_eq!(chi_square_tail(x, degrees), tail, max_relative = 2e-5);
        }
        for (f, above, below, tail) in [
            (4.964_6, 1.0, 10.0, 0.05),
            (3.490_3, 3.0, 12.0, 0.05),
            (5.953, 3.0, 12.0, 0.01),
            (2.347, 5.0, 84.0, 0.048),
        ] {
            approx::assert_relative_eq!(f_tail(f, above, below), tail, max_relative = 5e-3);
        }
        for (t, degrees) in [(12.706_2, 1.0), (2.228_14, 10.0), (2.042_27, 30.0), (1.962_34, 1000.0)] {
            approx::assert_relative_eq!(t_quantile(0.05, degrees), t, max_relative = 5e-6);
        }
    }

    /// A chi-square number of two degrees of freedom is exponential, one of four has a closed tail.
    #[test]
    fn tails_are_exact_where_there_is_a_closed_form() {
        for x in [0.01, 0.7, 3.0, 40.0, 700.0] {
            approx::assert_relative_eq!(chi_square_tail(x, 2.0), exp(-0.5 * x), max_relative = 1e-12);
            let of_four = (1.0 + 0.5 * x) * exp(-0.5 * x);
            approx::assert_relative_eq!(chi_square_tail(x, 4.0), of_four, max_relative = 1e-10);
        }
        // P(F_{2,n} > f) = (1 + 2 f/n)^{-n/2}.
        for (f, n) in [(0.3, 7.0f64), (4.0, 30.0), (9.0, 1500.0)] {
            let exact = powf(1.0 + 2.0 * f / n, -0.5 * n);
            approx::assert_relative_eq!(f_tail(f, 2.0, n), exact, max_relative = 1e-10);
        }
        assert_eq!((chi_square_tail(0.0, 3.0), f_tail(-1.0, 1.0, 5.0)), (1.0, 1.0));
        assert!(chi_square_tail(1e6, 30.0) >= 0.0 && chi_square_tail(1e6, 30.0) < 1e-300);
    }
}
