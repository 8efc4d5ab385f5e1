//! The figures of `docs/tutorials`, drawn from the data in `docs/tutorials/data` alone. `HYSID_WRITE=1 cargo test
//! --test tutorial_figures` draws them anew.

use std::fs;
use std::path::{Path, PathBuf};

use hysid_document::chart::{Chart, Colour, Curve};

const SIZE: (f64, f64) = (640.0, 360.0);

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs")
}

/// The rows of a table of data as cells; `separator` is that of its columns.
fn rows(name: &str, separator: char) -> Vec<Vec<String>> {
    let text = fs::read_to_string(docs().join("tutorials/data").join(name)).unwrap();
    let cells = |line: &str| -> Vec<String> {
        // The names of records are the only quoted cells, and the only ones with a comma inside.
        let line = match line.strip_prefix('"').and_then(|rest| rest.split_once('"')) {
            Some((name, rest)) => format!("{}{rest}", name.replace(',', "")),
            None => line.to_owned(),
        };
        line.split(separator).map(str::to_owned).collect()
    };
    text.lines().map(cells).collect()
}

/// Two columns of the rows that are numbers there, of one record if it is named.
fn points(rows: &[Vec<String>], [x, y]: [usize; 2], record: Option<&str>) -> Vec<(f64, f64)> {
    let number = |row: &Vec<String>, column: usize| row.get(column)?.replace(',', ".").parse::<f64>().ok();
    let is_of_record = |row: &&Vec<String>| record.is_none_or(|record| row[0] == record);
    rows.iter().filter(is_of_record).filter_map(|row| Some((number(row, x)?, number(row, y)?))).collect()
}

fn check(name: &str, chart: &Chart) {
    let place = docs().join("images").join(name);
    let drawn = chart.file("lab/tests/tutorial_figures.rs");
    if std::env::var_os("HYSID_WRITE").is_some() {
        fs::write(&place, &drawn).unwrap();
    }
    let stored = fs::read_to_string(&place).unwrap_or_default().replace("\r\n", "\n");
    assert!(stored == drawn, "{name}: HYSID_WRITE=1 cargo test draws it anew");
    assert!(drawn.len() < 100_000, "{name} has {} bytes", drawn.len());
}

#[test]
fn the_column_is_drawn_from_its_records() {
    let test = points(&rows("column-test.txt", ';'), [1, 2], None);
    let earthquake = points(&rows("earthquake-60.csv", ','), [1, 2], None);
    let curves =
        vec![Curve::new(test, Colour::Measured, 1.0), Curve::new(earthquake, Colour::Series(1), 1.2)];
    let description = "Force over displacement of the column: loops of growing amplitude in the cyclic test, and the \
                       irregular loops of the earthquake of 60 mm inside them";
    let chart = Chart::new(description, "displacement, mm", "force, kN", curves).sized(SIZE.0, SIZE.1);
    let legend = [(Colour::Measured, "cyclic test"), (Colour::Series(1), "earthquake of 60 mm")];
    check("tutorial-column.svg", &chart.with_legend(legend));
}

#[test]
fn the_stage_is_drawn_from_its_records() {
    let wanted = points(&rows("scan.csv", ','), [0, 1], None);
    let drives = [
        ("driven-by-line.csv", Colour::Measured, "straight line"),
        ("driven-by-inverse.csv", Colour::Series(1), "inverse"),
        ("driven-again.csv", Colour::Series(0), "inverse, second fit"),
    ];
    let curves = drives.map(|(name, colour, _)| {
        let reached = points(&rows(name, ','), [0, 2], None);
        let deviation = reached.iter().zip(&wanted).map(|((t, y), (_, wanted))| (*t, y - wanted));
        Curve::new(deviation.collect(), colour, 1.2)
    });
    let description = "Deviation of the stage from the wanted position over time: up to 1.7 um with a straight line, \
                       0.12 um with the inverse, 0.08 um after a second fit";
    let chart = Chart::new(description, "time, s", "deviation, um", curves.into()).sized(SIZE.0, SIZE.1);
    check("tutorial-stage.svg", &chart.with_legend(drives.map(|(_, colour, name)| (colour, name))));
}

#[test]
fn the_sheet_is_drawn_from_its_records() {
    let (sines, waveforms) = (rows("sheet.csv", ','), rows("waveforms.csv", ','));
    let curves = vec![
        Curve::new(points(&sines, [2, 3], Some("5 Hz 100 %")), Colour::Measured, 1.2),
        Curve::new(points(&sines, [2, 3], Some("200 Hz 100 %")), Colour::Series(0), 1.2),
        Curve::new(points(&waveforms, [2, 3], Some("fifth harmonic")), Colour::Series(1), 1.2),
    ];
    let description = "Flux density over field: a narrow loop at 5 Hz, a wide one at 200 Hz, and the loop with a fifth \
                       harmonic at 50 Hz between them";
    let chart = Chart::new(description, "field, A/m", "flux density, T", curves).sized(SIZE.0, SIZE.1);
    let legend = [
        (Colour::Measured, "5 Hz"),
        (Colour::Series(0), "200 Hz"),
        (Colour::Series(1), "50 Hz with a fifth harmonic"),
    ];
    check("tutorial-sheet.svg", &chart.with_legend(legend));
}
