//! Quick fits of measured records. They lie beside the repository, in `../shared/data`, and are no
//! part of it: where they are absent these tests say so and pass.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use hysid::data::rate::RateMethod;
use hysid::data::record::{ColumnNames, Dataset, Record};
use hysid::diagnosis::{DataIssue, DataIssueKind, Diagnosis, DiagnosisOptions};
use hysid::fit::network::fit;
use hysid::network::{Family, Sizes};
use hysid::options::network::FitOptions;

fn folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: there are no measured records in {}", folder.display());
    None
}

/// Reads `record[,t_s],input,output`; an empty output is blank.
fn read(path: &Path) -> Dataset {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<&str>>());
    let head = lines.next().unwrap();
    let timed = head[1].starts_with("t_");
    let mut parts: Vec<(String, Vec<Vec<f64>>)> = Vec::new();
    for cells in lines {
        if parts.last().is_none_or(|(name, _)| name != cells[0]) {
            parts.push((cells[0].into(), vec![Vec::new(); head.len() - 1]));
        }
        let number = |cell: &str| if cell.is_empty() { f64::NAN } else { cell.parse().unwrap() };
        let (_, columns) = parts.last_mut().unwrap();
        columns.iter_mut().zip(&cells[1..]).for_each(|(column, cell)| column.push(number(cell)));
    }
    let record = |(name, mut columns): (String, Vec<Vec<f64>>)| {
        let output = columns.pop().unwrap();
        let input = columns.pop().unwrap();
        let record = Record::new(name, vec![input], output).unwrap();
        match columns.pop() {
            Some(time) => record.with_time(time).unwrap(),
            None => record,
        }
    };
    let names = ColumnNames {
        time: timed.then(|| head[1].to_string()),
        inputs: vec![head[head.len() - 2].into()],
        rate: None,
        output: head[head.len() - 1].into(),
    };
    Dataset::new(names, parts.into_iter().map(record).collect()).unwrap()
}

fn quick_fit(case: &str, rate: Option<RateMethod>, rows: usize, records: usize) {
    let Some(folder) = folder() else { return };
    let data = read(&folder.join(case).join("train.csv"));
    assert_eq!((data.rows(), data.records().len()), (rows, records), "{case} is another file");
    let sizes = Sizes { stops: 5, hidden: 4, relaxation: 2 };
    let options =
        FitOptions { model: Family::XpnnPlus, sizes, rate, starts: 2, epochs: 10, ..FitOptions::default() };
    let fitted = fit(&data, &options, &mut |_| ControlFlow::Continue(())).unwrap();
    let error = fitted.model.evaluate(&data).unwrap().nrmse_std_percent.unwrap();
    println!("{case}: {error:.2} % of the standard deviation");
    assert!(error.is_finite() && error < 30.0, "{case}: {error} %");
    for record in data.records() {
        assert!(fitted.model.simulate(record).unwrap().iter().all(|y| y.is_finite()));
    }
}

#[test]
fn a_concrete_column() {
    quick_fit("rc-column-stable", None, 2658, 1);
}

#[test]
fn a_ferrite_with_blank_rows() {
    quick_fit("bh-ferrite", None, 774, 3);
}

#[test]
fn a_piezo_actuator_with_its_rate() {
    quick_fit("piezo-sine", Some(RateMethod::Central), 1600, 1);
}

fn doctor(case: &str) -> Option<Vec<DataIssue>> {
    let data = read(&folder()?.join(case).join("train.csv"));
    Some(Diagnosis::of(&data, &DiagnosisOptions::default()).unwrap().doctor)
}

#[test]
fn the_doctor_sees_what_is_in_measured_records() {
    // 367 of 1087 rows of the coupon are the row before, counted with awk; the piezo actuator begins at 149.9 V.
    if let Some(coupon) = doctor("steel-coupon") {
        let repeated = coupon.iter().find(|complaint| complaint.kind == DataIssueKind::RepeatedRows);
        let percent = repeated.expect("rows repeat").value.unwrap();
        assert!((percent - 100.0 * 367.0 / 1087.0).abs() < 0.5, "{percent}");
    }
    if let Some(piezo) = doctor("piezo-sine") {
        let kinds: Vec<DataIssueKind> = piezo.iter().map(|complaint| complaint.kind).collect();
        assert_eq!(kinds, [DataIssueKind::UnknownStart]);
    }
}
