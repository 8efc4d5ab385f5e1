//! The model file: what is written comes back to the last bit, and what is damaged does not come back
//! at all. And a model's two ways to run, whole and sample by sample.

use crate::scaffold::*;
use std::sync::LazyLock;

use hysid::data::warning::Warning;
use hysid::fit::network::fit;
use hysid::model::FORMAT_VERSION;
use hysid_core::elementary::{cos, sin};

/// Uneven steps in time, so that no two rows are alike.
fn record(inputs: usize, rows: usize) -> Record {
    let x: Vec<f64> = (0..rows).map(|k| sin(0.21 * k as f64) * (1.0 + 0.6 * cos(0.05 * k as f64))).collect();
    let mut y = Stop::new(0.4).unwrap().run(&x);
    let mut columns = vec![x];
    for c in 1..inputs {
        columns.push((0..rows).map(|k| cos(0.07 * (c + 1) as f64 * k as f64)).collect());
    }
    for (k, y) in y.iter_mut().enumerate() {
        *y += 0.2 * columns.iter().map(|column| column[k]).sum::<f64>();
    }
    let time: Vec<f64> = (0..rows).map(|k| 0.1 * k as f64 + 0.02 * sin(1.3 * k as f64)).collect();
    let rate = (0..rows).map(|k| 2.1 * cos(0.21 * k as f64)).collect();
    Record::new("run 1", columns, y).unwrap().with_time(time).unwrap().with_given_rate(rate).unwrap()
}

fn dataset(inputs: usize) -> Dataset {
    Dataset::new(ColumnNames::plain(inputs), vec![record(inputs, 120)]).unwrap()
}

fn model(family: Family, inputs: usize, rate: Option<RateMethod>) -> Model {
    let sizes = Sizes { stops: 3, hidden: 2, relaxation: 1 };
    let options = FitOptions { model: family, sizes, rate, starts: 1, epochs: 3, ..FitOptions::default() };
    fit(&dataset(inputs), &options, &mut |_| ControlFlow::Continue(())).unwrap().model
}

/// One with all parts.
static FULL: LazyLock<Model> = LazyLock::new(|| model(Family::XpnnPlus, 1, Some(RateMethod::Backward)));

fn models() -> Vec<Model> {
    let mut models = vec![FULL.clone(), model(Family::XpnnPlus, 3, None)];
    for family in Family::ALL {
        for rate in [None, Some(RateMethod::Given), Some(RateMethod::Central)] {
            models.push(model(family, 1, rate));
        }
    }
    models
}

fn refusal(text: &str) -> String {
    match Model::from_json(text) {
        Err(Error::ModelFile(text)) => text,
        Err(other) => panic!("another kind of error: {other}"),
        Ok(_) => panic!("accepted:\n{text}"),
    }
}

/// The text with its checksum made to fit again: CRC 32 of all before the key, without white space between parts.
pub fn with_fitting_checksum(text: &str) -> String {
    let end = text.rfind("\"checksum\"").unwrap();
    // No text of these files has a quotation mark within.
    let parts = text[..end].split('"').enumerate().map(|(place, part)| match place % 2 {
        0 => part.split_ascii_whitespace().collect(),
        _ => part.to_string(),
    });
    let content = parts.collect::<Vec<String>>().join("\"");
    format!("{}\"checksum\": \"{:08x}\"\n}}\n", &text[..end], crc32fast::hash(content.as_bytes()))
}

/// The file with another first value of a field.
fn with_value(part: &str, field: &str, value: &str) -> String {
    let mut text = FULL.to_json();
    let begin = text.find(&format!("\"{part}\"")).unwrap();
    let field = format!("\"{field}\": ");
    let at = begin + text[begin..].find(&field).unwrap() + field.len();
    let at = at + text[at..].find(|c: char| c.is_ascii_alphanumeric() || c == '-').unwrap();
    let end = at + text[at..].find([',', '\n', ']']).unwrap();
    assert_ne!(&text[at..end], value);
    text.replace_range(at..end, value);
    with_fitting_checksum(&text)
}

