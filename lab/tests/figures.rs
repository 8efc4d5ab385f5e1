//! The figures of the documentation: loops of the operators, and the diagram of the network.
//!
//! Each figure is stored twice: in `docs/images/` for `docs/theory.md`, and beside the module whose page shows it, since
//! a published crate holds only its own files. `HYSID_WRITE=1 cargo test --test figures` draws the
//! loops anew.

mod paths;

use std::path::{Path, PathBuf};

use hysid_core::operator::{DeterioratingStop, Operator, Play, Stop};
use hysid_document::chart::{Axis, Chart, Colour, Curve, Label};
use paths::{corners, path};

const SIZE: (f64, f64) = (460.0, 320.0);

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Where a figure is stored; the module's copy is named by its path in `hysid-core/src`.
fn places(in_core: &str) -> [PathBuf; 2] {
    let core = root().join("crates/hysid-core/src").join(in_core);
    [root().join("docs/images").join(core.file_name().unwrap()), core]
}

/// Input and output of an operator, without the samples in the middle of a straight piece.
fn curve(mut operator: impl Operator, x: &[f64], colour: Colour) -> Curve {
    let points: Vec<(f64, f64)> = x.iter().copied().zip(operator.run(x)).collect();
    Curve::new(corners(&points), colour, 2.0)
}

fn label(x: f64, y: f64, rise: f64, text: &str) -> Label {
    Label { point: (x, y), rise, text: text.into() }
}

/// A chart of outputs between -1 and 1, with room above and below for labels.
fn chart(description: &str, output: &str, curves: Vec<Curve>, labels: Vec<Label>) -> Chart {
    let inputs = curves.iter().flat_map(|curve| &curve.points).map(|point| point.0);
    let (x, y) = (Axis::linear("input x", inputs), Axis::linear(output, [-1.2, 1.2].into_iter()));
    Chart { labels, ..Chart::on_axes(description, x, y, curves).sized(SIZE.0, SIZE.1) }
}

fn stop() -> Chart {
    let cycles = curve(Stop::new(1.0).unwrap(), &path(&[2.0, -2.0, 2.0]), Colour::Simulated);
    let labels = vec![
        label(0.3, 1.0, 12.0, "slides: ε = r"),
        label(1.4, 0.3, 0.0, "sticks"),
        label(-1.6, -1.0, -12.0, "slides: ε = -r"),
    ];
    let description = "Output of a stop with threshold 1 over an input between -2 and 2: a parallelogram";
    chart(description, "stop ε, r = 1", vec![cycles], labels)
}

fn play() -> Chart {
    let cycles = curve(Play::new(1.0).unwrap(), &path(&[2.0, -2.0, 2.0]), Colour::Simulated);
    let labels = vec![
        label(0.8, 1.0, 12.0, "rests"),
        label(-0.5, -0.5, 0.0, "p = x - r"),
        label(-0.5, 0.4, 0.0, "p = x + r"),
    ];
    let description = "Output of a play with threshold 1 over an input between -2 and 2: a parallelogram";
    chart(description, "play p, r = 1", vec![cycles], labels)
}

/// Equation (1.9) of the theory gives a life of 4.8 cycles for this amplitude and capacity.
fn deteriorating_stop() -> Chart {
    let (r, beta, amplitude) = (1.0, 8.0, 1.42);
    let turning: Vec<f64> = (0..11).map(|k| if k % 2 == 0 { amplitude } else { -amplitude }).collect();
    let x = path(&turning);
    let worn = curve(DeterioratingStop::new(r, beta).unwrap(), &x, Colour::Simulated);
    let fresh = curve(Stop::new(r).unwrap(), &path(&[amplitude, -amplitude, amplitude]), Colour::Faint);
    let description = "Output of a deteriorating stop with threshold 1 and capacity 8 over an input between -1.42 and \
                       1.42: its loops shrink to nothing within 5 cycles";
    chart(
        description,
        "deteriorating stop z, r = 1, β = 8",
        vec![fresh, Curve { width: 1.6, ..worn }],
        vec![],
    )
    .with_legend([(Colour::Faint, "stop"), (Colour::Simulated, "5 cycles of the deteriorating stop")])
}

/// Without blank lines, which would end the block of HTML in the Markdown of a documentation comment.
fn without_blank_lines(svg: &str) -> String {
    svg.lines().filter(|line| !line.trim().is_empty()).flat_map(|line| [line, "\n"]).collect()
}

#[test]
fn figures_of_loops_are_as_the_operators_draw_them() {
    let figures = [
        ("operator/stop.svg", stop()),
        ("operator/play.svg", play()),
        ("operator/deteriorating_stop.svg", deteriorating_stop()),
    ];
    for (name, chart) in figures {
        let drawn = without_blank_lines(&chart.file("lab/tests/figures.rs"));
        for place in places(name) {
            if std::env::var_os("HYSID_WRITE").is_some() {
                std::fs::write(&place, &drawn).unwrap();
            }
            let stored = std::fs::read_to_string(&place).unwrap_or_default();
            assert!(
                stored.replace("\r\n", "\n") == drawn,
                "{}: HYSID_WRITE=1 cargo test draws it anew",
                place.display()
            );
        }
    }
}

#[test]
fn both_copies_of_the_network_diagram_are_the_same() {
    let [page, core] = places("network/network.svg");
    let [page, core] =
        [page, core].map(|place| std::fs::read_to_string(place).unwrap().replace("\r\n", "\n"));
    assert!(page == core, "docs/images/network.svg differs from its copy in hysid-core");
    assert!(core == without_blank_lines(&core), "network.svg has a blank line");
}
