//! Meaning of a column by its name and unit, as machines and loggers write them: what drives, what follows, and what
//! only accompanies a test. Words are those of a name, lower case, cut at blanks, signs, digits and capitals.

use hysid_core::data::unit;
use hysid_core::data::usual_role::{Domain, UsualRole};

/// Meaning of a column by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnKind {
    /// An input.
    Drives(Domain),
    /// An output.
    Follows(Domain),
    /// An input by its name: an excitation.
    Excites,
    /// Temperature, humidity, frequency: a condition of the test.
    Condition,
    /// A number of cycles, steps, points or the like.
    Counter,
    /// A capacity, an energy: a sum over other columns.
    Integral,
    /// A power, a stiffness, a velocity: calculated from other columns.
    Derived,
    /// A standard error, a range, a status: about a measurement.
    Statistic,
    /// Not known.
    Unknown,
}

/// Words of a number of something.
const COUNTERS: &str = "cycle cycles cyc step steps segment segments seg index idx no nr num number row rows sample \
    samples scan scans block loop loops sweep sweeps repetition rep repetitions count counts counter point points pt id \
    record seq sequence packet frame line zyklus zyklen zykluszahl lastwechsel schritt punkt nummer ciclo ciclos paso \
    pas essai циклы цикл шаг номер 循环 周期 序号 工步 サイクル";

/// Units of counts.
const COUNTED: [&str; 8] = ["cycles", "cycle", "n", "#", "counts", "segments", "steps", "1"];

/// Words of conditions.
const CONDITIONS: &str = "temperature temp temperatur température temperatura температура 温度 humidity rh feuchte 湿度 \
    frequency freq frequenz fréquence frecuencia 频率 amplitude amp chamber ambient oven";

/// Words of sums.
const INTEGRALS: &str = "capacity capacité kapazität capacidad 容量 energy energie énergie energía энергия 能量 work \
    dissipated dissipation cumulative cumulated accumulated damage ah mah wh mwh kwh qo";

/// Units of sums, and of rates of change.
const UNITS_OF_SUMS: [&str; 12] =
    ["Ah", "mAh", "uAh", "Wh", "mWh", "kWh", "A.h", "W.h", "mA.h", "A·h", "Ahr", "mAhr"];

const UNITS_OF_SPEED: [&str; 6] = ["mm/s", "m/s", "cm/s", "in/s", "deg/s", "rad/s"];

/// Words of figures that are calculated from others.
const DERIVED: &str = "power stiffness damping modulus permeability efficiency conductance impedance acr dcir \
    velocity vel speed acceleration acc rate tan phase derivative slope ratio steifigkeit leistung geschwindigkeit \
    beschleunigung vitesse accélération puissance скорость ускорение 速度 加速度 功率";

/// Words of forces, which those of figures tell apart, such as a damping force, and of what is calculated from forces.
const FORCES: &str = "force load stress torque moment flux polarization polarisation kraft effort fuerza";
const OF_FORCES: &str = "rate derivative slope ratio modulus stiffness phase tan permeability efficiency";

/// Words about a measurement.
const STATISTICS: &str = "std stdev stddev stderr err error sigma uncertainty deviation dev quality fit chi status state flag \
    range gain harmonic overload valid averages averaging offset limit mode min max minimum maximum lag quad";

/// Words of inputs, beside those of [`UsualRole::of`].
const DRIVES: &[(Domain, &str)] = &[
    (
        Domain::Mechanics,
        "displ displace displacements lvdt extensometer crosshead defl elong ext elongation pos gap cmod ctod slip \
      curvature settlement strains deform verschieb traverse traversenweg chord",
    ),
    (Domain::Magnetism, "field feld fields magfield happ hext bapp 磁场"),
    (Domain::Electricity, "volt volts voltage volta vg vgs vgate vds bias spannung напряжение tension"),
];

/// Words of outputs, beside those of [`UsualRole::of`].
const FOLLOWS: &[(Domain, &str)] = &[
    (
        Domain::Mechanics,
        "forces loads stresses shear axialforce standardkraft loadcell rf reaction vwc moisture saturation adsorption \
      adsorbed desorption uptake",
    ),
    (Domain::Magnetism, "magnetisation magnetization magnetic_moment emu kerr flux polarisation"),
    (Domain::Electricity, "polarization polarisation charge displacement_field"),
];

