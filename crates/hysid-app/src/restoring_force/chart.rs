//! The restoring force over the displacement.

use hysid::error::MotionColumn;
use hysid::restoring_force::{RestoringForce, RestoringRecord};
use hysid_document::chart::thin::thin_path;
use hysid_document::{Chart, Colour, Curve, unit};

use super::{MeasuredMotion, MotionRecord};

/// Points of all records together.
const POINTS: usize = 6000;

/// The loop of each record, over the rows with a force.
pub fn chart(motion: &MeasuredMotion, found: &RestoringForce) -> Chart {
    let most = (POINTS / motion.records.len().max(1)).max(16);
    let curve = |(record, found): (&MotionRecord, &RestoringRecord)| {
        let displacement = record.column(MotionColumn::Displacement).unwrap_or_default();
        let rows = displacement.iter().zip(&found.force).filter(|(_, force)| force.is_finite());
        let (x, y): (Vec<f64>, Vec<f64>) = rows.unzip();
        let point = |row: Option<usize>| row.map_or((f64::NAN, f64::NAN), |row| (x[row], y[row]));
        Curve::new(thin_path(&[&x, &y], most).into_iter().map(point).collect(), Colour::Measured, 1.6)
    };
    let curves = motion.records.iter().zip(&found.records).map(curve).collect();
    let x = unit::label(&motion.names.displacement);
    let y = match &motion.units.force_unit {
        Some(unit) => format!("restoring force ({unit})"),
        None => "restoring force".into(),
    };
    Chart::new(format!("{y} over {x}"), &x, &y, curves).sized(560.0, 400.0)
}
