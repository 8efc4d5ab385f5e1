//! Tests that only a model allows: the same way at other speeds, its mirror image, an excursion repeated.

use super::probe::{Probe, ProbePath, extent, path};
use crate::odd_symmetry::EFFECT as ODD_EFFECT;
use crate::rate_dependence::EFFECT as RATE_EFFECT;
use crate::wiping_out::{EFFECT as GAP_EFFECT, loops};
use crate::{Evidence, Finding, Picture, PictureCurve, Piece, Property, Verdict};
use hysid_core::data::record::Record;
use hysid_core::error::Result;
use hysid_core::significant::Significant;

/// Below this share of the range of the output a difference is rounding.
pub(super) const ROUNDING: f64 = 1e-9;

/// The input is mirrored about 0 if this share of its range lies evenly about it.
const EVENLY_ABOUT_ORIGIN: f64 = 0.6;

/// Loops of several sizes, whole ones first: what is left of the virgin state is gone after two branches.
const LOOPS: [f64; 11] = [0.0, 1.0, -1.0, 1.0, -1.0, 0.5, -0.5, 0.8, -0.2, 1.0, -1.0];

/// Branches until the virgin state is forgotten.
const FORGOTTEN: usize = 2;

const EXCURSIONS: usize = 20;

fn drawn(label: String, record: &Record, from: usize) -> PictureCurve {
    let rows = record.inputs()[0].iter().zip(record.output()).skip(from);
    PictureCurve { label, points: rows.map(|(&x, &y)| (x, y)).collect() }
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value * value));
    if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 }
}

/// The same rows at several speeds, theory.md (10.31).
pub(super) fn rate_dependence(probe: &Probe) -> Result<Finding> {
    let path = probe.path(&LOOPS);
    let speeds = probe.speeds.tried();
    let run = |speed: &f64| probe.run(&format!("at speed {speed:.3e}"), &path.x, *speed);
    let records: Vec<Record> = speeds.iter().map(run).collect::<Result<_>>()?;
    let slowest = &records[0];
    let height = records.iter().map(|record| extent(record.output())).fold(0.0, f64::max);
    let apart = |record: &Record| {
        rms(record.output().iter().zip(slowest.output()).map(|(a, b)| a - b)) / height.max(f64::MIN_POSITIVE)
    };
    let rows = path.x.len() - 1;
    let evidence: Vec<Evidence> = records[1..]
        .iter()
        .map(|record| Evidence {
            index: apart(record),
            pieces: vec![Piece::of(slowest, (0, rows)), Piece::of(record, (0, rows))],
        })
        .collect();
    let index = evidence.iter().map(|evidence| evidence.index).fold(0.0, f64::max);
    let statement = if index <= ROUNDING {
        "the output is the same at every speed, up to rounding".into()
    } else {
        let percent = Significant(100.0 * index);
        format!("at 30 times the speed the output differs by up to {percent:.3} % of its range")
    };
    let last_loop = path.turns[FORGOTTEN]..path.turns[FORGOTTEN + 2];
    let curve = |(speed, record): (&f64, &Record)| {
        let mut curve = drawn(format!("speed {speed:.3e}"), record, last_loop.start);
        curve.points.truncate(last_loop.len() + 1);
        curve
    };
    Ok(Finding {
        property: Property::RateDependence,
        verdict: if index > RATE_EFFECT { Verdict::Yes } else { Verdict::No },
        index: Some(index),
        threshold: Some(RATE_EFFECT),
        noise: Some(0.0),
        comparisons: evidence.len(),
        statement,
        experiment: None,
        evidence,
        picture: Some(loops(speeds.iter().zip(&records).map(curve).collect())),
    })
}

/// An output and that of the mirrored input, theory.md (10.32).
struct MirroredOutput {
    index: f64,
    record: Record,
    curves: Vec<PictureCurve>,
    rows: (usize, usize),
}

