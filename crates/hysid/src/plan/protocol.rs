//! First protocols, for specimens that were not measured yet.

use hysid_core::elementary::{exp, ln, powi};

use super::limits::{LimitOptions, Limits};
use super::path::{DrivePath, Leg, Wave};
use super::segment::SegmentKind;
use super::{Plan, drive::DriveRows, time};
use crate::data::record::ColumnNames;
use crate::error::{Error, OptionError, Result};

/// Rows of a protocol for which neither rows nor a rate are given.
const ROWS: usize = 2000;

/// A kind of specimen with a first protocol.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Protocol {
    /// Members, joints and connections of structures, metals: quasi-static cycles of rising amplitude.
    Structure,
    /// Dampers and bearings: amplitudes at several speeds.
    Damper,
    /// Rubber and other elastomers: conditioning, amplitudes at several speeds, holds.
    Rubber,
    /// Actuators (piezo, shape memory, magnetostrictive): reversal curves, minor loops, speeds, holds.
    Actuator,
    /// Magnets and ferroelectrics: loops of rising amplitude, reversal curves.
    Magnet,
}

/// Options of a protocol for a specimen without data.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ProtocolOptions {
    /// Limits; the range is needed.
    pub limits: LimitOptions,
    /// Shape of swings; smooth with a time step and triangles without if `None`.
    pub wave: Option<Wave>,
}

/// A piece of a protocol: legs between levels from -1 to 1, where 0 is the start and ±1 are the ends of the range.
struct ProtocolPiece {
    kind: SegmentKind,
    legs: Vec<Level>,
}

enum Level {
    Swing(f64, f64),
    Hold,
}

/// A hold takes as long as this part of a swing over the range at the largest rate.
const HOLD: f64 = 0.5;

/// Speeds of a protocol, as shares of the largest rate.
const SPEEDS: [f64; 3] = [1.0, 0.45, 0.2];

/// FEMA 461: each amplitude is 1.4 times the one before, and the smallest of ten 0.048 of the largest.
const FEMA_RATIO: f64 = 1.4;
const FEMA_STEPS: i32 = 10;

/// CUREE: a primary cycle is followed by trailing ones of 75 % of its amplitude.
const TRAILING: f64 = 0.75;

