//! `cargo xtask same-arithmetic`: the same models, and the same outputs of exported C, with every instruction set.
//!
//! The program runs natively, narrowed to smaller instruction sets, and on processors that qemu-x86_64 emulates (package
//! qemu-user), which are left out where it is missing. Narrow sets and emulated processors are slow: the fits are small.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use crate::cargo::{build_everything, built_program, target};

/// Where programs run: with what name, narrowed to which instruction set, on which emulated processor.
struct Machine {
    name: &'static str,
    narrow_to: &'static str,
    processor: Option<&'static str>,
}

const fn machine(name: &'static str, narrow_to: &'static str, processor: Option<&'static str>) -> Machine {
    Machine { name, narrow_to, processor }
}

const MACHINES: [Machine; 5] = [
    machine("native", "", None),
    machine("AVX2", "AVX2", None),
    machine("baseline", "baseline", None),
    machine("qemu Haswell", "", Some("Haswell")),
    machine("qemu Nehalem", "", Some("Nehalem")),
];

/// Rows of the training data: every fifth of those that the program generates.
const ROWS: usize = 120;
const EVERY: usize = 5;

/// Specimens that give training data, and the models that are fitted to each: every kind, some with options.
const FITS: [(&str, &[&str]); 3] = [
    (
        "reinforced-concrete-joint",
        &[
            "pnn",
            "gpnn",
            "preisach-nn",
            "xpnn",
            "xpnn+",
            "masing",
            "prandtl-ishlinskii",
            "modified-prandtl-ishlinskii",
            "generalized-prandtl-ishlinskii",
            "preisach",
            "neuro-madelung",
            "bouc-wen",
            "peak-oriented",
            "menegotto-pinto",
            "duhem-nn",
            "random-stops",
            "bouc-wen --degradation",
            "auto",
        ],
    ),
    (
        "terfenol-rod",
        &[
            "pnn",
            "gpnn",
            "preisach-nn",
            "xpnn",
            "xpnn+",
            "rate-dependent-prandtl-ishlinskii",
            "neuro-madelung",
            "lugre",
            "duhem-nn",
            "hysteretic-oscillator",
            "hysteretic-state-space",
            "random-stops",
            "preisach",
        ],
    ),
    (
        "ferromagnet",
        &[
            "jiles-atherton",
            "preisach",
            "xpnn",
            "xpnn+",
            "gpnn",
            "preisach-nn",
            "neuro-madelung",
            "generalized-prandtl-ishlinskii",
            "duhem-nn",
        ],
    ),
];

/// Steps of exported C: everywhere, and where no processor is emulated.
const STEPS: &str = "50000";
const MANY_STEPS: &str = "1000000";

/// Runs so many steps of an exported model along a random walk within the trained range, and prints a checksum of the
/// bits of the outputs.
const WALK: &str = r#"#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "exported.h"

static uint64_t random_bits = 88172645463325252u;

static double uniform(void)
{
    random_bits ^= random_bits << 13;
    random_bits ^= random_bits >> 7;
    random_bits ^= random_bits << 17;
    return (double)(random_bits >> 11) / 9007199254740992.0;
}

int main(int count, char **arguments)
{
    static exported_model model;
    const long steps = count > 1 ? atol(arguments[1]) : 0;
    uint64_t checksum = 0;
    double x = LOWEST;
    double goal = x;
    long k;
    exported_reset(&model);
    for (k = 0; k < steps; k++) {
        double y;
        uint64_t bits;
        if (k % 37 == 0) {
            goal = LOWEST + (HIGHEST - LOWEST) * (1.2 * uniform() - 0.1);
        }
        x += (goal - x) * 0.1;
        y = exported_step(&model, ARGUMENTS);
        memcpy(&bits, &y, sizeof bits);
        checksum = (checksum << 5 | checksum >> 59) ^ bits;
    }
    printf("%016llx\n", (unsigned long long)checksum);
    return 0;
}
"#;

/// Runs every so many of the fits.
pub fn run(every: usize) -> Result<()> {
    build_everything()?;
    let folder = target()?.join("same-arithmetic");
    if folder.exists() {
        fs::remove_dir_all(&folder).context("the results of the run before cannot be removed")?;
    }
    let machines: Vec<&Machine> =
        MACHINES.iter().filter(|machine| machine.processor.is_none() || has_emulator()).collect();
    let mut results = BTreeMap::new();
    for machine in &machines {
        println!("==> {}", machine.name);
        let place = folder.join(machine.name.replace(' ', "-"));
        fs::create_dir_all(&place)?;
        results.insert(machine.name, machine.results(&place, every)?);
    }
    let expected = &results["native"];
    let mut differences = Vec::new();
    for (name, found) in &results {
        for (what, bytes) in found {
            if expected.get(what) != Some(bytes) {
                differences.push(format!("{name}: {what}"));
            }
        }
        println!("{name}: {} results", found.len());
    }
    ensure!(differences.is_empty(), "these differ from the native ones:\n{}", differences.join("\n"));
    println!("all are equal to the last bit");
    Ok(())
}

