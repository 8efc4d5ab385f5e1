//! Names of input and output, and the units of what is made of them.

use hysid::data::record::ColumnNames;
use hysid::data::unit;

/// What the loops are loops of.
pub struct Quantities {
    /// Name of the input's column.
    pub input: String,
    /// Name of the output's column.
    pub output: String,
    time: Option<String>,
}

impl Quantities {
    /// The first input and the output.
    pub fn of(names: &ColumnNames) -> Self {
        let of_time = |name: &String| unit::of_column(name);
        Self {
            input: names.inputs[0].clone(),
            output: names.output.clone(),
            time: names.time.as_ref().and_then(of_time),
        }
    }

    /// A quantity in the unit of the input, named like a column.
    pub fn as_input(&self, name: &str) -> String {
        named(name, unit::of_column(&self.input))
    }

    /// A quantity in the unit of the output.
    pub fn as_output(&self, name: &str) -> String {
        named(name, unit::of_column(&self.output))
    }

    /// A quantity in the product of both units, as the area of a loop.
    pub fn as_energy(&self, name: &str) -> String {
        let units = unit::of_column(&self.output).zip(unit::of_column(&self.input));
        named(name, units.map(|(output, input)| format!("{output} {input}")))
    }

    /// A quantity in the unit of the output over that of the input.
    pub fn as_stiffness(&self, name: &str) -> String {
        named(name, quotient(unit::of_column(&self.output), unit::of_column(&self.input)))
    }

    /// A quantity in the unit of the input over that of time.
    pub fn as_speed(&self, name: &str) -> String {
        named(name, quotient(unit::of_column(&self.input), self.time.clone()))
    }
}

fn quotient(above: Option<String>, below: Option<String>) -> Option<String> {
    let (above, below) = (above?, below?);
    Some(if below.contains(['/', ' ']) { format!("{above}/({below})") } else { format!("{above}/{below}") })
}

/// Without a unit where one of those it is made of is not known.
fn named(name: &str, unit: Option<String>) -> String {
    unit.map_or_else(|| name.to_string(), |unit| format!("{name} [{unit}]"))
}

/// The name as text shows it: `energy, kN mm`.
pub fn text_label(name: &str) -> String {
    match unit::split(name) {
        (name, Some(unit)) => format!("{name}, {unit}"),
        (name, None) => name.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantities(time: Option<&str>, input: &str, output: &str) -> Quantities {
        let time = time.map(String::from);
        Quantities::of(&ColumnNames { time, inputs: vec![input.into()], rate: None, output: output.into() })
    }

    #[test]
    fn units_are_made_of_units() {
        let joint = quantities(Some("t_s"), "disp_mm", "force_kN");
        assert_eq!(joint.as_energy("energy"), "energy [kN mm]");
        assert_eq!(joint.as_stiffness("stiffness"), "stiffness [kN/mm]");
        assert_eq!(joint.as_speed("speed"), "speed [mm/s]");
        let magnet = quantities(None, "H_A_per_m", "B_T");
        assert_eq!(magnet.as_stiffness("slope"), "slope [T/(A/m)]");
        assert_eq!(text_label(&magnet.as_energy("energy")), "energy, T A/m");
        assert_eq!(magnet.as_speed("speed"), "speed");
        assert_eq!(quantities(None, "strain", "stress_MPa").as_energy("energy"), "energy");
    }
}