/// Units of magnetic moments and magnetizations, without blanks and signs.
const MAGNETIC_UNITS: [&str; 10] =
    ["emu", "memu", "uemu", "emug", "emucc", "emucm3", "am2", "am2kg", "mam2", "μemu"];

/// Words of commands.
const COMMANDS: [&str; 9] =
    ["command", "cmd", "control", "setpoint", "target", "demand", "desired", "reference", "soll"];

/// Words of raw data, and of the data made of them.
const RAW: [&str; 5] = ["raw", "uncorrected", "unfiltered", "uncalibrated", "roh"];
const MADE: [&str; 8] =
    ["adjusted", "corrected", "filtered", "calibrated", "smoothed", "processed", "adj", "corr"];

impl ColumnKind {
    /// The meaning of a column of this name.
    pub fn of(name: &str) -> Self {
        // A column that `hysid simulate` added.
        let (quantity, unit) = unit::split(name.trim().trim_end_matches("_model"));
        let words = words(quantity);
        let has = |list: &str| {
            list.split_whitespace().any(|known| match known.chars().any(|c| c as u32 >= 0x2e80) {
                true => quantity.contains(known),
                false => words.iter().any(|word| word == known),
            })
        };
        let unit = unit.as_deref();
        if has(STATISTICS) || has("coil") && !has("current") {
            return Self::Statistic;
        }
        if unit.is_some_and(|unit| UNITS_OF_SUMS.contains(&unit) || unit.contains("Ah/")) || has(INTEGRALS) {
            return Self::Integral;
        }
        // A change of one quantity with another: `dV/dt`, `dQ/dV`.
        let is_speed = unit.is_some_and(|unit| UNITS_OF_SPEED.contains(&unit));
        let is_change = quantity.contains("/d") && quantity.starts_with(['d', 'D']) || is_speed;
        if is_change || has(DERIVED) && (!has(FORCES) || has(OF_FORCES)) {
            return Self::Derived;
        }
        if quantity == "T" && matches!(unit, None | Some("C" | "F")) || has("amplitude frequency freq") {
            return Self::Condition;
        }
        if let Some(kind) = Self::physical(quantity, unit, &has) {
            return kind;
        }
        let is_temperature = words.iter().any(|word| word.ends_with("temperatur"));
        if has(CONDITIONS)
            || is_temperature
            || unit.is_some_and(|unit| matches!(unit, "Hz" | "kHz" | "mHz" | "%RH" | "%rh"))
        {
            return Self::Condition;
        }
        if has(COUNTERS) && unit.is_none_or(|unit| COUNTED.contains(&unit)) || quantity.trim() == "#" {
            return Self::Counter;
        }
        Self::Unknown
    }

    fn physical(quantity: &str, unit: Option<&str>, has: &dyn Fn(&str) -> bool) -> Option<Self> {
        let plain: String = unit.unwrap_or_default().chars().filter(|c| c.is_alphanumeric()).collect();
        let is_electric =
            has("electric e") || matches!(unit, Some("V/m" | "kV/cm" | "V/cm" | "MV/m" | "kV/mm" | "V/um"));
        if has("field feld champ campo fields") && !has("displacement") {
            return Some(Self::Drives(if is_electric { Domain::Electricity } else { Domain::Magnetism }));
        }
        if is_electric {
            return Some(Self::Drives(Domain::Electricity));
        }
        if MAGNETIC_UNITS.contains(&plain.to_lowercase().replace('μ', "u").as_str()) {
            return Some(Self::Follows(Domain::Magnetism));
        }
        // The suction of a soil is a pressure, and drives.
        if has("suction tension psi") && has("suction matric soil") {
            return Some(Self::Drives(Domain::Mechanics));
        }
        // The applied field of a magnetometer, in the unit of a flux density.
        let letters: String = quantity.chars().filter(|c| c.is_alphanumeric()).collect();
        if matches!(letters.as_str(), "mu0H" | "µ0H" | "μ0H" | "u0H" | "B0") {
            return Some(Self::Drives(Domain::Magnetism));
        }
        // A charge is a load in French; its unit decides.
        let quantity_or_unit = if has("charge") && unit.is_some() { "q" } else { quantity };
        match UsualRole::of(&name_of(quantity_or_unit, unit)) {
            Some(UsualRole::Drives(domain)) => return Some(Self::Drives(domain)),
            Some(UsualRole::Follows(domain)) => return Some(Self::Follows(domain)),
            Some(UsualRole::Excites) => return Some(Self::Excites),
            Some(UsualRole::Accompanies) => return Some(Self::Condition),
            None => {}
        }
        let named =
            |list: &[(Domain, &str)]| list.iter().find(|(_, words)| has(words)).map(|(domain, _)| *domain);
        match (named(DRIVES), named(FOLLOWS)) {
            (Some(domain), None) => Some(Self::Drives(domain)),
            (None, Some(domain)) => Some(Self::Follows(domain)),
            _ if unit.is_some() => None,
            _ => match quantity.trim() {
                "V" | "I" | "U" | "E" => Some(Self::Drives(Domain::Electricity)),
                "M" | "J" => Some(Self::Follows(Domain::Magnetism)),
                "P" | "Q" => Some(Self::Follows(Domain::Electricity)),
                "F" => Some(Self::Follows(Domain::Mechanics)),
                _ => None,
            },
        }
    }

