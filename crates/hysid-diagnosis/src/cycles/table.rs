//! The table of cycles of a data set.

use std::f64::consts::SQRT_2;

use hysid_core::data::record::{Dataset, Record};
use hysid_core::error::{Error, Result};
use hysid_core::significant::Significant;
use serde::Serialize;

use super::CLOSED;
use super::backbone::{BackbonePoint, Direction, backbone};
use super::branches;
use super::correction::gap;
use super::creep::{CycleHold, holds};
use super::division::{Division, LAST_STEP, Span, SpanPart, choose, divide, level, output_closes};
use super::elastic_plastic;
use super::field::Field;
use super::harmonic::ComplexModulus;
use super::joint::joint;
use super::levels::{self, LevelRow};
use super::loss_separation::LossLaws;
use super::losses::{LossAtFrequency, losses};
use super::notes::notes;
use super::path::{Closure, CyclePath, area, at, range, weights, width};
use super::period::{Rests, leave_out_mixed_frequencies, rests};
use super::quantities::Quantities;
use super::reading::{SURE, Widest, damping, end_without_noise, output_at_end, secant, widest};
use super::record_figure::RecordFigure;
use super::row::{CycleRow, OPEN_LOOP};
use super::saturation;
use super::strand::{Strand, cross};
use super::tips::{CycleTip, Tips};
use crate::branch::{Branch, BranchSet, JITTERS, ReversalRule};
use crate::{DiagnosisOptions, FEWEST_ROWS};

/// A loop over less than this share of a cycle's swing is smaller than the cycle: either that is said, or there is none.
const COMES_BACK: f64 = 0.9;

/// A loop over this share of a cycle's swing is the whole cycle.
const WHOLE: f64 = 0.98;

/// Rows further apart than this share of a swing do not show what the output does between them.
const FAR_APART: f64 = 0.1;

/// A step of a charge over this share of its swing is no measurement of what lies between.
const JUMP: f64 = 0.5;

/// Share of a swing that is rounding.
const ROUNDING: f64 = 1e-12;

/// Deviations of the noise between the extremes of a turning point and of the rows beside it.
const FAR_IN_NOISE: f64 = 6.0;

/// Area of a loop below which it is rounding, as a share of its box.
const LINE: f64 = 1e-5;

/// A loop is about the input 0 if its middle is this close to it, as a share of the swing.
const CENTRED: f64 = 0.05;

/// An offset of the output that is said, as a share of the loop's height.
const OFFSET: f64 = 0.02;

/// Share of the energy that an opening may add before it is said.
const ADDS: f64 = 0.01;

/// An opening of a loop that is said, as a share of its height.
const OPEN: f64 = 0.02;

/// A change of the output between rows next to a turning point that is said, as a share of the loop's height; and how close
/// such rows are, as a share of the swing.
const STEEP: f64 = 0.02;
const AT_THE_TIP: f64 = 0.01;

/// Share of the way through a loop, before its middle, to which the input goes back on smaller loops.
const BACK: f64 = 0.1;

/// How cycles are found and what is read from them.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleOptions {
    /// Reversals of the input below this share of its range are no turning points; `None`: the noise of the input decides.
    pub smallest_reversal: Option<f64>,
    /// Whether noise is smoothed out of branches before outputs are read from them.
    pub smoothing: bool,
    /// Where cycles begin and end; `None` for what suits the data.
    pub division: Option<Division>,
    /// The field of engineering; `None` for what names and units of the columns indicate.
    pub field: Option<Field>,
    /// Mass density in kg/m³, for losses per mass.
    pub density: Option<f64>,
    /// Height of a structure in the unit of the input, for the drift ratios of its levels.
    pub height: Option<f64>,
}

impl Default for CycleOptions {
    fn default() -> Self {
        Self {
            smallest_reversal: None,
            smoothing: true,
            division: None,
            field: None,
            density: None,
            height: None,
        }
    }
}

impl CycleOptions {
    /// How the branches of reversal curves are found.
    pub fn branches(&self) -> DiagnosisOptions {
        let smallest_reversal =
            self.smallest_reversal.unwrap_or(DiagnosisOptions::default().smallest_reversal);
        DiagnosisOptions { smallest_reversal, smoothing: self.smoothing }
    }

    fn survey<'d>(&self, data: &'d Dataset) -> BranchSet<'d> {
        match self.smallest_reversal {
            Some(_) => BranchSet::new(data, &self.branches()),
            None => BranchSet::by_rule(data, self.smoothing, ReversalRule::Noise),
        }
    }
}

