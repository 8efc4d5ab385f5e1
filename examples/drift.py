"""An actuator whose gain drifts while its output is measured: the error of its model with and without corrections."""

from math import sqrt

import hysid

STEP = 1 / 3000  # sampling interval in s
ROWS = 180_000  # a minute
PERIOD = 600  # rows of a period of the voltage, a sum of tones at 5, 30 and 60 Hz


def gain(row):
    """Gain of the actuator, which falls by a tenth in a minute."""
    return 1.0 - 0.1 * row / ROWS


def adapt_and_correct(stepper, y):
    stepper.adapt(y)
    stepper.correct(y)


def report() -> str:
    train, test = hysid.specimen("rate-dependent-actuator").data()
    model = hysid.fit(
        train.x, train.y, train.time, records=train.records, model="rate-dependent-prandtl-ishlinskii", seed=1
    )
    tones = test.records == "three tones"
    voltage, displacement = test.x[tones][PERIOD:].tolist(), test.y[tones][PERIOD:].tolist()

    text = "RMS error in um over a minute\n"
    for name, take in (
        ("none", lambda stepper, y: None),
        ("adapt", lambda stepper, y: stepper.adapt(y)),
        ("correct", lambda stepper, y: stepper.correct(y)),
        ("adapt and correct", adapt_and_correct),
    ):
        stepper, squares, noise = model.stepper(), 0.0, 1
        for row in range(ROWS):
            place = row % PERIOD
            predicted = stepper.step(voltage[place], STEP * row)
            output = gain(row) * displacement[place]
            squares += (predicted - output) ** 2
            # The sensor has noise of up to 0.1 um.
            noise = (1_103_515_245 * noise + 12_345) % 2**31
            take(stepper, output + 0.1 * (2 * noise / 2**31 - 1))
        text += f"{name:<18} {sqrt(squares / ROWS):.3f}\n"
        found = stepper.tracking
    text += f"gain after the minute {found.gain:.3f}, offset {found.offset:.2f} um, "
    return text + f"recent residual {found.residual:.3f} um\n"


if __name__ == "__main__":
    print(report(), end="")
