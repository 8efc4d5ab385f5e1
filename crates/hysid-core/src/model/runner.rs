//! Run of a model over a record in chunks of rows: the common path of all simulations.
//!
//! Each chunk has the rates of its first input and the time steps. They follow from the neighbouring rows, so
//! the outputs are the same to the last bit for any division of a record.

use std::borrow::Cow;
use std::ops::Range;

use crate::data::initial_state::{found_past, lead_in_of_period};
use crate::data::rate::RateMethod;
use crate::data::record::{Excitation, FadingResidual, Fingerprint, MemberState, RecordState};
use crate::error::{DataProblem, Result};
use crate::law::series::lead_in_samples;
use crate::law::{Classical, ClassicalState, Sample, remaining_share};
use crate::model::band::disagreement;
use crate::model::ensemble::{Excursion, MedianBuffers};
use crate::model::input_transform::{InputPast, InputTransform, SeenLeadIn};
use crate::model::ranges::Ranges;
use crate::model::{Ensemble, Model, Predictor};
use crate::network::free_run::{CHUNK, FreeRun};

/// How sure an output is.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct OutputSpread {
    /// How much the members of an ensemble disagree; 0 for a single model.
    pub disagreement: f64,
    /// Degree of having been outside the trained range, 0 to 1.
    pub outside: f64,
}

#[derive(Debug, Clone)]
pub(super) struct Runner<'m> {
    body: RunnerKind<'m>,
    excursion: Excursion,
    range: (f64, f64),
    /// Rates of the rows of a chunk, by each method that the model or a member has.
    rates: Vec<(RateMethod, Vec<f64>)>,
    steps: Vec<f64>,
    /// Lead-in of a record that has none of its own.
    lead_in: &'m [f64],
    /// Such a record begins after one period of itself: its rows come all at once.
    is_periodic: bool,
    /// The memory has been driven along the lead-in of the record.
    is_begun: bool,
    /// Residual at the end of the known beginning of the record, if it remains.
    residual: Option<FadingResidual>,
    /// Trained ranges to compare with, if requested, and the method for the rate.
    ranges: Option<(Ranges, Option<RateMethod>)>,
}

#[derive(Debug, Clone)]
enum RunnerKind<'m> {
    Single(Box<SingleRunner<'m>>),
    Ensemble(Box<EnsembleRunner<'m>>),
}

/// A single model: a network or a law, with its input transform.
#[derive(Debug, Clone)]
struct SingleRunner<'m> {
    mechanism: Mechanism<'m>,
    /// `None` for a model without input transform.
    preprocessing: Option<&'m InputTransform>,
    rate: Option<RateMethod>,
    past: InputPast,
    /// Transformed columns of a chunk.
    seen: Vec<Vec<f64>>,
    seen_rate: Vec<f64>,
}

#[derive(Debug, Clone)]
enum Mechanism<'m> {
    Network(Box<FreeRun<'m>>),
    Law(&'m Classical, Box<ClassicalState>, Vec<Sample>),
}

/// The members of an ensemble, and room for their outputs.
#[derive(Debug, Clone)]
struct EnsembleRunner<'m> {
    ensemble: &'m Ensemble,
    members: Vec<SingleRunner<'m>>,
    outputs: Vec<Vec<f64>>,
    medians: MedianBuffers,
}

/// Some rows of a record: inputs in the user's units, rates by method, and the time since the row before.
struct Chunk<'a> {
    name: &'a str,
    inputs: &'a [&'a [f64]],
    rates: &'a [(RateMethod, Vec<f64>)],
    steps: &'a [f64],
}

impl<'m> Runner<'m> {
    /// A run of a model, from its initial state where a record has no other.
    pub fn of_model(model: &'m Model) -> Self {
        let range = model.first_input_range();
        let run = Self::of_body(&model.body, Some(&model.preprocessing), model.rate, range);
        Self { lead_in: &model.lead_in, is_periodic: model.is_periodic, ..run }
    }

