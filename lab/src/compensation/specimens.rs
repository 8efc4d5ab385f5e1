//! The actuators that are driven by what the inverses give.

use hysid::specimens::{
    Specimen, magnetostrictive_actuator, piezo_actuator, rate_dependent_actuator, shape_memory_actuator,
    two_wire_actuator,
};

/// An actuator, and how its wanted outputs are sampled.
pub struct Actuator {
    /// Name of the specimen.
    pub name: &'static str,
    /// Period of a wanted output in s.
    pub period: f64,
    /// The outputs at these times in s, for these inputs over two periods.
    pub response: fn(&[f64], &[f64]) -> Vec<f64>,
}

impl Actuator {
    /// The specimen.
    pub fn specimen(&self) -> &'static Specimen {
        Specimen::named(self.name).expect("one of the catalogue")
    }
}

/// Rows of a period.
pub const ROWS: usize = 1000;

/// All actuators. Those that are slow in training are slow here; the periods of the others lie among the trained ones.
pub const ACTUATORS: [Actuator; 5] = [
    Actuator { name: "piezo-actuator", period: 0.05, response: piezo },
    Actuator { name: "magnetostrictive-actuator", period: 0.05, response: magnetostrictive_actuator::run },
    Actuator { name: "shape-memory-actuator", period: 5000.0, response: shape_memory },
    Actuator {
        name: "two-wire-actuator",
        period: 4000.0,
        response: |_, current| two_wire_actuator::run(current),
    },
    Actuator { name: "rate-dependent-actuator", period: 0.1, response: rate_dependent_actuator::run },
];

/// The second period, twice: the response is known for a periodic voltage.
fn piezo(time: &[f64], voltage: &[f64]) -> Vec<f64> {
    let half = voltage.len() / 2;
    let period = time[half] - time[0];
    piezo_actuator::periodic_response(&voltage[half..], period).repeat(2)
}

fn shape_memory(_: &[f64], voltage: &[f64]) -> Vec<f64> {
    shape_memory_actuator::law().run(voltage)
}
