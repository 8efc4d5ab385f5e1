//! Turning points with what was reached at each, ruled by Madelung's rules.

use serde::{Deserialize, Serialize};

/// A stack of turning points `(x, v)`. `v` is whatever the law keeps of a turning point.
///
/// The first is the virgin one at `x = 0`: from there the first branch begins, and a branch that passes
/// the mirror image of the first turning point at it is that first branch again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TurningPointMemory<V> {
    points: Vec<(f64, V)>,
    last: (f64, V),
    /// 1 upwards, -1 downwards, 0 before the input has moved.
    direction: f64,
}

impl<V: Clone> TurningPointMemory<V> {
    /// Only the virgin turning point, at input 0 with `v`.
    pub fn new(v: V) -> Self {
        Self { points: vec![(0.0, v.clone())], last: (0.0, v), direction: 0.0 }
    }

    /// Moves to the next input and gives the turning point from which the branch through it began.
    pub fn advance(&mut self, x: f64) -> &(f64, V) {
        let moved = x - self.last.0;
        if moved != 0.0 {
            let direction = moved.signum();
            if direction == -self.direction {
                self.points.push(self.last.clone());
            }
            self.direction = direction;
            self.last.0 = x;
            self.wipe_out(x, direction);
        }
        &self.points[self.points.len() - 1]
    }

    /// What was reached at the input last moved to.
    pub fn arrived(&mut self, v: V) {
        self.last.1 = v;
    }

    /// Number of turning points, the virgin one included.
    pub fn depth(&self) -> usize {
        self.points.len()
    }

    fn wipe_out(&mut self, x: f64, direction: f64) {
        while self.points.len() >= 3 {
            // The branch began at the last turning point; the one before it is passed, and so the loop
            // between the two is closed. The virgin point, which is none, is not passed.
            let before = self.points.len() - 2;
            if direction * (x - self.points[before].0) < 0.0 {
                return;
            }
            self.points.truncate(before);
        }
        if let [virgin, first] = self.points.as_slice()
            && direction * (x - virgin.0) >= direction * (virgin.0 - first.0)
        {
            self.points.truncate(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn depth_after(path: &[f64]) -> usize {
        let mut memory = TurningPointMemory::new(());
        path.iter().for_each(|&x| {
            memory.advance(x);
        });
        memory.depth()
    }

    #[test]
    fn closed_loops_are_forgotten() {
        assert_eq!(depth_after(&[1.0]), 1);
        assert_eq!(depth_after(&[1.0, 0.2]), 2);
        assert_eq!(depth_after(&[1.0, 0.2, 0.6]), 3);
        assert_eq!(depth_after(&[1.0, 0.2, 0.6, 0.4]), 4);
        assert_eq!(depth_after(&[1.0, 0.2, 0.6, 0.4, 0.61]), 3);
        assert_eq!(depth_after(&[1.0, 0.2, 0.6, 0.4, 0.1]), 2);
        assert_eq!(depth_after(&[1.0, 0.2, 0.6, 0.4, 1.0]), 1);
        // The mirror image of the first turning point.
        assert_eq!(depth_after(&[1.0, -0.9]), 2);
        assert_eq!(depth_after(&[1.0, -1.0]), 1);
        assert_eq!(depth_after(&[1.0, -0.5, 0.8, -1.2]), 1);
    }

    #[test]
    fn a_branch_knows_where_it_began() {
        let mut memory = TurningPointMemory::new(10.0);
        for (x, v) in [(0.5, 11.0), (1.0, 12.0)] {
            assert_eq!(*memory.advance(x), (0.0, 10.0));
            memory.arrived(v);
        }
        assert_eq!(*memory.advance(0.3), (1.0, 12.0));
        memory.arrived(13.0);
        assert_eq!(*memory.advance(0.3), (1.0, 12.0));
        assert_eq!(*memory.advance(0.7), (0.3, 13.0));
    }
}
