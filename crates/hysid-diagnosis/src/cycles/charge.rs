//! Charge that a battery cycler counts from 0 in each half cycle, or writes to a file for each: as one state of charge.

use hysid_core::data::record::{ColumnNames, Dataset, Record};

use super::field::Field;
use super::path::{range, width};

/// Share of the ranges of input and output below which a half cycle has no direction of its own, as a rest.
const STILL: f64 = 0.02;

/// Rows in which the input runs one way.
struct HalfCycle {
    rows: std::ops::Range<usize>,
    record: usize,
    /// True while the voltage rises; `None` if it hardly changes.
    charges: Option<bool>,
    /// The input rises.
    rises: bool,
}

/// The data of a battery with the half cycles of each record, or all records of one half cycle each, on one axis of charge,
/// and a note; `None` if the input is one already.
pub(super) fn counted_through(data: &Dataset, field: Option<Field>) -> Option<(Dataset, String)> {
    if field.unwrap_or_else(|| Field::of(data.names())) != Field::Battery {
        return None;
    }
    let halves = data.records().iter().enumerate().map(|(number, record)| half_cycles(number, record));
    let halves = halves.collect::<Option<Vec<_>>>()?;
    let is_one_each = halves.len() > 1 && halves.iter().all(|halves| halves.len() == 1);
    let groups: Vec<Vec<HalfCycle>> =
        if is_one_each { vec![halves.into_iter().flatten().collect()] } else { halves };
    let has_both = |group: &Vec<HalfCycle>| {
        [true, false].iter().all(|way| group.iter().any(|half| half.charges == Some(*way)))
    };
    if groups.iter().any(|group| group.len() < 2 || !has_both(group)) {
        return None;
    }
    // A state of charge rises in every charge and falls in every discharge, and a depth of discharge the other way round.
    let ways: Vec<bool> =
        groups.iter().flatten().filter_map(|half| Some(half.charges? == half.rises)).collect();
    let is_counted = ways.iter().any(|way| *way != ways[0]);
    let notes = [
        (is_one_each, "the records are taken as one, in their order"),
        (
            is_counted,
            "the charge begins anew in each half cycle: it is counted up while the voltage rises, and down while it falls",
        ),
    ];
    let notes: Vec<&str> = notes.into_iter().filter(|(is_so, _)| *is_so).map(|(_, words)| words).collect();
    let records = groups.iter().map(|group| joined(data, group, is_counted)).collect::<Option<Vec<_>>>()?;
    let time = data.names().time.clone().filter(|_| records.iter().all(|record| record.time().is_some()));
    let names = ColumnNames {
        time,
        inputs: vec![data.names().inputs[0].clone()],
        rate: None,
        ..data.names().clone()
    };
    Some((Dataset::new(names, records).ok()?, notes.join("; ")))
}

/// The half cycles of a record whose input falls all the time, or rises and falls back to its lowest value in one row; `None`
/// for any other.
fn half_cycles(number: usize, record: &Record) -> Option<Vec<HalfCycle>> {
    let (x, y) = (&*record.inputs()[0], record.output());
    let (low, high) = range(x);
    let is_falling = x.windows(2).all(|pair| pair[1] <= pair[0]);
    let falls = (1..x.len()).filter(|&row| !is_falling && x[row] < x[row - 1]);
    let starts: Vec<usize> = std::iter::once(0).chain(falls).collect();
    if starts[1..].iter().any(|&row| x[row] > low + STILL * (high - low)) {
        return None;
    }
    let known: Vec<f64> = y.iter().copied().filter(|y| !y.is_nan()).collect();
    let ends = starts[1..].iter().copied().chain([x.len()]);
    let half = |(start, end): (&usize, usize)| {
        let rows = *start..end;
        let measured = || y[rows.clone()].iter().filter(|y| !y.is_nan());
        let gain = measured().next_back().zip(measured().next()).map_or(0.0, |(last, first)| last - first);
        let moves = width(&x[rows.clone()]) > STILL * (high - low) && gain.abs() > STILL * width(&known);
        HalfCycle { rows, record: number, charges: moves.then_some(gain > 0.0), rises: !is_falling }
    };
    Some(starts.iter().zip(ends).map(half).collect())
}

/// Half cycles one behind the other. If their input is counted, it goes on from where it was.
fn joined(data: &Dataset, group: &[HalfCycle], is_counted: bool) -> Option<Record> {
    let mut charges = group.iter().find_map(|half| half.charges)?;
    let (mut x, mut y, mut time) = (Vec::new(), Vec::new(), Vec::new());
    for half in group {
        let record = &data.records()[half.record];
        let own = &record.inputs()[0][half.rows.clone()];
        charges = half.charges.unwrap_or(charges);
        let (sign, first) = (if charges { 1.0 } else { -1.0 }, x.last().copied().unwrap_or(own[0]));
        x.extend(own.iter().map(|x| if is_counted { first + sign * (x - own[0]).abs() } else { *x }));
        y.extend_from_slice(&record.output()[half.rows.clone()]);
        time.extend_from_slice(record.time().map_or(&[], |time| &time[half.rows.clone()]));
    }
    let lowest = data.input_range(0).0;
    let below = (lowest - range(&x).0).max(0.0);
    x.iter_mut().for_each(|x| *x += below);
    let mut names: Vec<&str> = group.iter().map(|half| data.records()[half.record].name()).collect();
    names.dedup();
    let record = Record::new(names.join(" + "), vec![x], y).ok()?;
    if time.len() == record.len() && time.windows(2).all(|pair| pair[0] < pair[1]) {
        return record.with_time(time).ok();
    }
    Some(record)
}
