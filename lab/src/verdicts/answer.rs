//! What `hysid diagnose --json` answers. Fields that are not needed here may come and go.

use serde_json::Value;

/// What is said of one case.
#[derive(Debug, PartialEq)]
pub struct Diagnosis {
    pub verdicts: Vec<Verdict>,
    /// What the data doctor complains of.
    pub complaints: Vec<String>,
    /// Which model can hold what was found; none or one.
    pub advice: Vec<String>,
}

/// What is said of one property.
#[derive(Debug, PartialEq)]
pub struct Verdict {
    pub property: String,
    pub verdict: String,
    pub index: Option<f64>,
}

/// Reads the object.
pub fn parse(text: &str) -> Result<Diagnosis, String> {
    let value: Value =
        serde_json::from_str(text).map_err(|error| format!("the answer is not JSON: {error}"))?;
    let verdicts: Vec<Verdict> = list(&value["properties"]).iter().filter_map(verdict).collect();
    if verdicts.is_empty() {
        return Err("the answer has no properties".into());
    }
    let complaints = list(&value["doctor"]).iter().filter_map(|complaint| text_of(&complaint["statement"]));
    // What follows the first are assumptions, which the table shows.
    let advice = list(&value["advice"]["statement"]).iter().take(1).filter_map(text_of);
    Ok(Diagnosis { verdicts, complaints: complaints.collect(), advice: advice.collect() })
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn text_of(value: &Value) -> Option<String> {
    value.as_str().map(str::to_owned)
}

fn verdict(object: &Value) -> Option<Verdict> {
    Some(Verdict {
        property: text_of(&object["name"])?,
        verdict: text_of(&object["verdict"])?,
        index: object["index"].as_f64(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_complaints_and_unknown_fields() {
        let text = r#"{"later": 1, "properties": [
            {"name": "masing", "verdict": "no", "index": 0.4, "threshold": 0.05},
            {"name": "congruency", "verdict": "not testable", "index": null}],
            "doctor": [{"kind": "drift", "statement": "the output drifts"}], "advice": {"statement": ["take pnn", "masing taken as holding"]}}"#;
        let verdict = |property: &str, verdict: &str, index| Verdict {
            property: property.into(),
            verdict: verdict.into(),
            index,
        };
        let expected = Diagnosis {
            verdicts: vec![verdict("masing", "no", Some(0.4)), verdict("congruency", "not testable", None)],
            complaints: vec!["the output drifts".into()],
            advice: vec!["take pnn".into()],
        };
        assert_eq!(parse(text), Ok(expected));
    }

    #[test]
    fn what_is_no_diagnosis_is_refused() {
        assert!(parse("a table").unwrap_err().starts_with("the answer is not JSON: "));
        assert_eq!(parse("[]").unwrap_err(), "the answer has no properties");
        assert_eq!(parse(r#"{"properties": [{}]}"#).unwrap_err(), "the answer has no properties");
    }
}
