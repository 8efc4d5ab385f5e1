//! The record as a whole: its loops with backbone and turning points, and the way of its input.

use hysid::data::record::Dataset;
use hysid::diagnosis::Diagnosis;
use hysid_document::chart::records_in_colour;
use hysid_document::chart::thin::{Point, thin, thin_path};
use hysid_document::{Chart, Colour, Curve, Part, count, unit};

use crate::quantities::Quantities;
use crate::time_label;

const LOOP_POINTS: usize = 8000;

const WAY_POINTS: usize = 3000;

/// Most turning points that are marked, and most records that are drawn.
const MOST_DOTS: usize = 600;
const MOST_RECORDS: usize = 200;

/// Most records whose way is drawn.
const MOST_WAYS: usize = 4;

/// The data, and what was found in them.
pub struct Overview<'a> {
    data: &'a Dataset,
    diagnosis: &'a Diagnosis,
    quantities: &'a Quantities,
}

impl<'a> Overview<'a> {
    pub fn new(data: &'a Dataset, diagnosis: &'a Diagnosis, quantities: &'a Quantities) -> Self {
        Self { data, diagnosis, quantities }
    }

    pub fn section(&self) -> Part {
        let mut ways = Vec::new();
        let records = self.data.records();
        let mut longest: Vec<usize> = (0..records.len()).collect();
        longest.sort_by_key(|&record| std::cmp::Reverse(records[record].len()));
        longest.truncate(MOST_WAYS);
        longest.sort_unstable();
        for record in &longest {
            if records.len() > 1 {
                ways.push(Part::heading(records[*record].name()));
            }
            ways.push(Part::chart(self.way(*record)));
        }
        let mut words =
            "The backbone connects the loop tips that exceed all earlier ones; dots are turning points of \
             the input."
                .to_string();
        if longest.len() < records.len() {
            words += &format!(
                " Of {}, the input of the {} longest is drawn.",
                count(records.len(), "record"),
                longest.len()
            );
        }
        let columns = vec![vec![Part::chart(self.loops())], ways];
        Part::section("The data", [Part::Columns(columns), Part::note(words)])
    }

    fn loops(&self) -> Chart {
        let records = self.data.records();
        let every = records.len().div_ceil(MOST_RECORDS).max(1);
        let shown: Vec<usize> = (0..records.len()).step_by(every).collect();
        let most = (LOOP_POINTS / shown.len()).max(16);
        let names: Vec<&str> = shown.iter().map(|&index| records[index].name()).collect();
        let (colours, mut legend) = records_in_colour(&names);
        if legend.is_empty() {
            legend.push((Colour::Measured, "measured".into()));
        }
        let (mut curves, mut backbones) = (Vec::new(), Vec::new());
        for (place, &index) in shown.iter().enumerate() {
            let (x, y) = (&records[index].inputs()[0], records[index].output());
            let path = thin_path(&[x, y], most);
            let point = |row: &Option<usize>| row.map_or((f64::NAN, f64::NAN), |row| (x[row], y[row]));
            let points = path.iter().map(point).collect();
            let colour = colours.get(place).copied().unwrap_or(Colour::Measured);
            curves.push(Curve::new(points, colour, 1.3));
            let points = self.backbone(index);
            backbones.push(Curve::new(points, Colour::Simulated, 2.0));
        }
        curves.extend(backbones.into_iter().filter(|curve| curve.points.len() > 2));
        curves.push(dots(shown.iter().flat_map(|&index| self.tips(index)).collect()));
        let (x, y) = (unit::label(&self.quantities.input), unit::label(&self.quantities.output));
        let description = format!("Loops of {y} over {x}, with backbone and turning points");
        legend.push((Colour::Simulated, "backbone".into()));
        legend.push((Colour::Error, "turning points".into()));
        Chart::new(description, &x, &y, curves).sized(560.0, 400.0).with_legend(legend)
    }

    /// Input and output where the input turns.
    fn tips(&self, index: usize) -> Vec<Point> {
        let record = &self.data.records()[index];
        let tip = |&row: &usize| (record.inputs()[0][row], record.output()[row]);
        self.diagnosis.turning_rows[index].iter().map(tip).filter(|tip| tip.1.is_finite()).collect()
    }

    /// The backbone of a record, in the order of the input.
    fn backbone(&self, index: usize) -> Vec<Point> {
        let name = self.data.records()[index].name();
        let own = self.diagnosis.backbone.iter().filter(|point| point.record == name);
        let mut points: Vec<Point> = own.map(|point| (point.input, point.output)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    }

    /// The input over time, or over the row where there is no time.
    fn way(&self, index: usize) -> Chart {
        let record = &self.data.records()[index];
        let time = |row: usize| record.time().map_or((row + 1) as f64, |time| time[row]);
        let x = &record.inputs()[0];
        let way: Vec<Point> = (0..x.len()).map(|row| (time(row), x[row])).collect();
        let turning = self.diagnosis.turning_rows[index].iter().map(|&row| way[row]).collect();
        let label = time_label(self.data);
        let input = unit::label(&self.quantities.input);
        let description = format!("{input} over {label}, record {}", record.name());
        let curves = vec![Curve::new(thin(&way, WAY_POINTS), Colour::Input, 1.2), dots(turning)];
        Chart::new(description, &label, &input, curves)
            .with_height(200.0)
            .with_legend([(Colour::Input, "input"), (Colour::Error, "turning points")])
    }
}

/// Points as dots, evenly chosen of very many.
fn dots(points: Vec<Point>) -> Curve {
    let every = points.len().div_ceil(MOST_DOTS).max(1);
    Curve::dots(points.into_iter().step_by(every), Colour::Error, 2.2)
}
