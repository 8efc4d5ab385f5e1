"""SysIdentPy: polynomial NARX, its terms chosen by FROLS."""

import itertools
import warnings

import numpy as np
from case import Scaling, choose
from sysidentpy.basis_function import Polynomial
from sysidentpy.model_structure_selection import FROLS
from sysidentpy.parameter_estimation import LeastSquares

CANDIDATES = [
    {"degree": degree, "lags": lags, "terms": terms}
    for degree, lags, terms in itertools.product((2, 3), (1, 2), (8, 16, 30))
]
FORMULATIONS = {"polynomial of u": False, "polynomial of u, its increment and direction": True}


def identify(case, formulation):
    warnings.simplefilter("ignore")
    with_direction = FORMULATIONS[formulation]
    scaling = Scaling(case.x, case.y)

    def fit(x, y, candidate):
        inputs = scaling.inputs(x, with_direction)
        lags = list(range(1, candidate["lags"] + 1))
        model = FROLS(
            order_selection=False,
            n_terms=candidate["terms"],
            ylag=lags,
            xlag=[lags] * inputs.shape[1] if with_direction else lags,
            estimator=LeastSquares(),
            basis_function=Polynomial(degree=candidate["degree"]),
        )
        # A row's own input is known when its output is asked for; the package's lags begin at 1.
        model.fit(X=ahead(inputs), y=scaling.output(y)[:, None])
        return model

    def simulate(model, x, start):
        with np.errstate(all="ignore"):
            inputs = ahead(scaling.inputs(x, with_direction))
            run = model.predict(X=inputs, y=scaling.output(start[: model.max_lag])[:, None])
        return scaling.back(np.asarray(run, dtype=float).ravel())

    model, best = choose(CANDIDATES, case, fit, simulate)
    note = f"degree {best['degree']}, {best['lags']} lags, {best['terms']} terms, of {len(CANDIDATES)} candidates"
    return note, simulate(model, case.x, case.y), simulate(model, case.test_x, case.test_start)


def ahead(inputs):
    """Each row with the inputs of the next, so that lag 1 is the present."""
    return np.concatenate([inputs[1:], inputs[-1:]])
