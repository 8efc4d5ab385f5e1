//! The paper's examples as data: specimens, rivals, what the paper reports and what is to be reached.

use hysid::network::Family;
use hysid::options::classical::ClassicalModel;

/// An example of the paper.
#[derive(Debug)]
pub struct Example {
    /// Name on the command line.
    pub name: &'static str,
    /// What it is about.
    pub title: &'static str,
    /// What the paper reports, on measured data that are not public.
    pub paper: &'static str,
    /// What stands in for these.
    pub cases: &'static [Case],
}

/// A specimen and who is fitted to it beside the XPNN.
#[derive(Debug)]
pub struct Case {
    /// Name in the catalogue of specimens.
    pub specimen: &'static str,
    /// Why it is there.
    pub shows: &'static str,
    /// Fitted to the same data.
    pub opponent: Opponent,
    /// What is to be reached.
    pub wanted: &'static [Wanted],
}

/// Who is compared with the XPNN.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Opponent {
    /// Nobody.
    Nobody,
    /// Another network with as many stops.
    Network(Family),
    /// A classical model.
    Law(ClassicalModel),
    /// The XPNN without the rate.
    WithoutRate,
}

/// A figure and its limit.
#[derive(Debug)]
pub struct Wanted {
    /// Which figure.
    pub figure: Figure,
    /// At most this for an error, at least this for a ratio.
    pub limit: f64,
}

/// A figure of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    /// NRMSE of the training data in % of std.
    Training,
    /// NRMSE of the unseen data in % of std.
    Unseen,
    /// The same of those records alone.
    UnseenRecords(&'static [&'static str]),
    /// Largest error on unseen data in % of the largest output.
    LargestUnseen,
    /// How many times the rival's MSE is above that of the XPNN, on the training data.
    TimesBelowTraining,
    /// The same on the unseen data.
    TimesBelowUnseen,
}

impl Figure {
    /// True if more is better.
    pub fn is_ratio(self) -> bool {
        matches!(self, Self::TimesBelowTraining | Self::TimesBelowUnseen)
    }

    /// In words.
    pub fn words(self) -> String {
        match self {
            Self::Training => "training, % of std".into(),
            Self::Unseen => "unseen, % of std".into(),
            Self::UnseenRecords(names) => format!("unseen {}, % of std", names.join(" and ")),
            Self::LargestUnseen => "largest unseen error, % of largest".into(),
            Self::TimesBelowTraining => "MSE ratio, other model / XPNN, training".into(),
            Self::TimesBelowUnseen => "MSE ratio, other model / XPNN, unseen".into(),
        }
    }
}

const fn wanted(figure: Figure, limit: f64) -> Wanted {
    Wanted { figure, limit }
}

const GPNN: Opponent = Opponent::Network(Family::Gpnn);
const GPIM: Opponent = Opponent::Law(ClassicalModel::GeneralizedPrandtlIshlinskii);

/// At most 0.5 % in training and 2 % on unseen data.
const CLOSE: &[Wanted] = &[wanted(Figure::Training, 0.5), wanted(Figure::Unseen, 2.0)];

/// At most the paper's 3.2 % of the largest load, and 10 times below the rival.
const JOINT: &[Wanted] = &[
    wanted(Figure::LargestUnseen, 3.2),
    wanted(Figure::TimesBelowTraining, 10.0),
    wanted(Figure::TimesBelowUnseen, 10.0),
];

/// 40 times below the rival: the paper's 0.654 to 0.016.
const FORTY: &[Wanted] = &[wanted(Figure::TimesBelowTraining, 40.0), wanted(Figure::TimesBelowUnseen, 40.0)];

