//! The field of engineering that data come from.

use hysid_core::data::record::ColumnNames;
use hysid_core::data::unit;
use hysid_core::data::usual_role::{Domain, UsualRole};
use hysid_core::named;
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
    /// Anything over temperature: shape-memory alloys.
    Thermal,
    /// Voltage over charge or state of charge.
    Battery,
    /// Concentration or turbidity over the discharge of a river.
    Hydrology,
    /// Not known: all figures are read.
    General,
}

named!(
    Field, "field":
    Structure = "structure", Magnet = "magnet", Actuator = "actuator", Thermal = "thermal", Battery = "battery",
    Hydrology = "hydrology", General = "general"
);

impl Field {
    /// The field that the names and units of the first input and the output indicate.
    pub fn of(names: &ColumnNames) -> Self {
        if names.inputs.first().is_some_and(|name| is_applied_field(name)) && is_magnetic_state(&names.output)
        {
            return Self::Magnet;
        }
        if let Some(input) = names.inputs.first() {
            let output = &names.output;
            if has_unit(input, TEMPERATURE_UNITS) || has_word(unit::split(input).0, TEMPERATURE_WORDS) {
                return Self::Thermal;
            }
            let is_charge = has_unit(input, CHARGE_UNITS) || has_word(unit::split(input).0, CHARGE_WORDS);
            if is_charge
                && (has_unit(output, VOLTAGE_UNITS) || has_word(unit::split(output).0, VOLTAGE_WORDS))
            {
                return Self::Battery;
            }
            let is_stream = has_unit(input, STREAM_UNITS) || has_word(unit::split(input).0, STREAM_WORDS);
            if is_stream && (has_unit(output, SOLUTE_UNITS) || has_word(unit::split(output).0, SOLUTE_WORDS))
            {
                return Self::Hydrology;
            }
        }
        let input = names.inputs.first().and_then(|name| UsualRole::of(name));
        match (input, UsualRole::of(&names.output)) {
            (Some(UsualRole::Drives(Domain::Mechanics)), Some(UsualRole::Follows(Domain::Mechanics))) => {
                Self::Structure
            }
            (Some(UsualRole::Drives(one)), Some(UsualRole::Follows(other))) if one == other => Self::Magnet,
            (Some(UsualRole::Drives(Domain::Mechanics) | UsualRole::Follows(_) | UsualRole::Excites), _) => {
                Self::General
            }
            (_, Some(UsualRole::Drives(Domain::Mechanics))) => Self::Actuator,
            _ => Self::General,
        }
    }

    /// True if the figures of structures are read.
    pub(crate) fn has_structures(self) -> bool {
        matches!(self, Self::Structure | Self::General)
    }

    /// True if the figures of magnets are read.
    pub(super) fn has_magnets(self) -> bool {
        matches!(self, Self::Magnet | Self::General)
    }

    /// True if the holds of actuators are read.
    pub(super) fn has_holds(self) -> bool {
        matches!(self, Self::Actuator | Self::General)
    }

    /// True if the width of loops is read.
    pub(super) fn has_widths(self) -> bool {
        !matches!(self, Self::Structure | Self::Magnet | Self::Hydrology)
    }

    /// True if loops usually go from one end of the input to the other.
    pub(super) fn goes_from_tips(self) -> bool {
        matches!(self, Self::Magnet | Self::Actuator | Self::Thermal | Self::Battery)
    }

    /// True if the area of loops is read.
    pub(super) fn has_areas(self) -> bool {
        !matches!(self, Self::Actuator | Self::Thermal | Self::Hydrology)
    }

    /// Factor that turns `∮ y dx` into the energy lost. The work on a magnet is `∮ H dB = -∮ B dH`.
    pub(super) fn sense_of_energy(self) -> f64 {
        if self == Self::Magnet { -1.0 } else { 1.0 }
    }
}

/// Units of magnetic and electric fields, without blanks.
const FIELD_UNITS: &str = "T mT uT µT G kG Oe kOe A/m kA/m MA/m V/m kV/m MV/m kV/cm kV/mm";

/// Words of an applied field.
const FIELD_WORDS: &str = "field feld champ campo h";