impl Protocol {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Structure, Self::Damper, Self::Rubber, Self::Actuator, Self::Magnet];

    /// The name, such as `structure`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Structure => "structure",
            Self::Damper => "damper",
            Self::Rubber => "rubber",
            Self::Actuator => "actuator",
            Self::Magnet => "magnet",
        }
    }

    /// Beginnings of words by which a text is recognised.
    fn words(self) -> &'static str {
        match self {
            Self::Structure => {
                "structure structural column beam frame wall joint brace connection timber wood concrete \
                 masonry member coupon metal steel"
            }
            Self::Damper => "damper bearing isolator friction magnetorheological magneto-rheological",
            Self::Rubber => "rubber elastomer bush mount viscoelastic",
            Self::Actuator => {
                "actuator piezo stack bender stage shape-memory shape sma magnetostrictive terfenol \
                 muscle"
            }
            Self::Magnet => {
                "magnet ferrite core transformer sheet lamination ferroelectric capacitor recording"
            }
        }
    }

    /// The kind that a text names in free words, such as `piezo stage`.
    ///
    /// # Errors
    /// A text without a known word.
    pub fn named(text: &str) -> Result<Self> {
        let lower = text.to_lowercase();
        let words: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric() && c != '-').collect();
        // The longest beginning of a word counts: a magnetorheological damper is no magnet.
        let letters = |kind: &Self| -> usize {
            let of_word = |word: &&str| {
                let known = kind.words().split(' ').filter(|known| word.starts_with(known));
                known.map(|known| known.len()).max().unwrap_or(0)
            };
            words.iter().map(of_word).sum()
        };
        let best = Self::ALL.into_iter().rev().max_by_key(letters).filter(|kind| letters(kind) > 0);
        best.ok_or_else(|| Error::UnknownName {
            what: "kind of specimen",
            name: text.into(),
            known: Self::ALL.map(Self::name).into(),
        })
    }

    /// Where the protocol is from.
    pub fn sources(self) -> &'static [&'static str] {
        match self {
            Self::Structure => &[
                "FEMA 461 (2007): two cycles for each amplitude, each amplitude 1.4 times the one before, the smallest of \
                 ten 0.048 of the largest",
                "CUREE W-02 (Krawinkler and others, 2001): trailing cycles of 75 % after a primary cycle",
            ],
            Self::Damper => &[
                "Spencer, Dyke, Sain and Carlson (1997): sines of several amplitudes and frequencies, then random motion",
            ],
            Self::Rubber => &[
                "ISO 4664-1: mechanical conditioning before the measurement",
                "Mullins (1969): the first cycles of rubber soften it",
            ],
            Self::Actuator => &["Mayergoyz (1986): first-order reversal curves identify a Preisach model"],
            Self::Magnet => &[
                "Mayergoyz (1986): first-order reversal curves identify a Preisach model",
                "Pike, Roberts and Verosub (1999): reversal curves from saturation (FORC)",
            ],
        }
    }

    fn pieces(self) -> Vec<ProtocolPiece> {
        match self {
            Self::Structure => {
                let amplitude = |step: i32| powi(FEMA_RATIO, step - FEMA_STEPS + 1);
                let mut pieces: Vec<ProtocolPiece> = (0..FEMA_STEPS - 3)
                    .map(|step| cycles(SegmentKind::RisingLoops, amplitude(step), 2, 1.0))
                    .collect();
                for step in FEMA_STEPS - 3..FEMA_STEPS {
                    pieces.push(cycles(SegmentKind::RisingLoops, amplitude(step), 2, 1.0));
                    pieces.push(cycles(SegmentKind::CentredLoop, TRAILING * amplitude(step), 1, 1.0));
                }
                pieces.push(nested());
                pieces
            }
            Self::Damper => {
                let mut pieces = at_speeds(&[0.25, 0.5, 1.0]);
                pieces.extend([nested(), irregular()]);
                pieces
            }
            Self::Rubber => {
                let mut pieces = vec![cycles(SegmentKind::Conditioning, 1.0, 3, 1.0)];
                pieces.extend(at_speeds(&[0.15, 0.4, 1.0]));
                pieces.extend([hold(0.8), hold(0.3), nested(), irregular()]);
                pieces
            }
            Self::Actuator => {
                let mut pieces = vec![cycles(SegmentKind::Conditioning, 1.0, 1, 1.0)];
                pieces.extend(reversal_curves());
                pieces.push(nested());
                pieces.extend(SPEEDS.map(|speed| cycles(SegmentKind::TwoSpeeds, 0.5, 1, speed)));
                pieces.extend([hold(0.8), hold(0.4), irregular()]);
                pieces
            }
            Self::Magnet => {
                let mut pieces: Vec<ProtocolPiece> = [0.1, 0.2, 0.35, 0.5, 0.7, 1.0]
                    .map(|amplitude| cycles(SegmentKind::RisingLoops, amplitude, 1, 1.0))
                    .into();
                pieces.extend(reversal_curves());
                pieces.extend([nested(), irregular()]);
                pieces
            }
        }
    }

    /// The protocol within limits.
    ///
    /// # Errors
    /// No range, or limits that leave no room for the protocol.
    pub fn plan(self, options: &ProtocolOptions) -> Result<Plan> {
        let ProtocolOptions { limits: wanted, wave } = *options;
        let needed = "it is needed for a specimen without data, as -1:1";
        let range = wanted.range.ok_or_else(|| OptionError::value("range", "none", needed))?;
        let wave = wave.unwrap_or(if wanted.step.is_some() { Wave::Smooth } else { Wave::Triangle });
        let limits = self.limits(range, &wanted, wave)?;
        let path = DrivePath { limits, wave };
        let legs = legs(self.pieces(), limits);
        let mut drive = DriveRows::new(path);
        legs.iter().for_each(|(kind, legs)| drive.add(*kind, legs));
        drive.go_back();
        let names = ColumnNames { time: limits.step.map(|_| "t".into()), ..ColumnNames::plain(1) };
        Ok(Plan {
            names,
            limits,
            wave,
            time: time(limits, drive.inputs.len()),
            segments: drive.segments(),
            input: drive.inputs,
            gaps: Vec::new(),
            sources: self.sources().to_vec(),
        })
    }

    /// The limits with the rate at which the protocol takes the wanted rows, or the rows at the wanted rate.
    fn limits(self, range: (f64, f64), wanted: &LimitOptions, wave: Wave) -> Result<Limits> {
        let step = wanted.step;
        let start = 0.0_f64.clamp(range.0.min(range.1), range.1);
        let rows = wanted.length.unwrap_or(ROWS);
        // Bounded by the fewest rows of a swing.
        let largest = (range.1 - range.0).abs() / step.unwrap_or(1.0);
        let probe = Limits { range, start, step, max_rate: largest, rows }.checked()?;
        let needed = |max_rate: f64| {
            let limits = Limits { max_rate, ..probe };
            let all: Vec<Leg> = legs(self.pieces(), limits).into_iter().flat_map(|(_, legs)| legs).collect();
            let back = Leg::Swing { to: start, speed: 1.0 };
            1 + DrivePath { limits, wave }.rows_of(start, &[all, vec![back]].concat())
        };
        if let Some(max_rate) = wanted.max_rate {
            // Nonsense is refused before rows are counted.
            let limits = Limits { max_rate, rows: super::limits::MOST_ROWS, ..probe }.checked()?;
            let needed = needed(limits.max_rate);
            return match wanted.length {
                Some(rows) if needed > rows => Err(too_few(self, rows, needed)),
                _ if needed > super::limits::MOST_ROWS => {
                    Err(too_few(self, super::limits::MOST_ROWS, needed))
                }
                _ => Ok(Limits { rows: needed, ..limits }),
            };
        }
        let fewest = needed(probe.max_rate);
        if fewest > rows {
            return Err(too_few(self, rows, fewest));
        }
        // The rows fall with the rate: halve the interval of its logarithm.
        let (mut slow, mut fast) =
            (ln(probe.width() / (probe.time_step() * rows as f64)), ln(probe.max_rate));
        for _ in 0..60 {
            let middle = 0.5 * (slow + fast);
            if needed(exp(middle)) > rows { slow = middle } else { fast = middle }
        }
        Ok(Limits { max_rate: exp(fast), ..probe })
    }
}

