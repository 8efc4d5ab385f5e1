//! The paper's examples as data: specimens, rivals, what the paper reports and what is to be reached.

use hysid_core::network::Family;

use crate::chapter::TargetSource;
use crate::fitting::FoldKind;

/// An example of the paper.
#[derive(Debug)]
pub struct Example {
    /// Name on the command line.
    pub name: &'static str,
    /// Title of the example.
    pub title: &'static str,
    /// Result that the paper reports, on measured data that are not public.
    pub paper: &'static str,
    /// Specimens that stand in for these data.
    pub cases: &'static [ExampleCase],
    /// Why targets are missed, as far as the cases show it: a paragraph each.
    pub causes: &'static [&'static str],
}

/// A specimen and who is fitted to it beside the XPNN.
#[derive(Debug)]
pub struct ExampleCase {
    /// Name in the catalogue of specimens.
    pub specimen: &'static str,
    /// Why it is there.
    pub shows: &'static str,
    /// Where its unseen data lie.
    pub folds: FoldKind,
    /// Fitted to the same data; ratios are to the first of them.
    pub opponents: &'static [Opponent],
    /// Figures with their limits.
    pub wanted: &'static [FigureLimit],
}

/// Who is compared with the XPNN.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Opponent {
    /// Another network with as many stops.
    Network(Family),
    /// The paper's rival of examples 3 and 4.
    GeneralizedPrandtlIshlinskii,
    /// The law of Bouc and Wen with the degradation and pinching of Baber and Noori.
    DegradingBoucWen,
    /// The XPNN without the rate.
    WithoutRate,
    /// The XPNN fitted to the unseen rows too: what it can represent.
    WithUnseen,
}

/// A figure and its limit.
#[derive(Debug)]
pub struct FigureLimit {
    pub figure: CaseFigure,
    /// At most this for an error, at least this for a ratio.
    pub limit: f64,
    /// Whose target it is.
    pub source: TargetSource,
}

/// A figure of a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CaseFigure {
    /// NRMSE of the training data in % of std.
    Training,
    /// NRMSE of the unseen data in % of std.
    Unseen,
    /// MSE of the unseen data in the square of the output's unit.
    UnseenMse,
    /// NRMSE of these unseen records alone in % of std.
    UnseenRecords(&'static [&'static str]),
    /// Largest error on unseen data in % of the largest output.
    LargestUnseen,
    /// The same on the unseen rows before the last training row of the same record.
    LargestUnseenBetween,
    /// How many times the rival's MSE is above that of the XPNN, on the training data.
    TimesBelowTraining,
    /// The same on the unseen data.
    TimesBelowUnseen,
}

impl CaseFigure {
    /// True if more is better.
    pub fn is_ratio(self) -> bool {
        matches!(self, Self::TimesBelowTraining | Self::TimesBelowUnseen)
    }

    /// In words; a ratio is one to this rival.
    pub fn words(self, rival: Option<&str>) -> String {
        let rival = rival.unwrap_or("other model");
        match self {
            Self::Training => "training, % of std".into(),
            Self::Unseen => "unseen, % of std".into(),
            Self::UnseenMse => "unseen, MSE".into(),
            Self::UnseenRecords(names) => format!("unseen {}, % of std", names.join(" and ")),
            Self::LargestUnseen => "largest unseen error, % of largest".into(),
            Self::LargestUnseenBetween => "largest unseen error between training rows, % of largest".into(),
            Self::TimesBelowTraining => format!("MSE ratio, {rival} / XPNN, training"),
            Self::TimesBelowUnseen => format!("MSE ratio, {rival} / XPNN, unseen"),
        }
    }
}

impl FigureLimit {
    /// The limit in words.
    pub fn words(&self) -> String {
        format!("{} {}", if self.figure.is_ratio() { "at least" } else { "at most" }, self.limit)
    }

    /// Is this within the limit?
    pub fn is_met_by(&self, value: f64) -> bool {
        if self.figure.is_ratio() { value >= self.limit } else { value <= self.limit }
    }
}

const fn paper(figure: CaseFigure, limit: f64) -> FigureLimit {
    FigureLimit { figure, limit, source: TargetSource::Paper }
}

const fn words(figure: CaseFigure, limit: f64) -> FigureLimit {
    FigureLimit { figure, limit, source: TargetSource::Words }
}

const fn ours(figure: CaseFigure, limit: f64) -> FigureLimit {
    FigureLimit { figure, limit, source: TargetSource::Ours }
}

const GPNN: Opponent = Opponent::Network(Family::Gpnn);
const GPIM: Opponent = Opponent::GeneralizedPrandtlIshlinskii;

/// Agreement, which the paper claims in words: at most 0.5 % in training and 2 % on unseen data.
const CLOSE: &[FigureLimit] = &[words(CaseFigure::Training, 0.5), words(CaseFigure::Unseen, 2.0)];

/// A model of fewer errors than a specimen's own law: the paper claims that the XPNN beats the GPIM.
const BETTER_THAN_ITS_LAW: &[FigureLimit] =
    &[words(CaseFigure::TimesBelowTraining, 1.0), words(CaseFigure::TimesBelowUnseen, 1.0)];

