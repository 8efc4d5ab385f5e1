//! A drive as CSV.

use hysid::plan::Plan;
use hysid_tables::{DecimalSign, push_shortest};

/// The rows of the drive as CSV, without the header.
pub fn rows(plan: &Plan) -> Vec<u8> {
    let mut text = String::new();
    for (row, &x) in plan.input.iter().enumerate() {
        if let Some(time) = &plan.time {
            push_shortest(&mut text, time[row], DecimalSign::Point);
            text.push(',');
        }
        push_shortest(&mut text, x, DecimalSign::Point);
        text.push('\n');
    }
    text.into_bytes()
}
