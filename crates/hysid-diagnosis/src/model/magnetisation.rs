//! Initial and anhysteretic curve of a model: from the virgin state to the ends of its trained range, and where oscillations
//! about each input end that decay to nothing.

use hysid_core::error::Result;

use super::probe::Probe;

/// Inputs to each side of the middle.
const NODES: i32 = 20;

/// Half oscillations about each input, of amplitudes that fall evenly from half the range to nothing.
const OSCILLATIONS: i32 = 40;

/// Outputs at an input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MagnetisationNode {
    /// The input.
    pub input: f64,
    /// Output on the way from the virgin state.
    pub initial: f64,
    /// Output after oscillations that decay, the mean of those that begin upwards and downwards. They stay within the trained
    /// range.
    pub anhysteretic: f64,
}

/// The curves at equal distances over the trained range, for a model whose range extends to both sides of its virgin state.
pub(super) fn curves(probe: &Probe) -> Result<Vec<MagnetisationNode>> {
    let outputs = |turning: &[f64]| -> Result<(Vec<f64>, Vec<usize>)> {
        let path = probe.path(turning);
        Ok((probe.run_slowly("curve", &path.x)?.output().to_vec(), path.turns))
    };
    let share = |node: i32| f64::from(node) / f64::from(NODES);
    // The turns of a path that never turns back are its nodes.
    let away = |sign: f64| outputs(&(0..=NODES).map(|node| sign * share(node)).collect::<Vec<f64>>());
    let sides = [away(-1.0)?, away(1.0)?];
    let decayed = |about: f64, sign: f64| -> Result<f64> {
        let amplitude = |k: i32| f64::from(OSCILLATIONS - k) / f64::from(OSCILLATIONS);
        let turn =
            |k: i32| (about + sign * if k % 2 == 0 { amplitude(k) } else { -amplitude(k) }).clamp(-1.0, 1.0);
        let turning: Vec<f64> =
            std::iter::once(0.0).chain((0..OSCILLATIONS).map(turn)).chain([about]).collect();
        Ok(outputs(&turning)?.0.last().copied().unwrap_or(f64::NAN))
    };
    let node = |node: i32| -> Result<MagnetisationNode> {
        let (output, turns) = &sides[usize::from(node >= 0)];
        let about = share(node);
        Ok(MagnetisationNode {
            input: probe.centre + probe.half * about,
            initial: output[turns[node.unsigned_abs() as usize]],
            anhysteretic: 0.5 * (decayed(about, 1.0)? + decayed(about, -1.0)?),
        })
    };
    (-NODES..=NODES).map(node).collect()
}
