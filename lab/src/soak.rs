//! `soak [KILLS]`: the program under conditions that no test has time for. It is killed at random
//! moments, writes to a full disk, races with itself for one file, and fits every model to nasty data under a time
//! limit. A report says what was done and what went wrong.

use std::fs;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use clap::Args;
use hysid::options::ModelName;
use hysid_core::elementary::sin;

use crate::program::{self, InFolder, last_line};

/// Longest time before a kill, of the time that the fit takes.
const LONGEST: f64 = 1.2;

/// Time limit of a fit, in seconds.
const LIMIT: f64 = 1.0;

/// Time that a fit may take beyond its limit, for reading and writing and the half second that is promised.
const BEYOND: f64 = 1.5;

/// Writers of one file.
const WRITERS: usize = 8;

/// How long to try.
#[derive(Debug, Args)]
pub struct Request {
    /// Fits to kill
    #[arg(default_value_t = 200)]
    kills: usize,
}

/// What was done, and what went wrong.
struct Report {
    lines: Vec<String>,
    faults: Vec<String>,
}

impl Report {
    fn require(&mut self, is_so: bool, fault: impl FnOnce() -> String) {
        if !is_so {
            self.faults.push(fault());
        }
    }
}

/// The program in a folder of its own.
struct Bench(InFolder);

pub fn run(request: &Request) -> Result<()> {
    let program = program::build()?;
    let folder = program::target().join("soak");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    let bench = Bench(InFolder { program, folder });
    let mut report = Report { lines: Vec::new(), faults: Vec::new() };
    bench.kills(request.kills, &mut report)?;
    if cfg!(unix) {
        bench.full_disk(&mut report)?;
    }
    bench.race(&mut report)?;
    bench.nasty_data(&mut report)?;
    println!("\n{}", report.lines.join("\n"));
    report.faults.iter().for_each(|fault| println!("FAULT: {fault}"));
    ensure!(report.faults.is_empty(), "{} faults", report.faults.len());
    println!("no faults");
    Ok(())
}

impl Bench {
    fn spawn(&self, arguments: &str) -> Result<Child> {
        let mut command = self.0.command(arguments);
        command.stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().context("the program could not be started")
    }

    fn succeeds(&self, arguments: &str) -> Result<bool> {
        Ok(self.0.output(arguments)?.status.success())
    }

    /// A fit is killed at random moments and resumed: whatever is there is whole.
    fn kills(&self, kills: usize, report: &mut Report) -> Result<()> {
        fs::write(self.0.path("data.csv"), record(1000, 1))?;
        let fit = "fit data.csv --model xpnn+ --starts 2 --epochs 30 --no-report --force -o model.json";
        let began = Instant::now();
        report.require(self.succeeds(fit)?, || "the fit that is to be killed failed".into());
        let undisturbed = began.elapsed();
        let (mut resumed, mut finished) = (0, 0);
        for kill in 0..kills {
            let has_checkpoint = self.0.path("state.bin").exists();
            let arguments = match has_checkpoint && kill % 4 != 0 {
                true => "fit data.csv --no-report --force -o model.json --resume state.bin".to_string(),
                false => format!("{fit} --checkpoint state.bin"),
            };
            let mut child = self.spawn(&arguments)?;
            // Every other one in the last tenth, where files are written.
            let share = share(kill as u64);
            let share = if kill % 2 == 0 { LONGEST * share } else { 0.95 + 0.1 * share };
            thread::sleep(undisturbed.mul_f64(share));
            // One that has ended need not be killed.
            let _ = child.kill();
            finished += usize::from(child.wait()?.success());
            let is_whole = self.succeeds("evaluate model.json data.csv")?;
            report.require(is_whole, || format!("kill {kill}: model.json cannot be read"));
            if self.0.path("state.bin").exists() && kill % 10 == 0 {
                resumed += 1;
                let goes_on = self.0.output(
                    "fit data.csv --no-report --force -o resumed.json --resume state.bin --time-limit 0.2",
                )?;
                report.require(goes_on.status.success(), || format!("kill {kill}: {}", last_line(&goes_on)));
            }
        }
        // A last run removes what killed ones left behind.
        let last = format!("{fit} --checkpoint state.bin --time-limit 0.2");
        report.require(self.succeeds(&last)?, || "the last fit failed".into());
        self.require_no_partial_files("kills", report)?;
        report.lines.push(format!(
            "{kills} kills: {finished} came too late, {resumed} checkpoints were resumed, no partial file is left"
        ));
        Ok(())
    }

    fn require_no_partial_files(&self, after: &str, report: &mut Report) -> Result<()> {
        for entry in fs::read_dir(&self.0.folder)? {
            let name = entry?.file_name().to_string_lossy().into_owned();
            report.require(!name.ends_with(".hysid-partial"), || format!("{name} is left after {after}"));
        }
        Ok(())
    }