    /// A run of what simulates alone, from the virgin state where a record has no other; `range` is that of its first input
    /// in training.
    pub fn of_body(
        body: &'m Predictor,
        preprocessing: Option<&'m InputTransform>,
        rate: Option<RateMethod>,
        range: (f64, f64),
    ) -> Self {
        let body = match body {
            Predictor::Ensemble(ensemble) => RunnerKind::Ensemble(Box::new(EnsembleRunner::of(ensemble))),
            body => RunnerKind::Single(Box::new(SingleRunner::of(body, preprocessing, rate))),
        };
        let mut methods: Vec<RateMethod> = body.singles().iter().filter_map(|single| single.rate).collect();
        methods.extend(rate);
        methods.sort_unstable_by_key(|method| *method as u8);
        methods.dedup();
        Self {
            body,
            excursion: Excursion::beyond(range),
            range,
            rates: methods.into_iter().map(|method| (method, Vec::new())).collect(),
            steps: Vec::new(),
            lead_in: &[],
            is_periodic: false,
            is_begun: false,
            residual: None,
            ranges: None,
        }
    }

    /// The same, which compares the rows with the ranges that the model was trained on.
    pub fn watching(mut self, model: &Model) -> Self {
        self.ranges = Some((Ranges::of(model), model.rate));
        self
    }

    /// The ranges of the rows so far, if they are compared with those trained on.
    pub fn ranges(&self) -> Option<&Ranges> {
        self.ranges.as_ref().map(|(ranges, _)| ranges)
    }

    /// Rows before and behind a row from which its rate and its time step follow, at most.
    pub fn rows_around(&self) -> (usize, usize) {
        let around = self.rates.iter().map(|(method, _)| method.rows_around());
        around.fold((1, 0), |most, around| (most.0.max(around.0), most.1.max(around.1)))
    }

    /// Back to the initial state, before another record.
    pub fn reset(&mut self) {
        self.is_begun = false;
        self.residual = None;
        self.body.singles_mut().iter_mut().for_each(SingleRunner::reset);
        self.excursion = Excursion::beyond(self.range);
    }

    /// The outputs of a whole record, from its initial state.
    ///
    /// # Errors
    /// Another number of inputs than the model has, a rate that cannot be computed.
    pub fn record(&mut self, excitation: &Excitation<'_>) -> Result<Vec<f64>> {
        let mut outputs = vec![0.0; excitation.len()];
        self.reset();
        self.rows(excitation, 0, &mut outputs, None)?;
        Ok(outputs)
    }

    /// The outputs of the next rows: those of the excitation from `first` on. The rows around them that their rates
    /// follow from are there too, unless the record ends.
    pub fn rows(
        &mut self,
        excitation: &Excitation<'_>,
        first: usize,
        outputs: &mut [f64],
        mut spreads: Option<&mut [OutputSpread]>,
    ) -> Result<()> {
        self.check_inputs(excitation)?;
        for (index, outputs) in outputs.chunks_mut(CHUNK).enumerate() {
            let rows = index * CHUNK..index * CHUNK + outputs.len();
            let spreads = spreads.as_deref_mut().map(|spreads| &mut spreads[rows.clone()]);
            self.chunk(excitation, first + rows.start, outputs, spreads)?;
        }
        Ok(())
    }

    fn check_inputs(&self, excitation: &Excitation<'_>) -> Result<()> {
        let (expected, found) = (self.body.inputs(), excitation.inputs().len());
        if expected == found {
            return Ok(());
        }
        Err(excitation.defect(None, None, DataProblem::Inputs { expected, found }))
    }

