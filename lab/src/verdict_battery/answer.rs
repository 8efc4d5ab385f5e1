//! What `hysid diagnose --json` says of the properties. Fields that are not needed here may come and go.

use serde_json::Value;

use super::property::{OF_MEMBERS, PROPERTIES};

/// What is said of one property.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Finding {
    /// Yes, no, or not testable.
    pub verdict: Option<bool>,
    pub index: Option<f64>,
    pub threshold: Option<f64>,
    pub statement: String,
}

/// The findings, in the order of the properties.
pub type Findings = Vec<Finding>;

/// Reads the object.
pub fn parse(text: &str) -> Result<Findings, String> {
    let value: Value =
        serde_json::from_str(text).map_err(|error| format!("the answer is not JSON: {error}"))?;
    let objects = value["properties"].as_array().ok_or("the answer has no properties")?;
    let of_property =
        |(property, name): (usize, &&str)| match objects.iter().find(|object| object["name"] == **name) {
            Some(object) => finding(object),
            None if property >= OF_MEMBERS => Ok(Finding::default()),
            None => Err(format!("the answer has no {name}")),
        };
    PROPERTIES.iter().enumerate().map(of_property).collect()
}

fn finding(object: &Value) -> Result<Finding, String> {
    let verdict = match object["verdict"].as_str() {
        Some("yes") => Some(true),
        Some("no") => Some(false),
        Some("not testable") => None,
        _ => return Err(format!("an unknown verdict: {}", object["verdict"])),
    };
    Ok(Finding {
        verdict,
        index: object["index"].as_f64(),
        threshold: object["threshold"].as_f64(),
        statement: object["statement"].as_str().unwrap_or_default().to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_stand_in_the_order_of_the_properties() {
        let object =
            |name: &str| format!(r#"{{"name": "{name}", "verdict": "not testable", "index": null}}"#);
        let mut objects: Vec<String> = PROPERTIES.iter().rev().map(|name| object(name)).collect();
        objects[2] = r#"{"name": "loop-closure", "verdict": "no", "index": 0.2, "threshold": 0.01, "statement": "open"}"#.into();
        let text = |objects: &[String]| format!(r#"{{"properties": [{}]}}"#, objects.join(","));
        let findings = parse(&text(&objects)).unwrap();
        let open = Finding {
            verdict: Some(false),
            index: Some(0.2),
            threshold: Some(0.01),
            statement: "open".into(),
        };
        assert_eq!(findings[9], open);
        assert_eq!(findings[0].verdict, None);
        assert_eq!(parse(&text(&objects[2..])).unwrap()[10..], [Finding::default(), Finding::default()]);
        assert_eq!(parse(&text(&objects[3..])).unwrap_err(), "the answer has no loop-closure");
        assert_eq!(parse("{}").unwrap_err(), "the answer has no properties");
        assert!(parse("a table").unwrap_err().starts_with("the answer is not JSON: "));
    }
}