/// The seven examples.
pub static EXAMPLES: [Example; 7] = [
    Example {
        name: "example1",
        title: "ferromagnetic material",
        paper: "excellent agreement with measured data (its abstract); no number for this example is known \
                to us.",
        cases: &[Case {
            specimen: "ferromagnet",
            shows: "minor loops within minor loops",
            opponent: Opponent::Nobody,
            wanted: CLOSE,
        }],
    },
    Example {
        name: "example2",
        title: "beam-column joint of reinforced concrete",
        paper: "prediction errors up to 3.2 % of the load (printed without the sign); training MSE from 41 to 0.004 by the genetic algorithm and 0.0001 by the gradient; GPNN 99.47 and 140.13. These MSE cannot all be in one unit: with the output weights by least squares none can begin above the output's variance.",
        cases: &[
            Case {
                specimen: "reinforced-concrete-joint-cycles",
                shows: "unseen cycles between training cycles: their damage is within the trained range, \
                        the cycles themselves are new",
                opponent: GPNN,
                wanted: JOINT,
            },
            Case {
                specimen: "reinforced-concrete-joint",
                shows: "the last 30 % of the time unseen: drift and damage exceed those in training, so \
                        this is an extrapolation",
                opponent: GPNN,
                wanted: JOINT,
            },
        ],
    },
    Example {
        name: "example3",
        title: "Terfenol-D actuator at low speed",
        paper: "MSE 0.016 against 0.654 of the GPIM.",
        cases: &[
            Case {
                specimen: "terfenol-rod",
                shows: "asymmetric loops of a specimen that is not a GPIM",
                opponent: GPIM,
                wanted: FORTY,
            },
            Case {
                specimen: "terfenol-actuator",
                shows: "a specimen that is a GPIM, which favours the GPIM",
                opponent: GPIM,
                wanted: &[],
            },
        ],
    },
    Example {
        name: "example4",
        title: "shape-memory-alloy actuator",
        paper: "a comparison with the GPIM for two wires between -1 and 1 A; no number for this example is \
                known to us.",
        cases: &[
            Case {
                specimen: "two-wire-actuator",
                shows: "asymmetric loops of a specimen that is not a GPIM",
                opponent: GPIM,
                wanted: FORTY,
            },
            Case {
                specimen: "shape-memory-actuator",
                shows: "a specimen that is a GPIM, which favours the GPIM",
                opponent: GPIM,
                wanted: &[],
            },
        ],
    },
    Example {
        name: "example5",
        title: "concrete in cyclic compression",
        paper: "MSE 2.79, its unit not stated.",
        cases: &[Case {
            specimen: "concrete",
            shows: "softening and permanent strain",
            opponent: Opponent::Nobody,
            wanted: CLOSE,
        }],
    },
    Example {
        name: "example6",
        title: "rate-dependent actuators",
        paper: "on the synthetic set MSE 7e-5 in training and 0.002 on unseen data, 778 without the rate; \
                for the piezo set, in which 50 and 200 Hz were not trained on, no number is known to us.",
        cases: &[
            Case {
                specimen: "rate-dependent-actuator",
                shows: "the synthetic set, of a rate-dependent Prandtl-Ishlinskii law. The paper's 7e-5 and 0.002 at an output variance above 778 are about 0.03 % and 0.16 % of std",
                opponent: Opponent::WithoutRate,
                wanted: &[
                    wanted(Figure::Training, 0.05),
                    wanted(Figure::UnseenRecords(&["25 Hz", "75 Hz"]), 0.5),
                    wanted(Figure::TimesBelowTraining, 50.0),
                ],
            },
            Case {
                specimen: "piezo-actuator",
                shows: "the piezo set: 50 and 200 Hz unseen",
                opponent: Opponent::WithoutRate,
                wanted: &[],
            },
        ],
    },
    Example {
        name: "example7",
        title: "magnetostrictive actuator from 10 to 300 Hz",
        paper: "excellent agreement with measured data (its abstract) at eight frequencies; no number for \
                this example is known to us.",
        cases: &[Case {
            specimen: "magnetostrictive-actuator",
            shows: "hysteresis between a lag and a resonance; 50 and 200 Hz unseen",
            opponent: Opponent::Nobody,
            wanted: CLOSE,
        }],
    },
];
