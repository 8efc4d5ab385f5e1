//! Tests of the residual, for training and other data apart.

use hysid::diagnosis::residuals::{GroupedResiduals, ResidualFinding, Residuals};
use hysid_document::{Axis, Chart, Colour, Curve, Item, Part, Table, count, number, unit};

use crate::Report;
use crate::residual_words::{name, p_value, verdict};

/// The section; `None` if no data had enough rows.
pub fn section(report: &Report) -> Option<Part> {
    if report.residuals.is_empty() {
        return None;
    }
    let mut parts = vec![Part::note(
        "The residual is the measured minus the simulated output of the free run. Structure in it can be predicted, so \
         that a better model exists; noise cannot. p is the probability of as much structure by chance; it allows for \
         the correlation of the residual in time, and is corrected for the number of tests. The data of each part are \
         named in its heading.",
    )];
    parts.extend(report.residuals.iter().flat_map(|(name, residuals)| of_data(name, residuals)));
    Some(Part::section("What the model leaves unexplained", parts))
}

fn of_data(data: &str, residuals: &Residuals) -> Vec<Part> {
    let mut table = Table::new(["test of the residual", "structure", "p"]);
    for finding in &residuals.findings {
        table.push([name(finding).into(), verdict(finding.verdict).into(), p_value(finding).into()]);
    }
    let item = |finding: &ResidualFinding| {
        let advice = finding.advice.as_ref().map_or_else(String::new, |advice| format!(" {advice}"));
        Item { text: format!("{}{advice}", finding.statement).into(), is_warning: false }
    };
    let found: Vec<Item> = residuals.found().map(item).collect();
    let tested = match residuals.rows == residuals.scored {
        true => count(residuals.rows, "row"),
        false => format!("{} of {}", residuals.rows, count(residuals.scored, "row")),
    };
    let heading = format!(
        "Residual on the {data} data: {tested}, RMS {}",
        unit::with(&number(residuals.rms, 3), &residuals.output)
    );
    let mut parts = vec![Part::Table(table)];
    parts.extend((!found.is_empty()).then_some(Part::List(found)));
    parts.extend(residuals.caution.as_deref().map(Part::note));
    let mut charts = Vec::new();
    if let Some(chart) = autocorrelation(data, residuals) {
        let words = format!("Autocorrelation of the residual on the {data} data; band: 95 % of white noise.");
        charts.extend([Part::note(words), Part::chart(chart)]);
    }
    if let Some(chart) = by_place(data, residuals) {
        let words = format!(
            "Root mean square of the residual on the {data} data in groups of rows, from the left to the right in the order \
             of the legend; line: all rows."
        );
        charts.extend([Part::note(words), Part::chart(chart)]);
    }
    vec![Part::heading(heading), Part::Columns(vec![parts, charts])]
}

/// Autocorrelations with the bound of white noise.
fn autocorrelation(data: &str, residuals: &Residuals) -> Option<Chart> {
    let whiteness = &residuals.whiteness;
    let lags = whiteness.autocorrelation.len();
    if lags == 0 {
        return None;
    }
    let band = [(0.5, -1.0), (lags as f64 + 0.5, -1.0), (lags as f64 + 0.5, 1.0), (0.5, 1.0)];
    let band = band.map(|(lag, side)| (lag, side * whiteness.bound)).to_vec();
    let bar = |(lag, &r): (usize, &f64)| {
        let lag = (lag + 1) as f64;
        [(lag, 0.0), (lag, r), (f64::NAN, f64::NAN)]
    };
    let bars = whiteness.autocorrelation.iter().enumerate().flat_map(bar).collect();
    let curves = vec![Curve::new(band, Colour::Band, 0.0), Curve::new(bars, Colour::Error, 3.0)];
    let description =
        format!("Autocorrelation of the residual on the {data} data, with the 95 % bound of white noise");
    let values = whiteness.autocorrelation.iter().copied();
    let y = Axis::linear("autocorrelation", values.chain([0.0, whiteness.bound, -whiteness.bound]));
    let x = Axis::linear("lag (scored rows)", [0.0, lags as f64 + 0.5].into_iter());
    Some(Chart::on_axes(description, x, y, curves).with_height(200.0))
}

/// Root mean squares by place, one after another.
fn by_place(data: &str, residuals: &Residuals) -> Option<Chart> {
    let places: Vec<&GroupedResiduals> =
        residuals.places.iter().filter(|place| !place.groups.is_empty()).collect();
    if places.is_empty() {
        return None;
    }
    let (mut curves, mut legend) = (Vec::new(), Vec::new());
    let mut at = 0.0;
    let mut sizes = vec![0.0, residuals.rms];
    for (index, place) in places.iter().enumerate() {
        let mut points = Vec::new();
        for group in &place.groups {
            at += 1.0;
            sizes.push(group.rms);
            points.extend([(at, 0.0), (at, group.rms), (f64::NAN, f64::NAN)]);
        }
        at += 0.8;
        curves.push(Curve::new(points, Colour::Series(index), 9.0));
        let groups: Vec<&str> = place.groups.iter().map(|group| short(&group.name)).collect();
        legend.push((Colour::Series(index), format!("{}: {}", place.test.name(), groups.join(", "))));
    }
    let rms = vec![(0.3, residuals.rms), (at, residuals.rms)];
    curves.insert(0, Curve::new(rms, Colour::Faint, 1.0));
    let y = Axis::linear(format!("RMS ({})", unit::of(&residuals.output)), sizes.into_iter());
    let x = Axis::linear("group", [0.0, at + 0.5].into_iter());
    let description = format!("Root mean square of the residual by place on the {data} data");
    Some(Chart::on_axes(description, x, y, curves).with_height(330.0).with_legend(legend))
}

fn short(group: &str) -> &str {
    if group.starts_with("first ") { "after" } else { group.strip_suffix(" input").unwrap_or(group) }
}
