//! The part that a physical quantity usually plays in hysteresis.

/// The usual role of a physical quantity in hysteresis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UsualRole {
    /// An input: displacement, strain, magnetic field, electric voltage.
    Drives(Domain),
    /// An output: force, stress, flux density, polarization.
    Follows(Domain),
    /// An input of any branch of physics, because its name says so: the excitation of an oscillator.
    Excites,
    /// A further input, and no output: temperature, humidity.
    Accompanies,
}

/// The branch of physics of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Domain {
    /// Displacements and forces.
    Mechanics,
    /// Fields and flux densities.
    Magnetism,
    /// Voltages and charges.
    Electricity,
}

impl UsualRole {
    /// The branch of physics of a part that has one.
    pub(crate) fn domain(self) -> Option<Domain> {
        match self {
            Self::Drives(domain) | Self::Follows(domain) => Some(domain),
            Self::Excites | Self::Accompanies => None,
        }
    }
}
