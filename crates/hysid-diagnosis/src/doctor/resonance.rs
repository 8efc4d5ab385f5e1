//! Resonance: a linear oscillator fits the output better than a law without inertia, theory.md (10.28).

use super::{ColumnUnits, DataIssue, DataIssueKind, Severity};
use crate::branch::BranchSet;
use crate::resonance::{ComparedSignal, Resonance};
use hysid_core::law::facts::Behaviour;
use hysid_core::options::classical::ClassicalModel;
use hysid_core::significant::Significant;
use hysid_core::words::{Hint, Words};

const SHOWN: usize = 3;

pub(super) fn complaint(survey: &BranchSet, found: &Resonance) -> DataIssue {
    let seconds = ColumnUnits::of(survey).time.as_deref() == Some("s");
    let simplest = ClassicalModel::simplest_for(Behaviour::Resonance);
    let oscillator = Words::from(Hint::Value("model", simplest.name().into()));
    let (what, models) = match found.oscillator.compared {
        ComparedSignal::Output => {
            let others =
                ClassicalModel::ALL.iter().filter(|model| model.has_inertia() && **model != simplest);
            let names = others.map(|model| format!(" or {}", model.name())).collect::<String>();
            ("", oscillator + &*names)
        }
        ComparedSignal::Changes => (
            "for the changes of the output from row to row, ",
            oscillator + "; add " + Hint::Option("degradation") + " if the structure loses strength",
        ),
    };
    let statement = format!(
        "this looks like a resonance at {:.3} {} (damping ratio {:.2} %): {}the error of a linear oscillator is {:.2} \
         times that of the best fit without inertia; fit a model with inertia",
        Significant(found.oscillator.natural_frequency),
        if seconds { "Hz" } else { "cycles per unit of time" },
        Significant(100.0 * found.oscillator.damping_ratio),
        what,
        found.ratio
    );
    let issue = DataIssue::of_all(DataIssueKind::Resonance, Severity::Warning, statement);
    let evidence = found.rows.iter().take(SHOWN).cloned().collect();
    DataIssue {
        evidence,
        advice: Some(models),
        ..issue.measured(found.oscillator.natural_frequency, &seconds.then(|| "Hz".into()))
    }
}