/// The cycles of a data set in figures.
///
/// ```
/// use hysid_core::data::record::Dataset;
/// use hysid_core::operator::{Operator, Stop};
/// use hysid_diagnosis::cycles::{CycleOptions, CycleTable};
///
/// // An elastic-perfectly plastic member: stiffness 1, strength 1, three cycles of amplitude 3.
/// let x: Vec<f64> = (0..=1200).map(|k| 3.0 * (std::f64::consts::TAU * k as f64 / 400.0).sin()).collect();
/// let y = Stop::new(1.0)?.run(&x);
/// let table = CycleTable::of(&Dataset::from_slices(&x, &y)?, &CycleOptions::default())?;
/// let last = table.cycles.last().unwrap();
/// // 4 F_y (d - F_y/k), and twice the share of the box that the loop fills over π.
/// assert!((last.energy.unwrap() - 8.0).abs() < 1e-2);
/// assert!((last.damping_percent.unwrap() - 100.0 * 2.0 / std::f64::consts::PI * (8.0 / 12.0)).abs() < 0.1);
/// assert!((last.residual_after_peak.unwrap() - 2.0).abs() < 1e-2);
/// # Ok::<(), hysid_core::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CycleTable {
    /// The field of engineering.
    pub field: Field,
    /// Where cycles begin and end.
    pub division: Division,
    /// One row for each cycle and each incomplete part, in the order of the data.
    pub cycles: Vec<CycleRow>,
    /// The backbone of each record.
    pub backbone: Vec<BackbonePoint>,
    /// Amplitude levels of structures.
    pub levels: Vec<LevelRow>,
    /// Figures of whole records.
    pub figures: Vec<RecordFigure>,
    /// Losses by amplitude and frequency, for data with time.
    pub losses: Vec<LossAtFrequency>,
    /// Notes on the whole table: why figures are missing in every row.
    pub notes: Vec<String>,
}

impl CycleTable {
    /// The cycles of the first input of the data and of their output.
    ///
    /// # Errors
    /// Data without loops: a constant input or output, hardly any rows. A density for data whose loops are no energy per
    /// volume, or a height for data of no structure.
    pub fn of(data: &Dataset, options: &CycleOptions) -> Result<Self> {
        data.check_identifiable(FEWEST_ROWS)?;
        let quantities = Quantities::of(data.names());
        let unit = quantities.other_than_energy_per_volume();
        if let Some(unit) = unit.filter(|_| options.density.is_some()) {
            return Err(Error::Parts(format!(
                "losses per mass need an energy per volume, as of A/m and T, and the loops of these data are in {unit}: \
                 leave the density out"
            )));
        }
        let survey = options.survey(data);
        let field = options.field.unwrap_or_else(|| Field::of(data.names()));
        if options.height.is_some() && field != Field::Structure {
            return Err(Error::Parts(format!(
                "a height gives the drift of structures, and the field is {field}"
            )));
        }
        let division = options.division.unwrap_or_else(|| choose(&survey, field));
        let (mut cycles, mut points) = (Vec::new(), Vec::new());
        let (mut levels, mut figures) = (Vec::new(), Vec::new());
        let noise = (survey.input_noise.deviation(), survey.output_noise.deviation());
        for (number, record) in data.records().iter().enumerate() {
            let begins = record.inputs()[0].first().copied().unwrap_or_default();
            let level = level(&survey, number, division).unwrap_or(begins);
            let backbone = if field.has_structures() { backbone(&survey, number, level) } else { Vec::new() };
            let mut rows = rows_of(&survey, number, (field, division), &backbone);
            rows.iter_mut().for_each(|row| row.scale(quantities.energy_factor(), quantities.rate_factor()));
            if field == Field::Structure {
                let own = elastic_plastic::figures(record.name(), &backbone, level);
                let yielding = elastic_plastic::mean_yield_input(&own);
                levels.extend(levels::levels(&rows, yielding, options.height, noise));
                figures.extend(own);
            }
            if field == Field::Magnet && rows.iter().any(|row| row.complete) {
                figures.extend(saturation::figures(record));
            }
            cycles.extend(rows);
            points.extend(backbone);
        }
        let density = options.density.filter(|_| field.has_magnets());
        if let Some(density) = density {
            for row in &mut cycles {
                row.energy_per_mass = row.energy.map(|energy| energy / density);
                row.power_per_mass = row.power.map(|power| power / density);
            }
        }
        let laws = if field == Field::Magnet {
            LossLaws::read(data, &mut cycles, quantities.rate_factor())
        } else {
            LossLaws::default()
        };
        figures.extend(laws.figures);
        let notes = notes(&survey, &cycles, (field, division));
        let losses = losses(&cycles, laws.separation.as_ref(), density);
        Ok(Self { field, division, losses, cycles, backbone: points, levels, figures, notes })
    }

