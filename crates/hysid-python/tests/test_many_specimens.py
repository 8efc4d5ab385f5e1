"""The example of a study on several processes, and a search of scikit-learn on them."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

EXAMPLE = Path(__file__).parents[1] / "examples" / "many_specimens.py"


def run(tmp_path, name, *arguments):
    out = tmp_path / f"{name}.json"
    command = [sys.executable, EXAMPLE, "--specimens", "4", "--out", out, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(out.read_text()), done.stderr + done.stdout


@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGKILL")
def test_two_workers_of_which_one_is_killed_give_the_models_of_a_serial_run(tmp_path):
    alone, _ = run(tmp_path, "serial", "--serial")
    together, said = run(tmp_path, "together", "--workers", "2", "--kill-one")
    assert "killed the worker" in said
    assert "12 fits finished, 0 of them more than once" in said
    assert together == alone
    assert len({row["checksum"] for row in alone}) == len(alone) == 12


# A fold's largest amplitude may be one that was not trained on.
@pytest.mark.filterwarnings("ignore::hysid.HysidWarning")
def test_a_grid_search_runs_on_the_workers(spring_and_slider):
    import joblib
    from dask.distributed import Client, LocalCluster
    from sklearn.model_selection import GridSearchCV, GroupKFold

    from hysid import HysteresisRegressor

    x, y = spring_and_slider
    records = np.repeat(np.arange(4), len(x))
    scale = 1 + 0.1 * records
    table = np.column_stack([np.tile(x, 4) * scale, records])
    force = np.concatenate([y] * 4) * scale
    search = GridSearchCV(
        HysteresisRegressor(record=1, starts=1, epochs=5, random_state=0, threads=1),
        {"model": ["xpnn", "pnn"], "stops": [2, 4]},
        cv=GroupKFold(2),
        error_score="raise",
    )
    alone = search.fit(table, force, groups=records).cv_results_["mean_test_score"].copy()
    cluster = LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)
    with cluster, Client(cluster), joblib.parallel_backend("dask"):
        together = search.fit(table, force, groups=records).cv_results_["mean_test_score"]
    assert np.isfinite(alone).all() and np.array_equal(alone, together)