    /// True for a column that is an input wherever it stands.
    pub fn drives(self) -> bool {
        matches!(self, Self::Drives(_) | Self::Excites)
    }

    /// True for a column that is an output wherever it stands.
    pub fn follows(self) -> bool {
        matches!(self, Self::Follows(_))
    }

    /// Why such a column is neither input nor output beside others that may be; `None` if it may be either.
    pub fn accompanies(self) -> Option<&'static str> {
        match self {
            Self::Condition => Some("a condition of the test"),
            Self::Counter => Some("a counter"),
            Self::Integral => Some("a sum over other columns"),
            Self::Derived => Some("calculated from other columns"),
            Self::Statistic => Some("about a measurement"),
            Self::Drives(_) | Self::Follows(_) | Self::Excites | Self::Unknown => None,
        }
    }

    /// True if these meanings of an input and an output are interchanged.
    pub fn are_swapped(input: Self, output: Self) -> bool {
        let part = |kind| match kind {
            Self::Drives(domain) => Some(UsualRole::Drives(domain)),
            Self::Follows(domain) => Some(UsualRole::Follows(domain)),
            Self::Excites => Some(UsualRole::Excites),
            _ => None,
        };
        UsualRole::are_swapped(part(input), part(output))
    }
}

/// True for a velocity: the rate of an input.
pub fn is_rate(name: &str) -> bool {
    words(unit::split(name).0)
        .iter()
        .any(|word| ["velocity", "vel", "speed", "rate"].contains(&word.as_str()))
}

/// True for an electric current.
pub fn is_current(name: &str) -> bool {
    let (quantity, unit) = unit::split(name);
    match unit.as_deref() {
        Some(unit) => matches!(unit, "A" | "mA" | "uA" | "µA" | "nA" | "kA"),
        None => {
            quantity == "I" || words(quantity).iter().any(|word| ["current", "amps"].contains(&word.as_str()))
        }
    }
}

/// True for the moment that a magnetometer measures, beside which a position or a pressure is no input or output.
pub fn is_moment(name: &str) -> bool {
    let plain =
        |unit: String| unit.chars().filter(|c| c.is_alphanumeric()).collect::<String>().to_lowercase();
    let unit = unit::split(name).1.map(plain);
    unit.is_some_and(|unit| MAGNETIC_UNITS.contains(&unit.replace('μ', "u").as_str()))
}

/// True for a command, beside which its measurement is the input.
pub fn is_command(name: &str) -> bool {
    words(name).iter().any(|word| COMMANDS.contains(&word.as_str()))
}

/// True for a name that is no more than the number of a channel.
pub fn is_channel(name: &str) -> bool {
    let letters: String = name.chars().filter(|c| c.is_alphabetic()).collect::<String>().to_lowercase();
    name.chars().any(|c| c.is_ascii_digit())
        && matches!(
            letters.as_str(),
            "c" | "ch" | "chan" | "channel" | "ai" | "kanal" | "col" | "column" | "var" | "unnamed"
        )
}

