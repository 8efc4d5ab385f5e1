//! How the program read the data, reported before the work begins.

use hysid_core::data::rate::RateMethod;
use hysid_core::data::record::{ProtocolDifference, RepeatedProtocol, SpeedEvidence, protocols};
use hysid_core::data::summary::Summary;
use hysid_core::options::FitSpec;
use hysid_core::options::classical::{ClassicalOptions, FittedError};
use hysid_core::options::fit_spec::AutoOptions;
use hysid_core::significant::Significant;
use hysid_core::words::{Hint, Words};
use hysid_document::Face;

use crate::data::Data;
use hysid_core::data::unit;
use hysid_document::plain::{WIDTH, wrapped};
use hysid_document::visible::{clipped, listed, listed_paths};
use hysid_tables::TableOrigin;

/// Room for a label and the blank behind it.
const LABEL: usize = 9;

/// Largest number of repeated tests that are listed one by one.
const MOST_REPEATS: usize = 5;

const MOST_INPUTS: usize = 20;

/// The request of a fit to these data, as labels and texts.
pub fn of_request(data: &Data, request: &FitSpec, model: &str, face: Face) -> Vec<(String, String)> {
    let used = request.rate().filter(|_| request.model().uses_rate());
    let mut lines = vec![("model".to_string(), format!("{}{model}", request.model().name()))];
    let is_one_speed = || data.set.has_time() && data.set.speeds() == SpeedEvidence::One;
    if used.is_none() && request.model().uses_rate() && is_one_speed() {
        let words =
            "none: each input value was passed at one speed only, so the data cannot show a rate dependence";
        let backward = Hint::Value("rate", "backward".into());
        let advised = Words::from(words).advised(Words::from("to use the rate anyway: ") + backward);
        lines.push(("rate".into(), face.told(&advised)));
    } else if let Some(method) = used {
        lines.push(("rate".into(), rate(&data.roles.inputs[0], data.roles.rate.as_deref(), method)));
    }
    if let FitSpec::Classical(options) = request {
        lines.extend(error_of_records(options, data, face).map(|text| ("error".to_string(), text)));
    }
    lines
}

/// The data in two lines, and what was left out of them; `hysid look` and [`of_data`] tell more.
pub fn in_short(data: &Data, summary: &Summary, face: Face) -> Vec<(String, String)> {
    let files: Vec<&str> = data.source.tables.iter().map(|table| table.file.as_str()).collect();
    let turning = turning_points(summary);
    let samples = samples(summary, " samples");
    let mut lines = vec![("data".to_string(), format!("{}: {samples}, {turning}", listed_paths(&files)))];
    let inputs = data.roles.inputs.iter().zip(&summary.inputs);
    let mut columns: Vec<String> =
        inputs.take(MOST_INPUTS).map(|(name, range)| format!("input {}", ranged(name, *range))).collect();
    if let Some(more) = summary.inputs.len().checked_sub(MOST_INPUTS).filter(|&more| more > 0) {
        columns.push(format!("and {more} more inputs"));
    }
    columns.push(format!("output {}", output(data, summary)));
    columns.extend(time(data, summary).map(|text| format!("time {text}")));
    columns.extend(data.roles.guessed.as_ref().map(|guessed| format!("guessed {}", face.told(guessed))));
    lines.push(("columns".into(), columns.join("; ")));
    let left_out = data.source.tables.iter().filter_map(|table| table.left_out.described());
    lines.extend(left_out.map(|text| ("left out".to_string(), text)));
    lines.extend(repeats(data).into_iter().map(|text| ("repeats".to_string(), text)));
    let ignored: Vec<&str> = data.roles.set_aside.iter().map(|(name, _)| name.as_str()).collect();
    if !ignored.is_empty() {
        lines.push(("ignored".into(), format!("{} (`hysid look` says why)", listed(&ignored))));
    }
    lines
}

