"""Identification of hysteresis: measured input and output in, a small, stable model out.

`fit` identifies a `Model`, `validate` cross-validates it, `diagnose` determines properties of the hysteresis in data,
`cycles` reads energy, damping, coercive field and the like from its loops, and `compare` fits all models to the same
data. `restoring_force` computes the force of an element from the motion of a mass. `operators` and `classical` contain the
operators and laws of the field as functions on arrays, `specimens` gives synthetic data. `HysteresisRegressor` is the
estimator for scikit-learn and `RecordSplit` divides data for it; `plot` draws with matplotlib. The estimator and the plots
are imported when they are first used.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from hysid import _hysid, classical, operators
from hysid._comparison import Compared, Comparison, compare
from hysid._cycles import Cycles, cycles
from hysid._diagnosis import Diagnosis, Finding, ModelDiagnosis, diagnose
from hysid._fitting import fit
from hysid._model_set import ModelSet
from hysid._inverse import Inverse, Inversion, Inverted
from hysid._plan import Plan, Segment, plan
from hysid._progress import Progress
from hysid._record_split import RecordSplit
from hysid._residuals import ParameterInterval, ResidualFinding, Residuals
from hysid._restoring_force import RestoringForce, restoring_force
from hysid._summary import Summary
from hysid._validation import FoldErrors, Validation, validate
from hysid._warning import HysidWarning
from hysid._results import Errors, Member, Prediction
from hysid.model import Model, RecordState, Stepper, Tracking
from hysid.progress import tqdm_progress
from hysid.specimens import Records, Specimen, specimen, specimens

if TYPE_CHECKING:
    from hysid import plot
    from hysid._options import ModelName
    from hysid.regressor import HysteresisRegressor

__version__: str = _hysid.__version__

models: tuple[ModelName, ...] = tuple(_hysid.model_names())
"""Names of all models, the networks first; ``"auto"`` chooses among them."""

__all__ = [
    "Compared",
    "Comparison",
    "Cycles",
    "Diagnosis",
    "Errors",
    "Finding",
    "FoldErrors",
    "HysidWarning",
    "HysteresisRegressor",
    "Inverse",
    "Inversion",
    "Inverted",
    "Member",
    "Model",
    "ModelDiagnosis",
    "ModelSet",
    "ParameterInterval",
    "Plan",
    "Prediction",
    "Progress",
    "RecordSplit",
    "RecordState",
    "Records",
    "ResidualFinding",
    "Residuals",
    "RestoringForce",
    "Segment",
    "Specimen",
    "Stepper",
    "Tracking",
    "Summary",
    "Validation",
    "classical",
    "compare",
    "cycles",
    "diagnose",
    "fit",
    "models",
    "operators",
    "plan",
    "plot",
    "restoring_force",
    "specimen",
    "specimens",
    "tqdm_progress",
    "validate",
]


def __dir__() -> list[str]:
    return [*__all__, "__version__"]


def __getattr__(name: str) -> Any:
    # Scikit-learn and matplotlib take longer to import than all the rest.
    if name == "HysteresisRegressor":
        return import_module("hysid.regressor").HysteresisRegressor
    if name == "plot":
        return import_module("hysid.plot")
    raise AttributeError(f"module 'hysid' has no attribute {name!r}")
