//! `hysid plot` as a user runs it: kinds, formats, sizes, and what it refuses.

use std::fs;

use hysid_core::elementary::{cos, sin};

use crate::workbench::Workbench;

/// Set where PDF and PNG must be tested; a machine without fonts otherwise skips them.
const PROVE_ALL: &str = "HYSID_PROVE_ALL";

/// Draws as PDF or PNG; `false`, said aloud, on a machine that has no fonts for it.
fn is_drawn(bench: &Workbench, arguments: &str) -> bool {
    let ran = bench.run(arguments);
    if ran.stderr.contains("this machine has none") && std::env::var_os(PROVE_ALL).is_none() {
        eprintln!("skipped: there are no fonts, which `hysid {arguments}` needs");
        return false;
    }
    assert_eq!(ran.status, Some(0), "hysid {arguments}: {}", ran.stderr);
    true
}

/// Cycles of an elastic-perfectly plastic member (2 kN/mm, 2 kN) with the amplitudes 2, 2, 4 and 4 mm, in steps of 0.05 mm
/// and 0.1 s.
fn member() -> String {
    let turning: [f64; 10] = [0.0, 2.0, -2.0, 2.0, -2.0, 4.0, -4.0, 4.0, -4.0, 0.0];
    let (mut text, mut row) = (String::from("t_s,disp_mm,force_kN\n0,0,0\n"), 0);
    let (mut last, mut force) = (0.0, 0.0f64);
    for pair in turning.windows(2) {
        let count = ((pair[1] - pair[0]).abs() / 0.05).round() as usize;
        for k in 1..=count {
            let x = pair[0] + (pair[1] - pair[0]) * k as f64 / count as f64;
            force = (force + 2.0 * (x - last)).clamp(-2.0, 2.0);
            (last, row) = (x, row + 1);
            text += &format!("{:.1},{x:.6},{force:.9}\n", 0.1 * f64::from(row));
        }
    }
    text
}

/// A workbench with data of the member, `member.csv`, and a model of its law, `model.json`.
fn with_member() -> Workbench {
    let bench = Workbench::new();
    bench.put("member.csv", member());
    bench.succeeds("fit member.csv -o model.json --no-report --model prandtl-ishlinskii --operators 4");
    bench
}

fn has_text(drawing: &str, text: &str) -> bool {
    let texts = drawing.split("<text ").skip(1).filter_map(|rest| rest.split_once('>')?.1.split('<').next());
    texts.map(str::trim).any(|found| found == text)
}

fn dots(drawing: &str, colour: &str) -> Vec<(f64, f64)> {
    let number = |circle: &str, name: &str| -> f64 {
        let rest = circle.split(&format!("{name}=\"")).nth(1).unwrap();
        rest.split('"').next().unwrap().parse().unwrap()
    };
    let circles = drawing.split("<circle ").skip(1).map(|rest| rest.split("/>").next().unwrap());
    let own = circles.filter(|circle| circle.contains(&format!("fill=\"{colour}\"")));
    own.map(|circle| (number(circle, "cx"), number(circle, "cy"))).collect()
}

#[test]
fn the_energy_of_an_elastic_plastic_member_is_that_of_its_law() {
    let bench = with_member();
    let ran = bench.succeeds("plot model.json member.csv --kind energy");
    assert!(ran.stderr.ends_with("figure  member.energy.svg\n"), "{}", ran.stderr);
    let drawing = bench.text("member.energy.svg");
    // Measured and model are drawn, in the colours of a light page.
    let (measured, model) = (dots(&drawing, "#b4bec9"), dots(&drawing, "#0a5fd1"));
    // 4 F (d - F / k) in a cycle, half a stored energy less in the first; each cycle takes 4 d / 0.05 rows of 0.1 s.
    let exact = [(0.0, 0.0), (16.0, 7.0), (32.0, 15.0), (64.0, 39.0), (96.0, 63.0)];
    assert_eq!((measured.len(), model.len()), (exact.len(), exact.len()));
    let share = |dots: &[(f64, f64)], place: usize| {
        let (first, last) = (dots[0], dots[dots.len() - 1]);
        let dot = dots[place];
        ((dot.0 - first.0) / (last.0 - first.0), (dot.1 - first.1) / (last.1 - first.1))
    };
    for (place, (time, energy)) in exact.into_iter().enumerate() {
        let (across, up) = share(&measured, place);
        assert!((across - time / 96.0).abs() < 2e-3, "cycle {place}: time {across}");
        assert!((up - energy / 63.0).abs() < 2e-3, "cycle {place}: energy {up}");
        let (across, up) = share(&model, place);
        assert!((across - time / 96.0).abs() < 2e-3 && (up - energy / 63.0).abs() < 2e-2, "model: {up}");
    }
    assert!(has_text(&drawing, "cumulative energy (J)") && has_text(&drawing, "t (s)"));
}

