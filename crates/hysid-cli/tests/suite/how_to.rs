//! Pages of `docs` as a reader follows them: every line of a `sh` block that calls `hysid`, a compiler, or a program of the
//! folder is run, in order, in a folder of the page's own. Each page is a test of its own. Every line of a `text` block must
//! be among the lines that these commands print, word by word: a fit is the same on every computer. The figures in the text
//! and the tables of how-to pages and tutorials must be printed too, to their last digit; the tables of the other pages are
//! the laboratory's.

use std::fs;
use std::path::{Path, PathBuf};

use hysid_core::elementary::powi;

use crate::workbench::Workbench;

/// How the lines begin that are run.
const PROGRAMS: [&str; 3] = ["hysid ", "cc ", "./"];

fn commands(page: &str) -> Vec<&str> {
    let mut inside = false;
    let mut commands = Vec::new();
    for line in page.lines() {
        if line.starts_with("```") {
            inside = line == "```sh";
        } else if inside && PROGRAMS.iter().any(|program| line.starts_with(program)) {
            commands.push(line);
        }
    }
    commands
}

/// The lines of the `text` blocks of a page, without those that mark an omission.
fn shown(page: &str) -> Vec<&str> {
    let blocks = page.split("\n```text\n").skip(1).filter_map(|rest| rest.split_once("\n```"));
    let lines = blocks.flat_map(|(block, _)| block.lines());
    lines.filter(|line| !line.trim().is_empty() && !line.trim().starts_with("...")).collect()
}

/// True for lines of the same words.
fn is_alike(shown: &str, printed: &str) -> bool {
    shown.split_whitespace().eq(printed.split_whitespace())
}

/// The figures in the text and the tables of a page, each with its line: numbers with a decimal point or in percent, of at
/// least two digits.
fn figures(page: &str) -> Vec<(PageNumber, &str)> {
    let mut is_code = false;
    let is_text = |line: &&str| {
        let is_fence = line.starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    };
    let of_line = |line| words(line).into_iter().filter_map(PageNumber::of).map(move |figure| (figure, line));
    page.lines().filter(is_text).flat_map(of_line).collect()
}

/// The words of a line outside of code, links and references, a percent sign with its number.
fn words(line: &str) -> Vec<String> {
    let text: String = line.split('`').step_by(2).collect::<Vec<_>>().join(" ");
    let parts: Vec<&str> = text.split("](").collect();
    let outside = |(place, part): (usize, &&str)| match place {
        0 => part.to_string(),
        _ => part.split_once(')').map_or(String::new(), |(_, rest)| rest.into()),
    };
    let text: Vec<String> = parts.iter().enumerate().map(outside).collect();
    let text = text.join(" ").replace(" %", "%");
    let words = text.split(|c: char| !(c.is_alphanumeric() || ".%".contains(c)));
    words.map(|word| word.trim_end_matches('.').to_string()).collect()
}

/// A number as a page shows it.
struct PageNumber {
    value: f64,
    /// Half of its last digit.
    rounding: f64,
}

impl PageNumber {
    fn of(word: String) -> Option<Self> {
        let bare = word.trim_end_matches('%');
        let value: f64 = bare.parse().ok()?;
        let decimals = bare.split_once('.').map(|(_, decimals)| decimals.len());
        let digits = bare.trim_start_matches(['0', '.']).replace('.', "");
        let digits = if decimals.is_none() { digits.trim_end_matches('0') } else { &digits };
        let is_asked = (decimals.is_some() || word.ends_with('%')) && digits.len() >= 2;
        let rounding = 0.5 * powi(10.0, -(decimals.unwrap_or(0) as i32));
        is_asked.then_some(Self { value, rounding })
    }

    fn is_near(&self, printed: f64) -> bool {
        // A printed number is rounded too.
        (self.value - printed).abs() <= self.rounding + 1e-9 * self.value
    }
}

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

/// Output of the examples that a page names.
fn printed_by_examples(page: &str) -> String {
    let names = page.split("`examples/").skip(1).filter_map(|rest| rest.split_once('.'));
    let texts = names.map(|(name, _)| docs().join("../examples").join(name).with_extension("txt"));
    texts.filter_map(|text| fs::read_to_string(text).ok()).collect()
}

/// The tables of cycles that the commands wrote.
fn tables_of_cycles(bench: &Workbench) -> String {
    let files = fs::read_dir(bench.path("")).unwrap().map(|entry| entry.unwrap().path());
    let tables = files.filter(|path| path.to_string_lossy().ends_with(".cycles.csv"));
    tables.map(|path| fs::read_to_string(path).unwrap().replace(',', " ")).collect()
}

