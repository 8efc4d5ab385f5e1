//! The drive of a plan: tests of properties that the data cannot test, then random reversals, then the way back.

use hysid_core::elementary::powf;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::path::{DrivePath, Leg};
use super::segment::{Segment, SegmentKind};
use super::survey::Survey;
use hysid_diagnosis::Verdict;

/// Largest share of the rows for the test of one property, and for all tests together.
const OF_A_TEST: f64 = 0.25;
const OF_ALL_TESTS: f64 = 0.4;

/// Amplitudes of a test as shares of half the range; the largest that fits is run.
const AMPLITUDES: [f64; 5] = [0.6, 0.45, 0.3, 0.2, 0.12];

/// Speed of the slow loop of a test of rate dependence, as a share of the largest rate.
const SLOW: f64 = 0.45;

/// Share of the rows of a hold, fewest rows, and places in the range.
const HOLD: f64 = 0.03;
const FEWEST_ROWS_OF_A_HOLD: usize = 8;
const HOLDS: [f64; 2] = [0.75, 0.3];

/// Largest first swing as a share of the range, and share of the rows until all is allowed: large swings may damage.
const FIRST_REACH: f64 = 0.35;
const WHOLE_REACH_AT: f64 = 0.6;

/// Smallest random swing, as a share of the range.
const SMALLEST_SWING: f64 = 0.06;

/// Slowest random swing, as a share of the largest rate; speeds are uniform in their logarithm.
const SLOWEST: f64 = 0.2;

/// Random swings that are drawn until one fits into the rows that are left.
const DRAWS: usize = 20;

/// Rows and segments of a drive, which begins at the start of the limits.
pub(super) struct DriveRows {
    pub inputs: Vec<f64>,
    path: DrivePath,
    pieces: Vec<DrivePiece>,
}

struct DrivePiece {
    kind: SegmentKind,
    first_row: usize,
    legs: Vec<Leg>,
    /// Largest rate, smallest and largest input, behind the first leg if there are others.
    rate: f64,
    range: (f64, f64),
}

const NO_RANGE: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

fn joined(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.min(b.0), a.1.max(b.1))
}

fn swings(turns: &[f64], speed: f64) -> Vec<Leg> {
    turns.iter().map(|&to| Leg::Swing { to, speed }).collect()
}

impl DriveRows {
    /// A drive of one row.
    pub fn new(path: DrivePath) -> Self {
        Self { inputs: vec![path.limits.start], path, pieces: Vec::new() }
    }

    /// A drive for data with these gaps.
    pub fn for_data(path: DrivePath, survey: &Survey, seed: u64) -> Self {
        let mut drive = Self::new(path);
        drive.add_tests(survey);
        drive.add_random_reversals(survey, &mut Xoshiro256PlusPlus::seed_from_u64(seed));
        drive.go_back();
        drive
    }

    fn now(&self) -> f64 {
        *self.inputs.last().expect("a drive begins with a row")
    }

    fn way_back(&self) -> Leg {
        Leg::Swing { to: self.path.limits.start, speed: 1.0 }
    }

    /// True if the legs fit into the rows and leave the way back.
    fn fits(&self, legs: &[Leg]) -> bool {
        let rows = self.path.rows_of(self.now(), &[legs, &[self.way_back()]].concat());
        self.inputs.len() + rows <= self.path.limits.rows
    }

    pub fn add(&mut self, kind: SegmentKind, legs: &[Leg]) {
        let first_row = self.inputs.len();
        let (mut rate, mut range) = (0.0_f64, NO_RANGE);
        for (place, &leg) in legs.iter().enumerate() {
            let mut x = self.now();
            if place == 1 {
                (rate, range) = (0.0, (x, x));
            }
            let rows = self.path.leg(x, leg);
            for &to in &rows {
                rate = rate.max((to - x).abs() / self.path.limits.time_step());
                range = joined(range, (to, to));
                x = to;
            }
            self.inputs.extend(rows);
        }
        self.pieces.push(DrivePiece { kind, first_row, legs: legs.to_vec(), rate, range });
    }

    /// Goes back to the start.
    pub fn go_back(&mut self) {
        if self.now() != self.path.limits.start {
            self.add(SegmentKind::Return, &[self.way_back()]);
        }
    }

    /// Adds tests of the properties that the data cannot test.
    fn add_tests(&mut self, survey: &Survey) {
        let (low, high) = self.path.limits.range;
        if survey.unknown_start && !survey.may_deteriorate {
            self.add_test(SegmentKind::Conditioning, &swings(&[high, low], 1.0));
        }
        if survey.speed_matters && survey.rate_dependence == Verdict::NotTestable {
            self.add_test_of_a_loop(SegmentKind::TwoSpeeds, |up, down| {
                [swings(&[up, down, up], 1.0), swings(&[down, up], SLOW)].concat()
            });
        }
        if survey.deterioration == Verdict::NotTestable {
            self.add_test_of_a_loop(SegmentKind::RepeatedLoop, |up, down| {
                swings(&[up, down, up, down, up], 1.0)
            });
        }
        if survey.speed_matters && survey.no_hold {
            let rows = (HOLD * self.path.limits.rows as f64) as usize;
            for place in HOLDS {
                let swing = Leg::Swing { to: low + place * (high - low), speed: 1.0 };
                self.add_test(SegmentKind::Hold, &[swing, Leg::Hold(rows.max(FEWEST_ROWS_OF_A_HOLD))]);
            }
        }
    }

