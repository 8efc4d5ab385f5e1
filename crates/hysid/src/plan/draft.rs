//! A drive in the making: rows, segments, and where memory and members are.

use rayon::prelude::*;

use super::coverage::{Coverage, Past, Visit};
use super::members::Members;
use super::path::{Leg, Path};
use super::segment::{Kind, Segment};
use crate::error::Result;

/// Disagreement of the members counts this much, the rest is coverage alone: members may agree by chance.
const BY_DISAGREEMENT: f64 = 0.5;

/// Largest disagreement of a row that counts, in mean disagreements: a member that diverges must not choose the plan.
const LARGEST_RATIO: f64 = 4.0;

/// Rows of a swing over the whole range at which candidates are looked at, about: long drives have many more.
const LOOKS: usize = 200;

/// A drive in the making.
pub(super) struct Draft<'m> {
    pub path: Path,
    pub coverage: Coverage,
    members: Option<Members<'m>>,
    /// Mean disagreement of the first candidates, which is 1 in their values.
    mean_disagreement: Option<f64>,
    pub inputs: Vec<f64>,
    past: Past,
    /// Direction of the last swing: 1, -1, or 0 at the beginning.
    direction: f64,
    pieces: Vec<Piece>,
}

/// A piece that was added.
struct Piece {
    kind: Kind,
    first_row: usize,
    legs: Vec<Leg>,
    visits: f64,
    new_visits: f64,
    squares: f64,
    rate: f64,
    /// Smallest and largest input behind the way to its first turning point.
    range: (f64, f64),
}

/// Rows of legs and what they visit.
struct Run {
    rows: Vec<f64>,
    /// How many rows each of them is from where the drive is.
    offsets: Vec<usize>,
    visits: Vec<Visit>,
    past: Past,
    direction: f64,
    /// Longest step from row to row behind the first leg, or within it if there is no other.
    longest: f64,
    /// Smallest and largest input there.
    range: (f64, f64),
}

/// The range of no input.
const NO_RANGE: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

fn joined(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    (a.0.min(b.0), a.1.max(b.1))
}

/// What a candidate is worth.
#[derive(Debug, Clone, Copy)]
pub(super) struct Worth {
    /// Sum of the disagreements, and rows that were looked at.
    disagreement: f64,
    rows: usize,
    /// Gain of a row.
    pub gain: f64,
}

impl<'m> Draft<'m> {
    /// A machine at rest at the beginning.
    pub fn new(path: Path, coverage: Coverage, members: Option<Members<'m>>) -> Self {
        let start = path.limits.start;
        Self {
            path,
            coverage,
            members,
            mean_disagreement: None,
            inputs: vec![start],
            past: Past::at(start),
            direction: 0.0,
            pieces: Vec::new(),
        }
    }

    /// The input now.
    pub fn now(&self) -> f64 {
        *self.inputs.last().expect("a drive begins with a row")
    }

    /// True if the legs fit and leave the way back.
    pub fn fits(&self, legs: &[Leg]) -> bool {
        let end = legs.iter().rev().find_map(|leg| match leg {
            Leg::Swing { to, .. } => Some(*to),
            Leg::Hold(_) => None,
        });
        let rows = self.path.rows_of(self.now(), legs);
        let back = self.path.rows(end.unwrap_or(self.now()), self.way_back());
        self.inputs.len() + rows + back <= self.path.limits.rows
    }

    fn way_back(&self) -> Leg {
        Leg::Swing { to: self.path.limits.start, speed: 1.0 }
    }

    /// Mean speed of a leg.
    fn speed(&self, from: f64, leg: Leg) -> f64 {
        match leg {
            Leg::Hold(_) => 0.0,
            Leg::Swing { to, .. } => {
                (to - from).abs() / (self.path.rows(from, leg) as f64 * self.path.limits.time_step())
            }
        }
    }

    /// Every so many rows of legs, and the last of each.
    fn run(&self, legs: &[Leg], every: usize) -> Run {
        let mut run = Run {
            rows: Vec::new(),
            offsets: Vec::new(),
            visits: Vec::new(),
            past: self.past,
            direction: self.direction,
            longest: 0.0,
            range: NO_RANGE,
        };
        let (mut x, mut length) = (self.now(), 0);
        for (place, &leg) in legs.iter().enumerate() {
            if place == 1 {
                (run.longest, run.range) = (0.0, (x, x));
            }
            if let Leg::Swing { to, .. } = leg {
                let direction = (to - x).signum();
                if run.direction * direction < 0.0 {
                    run.past = run.past.turned(x);
                }
                run.direction = direction;
            }
            let speed = self.speed(x, leg);
            let (rows, before) = (self.path.leg(x, leg), length);
            length += rows.len();
            for (index, &to) in rows.iter().enumerate() {
                if (index + 1) % every != 0 && index + 1 < rows.len() {
                    continue;
                }
                run.visits.push(self.coverage.visit(x, to, run.past, speed));
                run.rows.push(to);
                run.offsets.push(before + index + 1);
                run.longest = run.longest.max((to - x).abs());
                run.range = joined(run.range, (to, to));
                x = to;
            }
        }
        run
    }