/// Units of moments, magnetisations and polarisations, without blanks.
const STATE_UNITS: &str = "emu memu emu/g emu/cm3 emu/cc Am2 Am^2 mAm2 Am2/kg Am^2/kg uB C/m2 uC/cm2 \
                           µC/cm2 mdeg mrad";

/// Words of moments, magnetisations and polarisations.
const STATE_WORDS: &str = "moment magnetization magnetisation magnetisierung magnetic polarization \
                           polarisation kerr moke induction flux charge m j b p";

/// Units and words of temperatures.
const TEMPERATURE_UNITS: &str = "K °C degC ℃ °F Celsius";
const TEMPERATURE_WORDS: &str = "temperature temp temperatur température temperatura";

/// Units and words of a charge and a state of charge.
const CHARGE_UNITS: &str = "Ah mAh mAh/g Ah/kg";
const CHARGE_WORDS: &str = "soc dod capacity";

/// Units and words of voltages.
const VOLTAGE_UNITS: &str = "V mV";
const VOLTAGE_WORDS: &str = "voltage potential ocv";

/// Units and words of the discharge of a river.
const STREAM_UNITS: &str = "m3/s m^3/s m³/s l/s L/s cfs ft3/s";
const STREAM_WORDS: &str = "streamflow runoff discharge";

/// Units and words of what a river carries.
const SOLUTE_UNITS: &str = "mg/l mg/L g/L g/l ug/L µg/L NTU FNU uS/cm µS/cm";
const SOLUTE_WORDS: &str = "turbidity concentration ssc tss sediment nitrate phosphorus conductivity";

fn has_word(name: &str, words: &str) -> bool {
    let lower = name.to_lowercase();
    lower.split(|c: char| !c.is_alphanumeric()).any(|word| words.split(' ').any(|known| known == word))
}

fn has_unit(name: &str, units: &str) -> bool {
    let plain = |unit: String| unit.replace([' ', '·', '*', '.'], "");
    unit::of_column(name).map(plain).is_some_and(|unit| units.split(' ').any(|known| known == unit))
}

fn is_applied_field(name: &str) -> bool {
    has_unit(name, FIELD_UNITS) || has_word(unit::split(name).0, FIELD_WORDS)
}

fn is_magnetic_state(name: &str) -> bool {
    has_unit(name, STATE_UNITS) || has_word(unit::split(name).0, STATE_WORDS)
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
            ("Field (T)", "Moment (Am2)", Field::Magnet),
            ("Field (Oe)", "Moment (emu)", Field::Magnet),
            ("Magnetic Field (Oe)", "DC Moment Fixed Ctr (emu)", Field::Magnet),
            ("B (T)", "M (Am2/kg)", Field::Magnet),
            ("B (T)", "M (A m2/kg)", Field::Magnet),
            ("H (kA/m)", "J (T)", Field::Magnet),
            ("mu0H (T)", "Magnetization (emu/g)", Field::Magnet),
            ("Field (mT)", "Kerr rotation (mdeg)", Field::Magnet),
            ("E (kV/cm)", "P (uC/cm2)", Field::Magnet),
            ("Electric field (kV/cm)", "Polarization (µC/cm²)", Field::Magnet),
            ("Field (T)", "Magnetostriction strain (ppm)", Field::General),
            ("rotation (rad)", "moment (kN m)", Field::Structure),
            ("Strain (%)", "Stress (kPa)", Field::Structure),
            ("x", "y", Field::General),
            ("Temperature (°C)", "Strain (%)", Field::Thermal),
            ("T [K]", "R [ohm]", Field::Thermal),
            ("SOC (%)", "Voltage (V)", Field::Battery),
            ("Capacity (Ah)", "E (V)", Field::Battery),
            ("Q [m3/s]", "Turbidity [NTU]", Field::Hydrology),
            ("streamflow", "nitrate", Field::Hydrology),
            ("I (A)", "Voltage (V)", Field::General),
            ("force_N", "x_mm", Field::General),
        ] {
            let names = ColumnNames::of(None, &[input], output);
            assert_eq!(Field::of(&names), field, "{input} {output}");
        }
        assert_eq!("magnet".parse::<Field>().unwrap(), Field::Magnet);
        assert!("wood".parse::<Field>().is_err());
    }
}
