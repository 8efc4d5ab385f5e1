"""The task of the MagNet Challenge 2 on its public records of ferrite 3C90:

    python3 benchmarks/magnet-challenge.py RECORDS.csv [-- OPTIONS OF hysid fit]

RECORDS.csv (or .csv.gz) has the columns record, t_us, B_T, temperature_C, H_A_per_m; three consecutive record numbers are one
waveform at three temperatures. A sixth of these groups is held out at a time. Known are the input and the first n of 1000 outputs;
the error of a record is the rms error over the rms of its other outputs, and the figure is the mean over records and over n = 100,
300, 500, 700, 900. Needs the program hysid and nothing else; the default options are those of the small model of docs/accuracy.md.
"""

import csv
import gzip
import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SMALL = (
    "--model duhem-nn --initial-state free --odd --acceleration --states 6 --hidden 10 --operators 0 "
    "--rate-compression 0.2 --rate central --starts 6"
)
ROLES = "--input B_T --input temperature_C --output H_A_per_m"
KNOWN = [100, 300, 500, 700, 900]
DIVISIONS = 6


def table(path):
    opened = gzip.open(path, "rt") if path.suffix == ".gz" else open(path)
    with opened as file:
        rows = list(csv.reader(file))
    return rows[0], rows[1:]


def write(path, heading, rows):
    with open(path, "w", newline="") as file:
        csv.writer(file).writerows([heading, *rows])


def hysid(folder, *arguments):
    ran = subprocess.run(["hysid", *arguments], cwd=folder, capture_output=True, text=True)
    if ran.returncode != 0:
        sys.exit(ran.stderr)
    return ran.stdout


def relative_errors(measured, simulated, known):
    errors = []
    for record, outputs in measured.items():
        pairs = list(zip(outputs, simulated[record]))[known:]
        error = sum((a - b) ** 2 for a, b in pairs)
        errors.append(math.sqrt(error / sum(a * a for a, _ in pairs)))
    return errors


def by_record(heading, rows, column):
    place, found = heading.index(column), {}
    for row in rows:
        found.setdefault(row[0], []).append(float(row[place]))
    return found


def main():
    options = " ".join(sys.argv[3:]) if sys.argv[2:3] == ["--"] else SMALL
    heading, rows = table(Path(sys.argv[1]))
    number = {row[0]: int("".join(filter(str.isdigit, row[0]))) for row in rows}
    groups = sorted({count // 3 for count in number.values()})
    print(f"{hysid('.', '--version').strip()}, fit {options}")
    means = []
    for division in range(DIVISIONS):
        held = set(groups[division::DIVISIONS])
        with tempfile.TemporaryDirectory() as folder:
            parts = {"train.csv": False, "test.csv": True}
            for name, is_held in parts.items():
                write(f"{folder}/{name}", heading, [r for r in rows if (number[r[0]] // 3 in held) == is_held])
            began = time.perf_counter()
            fitted = hysid(folder, "fit", "train.csv", "-o", "model.json", "--no-report", "--json", *ROLES.split(), *options.split())
            seconds = time.perf_counter() - began
            measured = by_record(*table(Path(folder, "test.csv")), "H_A_per_m")
            errors = []
            for known in KNOWN:
                hysid(folder, "simulate", "model.json", "test.csv", "--known", str(known), "-o", "out.csv", "--force")
                simulated = by_record(*table(Path(folder, "out.csv")), "H_A_per_m_model")
                errors += relative_errors(measured, simulated, known)
        means.append(sum(errors) / len(errors))
        numbers = json.loads(fitted).get("parameters", "?")
        print(f"division {division}: {means[-1]:.3f}, {numbers} numbers, {seconds:.0f} s", flush=True)
    print(f"mean: {sum(means) / len(means):.3f}")


main()
