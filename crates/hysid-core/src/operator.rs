//! Operators with memory: the elements every hysteresis model here is built from.
//!
//! A function answers to the present input. An *operator with memory* answers to the present input
//! and to what it has seen before, kept in a state of one or two numbers. Put many of them side by
//! side, with different thresholds, add up their outputs, and loops within loops appear.
//!
//! | operator | picture | state | equation | remembers |
//! |---|---|---|---|---|
//! | [`Relay`] | switch with two thresholds | output, -1 or +1 | theory.md (1.1) | the last threshold crossed |
//! | [`Play`] | slider in a slot, backlash of gears | play `p` | theory.md (1.2) | turning points |
//! | [`Stop`] | spring and slider in series | play `p` | theory.md (1.3) | turning points |
//! | [`DeterioratingStop`] | a stop that wears out by sliding | play `p`, slip `s` | theory.md (1.6) | turning points and the way slid |
//! | [`Relaxation`] | spring and dashpot in series | stress `σ`, last input | theory.md (1.10) | time |
//!
//! The first four are *rate independent*: only the sequence of turning points of the input counts,
//! not how fast it is passed through. They implement [`Operator`]. The last one lives in time and
//! has methods of its own.
//!
//! Each file has the pure formula as free functions (branch-free, for loops over many neurons that
//! the compiler vectorises), which the struct of that file uses too: a formula is written once.
//!
//! # Virgin state
//!
//! All operators start virgin (demagnetised): as if the input had rested at 0 for ever and the
//! first sample were a jump from there (which slips nothing). [`Operator::reset`] returns to it.
//!
//! # Input that is not finite
//!
//! Inputs must be finite. Debug builds panic otherwise. In release builds such a sample gives NaN
//! and leaves the memory exactly as it was, so one bad sample does not poison those that follow.

pub mod deteriorating_stop;
pub mod play;
pub mod relaxation;
pub mod relay;
pub mod stop;

pub use deteriorating_stop::DeterioratingStop;
pub use play::Play;
pub use relaxation::Relaxation;
pub use relay::Relay;
pub use stop::Stop;

/// A rate-independent operator with memory, fed one sample at a time.
///
/// ```
/// use hysid_core::operator::{Operator, Play, Stop};
/// # fn main() -> Result<(), hysid_core::operator::InvalidOperator> {
/// let play = Box::new(Play::new(1.0)?) as Box<dyn Operator>;
/// let stop = Box::new(Stop::new(1.0)?);
/// let outputs = [play, stop].map(|mut operator| operator.run(&[0.0, 3.0, 0.0]));
/// assert_eq!(outputs, [[0.0, 2.0, 1.0], [0.0, 1.0, -1.0]]);
/// # Ok(())
/// # }
/// ```
pub trait Operator {
    /// Back to the virgin (demagnetised) state, as if no input had been seen.
    fn reset(&mut self);

    /// Takes the next input sample and returns the output there. `x` must be finite (see the
    /// [module](self)).
    fn step(&mut self, x: f64) -> f64;

    /// The outputs at all samples of a whole signal from the virgin state: resets first, and leaves
    /// the operator in the state after the last sample.
    fn run(&mut self, x: &[f64]) -> Vec<f64> {
        self.reset();
        x.iter().map(|&x| self.step(x)).collect()
    }
}

/// Why an operator cannot be made with these parameters, or cannot be run over these times.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidOperator {
    /// Threshold of a relay, a stop or a deteriorating stop.
    #[error("threshold r = {0}: it must be finite and greater than 0")]
    Threshold(f64),
    /// Threshold of a play.
    #[error(
        "threshold r = {0} of a play: it must be finite and at least 0 (with 0 the play is the identity)"
    )]
    PlayThreshold(f64),
    /// Centre of a relay.
    #[error("centre s = {0}: it must be finite")]
    Centre(f64),
    /// Capacity of a deteriorating stop.
    #[error("capacity beta = {0}: it must be greater than 0 (infinity: never deteriorates)")]
    Capacity(f64),
    /// Relaxation time.
    #[error("relaxation time tau = {0}: it must be greater than 0 (infinity: a spring that never relaxes)")]
    RelaxationTime(f64),
    /// A time that lies before the one of the previous row. Rows count from 0.
    #[error("row {row}: time {time} follows {previous}: times must not decrease")]
    TimeDecreases {
        /// Index of the row, counted from 0.
        row: usize,
        /// Time of the row before.
        previous: f64,
        /// Time of this row.
        time: f64,
    },
    /// A time that is NaN or infinite. Rows count from 0.
    #[error("row {row}: time {time}: times must be finite")]
    TimeNotFinite {
        /// Index of the row, counted from 0.
        row: usize,
        /// Time of this row.
        time: f64,
    },
    /// Different numbers of times and inputs.
    #[error("{times} times for {inputs} inputs: there must be one time for each input")]
    Lengths {
        /// Number of times.
        times: usize,
        /// Number of inputs.
        inputs: usize,
    },
}

impl From<InvalidOperator> for crate::Error {
    fn from(error: InvalidOperator) -> Self {
        Self::Parts(error.to_string())
    }
}

/// `r` itself if it is finite and greater than 0.
fn checked_threshold(r: f64) -> Result<f64, InvalidOperator> {
    if r.is_finite() && r > 0.0 { Ok(r) } else { Err(InvalidOperator::Threshold(r)) }
}

/// Whether the input may enter the memory; see "Input that is not finite" in the module
/// documentation.
#[inline(always)]
fn is_usable(x: f64) -> bool {
    debug_assert!(x.is_finite(), "the input of an operator must be finite, not {x}");
    x.is_finite()
}
