"""A Bouc-Wen damper with known parameters, and the same parameters found again from its data."""

import math

import numpy as np

import hysid


def report() -> str:
    x = np.array([0.01 * k * math.sin(0.1 * k) for k in range(800)])
    # 5 kN/mm beside 100 kN/mm that yields at 2 mm.
    force = hysid.classical.bouc_wen(x, 5.0, 100.0, yield_displacement=2.0)

    model = hysid.fit(x, force, model="bouc-wen")
    law = model.description["law"]["bouc-wen"]
    return (
        f"stiffness after yielding {law['elastic_stiffness']:.3f} kN/mm\n"
        f"yield displacement {law['yield_displacement']:.3f} mm\n"
    )


if __name__ == "__main__":
    print(report(), end="")