    /// Drives the memory along the lead-in, before the first row of a record, which is here.
    fn begin(&mut self, excitation: &Excitation<'_>, first: usize) -> Result<()> {
        if std::mem::replace(&mut self.is_begun, true) {
            return Ok(());
        }
        let first_row: Vec<f64> = excitation.inputs().iter().map(|input| input[first]).collect();
        let found = match excitation.state() {
            Some(state) => Some(Cow::Borrowed(state)),
            None if excitation.known().iter().all(|y| y.is_nan()) => None,
            None => Some(Cow::Owned(self.find_state(excitation, first)?)),
        };
        if let Some(state) = found {
            self.residual = state.residual;
            self.body.begin_in(&state.members, &first_row);
            return Ok(());
        }
        let lead_in = self.lead_in_of(excitation);
        if lead_in.is_empty() {
            return Ok(());
        }
        let rows: Vec<f64> = lead_in.iter().chain(&first_row[..1]).copied().collect();
        self.body.singles_mut().iter_mut().for_each(|single| single.lead_in(&rows, &first_row));
        Ok(())
    }

    /// Lead-in of a record without a known beginning: its own, or that of the model.
    fn lead_in_of<'e>(&self, excitation: &Excitation<'e>) -> Cow<'e, [f64]>
    where
        'm: 'e,
    {
        match excitation.lead_in() {
            Some(lead_in) => Cow::Borrowed(lead_in),
            None if self.is_periodic => Cow::Owned(lead_in_of_period(excitation.inputs()[0])),
            None => Cow::Borrowed(self.lead_in),
        }
    }

    /// Finds the state before the first row of a record with a known beginning, which is here: each member of an ensemble
    /// its own. The memory remains in its initial state.
    pub fn find_state(&mut self, excitation: &Excitation<'_>, first: usize) -> Result<RecordState> {
        self.check_inputs(excitation)?;
        let known = excitation.known();
        let known = &known[..known.len().min(excitation.len() - first)];
        let rows = first..first + known.len();
        self.fill(excitation, rows.clone())?;
        let inputs: Vec<&[f64]> = excitation.inputs().iter().map(|input| &input[rows.clone()]).collect();
        let chunk =
            Chunk { name: excitation.name(), inputs: &inputs, rates: &self.rates, steps: &self.steps };
        let singles = self.body.singles();
        let otherwise = self.lead_in_of(excitation);
        let state_of = |single: &SingleRunner<'_>| single.found_state(&chunk, known, self.range, &otherwise);
        let members: Vec<MemberState> = singles.iter().map(state_of).collect();
        let remaining = remaining_share(median(singles.iter().map(SingleRunner::residual_rows).collect()));
        let mut state =
            RecordState { members, residual: None, range: self.range, model: Fingerprint::default() };
        if remaining > 0.0 {
            let (mut body, mut outputs) = (self.body.clone(), vec![0.0; known.len()]);
            let first_row: Vec<f64> = inputs.iter().map(|input| input[0]).collect();
            body.begin_in(&state.members, &first_row);
            body.run(&chunk, &mut self.excursion.clone(), &mut outputs, None)?;
            let residuals = known.iter().zip(&outputs).map(|(y, output)| y - output);
            let residual = residuals.rev().find(|residual| !residual.is_nan()).unwrap_or_default();
            state.residual = Some(FadingResidual { rows: known.len(), residual, remaining });
        }
        Ok(state)
    }

    /// Rates and steps of some rows.
    fn fill(&mut self, excitation: &Excitation<'_>, rows: Range<usize>) -> Result<()> {
        for (method, rates) in &mut self.rates {
            rates.resize(rows.len(), 0.0);
            method.fill(excitation, rows.start, rates)?;
        }
        self.steps.clear();
        self.steps.extend(rows.map(|row| match excitation.time() {
            Some(time) if row > 0 => time[row] - time[row - 1],
            _ => 0.0,
        }));
        Ok(())
    }

    fn chunk(
        &mut self,
        excitation: &Excitation<'_>,
        first: usize,
        outputs: &mut [f64],
        spreads: Option<&mut [OutputSpread]>,
    ) -> Result<()> {
        let rows = first..first + outputs.len();
        self.begin(excitation, first)?;
        self.fill(excitation, rows.clone())?;
        let inputs: Vec<&[f64]> = excitation.inputs().iter().map(|input| &input[rows.clone()]).collect();
        let chunk =
            Chunk { name: excitation.name(), inputs: &inputs, rates: &self.rates, steps: &self.steps };
        if let Some((ranges, method)) = &mut self.ranges {
            ranges.take(&inputs, method.map(|method| chunk.rate(method)));
        }
        self.body.run(&chunk, &mut self.excursion, outputs, spreads)?;
        if let Some(residual) = &mut self.residual {
            outputs.iter_mut().for_each(|output| *output = residual.corrected(*output));
        }
        Ok(())
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 { values[half] } else { 0.5 * (values[half - 1] + values[half]) }
}

