//! The figures of a cycle: name, unit, fields and definition, declared once.

use Field::{Actuator, General, Magnet, Structure};
use FigureQuantity::{Creep, Energy, Frequency, Input, Output, Percent, Power, Stiffness, Time};

use super::field::Field;
use super::row::CycleRow;

/// Quantity whose unit a figure has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FigureQuantity {
    /// In the unit of the input.
    Input,
    /// In the unit of the output.
    Output,
    /// In the unit of the output for each decade of time.
    Creep,
    /// In the product of both units.
    Energy,
    /// In the product of both units over that of time.
    Power,
    /// In the unit of the output over that of the input.
    Stiffness,
    /// In the unit of time.
    Time,
    /// In cycles per unit of time.
    Frequency,
    /// In percent.
    Percent,
}

/// A figure of a cycle.
#[derive(Debug, Clone, Copy)]
pub struct Figure {
    /// Its name in tables, in JSON and in Python.
    pub name: &'static str,
    /// Name of the figure, in a few words.
    pub label: &'static str,
    /// Quantity whose unit it has.
    pub quantity: FigureQuantity,
    /// The fields in whose tables it is; [`Field::General`] has all.
    pub fields: &'static [Field],
    /// Its value for a cycle.
    pub of: fn(&CycleRow) -> Option<f64>,
}

impl Figure {
    /// True if the tables of the field have it.
    pub fn is_of(&self, field: Field) -> bool {
        field == General || self.fields.contains(&field)
    }
}

const ALL: &[Field] = &Field::ALL;

macro_rules! figures {
    ($($name:ident, $label:literal, $quantity:expr, $fields:expr;)*) => {
        /// All figures, in the order of the columns of a table.
        pub const FIGURES: &[Figure] = &[$(Figure {
            name: stringify!($name),
            label: $label,
            quantity: $quantity,
            fields: $fields,
            of: |row| row.$name,
        }),*];
    };
}

figures! {
    start_time, "start", Time, ALL;
    period, "period", Time, ALL;
    frequency, "frequency", Frequency, ALL;
    input_min, "smallest input", Input, ALL;
    input_max, "largest input", Input, ALL;
    amplitude, "amplitude", Input, ALL;
    mean_input, "mean input", Input, ALL;
    output_min, "smallest output", Output, ALL;
    output_max, "largest output", Output, ALL;
    peak_input, "input at peak", Input, &[Structure];
    peak_output, "output at peak", Output, &[Structure];
    valley_input, "input at valley", Input, &[Structure];
    valley_output, "output at valley", Output, &[Structure];
    energy, "energy", Energy, &[Structure, Magnet];
    energy_deviation, "deviation of energy", Energy, &[Structure, Magnet];
    cumulative_energy, "cumulative energy", Energy, &[Structure];
    power, "loss per time", Power, &[Magnet];
    secant_stiffness, "secant stiffness", Stiffness, &[Structure];
    damping_percent, "equivalent damping", Percent, &[Structure];
    residual_after_peak, "residual after peak", Input, &[Structure];
    residual_after_valley, "residual after valley", Input, &[Structure];
    coercive_input, "coercive field", Input, &[Magnet];
    remanent_output, "remanence", Output, &[Magnet];
    width, "width", Output, &[Actuator];
    width_deviation, "deviation of width", Output, &[Actuator];
    width_percent, "width", Percent, &[Actuator];
    width_at_input, "widest at", Input, &[Actuator];
    hold_duration, "hold", Time, &[Actuator];
    creep, "creep", Output, &[Actuator];
    creep_percent, "creep", Percent, &[Actuator];
    creep_per_decade, "creep per decade", Creep, &[Actuator];
}
