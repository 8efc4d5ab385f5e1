use super::*;

fn chart(points: Vec<Point>) -> Chart {
    Chart {
        labels: Vec::new(),
        description: "a \"test\" & more".into(),
        title: "<script>alert(1)</script>".into(),
        size: (520.0, 360.0),
        x: Axis::linear("x <mm>", points.iter().map(|p| p.0)),
        y: Axis::linear("y", points.iter().map(|p| p.1)),
        curves: vec![Curve { points, colour: Colour::Simulated, width: 1.5 }],
        legend: vec![(Colour::Simulated, "model".into())],
    }
}

/// Every element that opens closes, in the right order, and no text holds a bare `<`.
pub fn assert_balanced(markup: &str) {
    let void = ["meta", "br", "hr", "!DOCTYPE"];
    let mut open: Vec<&str> = Vec::new();
    for piece in markup.split('<').skip(1) {
        let tag = piece.split('>').next().expect("split gives a first piece");
        let name = tag.trim_end_matches('/').split_whitespace().next().unwrap_or("");
        if let Some(name) = name.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "in <{tag}>");
        } else if !tag.ends_with('/') && !void.contains(&name) {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "left open: {open:?}");
}

#[test]
fn user_text_is_escaped_and_elements_balanced() {
    let svg = chart((0..50).map(|k| (k as f64, (k as f64).sin())).collect()).svg();
    assert!(!svg.contains("<script") && svg.contains("&lt;script"), "{svg}");
    assert!(svg.contains("aria-label=\"a &quot;test&quot; &amp; more\""));
    assert_balanced(&svg);
    let file = standalone(&svg);
    assert!(
        file.contains("<style>") && file.contains("width=\"520\" height=\"360\"") && file.starts_with("<svg")
    );
    assert_balanced(&file);
}

#[test]
fn blanks_leave_gaps_and_lone_points_are_dots() {
    let gap = (1.5, f64::NAN);
    let svg = chart(vec![(0.0, 0.0), (1.0, 1.0), gap, (2.0, 0.0), (3.0, 1.0), gap, (4.0, 0.0)]).svg();
    let curve = "stroke=\"#0060D0\"";
    // Two pieces and the legend's line.
    assert_eq!(svg.split("<polyline").filter(|piece| piece.contains(curve)).count(), 3);
    assert_eq!(svg.matches("<circle").count(), 1);
}

#[test]
fn a_band_is_an_area_with_gaps() {
    let around = |x: f64| vec![(x, 0.0), (x + 1.0, 0.0), (x + 1.0, 1.0), (x, 1.0)];
    let points = [around(0.0), vec![(f64::NAN, 0.0)], around(3.0)].concat();
    let mut chart = chart(points);
    (chart.curves[0].colour, chart.legend) = (Colour::Band, vec![(Colour::Band, "90 % band".into())]);
    let svg = chart.svg();
    assert_eq!(svg.split("<polygon").filter(|piece| piece.contains("fill=\"#A0C8F0\"")).count(), 2, "{svg}");
    assert!(svg.contains("90 % band"));
    assert_balanced(&svg);
}

#[test]
fn odd_series_can_be_drawn() {
    let cases = [vec![], vec![(1.0, 2.0)], vec![(0.0, 5.0); 9], vec![(f64::NAN, 1.0)], vec![(1e150, -1e150)]];
    for points in cases {
        assert_balanced(&chart(points).svg());
    }
}

#[test]
fn every_marker_is_recoloured() {
    let colours =
        [Colour::Measured, Colour::Simulated, Colour::Input, Colour::Error, Colour::Faint, Colour::Band];
    let markers = colours.map(Colour::marker).into_iter().chain([INK, GRID]);
    for RGBColor(r, g, b) in markers {
        assert!(STYLE.contains(&format!("[stroke=\"#{r:02X}{g:02X}{b:02X}\"]")));
    }
}

#[test]
fn a_long_legend_goes_on_below_and_unused_colours_are_left_out() {
    let curve =
        |place| Curve { points: vec![(0.0, 0.0), (1.0, 1.0)], colour: Colour::Series(place), width: 1.0 };
    let chart = Chart {
        curves: (0..4).map(curve).collect(),
        legend: (0..6).map(|place| (Colour::Series(place), format!("a long name, number {place}"))).collect(),
        title: String::new(),
        ..chart(vec![])
    };
    // An entry takes about 190 of 520 pixels.
    let lines: Vec<usize> = chart.legend_lines().iter().map(Vec::len).collect();
    assert_eq!(lines, [2, 2]);
    assert_balanced(&chart.svg());
}

#[test]
fn every_chart_is_a_drawing_and_what_was_changed_in_it_is_none() {
    let wave: Vec<Point> = (1..50).map(|k| (k as f64, (k as f64).sin())).collect();
    let gap = (f64::NAN, f64::NAN);
    let curve = |points: &[Point], colour| Curve { points: points.to_vec(), colour, width: 1.5 };
    let full = Chart {
        curves: vec![
            curve(&wave, Colour::Band),
            curve(&wave, Colour::Series(3)),
            curve(&[(1.0, 2.0), gap, (3.0, 0.5), gap], Colour::Error),
        ],
        labels: vec![Label { point: (2.0, 0.5), rise: 3.0, text: "<b>\"a\" & b'\u{1b}</b>".into() }],
        x: Axis::logarithmic("x > 0", wave.iter().map(|point| point.0)),
        legend: vec![(Colour::Band, "90 % band".into()), (Colour::Series(3), "<i>".into())],
        ..chart(wave.clone())
    };
    for svg in [full.svg(), chart(wave).svg(), chart(vec![(0.0, 0.0)]).svg(), chart(Vec::new()).svg()] {
        assert!(is_drawing(&svg), "{svg}");
        for (from, to) in [
            ("</svg>", "<script/></svg>"),
            ("<svg ", "<svg onload=\"a()\" "),
            ("<svg ", "<svg onload=a() "),
            ("<svg ", "<svg\tonload=\"a()\" "),
            ("<svg ", "text<svg "),
            ("</svg>", "</svg>text"),
            ("</svg>", "<!-- --></svg>"),
            ("</svg>", "<a href=\"javascript:a()\"></a></svg>"),
            ("fill=\"#111111\"", "fill=\"url(#a)\""),
            ("xmlns=\"http://www.w3.org/2000/svg\"", "xmlns=\"http://www.w3.org/1999/xhtml\""),
        ] {
            let changed = svg.replacen(from, to, 1);
            assert!(changed == svg || !is_drawing(&changed), "{from} {to}");
        }
    }
    assert!(!is_drawing("") && !is_drawing("<svg") && !is_drawing("<svg>") && is_drawing("<svg></svg>"));
}