fn too_few(protocol: Protocol, rows: usize, needed: usize) -> Error {
    let name = protocol.name();
    Error::Parts(format!("the protocol for {name} needs {needed} rows at this rate: {rows} are too few"))
}

/// Cycles between both ends at a level.
fn cycles(kind: SegmentKind, amplitude: f64, count: usize, speed: f64) -> ProtocolPiece {
    let mut legs: Vec<Level> = Vec::new();
    (0..count).for_each(|_| legs.extend([Level::Swing(amplitude, speed), Level::Swing(-amplitude, speed)]));
    ProtocolPiece { kind, legs }
}

/// Amplitudes, each at all speeds, the slowest first.
fn at_speeds(amplitudes: &[f64]) -> Vec<ProtocolPiece> {
    let of_amplitude =
        |amplitude: &f64| SPEEDS.map(|speed| cycles(SegmentKind::RisingLoops, *amplitude, 1, speed));
    amplitudes.iter().flat_map(of_amplitude).collect()
}

fn reversal_curves() -> Vec<ProtocolPiece> {
    let curve = |end: f64, turn: f64| ProtocolPiece {
        kind: SegmentKind::ReversalCurve,
        legs: vec![Level::Swing(end, 1.0), Level::Swing(turn, 1.0), Level::Swing(end, 1.0)],
    };
    let turns = [0.6, 0.2, -0.2, -0.6];
    turns.iter().map(|&turn| curve(1.0, turn)).chain([curve(-1.0, 0.0)]).collect()
}

/// Loops that fall, each inside the one before.
fn nested() -> ProtocolPiece {
    let level = |k: i32| Level::Swing(if k % 2 == 0 { 1.0 } else { -1.0 } * powi(0.8, k), 1.0);
    ProtocolPiece { kind: SegmentKind::NestedLoops, legs: (0..10).map(level).collect() }
}

/// Turning points all over the range, by multiples of the golden ratio.
fn irregular() -> ProtocolPiece {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let level = |k: usize| Level::Swing(2.0 * (k as f64 * GOLDEN).fract() - 1.0, 1.0);
    ProtocolPiece { kind: SegmentKind::RandomReversals, legs: (1..=14).map(level).collect() }
}

fn hold(level: f64) -> ProtocolPiece {
    ProtocolPiece { kind: SegmentKind::Hold, legs: vec![Level::Swing(level, 1.0), Level::Hold] }
}

