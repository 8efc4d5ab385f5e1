//! `same-models OLD [--program NEW]`: fits of every model by two programs. Their model files and what these
//! simulate must be the same byte by byte, for changes that are meant to change no result.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use clap::Args;

use crate::program::{self, InFolder, last_line};

/// Rows of each table.
const ROWS: usize = 500;

/// Specimens that the data are of, each with noise on its output.
const SPECIMENS: [&str; 4] =
    ["ferromagnet", "reinforced-concrete-joint", "rate-dependent-actuator", "shape-memory-actuator"];

/// What is fitted to every specimen.
const FITS: [&str; 10] = [
    "--model xpnn --starts 3 --epochs 6",
    "--model xpnn+ --starts 2 --epochs 6 --relaxation 3",
    "--model gpnn --starts 2 --epochs 6",
    "--model pnn --starts 2 --epochs 6",
    "--model masing",
    "--model modified-prandtl-ishlinskii",
    "--model generalized-prandtl-ishlinskii --starts 2 --epochs 6",
    "--model random-stops",
    "--model bouc-wen --starts 2 --epochs 6",
    "--model jiles-atherton --starts 2 --epochs 6",
];

/// What is fitted to one specimen only, by its name.
const FURTHER: [(&str, &str); 15] = [
    ("ferromagnet", "--seed 5"),
    ("rate-dependent-actuator", "--members 1"),
    ("ferromagnet", "--model preisach-nn --starts 2 --epochs 6 --members 2"),
    ("ferromagnet", "--model xpnn --training hybrid --population 12 --epochs 8"),
    ("ferromagnet", "--model xpnn --training genetic --population 12 --epochs 8"),
    ("ferromagnet", "--model xpnn --training subgradient --epochs 8"),
    ("ferromagnet", "--model jiles-atherton --differential-form --starts 2 --epochs 6"),
    ("ferromagnet", "--model preisach --operators 12"),
    ("ferromagnet", "--model prandtl-ishlinskii --sign non-negative"),
    ("ferromagnet", "--model neuro-madelung --starts 1 --epochs 4"),
    ("reinforced-concrete-joint", "--model bouc-wen --degradation --starts 2 --epochs 6"),
    ("reinforced-concrete-joint", "--model xpnn+ --compression 0.3 --history --starts 2 --epochs 6"),
    ("rate-dependent-actuator", "--model rate-dependent-prandtl-ishlinskii --starts 2 --epochs 6"),
    ("rate-dependent-actuator", "--model duhem-nn --starts 2 --epochs 6"),
    (
        "rate-dependent-actuator",
        "--model rate-dependent-prandtl-ishlinskii --logarithmic-thresholds --starts 2 --epochs 6",
    ),
];

/// The programs that are compared.
#[derive(Debug, Args)]
pub struct Request {
    /// The older program
    old: PathBuf,
    /// The newer program; the release build without
    #[arg(long = "program", value_name = "NEW")]
    new: Option<PathBuf>,
}

pub fn run(request: &Request) -> Result<()> {
    let new = request.new.clone().map_or_else(program::build, Ok)?;
    let folder = program::target().join("same-models");
    fs::create_dir_all(&folder)?;
    let in_folder = |program: &Path| -> Result<InFolder> {
        let program = fs::canonicalize(program).with_context(|| program.display().to_string())?;
        Ok(InFolder { program, folder: folder.clone() })
    };
    let programs = [in_folder(&request.old)?, in_folder(&new)?];
    for specimen in SPECIMENS {
        let arguments = format!("generate {specimen} --noise 1 --force -o {specimen}.csv");
        answer(&programs[0], &arguments)?;
        shorten(&folder.join(format!("{specimen}.csv")))?;
    }
    let everywhere = FITS.iter().flat_map(|fit| SPECIMENS.map(|specimen| (specimen, *fit)));
    let (mut fits, mut different, mut refused, mut spent) = (0, 0, 0, [Duration::ZERO; 2]);
    for (specimen, options) in everywhere.chain(FURTHER) {
        let [old, new] = [0, 1].map(|index| {
            let began = Instant::now();
            let outcome = outcome(&programs[index], specimen, options);
            spent[index] += began.elapsed();
            outcome
        });
        fits += 1;
        let (old, new) = (old?, new?);
        if let Outcome::Refused(reason) = &old {
            refused += 1;
            println!("refused: {specimen} {options}: {reason}");
        }
        if old != new {
            different += 1;
            println!("DIFFERENT: {specimen} {options}: {}", old.difference(&new));
        }
    }
    println!(
        "{fits} fits, {refused} refused, {different} different; {:.1} s and {:.1} s, ratio {:.3}",
        spent[0].as_secs_f64(),
        spent[1].as_secs_f64(),
        spent[1].as_secs_f64() / spent[0].as_secs_f64()
    );
    ensure!(different == 0, "{different} of {fits} fits are different");
    Ok(())
}

/// What a fit gives: the model file and a simulation, or how it is refused.
#[derive(Debug, PartialEq)]
enum Outcome {
    Model { file: String, simulated: String },
    Refused(String),
}

impl Outcome {
    fn difference(&self, other: &Self) -> String {
        let (old, new) = match (self, other) {
            (Self::Model { file: old, .. }, Self::Model { file: new, .. }) if old != new => (old, new),
            (Self::Model { simulated: old, .. }, Self::Model { simulated: new, .. }) => (old, new),
            _ => return format!("{} / {}", self.start(), other.start()),
        };
        let same = old.bytes().zip(new.bytes()).take_while(|(old, new)| old == new).count();
        let around = |text: &str| -> String {
            String::from_utf8_lossy(&text.as_bytes()[same.saturating_sub(40).min(text.len())..])
                .chars()
                .take(80)
                .collect()
        };
        format!("at byte {same}: {:?} / {:?}", around(old), around(new))
    }

    fn start(&self) -> &str {
        match self {
            Self::Model { .. } => "a model",
            Self::Refused(reason) => reason,
        }
    }
}

fn outcome(program: &InFolder, specimen: &str, options: &str) -> Result<Outcome> {
    let fit = format!("fit {specimen}.csv --no-report --force -o model.json {options}");
    let fitted = program.output(&fit)?;
    if !fitted.status.success() {
        return Ok(Outcome::Refused(last_line(&fitted)));
    }
    let file = fs::read_to_string(program.path("model.json"))?;
    let simulated = answer(program, &format!("simulate model.json {specimen}.csv"))?;
    Ok(Outcome::Model { file, simulated })
}

/// What the program writes on stdout.
fn answer(program: &InFolder, arguments: &str) -> Result<String> {
    let output = program.output(arguments)?;
    ensure!(output.status.success(), "{} {arguments}: {}", program.program.display(), last_line(&output));
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Keeps the first rows of a table.
fn shorten(table: &Path) -> Result<()> {
    let text = fs::read_to_string(table)?;
    let kept: String = text.split_inclusive('\n').take(ROWS + 1).collect();
    fs::write(table, kept).context("the table cannot be shortened")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_shown_where_it_begins() {
        let of = |file: &str| Outcome::Model { file: file.into(), simulated: String::new() };
        let long = "α".repeat(100);
        assert!(of("ab1c").difference(&of("ab2c")).starts_with("at byte 2:"));
        assert!(of(&long).difference(&of(&format!("{long}x"))).starts_with("at byte 200:"));
        let refused = Outcome::Refused("error: no".into());
        assert_eq!(of("a").difference(&refused), "a model / error: no");
    }
}