    /// A file that may not grow: an error, and the old model stays.
    fn full_disk(&self, report: &mut Report) -> Result<()> {
        self.0.output("fit data.csv --model pnn --starts 1 --epochs 2 --no-report --force -o full.json")?;
        let before = fs::read(self.0.path("full.json"))?;
        let mut failed = 0;
        for blocks in 0..6 {
            let line = format!(
                "ulimit -f {blocks}; exec '{}' fit data.csv --model xpnn+ --starts 1 --epochs 2 --force -o full.json",
                self.0.program.display()
            );
            let output = Command::new("sh").current_dir(&self.0.folder).args(["-c", &line]).output()?;
            let now = fs::read(self.0.path("full.json"))?;
            let is_whole = self.succeeds("evaluate full.json data.csv")?;
            report.require(is_whole, || format!("with {blocks} blocks full.json cannot be read"));
            if !output.status.success() {
                failed += 1;
                let said = last_line(&output);
                report.require(said.starts_with("error: "), || format!("with {blocks} blocks: {said}"));
            }
            report.require(blocks > 0 || now == before, || "a model was replaced on a full disk".into());
        }
        report
            .lines
            .push(format!("full disk: {failed} of 6 writes failed, each with an error, no model was lost"));
        Ok(())
    }

    /// Several fits write one model: it is that of one of them.
    fn race(&self, report: &mut Report) -> Result<()> {
        let fit = "fit data.csv --model pnn --starts 1 --epochs 1 --no-report --force -o race.json --seed";
        let mut writers = Vec::new();
        for round in 0..5 * WRITERS {
            writers.push(self.spawn(&format!("{fit} {round}"))?);
            if writers.len() == WRITERS {
                for mut writer in writers.drain(..) {
                    let status = writer.wait()?;
                    report.require(status.success(), || format!("a racing writer failed: {status}"));
                }
                let is_whole = self.succeeds("evaluate race.json data.csv")?;
                report.require(is_whole, || "race.json cannot be read".into());
            }
        }
        self.require_no_partial_files("the race", report)?;
        report.lines.push(format!("race: {} writers of one file, {WRITERS} at a time", 5 * WRITERS));
        Ok(())
    }

    /// Every model on every nasty table: it ends soon after its limit, with a model or an error.
    fn nasty_data(&self, report: &mut Report) -> Result<()> {
        report.lines.push(format!("time limit of {LIMIT} s: longest time, models and errors"));
        for (name, text) in nasty() {
            fs::write(self.0.path("nasty.csv"), text)?;
            let (mut longest, mut slowest, mut models, mut errors) = (0.0, "", 0, 0);
            for model in ModelName::all().chain([ModelName::AUTO]) {
                let model = model.name();
                let began = Instant::now();
                let output = self.0.output(&format!(
                    "fit nasty.csv --model {model} --no-report --force -o nasty.json --time-limit {LIMIT}"
                ))?;
                let elapsed = began.elapsed().as_secs_f64();
                if elapsed > longest {
                    (longest, slowest) = (elapsed, model);
                }
                match output.status.code() {
                    Some(0) => models += 1,
                    Some(1 | 2) => errors += 1,
                    status => report.faults.push(format!("{model} on {name}: status {status:?}")),
                }
                report.require(elapsed < LIMIT + BEYOND, || format!("{model} on {name} took {elapsed:.1} s"));
            }
            report
                .lines
                .push(format!("  {name:28} {longest:4.1} s ({slowest}), {models} models, {errors} errors"));
        }
        Ok(())
    }
}

/// A number from 0 to 1, another for each number.
fn share(number: u64) -> f64 {
    let mixed = (number + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (mixed ^ (mixed >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9) as f64 / u64::MAX as f64
}

/// A lagging output under a noisy oscillation.
fn record(rows: u64, records: u64) -> String {
    let mut text = String::from("record,t,x,y\n");
    for record in 0..records {
        let mut play: f64 = 0.0;
        for row in 0..rows {
            let x = sin(0.02 * row as f64) + 0.02 * share(row + rows * record);
            play = play.clamp(x - 0.3, x + 0.3);
            text += &format!("{record},{},{x},{}\n", 0.01 * row as f64, 0.5 * x + play);
        }
    }
    text
}

/// Tables that are hard to fit to.
fn nasty() -> Vec<(&'static str, String)> {
    let of = |rows: u64, x: &dyn Fn(u64) -> f64, y: &dyn Fn(u64) -> f64| {
        let rows = (0..rows).map(|k| format!("{},{},{}\n", 0.1 * k as f64, x(k), y(k)));
        format!("t,x,y\n{}", rows.collect::<String>())
    };
    let sine = |k: u64| sin(0.1 * k as f64);
    vec![
        ("200,000 noisy rows", record(200_000, 1)),
        ("3000 records", record(40, 3000)),
        ("noise alone", of(5000, &|k| share(k), &|k| share(k + 99_991))),
        ("values of 1e90", of(2000, &|k| 1e90 * sine(k), &|k| 1e90 * sine(k + 5))),
        ("values of 1e-90", of(2000, &|k| 1e-90 * sine(k), &|k| 1e-90 * sine(k + 5))),
        ("an offset of 1e12", of(2000, &|k| 1e12 + sine(k), &|k| -1e12 + sine(k + 5))),
        ("one spike", of(3000, &|k| if k == 1500 { 1e9 } else { sine(k) }, &sine)),
        ("two values of the input", of(3000, &|k| f64::from(u8::from(share(k) > 0.5)), &sine)),
        (
            "a step, then nothing",
            of(3000, &|k| f64::from(u8::from(k > 10)), &|k| f64::from(u8::from(k > 12))),
        ),
        ("eleven rows", of(11, &sine, &|k| sine(k + 3))),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_spread() {
        let mean = (0..1000).map(share).sum::<f64>() / 1000.0;
        assert!((0.4..0.6).contains(&mean), "{mean}");
    }
}