fn has_emulator() -> bool {
    Command::new("qemu-x86_64").arg("--version").output().is_ok_and(|output| output.status.success())
}

impl Machine {
    fn command(&self, program: &Path) -> Command {
        let mut command = match self.processor {
            None => Command::new(program),
            Some(processor) => {
                let mut emulator = Command::new("qemu-x86_64");
                emulator.args(["-cpu", processor]).arg(program);
                emulator
            }
        };
        if !self.narrow_to.is_empty() {
            command.env("HYSID_INSTRUCTIONS", self.narrow_to);
        }
        command
    }

    fn hysid<A: AsRef<OsStr>>(&self, place: &Path, arguments: impl IntoIterator<Item = A>) -> Result<()> {
        let mut command = self.command(&built_program()?);
        let output = command.arg("--quiet").args(arguments).current_dir(place).output()?;
        let errors = String::from_utf8_lossy(&output.stderr);
        ensure!(output.status.success(), "{command:?} on {}: {errors}", self.name);
        Ok(())
    }

    /// Every model file and every checksum of outputs, by name.
    fn results(&self, place: &Path, every: usize) -> Result<BTreeMap<String, Vec<u8>>> {
        let mut results = BTreeMap::new();
        for (specimen, models) in FITS {
            let data = format!("{specimen}.csv");
            self.hysid(place, ["generate", specimen, "-o", &data, "--noise", "1"])?;
            let text = fs::read_to_string(place.join(&data))?;
            let (names, rows) = text.split_once('\n').context("no names of columns")?;
            let rows: String = rows.split_inclusive('\n').step_by(EVERY).take(ROWS).collect();
            let short = format!("{names}\n{rows}");
            fs::write(place.join(&data), &short)?;
            results.insert(data.clone(), short.into_bytes());
            for (number, model) in models.iter().enumerate().step_by(every) {
                let file = format!("{specimen}-{number}.json");
                let options = "--starts 1 --epochs 6 --no-report --force --initial-state virgin -o";
                let arguments =
                    ["fit", &data, "--model"].into_iter().chain(model.split(' ')).chain(options.split(' '));
                self.hysid(place, arguments.chain([&*file]))?;
                results.insert(format!("{model} of {specimen}"), fs::read(place.join(&file))?);
                let walk = self.compiled(place, &file)?;
                for steps in self.steps() {
                    let output = self.command(&walk).arg(steps).output()?;
                    ensure!(output.status.success(), "exported {model} on {}", self.name);
                    results
                        .insert(format!("{steps} outputs of exported {model} of {specimen}"), output.stdout);
                }
            }
        }
        Ok(results)
    }

    fn steps(&self) -> &'static [&'static str] {
        if self.processor.is_some() { &[STEPS] } else { &[STEPS, MANY_STEPS] }
    }

    /// The program of the walk of an exported model.
    fn compiled(&self, place: &Path, model: &str) -> Result<PathBuf> {
        self.hysid(place, ["export", "--to", "c", "--name", "exported", "--force", "-o", "c", model])?;
        let folder = place.join("c");
        fs::write(folder.join("walk.c"), WALK)?;
        let compiled = Command::new("gcc")
            .args(["-std=c99", "-O2", "-o", "walk", "walk.c", "exported.c", "-lm"])
            .args(definitions(&fs::read_to_string(folder.join("exported.h"))?)?)
            .current_dir(&folder)
            .output()?;
        ensure!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
        Ok(folder.join("walk"))
    }
}

/// Definitions for the walk through an exported model: the range of its input, and the arguments of a step.
fn definitions(header: &str) -> Result<[String; 3]> {
    let range = header.lines().find_map(|line| line.split_once("trained from ")?.1.split_once(" to "));
    let (lowest, highest) = range.context("the header names no range of the input")?;
    let step = header
        .lines()
        .find_map(|line| line.split_once("exported_step(exported_model *model, ")?.1.strip_suffix(");"));
    let names = step.context("the header declares no step")?.split(", ");
    let values = names.map(|name| if name.ends_with(" x") { "x" } else { "0.01" });
    Ok([
        format!("-DLOWEST=({lowest})"),
        format!("-DHIGHEST=({highest})"),
        format!("-DARGUMENTS={}", values.collect::<Vec<_>>().join(",")),
    ])
}
