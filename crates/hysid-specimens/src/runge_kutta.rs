//! The classical Runge-Kutta method of fourth order.

/// The state one step `h` later. `slope` gives the rate of the state at a share of the step from 0 to 1.
pub(super) fn step<const N: usize>(
    state: [f64; N],
    h: f64,
    slope: impl Fn(f64, [f64; N]) -> [f64; N],
) -> [f64; N] {
    let along = |by: f64, rate: [f64; N]| std::array::from_fn(|i| state[i] + by * rate[i]);
    let k1 = slope(0.0, state);
    let k2 = slope(0.5, along(0.5 * h, k1));
    let k3 = slope(0.5, along(0.5 * h, k2));
    let k4 = slope(1.0, along(h, k3));
    std::array::from_fn(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

#[cfg(test)]
mod tests {
    use hysid_core::elementary::powi;

    use super::*;

    /// In one step `x' = x` gives the first five terms of the exponential series; a rate that is a cubic of time is
    /// integrated exactly.
    #[test]
    fn a_step_is_exact_to_fourth_order() {
        let h = 0.3f64;
        let [x, y] = step([1.0, 0.0], h, |share, [x, _]| [x, 4.0 * powi(share * h, 3)]);
        let series = 1.0 + h + h * h / 2.0 + powi(h, 3) / 6.0 + powi(h, 4) / 24.0;
        assert!((x - series).abs() < 1e-15 && (y - powi(h, 4)).abs() < 1e-15, "{x} {y}");
    }
}
