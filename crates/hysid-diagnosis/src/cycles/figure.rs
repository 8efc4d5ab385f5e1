//! The figures of a cycle and of an amplitude level: name, unit, fields and definition, declared once.

use Field::{Actuator, Battery, General, Hydrology, Magnet, Structure, Thermal};
use FigureQuantity::{
    Angle, Creep, Energy, EnergyPerMass, Frequency, Input, Output, Percent, Power, PowerPerMass, Ratio,
    Stiffness, Time,
};

use super::field::Field;
use super::levels::LevelRow;
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
    /// A number without unit.
    Ratio,
    /// An angle in degrees.
    Angle,
    /// The product of both units, an energy per volume, over a mass density.
    EnergyPerMass,
    /// The same over the unit of time.
    PowerPerMass,
}

/// A figure of a row: of a cycle, or of an amplitude level.
#[derive(Debug, Clone, Copy)]
pub struct Figure<R = CycleRow> {
    /// Its name in tables, in JSON and in Python.
    pub name: &'static str,
    /// Name of the figure, in a few words.
    pub label: &'static str,
    /// Quantity whose unit it has.
    pub quantity: FigureQuantity,
    /// The fields in whose tables it is; [`Field::General`] has those of structures, magnets and actuators.
    pub fields: &'static [Field],
    /// Its value in a row.
    pub of: fn(&R) -> Option<f64>,
}

impl<R> Figure<R> {
    /// True if the tables of the field have it.
    pub fn is_of(&self, field: Field) -> bool {
        let is_usual = || [Structure, Magnet, Actuator].iter().any(|usual| self.fields.contains(usual));
        self.fields.contains(&field) || field == General && is_usual()
    }
}

const ALL: &[Field] = &Field::ALL;

macro_rules! figures {
    ($all:ident of $row:ty: $($name:ident, $label:literal, $quantity:expr, $fields:expr;)*) => {
        /// All figures, in the order of the columns of a table.
        pub const $all: &[Figure<$row>] = &[$(Figure {
            name: stringify!($name),
            label: $label,
            quantity: $quantity,
            fields: $fields,
            of: |row| row.$name,
        }),*];
    };
}

figures! {
    FIGURES of CycleRow:
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
    energy, "energy", Energy, &[Structure, Magnet, Battery];
    energy_deviation, "deviation of energy", Energy, &[Structure, Magnet, Battery];
    cumulative_energy, "cumulative energy", Energy, &[Structure];
    power, "loss per time", Power, &[Magnet];
    igse_energy, "loss by iGSE", Energy, &[Magnet];
    energy_per_mass, "loss per cycle and mass", EnergyPerMass, &[Magnet];
    power_per_mass, "specific loss", PowerPerMass, &[Magnet];
    secant_stiffness, "secant stiffness", Stiffness, &[Structure];
    damping_percent, "equivalent damping", Percent, &[Structure];
    storage_modulus, "storage modulus", Stiffness, &[Structure];
    loss_modulus, "loss modulus", Stiffness, &[Structure];
    loss_angle, "loss angle", Angle, &[Structure];
    residual_after_peak, "residual after peak", Input, &[Structure];
    residual_after_valley, "residual after valley", Input, &[Structure];
    coercive_input, "coercive field", Input, &[Magnet];
    remanent_output, "remanence", Output, &[Magnet];
    squareness, "squareness", Ratio, &[Magnet];
    width, "width", Output, &[Actuator, Thermal, Battery];
    width_deviation, "deviation of width", Output, &[Actuator, Thermal, Battery];
    width_percent, "width", Percent, &[Actuator, Thermal, Battery];
    width_at_input, "widest at", Input, &[Actuator, Thermal, Battery];
    nonlinearity_percent, "non-linearity", Percent, &[Actuator];
    peak_to_peak, "peak to peak", Output, &[Actuator];
    butterfly_remanence, "at remanence", Output, &[Actuator];
    butterfly_coercive_input, "coercive field", Input, &[Actuator];
    heating_start, "heating, start", Input, &[Thermal];
    heating_finish, "heating, finish", Input, &[Thermal];
    cooling_start, "cooling, start", Input, &[Thermal];
    cooling_finish, "cooling, finish", Input, &[Thermal];
    thermal_width, "thermal width", Input, &[Thermal];
    mean_gap, "mean gap", Output, &[Battery];
    energy_efficiency_percent, "energy efficiency", Percent, &[Battery];
    hysteresis_index, "hysteresis index", Ratio, &[Hydrology];
    hold_duration, "hold", Time, &[Actuator];
    creep, "creep", Output, &[Actuator];
    creep_percent, "creep", Percent, &[Actuator];
    creep_per_decade, "creep per decade", Creep, &[Actuator];
}

figures! {
    LEVEL_FIGURES of LevelRow:
    amplitude, "amplitude", Input, &[Structure];
    drift_percent, "drift", Percent, &[Structure];
    output_first, "output, first", Output, &[Structure];
    strength_loss_percent, "strength loss", Percent, &[Structure];
    strength_percent, "of peak", Percent, &[Structure];
    stiffness_first, "stiffness, first", Stiffness, &[Structure];
    stiffness_loss_percent, "stiffness loss", Percent, &[Structure];
    stiffness_percent, "of first stiffness", Percent, &[Structure];
    energy_first, "energy, first", Energy, &[Structure];
    energy_mean, "energy, mean", Energy, &[Structure];
    damping_percent, "mean damping", Percent, &[Structure];
    cumulative_energy, "cumulative energy", Energy, &[Structure];
    ductility, "ductility", Ratio, &[Structure];
    cumulative_ductility, "cumulative ductility", Ratio, &[Structure];
}
