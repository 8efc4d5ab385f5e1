"""Restoring forces from measured motion and force."""

import json

import numpy as np
import pytest

import hysid

MASS = 2.0


@pytest.fixture
def vibration():
    """Time, displacement, velocity, acceleration and restoring force of 2 kg on a spring and a damper."""
    time = np.arange(1500) * 0.005
    y = 0.02 * np.sin(6 * time) + 0.012 * np.sin(13 * time)
    v = 0.12 * np.cos(6 * time) + 0.156 * np.cos(13 * time)
    a = -0.72 * np.sin(6 * time) - 2.028 * np.sin(13 * time)
    return time, y, v, a, 500 * y + 4 * v


def test_the_force_is_that_of_the_spring_and_the_damper(vibration):
    time, y, v, a, r = vibration
    ground = 3 * np.sin(5 * time)
    measured = hysid.restoring_force(y, time, MASS, force=r + MASS * a, velocity=v, acceleration=a)
    assert np.allclose(measured.force, r, atol=1e-12) and np.array_equal(measured.velocity, v)
    assert measured.acceleration_filter is None and measured.velocity_filter is None
    pushed = r + MASS * (a + ground)
    relative = hysid.restoring_force(y, time, MASS, force=pushed, acceleration=a, base_acceleration=ground)
    absolute = hysid.restoring_force(y, time, MASS, force=pushed, absolute_acceleration=a + ground)
    computed = hysid.restoring_force(y, time, MASS, force=pushed, base_acceleration=ground)
    for found in (relative, absolute):
        assert np.allclose(found.force, r, atol=1e-12)
    assert np.nanmax(np.abs(computed.force - r)) < 1e-3 * r.std()
    degree, window = computed.acceleration_filter
    assert degree == 4 and np.isnan(computed.force).sum() == window - 1
    assert repr(relative).startswith("<restoring force in 1500 rows, standard deviation ")


def test_it_is_that_of_the_program(vibration, program, tmp_path):
    time, y, _, a, r = vibration
    u = r + MASS * a
    records = np.where(time < 4, "a", "b")
    rows = (f"{k},{t!r},{x!r},{f!r}\n" for k, t, x, f in zip(records, time.tolist(), y.tolist(), u.tolist(), strict=True))
    (tmp_path / "data.csv").write_text("record,t_s,y_m,u_N\n" + "".join(rows))
    said = program("restoring-force", "data.csv", "--mass", "2", "--json", folder=tmp_path)
    told = json.loads(said.stdout)
    found = hysid.restoring_force(y, time, MASS, force=u, records=records)
    assert [found.deviation, found.noise, found.smoothing] == pytest.approx(
        [told["standard_deviation"], told["noise"], told["smoothing"]]
    )
    written = np.genfromtxt(tmp_path / "data.force.csv", delimiter=",", skip_header=1)
    assert np.array_equal(written[:, -1], found.force, equal_nan=True)
    assert np.array_equal(written[:, -2], found.velocity)


def test_what_has_no_force_is_refused(vibration):
    time, y, v, a, r = vibration
    for arguments, words in [
        ({"mass": 0.0}, "above 0"),
        ({"window": 4}, "odd number"),
        ({"acceleration": a, "absolute_acceleration": a}, "one or the other"),
        ({"acceleration": a[1:]}, "acceleration: has 1499 values"),
        ({"velocity": v[1:]}, "1499 values"),
        ({"displacement": np.full_like(y, 3.0)}, "constant"),
        ({"displacement": np.where(y > 0.02, np.nan, y)}, "displacement: NaN"),
        ({"time": time[::-1]}, "does not come after"),
        ({"force": np.full_like(y, np.nan)}, "no row has all"),
    ]:
        with pytest.raises(ValueError, match=words):
            hysid.restoring_force(**{"displacement": y, "time": time, "mass": MASS, "force": r, **arguments})
    with pytest.raises(TypeError, match="mass"):
        hysid.restoring_force(y, time, "2 t")
