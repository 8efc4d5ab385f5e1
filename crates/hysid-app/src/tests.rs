use std::ops::ControlFlow;

use hysid::data::rate::RateMethod;
use hysid::data::record::{ColumnNames, Record};
use hysid::diagnosis::resonance::ComparedSignal;
use hysid::fit::network::fit;
use hysid::model::{Ensemble, Group, Node, NodeKind, Predictor, Provenance, Weights};
use hysid::options::FitSpec;
use hysid::options::classical::{ClassicalModel, ClassicalOptions};
use hysid::options::network::FitOptions;
use hysid_core::elementary::sin;
use hysid_core::network::Sizes;
use hysid_core::operator::{Operator, Stop};
use hysid_document::{Cell, Part};

use super::*;

#[path = "../../hysid-document/src/balance.rs"]
mod balance;

/// Measured loops of two records with odd names, with blanks.
fn data(time: bool) -> Dataset {
    let record = |name: &str, size: f64| {
        let x: Vec<f64> = (0..300).map(|k| size * sin(0.1 * k as f64)).collect();
        let mut play = 0.0f64;
        let mut y: Vec<f64> = Vec::new();
        for x in &x {
            play = play.clamp(x - 0.4, x + 0.4);
            y.push(0.3 * x + play);
        }
        y[..20].fill(f64::NAN);
        let record = Record::new(name, vec![x], y).unwrap();
        let seconds: Vec<f64> = (0..300).map(f64::from).collect();
        if time { record.with_time(seconds).unwrap() } else { record }
    };
    let names = ColumnNames::of(time.then_some("t_s"), &["<script>x</script>_mm"], "force_kN");
    Dataset::new(names, vec![record("a <b> & \"c\"", 1.0), record("second", 2.0)]).unwrap()
}

fn model(data: &Dataset) -> Model {
    let options = FitOptions {
        sizes: Sizes { stops: 3, hidden: 2, relaxation: 1 },
        rate: data.has_time().then_some(RateMethod::Central),
        starts: 2,
        epochs: 4,
        ..FitOptions::default()
    };
    fit(data, &options, &mut |_| ControlFlow::Continue(())).unwrap().model
}

fn set<'a>(name: &str, model: &Model, data: &'a Dataset) -> ReportSet<'a> {
    let simulated = data.records().iter().map(|record| model.simulate(record).unwrap()).collect();
    let (errors, tracks) = (model.evaluate(data).unwrap(), Tracks::of(name, data));
    ReportSet { name: name.into(), data, simulated, predicted: None, errors, tracks }
}

fn report<'a>(model: &'a Model, data: &'a Dataset, warnings: &'a [String]) -> Report<'a> {
    Report {
        title: "Fit of <x>".into(),
        model,
        sets: vec![set("training", model, data), set("unseen", model, data)],
        residuals: &[],
        intervals: &[],
        frequency_response: None,
        warnings,
        understood: &[],
        model_file: Some("my $(model).json".into()),
        seconds: Some(1.25),
    }
}

#[test]
fn the_page_is_whole_and_needs_nothing_else() {
    for time in [false, true] {
        let data = data(time);
        let model = model(&data);
        let warnings = ["beware of <this>".to_string()];
        let page = page_text(&page(&report(&model, &data, &warnings)));
        let (page, script) = page.split_once("<script>").unwrap();
        assert!(!page.contains("<script") && page.contains("&lt;script&gt;"));
        assert!(script.ends_with("</script>\n</body>\n</html>\n") && !script.contains("import"));
        assert!(
            page.contains("beware of &lt;this&gt;")
                && page.contains("hysid evaluate &#39;my $(model).json&#39;")
        );
        for reference in ["src=", "href=\"h", "url(", "@import", "<link"] {
            assert!(!page.contains(reference), "{reference}");
        }
        let body = page.split("</style>").last().unwrap();
        let body = body.strip_prefix("\n</head>\n<body>").unwrap();
        balance::assert_balanced(body);
        assert!(page.len() < 1_000_000);
    }
}