/// That the fit weighs each record by its size, which nobody asked for.
fn error_of_records(options: &ClassicalOptions, data: &Data, face: Face) -> Option<String> {
    let is_default = options.error.is_none() && options.model.facts().options.contains(&"error");
    if !is_default || options.fitted_error(&data.set) == FittedError::Row {
        return None;
    }
    let words = match data.set.size_ratio() {
        ratio if ratio > ClassicalOptions::RATIO_OF_SIZES => format!(
            "of each record relative to its size, because the outputs of the largest record are {:.2} times those of the \
             smallest",
            Significant(ratio)
        ),
        _ => "of each record relative to its size".into(),
    };
    let row = Hint::Value("error", "row".into());
    Some(face.told(&Words::from(words).advised(Words::from("to weigh all rows alike: ") + row)))
}

pub fn of_data(data: &Data, summary: &Summary, face: Face) -> Vec<(String, String)> {
    let mut lines: Vec<(String, String)> = Vec::new();
    let mut say = |label: &str, text: String| lines.push((label.to_string(), text));
    let files: Vec<&str> = data.source.tables.iter().map(|table| table.file.as_str()).collect();
    say(if files.len() == 1 { "file" } else { "files" }, listed_paths(&files));
    for (text, count) in as_read(&data.source.tables) {
        let others =
            if count < files.len() { format!(" ({count} of {} files)", files.len()) } else { String::new() };
        say("read as", text + &others);
    }
    for table in &data.source.tables {
        if let Some(text) = table.left_out.described() {
            let file = if files.len() == 1 { String::new() } else { format!("{}: ", clipped(&table.file)) };
            say("left out", file + &text);
        }
    }
    say("samples", samples(summary, ""));
    for text in repeats(data) {
        say("repeats", text);
    }
    if let Some(text) = time(data, summary) {
        say("time", text);
    }
    let inputs: Vec<(&String, &(f64, f64))> = data.roles.inputs.iter().zip(&summary.inputs).collect();
    for (name, range) in inputs.iter().take(MOST_INPUTS) {
        say("input", ranged(name, **range));
    }
    if let Some(more) = inputs.len().checked_sub(MOST_INPUTS).filter(|&more| more > 0) {
        say("", format!("and {more} more"));
    }
    say("output", output(data, summary));
    for (name, reason) in data.roles.set_aside.iter().take(MOST_INPUTS) {
        say("ignored", format!("{}: {}", clipped(name), face.told(reason)));
    }
    if let Some(guessed) = &data.roles.guessed {
        say("guessed", face.told(guessed));
    }
    say("turning", format!("{} of {}", turning_points(summary), clipped(&data.roles.inputs[0])));
    lines
}

/// A label and its text, in lines within 80 columns where words allow.
pub fn labelled(label: &str, text: &str) -> String {
    let mut label = label;
    let mut lines = String::new();
    for line in wrapped(text, WIDTH - LABEL) {
        lines += &format!("{label:<LABEL$}{line}\n");
        label = "";
    }
    lines
}

/// Candidates of an automatic model, in words.
pub fn choice(options: &AutoOptions) -> String {
    match &options.only {
        Some(request) => format!(": at most {} fits of {}", options.members, request.model().name()),
        None if options.members == 1 => ": one model, chosen by cross-validation".into(),
        None => {
            format!(": at most {} models, chosen by cross-validation", options.members)
        }
    }
}

/// In which ways tables were read, and how many in each way.
fn as_read(tables: &[TableOrigin]) -> Vec<(String, usize)> {
    let mut ways: Vec<(String, usize)> = Vec::new();
    for table in tables {
        let way = table.described();
        match ways.iter_mut().find(|(known, _)| *known == way) {
            Some((_, count)) => *count += 1,
            None => ways.push((way, 1)),
        }
    }
    ways
}

fn turning_points(summary: &Summary) -> String {
    match summary.turning_points() {
        1 => "1 turning point".into(),
        turning => format!("{turning} turning points"),
    }
}