    /// What candidates are worth, each from here.
    pub fn worth(&mut self, candidates: &[Vec<Leg>]) -> Result<Vec<Worth>> {
        // Without a mean yet, the gains are those of coverage alone; then once more.
        let of = |draft: &Self| -> Result<Vec<Worth>> {
            let members = || draft.members.clone();
            candidates.par_iter().map_init(members, |members, legs| draft.worth_of(legs, members)).collect()
        };
        let first = of(self)?;
        if self.members.is_none() || self.mean_disagreement.is_some() {
            return Ok(first);
        }
        let (sum, rows) =
            first.iter().fold((0.0, 0), |(sum, rows), one| (sum + one.disagreement, rows + one.rows));
        self.mean_disagreement = Some(sum / rows.max(1) as f64);
        of(self)
    }

    fn worth_of(&self, legs: &[Leg], members: &mut Option<Members<'m>>) -> Result<Worth> {
        let (low, high) = self.path.limits.range;
        let swing = self.path.rows(low, Leg::Swing { to: high, speed: 1.0 });
        let run = self.run(legs, (swing / LOOKS).max(1));
        let disagreement = match members {
            Some(members) => members.along(&run.rows, &run.offsets)?,
            None => Vec::new(),
        };
        let mean = self.mean_disagreement.filter(|mean| *mean > 0.0);
        let value = |row: usize| match (mean, disagreement.get(row)) {
            (Some(mean), Some(found)) => {
                1.0 - BY_DISAGREEMENT + BY_DISAGREEMENT * (found / mean).min(LARGEST_RATIO)
            }
            _ => 1.0,
        };
        let rows = self.path.rows_of(self.now(), legs);
        Ok(Worth {
            disagreement: disagreement.iter().sum(),
            rows: run.rows.len(),
            gain: self.coverage.gain(&run.visits, value) / rows as f64,
        })
    }

    /// Adds a piece.
    pub fn add(&mut self, kind: Kind, legs: &[Leg]) -> Result<()> {
        let run = self.run(legs, 1);
        let squares = match &mut self.members {
            Some(members) => members.advance(&run.rows)?.iter().map(|d| d * d).sum(),
            None => 0.0,
        };
        let visits: f64 = run.visits.iter().map(|visit| visit.amount).sum();
        self.pieces.push(Piece {
            kind,
            first_row: self.inputs.len(),
            legs: legs.to_vec(),
            visits,
            new_visits: visits * self.coverage.new_share(&run.visits),
            squares,
            rate: run.longest / self.path.limits.time_step(),
            range: run.range,
        });
        self.coverage.add(&run.visits);
        self.inputs.extend(run.rows);
        (self.past, self.direction) = (run.past, run.direction);
        Ok(())
    }

    /// Goes back to the beginning.
    pub fn go_back(&mut self) -> Result<()> {
        if self.now() == self.path.limits.start {
            return Ok(());
        }
        self.add(Kind::Return, &[self.way_back()])
    }

    /// Root mean square of the disagreement along the drive so far.
    pub fn disagreement(&self) -> Option<f64> {
        let rows = self.inputs.len().saturating_sub(1).max(1);
        let squares: f64 = self.pieces.iter().map(|piece| piece.squares).sum();
        self.members.is_some().then(|| (squares / rows as f64).sqrt())
    }

    /// The segments, without reasons: pieces of one kind at one speed that follow each other are one.
    pub fn segments(&self) -> Vec<Segment> {
        let speed = |piece: &Piece| {
            piece.legs.iter().rev().find_map(|leg| match leg {
                Leg::Swing { speed, .. } => Some(speed.to_bits()),
                Leg::Hold(_) => None,
            })
        };
        let same = |a: &Piece, b: &Piece| a.kind == b.kind && speed(a) == speed(b);
        let mut first = 0;
        self.pieces
            .chunk_by(same)
            .map(|pieces| {
                let end = first + pieces.len();
                let rows =
                    pieces[0].first_row..self.pieces.get(end).map_or(self.inputs.len(), |p| p.first_row);
                first = end;
                self.segment(pieces, rows)
            })
            .collect()
    }

    fn segment(&self, pieces: &[Piece], rows: std::ops::Range<usize>) -> Segment {
        let (low, high) = pieces.iter().fold(NO_RANGE, |range, piece| joined(range, piece.range));
        let sum = |of: fn(&Piece) -> f64| pieces.iter().map(of).sum::<f64>();
        let visits = sum(|piece| piece.visits);
        let legs = pieces.iter().flat_map(|piece| &piece.legs);
        Segment {
            kind: pieces[0].kind,
            amplitude: 0.5 * (high - low),
            mean: 0.5 * (high + low),
            rate: pieces.iter().map(|piece| piece.rate).fold(0.0, f64::max),
            turning_points: legs
                .filter_map(|leg| match leg {
                    Leg::Swing { to, .. } => Some(*to),
                    Leg::Hold(_) => None,
                })
                .collect(),
            new_share: (visits > 0.0).then(|| sum(|piece| piece.new_visits) / visits),
            disagreement: self
                .members
                .is_some()
                .then(|| (sum(|piece| piece.squares) / rows.len() as f64).sqrt()),
            reason: String::new(),
            rows,
        }
    }
}