/// The input mirrored about the model's origin, where the trained range allows it, and about the middle of the range.
/// One is enough.
pub(super) fn odd_symmetry(probe: &Probe) -> Result<Finding> {
    let Probe { centre, half, .. } = *probe;
    let middle = mirrored(probe, centre, half)?;
    let origin = probe.origin();
    let off_centre = (origin - centre).abs();
    let at_origin =
        if about_origin(probe) { Some(mirrored(probe, origin, half - off_centre)?) } else { None };
    let percent = |mirrored: &MirroredOutput| Significant(100.0 * mirrored.index);
    let middle_of_range = "the middle of the input's range";
    let x_origin = format!("x = {}", Significant(origin));
    let (about, further) = match &at_origin {
        Some(found) if off_centre == 0.0 => {
            (format!("{x_origin} deviates from itself by {:.3} %", percent(found)), String::new())
        }
        Some(found) => (
            format!("{x_origin} deviates from itself by {:.3} %", percent(found)),
            format!(", about {middle_of_range} by {:.3} %", percent(&middle)),
        ),
        None => (
            format!("{middle_of_range} deviates from itself by {:.3} %", percent(&middle)),
            format!("; {x_origin} is not in the middle of the trained range"),
        ),
    };
    let statement = format!("an output rotated by 180° about {about} of its range{further}");
    let best = match at_origin {
        Some(found) if found.index <= middle.index => found,
        _ => middle,
    };
    Ok(Finding {
        property: Property::OddSymmetry,
        verdict: if best.index <= ODD_EFFECT { Verdict::Yes } else { Verdict::No },
        index: Some(best.index),
        threshold: Some(ODD_EFFECT),
        noise: Some(0.0),
        comparisons: 1,
        statement,
        experiment: None,
        evidence: vec![Evidence { index: best.index, pieces: vec![Piece::of(&best.record, best.rows)] }],
        picture: Some(loops(best.curves)),
    })
}

/// True if the trained range lies evenly enough about the model's origin to be mirrored there.
pub(super) fn about_origin(probe: &Probe) -> bool {
    probe.half - (probe.centre - probe.origin()).abs() >= EVENLY_ABOUT_ORIGIN * probe.half
}

fn mirrored(probe: &Probe, centre: f64, half: f64) -> Result<MirroredOutput> {
    let there: ProbePath = path(centre, half, &LOOPS, probe.steps);
    let back = path(centre, half, &LOOPS.map(|turning| -turning), probe.steps);
    let record = probe.run("path", &there.x, probe.speeds.vanishing)?;
    let other = probe.run("mirrored path", &back.x, probe.speeds.vanishing)?;
    let first = there.turns[FORGOTTEN];
    let sums = || record.output()[first..].iter().zip(&other.output()[first..]).map(|(a, b)| a + b);
    let mean = sums().sum::<f64>() / (there.x.len() - first) as f64;
    let turned = PictureCurve {
        label: "mirrored, rotated back".into(),
        points: there.x[first..].iter().zip(&other.output()[first..]).map(|(&x, y)| (x, mean - y)).collect(),
    };
    Ok(MirroredOutput {
        index: rms(sums().map(|sum| sum - mean)) / extent(record.output()).max(f64::MIN_POSITIVE),
        curves: vec![drawn("path".into(), &record, first), turned],
        rows: (first, there.x.len() - 1),
        record,
    })
}

/// Return-point memory after excursions in a row, theory.md (10.33): a gap too small to matter may add up.
pub(super) fn with_accumulated_gap(probe: &Probe, finding: Finding, height: f64) -> Result<Finding> {
    let mut turning = vec![0.0, 1.0, -1.0];
    let mut arrivals = Vec::new();
    for (from, to) in [(0.2, -0.2), (0.7, 0.5), (0.0, -0.8), (-0.5, -0.6)] {
        for side in [1.0, -1.0] {
            arrivals.push(turning.len());
            turning.push(side * from);
            turning.extend([side * to, side * from].repeat(EXCURSIONS));
            turning.push(side);
        }
    }
    let path = probe.path(&turning);
    let record = probe.run_slowly("excursions in a row", &path.x)?;
    let y = record.output();
    let ends = arrivals.iter().map(|&turn| (path.turns[turn], path.turns[turn + 2 * EXCURSIONS]));
    let gaps = ends.map(|(first, last)| ((y[last] - y[first]).abs() / height, (first, last)));
    let (gap, rows) = gaps.max_by(|a, b| a.0.total_cmp(&b.0)).expect("there are excursions");
    let mut finding = finding;
    if finding.verdict == Verdict::No || gap <= GAP_EFFECT {
        finding.statement +=
            &format!("; after {EXCURSIONS} in a row it is {:.2} %", Significant(100.0 * gap));
        finding.index = finding.index.map(|index| index.max(gap)).or(Some(gap));
        return Ok(finding);
    }
    let mut curve = drawn(format!("{EXCURSIONS} excursions"), &record, rows.0);
    curve.points.truncate(rows.1 - rows.0 + 1);
    Ok(Finding {
        verdict: Verdict::No,
        index: Some(gap),
        threshold: Some(GAP_EFFECT),
        statement: format!(
            "{EXCURSIONS} excursions in a row leave a gap of {:.1} % of the output's range",
            100.0 * gap
        ),
        evidence: vec![Evidence { index: gap, pieces: vec![Piece::of(&record, rows)] }],
        picture: Some(Picture { x_label: String::new(), y_label: String::new(), curves: vec![curve] }),
        ..finding
    })
}