    /// The rows of complete cycles.
    pub fn complete(&self) -> impl Iterator<Item = &CycleRow> + Clone {
        self.cycles.iter().filter(|row| row.complete)
    }
}

/// The rows of a record.
fn rows_of(
    survey: &BranchSet,
    record: usize,
    (field, division): (Field, Division),
    backbone: &[BackbonePoint],
) -> Vec<CycleRow> {
    let branches = survey.of_record(record);
    let holds = if field.has_holds() { holds(survey, record) } else { Vec::new() };
    let spans = divide(survey, record, division);
    let mut cumulative = Some(0.0);
    let (mut rows, mut unevenness) = (Vec::new(), Vec::new());
    for (place, span) in spans.iter().enumerate() {
        let reader =
            CycleReader { survey, record: &survey.data.records()[record], branches, span, field, division };
        let rests = match span.part {
            SpanPart::Cycle => rests(survey, reader.record, branches, span, division),
            _ => Rests::default(),
        };
        let mut row = reader.row(place + 1, rests);
        mark_backbone(&mut row, backbone);
        if row.complete {
            cumulative = cumulative.zip(row.energy).map(|(sum, energy)| sum + energy);
            row.cumulative_energy = cumulative;
        }
        let next = spans.get(place + 1).map_or(f64::INFINITY, |next| next.from);
        let first = if place == 0 { 0.0 } else { span.from };
        let is_within = |hold: &&CycleHold| (first..next).contains(&(hold.rows.0 as f64));
        let longest = holds.iter().filter(is_within).max_by(|a, b| a.duration.total_cmp(&b.duration));
        if let Some(hold) = longest {
            set_creep(&mut row, hold, survey.height());
        }
        unevenness.push(reader.unevenness(rests).filter(|_| row.complete).unwrap_or(1.0));
        rows.push(row);
    }
    leave_out_mixed_frequencies(&mut rows, &unevenness);
    rows
}

/// A turning point where a cycle ends belongs to the next one.
fn mark_backbone(row: &mut CycleRow, backbone: &[BackbonePoint]) {
    let rows = row.rows.0..row.rows.1;
    let has =
        |direction| backbone.iter().any(|point| point.direction == direction && rows.contains(&point.row));
    (row.backbone_peak, row.backbone_valley) = (has(Direction::Up), has(Direction::Down));
}

fn set_creep(row: &mut CycleRow, hold: &CycleHold, height: f64) {
    row.hold_duration = Some(hold.duration);
    row.creep = Some(hold.drift);
    row.creep_percent = Some(100.0 * hold.drift / height);
    row.creep_per_decade = hold.per_decade;
    if hold.per_decade.is_none() {
        row.notes.push("the hold is shorter than a decade of its time steps: no creep per decade".into());
    }
}

/// Reads one part of a record.
struct CycleReader<'r> {
    survey: &'r BranchSet<'r>,
    record: &'r Record,
    branches: &'r [Branch],
    span: &'r Span,
    field: Field,
    division: Division,
}

