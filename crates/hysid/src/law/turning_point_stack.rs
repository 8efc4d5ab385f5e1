//! Memory by Madelung's rules: the turning points of the input that are not wiped out.
//!
//! ```text
//! 1. A branch is fixed by the turning point where it began.
//! 2. A branch that returns to the turning point before last goes on as if the two had not been.
//! 3. Beyond all turning points, or beyond the mirror image of the first, the virgin curve goes on.
//!                                                                             theory.md (7.2)
//! ```
//!
//! The points that remain are the *dominant extrema*: the input value of largest magnitude since the
//! virgin state, the furthest opposite extremum after it, the furthest opposite one after that, and so
//! on to the present.

/// A point of the path, with what the model knows there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningPoint<T> {
    /// Input.
    pub x: f64,
    /// What the model knows there, such as its output.
    pub value: T,
}

/// The curve that the present point lies on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Branch<T> {
    /// The virgin curve: no turning point is remembered.
    Virgin,
    /// A branch that began at a turning point.
    From {
        /// Where it began.
        start: TurningPoint<T>,
        /// Where the branch before began, which this one heads for; `None` if that is the virgin curve.
        before: Option<TurningPoint<T>>,
    },
}

/// The turning points of an input that are not wiped out, oldest first, and the present point.
///
/// Each sample is put down once and wiped out at most once, so that a step takes constant time on
/// average, however long the path. It takes memory for as many points as loops are nested.
///
/// ```
/// use hysid::law::turning_point_stack::TurningPointStack;
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
    /// Virgin: the input has rested at 0 for ever.
    fn default() -> Self {
        Self { points: Vec::new(), present: None }
    }
}

impl<T: Clone> TurningPointStack<T> {
    /// Moves to the next input, which must be finite: the present point is put down as a turning point
    /// if the input turns there, and what the input passes is wiped out. `value` is what the model knows
    /// at the new point; where it follows from the branch, [`TurningPointStack::set_value`] sets it.
    pub fn advance(&mut self, x: f64, value: T) {
        self.advance_with(x, value, |_| {});
    }

    /// [`TurningPointStack::advance`], telling of every change of the points: `changed` sees each point
    /// just put down, and the stack just before points are wiped out.
    pub fn advance_with(&mut self, x: f64, value: T, mut changed: impl FnMut(Change<'_, T>)) {
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
                changed(Change::PutDown(&self.points));
            }
        }
        loop {
            let wiped = match self.points.as_slice() {
                [] => 0,
                [first] => usize::from(x.abs() >= first.x.abs()),
                [.., before, start] => {
                    let closed = if before.x > start.x { x >= before.x } else { x <= before.x };
                    2 * usize::from(closed)
                }
            };
            if wiped == 0 {
                break;
            }
            changed(Change::WipedOut(&self.points, wiped));
            self.points.truncate(self.points.len() - wiped);
        }
        self.present = Some(TurningPoint { x, value });
    }

    /// Says what the model knows at the present point.
    pub fn set_value(&mut self, value: T) {
        if let Some(present) = &mut self.present {
            present.value = value;
        }
    }

    /// The curve that the present point lies on.
    pub fn branch(&self) -> Branch<T> {
        match self.points.as_slice() {
            [] => Branch::Virgin,
            [start] => Branch::From { start: start.clone(), before: None },
            [.., before, start] => Branch::From { start: start.clone(), before: Some(before.clone()) },
        }
    }

    /// The turning points, oldest first; each lies between the two before it. The present point is not
    /// among them.
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
pub enum Change<'a, T> {
    /// The last of these was put down.
    PutDown(&'a [TurningPoint<T>]),
    /// The last so many of these are about to be wiped out.
    WipedOut(&'a [TurningPoint<T>], usize),
}
