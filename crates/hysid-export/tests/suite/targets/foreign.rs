//! Names of columns and files that would be code in comments and pages.

use hysid::Fit;
use hysid::data::record::Dataset;
use hysid::model::Model;
use hysid_core::elementary::sin;
use hysid_export::{Options, Target, export};

/// Ends comments and lines of every language.
const FOREIGN: &str = "a*\\\n/ int foreign_code; /*\r\n foreign_code = 1; \u{85}foreign_code\u{2028}*/\"\"\"'''??/\n\u{fffe}\u{1}\u{202e}<b>";

fn model() -> Model {
    let input: Vec<f64> = (0..80).map(|k| sin(0.2 * f64::from(k)) * f64::from(k) / 40.0).collect();
    let output: Vec<f64> = input.iter().map(|x| 2.0 * x + 0.1).collect();
    let name = format!("x {FOREIGN}");
    let data = Dataset::from_columns(None, &[(&name, &input)], ("", &output)).unwrap();
    Fit::new().model("pnn").option("starts", 1).option("epochs", 2).run(&data).unwrap()
}

#[test]
fn foreign_text_stays_in_its_line() {
    let model = model();
    for target in Target::ALL {
        let mut options = Options::named("ex");
        options.source = vec![("model file".into(), format!("m{FOREIGN}.json"))];
        for file in export(&model, target, &options).unwrap().files {
            let text = String::from_utf8_lossy(&file.content);
            for line in text.lines().filter(|line| line.contains("foreign_code")) {
                // The whole of it, or nothing: no line begins or ends inside.
                assert_eq!(line.matches("foreign_code").count() % 3, 0, "{target:?}, {}: {line}", file.path);
                assert!(!line.trim_end_matches("*/").contains("*/"), "{target:?}, {}: {line}", file.path);
            }
            let is_binary = [".fmu", ".onnx"].iter().any(|ending| file.path.ends_with(ending));
            assert!(
                is_binary || !text.contains(['\u{85}', '\u{2028}', '\u{fffe}', '\u{1}', '\u{202e}']),
                "{}",
                file.path
            );
            assert!(is_binary || !text.contains("*\\\n/"), "{}", file.path);
        }
    }
}