/// The seven examples.
pub static EXAMPLES: [Example; 7] = [
    Example {
        name: "example1",
        title: "ferromagnetic material",
        paper: "excellent agreement with measured data (its abstract); no number for this example is known to us.",
        cases: &[ExampleCase {
            specimen: "ferromagnet",
            shows: "minor loops within minor loops",
            folds: FoldKind::After,
            opponents: &[],
            wanted: CLOSE,
        }],
        causes: &[],
    },
    Example {
        name: "example2",
        title: "beam-column joint of reinforced concrete",
        paper: "prediction errors up to 3.2 % of the load (printed without the sign); training MSE from 41 to 0.004 by the genetic algorithm and 0.0001 by the gradient; GPNN 99.47 and 140.13. These MSE cannot all be in one unit: with the output weights by least squares none can begin above the output's variance. Which data were unseen is not known to us.",
        cases: &[
            ExampleCase {
                specimen: "reinforced-concrete-joint-cycles",
                shows: "unseen cycles between training cycles, except the last one, which comes after all training \
                        rows and has more damage than any of them",
                folds: FoldKind::Between,
                opponents: &[GPNN, Opponent::DegradingBoucWen, Opponent::WithUnseen],
                wanted: &[
                    paper(CaseFigure::LargestUnseen, 3.2),
                    words(CaseFigure::TimesBelowTraining, 1.0),
                    words(CaseFigure::TimesBelowUnseen, 1.0),
                    ours(CaseFigure::LargestUnseenBetween, 3.2),
                    ours(CaseFigure::TimesBelowTraining, 10.0),
                    ours(CaseFigure::TimesBelowUnseen, 10.0),
                ],
            },
            ExampleCase {
                specimen: "reinforced-concrete-joint",
                shows: "the last 30 % of the time unseen: drift and damage exceed those in training, so \
                        this is an extrapolation",
                folds: FoldKind::After,
                opponents: &[GPNN, Opponent::DegradingBoucWen],
                wanted: &[
                    ours(CaseFigure::LargestUnseen, 3.2),
                    ours(CaseFigure::TimesBelowTraining, 10.0),
                    ours(CaseFigure::TimesBelowUnseen, 10.0),
                ],
            },
        ],
        causes: &[THIRD_CYCLES, FORECAST],
    },
    Example {
        name: "example3",
        title: "Terfenol-D actuator at low speed",
        paper: "MSE 0.016 against 0.654 of the GPIM, a ratio of 41; that this holds on unseen data it does not say.",
        cases: &[
            ExampleCase {
                specimen: "terfenol-rod",
                shows: "asymmetric loops of a specimen that is not a GPIM",
                folds: FoldKind::After,
                opponents: &[GPIM],
                wanted: &[
                    paper(CaseFigure::TimesBelowTraining, 40.0),
                    ours(CaseFigure::TimesBelowUnseen, 40.0),
                ],
            },
            ExampleCase {
                specimen: "terfenol-actuator",
                shows: "a specimen that is a GPIM, which favours the GPIM",
                folds: FoldKind::After,
                opponents: &[GPIM],
                wanted: BETTER_THAN_ITS_LAW,
            },
        ],
        causes: &[OWN_LAW],
    },
    Example {
        name: "example4",
        title: "shape-memory-alloy actuator",
        paper: "a comparison with the GPIM for two wires between -1 and 1 A; no number for this example is \
                known to us.",
        cases: &[
            ExampleCase {
                specimen: "two-wire-actuator",
                shows: "asymmetric loops of a specimen that is not a GPIM",
                folds: FoldKind::After,
                opponents: &[GPIM],
                wanted: &[
                    words(CaseFigure::TimesBelowTraining, 1.0),
                    words(CaseFigure::TimesBelowUnseen, 1.0),
                    ours(CaseFigure::TimesBelowTraining, 40.0),
                    ours(CaseFigure::TimesBelowUnseen, 40.0),
                ],
            },
            ExampleCase {
                specimen: "shape-memory-actuator",
                shows: "a specimen that is a GPIM, which favours the GPIM",
                folds: FoldKind::After,
                opponents: &[GPIM],
                wanted: BETTER_THAN_ITS_LAW,
            },
        ],
        causes: &[OWN_LAW],
    },
    Example {
        name: "example5",
        title: "concrete in cyclic compression",
        paper: "MSE 2.79, its unit not stated.",
        cases: &[ExampleCase {
            specimen: "concrete",
            shows: "softening and permanent strain",
            folds: FoldKind::After,
            opponents: &[],
            wanted: &[
                paper(CaseFigure::UnseenMse, 2.79),
                ours(CaseFigure::Training, 0.5),
                ours(CaseFigure::Unseen, 2.0),
            ],
        }],
        causes: &[PENALTY],
    },
    Example {
        name: "example6",
        title: "rate-dependent actuators",
        paper: "on the synthetic set MSE 7e-5 in training and 0.002 on unseen data of other frequencies, 778 without \
                the rate; for the piezo set, in which 50 and 200 Hz were not trained on, no number is known to us. At \
                an output variance above 778 these are at most 0.03 % and 0.16 % of std.",
        cases: &[
            ExampleCase {
                specimen: "rate-dependent-actuator",
                shows: "the synthetic set, of a rate-dependent Prandtl-Ishlinskii law, trained on pure sines",
                folds: FoldKind::After,
                opponents: &[Opponent::WithoutRate],
                wanted: &[
                    paper(CaseFigure::Training, 0.03),
                    paper(CaseFigure::UnseenRecords(&["three tones"]), 0.16),
                    words(CaseFigure::TimesBelowTraining, 50.0),
                    ours(CaseFigure::UnseenRecords(&["25 Hz", "75 Hz"]), 0.5),
                ],
            },
            ExampleCase {
                specimen: "rate-dependent-actuator-tones",
                shows: "the same, trained on sums of tones too",
                folds: FoldKind::After,
                opponents: &[Opponent::WithoutRate],
                // The paper's figures, for a training set that is not the paper's.
                wanted: &[
                    ours(CaseFigure::Training, 0.03),
                    ours(CaseFigure::UnseenRecords(&["three tones"]), 0.16),
                    ours(CaseFigure::TimesBelowTraining, 50.0),
                    ours(CaseFigure::UnseenRecords(&["25 Hz", "75 Hz"]), 0.5),
                ],
            },
            ExampleCase {
                specimen: "piezo-actuator",
                shows: "the piezo set: 50 and 200 Hz unseen",
                folds: FoldKind::After,
                opponents: &[Opponent::WithoutRate],
                wanted: CLOSE,
            },
        ],
        causes: &[ELLIPSES],
    },
    Example {
        name: "example7",
        title: "magnetostrictive actuator from 10 to 300 Hz",
        paper: "excellent agreement with measured data (its abstract) at eight frequencies; no number for \
                this example is known to us.",
        cases: &[ExampleCase {
            specimen: "magnetostrictive-actuator",
            shows: "hysteresis between a lag and a resonance; 50 and 200 Hz unseen",
            folds: FoldKind::After,
            opponents: &[],
            wanted: CLOSE,
        }],
        causes: &[],
    },
];

