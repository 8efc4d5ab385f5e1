"""Whether an installed package works: `python installed.py` needs NumPy and nothing else. For the tests of wheels."""

import tempfile
from pathlib import Path

import numpy as np

import hysid

x = 3.0 * np.sin(np.linspace(0.0, 30.0, 900))
y = 0.2 * x + hysid.operators.stop(x, r=1.0)

model = hysid.fit(x, y, model="masing", thresholds=[0.5, 1.0, 2.0])
assert model.train.nrmse_std_percent < 0.1, model
assert np.abs(model.simulate(x) - y).max() < 0.01

network = hysid.fit(x, y, model="xpnn", stops=4, hidden=3, starts=1, epochs=20, threads=1)
assert network == hysid.fit(x, y, model="xpnn", stops=4, hidden=3, starts=1, epochs=20, threads=2)
assert network.train.nrmse_std_percent < 20.0, network

with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "model.json"
    network.save(path)
    assert hysid.Model.load(path) == network

print(f"hysid {hysid.__version__} of {hysid.__file__} works: {model!r}")
