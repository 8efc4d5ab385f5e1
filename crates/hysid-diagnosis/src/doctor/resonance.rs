//! Resonance: a linear oscillator fits the output better than a law without inertia, theory.md (10.28).

use super::{ColumnUnits, DataIssue, DataIssueKind, Severity};
use crate::branch::BranchSet;
use crate::resonance::{ComparedSignal, Resonance};
use hysid_core::law::facts::Behaviour;
use hysid_core::options::classical::ClassicalModel;
use hysid_core::significant::Significant;

const SHOWN: usize = 3;

pub(super) fn complaint(survey: &BranchSet, found: &Resonance) -> DataIssue {
    let seconds = ColumnUnits::of(survey).time.as_deref() == Some("s");
    let (what, models) = match found.oscillator.compared {
        ComparedSignal::Output => {
            let with_inertia = ClassicalModel::ALL.iter().filter(|model| model.has_inertia());
            ("", with_inertia.map(|model| model.name()).collect::<Vec<_>>().join(" or "))
        }
        ComparedSignal::Changes => {
            let simplest = ClassicalModel::simplest_for(Behaviour::Resonance).name();
            let models = format!("{simplest}; add --degradation if the structure loses strength");
            ("for the changes of the output from row to row, ", models)
        }
    };
    let statement = format!(
        "this looks like a resonance at {:.3} {} (damping ratio {:.2} %): {}the error of a linear oscillator is {:.2} \
         times that of the best fit without inertia; fit a model with inertia (--model {})",
        Significant(found.oscillator.natural_frequency),
        if seconds { "Hz" } else { "cycles per unit of time" },
        Significant(100.0 * found.oscillator.damping_ratio),
        what,
        found.ratio,
        models
    );
    let issue = DataIssue::of_all(DataIssueKind::Resonance, Severity::Warning, statement);
    let evidence = found.rows.iter().take(SHOWN).cloned().collect();
    DataIssue {
        evidence,
        ..issue.measured(found.oscillator.natural_frequency, &seconds.then(|| "Hz".into()))
    }
}
