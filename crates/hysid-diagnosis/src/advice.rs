//! Advice: the simplest model that can hold what was found. The paper's Table 2 with its error mended: a
//! tanh layer that mixes stops is not congruent, so that networks with it hold memories that additive models cannot.

use serde::{Serialize, Serializer};

use super::{Delay, Finding, Property, Verdict};
use hysid_core::law::facts::Behaviour;
use hysid_core::network::Family;
use hysid_core::options::ModelName;
use hysid_core::options::classical::ClassicalModel;
use hysid_core::significant::Significant;

/// The simplest model that can hold what was found, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Advice {
    /// The model; `None` where a function of the input, without memory, is enough.
    #[serde(serialize_with = "by_name")]
    pub model: Option<ModelName>,
    /// Whether it must see the rate of the input.
    pub needs_rate: Verdict,
    /// Whether it must wear out.
    pub needs_deterioration: Verdict,
    /// Whether it must be unlike itself turned by half a turn.
    pub needs_asymmetry: Verdict,
    /// Whether its memory must fade with time, as in creep: needed only where the speed matters.
    pub needs_memory_of_time: Verdict,
    /// Why, in sentences; what was not testable is said as an assumption.
    pub statement: Vec<String>,
}

fn by_name<S: Serializer>(model: &Option<ModelName>, serializer: S) -> Result<S::Ok, S::Error> {
    model.map(ModelName::name).serialize(serializer)
}

/// Findings on the properties that decide.
struct DecidingProperties {
    static_hysteresis: Verdict,
    rate_dependence: Verdict,
    wiping_out: Verdict,
    congruency: Verdict,
    masing: Verdict,
    odd_symmetry: Verdict,
    deterioration: Verdict,
    strength_loss: bool,
    pinching: bool,
    resonates: bool,
}

impl DecidingProperties {
    fn of(findings: &[Finding], resonates: bool) -> Self {
        let verdict = |property| {
            let finding = findings.iter().find(|finding| finding.property == property);
            finding.map_or(Verdict::NotTestable, |finding| finding.verdict)
        };
        Self {
            static_hysteresis: verdict(Property::StaticHysteresis),
            rate_dependence: verdict(Property::RateDependence),
            wiping_out: verdict(Property::WipingOut),
            congruency: verdict(Property::Congruency),
            masing: verdict(Property::Masing),
            odd_symmetry: verdict(Property::OddSymmetry),
            deterioration: verdict(Property::Deterioration),
            strength_loss: verdict(Property::StrengthLoss) == Verdict::Yes,
            pinching: verdict(Property::Pinching) == Verdict::Yes,
            resonates,
        }
    }

    /// True if the model must lose strength, by repetition or with the amplitude.
    fn degrades(&self) -> bool {
        self.deterioration == Verdict::Yes || self.strength_loss
    }

    fn is_a_function(&self) -> bool {
        self.static_hysteresis == Verdict::No && self.rate_dependence != Verdict::Yes
    }
}

pub(crate) fn advise(findings: &[Finding], delay: Option<&Delay>, resonates: bool) -> Advice {
    let found = DecidingProperties::of(findings, resonates);
    let (model, reason) = simplest(&found);
    let mut statement = vec![match model {
        Some(model) => {
            format!("the simplest model that can represent these properties is {}: {reason}", model.name())
        }
        None => reason.to_string(),
    }];
    statement.extend(laws(&found));
    if model.is_some() {
        statement.push(
            "to learn how well a model fits, cross-validate it: the default fit does so with many models, and the command \
             compare lists the errors of all"
                .into(),
        );
    }
    if let Some(delay) = delay {
        let shift = Significant(delay.time.abs());
        statement.push(format!(
            "remove the delay first (shift the output by {shift:.3} in time); otherwise the output depends \
             on the speed, and xpnn is needed"
        ));
    }
    if model.is_some() {
        statement.extend(assumptions(&found));
    }
    Advice {
        model,
        needs_rate: found.rate_dependence,
        needs_deterioration: if found.degrades() { Verdict::Yes } else { found.deterioration },
        needs_asymmetry: match found.odd_symmetry {
            Verdict::Yes => Verdict::No,
            Verdict::No => Verdict::Yes,
            Verdict::NotTestable => Verdict::NotTestable,
        },
        // Whether the rate itself or a fading memory is behind it, these properties do not tell.
        needs_memory_of_time: match found.rate_dependence {
            Verdict::No => Verdict::No,
            Verdict::Yes | Verdict::NotTestable => Verdict::NotTestable,
        },
        statement,
    }
}