fn output(data: &Data, summary: &Summary) -> String {
    let missing = match summary.rows - summary.scored {
        0 => String::new(),
        missing => format!(", missing in {missing} rows"),
    };
    ranged(&data.roles.output, summary.output) + &missing
}

/// The column of time and its steps.
fn time(data: &Data, summary: &Summary) -> Option<String> {
    let time = data.roles.time.as_ref()?;
    let steps = time_steps(summary, &unit::suffix(unit::of_column(time).as_deref()));
    Some(format!("{}: {steps}", clipped(time)))
}

fn samples(summary: &Summary, word: &str) -> String {
    let scored = match summary.scored == summary.rows {
        true => "all scored".to_string(),
        false => format!("{} scored", summary.scored),
    };
    let records = match summary.records.as_slice() {
        [_] => "1 record".to_string(),
        records => {
            let names: Vec<&str> = records.iter().map(|record| record.name.as_str()).collect();
            format!("{} records: {}", records.len(), listed(&names))
        }
    };
    format!("{}{word}, {scored}, in {records}", summary.rows)
}

/// Repeated protocols, and the noise that they show; the first few if there are many.
fn repeats(data: &Data) -> Vec<String> {
    let records = data.set.records();
    let (low, high) = data.set.output_range();
    let repeated = protocols(records).into_iter().filter(|protocol| protocol.runs.len() > 1);
    let words = |protocol: RepeatedProtocol| {
        let names: Vec<&str> = protocol.runs.iter().map(|&run| records[run].name()).collect();
        let percent =
            |deviation: f64| format!("{:.3} % of the range", Significant(100.0 * deviation / (high - low)));
        let differ = match protocol.difference(records) {
            Some(ProtocolDifference { deviation: 0.0, .. }) => String::new(),
            Some(ProtocolDifference { deviation, is_noise: true }) => format!(
                "; their outputs differ by noise of {} (standard deviation), the least error of any model",
                percent(deviation)
            ),
            Some(ProtocolDifference { deviation, is_noise: false }) => format!(
                "; their outputs differ by {} (standard deviation), and not by noise alone: the conditions, the specimen \
                 or the input differed; a model that does not know this has at least this error",
                percent(deviation)
            ),
            None => String::new(),
        };
        format!("{} have the same input and are held out together{differ}", listed(&names))
    };
    repeated.take(MOST_REPEATS).map(words).collect()
}

fn time_steps(summary: &Summary, unit: &str) -> String {
    let steps = || summary.records.iter().filter_map(|record| record.time_steps);
    let shortest = steps().map(|step| step.0).fold(f64::INFINITY, f64::min);
    let longest = steps().map(|step| step.2).fold(0.0, f64::max);
    if longest == 0.0 {
        "one sample per record".into()
    } else if longest - shortest <= 1e-3 * longest {
        format!("steps of {:.4}{unit}", Significant(longest))
    } else {
        format!("steps of {:.4} to {:.4}{unit}", Significant(shortest), Significant(longest))
    }
}

fn ranged(name: &str, (low, high): (f64, f64)) -> String {
    let unit = unit::suffix(unit::of_column(name).as_deref());
    let (name, unit) = (clipped(name), clipped(&unit));
    if low > high {
        return format!("{name}: blank");
    }
    format!("{name}: {:.4} to {:.4}{unit}", Significant(low), Significant(high))
}

fn rate(input: &str, column: Option<&str>, method: RateMethod) -> String {
    let (input, column) = (clipped(input), clipped(column.unwrap_or_default()));
    match method {
        RateMethod::Given => format!("of {input} from column {column}"),
        RateMethod::Central => format!("of {input} by central differences"),
        RateMethod::Backward => format!("of {input} by backward differences"),
        RateMethod::SavitzkyGolay => format!("of {input} by the Savitzky-Golay method"),
    }
}