impl<'m> RunnerKind<'m> {
    fn singles(&self) -> &[SingleRunner<'m>] {
        match self {
            Self::Single(single) => std::slice::from_ref(single),
            Self::Ensemble(members) => &members.members,
        }
    }

    fn singles_mut(&mut self) -> &mut [SingleRunner<'m>] {
        match self {
            Self::Single(single) => std::slice::from_mut(single),
            Self::Ensemble(members) => &mut members.members,
        }
    }

    /// Begins a record in these states of the members; the memory is in its initial state.
    fn begin_in(&mut self, members: &[MemberState], first_row: &[f64]) {
        self.singles_mut()
            .iter_mut()
            .zip(members)
            .for_each(|(single, state)| single.begin_in(state, first_row));
    }

    fn run(
        &mut self,
        chunk: &Chunk<'_>,
        excursion: &mut Excursion,
        outputs: &mut [f64],
        spreads: Option<&mut [OutputSpread]>,
    ) -> Result<()> {
        match self {
            Self::Single(single) => {
                single.run(chunk, outputs)?;
                for (spread, &x) in spreads.into_iter().flatten().zip(chunk.inputs[0]) {
                    *spread = OutputSpread { disagreement: 0.0, outside: excursion.take(x) };
                }
                Ok(())
            }
            Self::Ensemble(members) => members.run(chunk, excursion, outputs, spreads),
        }
    }

    /// Inputs of a record; those of all members are as many.
    fn inputs(&self) -> usize {
        self.singles()[0].inputs()
    }
}

impl Chunk<'_> {
    fn rate(&self, method: RateMethod) -> &[f64] {
        let known = self.rates.iter().find(|(known, _)| *known == method);
        known.map_or(&[], |(_, rates)| rates)
    }
}

impl<'m> SingleRunner<'m> {
    fn of(body: &'m Predictor, preprocessing: Option<&'m InputTransform>, rate: Option<RateMethod>) -> Self {
        let mechanism = match body {
            Predictor::Network { network, scaling } => {
                let rate = rate.map(|_| RateMethod::Given);
                Mechanism::Network(Box::new(FreeRun::new(network, scaling, rate)))
            }
            Predictor::Law(law) => Mechanism::Law(law, Box::new(law.virgin()), Vec::new()),
            Predictor::Ensemble(_) => unreachable!("members are networks or laws"),
        };
        let preprocessing = preprocessing.filter(|preprocessing| !preprocessing.is_none());
        let (seen, seen_rate) = (Vec::new(), Vec::new());
        Self { mechanism, preprocessing, rate, past: InputPast::default(), seen, seen_rate }
    }

    fn inputs(&self) -> usize {
        let added = self.preprocessing.map_or(0, InputTransform::added_inputs);
        match &self.mechanism {
            Mechanism::Network(network) => network.inputs() - added,
            Mechanism::Law(law, ..) => (1 + law.further_inputs()).saturating_sub(added),
        }
    }

