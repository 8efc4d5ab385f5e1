"""A model sample by sample, as in the loop of a controller: the same outputs, to the last bit, as a free run."""

import math

import numpy as np

import hysid


def report() -> str:
    x = np.array([0.01 * k * math.sin(0.1 * k) for k in range(600)])
    y = 0.2 * x + hysid.operators.stop(x, r=1.0)
    model = hysid.fit(x, y, model="prandtl-ishlinskii")

    free_run = model.simulate(x)
    stepper = model.stepper()
    same = sum(stepper.step(value) == expected for value, expected in zip(x, free_run, strict=True))
    return f"{same} of {len(x)} outputs are the same\nthe last is {free_run[-1]:.6f}\n"


if __name__ == "__main__":
    print(report(), end="")
