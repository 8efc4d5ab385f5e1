//! Names of input and output, and the units of what is made of them.

use hysid_core::data::record::ColumnNames;
use hysid_core::data::unit;

use super::FigureQuantity;

/// Names of the columns that the loops are of.
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
        named(name, self.energy())
    }

    /// A quantity in the product of both units over that of time, as a loss.
    pub fn as_power(&self, name: &str) -> String {
        let power = self.energy().zip(self.rate_time());
        named(name, power.map(|(energy, time)| unit::power(&energy, &time)))
    }

    /// A quantity in the unit of the output over that of the input.
    pub fn as_stiffness(&self, name: &str) -> String {
        let units = unit::of_column(&self.output).zip(unit::of_column(&self.input));
        named(name, units.map(|(output, input)| unit::quotient(&output, &input)))
    }

    /// A quantity in the unit of the output over the square of that of the input, as a Preisach density.
    pub fn as_density(&self, name: &str) -> String {
        let units = unit::of_column(&self.output).zip(unit::of_column(&self.input));
        let square = |input: String| {
            if input.contains(['/', ' ']) { format!("({input})2") } else { format!("{input}2") }
        };
        named(name, units.map(|(output, input)| format!("{output}/{}", square(input))))
    }

    /// A quantity in the unit of the input over that of time.
    pub fn as_speed(&self, name: &str) -> String {
        let units = unit::of_column(&self.input).zip(self.time.clone());
        named(name, units.map(|(input, time)| unit::quotient(&input, &time)))
    }

    /// A figure of a cycle, named like a column.
    pub fn as_figure(&self, name: &str, quantity: FigureQuantity) -> String {
        match quantity {
            FigureQuantity::Input => self.as_input(name),
            FigureQuantity::Output | FigureQuantity::Creep => self.as_output(name),
            FigureQuantity::Energy => self.as_energy(name),
            FigureQuantity::Power => self.as_power(name),
            FigureQuantity::Stiffness => self.as_stiffness(name),
            FigureQuantity::Time => named(name, self.time.clone()),
            FigureQuantity::Frequency => named(name, self.rate_time().as_deref().map(frequency)),
            FigureQuantity::Percent => named(name, Some("%".into())),
            FigureQuantity::Ratio => name.into(),
            FigureQuantity::Angle => named(name, Some("deg".into())),
            FigureQuantity::EnergyPerMass => named(name, self.energy().and_then(|unit| per_mass(&unit))),
            FigureQuantity::PowerPerMass => {
                let power = self.energy().and_then(|unit| per_mass(&unit)).zip(self.rate_time());
                named(
                    name,
                    power.map(|(energy, time)| match time.as_str() {
                        "s" => energy.replace('J', "W"),
                        _ => unit::quotient(&energy, &time),
                    }),
                )
            }
        }
    }

    /// True if the input is a voltage.
    pub fn is_of_voltage(&self) -> bool {
        unit::of_column(&self.input).is_some_and(|unit| matches!(unit.as_str(), "V" | "kV" | "mV"))
    }

    /// True if the output is a charge of an area.
    pub fn is_polarisation(&self) -> bool {
        unit::of_column(&self.output).is_some_and(|unit| unit.contains('C') && unit.ends_with("m2"))
    }

    /// The product of both units if it is known and is no energy per volume.
    pub(super) fn other_than_energy_per_volume(&self) -> Option<String> {
        self.energy().filter(|unit| per_mass(unit).is_none())
    }

    /// Factor from the area of a loop to its energy in its unit.
    pub fn energy_factor(&self) -> f64 {
        self.energy_and_factor().map_or(1.0, |(_, factor)| factor)
    }

    /// Factor from cycles per unit of time to the unit of frequencies.
    pub(super) fn rate_factor(&self) -> f64 {
        self.per_second().unwrap_or(1.0)
    }

    fn energy(&self) -> Option<String> {
        self.energy_and_factor().map(|(unit, _)| unit)
    }

    fn energy_and_factor(&self) -> Option<(String, f64)> {
        let units = unit::of_column(&self.output).zip(unit::of_column(&self.input));
        units.map(|(output, input)| unit::energy(&output, &input))
    }

    /// The unit of time of frequencies and powers: seconds for seconds and their parts.
    fn rate_time(&self) -> Option<String> {
        self.per_second().map(|_| "s".to_string()).or_else(|| self.time.clone())
    }

    /// Units of time in a second, where they are no longer than one.
    fn per_second(&self) -> Option<f64> {
        unit::factor("s", self.time.as_deref()?).filter(|per_second| *per_second >= 1.0)
    }
}

/// The unit of an energy per volume over a density in kg/m3.
fn per_mass(energy: &str) -> Option<String> {
    energy.strip_suffix("/m3").map(|energy| format!("{energy}/kg"))
}

/// The unit of a frequency.
fn frequency(time: &str) -> String {
    match time {
        "s" => "Hz".into(),
        other => format!("1/{other}"),
    }
}

/// Without a unit where one of those it is made of is not known.
fn named(name: &str, unit: Option<String>) -> String {
    unit.map_or_else(|| name.to_string(), |unit| format!("{name} [{unit}]"))
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
        assert_eq!(joint.as_energy("energy"), "energy [J]");
        assert_eq!(joint.as_power("loss"), "loss [W]");
        assert_eq!(joint.as_stiffness("stiffness"), "stiffness [kN/mm]");
        assert_eq!(joint.as_speed("speed"), "speed [mm/s]");
        let magnet = quantities(None, "H_A_per_m", "B_T");
        assert_eq!(magnet.as_stiffness("slope"), "slope [T/(A/m)]");
        assert_eq!(magnet.as_density("density"), "density [T/(A/m)2]");
        assert_eq!(magnet.as_energy("energy"), "energy [J/m3]");
        assert_eq!(magnet.as_speed("speed"), "speed");
        let cgs = quantities(Some("t_ms"), "H_Oe", "B_kG");
        assert_eq!(cgs.as_energy("energy"), "energy [J/m3]");
        // 1000/(4π) erg/cm³, in J/m³.
        approx::assert_relative_eq!(cgs.energy_factor(), 7.957_747_154_594_767, max_relative = 1e-12);
        assert_eq!(cgs.as_power("loss"), "loss [W/m3]");
        assert_eq!(cgs.as_figure("frequency", FigureQuantity::Frequency), "frequency [Hz]");
        assert_eq!(cgs.as_figure("specific loss", FigureQuantity::PowerPerMass), "specific loss [W/kg]");
        assert_eq!(cgs.as_speed("speed"), "speed [Oe/ms]");
        assert_eq!((cgs.rate_factor(), joint.rate_factor(), joint.energy_factor()), (1000.0, 1.0, 1.0));
        let slow = quantities(Some("t_min"), "disp_mm", "force_kN");
        assert_eq!(slow.as_figure("frequency", FigureQuantity::Frequency), "frequency [1/min]");
        assert_eq!(slow.rate_factor(), 1.0);
        assert_eq!(quantities(None, "strain", "stress_MPa").as_energy("energy"), "energy");
    }
}