    fn reset(&mut self) {
        self.past = InputPast::default();
        match &mut self.mechanism {
            Mechanism::Network(network) => network.reset(),
            Mechanism::Law(law, state, _) => **state = law.virgin(),
        }
    }

    /// Drives the memory along a lead-in, whose last row has the first input of `first_row`.
    fn lead_in(&mut self, rows: &[f64], first_row: &[f64]) {
        let nothing = InputTransform::default();
        let SeenLeadIn { first, others } =
            self.preprocessing.unwrap_or(&nothing).lead_in(rows, first_row, &mut self.past);
        match &mut self.mechanism {
            Mechanism::Network(network) => network.lead_in(&first, &others),
            Mechanism::Law(law, state, _) => {
                let samples: Vec<Sample> = lead_in_samples(&first).collect();
                let columns: Vec<Vec<f64>> = others.iter().map(|&value| vec![value; first.len()]).collect();
                let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
                law.run_on(state, &samples, &columns, &mut vec![0.0; samples.len()]);
            }
        }
    }

    /// Rows within which the residual at the end of a known beginning falls to 1/e.
    fn residual_rows(&self) -> f64 {
        match &self.mechanism {
            Mechanism::Network(_) => 0.0,
            Mechanism::Law(law, ..) => law.residual_rows(),
        }
    }

    /// The state that suits the outputs of the first rows best: free states of a law, or a past of the input. `otherwise` is
    /// the past without known outputs.
    fn found_state(
        &self,
        chunk: &Chunk<'_>,
        known: &[f64],
        range: (f64, f64),
        otherwise: &[f64],
    ) -> MemberState {
        let nothing = InputTransform::default();
        let preprocessing = self.preprocessing.unwrap_or(&nothing);
        if let Mechanism::Law(law, ..) = &self.mechanism {
            let mut seen = Vec::new();
            see(preprocessing, chunk.inputs, &mut InputPast::default(), &mut seen);
            let rate = self.rate.map(|method| chunk.rate(method));
            let rate = |row: usize| rate.map_or(0.0, |rate| preprocessing.rate(rate[row]));
            let sample = |(row, &x): (usize, &f64)| Sample { x, rate: rate(row), step: chunk.steps[row] };
            let samples: Vec<Sample> = seen[0].iter().enumerate().map(sample).collect();
            let further: Vec<&[f64]> = seen[1..].iter().map(Vec::as_slice).collect();
            if let Some(states) = law.found_states(&samples, &further, known) {
                return MemberState::Free(states);
            }
        }
        let first_row: Vec<f64> = chunk.inputs.iter().map(|input| input[0]).collect();
        let mut outputs = vec![0.0; known.len()];
        let mut trial = self.clone();
        let misfit = |past: &[f64], rows: Range<usize>| -> f64 {
            trial.reset();
            trial.begin_after(past, &first_row);
            if trial.run(chunk, &mut outputs).is_err() {
                return f64::INFINITY;
            }
            let errors = outputs[rows.clone()].iter().zip(&known[rows]).filter(|(_, y)| !y.is_nan());
            errors.map(|(output, y)| (output - y) * (output - y)).sum()
        };
        MemberState::Past(found_past(range, known, otherwise, misfit))
    }

    fn begin_in(&mut self, state: &MemberState, first_row: &[f64]) {
        match (state, &mut self.mechanism) {
            (MemberState::Past(past), _) => self.begin_after(past, first_row),
            (MemberState::Free(states), Mechanism::Law(law, state, _)) => **state = law.begun_with(states),
            (MemberState::Free(_), Mechanism::Network(_)) => {}
        }
    }

    fn begin_after(&mut self, past: &[f64], first_row: &[f64]) {
        if !past.is_empty() {
            let rows: Vec<f64> = past.iter().chain(&first_row[..1]).copied().collect();
            self.lead_in(&rows, first_row);
        }
    }

