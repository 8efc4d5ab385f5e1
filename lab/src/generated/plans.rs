//! The plans of the cases: which law is measured how. They are ordered so that any first few differ in kind.

use hysid_core::data::record::ColumnNames;
use hysid_core::error::Result;

use super::draw::Draw;
use super::quasi_static::{self, Course, From, LeftOut};
use super::subject::Subject;
use super::timed::{self, Band};
use super::{Parts, devices, magnets, structures};

/// The design of an experiment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Design {
    Cyclic(Course),
    Loops(LeftOut),
    Reversals(From),
    Frequencies(Band),
    Pairs(Band),
    Random(Band),
    Halves(Band),
    /// A random history of a specimen that needs no time.
    SlowRandom,
}

impl Design {
    pub fn parts(self, draw: &mut Draw, subject: &Subject) -> Result<Parts> {
        match self {
            Self::Cyclic(course) => quasi_static::cyclic(draw, subject, course),
            Self::Loops(left_out) => quasi_static::loops(draw, subject, left_out),
            Self::Reversals(from) => quasi_static::reversals(draw, subject, from),
            Self::Frequencies(band) => timed::frequencies(draw, subject, band),
            Self::Pairs(band) => timed::pairs(draw, subject, band),
            Self::Random(band) => timed::random(draw, subject, band),
            Self::Halves(band) => timed::halves(draw, subject, band),
            Self::SlowRandom => timed::slow_random(draw, subject),
        }
    }

    /// The frequencies in Hz of records with time stamps.
    pub fn band(self) -> Option<Band> {
        match self {
            Self::Frequencies(band) | Self::Pairs(band) | Self::Random(band) | Self::Halves(band) => {
                Some(band)
            }
            Self::Cyclic(_) | Self::Loops(_) | Self::Reversals(_) | Self::SlowRandom => None,
        }
    }

    pub fn words(self) -> &'static str {
        match self {
            Self::Cyclic(Course::Growing) => "cyclic test, growing; first 70 %, then the rest",
            Self::Cyclic(Course::Repeated) => "cyclic test, few levels repeated; first 70 %, then the rest",
            Self::Cyclic(Course::Irregular) => "cyclic test, irregular; first 70 %, then the rest",
            Self::Loops(LeftOut::Inside) => "closed loops, one inside left out",
            Self::Loops(LeftOut::Largest) => "closed loops, the largest left out",
            Self::Reversals(From::Below) => "reversal curves from below, alternate ones left out",
            Self::Reversals(From::Above) => "reversal curves from above, alternate ones left out",
            Self::Frequencies(_) => "several frequencies, some inside left out",
            Self::Pairs(_) => "pairs of amplitude and frequency, two left out",
            Self::Random(_) => "random history, then another",
            Self::Halves(_) => "steady sine, first half, then the second",
            Self::SlowRandom => "slow random history, then another",
        }
    }
}

/// How cases of a kind are made.
pub(super) struct Plan {
    pub name: &'static str,
    pub law: &'static str,
    pub subject: fn(&mut Draw) -> Result<Subject>,
    pub design: Design,
    pub input: &'static str,
    pub output: &'static str,
    /// Least and most noise, in percent of the standard deviation of the output.
    pub noise: (f64, f64),
}

impl Plan {
    /// Names of the columns; the time is named where it matters.
    pub fn names(&self) -> ColumnNames {
        ColumnNames {
            time: self.design.band().map(|_| "t_s".to_owned()),
            inputs: vec![self.input.to_owned()],
            rate: None,
            output: self.output.to_owned(),
        }
    }
}

/// Names of a structure's columns.
const MEMBER: [&str; 2] = ["disp_mm", "force_kN"];
/// Names of a magnet's columns.
const MAGNET: [&str; 2] = ["H_A_per_m", "B_T"];
/// Names of a metal's columns.
const METAL: [&str; 2] = ["strain_mm_per_m", "stress_MPa"];

/// Noise of a load cell.
const LOAD_CELL: (f64, f64) = (0.5, 2.0);
/// Noise of a laboratory's instruments.
const LABORATORY: (f64, f64) = (0.2, 1.0);

