"""Scenes of several bodies."""

import pickle

import lobe
import numpy as np
import pytest

SCENE = {
    "bodies": [
        {"name": "left", "mesh": "box.vtu"},
        {"name": "right", "mesh": "box.vtu", "position": [0.2, 0, 0]},
    ],
    "materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000}],
    "boundary": [{"fix": True, "where": {"all_of": [{"body": "left"}, {"box": {"min": [-1, -1, -1], "max": [1, 1, 0]}}]}}],
    "gravity": [0, 0, -9.81],
    "contact": {"self": True},
    "time": {"precision": "double"},
}


@pytest.fixture
def organs(tmp_path):
    lobe.box_mesh((0.1, 0.02, 0.02), (8, 2, 2)).save(tmp_path / "box.vtu")
    return lobe.Scene(SCENE, folder=tmp_path)


def test_a_world_tells_what_its_bodies_do(organs):
    world = lobe.World(organs)
    left, right = world.bodies
    assert (left["name"], right["name"]) == ("left", "right")
    assert left["mass"] == pytest.approx(0.04)
    assert np.allclose(right["centre"], [0.25, 0.01, 0.01])
    for _ in range(5):
        world.advance(0.01)
    left, right = world.bodies
    assert right["momentum"][2] == pytest.approx(-0.04 * 9.81 * 0.05, rel=0.02)
    assert right["kinetic"] > left["kinetic"]
    assert left["elastic"] + right["elastic"] == pytest.approx(world.energies()["elastic_nonlinear"])


def test_triangles_know_their_body(organs):
    surface = lobe.World(organs).snapshot().surface
    assert surface.body.dtype == np.uint8 and not surface.body.flags.writeable
    assert (surface.body == (surface.x[surface.triangles[:, 0], 0] > 0.15)).all()


def test_a_scene_of_one_mesh_has_no_bodies(scene):
    world = lobe.World(scene)
    assert world.bodies == []
    assert (world.snapshot().surface.body == 0).all()


def test_a_scene_of_bodies_survives_pickling_and_saving(organs, tmp_path):
    again = pickle.loads(pickle.dumps(organs))
    assert (again.mesh.points == organs.mesh.points).all()
    organs.save(tmp_path / "kept.json")
    assert (lobe.read_scene(tmp_path / "kept.json").mesh.tets == organs.mesh.tets).all()


def test_a_mesh_of_bodies_in_memory_keeps_them(organs, tmp_path):
    document = {key: SCENE[key] for key in ("materials", "boundary", "contact")}
    scene = lobe.Scene(document, organs.mesh)
    assert [body["name"] for body in lobe.World(scene).bodies] == ["left", "right"]
    again = pickle.loads(pickle.dumps(scene))
    assert [body["name"] for body in lobe.World(again).bodies] == ["left", "right"]
    scene.save(tmp_path / "other.json")
    kept = lobe.read_scene(tmp_path / "other.json")
    assert (kept.mesh.points == organs.mesh.points).all()
    assert [body["name"] for body in lobe.World(kept).bodies] == ["left", "right"]


def test_a_mesh_beside_bodies_is_refused(organs):
    with pytest.raises(lobe.InputError, match='the document has "bodies"'):
        lobe.Scene(SCENE, organs.mesh)