/// True for names in the documented order: `x1`, `x2`, `y`.
pub fn are_documented(names: &[&String]) -> bool {
    let begins = |name: &String, letters: &[char]| name.to_lowercase().starts_with(letters);
    let [inputs @ .., output] = names else { return false };
    begins(output, &['y']) && inputs.iter().all(|input| begins(input, &['x', 'u']))
}

/// The column made of a raw one, by its name: `Adjusted Moment` of `Raw Moment`, or `Moment` of `M. Raw`.
pub fn made_of<'n>(raw: &str, names: &[&'n String]) -> Option<&'n String> {
    let kind = ColumnKind::of(raw);
    let is_raw = |words: &[String]| words.iter().any(|word| RAW.contains(&word.as_str()));
    let raw = words(raw);
    let rest = |words: &[String], qualifiers: &[&str]| -> Option<Vec<String>> {
        let rest: Vec<String> =
            words.iter().filter(|word| !qualifiers.contains(&word.as_str())).cloned().collect();
        (rest.len() < words.len()).then_some(rest)
    };
    let wanted = rest(&raw, &RAW)?;
    let adjusted = names.iter().find(|name| rest(&words(name), &MADE).is_some_and(|rest| rest == wanted));
    let is_other = |name: &&&String| kind.follows() && ColumnKind::of(name) == kind && !is_raw(&words(name));
    adjusted.or_else(|| names.iter().find(is_other)).copied()
}

/// The words of a name, lower case.
pub fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for letter in name.chars() {
        let begins = !before.is_alphabetic() || before.is_lowercase() && letter.is_uppercase();
        if letter.is_alphabetic() {
            if begins {
                words.push(String::new());
            }
            if let Some(word) = words.last_mut() {
                word.extend(letter.to_lowercase());
            }
        }
        before = letter;
    }
    words
}

/// A name with its unit, in which digits and capitals do not hide words.
fn name_of(quantity: &str, unit: Option<&str>) -> String {
    let spaced = words(quantity);
    let quantity = if spaced.iter().all(|word| word.chars().count() == 1) {
        quantity.to_string()
    } else {
        spaced.join(" ")
    };
    unit.map_or(quantity.clone(), |unit| format!("{quantity} [{unit}]"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_meanings() {
        use Domain::{Electricity, Magnetism, Mechanics};
        for (kind, names) in [
            (
                ColumnKind::Drives(Mechanics),
                "Axial Displacement (mm); disp1; Crosshead [mm]; LVDT 2; x_mm; Strain1; Matric Suction (kPa)",
            ),
            (
                ColumnKind::Drives(Magnetism),
                "Magnetic Field (Oe); Field (T); H; mu0H (T); Adjusted Field; H_A_per_m; AppliedField",
            ),
            (
                ColumnKind::Drives(Electricity),
                "Electric Field (kV/cm); Drive Voltage (V); current; Coil Current (A); I [A]; Vg; E (V/m)",
            ),
            (
                ColumnKind::Follows(Mechanics),
                "Damping Force [N]; Axial Force (kN); Load1; Stress (MPa); BaseShear; F_N; F",
            ),
            (
                ColumnKind::Follows(Magnetism),
                "Moment (emu); Magnetization (A/m); M (emu/g); DC Moment Free Ctr (emu); B_T; Kerr",
            ),
            (ColumnKind::Follows(Electricity), "Polarization (uC/cm2); Charge (nC); P"),
            (ColumnKind::Condition, "Temperature (K); T (°C); Frequency (Hz); RH; Sample Temp"),
            (
                ColumnKind::Counter,
                "Cycle Count; Cycle_Index; Step; StepNo; Segment #; Axial Counts (segments); Data_Point; TC_Counter; N. cycles",
            ),
            (
                ColumnKind::Integral,
                "chgAh; Charge_Capacity(Ah); Discharge Capacity [mAh]; Energy (J); Q (mAh/g); Dissipated Energy",
            ),
            (
                ColumnKind::Derived,
                "dV/dt(V/s); Stress rate; Force ratio; Velocity (mm/s); Power [W]; Storage Modulus (MPa); dQ/dV",
            ),
            (ColumnKind::Statistic, "M. Std. Err. (emu); Range; Status; Moment Quality; Field error"),
            (ColumnKind::Unknown, "x; y; u; foo; Bridge A"),
        ] {
            for name in names.split("; ") {
                assert_eq!(ColumnKind::of(name), kind, "{name}");
            }
        }
    }
}
