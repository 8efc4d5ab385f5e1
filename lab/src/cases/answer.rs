//! What `hysid compare --json` answers: a list with an object for each model. Fields that are not needed here may
//! come and go.

use serde_json::Value;

/// A case and what came of it: answers, or why there are none.
pub struct Case<T = Vec<Answer>> {
    pub name: String,
    pub outcome: Result<T, String>,
}

/// What came of one model on one case.
#[derive(Debug, PartialEq)]
pub struct Answer {
    pub model: String,
    /// The figures, or why there are none.
    pub figures: Result<Figures, String>,
}

/// How good and how fast a model was. What was not said, or has no value, is `None`.
#[derive(Debug, Default, PartialEq)]
pub struct Figures {
    /// NRMSE of the test data in percent of the output's standard deviation.
    pub test: Option<f64>,
    /// The same of the training data.
    pub train: Option<f64>,
    /// Seconds it took to fit.
    pub seconds: Option<f64>,
    /// What the model is made of, in words.
    pub structure: Option<String>,
}

/// Reads the list.
pub fn parse(text: &str) -> Result<Vec<Answer>, String> {
    let value: Value =
        serde_json::from_str(text).map_err(|error| format!("the answer is not JSON: {error}"))?;
    let objects = value.as_array().ok_or("the answer is not a list")?;
    if objects.is_empty() {
        return Err("the answer is an empty list".into());
    }
    objects.iter().map(answer).collect()
}

fn answer(object: &Value) -> Result<Answer, String> {
    let name = object["label"].as_str().or(object["model"].as_str());
    let model = name.ok_or("the answer has an object without a model")?;
    let nrmse = |set: &str| object[set]["nrmse_std_percent"].as_f64();
    let figures = match &object["error"] {
        Value::Null => Ok(Figures {
            test: nrmse("test"),
            train: nrmse("train"),
            seconds: object["fit_seconds"].as_f64(),
            structure: object["structure"].as_str().map(str::to_owned),
        }),
        Value::String(error) => Err(error.clone()),
        error => Err(error.to_string()),
    };
    Ok(Answer { model: model.into(), figures })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_errors_and_unknown_fields() {
        let text = r#"[
            {"model": "pnn", "parameters": 20, "error": null, "fit_seconds": 0.5, "later": [1],
             "train": {"samples": 9, "nrmse_std_percent": 1.5}, "test": {"nrmse_std_percent": 2.5},
             "structure": "10 stops"},
            {"model": "xpnn", "train": {"nrmse_std_percent": 1}, "test": {"nrmse_std_percent": null},
             "structure": null},
            {"model": "bouc-wen", "error": "takes one input, not 2"}
        ]"#;
        let answer = |model: &str, figures| Answer { model: model.into(), figures };
        let pnn = Figures {
            test: Some(2.5),
            train: Some(1.5),
            seconds: Some(0.5),
            structure: Some("10 stops".into()),
        };
        let expected = [
            answer("pnn", Ok(pnn)),
            answer("xpnn", Ok(Figures { train: Some(1.0), ..Figures::default() })),
            answer("bouc-wen", Err("takes one input, not 2".into())),
        ];
        assert_eq!(parse(text).unwrap(), expected);
    }

    #[test]
    fn what_is_no_such_list_is_refused() {
        assert!(parse("a table").unwrap_err().starts_with("the answer is not JSON: "));
        assert_eq!(parse("{}").unwrap_err(), "the answer is not a list");
        assert_eq!(parse("[{}]").unwrap_err(), "the answer has an object without a model");
        assert_eq!(parse("[]").unwrap_err(), "the answer is an empty list");
    }
}
