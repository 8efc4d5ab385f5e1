"""Types of the options of a fit, generated from the table in crates/hysid-core/src/options/table.rs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypeAlias, TypedDict

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

ModelName: TypeAlias = Literal[
    "auto",
    "pnn",
    "gpnn",
    "preisach-nn",
    "xpnn",
    "xpnn+",
    "masing",
    "prandtl-ishlinskii",
    "modified-prandtl-ishlinskii",
    "generalized-prandtl-ishlinskii",
    "rate-dependent-prandtl-ishlinskii",
    "dynamic-prandtl-ishlinskii",
    "preisach",
    "neuro-madelung",
    "bouc-wen",
    "peak-oriented",
    "menegotto-pinto",
    "ramberg-osgood",
    "jiles-atherton",
    "lugre",
    "duhem-nn",
    "hysteretic-oscillator",
    "hysteretic-state-space",
    "random-stops",
]
InitialStateName: TypeAlias = Literal[
    "virgin",
    "saturated-up",
    "saturated-down",
    "demagnetised",
    "periodic",
    "unknown",
    "free",
]
TrainingName: TypeAlias = Literal[
    "subgradient",
    "levenberg-marquardt",
    "hybrid",
    "genetic",
]
EffortName: TypeAlias = Literal[
    "quick",
    "normal",
    "thorough",
]
SignName: TypeAlias = Literal[
    "any",
    "non-negative",
    "non-positive",
]
ErrorName: TypeAlias = Literal[
    "row",
    "record",
]


class Options(TypedDict, total=False):
    """Options of a fit, as keywords of `hysid.fit`."""

    # Model
    model: ModelName | None
    members: int | None
    stops: int | None
    hidden: int | None
    relaxation: int | None
    no_deterioration: bool | None
    history: bool | None
    compression: float | None
    rate_compression: float | None

    # Training
    warm_up: int | None
    initial_state: InitialStateName | None
    known: int | str | None
    training: TrainingName | None
    effort: EffortName | None
    starts: int | None
    epochs: int | None
    population: int | None
    stall: int | None
    seed: int | None
    validation: float | None
    ridge: float | None
    decay: float | None

    # Classical models
    operators: int | None
    states: int | None
    modes: int | None
    thresholds: ArrayLike | None
    sign: SignName | None
    dead_zones: int | None
    free_weights: bool | None
    logarithmic_thresholds: bool | None
    degradation: bool | None
    asymmetric: bool | None
    differential_form: bool | None
    resonance: bool | None
    lagged_input: bool | None
    acceleration: bool | None
    odd: bool | None
    error: ErrorName | None
