//! Operators with memory: the elements of the networks and of many classical laws.
//!
//! The output of a function depends on the present value of its input. The output of an *operator with
//! memory* depends on the past of its input too, through a state of one or two numbers. A weighted sum of
//! operators with different thresholds gives loops within loops.
//!
//! | operator | device | output | state | memory of |
//! |---|---|---|---|---|
//! | [`Relay`] | switch with two thresholds | -1 or +1 | its output | the threshold crossed last |
//! | [`Play`] | slider in a slot, backlash of gears | `p = min(x + r, max(x - r, p before))` | play `p` | turning points |
//! | [`Stop`] | spring and slider in series | `ε = x - p` | play `p` | turning points |
//! | [`DeterioratingStop`] | a stop that loses strength with its slip `s` | `ε max(0, 1 - s/(r β))` | play `p`, slip `s` | turning points and slip |
//! | [`Relaxation`] | spring and dashpot in series | stress `σ`, with `σ' = x' - σ/τ` | stress `σ`, last input | time |
//!
//! The first four are *rate-independent*: the output depends on the sequence of turning points of the input,
//! not on the speed. They implement [`Operator`]. The output of the relaxation element depends on time, so it
//! has methods of its own.
//!
//! Each module has its equation as free functions without branches, which the struct and the networks both
//! use.
//!
//! # Virgin state
//!
//! All operators start virgin (demagnetised): as if the input had always been 0 and then moved monotonically
//! to the first sample. This first movement counts as no slip. [`Operator::reset`] returns to the virgin
//! state.
//!
//! # Input that is not finite
//!
//! Inputs must be finite. Debug builds panic otherwise. In release builds such a sample gives NaN and leaves
//! the memory unchanged, so that later samples are not affected.

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

/// A rate-independent operator with memory, run one sample at a time.
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
    /// Returns to the virgin (demagnetised) state.
    fn reset(&mut self);

    /// Advances to the next sample `x`, which must be finite (see the [module](self)), and returns the output there.
    fn step(&mut self, x: f64) -> f64;

    /// Runs over a signal from the virgin state and returns the output at each sample.
    fn run(&mut self, x: &[f64]) -> Vec<f64> {
        self.reset();
        x.iter().map(|&x| self.step(x)).collect()
    }
}

/// Parameters with which no operator can be made, or times over which none can be run.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the message of each has its fields")]
pub enum InvalidOperator {
    /// The threshold of a relay, a stop or a deteriorating stop is not finite or not greater than 0.
    #[error("threshold r = {0}: it must be finite and greater than 0")]
    Threshold(f64),
    /// The threshold of a play is not finite or negative.
    #[error(
        "threshold r = {0} of a play: it must be finite and at least 0 (with 0 the play is the identity)"
    )]
    PlayThreshold(f64),
    /// The centre of a relay is not finite.
    #[error("centre s = {0}: it must be finite")]
    Centre(f64),
    /// The capacity of a deteriorating stop is not greater than 0.
    #[error("capacity beta = {0}: it must be greater than 0 (infinity: never deteriorates)")]
    Capacity(f64),
    /// The relaxation time is not greater than 0.
    #[error("relaxation time tau = {0}: it must be greater than 0 (infinity: a spring that never relaxes)")]
    RelaxationTime(f64),
    /// A time is smaller than that of the previous row.
    #[error("row {row}: time {time} follows {previous}: times must not decrease")]
    TimeDecreases {
        /// Index of the row, counted from 0.
        row: usize,
        previous: f64,
        time: f64,
    },
    /// A time is NaN or infinite.
    #[error("row {row}: time {time}: times must be finite")]
    TimeNotFinite {
        /// Index of the row, counted from 0.
        row: usize,
        time: f64,
    },
    /// The numbers of times and inputs differ.
    #[error("{times} times for {inputs} inputs: there must be one time for each input")]
    Lengths { times: usize, inputs: usize },
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

/// Whether the input may enter the memory (see the module documentation).
#[inline(always)]
fn is_usable(x: f64) -> bool {
    debug_assert!(x.is_finite(), "the input of an operator must be finite, not {x}");
    x.is_finite()
}