fn legs(pieces: Vec<ProtocolPiece>, limits: Limits) -> Vec<(SegmentKind, Vec<Leg>)> {
    let (low, high) = limits.range;
    // A level of a range on one side goes from the start to the end.
    let is_one_sided =
        limits.start - low < 0.05 * limits.width() || high - limits.start < 0.05 * limits.width();
    let place = |level: f64, kind: SegmentKind| {
        let is_cycle = matches!(
            kind,
            SegmentKind::RisingLoops
                | SegmentKind::CentredLoop
                | SegmentKind::TwoSpeeds
                | SegmentKind::Conditioning
        );
        match (is_one_sided, is_cycle) {
            (true, true) if level < 0.0 => limits.start,
            (true, true) => {
                limits.start
                    + level
                        * (if high - limits.start > limits.start - low { high } else { low } - limits.start)
            }
            (true, false) => low + 0.5 * (level + 1.0) * limits.width(),
            (false, _) => limits.start + level.abs() * (if level < 0.0 { low } else { high } - limits.start),
        }
    };
    let hold = HOLD * limits.width() / (limits.max_rate * limits.time_step());
    let leg = |level: Level, kind: SegmentKind| match level {
        Level::Swing(level, speed) => Leg::Swing { to: place(level, kind).clamp(low, high), speed },
        Level::Hold => Leg::Hold((hold.ceil() as usize).max(4)),
    };
    let of_piece = |piece: ProtocolPiece| {
        (piece.kind, piece.legs.into_iter().map(|level| leg(level, piece.kind)).collect())
    };
    pieces.into_iter().map(of_piece).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn free_words_name_a_kind() {
        for (text, kind) in [
            ("piezo stage", Protocol::Actuator),
            ("Shape-memory wire", Protocol::Actuator),
            ("RC column, cyclic", Protocol::Structure),
            ("magnetorheological damper", Protocol::Damper),
            ("magnetostrictive rod", Protocol::Actuator),
            ("transformer steel sheet", Protocol::Magnet),
            ("rubber bushing", Protocol::Rubber),
        ] {
            assert_eq!(Protocol::named(text).unwrap(), kind, "{text}");
        }
        for kind in Protocol::ALL {
            assert_eq!(Protocol::named(kind.name()).unwrap(), kind);
        }
        let error = Protocol::named("jelly").unwrap_err().to_string();
        assert!(error.contains("jelly") && error.contains("structure, damper"), "{error}");
    }

    /// Amplitudes of FEMA 461: two cycles each, 1.4 times larger each time, from 0.048 of the largest.
    #[test]
    fn the_protocol_of_structures_is_that_of_fema_461() {
        let limits =
            LimitOptions { range: Some((-50.0, 50.0)), length: Some(4000), ..LimitOptions::default() };
        let plan = Protocol::Structure.plan(&ProtocolOptions { limits, wave: None }).unwrap();
        let turns = &plan.segments[0].turning_points;
        assert!((turns[0] / 50.0 - 0.048).abs() < 0.0005, "{turns:?}");
        assert!((turns[4] / turns[0] - 1.4).abs() < 1e-12 && turns[2] == turns[0] && turns[1] == -turns[0]);
        let largest = plan.input.iter().copied().fold(0.0, f64::max);
        assert!((largest - 50.0).abs() < 1e-9 && plan.rows() <= 4000 && plan.rows() > 3900);
    }

    #[test]
    fn every_protocol_keeps_its_limits() {
        for kind in Protocol::ALL {
            for (range, step) in [((-2.0, 3.0), Some(0.01)), ((0.0, 150.0), Some(0.1)), ((-5.0, 0.0), None)] {
                let limits = LimitOptions { range: Some(range), step, ..LimitOptions::default() };
                let plan = kind.plan(&ProtocolOptions { limits, wave: None }).unwrap();
                assert!(plan.input.iter().all(|x| (range.0..=range.1).contains(x)), "{kind:?}");
                assert_eq!((plan.input[0], *plan.input.last().unwrap()), (0.0, 0.0));
                let largest = plan.input.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
                assert!(largest <= plan.limits.max_rate * step.unwrap_or(1.0) * (1.0 + 1e-9));
                assert!(plan.rows() <= 2000 && plan.rows() > 1900, "{kind:?} {}", plan.rows());
            }
        }
    }
}