#[test]
fn every_kind_has_its_figure() {
    let bench = with_member();
    let label = ["force (kN)", "disp (mm)", "error (kN)", "amplitude (mm)", "t (s)"];
    let kinds: [(&str, &[usize], usize); 5] = [
        ("loops", &[0, 1], 1),
        ("histories", &[0, 1, 4], 2),
        ("errors", &[1, 2, 4], 2),
        ("cycles", &[3], 4),
        ("backbone", &[0, 1], 1),
    ];
    for (kind, labels, charts) in kinds {
        bench.succeeds(&format!("plot model.json member.csv --kind {kind} -o {kind}.svg"));
        let drawing = bench.text(&format!("{kind}.svg"));
        assert!(drawing.contains(" width=\"88.000mm\" "), "{kind}");
        for place in labels {
            assert!(has_text(&drawing, label[*place]), "{kind}: {}", label[*place]);
        }
        assert_eq!(drawing.matches("class=\"curves\"").count(), charts, "{kind}");
        assert!(!drawing.contains("NaN") && !drawing.contains("var(--"), "{kind}");
    }
}

/// Ellipses in records of their own, and one more input.
fn ellipses(records: usize) -> String {
    let mut text = String::from("record,t_s,disp_mm,v_mm_s,force_kN\n");
    for record in 1..=records {
        for row in 0..80 {
            let phase = std::f64::consts::TAU * f64::from(row) / 40.0;
            let size = record as f64;
            text += &format!(
                "r{record},{row},{},{},{}\n",
                size * sin(phase),
                cos(phase),
                size * sin(phase + 0.3)
            );
        }
    }
    text
}

#[test]
fn records_have_colours_and_a_legend_and_histories_fit_on_a_page() {
    let bench = Workbench::new();
    bench.put("few.csv", ellipses(3));
    bench.put("many.csv", ellipses(20));
    bench.succeeds("plot few.csv --output force_kN -o few.svg");
    let drawing = bench.text("few.svg");
    let strokes = |drawing: &str| {
        let lines = drawing.split("<polyline ").skip(1).filter_map(|line| line.split("stroke=\"").nth(1));
        lines.filter_map(|line| line.split('"').next().map(String::from)).collect::<Vec<_>>()
    };
    let own: std::collections::BTreeSet<String> = strokes(&drawing).into_iter().collect();
    assert!(own.len() >= 3, "{own:?}");
    assert!(["r1", "r2", "r3"].iter().all(|name| has_text(&drawing, name)));
    bench.succeeds("plot many.csv --output force_kN -o many.svg");
    let drawing = bench.text("many.svg");
    assert!(has_text(&drawing, "r1 (first of 20)") && has_text(&drawing, "r20 (last)"));
    for (inputs, most) in [("disp_mm", 4), ("disp_mm --input v_mm_s", 2)] {
        let ran = bench.succeeds(&format!(
            "plot many.csv --width 170 --kind histories --input {inputs} --output force_kN -o time.svg --force"
        ));
        assert!(ran.stderr.contains("records are drawn over time"), "{}", ran.stderr);
        let drawing = bench.text("time.svg");
        let height: f64 =
            drawing.split(" height=\"").nth(1).unwrap().split("mm").next().unwrap().parse().unwrap();
        assert!(height < 260.0, "{inputs}: {height} mm");
        let charts = drawing.matches("class=\"curves\"").count();
        assert!(charts <= 3 * most, "{inputs}: {charts} charts");
    }
}

