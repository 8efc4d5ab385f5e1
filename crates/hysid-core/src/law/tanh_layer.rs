//! A layer of tanh neurons and the sums of products it is made of, for laws that are recurrent networks.

use pulp::Simd;

use crate::network::tanh::tanh;
use crate::simd::multiply_add;

/// Neurons whose sums are formed together.
pub(super) const LANES: usize = 8;

/// `tanh(b + A inputs)`, from the weights of each input in turn; the first input is the constant.
#[inline(always)]
pub(super) fn layer<S: Simd>(weights: &[f64], inputs: &[f64], neurons: &mut [f64]) {
    let count = neurons.len();
    let mut first = 0;
    while first < count {
        if count >= LANES {
            // The last group overlaps the one before: its neurons are computed twice with the same result.
            let group = first.min(count - LANES);
            let mut sums = [0.0; LANES];
            sums.copy_from_slice(&weights[group..group + LANES]);
            for (k, &input) in inputs.iter().enumerate().skip(1) {
                let column = &weights[k * count + group..][..LANES];
                for l in 0..LANES {
                    sums[l] = multiply_add::<S>(column[l], input, sums[l]);
                }
            }
            for (neuron, sum) in neurons[group..group + LANES].iter_mut().zip(sums) {
                *neuron = tanh::<S>(sum);
            }
            first += LANES;
        } else {
            let mut sum = weights[first];
            for (k, &input) in inputs.iter().enumerate().skip(1) {
                sum = multiply_add::<S>(weights[k * count + first], input, sum);
            }
            neurons[first] = tanh::<S>(sum);
            first += 1;
        }
    }
}

/// Adds `Σ_k factor_k column_k`, with columns as long as `to`.
#[inline(always)]
pub(super) fn add_columns<S: Simd>(columns: &[f64], factors: &[f64], to: &mut [f64]) {
    for (column, &factor) in columns.chunks_exact(to.len()).zip(factors) {
        for (to, weight) in to.iter_mut().zip(column) {
            *to = multiply_add::<S>(*weight, factor, *to);
        }
    }
}

/// Scalar product, in partial sums that become SIMD code.
#[inline(always)]
pub(super) fn product<S: Simd>(a: &[f64], b: &[f64]) -> f64 {
    let (a, a_rest) = a.as_chunks::<LANES>();
    let (b, b_rest) = b.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for l in 0..LANES {
            sums[l] = multiply_add::<S>(a[l], b[l], sums[l]);
        }
    }
    let mut rest = 0.0;
    for (a, b) in a_rest.iter().zip(b_rest) {
        rest = multiply_add::<S>(*a, *b, rest);
    }
    let [p, q, r, s, t, u, v, w] = sums;
    ((p + t) + (q + u)) + ((r + v) + (s + w)) + rest
}

/// Adds `Σ_l factor_l row_l`, with rows as long as `to`, a multiple of [`LANES`].
#[inline(always)]
pub(super) fn add_multiples<S: Simd>(to: &mut [f64], factors: &[f64], rows: &[f64]) {
    let width = to.len();
    for (group, to) in to.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
        let mut sums = *to;
        for (l, &factor) in factors.iter().enumerate() {
            let row = &rows[l * width + LANES * group..][..LANES];
            for k in 0..LANES {
                sums[k] = multiply_add::<S>(factor, row[k], sums[k]);
            }
        }
        *to = sums;
    }
}

/// Adds a multiple of a row that is as long as `to`, a multiple of [`LANES`].
#[inline(always)]
pub(super) fn add_multiple<S: Simd>(to: &mut [f64], factor: f64, row: &[f64]) {
    for (to, row) in to.as_chunks_mut::<LANES>().0.iter_mut().zip(row.as_chunks::<LANES>().0) {
        for k in 0..LANES {
            to[k] = multiply_add::<S>(factor, row[k], to[k]);
        }
    }
}

/// Adds two multiples of rows that are as long as `to`, a multiple of [`LANES`].
#[inline(always)]
pub(super) fn add_two<S: Simd>(to: &mut [f64], factors: [f64; 2], rows: [&[f64]; 2]) {
    let (to, [first, second]) = (to.as_chunks_mut::<LANES>().0, rows.map(|row| row.as_chunks::<LANES>().0));
    for (to, (first, second)) in to.iter_mut().zip(first.iter().zip(second)) {
        for k in 0..LANES {
            to[k] = multiply_add::<S>(factors[1], second[k], multiply_add::<S>(factors[0], first[k], to[k]));
        }
    }
}
