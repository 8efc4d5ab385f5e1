//! Results of the tests, in sentences.

use hysid_core::data::record::{Dataset, SpeedEvidence};
use hysid_core::data::unit::suffix;
use hysid_core::elementary::square;
use hysid_core::significant::Significant;

use super::{
    GroupedResiduals, LEVEL, ResidualFinding, ResidualGroup, ResidualOptions, ResidualTest, ResidualVerdict,
    Residuals,
};
use crate::distribution::t_tail;
use crate::serial::SerialSum;

/// A residual with less of its variance predictable from its past is as good as white.
const SMALL_SHARE: f64 = 0.1;

/// With fewer independent rows only large differences are found.
const FEW_ROWS: f64 = 50.0;

/// Advice where the residual of a model with a rate depends on the rate.
const OTHER_RATE_DEPENDENCE: &str = "The rate dependence of the model is not that of the data: too strong, too weak or of \
    another form. Compare it on held-out data with a model without the rate and with one with relaxation neurons (xpnn+), \
    and check for a delay between the channels (diagnose the data).";

/// Limitation of all tests.
pub(super) fn caution(residuals: &Residuals, options: &ResidualOptions) -> Option<String> {
    let Residuals { rows, effective_rows, .. } = *residuals;
    let few = (effective_rows < FEW_ROWS).then(|| {
        format!(
            "The residual changes so slowly that its {rows} rows count as {:.2} independent ones: only large differences \
             can be told from chance, and “not found” does not mean that there is no structure.",
            Significant(effective_rows)
        )
    });
    let fitted = options.is_training.then(|| {
        "The model was fitted to these data, which takes correlations with the input out of the residual: held-out data \
         tell more."
            .to_string()
    });
    let all: Vec<String> = few.into_iter().chain(fitted).collect();
    (!all.is_empty()).then(|| all.join(" "))
}

/// All findings, with p-values that are corrected for their number.
pub(super) fn findings(
    residuals: &Residuals,
    total: &SerialSum,
    unit: Option<&str>,
    options: &ResidualOptions,
    data: &Dataset,
) -> Vec<ResidualFinding> {
    let mut p_values = vec![Some(bias_p_value(residuals, total)), Some(residuals.whiteness.p_value)];
    p_values.extend(residuals.inputs.iter().map(|input| Some(input.p_value)));
    p_values.extend(residuals.places.iter().map(of_place));
    let adjusted = holm(&p_values);
    let is_of_one_speed = data.has_time() && data.speeds() == SpeedEvidence::One;
    let teller = FindingWriter { residuals, unit, options, is_of_one_speed };
    let mut told = vec![teller.bias(adjusted[0]), teller.whiteness(adjusted[1])];
    let (of_inputs, of_places) = adjusted[2..].split_at(residuals.inputs.len());
    told.extend((0..of_inputs.len()).map(|at| teller.input(at, of_inputs[at])));
    told.extend(residuals.places.iter().zip(of_places).map(|(place, p)| teller.place(place, *p)));
    let with_p_values = told.into_iter().zip(p_values).zip(adjusted);
    with_p_values.map(|((told, p_value), adjusted)| told.finding(p_value, adjusted)).collect()
}

/// The smaller of both p-values of a place, for two tests.
fn of_place(place: &GroupedResiduals) -> Option<f64> {
    let smaller = place.size_p_value?.min(place.bias_p_value?);
    Some((2.0 * smaller).min(1.0))
}

fn bias_p_value(residuals: &Residuals, total: &SerialSum) -> f64 {
    let spread = total.covariance.at(0, 0).sqrt();
    let sum = residuals.bias * residuals.rows as f64;
    if spread > 0.0 { t_tail(sum / spread, total.degrees) } else { 1.0 }
}

/// The correction of Holm: the smallest of `m` p-values times `m`, the next times `m - 1`, ..., none smaller than the one
/// before.
fn holm(p_values: &[Option<f64>]) -> Vec<Option<f64>> {
    let mut order: Vec<(usize, f64)> =
        p_values.iter().enumerate().filter_map(|(at, p)| Some((at, (*p)?))).collect();
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut adjusted = vec![None; p_values.len()];
    let mut largest = 0.0f64;
    for (rank, &(at, p)) in order.iter().enumerate() {
        largest = largest.max((p * (order.len() - rank) as f64).min(1.0));
        adjusted[at] = Some(largest);
    }
    adjusted
}