/// Runs the commands of a page, with the files that its reader is to copy.
fn follow(path: &str) {
    let bench = Workbench::new();
    bench.put("testing-machine.csv", include_str!("../files/testing-machine.csv"));
    bench.put("closed_loop.c", include_str!("../../../../examples/closed_loop.c"));
    if path.starts_with("tutorials/") {
        for entry in fs::read_dir(docs().join("tutorials/data")).unwrap() {
            let file = entry.unwrap().path();
            bench.put(&file.file_name().unwrap().to_string_lossy(), fs::read(&file).unwrap());
        }
    }
    let page = fs::read_to_string(docs().join(path)).unwrap();
    let commands = commands(&page);
    assert!(!commands.is_empty(), "{path} has no command");
    let mut printed = String::new();
    for command in commands {
        let ran = bench.shell(command);
        assert_eq!(ran.status, Some(0), "{path}: `{command}`: {}", ran.stderr);
        printed += &format!("{}\n{}\n", ran.stdout, ran.stderr);
    }
    printed += &printed_by_examples(&page);
    printed += &tables_of_cycles(&bench);
    let known: Vec<f64> =
        printed.lines().flat_map(words).filter_map(|word| word.trim_end_matches('%').parse().ok()).collect();
    let is_known = |figure: &PageNumber| known.iter().any(|known| figure.is_near(*known));
    let unknown: Vec<String> = figures(&page)
        .into_iter()
        .filter(|(figure, _)| path.contains('/') && !is_known(figure))
        .map(|(figure, line)| format!("{}: {line}", figure.value))
        .collect();
    assert!(unknown.is_empty(), "{path} has figures that no command prints:\n{}", unknown.join("\n"));
    let is_printed = |line: &&str| printed.lines().any(|printed| is_alike(line, printed));
    let others: Vec<&str> = shown(&page).into_iter().filter(|line| !is_printed(line)).collect();
    assert!(
        others.is_empty(),
        "{path} shows what no command prints:\n{}\n--- printed:\n{printed}",
        others.join("\n")
    );
}

macro_rules! pages {
    ($($test:ident: $path:literal),* $(,)?) => {
        const PAGES: &[&str] = &[$($path),*];

        $(#[test]
        fn $test() {
            follow($path);
        })*
    };
}

pages! {
    closed_loop: "how-to/closed-loop.md",
    compensate_hysteresis: "how-to/compensate-hysteresis.md",
    cycles: "cycles.md",
    diagnose: "how-to/diagnose.md",
    drift: "how-to/drift.md",
    export_as_fmu: "how-to/export-as-fmu.md",
    export_to_abaqus: "how-to/export-to-abaqus.md",
    export_to_c: "how-to/export-to-c.md",
    export_to_matlab: "how-to/export-to-matlab.md",
    export_to_onnx: "how-to/export-to-onnx.md",
    export_to_opensees: "how-to/export-to-opensees.md",
    export_to_python: "how-to/export-to-python.md",
    figures_for_a_paper: "how-to/figures-for-a-paper.md",
    how_far_to_trust: "how-to/how-far-to-trust.md",
    initial_state: "how-to/initial-state.md",
    magnetics: "tutorials/magnetics.md",
    piezo_control: "tutorials/piezo-control.md",
    plan: "plan.md",
    questions: "questions.md",
    read_files: "how-to/read-files.md",
    records_from_the_middle: "how-to/records-from-the-middle.md",
    reproduce_the_paper: "how-to/reproduce-the-paper.md",
    restoring_force: "how-to/restoring-force.md",
    structures: "tutorials/structures.md",
    synthetic_specimen: "how-to/synthetic-specimen.md",
}

#[test]
fn every_page_with_commands_is_followed() {
    for folder in ["how-to", "tutorials"] {
        for entry in fs::read_dir(docs().join(folder)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            let path = format!("{folder}/{name}");
            if name.ends_with(".md") && !commands(&fs::read_to_string(docs().join(&path)).unwrap()).is_empty()
            {
                assert!(PAGES.contains(&path.as_str()), "{path} is not among the pages");
            }
        }
    }
}

#[test]
fn lines_are_alike_whose_words_are_equal() {
    assert!(is_alike("loss  at 5 Hz: 97.2 J/m3", "loss at 5 Hz: 97.2   J/m3"));
    for other in ["loss at 5 Hz: 97.3 J/m3", "loss at 5 Hz: 97.2 W/m3", "loss at 5 Hz: 97.2"] {
        assert!(!is_alike("loss at 5 Hz: 97.2 J/m3", other), "{other}");
    }
}

#[test]
fn figures_are_found_in_the_text_and_the_tables_alone() {
    let page = "Off by 3.40 % ([1.5](2.5)), `6.5`, 10 %, 20 rows.\n| a | -12.5 |\n```text\n7.5\n```\n";
    let found: Vec<f64> = figures(page).iter().map(|(figure, _)| figure.value).collect();
    assert_eq!(found, [3.4, 1.5, 12.5]);
    let figure = |word: &str| PageNumber::of(word.into()).unwrap();
    assert!(figure("3.4").is_near(3.449) && figure("3.40").is_near(3.404) && !figure("3.40").is_near(3.41));
}

#[test]
fn the_blocks_of_a_page_have_its_lines() {
    assert_eq!(shown("a\n```text\nb 1\n...\n\nc\n```\nd\n```sh\ne\n```\n"), ["b 1", "c"]);
}

#[test]
fn only_lines_of_shell_blocks_are_commands() {
    let page = "hysid a\n```sh\nhysid b\ncargo c\n  hysid d\n```\nhysid e\n```json\nhysid f\n```\n```sh\nhysid g # h\n```\n";
    assert_eq!(commands(page), ["hysid b", "hysid g # h"]);
}
