"""The comparison reads the models that the program writes: `HYSID_PROGRAM=PATH python3 -m pytest lab/peers` (needs numpy)."""

import os

import hysid_program


def test_the_reference_in_numpy_computes_what_the_program_simulates(tmp_path):
    program = os.environ["HYSID_PROGRAM"]
    model = hysid_program.fitted_model(program, tmp_path)
    assert hysid_program.difference(program, model, tmp_path) < 1e-12
    # The peers have constants for these sizes.
    assert len(model["memory"]["stops"]) == hysid_program.reference.STOPS
    assert len(model["readout"]["hidden"]) == hysid_program.reference.HIDDEN