#[test]
fn the_figures_of_the_errors_are_there() {
    let data = data(true);
    let model = model(&data);
    let page = page_text(&page(&report(&model, &data, &[])));
    for errors in [&model.provenance().train, model.provenance().validation.as_ref().unwrap()] {
        let figures = [errors.rmse, errors.nrmse_std_percent.unwrap(), errors.max_abs_error];
        for figure in figures {
            assert!(page.contains(&format!(">{}</td>", hysid_document::number(figure, 4))), "{figure}");
        }
    }
    assert!(page.contains("RMSE (kN)") && page.contains("Validation"));
}

/// The headline has the error on data held out in the unit of the output, and what is doubtful about it.
#[test]
fn the_headline_is_the_error_on_new_data_with_its_doubt() {
    let data = data(true);
    let fitted = model(&data);
    let headline = |model: &Model, sets: Vec<ReportSet>| -> (String, Vec<String>) {
        let report = Report { sets, ..report(model, &data, &[]) };
        let parts = errors::verdict(&report);
        let Part::Lead(lead) = &parts[0] else { panic!("no headline") };
        let doubts = parts.iter().filter_map(|part| match part {
            Part::List(items) => Some(items.iter().map(|item| item.text.plain()).collect::<Vec<_>>()),
            _ => None,
        });
        (lead.plain(), doubts.flatten().collect())
    };
    let in_unit = |errors: &Errors| {
        let percent = hysid_document::number(errors.nrmse_std_percent.unwrap(), 3);
        format!(
            "force is {} kN off (root mean square error), {percent} %",
            hysid_document::number(errors.rmse, 3)
        )
    };
    let training = || vec![set("training", &fitted, &data)];
    let provenance = fitted.provenance();
    let held_out = provenance.validation.clone().unwrap();
    let (lead, _) = headline(&fitted, training());
    assert!(
        lead.starts_with("On held-out data, the simulated ") && lead.contains(&in_unit(&held_out)),
        "{lead}"
    );
    // Data that the model never saw come first.
    let (lead, _) = headline(&fitted, vec![set("training", &fitted, &data), set("unseen", &fitted, &data)]);
    assert!(lead.starts_with("On the unseen data, "), "{lead}");
    let with = |validation: Option<Errors>| {
        fitted.clone().with_provenance(Provenance { validation, ..provenance.clone() })
    };
    let (lead, doubts) = headline(&with(None), training());
    assert!(
        lead.starts_with("On the training data, ") && lead.contains(&in_unit(&provenance.train)),
        "{lead}"
    );
    assert_eq!(
        doubts,
        ["The error on new data was not measured, because there were too few to hold any out."]
    );
    let (_, doubts) =
        headline(&with(Some(Errors { rmse: 3.0 * provenance.train.rmse, ..held_out })), training());
    assert!(
        doubts[0].starts_with("The error on held-out data is 3 times that on the training data"),
        "{doubts:?}"
    );
}

/// Each law among the members has its parameters and intervals, as the law alone has them.
#[test]
fn an_ensemble_shows_the_parameters_of_its_laws() {
    let data = data(false);
    let law = |thresholds: &[f64]| {
        let options = ClassicalOptions {
            thresholds: Some(thresholds.to_vec()),
            ..ClassicalOptions::of(ClassicalModel::PrandtlIshlinskii)
        };
        let spec = FitSpec::Classical(options);
        hysid::fit::identify(&data, &spec, &mut |_| ControlFlow::Continue(())).unwrap().model
    };
    let laws = [law(&[0.4]), law(&[0.2, 0.6])];
    let alone: Vec<_> = laws.iter().map(|law| ParameterIntervals::of(law, &data).unwrap().unwrap()).collect();
    let node = |(member, inside): (usize, f64)| Node {
        weights: Weights { inside, outside: 0.5 },
        kind: NodeKind::Member(member),
    };
    let group = Group { name: "laws".into(), nodes: [(0, 0.3), (1, 0.7)].map(node).to_vec() };
    let ensemble = Ensemble::new(laws.to_vec(), group, data.input_range(0)).unwrap();
    let found = hysid::model::ProvenanceDraft::from(laws[0].provenance().clone());
    let whole = Model::new(
        Predictor::Ensemble(ensemble),
        hysid::model::input_transform::InputTransform::default(),
        None,
        &data,
        found,
    );
    let page = Identified::before(whole.unwrap()).page(None, None, &[("training", &data)]).unwrap();
    assert!(page.title.starts_with("Force over "), "{}", page.title);
    let section = page.parts.iter().find_map(|part| match part {
        Part::Section(heading, parts) if heading == "Parameters" => Some(parts),
        _ => None,
    });
    let parts = section.unwrap();
    let headings: Vec<String> = parts
        .iter()
        .filter_map(|part| match part {
            Part::Heading(text) => Some(text.plain()),
            _ => None,
        })
        .collect();
    assert_eq!(headings, ["prandtl-ishlinskii, weight 70 %", "prandtl-ishlinskii, weight 30 %"]);
    let tables: Vec<_> = parts.iter().flat_map(Part::tables).collect();
    for (table, intervals) in tables.iter().zip(alone.iter().rev()) {
        let constant = &intervals.parameters[0];
        let [low, high] = [constant.low, constant.high].map(|end| hysid_document::number(end.unwrap(), 4));
        assert_eq!(table.rows[0][2].shown(), format!("{low} to {high}"));
        assert_eq!(table.rows.len(), intervals.parameters.len());
    }
}