    fn run(&mut self, chunk: &Chunk<'_>, outputs: &mut [f64]) -> Result<()> {
        let rate = self.rate.map(|method| chunk.rate(method));
        let Some(preprocessing) = self.preprocessing else {
            return self.mechanism.run(chunk, chunk.inputs, rate, outputs);
        };
        see(preprocessing, chunk.inputs, &mut self.past, &mut self.seen);
        let rate = rate.map(|rate| {
            self.seen_rate.clear();
            self.seen_rate.extend(rate.iter().map(|&rate| preprocessing.rate(rate)));
            self.seen_rate.as_slice()
        });
        let seen: Vec<&[f64]> = self.seen.iter().map(Vec::as_slice).collect();
        self.mechanism.run(chunk, &seen, rate, outputs)
    }
}

/// Transformed inputs, column by column.
fn see(preprocessing: &InputTransform, inputs: &[&[f64]], past: &mut InputPast, seen: &mut Vec<Vec<f64>>) {
    seen.resize(inputs.len() + preprocessing.added_inputs(), Vec::new());
    seen.iter_mut().for_each(Vec::clear);
    let (mut sample, mut sample_seen) = (vec![0.0; inputs.len()], Vec::new());
    for row in 0..inputs[0].len() {
        sample.iter_mut().zip(inputs).for_each(|(value, input)| *value = input[row]);
        preprocessing.sample(&sample, past, &mut sample_seen);
        seen.iter_mut().zip(&sample_seen).for_each(|(column, &value)| column.push(value));
    }
}

impl Mechanism<'_> {
    /// Continues with transformed inputs and rate.
    fn run(
        &mut self,
        chunk: &Chunk<'_>,
        inputs: &[&[f64]],
        rate: Option<&[f64]>,
        outputs: &mut [f64],
    ) -> Result<()> {
        match self {
            Self::Network(network) => {
                let excitation = Excitation::unchecked(chunk.name, None, inputs.to_vec(), rate);
                network.rows(&excitation, 0, chunk.steps, outputs)
            }
            Self::Law(law, state, samples) => {
                let rates = rate.into_iter().flatten().copied().chain(std::iter::repeat(0.0));
                let rows = inputs[0].iter().zip(rates).zip(chunk.steps);
                samples.clear();
                samples.extend(rows.map(|((&x, rate), &step)| Sample { x, rate, step }));
                law.run_on(state, samples, &inputs[1..], outputs);
                Ok(())
            }
        }
    }
}

impl<'m> EnsembleRunner<'m> {
    fn of(ensemble: &'m Ensemble) -> Self {
        let member =
            |member: &'m Model| SingleRunner::of(&member.body, Some(&member.preprocessing), member.rate);
        let members: Vec<SingleRunner<'m>> = ensemble.members().iter().map(member).collect();
        let outputs = vec![Vec::new(); members.len()];
        Self { ensemble, members, outputs, medians: MedianBuffers::new(ensemble.group()) }
    }

    fn run(
        &mut self,
        chunk: &Chunk<'_>,
        excursion: &mut Excursion,
        outputs: &mut [f64],
        spreads: Option<&mut [OutputSpread]>,
    ) -> Result<()> {
        for (member, of_member) in self.members.iter_mut().zip(&mut self.outputs) {
            of_member.resize(outputs.len(), 0.0);
            member.run(chunk, of_member)?;
        }
        let (group, of_members, medians) = (self.ensemble.group(), &self.outputs, &mut self.medians);
        let mut spreads = spreads.into_iter().flatten();
        for (row, (output, &x)) in outputs.iter_mut().zip(chunk.inputs[0]).enumerate() {
            let outside = excursion.take(x);
            *output = medians.output(group, outside, |member| of_members[member][row]);
            if let Some(spread) = spreads.next() {
                let all = medians.predictions(group, outside, |member| of_members[member][row]);
                *spread = OutputSpread { disagreement: disagreement(all), outside };
            }
        }
        Ok(())
    }
}
