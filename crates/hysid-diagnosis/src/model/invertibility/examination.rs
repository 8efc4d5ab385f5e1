//! The scans of a model after many pasts, with steps of many lengths.

use hysid_core::elementary::powi;
use hysid_core::error::Result;
use hysid_core::model::Stepper;

use super::EFFECT;
use super::pasts::{ModelPast, PastPath, drive, ways};
use super::scan::Scan;
use crate::model::probe::{Probe, STEPS, extent};
use crate::model::properties::PROTOCOL;

/// Time steps after pasts at the middle speed: that of the probe times two to these powers.
const DOUBLINGS: std::ops::RangeInclusive<i32> = -5..=8;

/// Inputs of a scan of the whole range, and of one of many with different time steps.
const POINTS: usize = 65;
const FEWER_POINTS: usize = 33;
const LEAST_POINTS: usize = 9;

/// A window that leaves out less than this share of the trained range is whole.
const WHOLE: f64 = 1e-9;

#[derive(Debug)]
pub(super) struct ExaminedScan {
    pub past: usize,
    /// Time to the next sample; `None` for a model without time, and before the first sample.
    pub time_step: Option<f64>,
    /// Whether the scan covers the whole trained range.
    pub is_whole: bool,
    pub scan: Scan,
}

/// All scans of a model.
#[derive(Debug)]
pub(super) struct Examination {
    pub pasts: Vec<ModelPast>,
    pub scans: Vec<ExaminedScan>,
    /// Largest less smallest output of the protocol.
    pub range: f64,
    /// Time step of the probe at the fastest speed. Shorter ones do not decide.
    pub fastest_step: f64,
}

/// A speed of pasts, and the time steps after them.
struct ProbePace {
    speed: f64,
    time_steps: Vec<f64>,
    is_worn: bool,
}

impl Examination {
    pub fn of(probe: &Probe) -> Result<Self> {
        let protocol = probe.path(&PROTOCOL).x;
        let range = [probe.speeds.middle, probe.speeds.vanishing]
            .iter()
            .map(|&speed| probe.run("protocol", &protocol, speed).map(|record| extent(record.output())))
            .try_fold(0.0, |largest, range| range.map(|range| f64::max(largest, range)))?;
        let mut examination = Self {
            pasts: Vec::new(),
            scans: Vec::new(),
            range,
            fastest_step: row(probe, probe.speeds.tried()[3]),
        };
        let mut stepper = probe.model.stepper();
        let virgin = ModelPast {
            path: "initial state",
            row: None,
            time: 0.0,
            input: probe.origin(),
            turning_points: vec![],
        };
        examination.take(probe, &mut stepper, virgin, &[])?;
        for pace in paces(probe) {
            for way in &ways(pace.is_worn) {
                examination.along(probe, &mut stepper, way, &pace)?;
            }
        }
        Ok(examination)
    }

    fn along<'m>(
        &mut self,
        probe: &Probe<'m>,
        stepper: &mut Stepper<'m>,
        way: &PastPath,
        pace: &ProbePace,
    ) -> Result<()> {
        drive(probe, stepper, way, pace.speed, &mut |stepper, past| {
            self.take(probe, stepper, past, &pace.time_steps)
        })
    }

    /// Scans after a past, with each of the time steps; without any at the first sample.
    fn take<'m>(
        &mut self,
        probe: &Probe<'m>,
        stepper: &mut Stepper<'m>,
        past: ModelPast,
        time_steps: &[f64],
    ) -> Result<()> {
        let (low, high) = (probe.centre - probe.half, probe.centre + probe.half);
        let whole = (low, high);
        let fastest = probe.model.rate().map(|_| probe.speeds.tried()[3]);
        let mut inputs = probe.inputs(past.input);
        let first = [None];
        let steps: Vec<Option<f64>> = time_steps.iter().copied().map(Some).collect();
        for &time_step in if steps.is_empty() { &first[..] } else { &steps } {
            let window = match (fastest, time_step) {
                // No faster than trained.
                (Some(fastest), Some(step)) => {
                    ((past.input - fastest * step).max(low), (past.input + fastest * step).min(high))
                }
                _ => whole,
            };
            let time = past.time + time_step.unwrap_or(0.0);
            let least = EFFECT * self.range;
            let points = if time_steps.len() > 1 { FEWER_POINTS } else { POINTS };
            // Fewer, as on the paths, of a model whose steps need much work.
            let points = (points * probe.steps as usize / STEPS as usize).max(LEAST_POINTS);
            let scan = Scan::of(window, points, past.input, least, &mut |x| {
                inputs[0] = x;
                stepper.trial(&inputs, time, None)
            })?;
            let is_whole = scan.width() >= (1.0 - WHOLE) * (high - low);
            let time_step = time_step.filter(|_| probe.speeds.matter());
            self.scans.push(ExaminedScan { past: self.pasts.len(), time_step, is_whole, scan });
        }
        stepper.revert();
        self.pasts.push(past);
        Ok(())
    }
}

/// Time between the rows of a path.
fn row(probe: &Probe, speed: f64) -> f64 {
    probe.half / f64::from(probe.steps) / speed
}

fn paces(probe: &Probe) -> Vec<ProbePace> {
    let speeds = &probe.speeds;
    let middle = row(probe, speeds.middle);
    if !speeds.matter() {
        return vec![ProbePace { speed: speeds.middle, time_steps: vec![middle], is_worn: true }];
    }
    let steps = DOUBLINGS.map(|power| middle * powi(2.0, power)).collect();
    let own = |speed: f64| ProbePace { speed, time_steps: vec![row(probe, speed)], is_worn: false };
    vec![
        own(speeds.vanishing),
        ProbePace { speed: speeds.middle, time_steps: steps, is_worn: true },
        own(speeds.tried()[3]),
    ]
}