#[test]
fn a_model_comes_back_to_the_last_bit() {
    for model in models() {
        let text = model.to_json();
        let again = Model::from_json(&text).unwrap();
        assert_eq!(again, model);
        assert_eq!(again.to_json(), text);
        assert_eq!(bits(again.network().unwrap().parameters()), bits(model.network().unwrap().parameters()));
        assert_eq!(bits(again.network().unwrap().output()), bits(model.network().unwrap().output()));
        let record = record(model.names().inputs.len(), 200);
        assert_eq!(bits(&again.simulate(&record).unwrap()), bits(&model.simulate(&record).unwrap()));
        assert_eq!(with_fitting_checksum(&text), text);
    }
}

#[test]
fn a_changed_byte_is_noticed() {
    let text = FULL.to_json();
    let places = 400;
    let (mut refused, mut harmless) = (0, 0);
    for n in 0..places {
        // The start, the end with the checksum, and what lies between.
        let place = match n {
            0..40 => n,
            40..80 => text.len() - 1 - (n - 40),
            n => (n - 80) * text.len() / (places - 80),
        };
        for flip in [0x01, 0x02, 0x04, 0x08, 0x10, 0x20, 0x40, 0x80, 0x29, 0x2a, 0x2d] {
            let mut bytes = text.clone().into_bytes();
            let before = bytes[place];
            bytes[place] ^= flip;
            let after = bytes[place];
            // What is no text is refused before it gets here.
            let Ok(changed) = String::from_utf8(bytes) else { continue };
            match Model::from_json(&changed) {
                Err(_) => refused += 1,
                Ok(model) => {
                    let white = before.is_ascii_whitespace() && after.is_ascii_whitespace();
                    assert!(white, "byte {place}: {before:#x} became {after:#x}");
                    assert_eq!(model, *FULL);
                    harmless += 1;
                }
            }
        }
    }
    assert!(refused > 3000 && harmless > 50, "{refused} refused, {harmless} harmless");
}

/// A blank in a name is part of the name.
#[test]
fn a_blank_within_a_text_is_noticed() {
    let text = FULL.to_json();
    for (name, with_blank) in
        [("\"output\": \"y\"", "\"output\": \"y \""), ("\"hysid-model\"", "\"hysid-model\" ")]
    {
        let changed = text.replacen(name, with_blank, 1);
        assert_ne!(changed, text);
        match with_blank.ends_with(' ') {
            true => assert_eq!(Model::from_json(&changed).unwrap(), *FULL),
            false => assert!(refusal(&changed).contains("checksum does not match")),
        }
    }
}

/// Factors that no fit finds: the outputs would be infinite, or none.
#[test]
fn scales_that_nothing_can_be_divided_by_are_refused() {
    let text = FULL.to_json();
    for field in ["inputs", "rate", "output_deviation"] {
        for value in ["0.0", "-1.0", "1e308", "5e-324"] {
            let said = refusal(&with_value("scaling", field, value));
            assert!(said.contains("its scaling has the factor"), "{field} {value}: {said}");
        }
    }
    assert!(refusal(&with_value("scaling", "output_mean", "1e308")).contains("mean output"));
    assert!(refusal(&with_value("trained_ranges", "inputs", "1e9")).contains("range"));
    let preprocessing = text.replacen(
        "\"trained_ranges\"",
        "\"preprocessing\": {\"compression\": 5e-324, \"rate_compression\": null, \"history\": null}, \"trained_ranges\"",
        1,
    );
    assert!(refusal(&with_fitting_checksum(&preprocessing)).contains("preprocessing has a scale"));
}

#[test]
fn a_file_that_is_cut_off_says_so() {
    let text = FULL.to_json();
    let last = text.trim_end().len();
    let lengths = (1..last).step_by(37).chain(last - 60..last);
    for length in lengths {
        let said = refusal(&text[..length]);
        assert!(said.contains("cut off") || said.contains("damaged"), "{length}: {said}");
        assert!(said.contains("restore the file"), "{said}");
    }
    assert_eq!(Model::from_json(&text[..last]).unwrap(), *FULL);
    assert!(refusal("").contains("empty") && refusal(" \n").contains("empty"));
}