    /// Adds a test if it leaves enough rows; true if it was added.
    fn add_test(&mut self, kind: SegmentKind, legs: &[Leg]) -> bool {
        let (all, rows) = (self.path.limits.rows as f64, self.path.rows_of(self.now(), legs));
        let together = (self.inputs.len() + rows) as f64;
        let may_be_run = rows as f64 <= OF_A_TEST * all && together <= OF_ALL_TESTS * all && self.fits(legs);
        if may_be_run {
            self.add(kind, legs);
        }
        may_be_run
    }

    fn add_test_of_a_loop(&mut self, kind: SegmentKind, legs: impl Fn(f64, f64) -> Vec<Leg>) {
        let limits = self.path.limits;
        let (middle, half) = (0.5 * (limits.range.0 + limits.range.1), 0.5 * limits.width());
        AMPLITUDES
            .iter()
            .find(|&share| self.add_test(kind, &legs(middle + share * half, middle - share * half)));
    }

    /// Fills the rows with turning points at random, alternately above and below the one before.
    fn add_random_reversals(&mut self, survey: &Survey, generator: &mut Xoshiro256PlusPlus) {
        let (low, high) = self.path.limits.range;
        let mut rises = high - self.now() > self.now() - low;
        loop {
            let (from, range) = (self.now(), self.reach(survey.may_deteriorate));
            let mut draw = || {
                let speed = if survey.speed_matters { powf(SLOWEST, generator.random::<f64>()) } else { 1.0 };
                Leg::Swing { to: random_turn(from, range, rises, generator.random::<f64>()), speed }
            };
            let fitting = (0..DRAWS).map(|_| draw()).find(|leg| self.fits(&[*leg]));
            let Some(leg) = fitting else { return };
            self.add(SegmentKind::RandomReversals, &[leg]);
            rises = !rises;
        }
    }

    /// The range of the input that may be visited now.
    fn reach(&self, may_deteriorate: bool) -> (f64, f64) {
        let limits = self.path.limits;
        let done = self.inputs.len() as f64 / (WHOLE_REACH_AT * limits.rows as f64);
        let share = FIRST_REACH + (1.0 - FIRST_REACH) * done;
        if !may_deteriorate || share >= 1.0 {
            return limits.range;
        }
        let towards = |end: f64| limits.start + share * (end - limits.start);
        (towards(limits.range.0), towards(limits.range.1))
    }

    /// The segments: pieces of one kind that follow each other are one, and have one speed unless they are random.
    pub fn segments(&self) -> Vec<Segment> {
        let speed = |piece: &DrivePiece| {
            piece.legs.iter().rev().find_map(|leg| match leg {
                Leg::Swing { speed, .. } => Some(speed.to_bits()),
                Leg::Hold(_) => None,
            })
        };
        let is_same = |a: &DrivePiece, b: &DrivePiece| {
            a.kind == b.kind && (a.kind == SegmentKind::RandomReversals || speed(a) == speed(b))
        };
        let mut end = self.inputs.len();
        let chunks: Vec<&[DrivePiece]> = self.pieces.chunk_by(is_same).collect();
        let mut segments: Vec<Segment> = Vec::new();
        for pieces in chunks.into_iter().rev() {
            segments.push(self.segment(pieces, end));
            end = pieces[0].first_row;
        }
        segments.reverse();
        segments
    }

    fn segment(&self, pieces: &[DrivePiece], end: usize) -> Segment {
        let (low, high) = pieces.iter().fold(NO_RANGE, |range, piece| joined(range, piece.range));
        let rate = pieces.iter().map(|piece| piece.rate).fold(0.0, f64::max);
        let kind = pieces[0].kind;
        let turning_points = pieces.iter().flat_map(|piece| &piece.legs).filter_map(|leg| match leg {
            Leg::Swing { to, .. } => Some(*to),
            Leg::Hold(_) => None,
        });
        Segment {
            kind,
            rows: pieces[0].first_row..end,
            amplitude: 0.5 * (high - low),
            mean: 0.5 * (high + low),
            rate,
            turning_points: turning_points.collect(),
            reason: kind.reason(rate / self.path.limits.max_rate),
        }
    }
}

/// A turning point between the smallest swing and the end of the range, at this share of the way.
fn random_turn(from: f64, (low, high): (f64, f64), rises: bool, share: f64) -> f64 {
    let least = SMALLEST_SWING * (high - low);
    let end = if rises { high } else { low };
    let nearest = if rises { (from + least).min(end) } else { (from - least).max(end) };
    nearest + (end - nearest) * share
}
