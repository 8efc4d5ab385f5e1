//! A memory of turning points that nest (Madelung's rules): what a branch adds depends on its ends only.

/// How the output changes between two inputs.
pub trait Branches {
    /// Growth of the output on a branch between two inputs, `low <= high`, in either direction.
    fn growth(&self, low: f64, high: f64) -> f64;
}

/// Turning points and the output there. Mayergoyz, Mathematical Models of Hysteresis (1991), section 1.2.
pub struct Memory<B> {
    branches: B,
    /// Turning points that the input has not passed since; pairs of a virgin curve first.
    stack: Vec<(f64, f64)>,
    now: (f64, f64),
    /// True where the memory began at rest: the first branch is half as high as a later one over twice its length.
    virgin: bool,
}

impl<B: Branches> Memory<B> {
    /// At rest at 0.
    pub fn virgin(branches: B) -> Self {
        Self { branches, stack: Vec::new(), now: (0.0, 0.0), virgin: true }
    }

    /// Far below 0, where the output is at its lowest.
    pub fn saturated(branches: B, below: f64) -> Self {
        let half = 0.5 * branches.growth(below, -below);
        // A little above its turning point, so that the way to 0 is no reversal.
        Self { branches, stack: vec![(below, -half)], now: (0.999 * below, -half), virgin: false }
    }

    /// The output at an input that is reached from here, without going there.
    pub fn seen(&self, x: f64) -> f64 {
        self.course(x).1
    }

    /// Goes to an input.
    pub fn advance(&mut self, x: f64) -> f64 {
        if x == self.now.0 {
            return self.now.1;
        }
        let (stack, y) = self.course(x);
        (self.stack, self.now) = (stack, (x, y));
        y
    }

    fn reverses(&self, x: f64) -> bool {
        match self.stack.last() {
            Some(&(from, _)) => (x > self.now.0) != (self.now.0 > from),
            None => self.now.0 != 0.0 && (x > self.now.0) != (self.now.0 > 0.0),
        }
    }

    /// The turning points that remain at an input, and the output there.
    fn course(&self, x: f64) -> (Vec<(f64, f64)>, f64) {
        let mut points = self.stack.clone();
        if self.reverses(x) {
            if points.is_empty() {
                // The virgin curve reaches as far to the other side.
                points.push((-self.now.0, -self.now.1));
            }
            points.push(self.now);
        }
        let rises = x > self.now.0;
        while points.len() >= 2 {
            let before = points[points.len() - 2].0;
            let passed = if rises { x >= before } else { x <= before };
            if !passed {
                break;
            }
            points.truncate(points.len() - 2);
        }
        if self.virgin && points.len() == 1 {
            // Beyond the largest input so far the virgin curve continues.
            points.clear();
        }
        let y = self.output(points.last(), x);
        (points, y)
    }

    fn output(&self, from: Option<&(f64, f64)>, x: f64) -> f64 {
        match from {
            Some(&(from, y)) if x >= from => y + self.branches.growth(from, x),
            Some(&(from, y)) => y - self.branches.growth(x, from),
            None if self.virgin => x.signum() * 0.5 * self.branches.growth(-x.abs(), x.abs()),
            None => 0.0,
        }
    }
}