#[test]
fn other_files_and_versions_are_told_apart() {
    let text = FULL.to_json();
    let version = format!("\"version\": {FORMAT_VERSION}");
    assert!(text.contains(&version));
    let next = FORMAT_VERSION + 1;
    let newer = with_fitting_checksum(&text.replacen(&version, &format!("\"version\": {next}"), 1));
    assert!(
        refusal(&newer).contains(&format!("version {next}")) && refusal(&newer).contains("use a newer hysid")
    );
    for none in ["0", "-1", "1.5", "\"1\"", "null"] {
        let text = text.replacen(&version, &format!("\"version\": {none}"), 1);
        assert!(refusal(&with_fitting_checksum(&text)).contains("no valid format version"), "{none}");
    }
    for other in ["x,y\n1,2\n", "[1, 2]", "{}", "{\"format\": \"other\"}", "7"] {
        assert!(refusal(other).contains("not a Hysid model file"), "{other}");
    }
}

#[test]
fn an_unknown_field_is_another_layout() {
    let text = FULL.to_json();
    for place in ["\"format\"", "\"stops\": [", "\"weights\"", "\"output\": ["] {
        let at = text.rfind(place).unwrap();
        let mut extended = text.clone();
        extended.insert_str(at, "\"novelty\": 1, ");
        let said = refusal(&with_fitting_checksum(&extended));
        assert!(
            said.contains(&format!("layout of version {FORMAT_VERSION}")) && said.contains("novelty"),
            "{said}"
        );
    }
}

#[test]
fn a_file_that_contradicts_itself_is_refused() {
    let changes = [("inputs", "2"), ("rate", "false"), ("stops", "4"), ("hidden", "1"), ("relaxation", "0")];
    for (field, value) in changes {
        let said = refusal(&with_value("architecture", field, value));
        assert!(said.contains("contradicts itself"), "{field}: {said}");
    }
    for field in ["deterioration", "linear", "direct", "constant"] {
        refusal(&with_value("architecture", field, "false"));
    }
    // Of absurd size, without a panic.
    for field in ["stops", "hidden", "relaxation"] {
        refusal(&with_value("architecture", field, "18446744073709551615"));
    }
}

#[test]
fn line_ends_do_not_matter() {
    let text = FULL.to_json();
    assert_eq!(Model::from_json(&text.replace('\n', "\r\n")).unwrap(), *FULL);
    assert_eq!(Model::from_json(&format!("\n{text}\n\n")).unwrap(), *FULL);
    let compact: String = text.lines().map(str::trim_start).collect();
    assert_eq!(Model::from_json(&compact).unwrap(), *FULL);
}

#[test]
fn a_stepper_finds_backward_rates_itself() {
    let record = record(1, 200);
    let time = record.time().unwrap();
    let steps = |model: &Model| {
        let mut stepper = model.stepper();
        let step = |k: usize| stepper.step(&[record.inputs()[0][k]], time[k], None).unwrap();
        (0..record.len()).map(step).collect::<Vec<f64>>()
    };
    for family in [Family::Xpnn, Family::XpnnPlus] {
        let backward = model(family, 1, Some(RateMethod::Backward));
        assert_eq!(bits(&steps(&backward)), bits(&backward.simulate(&record).unwrap()));
        let central = model(family, 1, Some(RateMethod::Central));
        assert_ne!(bits(&steps(&central)), bits(&central.simulate(&record).unwrap()));
    }
}

#[test]
fn a_stepper_refuses_what_it_cannot_use_and_stays_as_it_was() {
    let mut stepper = FULL.stepper();
    stepper.step(&[0.1], 0.0, None).unwrap();
    let mut undisturbed = stepper.clone();
    for (inputs, time, rate) in [
        (vec![], 1.0, None),
        (vec![0.1, 0.2], 1.0, None),
        (vec![f64::NAN], 1.0, None),
        (vec![f64::INFINITY], 1.0, None),
        (vec![0.2], 0.0, None),
        (vec![0.2], -1.0, None),
        (vec![0.2], f64::NAN, None),
        (vec![0.2], 1.0, Some(f64::NAN)),
    ] {
        assert!(stepper.step(&inputs, time, rate).is_err(), "{inputs:?} at {time}, rate {rate:?}");
    }
    let next = stepper.step(&[0.5], 1.0, None).unwrap();
    assert_eq!(next.to_bits(), undisturbed.step(&[0.5], 1.0, None).unwrap().to_bits());
}