#[test]
fn losses_over_frequency_are_those_of_the_cycles() {
    let bench = Workbench::new();
    // An ellipse y = x' / 40 of amplitude 2 has the energy pi w 4 / 40 = 2 pi^2 f 4 / 40.
    let mut text = String::from("t_s,disp_mm,force_kN\n");
    let (mut time, mut phase) = (0.0, 0.0f64);
    for frequency in [0.5, 1.0, 2.0] {
        for _ in 0..400 {
            let (x, rate) = (2.0 * sin(phase), 2.0 * std::f64::consts::TAU * frequency * cos(phase));
            text += &format!("{time:.6},{x:.9},{:.9}\n", rate / 40.0);
            phase += std::f64::consts::TAU / 100.0;
            time += 0.01 / frequency;
        }
    }
    bench.put("damper.csv", text);
    bench.succeeds("plot damper.csv --kind frequency --field structure -o losses.svg");
    let drawing = bench.text("losses.svg");
    let losses = dots(&drawing, "#0a5fd1");
    assert_eq!(losses.len(), 3, "{losses:?}");
    // Twice the frequency twice the loss, above an axis that begins at 0.
    let steps = ((losses[1].1 - losses[0].1), (losses[2].1 - losses[1].1));
    assert!((steps.1 / steps.0 - 2.0).abs() < 0.1, "{losses:?}");
    assert!((losses[2].0 - losses[1].0 - (losses[1].0 - losses[0].0)).abs() < 6.0, "{losses:?}");
    assert!(has_text(&drawing, "frequency (Hz)") && has_text(&drawing, "loss per cycle (J)"));
}

#[test]
fn a_pdf_has_its_size_its_font_and_its_maker() {
    let bench = with_member();
    if !is_drawn(&bench, "plot model.json member.csv --width 100 --height 60 -o figure.pdf") {
        return;
    }
    let bytes = fs::read(bench.path("figure.pdf")).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.starts_with("%PDF-") && text.trim_end().ends_with("%%EOF"));
    let media_box = text.split("/MediaBox [0 0 ").nth(1).unwrap().split(']').next().unwrap();
    let sides: Vec<f64> = media_box.split(' ').map(|side| side.parse().unwrap()).collect();
    for (side, millimetres) in sides.iter().zip([100.0, 60.0]) {
        assert!((side - millimetres * 72.0 / 25.4).abs() < 0.1, "{media_box}");
    }
    assert!(text.contains("/FontFile") || text.contains("/FontDescriptor"));
    assert!(text.contains("/Creator (Hysid ") && text.contains("/Title (Loops of force "));
    // Its own file is replaced, another one is not.
    bench.succeeds("plot model.json member.csv -o figure.pdf");
    bench.put("theirs.pdf", b"%PDF-1.7\n1 0 obj <</Creator (LaTeX)>> endobj\n");
    let arguments = "plot model.json member.csv -o theirs.pdf";
    let ran = bench.run(arguments);
    assert_eq!(ran.status, Some(2));
    assert!(
        ran.last_line().contains("theirs.pdf: a file is there already and is no drawing of Hysid"),
        "{ran}"
    );
}

#[test]
fn a_png_has_its_dots_its_density_and_the_colours_of_the_figure() {
    let bench = with_member();
    if !is_drawn(&bench, "plot model.json member.csv --width 50.8 --height 38.1 --dpi 200 -o figure.png") {
        return;
    }
    let decoder = png::Decoder::new(fs::File::open(bench.path("figure.png")).unwrap());
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.width, info.height), (400, 300));
    let density = reader.info().pixel_dims.unwrap();
    assert_eq!((density.xppu, density.unit), (7874, png::Unit::Meter));
    let has = |colour: [u8; 3]| pixels.chunks_exact(3).any(|dot| dot == colour);
    // White, measured, model, and the black of the text.
    for colour in [[255, 255, 255], [0xb4, 0xbe, 0xc9], [0x0a, 0x5f, 0xd1], [0, 0, 0]] {
        assert!(has(colour), "{colour:?}");
    }
    bench.succeeds("plot member.csv -o figure.png --dpi 50");
}