/// A finding without its p-values.
struct PlainFinding {
    test: ResidualTest,
    input: Option<String>,
    statement: String,
    advice: Option<&'static str>,
}

impl PlainFinding {
    fn finding(self, p_value: Option<f64>, adjusted_p_value: Option<f64>) -> ResidualFinding {
        let verdict = match adjusted_p_value {
            None => ResidualVerdict::NotTestable,
            Some(p) if p < LEVEL => ResidualVerdict::Found,
            Some(_) => ResidualVerdict::NotFound,
        };
        let advice = self.advice.filter(|_| verdict == ResidualVerdict::Found).map(Into::into);
        let Self { test, input, statement, .. } = self;
        ResidualFinding { test, input, verdict, p_value, adjusted_p_value, statement, advice }
    }
}

/// Tells what was found.
struct FindingWriter<'a> {
    residuals: &'a Residuals,
    unit: Option<&'a str>,
    options: &'a ResidualOptions,
    /// A fit uses no rate, because each input value was passed at one speed.
    is_of_one_speed: bool,
}

impl FindingWriter<'_> {
    fn value(&self, value: f64) -> String {
        format!("{:.3}{}", Significant(value), suffix(self.unit))
    }

    fn bias(&self, p: Option<f64>) -> PlainFinding {
        let Residuals { bias, rms, .. } = *self.residuals;
        let share = if rms > 0.0 { 100.0 * bias.abs() / rms } else { 0.0 };
        let amount =
            format!("{} ({:.2} % of its RMS of {})", self.value(bias), Significant(share), self.value(rms));
        let statement = match is_found(p) {
            true => format!("The mean of the residual is {amount}, not 0 ({}).", words(p)),
            false => format!("The mean of the residual is {amount}: no bias was found ({}).", words(p)),
        };
        let advice = "The output is offset against that of the training data: check the zero of the sensor and the \
                      initial state of the records.";
        PlainFinding { test: ResidualTest::Bias, input: None, statement, advice: Some(advice) }
    }

    fn whiteness(&self, p: Option<f64>) -> PlainFinding {
        let Residuals { whiteness, rows, effective_rows, .. } = self.residuals;
        let lags = whiteness.degrees_of_freedom;
        let share = 100.0 * whiteness.predictable_share;
        let statement = match is_found(p) {
            true => format!(
                "The residual is not white: its last {lags} values predict {:.2} % of its variance ({}); for its mean, \
                 {rows} rows count as {:.2} independent ones.",
                Significant(share),
                words(p),
                Significant(*effective_rows)
            ),
            false => {
                format!("The residual is white up to lag {lags}, as far as {rows} rows tell ({}).", words(p))
            }
        };
        let advice = match whiteness.predictable_share < SMALL_SHARE {
            true => "The correlation is weak: little is gained by a larger model.",
            false => {
                "Part of the residual is not noise of single rows: see the other findings for its origin. If there is \
                 none, it is slow noise of the sensor, or a memory that the model does not have."
            }
        };
        PlainFinding { test: ResidualTest::Whiteness, input: None, statement, advice: Some(advice) }
    }

    fn input(&self, at: usize, p: Option<f64>) -> PlainFinding {
        let input = &self.residuals.inputs[at];
        let (name, _) = hysid_core::data::unit::split(&input.input);
        let what = if input.of_rate { format!("the rate of {name}") } else { name.to_string() };
        // The lag that decides is the one furthest beyond its bound; of a rate it is the same row.
        let beyond = |k: &usize| input.correlation[*k].abs() / input.bounds[*k].max(f64::MIN_POSITIVE);
        let tested = if input.of_rate { 1 } else { input.lags.len() };
        let at = (0..tested).max_by(|a, b| beyond(a).total_cmp(&beyond(b))).unwrap_or(0);
        let (lag, r) = (input.lags[at], input.correlation[at]);
        let when = match lag {
            0 => "in the same row".to_string(),
            1 => "one row before".to_string(),
            rows => format!("{rows} rows before"),
        };
        let statement = match is_found(p) {
            true => format!(
                "The residual is correlated with {what} {when}: r = {:.2} ({}).",
                Significant(r),
                words(p)
            ),
            false => format!("No correlation of the residual with {what} was found ({}).", words(p)),
        };
        let advice = match input.of_rate {
            true => self.advice_of_rate(r),
            false => {
                "A larger model, or one with more memory, can represent this: more operators or neurons, or the default \
                 model (auto)."
            }
        };
        let test = if input.of_rate { ResidualTest::Rate } else { ResidualTest::Input };
        let input = (test == ResidualTest::Input).then(|| input.input.clone());
        PlainFinding { test, input, statement, advice: Some(advice) }
    }

    /// Remedy for a correlation `r` with the rate in the same row.
    fn advice_of_rate(&self, r: f64) -> &'static str {
        if self.is_of_one_speed() {
            return "Each input value was passed at about one speed, so that a dependence on the rate, loops of a wrong width and a \
                    delay between the channels look the same: check for a delay (diagnose the data), and measure at a second \
                    speed before you give the model the rate.";
        }
        if self.share_of_direction() > r * r {
            return "The residual follows the direction of the input more closely than its rate: the simulated loops are too \
                    wide or too narrow; see the finding by direction.";
        }
        if self.options.uses_rate {
            return OTHER_RATE_DEPENDENCE;
        }
        "The residual depends on the rate: give the model the rate of the input (option rate), or a law that uses it, or \
         check for a delay between the channels (diagnose the data)."
    }

    fn place_of(&self, test: ResidualTest) -> Option<&GroupedResiduals> {
        self.residuals.places.iter().find(|place| place.test == test)
    }

    /// True if speed and place in the half cycle cannot be distinguished.
    fn is_of_one_speed(&self) -> bool {
        let is_doubtful = |place: &GroupedResiduals| place.caution.is_some() || place.not_testable.is_some();
        self.is_of_one_speed || self.place_of(ResidualTest::Speed).is_none_or(is_doubtful)
    }

    /// Share of the variance that the means of rising and falling rows explain.
    fn share_of_direction(&self) -> f64 {
        let Residuals { rows, rms, bias, .. } = *self.residuals;
        let groups = self.place_of(ResidualTest::Direction).map_or(&[][..], |place| &place.groups);
        let explained = groups.iter().map(|group| group.rows as f64 * square(group.bias - bias)).sum::<f64>();
        explained / (rows as f64 * (rms * rms - bias * bias)).max(f64::MIN_POSITIVE)
    }

    fn place(&self, place: &GroupedResiduals, p: Option<f64>) -> PlainFinding {
        let test = place.test;
        if let Some(why) = &place.not_testable {
            return PlainFinding {
                test,
                input: None,
                statement: format!("Not testable: {why}."),
                advice: None,
            };
        }
        let mut statements = Vec::new();
        if is_found(p) {
            // Each of both tests of the place at the level of both.
            let factor = p.unwrap_or(1.0) / of_place(place).unwrap_or(1.0).max(f64::MIN_POSITIVE);
            let corrected = |p: Option<f64>| p.map(|p| (2.0 * p * factor.max(1.0)).min(1.0));
            let (size, bias) = (corrected(place.size_p_value), corrected(place.bias_p_value));
            statements.extend(is_found(size).then(|| self.size(place, size)));
            statements.extend(is_found(bias).then(|| self.bias_of(place, bias)));
        }
        if statements.is_empty() {
            let sizes: Vec<String> = place.groups.iter().map(|group| self.size_in_words(group)).collect();
            let unlike = "no difference of size or mean was found";
            statements.push(format!("RMS {}: {unlike} ({}).", sizes.join(", "), words(p)));
        }
        if let (true, Some(caution)) = (is_found(p), &place.caution) {
            statements.push(format!("Note: {caution}."));
        }
        PlainFinding { test, input: None, statement: statements.join(" "), advice: Some(self.advice(test)) }
    }

    fn size_in_words(&self, group: &ResidualGroup) -> String {
        format!("{} ({})", self.value(group.rms), group.name)
    }

    /// The largest and the smallest size.
    fn size(&self, place: &GroupedResiduals, p: Option<f64>) -> String {
        let by_size = |a: &&ResidualGroup, b: &&ResidualGroup| a.rms.total_cmp(&b.rms);
        let largest = place.groups.iter().max_by(by_size).expect("there are groups");
        let smallest = place.groups.iter().min_by(by_size).expect("there are groups");
        let ratio = match smallest.rms > 0.0 {
            true => format!("by a factor of {:.2}", Significant(largest.rms / smallest.rms)),
            false => "and 0 elsewhere".into(),
        };
        let where_ = match place.test {
            ResidualTest::TurningPoints if largest.name == "elsewhere" => {
                "smaller after turning points than elsewhere"
            }
            ResidualTest::TurningPoints => "larger after turning points than elsewhere",
            _ => {
                return format!(
                    "The residual is larger at “{}” than at “{}” {ratio} (RMS {} against {}; {}).",
                    largest.name,
                    smallest.name,
                    self.value(largest.rms),
                    self.value(smallest.rms),
                    words(p)
                );
            }
        };
        let [after, elsewhere] = [0, 1].map(|at| self.value(place.groups[at].rms));
        format!("The residual is {where_} {ratio} (RMS {after} against {elsewhere}; {}).", words(p))
    }

    fn bias_of(&self, place: &GroupedResiduals, p: Option<f64>) -> String {
        let of_group = |group: &ResidualGroup| {
            let sign = if group.bias > 0.0 { "+" } else { "" };
            format!("{sign}{} ({})", self.value(group.bias), group.name)
        };
        let all: Vec<String> = place.groups.iter().map(of_group).collect();
        format!("Its mean is {} ({}).", all.join(", "), words(p))
    }

    /// Remedy for structure by a place.
    fn advice(&self, test: ResidualTest) -> &'static str {
        match test {
            ResidualTest::TurningPoints => {
                "The model does not follow the output after reversals: use a model with more memory (more operators or \
                 neurons, or the default model, auto), and check for a delay between the channels (diagnose the data)."
            }
            ResidualTest::Speed if self.is_of_one_speed() => {
                "Whether the speed or the place in the half cycle matters, these data do not tell: measure at a second speed."
            }
            ResidualTest::Speed if self.options.uses_rate => OTHER_RATE_DEPENDENCE,
            ResidualTest::Speed => {
                "Rate-dependent residual, if the data have time: give the model the rate of the input (option rate), or a law \
                 that uses it."
            }
            ResidualTest::Amplitude => {
                "Train on loops of all amplitudes that matter; a change with the largest amplitude so far needs a model \
                 with deterioration or history inputs."
            }
            ResidualTest::Distance => {
                "The output bends differently near the ends of the input range: use a model that can saturate, or \
                 transform the input (option compression)."
            }
            ResidualTest::Direction => {
                "The simulated loops are too wide or too narrow, or shifted: use a model with asymmetric loops, and \
                 check for a delay between the channels (diagnose the data)."
            }
            _ => {
                "The specimen or a sensor changes over time: use a model with deterioration, or remove the drift; if \
                 only the beginning is worse, check the initial state (options initial_state and warm_up)."
            }
        }
    }
}

fn is_found(p: Option<f64>) -> bool {
    p.is_some_and(|p| p < LEVEL)
}

fn words(p: Option<f64>) -> String {
    match p {
        None => "not testable".into(),
        Some(p) if p < 0.001 => "p < 0.001".into(),
        Some(p) if p > 0.995 => "p = 1".into(),
        Some(p) => format!("p = {:.2}", Significant(p)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of Holm (1979) with four tests.
    #[test]
    fn p_values_are_corrected_as_by_holm() {
        let found = holm(&[Some(0.01), None, Some(0.04), Some(0.03), Some(0.005)]);
        let expected = [Some(0.03), None, Some(0.06), Some(0.06), Some(0.02)];
        for (found, expected) in found.iter().zip(expected) {
            assert_eq!(found.is_some(), expected.is_some());
            assert!((found.unwrap_or(0.0) - expected.unwrap_or(0.0)).abs() < 1e-12);
        }
    }
}
