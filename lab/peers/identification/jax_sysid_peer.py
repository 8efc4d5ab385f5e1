"""jax-sysid: a recurrent network in state-space form, by Adam and then L-BFGS."""

import contextlib
import io

import jax
import numpy as np
from case import Scaling, choose
from flax import linen
from jax_sysid.models import RNN

jax.config.update("jax_enable_x64", True)

FORMULATIONS = {"of u": False, "of u, its increment and direction": True}
CANDIDATES = [{"states": states, "seed": seed} for states in (4, 8) for seed in (0, 1)]
HIDDEN = 10
ADAM_EPOCHS, LBFGS_EPOCHS = 1000, 1000


class StateUpdate(linen.Module):
    states: int

    @linen.compact
    def __call__(self, x):
        x = linen.tanh(linen.Dense(features=HIDDEN)(x))
        return linen.Dense(features=self.states)(x)


class Output(linen.Module):
    @linen.compact
    def __call__(self, x):
        x = linen.tanh(linen.Dense(features=HIDDEN)(x))
        return linen.Dense(features=1)(x)


def identify(case, formulation):
    with_direction = FORMULATIONS[formulation]
    scaling = Scaling(case.x, case.y)

    def fit(x, y, candidate):
        states = candidate["states"]
        inputs = scaling.inputs(x, with_direction)

        class Update(StateUpdate):
            states: int = candidate["states"]

        model = RNN(states, 1, inputs.shape[1], FX=Update, FY=Output, x_scaling=0.1, seed=candidate["seed"])
        model.loss(rho_x0=1e-4, rho_th=1e-5)
        model.optimization(adam_eta=0.005, adam_epochs=ADAM_EPOCHS, lbfgs_epochs=LBFGS_EPOCHS, iprint=-1)
        with contextlib.redirect_stdout(io.StringIO()):
            model.fit(scaling.output(y)[:, None], inputs)
        return model

    def simulate(model, x, start):
        run, _ = model.predict(model.x0, scaling.inputs(x, with_direction))
        return scaling.back(np.asarray(run, dtype=float).ravel())

    model, best = choose(CANDIDATES, case, fit, simulate)
    note = f"{best['states']} states, of {len(CANDIDATES)} candidates"
    return note, simulate(model, case.x, case.y), simulate(model, case.test_x, case.test_start)
