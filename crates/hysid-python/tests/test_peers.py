"""The comparison with other programs in `benchmarks/peers` reads the models that the program writes today."""

from pathlib import Path

import pytest

PEERS = Path(__file__).resolve().parents[3] / "benchmarks" / "peers"


@pytest.fixture
def hysid_program(monkeypatch):
    """The part of the comparison that runs the program; it needs numpy only."""
    monkeypatch.syspath_prepend(PEERS)
    import hysid_program

    return hysid_program


def test_the_reference_in_numpy_computes_what_the_program_simulates(hysid_program, program, tmp_path):
    model = hysid_program.fitted_model(program.path, tmp_path)
    assert hysid_program.difference(program.path, model, tmp_path) < 1e-12
    # The peers have constants for these sizes.
    assert len(model["memory"]["stops"]) == hysid_program.reference.STOPS
    assert len(model["readout"]["hidden"]) == hysid_program.reference.HIDDEN