/// Records of one and a half cycles: the table of cycles has a figure in every cell, and the parts have a table of their own.
#[test]
fn many_short_records_have_tables_of_cycles_without_gaps() {
    let record = |k: usize| {
        let size = 1.0 + 0.1 * k as f64;
        let rows = if k.is_multiple_of(3) { 60 } else { 150 };
        let x: Vec<f64> = (0..rows).map(|row| size * sin(0.0785 * row as f64)).collect();
        let y = Stop::new(0.5).unwrap().run(&x);
        Record::new(format!("r{k}"), vec![x], y).unwrap()
    };
    let names = ColumnNames::of(None, &["x_mm"], "force_kN");
    let data = Dataset::new(names, (0..12).map(record).collect()).unwrap();
    let cycles = cycles::Cycles::of_data(&data, &Default::default(), &[], (None, 1.0), ("f.csv", Vec::new()));
    let page = cycles::page(&cycles.unwrap());
    let section = page.parts.iter().find_map(|part| match part {
        Part::Section(heading, parts) if heading == "Cycles" => Some(parts),
        _ => None,
    });
    let tables: Vec<_> = section.unwrap().iter().flat_map(Part::tables).collect();
    assert_eq!(tables.len(), 2);
    assert_eq!(tables[0].rows.len(), 8);
    for table in tables {
        let is_missing = |cell: &Cell| matches!(cell, Cell::Missing);
        assert!(!table.rows.iter().flatten().any(is_missing), "{:?}", table.columns);
    }
    // Each level has one cycle: a table of levels would be the table of cycles again.
    assert!(
        !page
            .parts
            .iter()
            .any(|part| matches!(part, Part::Section(heading, _) if heading.starts_with("Levels")))
    );
}

/// A long record, a single row, a constant output: nothing panics, nothing grows without bound.
#[test]
fn odd_data_can_be_shown() {
    let model = model(&data(false));
    let odd = |rows: usize| {
        let x: Vec<f64> = (0..rows).map(|k| sin(0.01 * k as f64)).collect();
        Record::new(format!("{rows} rows"), vec![x], vec![1.0; rows]).unwrap()
    };
    let names = ColumnNames { time: None, ..ColumnNames::plain(1) };
    let data = Dataset::new(names, vec![odd(1), odd(200_000)]).unwrap();
    let page = page_text(&page(&report(&model, &data, &[])));
    assert!(page.len() < 2_000_000, "{}", page.len());
    let many = Dataset::new(data.names().clone(), (0..900).map(|_| odd(40)).collect()).unwrap();
    assert!(page_text(&super::page(&report(&model, &many, &[]))).len() < 2_000_000);
}

/// An input that moves at all frequencies, with the output of a mass on a spring: 0.16 cycles per second, 5 % of damping.
fn vibration(names: ColumnNames) -> Dataset {
    let (mut y, mut v, mut x, mut state) = (0.0, 0.0, 0.0, 1u64);
    let (mut time, mut input, mut output) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..6000 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        x += 0.5 * ((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0 - x);
        for _ in 0..20 {
            v += 0.01 * (x - y - 0.1 * v);
            y += 0.01 * v;
        }
        time.push(0.2 * f64::from(row));
        input.push(x);
        output.push(y);
    }
    let record = Record::new("r", vec![input], output).unwrap().with_time(time).unwrap();
    Dataset::new(names, vec![record]).unwrap()
}