/// The model and the reason, the property with the largest requirement first.
fn simplest(found: &DecidingProperties) -> (Option<ModelName>, &'static str) {
    use Verdict::{No, Yes};
    let network = |family| Some(ModelName::Network(family));
    let law = |behaviour| Some(ModelName::Classical(ClassicalModel::simplest_for(behaviour)));
    if found.resonates {
        return (law(Behaviour::Resonance), "the data look like a resonance, which needs a mass");
    }
    if found.is_a_function() {
        return (
            None,
            "there is no hysteresis: the output is a function of the input, and no model with memory is needed",
        );
    }
    if found.rate_dependence == Yes {
        let reason = "the output depends on the speed, so the rate must be an input; if the memory also \
                      fades with time (creep, relaxation), use xpnn+";
        return (network(Family::Xpnn), reason);
    }
    if found.degrades() {
        return match (found.deterioration, found.odd_symmetry) {
            (Yes, No) => {
                (network(Family::Xpnn), "loops shrink when they are repeated, and are not symmetric")
            }
            (Yes, _) => (network(Family::Gpnn), "loops shrink when they are repeated"),
            (_, No) => {
                (network(Family::Xpnn), "strength is lost with the amplitude, and loops are not symmetric")
            }
            _ => (network(Family::Gpnn), "strength is lost with the amplitude"),
        };
    }
    if found.wiping_out == No {
        return match found.odd_symmetry {
            Yes => (
                law(Behaviour::Traces),
                "closed excursions leave a trace, without deterioration; xpnn can represent this too",
            ),
            _ => (
                network(Family::Xpnn),
                "closed excursions leave a trace, without deterioration, and the loops are not known to be \
                 symmetric",
            ),
        };
    }
    if found.congruency == No {
        return (
            network(Family::PreisachNn),
            "minor loops between the same inputs differ in shape, which a weighted sum of plays, stops or \
             relays cannot represent",
        );
    }
    if found.masing == No || found.odd_symmetry == No {
        let reason =
            "branches differ in shape, and minor loops between the same inputs were not found to differ";
        return (law(Behaviour::UnlikeBranches), reason);
    }
    let reason = if found.masing == Yes {
        "all branches are one curve, scaled, so a weighted sum of plays is enough (as a network: pnn)"
    } else {
        "these data show no property that a weighted sum of plays cannot represent, but they do not show that it is \
         enough"
    };
    (law(Behaviour::SumOfPlays), reason)
}

/// Laws with fewer parameters than the simplest model. Whether their shapes fit, only a fit tells.
fn laws(found: &DecidingProperties) -> Option<String> {
    let behaviour = match found {
        _ if found.is_a_function() || found.resonates => return None,
        _ if found.degrades() => Behaviour::Degradation,
        _ if found.pinching => Behaviour::Pinching,
        _ if found.rate_dependence == Verdict::Yes => Behaviour::RateDependence,
        _ if simplest(found).0
            == Some(ModelName::Classical(ClassicalModel::simplest_for(Behaviour::UnlikeBranches))) =>
        {
            Behaviour::UnlikeBranches
        }
        _ => return None,
    };
    let laws = ClassicalModel::with_fewer_parameters_for(behaviour);
    let laws: Vec<String> = laws.map(|(law, remark)| format!("{} ({remark})", law.name())).collect();
    let models = if laws.len() == 1 { "a model" } else { "models" };
    Some(format!("{models} with fewer parameters: {}", laws.join(" or ")))
}