#[test]
fn warnings_give_the_share_of_samples_beyond_the_training() {
    let beyond = |factor: f64, rows: usize| {
        let record = record(1, 120);
        let largest = record.inputs()[0].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let mut x = record.inputs()[0].to_vec();
        x[..rows].fill(factor * largest);
        let whole = Record::new("r", vec![x], vec![f64::NAN; 120])
            .unwrap()
            .with_time((0..120).map(|k| 0.1 * k as f64).collect())
            .unwrap();
        Dataset::new(ColumnNames::plain(1), vec![whole]).unwrap()
    };
    let model = model(Family::PreisachNn, 1, None);
    assert_eq!(model.range_warnings(&dataset(1)).unwrap(), []);
    assert_eq!(model.range_warnings(&beyond(0.9, 30)).unwrap(), []);
    let warnings = model.range_warnings(&beyond(1.5, 30)).unwrap();
    let [Warning::OutsideTrainedRange { name, share_percent, trained, seen }] = warnings.as_slice() else {
        panic!("{warnings:?}");
    };
    assert_eq!((name.as_str(), *share_percent), ("x", 25.0));
    assert_eq!(*trained, model.trained_ranges().inputs[0]);
    assert!(seen.1 > 1.4 * trained.1);
    // With a rate, the jump back into the path is one row in 120 of too fast an input.
    let warnings = FULL.range_warnings(&beyond(0.9, 30)).unwrap();
    let [Warning::OutsideTrainedRange { name, share_percent, .. }] = warnings.as_slice() else {
        panic!("{warnings:?}");
    };
    assert_eq!(name, "the rate of x");
    assert!((share_percent - 100.0 / 120.0).abs() < 1e-9);
}

#[test]
fn a_model_whose_rows_take_too_long_is_refused() {
    let fit = |name: &str| hysid::Fit::new().model(name).option("starts", 2).option("epochs", 1);
    let written = fit("pnn").option("members", 2).run(&dataset(1)).unwrap().to_json();
    let law = fit("jiles-atherton").run(&dataset(1)).unwrap().to_json();
    // A member has the fields of a file that are its own.
    let law: serde_json::Map<String, serde_json::Value> = serde_json::from_str(&law).unwrap();
    let own = ["model", "rate", "trained_ranges", "law", "training"];
    let mut law: serde_json::Map<String, serde_json::Value> =
        law.into_iter().filter(|(field, _)| own.contains(&field.as_str())).collect();
    law["trained_ranges"].as_object_mut().unwrap().remove("records");
    let text = |pinning: f64, members: usize| {
        let (head, rest) = written.split_once("\"ensemble\": ").unwrap();
        let mut values = serde_json::Deserializer::from_str(rest).into_iter::<serde_json::Value>();
        let mut ensemble = values.next().unwrap().unwrap();
        let rest = &rest[values.byte_offset()..];
        let voices = ensemble["group"]["voices"][0]["who"]["group"]["voices"].as_array_mut().unwrap();
        *voices = (0..members)
            .map(|member| serde_json::json!({"weights": voices[0]["weights"], "who": {"member": member}}))
            .collect();
        let mut member = serde_json::Value::from(law.clone());
        member["law"]["jiles-atherton"]["k"] = pinning.into();
        ensemble["members"] = vec![member; members].into();
        with_fitting_checksum(&format!("{head}\"ensemble\": {ensemble}{rest}"))
    };
    // Each of 4,000 steps a row takes 200 operations.
    for (pinning, members) in [(0.5, 200), (1e-5, 100)] {
        Model::from_json(&text(pinning, members)).unwrap();
    }
    assert!(refusal(&text(1e-5, 200)).contains("too slow: a row would take longer than 0.1 s"));
}
