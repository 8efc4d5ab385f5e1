//! Notes on a fitted model, other than its errors.

use crate::data::initial_state::{InitialState, in_words};
use crate::data::metrics::Errors;
use crate::data::warning::Warning;
use crate::model::selection::{Selection, WarmUp};
use crate::model::{Ensemble, Model};
use crate::options::ModelName;
use crate::significant::Significant;

/// A validation error below this share of the training error shows rows that are easier than the others. Designed.
const EASIER: f64 = 0.8;

/// Weights of a law that a row may stand for.
const WEIGHTS_A_ROW: usize = 2;

impl Model {
    /// Notes to read before use of the model, in sentences: rows that were not used in training, and data
    /// that could not distinguish candidates. Empty if there are none.
    pub fn notes(&self) -> Vec<String> {
        let size = self.size_warning().map(|warning| warning.to_string());
        let beginning = self.warm_up_note().into_iter().chain(self.initial_state_note());
        beginning.chain(self.one_loop_note()).chain(self.easy_rows_note()).chain(size).collect()
    }

    /// A note on more parameters than rows; for an ensemble, of its largest member.
    fn size_warning(&self) -> Option<Warning> {
        // Where data were held out, their error tells more.
        if self.network().is_some() || self.provenance().validation.is_some() {
            return None;
        }
        let rows = self.provenance().samples;
        let members = self.ensemble().map_or(std::slice::from_ref(self), Ensemble::members);
        // The weights of a law are bounded by their sign or their order, so that it takes more of them to go astray.
        let allowed = |member: &Model| if member.network().is_some() { rows } else { WEIGHTS_A_ROW * rows };
        let too_large = members.iter().filter(|member| member.parameters() > allowed(member));
        too_large.map(Model::parameters).max().and_then(|parameters| Warning::of_size(parameters, rows))
    }

    fn warm_up_note(&self) -> Option<String> {
        let provenance = self.provenance();
        let behind = provenance.train_after_warm_up.as_ref()?;
        let selected = provenance.selection.as_ref().and_then(|selection| selection.warm_up);
        Some(format!(
            "warm-up: the first {} rows of each record drive the memory and were not trained on{}; with them the training \
             error is {}, without them {}",
            self.warm_up(),
            selected.map_or_else(String::new, why),
            percent(&provenance.train),
            percent(behind)
        ))
    }

    fn initial_state_note(&self) -> Option<String> {
        let provenance = self.provenance();
        let found = provenance.selection.as_ref().and_then(|selection| selection.found_states);
        let range = self.trained_ranges().inputs[0];
        let all = in_words(self.lead_in(), range);
        if provenance.options.has_free_states() {
            let first = match provenance.options.model() {
                ModelName::Classical(law) if law.has_inertia() => "at rest",
                model if model.has_free_states() => "with the mean of these states (0 in an odd network)",
                _ => &all,
            };
            return Some(format!(
                "initial state: found for each training record together with the parameters; a new record begins {first}, \
                 unless its first outputs are known (known)"
            ));
        }
        if found.is_none() && provenance.options.initial_state() != Some(InitialState::Unknown) {
            return None;
        }
        let why = found.map_or_else(String::new, |found| {
            format!(
                ", because the cross-validation error of quick models is {:.3} % of std with these states, and \
                 {:.3} % from the virgin state",
                Significant(found.found_percent),
                Significant(found.virgin_percent)
            )
        });
        if self.is_periodic() {
            return Some(format!(
                "initial state: each record begins after one period of itself{why}; so do new data, unless another \
                 initial state is given (initial_state)"
            ));
        }
        let mut counts: Vec<(String, usize)> = Vec::new();
        for known in &provenance.lead_ins {
            let state = in_words(&known.lead_in, range);
            match counts.iter_mut().find(|(other, _)| *other == state) {
                Some((_, count)) => *count += 1,
                None => counts.push((state, 1)),
            }
        }
        let begin = match counts.as_slice() {
            [] => format!("all records begin {all}"),
            counts => {
                let begin = |(state, count): &(String, usize)| match count {
                    1 => format!("1 record begins {state}"),
                    count => format!("{count} records begin {state}"),
                };
                counts.iter().map(begin).collect::<Vec<String>>().join(", ")
            }
        };
        Some(format!(
            "initial state: {begin}{why}; new data begin {all} unless another initial state is given (initial_state)"
        ))
    }

    fn easy_rows_note(&self) -> Option<String> {
        let provenance = self.provenance();
        let train = provenance.train_after_warm_up.as_ref().unwrap_or(&provenance.train);
        let held_out = provenance.validation.as_ref()?;
        (held_out.rmse < EASIER * train.rmse).then(|| {
            format!(
                "validation: the rows held out ({}) have a smaller error than all training rows ({}): they are easier than \
                 the others, so expect at least the training error on new data",
                percent(held_out),
                percent(train)
            )
        })
    }

    /// A note for stepping a model whose records begin after a period, which is not known then.
    pub fn stepping_note(&self) -> Option<&'static str> {
        self.is_periodic().then_some(
            "this model was trained on steady periods: sample by sample it begins in the virgin state, so its first period \
             is a transient",
        )
    }

    fn one_loop_note(&self) -> Option<String> {
        let one_loop = |selection: &Selection| selection.one_loop;
        self.provenance().selection.as_ref().is_some_and(one_loop).then(|| {
            format!(
                "one loop: all reversals of {} are at the ends of its range, so the data contain no smaller \
                 loops, and the errors say nothing about these; candidates are also judged by the errors that their \
                 kind had on smaller loops of simulated cases, and the band is wider (measure loops of three or more \
                 amplitudes)",
                self.names().inputs[0]
            )
        })
    }
}

/// Why rows were left out, if cross-validation decided it.
fn why(warm_up: WarmUp) -> String {
    let (Some(without), Some(with)) = (warm_up.without_percent, warm_up.with_percent) else {
        return String::new();
    };
    format!(
        ", because the error of a quick model on the later rows is {:.3} % of std when not trained on them, and {:.3} % \
         when trained on them",
        Significant(without),
        Significant(with)
    )
}

fn percent(errors: &Errors) -> String {
    let percent = errors.nrmse_std_percent;
    percent.map_or_else(|| "not defined".into(), |percent| format!("{:.3} % of std", Significant(percent)))
}