const fn plan(
    name: &'static str,
    law: &'static str,
    subject: fn(&mut Draw) -> Result<Subject>,
    design: Design,
    [input, output]: [&'static str; 2],
    noise: (f64, f64),
) -> Plan {
    Plan { name, law, subject, design, input, output, noise }
}

const BABER_NOORI: &str = "Bouc-Wen-Baber-Noori";
const PEAKS: &str = "peak-oriented (Clough, Ibarra)";
const EVERETT: &str = "Preisach, analytic Everett function";
const GENERALIZED: &str = "generalized Prandtl-Ishlinskii";
const CHABOCHE: &str = "Chaboche";
const DAMPER: &str = "Bouc-Wen and saturating viscous force behind a lag";
const BUSH: &str = "cubic spring, Berg friction, Maxwell elements";
const JILES_ORIGINAL: &str = "Jiles-Atherton 1986";

/// All plans.
#[rustfmt::skip]
pub(super) static PLANS: [Plan; 36] = {
    use Design::{Cyclic, Frequencies, Halves, Loops, Pairs, Random, Reversals, SlowRandom};
    use Course::{Growing, Irregular, Repeated};
    use LeftOut::{Inside, Largest};
    [
        plan("joint-growing", BABER_NOORI, structures::joint, Cyclic(Growing), MEMBER, LOAD_CELL),
        plan("ferrite-loops", JILES_ORIGINAL, magnets::ferrite, Loops(Inside), MAGNET, LABORATORY),
        plan("sma-actuator-reversals", GENERALIZED, devices::shape_memory_actuator, Reversals(From::Below), ["u_V", "y"], LABORATORY),
        plan("rate-actuator-frequencies", "rate-dependent Prandtl-Ishlinskii", devices::rate_dependent_actuator, Frequencies((1.0, 100.0)), ["u_V", "y_um"], LABORATORY),
        plan("damper-random", DAMPER, devices::magnetorheological_damper, Random((0.2, 3.0)), ["x_mm", "F_N"], LOAD_CELL),
        plan("degrading-column-repeated", BABER_NOORI, structures::degrading_column, Cyclic(Repeated), MEMBER, LOAD_CELL),
        plan("concrete-growing", "Popovics, Karsan-Jirsa", structures::concrete, Cyclic(Growing), METAL, LOAD_CELL),
        plan("thin-sheet-loops", EVERETT, magnets::thin_sheet, Loops(Inside), MAGNET, LABORATORY),
        plan("sma-wire-reversals", "Liang-Rogers", devices::shape_memory_wire, Reversals(From::Below), ["T_degC", "y_mm"], LABORATORY),
        plan("creeping-piezo-frequencies", "Prandtl-Ishlinskii and Maxwell elements", devices::creeping_piezo, Frequencies((0.1, 30.0)), ["u_V", "y_um"], LABORATORY),
        plan("steel-coupon-random", CHABOCHE, structures::structural_steel, SlowRandom, METAL, LABORATORY),
        plan("slender-column-growing", PEAKS, structures::slender_column, Cyclic(Growing), MEMBER, LOAD_CELL),
        plan("pinched-column-growing", BABER_NOORI, structures::pinched_column, Cyclic(Growing), MEMBER, LOAD_CELL),
        plan("powder-core-loops", "Preisach, Lorentz density", magnets::powder_core, Loops(Inside), MAGNET, LABORATORY),
        plan("terfenol-reversals", GENERALIZED, devices::terfenol_actuator, Reversals(From::Above), ["i_A", "y_um"], LABORATORY),
        plan("damper-pairs", DAMPER, devices::magnetorheological_damper, Pairs((0.5, 4.0)), ["x_mm", "F_N"], LOAD_CELL),
        plan("piezo-halves", "Prandtl-Ishlinskii and Maxwell elements", devices::creeping_piezo, Halves((0.5, 5.0)), ["u_V", "y_um"], LABORATORY),
        plan("brace-irregular", "Bouc-Wen", structures::brace, Cyclic(Irregular), MEMBER, LOAD_CELL),
        plan("timber-growing", BABER_NOORI, structures::timber, Cyclic(Growing), MEMBER, LOAD_CELL),
        plan("cast-core-loops", "Jiles-Atherton 1992", magnets::cast_core, Loops(Inside), MAGNET, LABORATORY),
        plan("recording-medium-reversals", "Preisach, Gauss density", magnets::recording_medium, Reversals(From::Above), MAGNET, LABORATORY),
        plan("ferroelectric-frequencies", "Preisach behind a lag, dielectric", magnets::ferroelectric, Frequencies((10.0, 2000.0)), ["V_V", "P_uC_per_cm2"], LABORATORY),
        plan("bush-random", BUSH, devices::rubber_bush, Random((0.1, 15.0)), ["x_mm", "F_N"], LOAD_CELL),
        plan("squat-wall-repeated", PEAKS, structures::squat_wall, Cyclic(Repeated), MEMBER, LOAD_CELL),
        plan("mild-steel-irregular", "Masing, Ramberg-Osgood", structures::ramberg_osgood_steel, Cyclic(Irregular), METAL, LOAD_CELL),
        plan("narrow-core-loops", JILES_ORIGINAL, magnets::narrow_core, Loops(Inside), MAGNET, LABORATORY),
        plan("stack-reversals", "modified Prandtl-Ishlinskii", devices::stack_actuator, Reversals(From::Below), ["u_V", "y_um"], LABORATORY),
        plan("magnetostrictive-frequencies", "generalized Prandtl-Ishlinskii, lag, resonance", devices::magnetostrictive_actuator, Frequencies((10.0, 300.0)), ["i_A", "y_um"], LABORATORY),
        plan("bender-random", "Prandtl-Ishlinskii, bent", devices::bender, SlowRandom, ["u_V", "y_um"], LABORATORY),
        plan("stable-column-growing", BABER_NOORI, structures::stable_column, Cyclic(Growing), MEMBER, LOAD_CELL),
        plan("structural-steel-growing", CHABOCHE, structures::structural_steel, Cyclic(Growing), METAL, LOAD_CELL),
        plan("coarse-sheet-loops", EVERETT, magnets::coarse_sheet, Loops(Largest), MAGNET, LABORATORY),
        plan("bush-pairs", BUSH, devices::rubber_bush, Pairs((0.3, 20.0)), ["x_mm", "F_N"], LOAD_CELL),
        plan("masonry-irregular", "deteriorating stops", structures::masonry, Cyclic(Irregular), MEMBER, LOAD_CELL),
        plan("eddy-sheet-frequencies", "Preisach, analytic Everett function, behind a lag", magnets::eddy_current_sheet, Frequencies((5.0, 400.0)), MAGNET, LABORATORY),
        plan("cobalt-iron-loops", EVERETT, magnets::cobalt_iron, Loops(Inside), MAGNET, LABORATORY),
    ]
};