#[test]
fn frequency_responses_are_drawn_and_their_resonances_told() {
    for (time, hertz) in [("t_s", "Hz"), ("t_ms", "cycles per ms"), ("t", "cycles per unit of time")] {
        let names = ColumnNames::of(Some(time), &["F_kN"], "y_mm");
        let data = vibration(names);
        // A network has no inertia: what is told of it is that it does not follow.
        let model = model(&data);
        let simulated: Vec<Vec<f64>> =
            data.records().iter().map(|record| model.simulate(record).unwrap()).collect();
        let responses = ModelResponses::of(&model, &data, &simulated).unwrap();
        let peak = responses.as_ref().unwrap().measured.peak(ComparedSignal::Output).unwrap();
        // sqrt(1)/(2 pi), and a height of 1/(2 * 0.05) less what the resolution takes.
        assert!(
            (peak.frequency - 0.159).abs() < 0.004 && (8.0..11.0).contains(&peak.magnitude()),
            "{peak:?}"
        );
        let report = Report { frequency_response: Some(responses), ..report(&model, &data, &[]) };
        let page = page_text(&page(&report));
        let section = page.split("<section id=\"frequency-response\">").nth(1).unwrap();
        let section = section.split("</section>").next().unwrap();
        assert_eq!(section.matches("<svg class=\"plot\"").count(), 2);
        for told in [
            "magnitude (mm per kN)".to_string(),
            format!("resonance ({hertz})"),
            ">0.161</td>".into(),
            format!(">{}</td>", hysid_document::number(peak.magnitude(), 3)),
            "best linear oscillator".into(),
            " kN std (as measured)".into(),
            " kN std (× 0.3)".into(),
            " kN std (× 0.1)".into(),
            "Hann window".into(),
        ] {
            assert!(section.contains(&told), "{told}: {section}");
        }
    }
}

#[test]
fn a_response_that_cannot_be_drawn_is_explained() {
    let data = data(true);
    let model = model(&data);
    let simulated: Vec<Vec<f64>> =
        data.records().iter().map(|record| model.simulate(record).unwrap()).collect();
    let sine = ModelResponses::of(&model, &data, &simulated).unwrap();
    let cases = [
        (sine, "only 2 spectral lines had enough input power"),
        (Err(NoResponse::UnevenTime("a".into())), "record &quot;a&quot; are not evenly spaced"),
    ];
    for (responses, told) in cases {
        let report = Report { frequency_response: Some(responses), ..report(&model, &data, &[]) };
        let page = page_text(&page(&report));
        let section = page.split("<section id=\"frequency-response\">").nth(1).unwrap();
        let section = section.split("</section>").next().unwrap();
        assert!(section.contains(told), "{told}: {section}");
    }
}

/// An elastic, perfectly plastic member, and a model whose force is a tenth too large: energy and stiffness differ by 10 %,
/// damping and residual displacement do not.
#[test]
fn cycles_of_the_model_stand_beside_those_of_the_data() {
    let x: Vec<f64> = (0..=1200).map(|k| 3.0 * sin(std::f64::consts::TAU * f64::from(k) / 400.0)).collect();
    let y = Stop::new(1.0).unwrap().run(&x);
    let simulated = vec![y.iter().map(|y| 1.1 * y).collect::<Vec<f64>>()];
    let record = Record::new("r", vec![x], y).unwrap();
    let data = Dataset::new(ColumnNames::of(None, &["x_mm"], "force_kN"), vec![record]).unwrap();
    let set = ReportSet { simulated, ..set("training", &model(&data), &data) };
    let Some(Part::Section(_, parts)) = cycle_comparison::section(&set) else { panic!("no section") };
    let Some(Part::Table(table)) = parts.last() else { panic!("no table") };
    assert_eq!(table.rows.len(), 3);
    let second: Vec<String> = table.rows[1].iter().map(Cell::ascii).collect();
    let expected =
        ["2", "3", "8", "8.8", "+10.0", "42.4", "42.4", "+0.0", "0.333", "0.367", "+10.0", "2", "2", "+0.0"];
    assert_eq!(second, expected, "{:?}", table.columns);
}
