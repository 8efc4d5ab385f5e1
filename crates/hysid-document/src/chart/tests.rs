use hysid_core::elementary::sin;

use super::frame::legend_lines;
use super::*;
use crate::balance::assert_balanced;

#[test]
fn records_have_colours_of_their_own_and_a_legend() {
    for count in 2..=8 {
        let names: Vec<String> = (0..count).map(|k| format!("r{k}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let (colours, legend) = records_in_colour(&names);
        assert_eq!((colours[0], colours[count - 1]), (Colour::Ramp(0), Colour::Ramp(RAMP - 1)));
        assert!(colours.windows(2).all(|pair| pair[0] != pair[1]), "{colours:?}");
        assert_eq!(legend.iter().map(|(_, name)| name.as_str()).collect::<Vec<_>>(), names);
    }
    let (colours, legend) = records_in_colour(&["r"; 30]);
    assert_eq!((colours.len(), legend.len()), (30, 2));
    assert_eq!(legend[0], (Colour::Ramp(0), "r (first of 30)".to_string()));
    assert_eq!(records_in_colour(&["r"]), (Vec::new(), Vec::new()));
    // Of files in the order of their names, the number orders the colours.
    let (colours, legend) = records_in_colour(&["b2_100Hz", "b2_10Hz", "b2_20.5Hz"]);
    assert_eq!(colours, [Colour::Ramp(11), Colour::Ramp(0), Colour::Ramp(6)]);
    assert_eq!(
        legend.iter().map(|(_, name)| name.as_str()).collect::<Vec<_>>(),
        ["b2_10Hz", "b2_20.5Hz", "b2_100Hz"]
    );
    for names in [["a1_1Hz", "a2_2Hz"], ["1", "b"], ["é1", "e2"]] {
        assert_eq!(records_in_colour(&names).0, [Colour::Ramp(0), Colour::Ramp(11)]);
    }
}

fn chart(points: Vec<Point>) -> Chart {
    Chart {
        labels: Vec::new(),
        description: "a \"test\" & more".into(),
        title: "<script>alert(1)</script>".into(),
        size: (520.0, 360.0),
        x: Axis::linear("x <mm>", points.iter().map(|p| p.0)),
        y: Axis::linear("y", points.iter().map(|p| p.1)),
        curves: vec![Curve::new(points, Colour::Simulated, 1.5)],
        legend: vec![(Colour::Simulated, "model".into())],
        shares_axis: false,
        has_equal_axes: false,
        bar: None,
    }
}

#[test]
fn user_text_is_escaped_and_elements_balanced() {
    let chart = chart((0..50).map(|k| (k as f64, sin(k as f64))).collect());
    let svg = chart.svg();
    assert!(!svg.contains("<script") && svg.contains("&lt;script"), "{svg}");
    assert!(svg.contains("aria-label=\"a &quot;test&quot; &amp; more\""));
    assert_balanced(&svg);
    let file = chart.file("Hysid 1");
    assert!(
        file.contains("<style>") && file.contains("width=\"520\" height=\"360\"") && file.starts_with("<svg")
    );
    assert_balanced(&file);
}

#[test]
fn charts_of_a_sheet_are_in_rows_and_columns() {
    let one = chart(vec![(0.0, 0.0), (1.0, 1.0)]);
    let sheet = sheet(
        &[one.clone(), one.clone(), one.sized(500.0, 300.0)],
        2,
        &Appearance::of_page(),
        "a & b",
        "Hysid 1",
    );
    assert!(sheet.starts_with("<svg") && sheet.contains("aria-label=\"a &amp; b\""));
    assert!(sheet.contains("width=\"1040\" height=\"680\"") && sheet.matches("<style>").count() == 1);
    for place in [
        "x=\"0\" y=\"0\" width=\"520\" height=\"360\"",
        "x=\"520\" y=\"0\"",
        "x=\"0\" y=\"380\" width=\"500\"",
    ] {
        assert!(sheet.contains(place), "{place}");
    }
    assert_balanced(&sheet);
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
fn a_long_legend_goes_on_below_and_unused_colours_are_left_out() {
    let curve = |place| Curve::new(vec![(0.0, 0.0), (1.0, 1.0)], Colour::Series(place), 1.0);
    let chart = Chart {
        curves: (0..4).map(curve).collect(),
        legend: (0..6).map(|place| (Colour::Series(place), format!("a long name, number {place}"))).collect(),
        title: String::new(),
        ..chart(vec![])
    };
    // An entry takes about 190 of 520 pixels.
    let lines: Vec<usize> = legend_lines(&chart, &Appearance::of_page()).iter().map(Vec::len).collect();
    assert_eq!(lines, [2, 2]);
    assert_balanced(&chart.svg());
}

/// Texts of a drawing.
fn texts(drawing: &str) -> Vec<&str> {
    let text = |part: &'_ str| -> usize { part.find("</text>").unwrap() };
    drawing.split("<text").skip(1).map(|part| part[part.find('>').unwrap() + 1..text(part)].trim()).collect()
}

#[test]
fn a_long_label_has_several_lines_and_its_unit_stays() {
    let curve = || chart(vec![(0.0, 0.0), (1.0, 1.0)]).curves;
    let of = |label: &str, height: f64| {
        let y = Axis::linear(label, [0.0, 1.0].into_iter());
        Chart::on_axes("", Axis::linear("x", [0.0, 1.0].into_iter()), y, curve()).with_height(height).svg()
    };
    let wide = of("Lateral Displacement Top (mm)", 160.0);
    assert!(texts(&wide).windows(3).any(|lines| lines == ["Lateral", "Displacement", "Top (mm)"]), "{wide}");
    let one = of("Verschiebungsaufnehmer (mm)", 160.0);
    assert!(texts(&one).windows(2).any(|lines| lines == ["Verschiebungsa…", "(mm)"]), "{:?}", texts(&one));
}

#[test]
fn a_title_has_a_line_of_its_own_where_the_legend_leaves_no_room() {
    let long =
        Chart { title: "a record with a long name of its own".into(), ..chart(vec![(0.0, 0.0), (1.0, 1.0)]) };
    let lines = |width: f64| -> Vec<usize> {
        let chart = long.clone().sized(width, 360.0);
        legend_lines(&chart, &Appearance::of_page()).iter().map(Vec::len).collect()
    };
    assert_eq!((lines(800.0), lines(420.0)), (vec![1], vec![0, 1]));
    assert!(texts(&long.sized(420.0, 360.0).svg()).contains(&"a record with a long name of its own"));
}

#[test]
fn charts_above_each_other_share_one_axis_and_its_label() {
    let mut upper = chart(vec![(0.0, 0.0), (10.0, 1.0)]);
    upper.shares_axis = true;
    let lower = Chart { shares_axis: false, ..upper.clone() };
    let drawing = sheet(&[upper, lower], 1, &Appearance::of_page(), "", "Hysid 1");
    let count = |text: &str| texts(&drawing).iter().filter(|found| **found == text).count();
    assert_eq!((count("x &lt;mm&gt;"), count("10"), count("1.0")), (1, 1, 2), "{:?}", texts(&drawing));
}

#[test]
fn a_sheet_for_print_has_its_size_in_millimetres_fixed_colours_and_axes_below_each_other() {
    let few = chart(vec![(0.0, 0.0), (1.0, 1.0)]);
    let many = chart(vec![(0.0, 0.0), (1.0, 123_456.0)]);
    let appearance = Appearance::of_print("DejaVu Sans, sans-serif", 8.0);
    let drawing = sheet(&[few.clone(), many], 1, &appearance, "two charts", "Hysid 1");
    assert_balanced(&drawing);
    // 520 of 96 pixels an inch, and two charts of 360 with a gap of 16.
    assert!(drawing.contains("width=\"137.583mm\" height=\"194.733mm\""), "{}", &drawing[..400]);
    assert!(!drawing.contains("var(--") && !drawing.contains("<style"));
    assert!(drawing.contains("font-family=\"DejaVu Sans, sans-serif\""));
    // The curves are in the colour of a light page and not in that of a marker.
    assert!(drawing.contains("stroke=\"#0a5fd1\"") && !drawing.contains("#0060D0"));
    // The place of the curves begins at the same abscissa.
    let places: Vec<&str> =
        drawing.split("class=\"curves\" x=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    assert!(places.len() == 2 && places[0] == places[1], "{places:?}");
    let alone = sheet(&[few], 1, &appearance, "one chart", "Hysid 1");
    assert!(!alone.contains(&format!("class=\"curves\" x=\"{}\"", places[0])));
}