/// Why unseen cycles of the joint have larger errors than trained ones.
const THIRD_CYCLES: &str = "Why the largest error on the unseen third cycles is above the paper's 3.2 %: the XPNN can represent all cycles, as the row fitted to the unseen rows too shows, and with the law of the specimen, which has a course of damage built in, the rows of the first two cycles are enough. For an XPNN they are not. A likely reason: the first cycle differs from the second by its first visit to a new drift and by damage together, and two cycles do not tell these apart. Separate runs, as medians of three seeds of the median of eight networks: 5.8 % with 20 stops instead of 4.4 %; 3.9 % with four cycles at each drift, of which three are trained. The median of the 24 best of 72 starts has 4.4 % as well. More starts and more stops do not help; more cycles help a little.";

const FORECAST: &str = "What a forecast beyond the trained damage can be: the last 30 % of the test reach a drift and a damage that no training row has. A network has learnt how the force falls with the slip of its stops up to the end of training, and nothing says how it falls beyond: its forecast is an extrapolation of that course, and networks that fit the training data equally well differ from each other there, as the ranges of the seeds show. The law of the specimen, Bouc-Wen with the degradation and pinching of Baber and Noori, is fitted to the same rows: it has the right course of damage built in, so that a few parameters, found from the beginning, are enough for all that follows. A forecast of a degrading specimen is as good as the law of damage that is assumed, not as good as the fit.";

/// Why an XPNN does not beat a GPIM on a GPIM.
const OWN_LAW: &str = "On a specimen that is itself a GPIM the GPIM is the law with unknown values, and its error is only that of their search. The XPNN approximates that law by a sum of tanh functions of stops, on the paths that it was trained on. That the XPNN beats the GPIM is therefore a property of the specimen: it holds for those outside the GPIM's class.";

/// Why other frequency content needs other training data.
const ELLIPSES: &str = "Why sines do not tell of other frequency content: on a sine of one amplitude x and x' lie on an ellipse, one for each frequency, so that every input x comes with one magnitude of the rate alone. Between and inside these ellipses nothing is trained. The sum of three tones passes through the inside all the time. Eight short records of other sums of tones beside a period of each sine bring the error down by an order of magnitude; the case rate-dependent-actuator-tones shows it. The paper's 0.16 % is not reached. Nor is its training error on sines: the table of what was tried has the training errors of weaker penalties and more iterations, and in a separate run the best of six networks of one seed with 20 stops and 40 tanh neurons ended at 0.039 %, that of the size used here at 0.046 %.";

/// Why the training error of concrete is above the target.
const PENALTY: &str = "Why the training error is above 0.5 %: the table of what was tried shows that weaker penalties bring it below, and that they raise the error on the folds. The strongest penalty is chosen by the folds.";
