"""Tracking with an actuator that has hysteresis: a PI controller, feedforward by the inverse of a model, and both."""

from math import exp, pi, sin, sqrt, tanh

import hysid

ROWS = 1000
STEP = 0.01  # sampling interval in s
LOW, HIGH = -0.7, 1.2  # limits of the current in A
# Gains in A/µm: of those with which the loop is stable at twice the largest slope of the actuator, 64 µm/A, the best
# for the PI controller alone.
KP, KI = 0.002, 0.007


class Actuator:
    """The law of the specimen terfenol-actuator: current in A to displacement in µm."""

    def __init__(self):
        self.plays = [0.0] * 11

    def step(self, current):
        left = 4.0 * tanh(1.35 * current - 0.35)
        right = 4.0 * tanh(1.25 * current + 0.05) + 0.15
        self.plays = [
            max(left - 0.25 * j, min(right + 0.25 * j, play)) for j, play in enumerate(self.plays)
        ]
        return 24.0 + sum(2.4 * exp(-0.55 * 0.25 * j) * play for j, play in enumerate(self.plays))


def reference(time):
    """The wanted displacement in µm."""
    return 30.0 + 19.0 * sin(2 * pi * 0.5 * time) + 9.0 * sin(2 * pi * 1.3 * time)


def drift(time):
    """What the model does not know: the actuator warms up and expands by 3 µm."""
    return 3.0 * (1.0 - exp(-time / 2.0))


def track(model, with_inverse, with_pi):
    """RMS tracking error in µm."""
    actuator = Actuator()
    inverse = model.inverse(limits=(LOW, HIGH))
    integral = error = late = squares = 0.0
    for k in range(ROWS):
        time = STEP * k
        wanted = reference(time)
        # The inverse follows its own input, not the corrected one, so that no measurement gets into its memory.
        # Its memory then differs from the actuator's by what the correction does: keep the correction small.
        current = inverse.step(wanted, time).input if with_inverse else 0.0
        if with_pi:
            total = integral + KI * late
            current += KP * late + total
            # Anti-windup: the integral stops while the current is beyond a limit and the error drives it further.
            if (current < HIGH or late < 0.0) and (current > LOW or late > 0.0):
                integral = total
        displacement = actuator.step(min(max(current, LOW), HIGH)) + drift(time)
        # The measurement arrives one sample late.
        late = error
        error = wanted - displacement
        squares += error * error
    return sqrt(squares / ROWS)


def report() -> str:
    train, _ = hysid.specimen("terfenol-actuator").data()
    model = hysid.fit(
        train.x, train.y, train.time, records=train.records, model="modified-prandtl-ishlinskii", seed=1
    )
    span = train.y.max() - train.y.min()

    text = "RMS tracking error in percent of the range\n"
    for controller, with_inverse, with_pi in (
        ("PI", False, True),
        ("inverse", True, False),
        ("inverse and PI", True, True),
    ):
        percent = 100 * track(model, with_inverse, with_pi) / span
        text += f"{controller:<14} {percent:5.2f}\n"
    return text


if __name__ == "__main__":
    print(report(), end="")