/// Assumptions on properties that were not testable.
fn assumptions(found: &DecidingProperties) -> Vec<String> {
    let mut assumed = Vec::new();
    let mut assume = |verdict: Verdict, what: &str| {
        if verdict == Verdict::NotTestable {
            assumed.push(format!("not testable with these data: {what}"));
        }
    };
    assume(found.static_hysteresis, "static hysteresis (assumed: yes)");
    assume(found.rate_dependence, "rate dependence (assumed: none; if the speed matters: xpnn)");
    if found.rate_dependence == Verdict::Yes {
        return assumed;
    }
    if !found.degrades() {
        assume(found.deterioration, "deterioration by repetition (assumed: none)");
        assume(found.wiping_out, "wiping-out (assumed: yes)");
        if found.wiping_out != Verdict::No {
            assume(found.congruency, "congruency (assumed: yes; if not: preisach-nn)");
        }
        if found.wiping_out != Verdict::No
            && found.congruency != Verdict::No
            && found.odd_symmetry != Verdict::No
        {
            let otherwise = ClassicalModel::simplest_for(Behaviour::UnlikeBranches).name();
            assume(found.masing, &format!("Masing's rule (assumed: yes; if not: {otherwise})"));
        }
    }
    let relies_on_symmetry = found.degrades()
        || found.wiping_out != Verdict::No && found.congruency != Verdict::No && found.masing != Verdict::No;
    if relies_on_symmetry {
        assume(found.odd_symmetry, "symmetry (assumed: yes)");
    }
    assumed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Diagnosis, DiagnosisOptions};
    use Verdict::{No, NotTestable, Yes};
    use hysid_specimens::Specimen;

    /// Findings with the verdicts on static hysteresis, rate dependence, wiping-out, congruency, Masing's rule, odd
    /// symmetry and deterioration.
    fn findings(verdicts: [Verdict; 7]) -> Vec<Finding> {
        let properties = [
            Property::StaticHysteresis,
            Property::RateDependence,
            Property::WipingOut,
            Property::Congruency,
            Property::Masing,
            Property::OddSymmetry,
            Property::Deterioration,
        ];
        let finding = |(property, verdict)| Finding { verdict, ..Finding::not_testable(property, "", "") };
        properties.into_iter().zip(verdicts).map(finding).collect()
    }

    fn name(advice: &Advice) -> Option<&'static str> {
        advice.model.map(ModelName::name)
    }

    fn assumed(advice: &Advice) -> usize {
        advice.statement.iter().filter(|text| text.starts_with("not testable with these data: ")).count()
    }

    #[test]
    fn laws_that_wear_out_or_see_the_rate_are_named() {
        let statement = |verdicts| advise(&findings(verdicts), None, false).statement.concat();
        assert!(statement([Yes, No, No, No, No, Yes, Yes]).contains("bouc-wen (option degradation"));
        assert!(statement([Yes, Yes, Yes, Yes, Yes, Yes, No]).contains("rate-dependent-prandtl-ishlinskii"));
        assert!(!statement([Yes, No, Yes, Yes, Yes, Yes, No]).contains("fewer parameters"));
    }

    #[test]
    fn the_model_follows_from_the_findings() {
        for (verdicts, expected) in [
            ([No, No, Yes, Yes, Yes, Yes, No], None),
            ([Yes, No, Yes, Yes, Yes, Yes, No], Some("prandtl-ishlinskii")),
            ([Yes, No, Yes, Yes, No, Yes, No], Some("preisach")),
            ([Yes, No, Yes, Yes, No, No, No], Some("preisach")),
            ([Yes, No, Yes, No, No, Yes, No], Some("preisach-nn")),
            ([Yes, No, No, No, No, Yes, No], Some("bouc-wen")),
            ([Yes, No, No, No, No, No, No], Some("xpnn")),
            ([Yes, No, No, No, No, Yes, Yes], Some("gpnn")),
            ([Yes, No, No, No, No, No, Yes], Some("xpnn")),
            ([Yes, Yes, Yes, Yes, Yes, Yes, No], Some("xpnn")),
            // Loops that vanish at rest are a matter of the rate, not of nothing.
            ([No, Yes, Yes, Yes, Yes, Yes, No], Some("xpnn")),
        ] {
            let advice = advise(&findings(verdicts), None, false);
            assert_eq!(name(&advice), expected, "{verdicts:?}");
            assert_eq!(assumed(&advice), 0, "{:?}", advice.statement);
        }
    }

    #[test]
    fn what_is_not_testable_is_said_to_be_assumed() {
        assert_eq!(name(&advise(&findings([Yes; 7]), None, true)), Some("hysteretic-oscillator"));
        let advice = advise(&findings([NotTestable; 7]), None, false);
        assert_eq!(name(&advice), Some("prandtl-ishlinskii"));
        assert_eq!(advice.statement.len(), 9, "{:?}", advice.statement);
        assert!(advice.statement[2..].iter().all(|text| text.starts_with("not testable with these data: ")));
        assert_eq!(advice.needs_rate, NotTestable);
        assert!(advice.statement[0].contains("do not show that it is enough"), "{:?}", advice.statement);
        // What would not change the model is not mentioned.
        let advice = advise(
            &findings([Yes, Yes, NotTestable, NotTestable, NotTestable, NotTestable, NotTestable]),
            None,
            false,
        );
        assert_eq!(assumed(&advice), 0, "{:?}", advice.statement);
        assert_eq!(advice.needs_memory_of_time, NotTestable);
    }

    #[test]
    fn specimens_get_models_of_their_kind() {
        for (specimen, expected) in [
            ("ferromagnet", "preisach"),
            ("reinforced-concrete-joint", "gpnn"),
            ("terfenol-actuator", "preisach"),
            ("shape-memory-actuator", "preisach"),
            ("concrete", "xpnn"),
            ("piezo-actuator", "xpnn"),
            ("rate-dependent-actuator", "xpnn"),
            ("magnetostrictive-actuator", "xpnn"),
        ] {
            let data = Specimen::named(specimen).expect("it is in the catalogue").train();
            let diagnosis = Diagnosis::of(&data, &DiagnosisOptions::default()).unwrap();
            assert_eq!(name(&diagnosis.advice), Some(expected), "{specimen}");
            let file = serde_json::to_value(&diagnosis.advice).unwrap();
            assert_eq!(file["model"], expected);
        }
    }
}
