//! The field of engineering that data come from.

use std::fmt;
use std::str::FromStr;

use hysid_core::data::column::{Domain, Part};
use hysid_core::data::record::ColumnNames;
use serde::Serialize;

/// A field of engineering, which determines what is read from its loops.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Field {
    /// Force over displacement, stress over strain: members, joints, dampers, bearings.
    Structure,
    /// Flux density over field, polarisation over voltage: magnets and ferroelectrics.
    Magnet,
    /// Displacement or strain over voltage, current or field.
    Actuator,
    /// Not known: all figures are read.
    General,
}

impl Field {
    /// All fields.
    pub const ALL: [Self; 4] = [Self::Structure, Self::Magnet, Self::Actuator, Self::General];

    /// The field that the names and units of the first input and the output indicate.
    pub fn of(names: &ColumnNames) -> Self {
        let input = names.inputs.first().and_then(|name| Part::of(name));
        match (input, Part::of(&names.output)) {
            (Some(Part::Drives(Domain::Mechanics)), Some(Part::Follows(Domain::Mechanics))) => {
                Self::Structure
            }
            (Some(Part::Drives(one)), Some(Part::Follows(other))) if one == other => Self::Magnet,
            (Some(Part::Drives(Domain::Mechanics) | Part::Follows(_) | Part::Excites), _) => Self::General,
            (_, Some(Part::Drives(Domain::Mechanics))) => Self::Actuator,
            _ => Self::General,
        }
    }

    /// True if the figures of structures are read.
    pub(super) fn has_structures(self) -> bool {
        matches!(self, Self::Structure | Self::General)
    }

    /// True if the figures of magnets are read.
    pub(super) fn has_magnets(self) -> bool {
        matches!(self, Self::Magnet | Self::General)
    }

    /// True if the figures of actuators are read.
    pub(super) fn has_actuators(self) -> bool {
        matches!(self, Self::Actuator | Self::General)
    }

    /// What `∮ y dx` is multiplied by to be the energy lost. The work on a magnet is `∮ H dB = -∮ B dH`.
    pub(super) fn sense_of_energy(self) -> f64 {
        if self == Self::Magnet { -1.0 } else { 1.0 }
    }

    /// The name, such as `structure`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Structure => "structure",
            Self::Magnet => "magnet",
            Self::Actuator => "actuator",
            Self::General => "general",
        }
    }
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Field {
    type Err = hysid_core::Error;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let known = || Self::ALL.map(Self::name).to_vec();
        Self::ALL.into_iter().find(|field| field.name() == name).ok_or_else(|| {
            hysid_core::Error::UnknownName { what: "field", name: name.into(), known: known() }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_tell_the_field() {
        for (input, output, field) in [
            ("disp_mm", "force_kN", Field::Structure),
            ("strain", "stress_MPa", Field::Structure),
            ("theta_rad", "M_kN_m", Field::Structure),
            ("H_A_per_m", "B_T", Field::Magnet),
            ("V_V", "P_uC_per_cm2", Field::Magnet),
            ("u_V", "y_um", Field::Actuator),
            ("i_A", "y_um", Field::Actuator),
            ("x", "y", Field::General),
            ("force_N", "x_mm", Field::General),
        ] {
            let names =
                ColumnNames { time: None, inputs: vec![input.into()], rate: None, output: output.into() };
            assert_eq!(Field::of(&names), field, "{input} {output}");
        }
        assert_eq!("magnet".parse::<Field>().unwrap(), Field::Magnet);
        assert!("wood".parse::<Field>().is_err());
    }
}