#[test]
fn records_are_chosen_and_data_or_a_model_drawn_alone() {
    let bench = with_member();
    let mut text = String::from("record,t_s,disp_mm,force_kN\n");
    for record in ["first", "second"] {
        text.extend(member().lines().skip(1).map(|line| format!("{record},{line}\n")));
    }
    bench.put("two.csv", text);
    let ran = bench.succeeds("plot model.json two.csv --kind histories -o both.svg");
    // Both are copies of the training data, which is said of each by its name.
    for record in ["first", "second"] {
        assert!(ran.stderr.contains(&format!("record \"{record}\" is equal to what the model")), "{ran}");
    }
    let both = bench.text("both.svg");
    assert!(has_text(&both, "first") && has_text(&both, "second"));
    bench.succeeds("plot model.json two.csv --kind histories --only second -o one.svg");
    let one = bench.text("one.svg");
    assert!(!has_text(&one, "first") && one.matches("class=\"curves\"").count() == 2);
    // Without a measured output, the model alone.
    bench.put("drive.csv", "t_s,disp_mm\n0,0\n1,1\n2,2\n3,1\n4,0\n5,-1\n");
    bench.succeeds("plot model.json drive.csv -o drive.svg");
    let drive = bench.text("drive.svg");
    assert!(drive.contains("#0a5fd1") && !drive.contains("#b4bec9") && !has_text(&drive, "measured"));
    // Another unit is converted to that of the model.
    bench.put("metres.csv", "disp_m,force_N\n0,0\n0.001,2000\n0.002,2000\n0.001,0\n0,-2000\n");
    bench.succeeds("plot model.json metres.csv -o metres.svg");
    assert!(has_text(&bench.text("metres.svg"), "disp (mm)"));
}

#[test]
fn what_cannot_be_drawn_is_said_in_one_line_and_nothing_is_written() {
    let bench = with_member();
    bench.put("line.csv", "x,y\n0,0\n1,1\n2,2\n3,3\n4,4\n5,5\n6,6\n7,7\n8,8\n9,9\n10,10\n");
    let before = bench.files(".");
    bench.refuses(
        r#"
        2 plot member.csv -o figure.jpg => figure.jpg: the ending tells the format of the figure: .svg, .pdf or .png
        2 plot member.csv -o figure => figure: the ending tells the format of the figure: .svg, .pdf or .png
        2 plot model.json => model.json is a model: name data to draw it on, or let `hysid cycles` drive and draw it alone
        2 plot member.csv --kind errors => errors need a model: hysid plot MODEL.json DATA.csv --kind errors
        2 plot member.csv --band 0.9 => --band needs a model: hysid plot MODEL.json DATA.csv
        2 plot model.json member.csv --kind errors --height 30 => --height 30 has no room for 2 charts: choose more, or draw fewer with --only
        1 plot member.csv --only third => member.csv: there is no record "third" for --only (records: member)
        1 plot member.csv --kind frequency => member.csv: no amplitude was run at several frequencies (or there is no time), so there is nothing to draw over frequency
    "#,
    );
    assert_eq!(bench.files("."), before);
    let refused = [
        "plot model.json member.csv --band 0.9",
        "plot line.csv --kind cycles",
        "plot member.csv --width 5",
        "plot member.csv --kind circles",
        "plot missing.csv",
        "plot model.json line.csv",
        "plot member.csv -o member.csv",
    ];
    for arguments in refused {
        let ran = bench.run(arguments);
        assert!(matches!(ran.status, Some(1 | 2)), "{arguments}: {}", ran.stderr);
        assert!(ran.last_line().starts_with("error: ") && !ran.stderr.contains("panicked"), "{}", ran.stderr);
        assert_eq!(bench.files("."), before, "{arguments}");
    }
}
