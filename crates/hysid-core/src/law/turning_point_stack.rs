//! Memory by Madelung's rules: the turning points of the input that are not wiped out.
//!
//! ```text
//! 1. A branch is fixed by the turning point where it began.
//! 2. A branch that returns to the turning point before last continues as if the last two had not been.
//! 3. Beyond the first turning point, or its mirror image about 0, the virgin curve continues.
//!                                                                             theory.md (7.2)
//! ```
//!
//! The points that remain are the *dominant extrema*: the input of largest magnitude since the virgin state,
//! the furthest opposite extremum after it, the furthest opposite one after that, and so on to the present.

/// A turning point of the input with the value of the model there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningPoint<T> {
    /// Input, in its unit.
    pub x: f64,
    /// Value of the model there, such as its output.
    pub value: T,
}

/// The curve that the present point lies on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StackBranch<T> {
    /// The virgin curve: there is no turning point.
    Virgin,
    /// A branch that began at a turning point.
    From {
        /// Where it began.
        start: TurningPoint<T>,
        /// The beginning of the previous branch, to which this one leads; `None` if that is the virgin curve.
        before: Option<TurningPoint<T>>,
    },
}

/// The turning points of an input that are not wiped out, oldest first, and the present point.
///
/// Each sample is stored once and deleted at most once, so a step takes constant time on average. The storage
/// is that of as many points as loops are nested.
///
/// ```
/// use hysid_core::law::turning_point_stack::TurningPointStack;
/// let mut stack = TurningPointStack::default();
/// for x in [5.0, -3.0, 2.0, -1.0, 4.0] {
///     stack.advance(x, ());
/// }
/// // 2 and -1 were wiped out on the way to 4.
/// let turning: Vec<f64> = stack.points().iter().map(|point| point.x).collect();
/// assert_eq!(turning, [5.0, -3.0]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TurningPointStack<T> {
    points: Vec<TurningPoint<T>>,
    present: Option<TurningPoint<T>>,
}

impl<T> Default for TurningPointStack<T> {
    /// Virgin: the input has always been 0.
    fn default() -> Self {
        Self { points: Vec::new(), present: None }
    }
}

impl<T: Clone> TurningPointStack<T> {
    /// Advances to the next input, which must be finite. The present point becomes a turning point if the
    /// input turns there, and the points that the input passes are deleted. `value` is the value of the model
    /// at the new point; where it follows from the branch, [`TurningPointStack::set_value`] sets it.
    pub fn advance(&mut self, x: f64, value: T) {
        self.advance_with(x, value, |_| {});
    }

    /// As [`TurningPointStack::advance`]; calls `changed` after a point is added and before points are deleted.
    pub fn advance_with(&mut self, x: f64, value: T, mut changed: impl FnMut(StackChange<'_, T>)) {
        if let Some(present) = &self.present {
            if x == present.x {
                self.present = Some(TurningPoint { x, value });
                return;
            }
            let heads_up = match self.points.last() {
                Some(start) => present.x > start.x,
                None => present.x > 0.0,
            };
            // At rest at 0 the virgin curve goes both ways.
            let at_origin = self.points.is_empty() && present.x == 0.0;
            if heads_up != (x > present.x) && !at_origin {
                self.points.push(present.clone());
                changed(StackChange::PutDown(&self.points));
            }
        }
        loop {
            let wiped = match self.points.as_slice() {
                [] => 0,
                [first] => usize::from(x.abs() >= first.x.abs()), // (7.2), rule 3
                [.., before, start] => {
                    let closed = if before.x > start.x { x >= before.x } else { x <= before.x };
                    2 * usize::from(closed) // (7.2), rule 2
                }
            };
            if wiped == 0 {
                break;
            }
            changed(StackChange::WipedOut(&self.points, wiped));
            self.points.truncate(self.points.len() - wiped);
        }
        self.present = Some(TurningPoint { x, value });
    }

    /// Sets the value of the model at the present point.
    pub fn set_value(&mut self, value: T) {
        if let Some(present) = &mut self.present {
            present.value = value;
        }
    }

    /// The curve that the present point lies on.
    pub fn branch(&self) -> StackBranch<T> {
        match self.points.as_slice() {
            [] => StackBranch::Virgin,
            [start] => StackBranch::From { start: start.clone(), before: None },
            [.., before, start] => StackBranch::From { start: start.clone(), before: Some(before.clone()) },
        }
    }

    /// The turning points without the present point, oldest first; each lies between the two before it.
    pub fn points(&self) -> &[TurningPoint<T>] {
        &self.points
    }

    /// The present point; `None` before the first sample.
    pub fn present(&self) -> Option<&TurningPoint<T>> {
        self.present.as_ref()
    }
}

/// A change of the turning points on the way to a new input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StackChange<'a, T> {
    /// The last of these points was added.
    PutDown(&'a [TurningPoint<T>]),
    /// So many of these points, the last ones, are about to be deleted.
    WipedOut(&'a [TurningPoint<T>], usize),
}
