import lobe
import numpy as np
import pytest

BEAM = {
    "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000}],
    "boundary": [{"fix": True, "where": {"box": {"min": [-1, -1, -1], "max": [0, 1, 1]}}}],
    "gravity": [0, 0, -9.81],
    "time": {"damping": 20, "precision": "double"},
}


@pytest.fixture
def mesh():
    return lobe.box_mesh((0.1, 0.02, 0.02), (8, 2, 2))


@pytest.fixture
def scene(mesh):
    return lobe.Scene(BEAM, mesh)


@pytest.fixture
def tip(mesh):
    return np.flatnonzero(mesh.points[:, 0] > 0.099)