impl CycleReader<'_> {
    fn row(&self, cycle: usize, rests: Rests) -> CycleRow {
        let Span { from, to, part, ref branches } = *self.span;
        let (first, last) = (branches.start, branches.end - 1);
        let turns = (self.branches[first].rows.end - 1, self.branches[last].rows.start);
        let path = CyclePath::between(self.record, (from, to), turns);
        let (low, high) = range(&path.x);
        let outputs: Vec<f64> = path.y.iter().copied().filter(|y| !y.is_nan()).collect();
        let measured = (!outputs.is_empty()).then(|| range(&outputs));
        let complete = part == SpanPart::Cycle;
        let time = self.record.time().map(|time| (at(time, from), at(time, to)));
        let mut row = CycleRow {
            record: self.record.name().into(),
            cycle,
            rows: (from.ceil() as usize, to.floor() as usize),
            complete,
            start_time: time.map(|(start, _)| start),
            period: time
                .filter(|_| complete)
                .map(|(start, end)| end - start + self.missing_time() - rests.at_ends()),
            input_min: Some(low),
            input_max: Some(high),
            output_min: measured.map(|range| range.0),
            output_max: measured.map(|range| range.1),
            ..CycleRow::default()
        };
        row.frequency = row.period.map(f64::recip).filter(|frequency| frequency.is_finite());
        if rests.is_mostly_one {
            row.frequency = None;
            row.notes.push("no frequency: the input rests for more than half of the cycle".into());
        }
        if rests.at_ends() > 0.0 {
            row.notes.push(format!(
                "the period leaves out a rest of {:.3} at the beginning or the end of the cycle",
                Significant(rests.at_ends())
            ));
        }
        let tips = self.tips();
        row.peak_input = tips.peak.map(|tip| tip.input);
        row.valley_input = tips.valley.map(|tip| tip.input);
        row.peak_output = tips.peak.and_then(|tip| tip.output);
        row.valley_output = tips.valley.and_then(|tip| tip.output);
        match part {
            SpanPart::Cycle => self.read_loop(&mut row, path, &tips),
            SpanPart::Beginning => row.notes.push("incomplete: the record begins within a cycle".into()),
            SpanPart::End => row.notes.push("incomplete: the record ends within a cycle".into()),
            SpanPart::All => row.notes.push("incomplete: the record has no whole cycle".into()),
        }
        row
    }

    /// How many times as long the way back lasts as the way there, of a cycle from turning point to turning point.
    fn unevenness(&self, rests: Rests) -> Option<f64> {
        let Span { from, to, ref branches, .. } = *self.span;
        let time = self.record.time().filter(|_| branches.len() == 2)?;
        let turn = at(time, (self.branches[branches.start].rows.end - 1) as f64);
        Some((at(time, to) - rests.end - turn) / (turn - at(time, from) - rests.beginning))
    }

    /// The time that a cycle lacks because its record ends a step before the level is passed: at the speed with which it was
    /// passed at the beginning.
    fn missing_time(&self) -> f64 {
        let (x, last) = (&self.record.inputs()[0], self.record.len() - 1);
        let ends_there = self.span.to == last as f64 && self.division != Division::Reversals;
        let Some(time) = self.record.time().filter(|_| ends_there) else { return 0.0 };
        let first = self.span.from.floor() as usize;
        let steps = (at(x, self.span.from) - x[last]) / (x[first + 1] - x[first]);
        if (0.0..=LAST_STEP).contains(&steps) { steps * (time[first + 1] - time[first]) } else { 0.0 }
    }

    /// Everything that needs the whole loop.
    fn read_loop(&self, row: &mut CycleRow, path: CyclePath, tips: &Tips) {
        let (lowest, highest) = range(&path.x);
        let (path, closure) = path.without_blank_ends(CLOSED).closed();
        let (low, high) = range(&path.x);
        let (low_tip, high_tip) = self.without_noise(&path, tips).unwrap_or((low, high));
        row.amplitude = Some(0.5 * (high_tip - low_tip));
        // Ends that differ in sign only by rounding have the mean 0.
        row.mean_input = Some(0.5 * (high + low))
            .map(|mean| if mean.abs() < ROUNDING * (high - low) { 0.0 } else { mean });
        match path.blanks() {
            0 => {}
            1 => row.notes.push("1 row of the cycle has no output".into()),
            blanks => row.notes.push(format!("{blanks} rows of the cycle have no output")),
        }
        let longest = path.x.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        let is_coarse = longest > FAR_APART * (high - low);
        if is_coarse {
            let percent = 100.0 * longest / (high - low);
            row.notes.push(format!(
                "rows are up to {percent:.0} % of the swing apart: what lies between is interpolated"
            ));
        }
        if self.field == Field::Battery && longest > JUMP * (high - low) {
            row.notes.push("no figures: the charge jumps, as where it is counted from 0 again".into());
            return;
        }
        let strands = self.strands(tips, (low, high));
        if let Some((falling, rising)) = &strands {
            self.read_levels(row, falling, rising);
            match self.field {
                Field::Actuator | Field::General => {
                    row.nonlinearity_percent = branches::nonlinearity_percent(falling, rising, (low, high));
                    branches::read_butterfly(row, falling, rising, (low, high));
                }
                Field::Thermal => branches::read_transitions(row, falling, rising, (low, high)),
                Field::Hydrology => {
                    row.hysteresis_index = branches::hysteresis_index(falling, rising, (low, high));
                }
                _ => {}
            }
        }
        if self.field == Field::Battery && path.blanks() == 0 {
            branches::read_battery(row, &path.x, &path.y);
        }
        if high - low < COMES_BACK * (highest - lowest) {
            row.notes.push(match closure {
                Closure::BeginningCut => {
                    "no loop: the input does not come back to where the cycle began".into()
                }
                _ => "the input goes beyond where the cycle began: the loop is the part before".into(),
            });
            if closure == Closure::BeginningCut {
                (row.coercive_input, row.remanent_output, row.squareness) = (None, None, None);
                return;
            }
        }
        let valley = row.valley_input.zip(row.valley_output);
        let peak = row.peak_input.zip(row.peak_output);
        if let (true, Some((valley, peak))) = (self.field.has_structures(), valley.zip(peak)) {
            let rise = (peak.1 - valley.1).abs();
            let noise = SURE * SQRT_2 * self.survey.output_noise.deviation();
            let (lowest, highest) = range(&path.y);
            if rise <= noise || rise < ROUNDING * (highest - lowest) {
                row.notes.push(
                    "no secant stiffness: the outputs at peak and valley do not differ by more than noise"
                        .into(),
                );
            } else {
                row.secant_stiffness = Some(secant(valley, peak)).filter(|slope| slope.is_finite());
            }
        }
        if row.secant_stiffness.is_some() {
            self.note_steep_tips(row, tips, high - low);
        }
        if self.field.has_structures() && path.blanks() == 0 {
            self.read_modulus(row);
        }
        if self.field.has_areas() && path.blanks() == 0 {
            let crosses =
                strands.as_ref().is_some_and(|(falling, rising)| cross(falling, rising, (low, high)));
            self.read_area(row, &path, high - low, crosses);
        }
        // The cycles of growing tests are open where the input passes its zero, and those of batteries by their resistance.
        let should_close = !matches!(self.field, Field::Structure | Field::Battery)
            || self.field == Field::Structure
                && matches!(self.division, Division::Reversals | Division::Start)
                && high - low >= WHOLE * (highest - lowest);
        if should_close && path.blanks() == 0 {
            self.note_open_loop(row, &path);
        }
        if self.field.has_widths() && is_coarse {
            row.notes.push("no width: the rows are too far apart".into());
        } else if self.field.has_widths() {
            self.read_width(row, &path, high - low);
        }
    }

    /// Rows next to a turning point, of nearly the same input and with clearly other outputs.
    fn note_steep_tips(&self, row: &mut CycleRow, tips: &Tips, swing: f64) {
        let (x, y) = (&self.record.inputs()[0], self.record.output());
        let change = |tip: CycleTip| {
            let turn = self.branches.get(tip.leaves).map_or(x.len() - 1, |branch| branch.rows.start);
            let beside = [turn.checked_sub(1), Some(turn + 1).filter(|row| *row < x.len())];
            let near =
                beside.into_iter().flatten().filter(|row| (x[*row] - x[turn]).abs() < AT_THE_TIP * swing);
            near.map(|row| (y[row] - y[turn]).abs()).fold(0.0, f64::max)
        };
        let largest = [tips.peak, tips.valley].into_iter().flatten().map(change).fold(0.0, f64::max);
        let height = row.output_max.zip(row.output_min).map_or(f64::INFINITY, |(high, low)| high - low);
        if largest > STEEP * height + 2.0 * SURE * self.survey.output_noise.deviation() {
            row.notes.push(format!(
                "the output changes by {:.0} % of its range from row to row at a turning point: the secant \
                 stiffness and the damping are uncertain by about as much",
                100.0 * largest / height
            ));
        }
    }

    /// Storage and loss modulus of a cycle of a sine.
    fn read_modulus(&self, row: &mut CycleRow) {
        let Some(time) = self.record.time() else { return };
        let Span { from, to, .. } = *self.span;
        let inner = from.floor() as usize + 1..to.ceil() as usize;
        let column = |values: &[f64], last: f64| -> Vec<f64> {
            let missing = (self.missing_time() > 0.0).then_some(last);
            let rows = values[inner.clone()].iter().copied();
            [at(values, from)].into_iter().chain(rows).chain([at(values, to)]).chain(missing).collect()
        };
        // Where the last step is missing, the cycle comes back to where it began.
        let (x, y) = (&self.record.inputs()[0], self.record.output());
        let end = at(time, to) + self.missing_time();
        let columns = (column(time, end), column(x, at(x, from)), column(y, at(y, from)));
        if let Some(modulus) = ComplexModulus::of(&columns.0, &columns.1, &columns.2) {
            row.storage_modulus = Some(modulus.storage);
            row.loss_modulus = Some(modulus.loss);
            row.loss_angle = Some(modulus.angle());
        }
    }

    /// Smallest and largest input of a noisy loop, as the smoothed branches have them.
    fn without_noise(&self, path: &CyclePath, tips: &Tips) -> Option<(f64, f64)> {
        if self.survey.input_noise.deviation() <= JITTERS * self.survey.width() {
            return None;
        }
        let x = &self.record.inputs()[0];
        // Both sides of a turning point, so that the row of its extreme, which noise chose, does not matter.
        let end = |tip: CycleTip| {
            let beside = [tip.leaves.checked_sub(1), Some(tip.leaves)];
            let ends: Vec<f64> = beside
                .into_iter()
                .enumerate()
                .filter_map(|(side, number)| end_without_noise(x, self.branches.get(number?)?, side == 0))
                .collect();
            (!ends.is_empty()).then(|| ends.iter().sum::<f64>() / ends.len() as f64)
        };
        let (peak, valley) = (tips.peak?, tips.valley?);
        let (low, high) = range(&path.x);
        // Of a loop that was cut, the ends are no turning points.
        let near = FAR_IN_NOISE * self.survey.input_noise.deviation();
        let is_whole = (peak.input - high).abs() <= near && (valley.input - low).abs() <= near;
        // A parabola does not describe a branch with a dwell.
        let end = |tip: CycleTip| end(tip).filter(|end| (end - tip.input).abs() <= near);
        if is_whole { Some((end(valley)?, end(peak)?)) } else { None }
    }

    /// Energy, loss per time and damping.
    fn read_area(&self, row: &mut CycleRow, path: &CyclePath, swing: f64, crosses: bool) {
        // A loop without area has no sign.
        let energy = self.field.sense_of_energy() * area(&path.x, &path.y) + 0.0;
        let deviation = self.survey.output_noise.of_sum(&weights(&path.x));
        row.energy = Some(energy);
        row.energy_deviation = Some(deviation);
        if self.field.has_magnets() {
            row.power = row.frequency.map(|frequency| frequency * energy);
        }
        if energy.abs() < SURE * deviation {
            row.notes.push("the energy is within three deviations of the noise".into());
        }
        if crosses {
            row.notes.push("the loop crosses itself: the energy is the difference of its parts".into());
        }
        let Some(stiffness) = row.secant_stiffness else { return };
        let (low, high) = range(&path.y);
        let is_line = energy.abs() < LINE * swing * (high - low);
        match damping(if is_line { energy.abs() } else { energy }, stiffness, swing) {
            Some(ratio) => row.damping_percent = Some(100.0 * ratio),
            None if crosses => row.notes.push("no equivalent damping: the loop crosses itself".into()),
            None if energy < 0.0 => {
                row.notes.push("no equivalent damping: the loop is passed anticlockwise".into());
            }
            None => row.notes.push("no equivalent damping: the secant stiffness is not positive".into()),
        }
    }

    /// Both ways between peak and valley: down, and up.
    fn strands(&self, tips: &Tips, (low, high): (f64, f64)) -> Option<(Strand, Strand)> {
        let (peak, valley) = (tips.peak?, tips.valley?);
        let beyond = CLOSED * (high - low);
        let (ends, is_last) = ((self.span.from, self.span.to), self.span.branches.end == self.branches.len());
        let closes = output_closes(self.survey, self.record.output(), ends, is_last);
        let down = self.strand(&peak, valley.input + beyond, peak.input + beyond, closes);
        let up = self.strand(&valley, peak.input - beyond, valley.input - beyond, closes);
        Some((down, up))
    }

    /// The way from a turning point on until the input reaches `target`, and no further than where it turns beyond
    /// `limit`. A loop that closes goes on where it began; one that does not, into the next cycle.
    fn strand(&self, tip: &CycleTip, target: f64, limit: f64, closes: bool) -> Strand {
        let falls = target < tip.input;
        let is_past = |x: f64, level: f64| if falls { x <= level } else { x >= level };
        // A smaller loop that goes through the middle is not on the way.
        let back = (0.5 - BACK) * target + (0.5 + BACK) * tip.input;
        let (x, (from, to)) = (&self.record.inputs()[0], (self.span.from, self.span.to));
        let mut strand = Strand::default();
        for branch in self.branches.get(tip.leaves..).unwrap_or_default() {
            let turns_back = is_past(branch.from, back) && !is_past(branch.to, back);
            if is_past(limit, branch.to) || turns_back {
                return strand;
            }
            if closes && to < (branch.rows.end - 1) as f64 {
                strand.extend_until(branch, at(x, to));
                break;
            }
            strand.extend(branch);
            if is_past(branch.to, target) {
                return strand;
            }
        }
        if !closes {
            return strand;
        }
        for (place, branch) in self.branches[self.span.branches.clone()].iter().enumerate() {
            match place {
                0 => strand.extend_from(branch, at(x, from)),
                _ => strand.extend(branch),
            }
            if is_past(branch.to, target) {
                break;
            }
        }
        strand
    }

    /// Reads the figures where both ways pass a level: residual inputs, coercive input, remanence.
    fn read_levels(&self, row: &mut CycleRow, falling: &Strand, rising: &Strand) {
        if self.field.has_structures() {
            row.residual_after_peak = falling.crossings(0.0).first().copied();
            row.residual_after_valley = rising.crossings(0.0).first().copied();
        }
        if self.field == Field::Structure {
            let notes = missed(row.residual_after_peak.is_some(), row.residual_after_valley.is_some());
            row.notes.extend(notes.map(|which| format!("{which} the output 0")));
        }
        if !self.field.has_magnets() {
            return;
        }
        let (Some((low, high)), Some(peak), Some(valley)) =
            (row.input_min.zip(row.input_max), row.peak_output, row.valley_output)
        else {
            return;
        };
        let (middle, swing, height) = (0.5 * (low + high), high - low, (peak - valley).abs());
        if let Some(joint) = joint(self.record, self.span, self.survey, self.branches) {
            row.notes.push(format!(
                "no coercive field and no remanence: {joint} as between records one after the other (--record names a \
                 column that tells them apart)"
            ));
            return;
        }
        let (down, up) = (falling.crossings(0.0), rising.crossings(0.0));
        let innermost = |found: &[f64]| {
            found.iter().copied().min_by(|a, b| (a - middle).abs().total_cmp(&(b - middle).abs()))
        };
        let (after_peak, after_valley) = (innermost(&down), innermost(&up));
        let told = |value: f64, range: f64| if value < ROUNDING * range { 0.0 } else { value };
        row.coercive_input =
            after_peak.zip(after_valley).map(|(down, up)| told(0.5 * (up - down).abs(), swing));
        match missed(after_peak.is_some(), after_valley.is_some()) {
            Some(which) => row.notes.push(format!("{which} the output 0")),
            None if down.len() > 1 && up.len() > 1 => {
                row.faults.passings = down.len().max(up.len());
                row.notes.push(format!(
                    "both branches pass the output 0 {} times, as over a straight background (--subtract \
                     slope removes it): the coercive field is that of the innermost passings",
                    row.faults.passings
                ));
            }
            None => {}
        }
        // A loop about the input 0 has its own middle at the output 0, unless the instrument has an offset.
        let own = 0.5 * (peak + valley);
        let noise = SURE * self.survey.output_noise.deviation();
        if middle.abs() <= CENTRED * swing && own.abs() > OFFSET * height + noise {
            row.faults.offset = Some(own);
            row.notes.push(format!(
                "the middle of the outputs is {:.3}, not 0 (--center removes it)",
                Significant(own)
            ));
        }
        let (down, up) = (falling.output_at(0.0, CLOSED * swing), rising.output_at(0.0, CLOSED * swing));
        row.remanent_output = down.zip(up).map(|(down, up)| told(0.5 * (down - up).abs(), height));
        row.squareness =
            row.remanent_output.map(|remanence| 2.0 * remanence / height).filter(|ratio| ratio.is_finite());
        if row.remanent_output.is_none() {
            row.notes.push("a branch does not pass the input 0: no remanence".into());
        }
    }

    /// A loop whose output does not come back with the input.
    fn note_open_loop(&self, row: &mut CycleRow, path: &CyclePath) {
        let (Some(near), Some((first, last))) = (gap(&path.x, &path.y), path.y.first().zip(path.y.last()))
        else {
            return;
        };
        // Rows near a tip that is rounded lie apart on both sides although the tip is one point.
        let gap = if near.abs() < (last - first).abs() { near } else { last - first };
        let (low, high) = range(&path.y);
        let noise = SURE * self.survey.output_noise.deviation();
        // A drift adds up to half of the gap over the whole swing to the area.
        let swing = width(&path.x);
        let adds = row.energy.is_some_and(|energy| 0.5 * gap.abs() * swing > ADDS * energy.abs());
        if (adds || gap.abs() > OPEN * (high - low)) && gap.abs() > noise + LINE * (high - low) {
            row.faults.opening = Some(gap);
            row.notes.push(format!(
                "{OPEN_LOOP} {:.2} of {:.2}: its reversals differ, the output drifts (--subtract drift), or it \
                 began in another state",
                Significant(gap.abs()),
                Significant(high - low)
            ));
        }
    }

    /// The largest distance of the rising and the falling parts of the cycle, if they have outputs over its swing.
    fn read_width(&self, row: &mut CycleRow, path: &CyclePath, swing: f64) {
        let numbers = self.span.branches.clone();
        let (rising, falling): (Vec<usize>, Vec<usize>) =
            numbers.partition(|&number| self.branches[number].rises());
        let (mut covered, mut widest_of_all): (f64, Option<Widest>) = (0.0, None);
        for (&up, &down) in rising.iter().flat_map(|up| falling.iter().map(move |down| (up, down))) {
            let (a, b) = (self.inputs_within(up), self.inputs_within(down));
            let common = (a.0.max(b.0), a.1.min(b.1));
            if common.1 > common.0
                && let Some(found) = widest(&self.branches[up], &self.branches[down], common)
            {
                covered += common.1 - common.0;
                if widest_of_all.is_none_or(|known| found.apart > known.apart) {
                    widest_of_all = Some(found);
                }
            }
        }
        let Some(widest) = widest_of_all.filter(|_| covered >= COMES_BACK * swing) else {
            row.notes.push("no width: both branches have outputs over a part of the swing only".into());
            return;
        };
        if widest.apart < SURE * widest.deviation {
            row.notes.push("no width: it is within three deviations of the noise".into());
            return;
        }
        row.width = Some(widest.apart);
        row.width_deviation = Some(widest.deviation);
        row.width_at_input = Some(widest.x);
        let (low, high) = range(&path.y);
        row.width_percent = Some(100.0 * widest.apart / (high - low)).filter(|percent| percent.is_finite());
    }

    /// Smallest and largest input of the part of a branch that belongs to the cycle and has outputs.
    fn inputs_within(&self, number: usize) -> (f64, f64) {
        let branch = &self.branches[number];
        let x = &self.record.inputs()[0];
        let begin = at(x, self.span.from.max(branch.rows.start as f64));
        let end = at(x, self.span.to.min((branch.rows.end - 1) as f64));
        let (low, high) = branch.curve.range();
        (begin.min(end).max(low), begin.max(end).min(high))
    }

    /// Peak and valley, and the branches that begin there.
    fn tips(&self) -> Tips {
        let Span { from, to, part, ref branches } = *self.span;
        let mut tips = Tips::default();
        for number in branches.clone() {
            let branch = &self.branches[number];
            let (start, end) = (branch.rows.start as f64, (branch.rows.end - 1) as f64);
            // A cycle from turning point to turning point begins at one; what it ends at is that of the next.
            let begins_here =
                self.division == Division::Reversals && part == SpanPart::Cycle && start == from;
            if begins_here {
                let (input, output) = self.end_of_loop(number);
                tips.take(CycleTip { input, output, leaves: number }, !branch.rises());
            }
            if end > from && end < to {
                let output = output_at_end(branch, branch.to);
                tips.take(CycleTip { input: branch.to, output, leaves: number + 1 }, branch.rises());
            }
        }
        tips
    }

    /// The end of the loop of a cycle from turning point to turning point: the mean of its beginning and its end where both
    /// are the same input, otherwise that of the shorter branch.
    fn end_of_loop(&self, first: usize) -> (f64, Option<f64>) {
        let begin = &self.branches[first];
        let own = (begin.from, output_at_end(begin, begin.from));
        let Some(end) =
            self.branches.get(self.span.branches.end - 1).filter(|end| end.rises() != begin.rises())
        else {
            return own;
        };
        let back = (end.to, output_at_end(end, end.to));
        if (back.0 - own.0).abs() <= CLOSED * begin.travel() {
            let mean = |a: f64, b: f64| 0.5 * (a + b);
            return (mean(own.0, back.0), own.1.zip(back.1).map(|(a, b)| mean(a, b)).or(own.1));
        }
        if end.travel() < begin.travel() { back } else { own }
    }
}

/// Which branch does not pass a level.
fn missed(after_peak: bool, after_valley: bool) -> Option<&'static str> {
    match (after_peak, after_valley) {
        (false, false) => Some("neither branch passes"),
        (false, true) => Some("the branch after the peak does not pass"),
        (true, false) => Some("the branch after the valley does not pass"),
        (true, true) => None,
    }
}
