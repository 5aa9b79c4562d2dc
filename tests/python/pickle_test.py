import copy
import multiprocessing
import os
import pickle

import conftest
import lobe
import numpy as np
import pytest
import workers


def sent(value):
    return pickle.loads(pickle.dumps(value))


def is_same_mesh(a, b):
    return all((x == y).all() for x, y in ((a.points, b.points), (a.tets, b.tets), (a.labels, b.labels)))


@pytest.fixture
def hybrid(mesh):
    labelled = lobe.Mesh(mesh.points, mesh.tets, np.arange(len(mesh.tets)) % 3)
    codes = np.where(mesh.points[mesh.tets].mean(axis=1)[:, 0] < 0.05, 0, 2)
    return lobe.Scene(conftest.BEAM, labelled, regions=codes)


def test_a_mesh_is_the_same_after_pickle(mesh, tmp_path):
    labelled = lobe.Mesh(mesh.points, mesh.tets, np.arange(len(mesh.tets)))
    assert is_same_mesh(sent(labelled), labelled)
    fibres = '<DataArray type="Float64" Name="fibre" NumberOfComponents="3" format="ascii">' + "0 0.6 0.8 " + "</DataArray>"
    labelled.save(tmp_path / "plain.vtu")
    one = lobe.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]])
    (tmp_path / "fibres.vtu").write_text(
        '<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="4" NumberOfCells="1"><Points>'
        '<DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>'
        '<Cells><DataArray type="Int32" Name="connectivity" format="ascii">0 1 2 3</DataArray>'
        '<DataArray type="Int32" Name="offsets" format="ascii">4</DataArray>'
        '<DataArray type="UInt8" Name="types" format="ascii">10</DataArray></Cells>'
        f"<CellData>{fibres}</CellData></Piece></UnstructuredGrid></VTKFile>")
    fibrous = lobe.read_mesh(tmp_path / "fibres.vtu")
    assert is_same_mesh(fibrous, one)
    sent(fibrous).save(tmp_path / "again.vtu")
    fibrous.save(tmp_path / "before.vtu")
    assert (tmp_path / "again.vtu").read_bytes() == (tmp_path / "before.vtu").read_bytes()
    one.save(tmp_path / "none.vtu")
    assert (tmp_path / "again.vtu").read_bytes() != (tmp_path / "none.vtu").read_bytes()


def test_a_scene_is_the_same_after_pickle(hybrid):
    again = sent(hybrid)
    assert again.to_dict() == hybrid.to_dict() and again.check() == hybrid.check()
    assert (again.regions == hybrid.regions).all() and set(hybrid.regions) == {0, 2}
    assert is_same_mesh(again.mesh, hybrid.mesh)
    lobe.World(again).restore(lobe.World(hybrid).save())  # it refuses another setup


def test_regions_that_lobe_has_chosen_are_sent_with_the_scene(mesh, tip):
    gesture = {"name": "poke", "where": {"vertices": tip}, "force": [0, 0, 0.001]}
    document = dict(conftest.BEAM, gravity=[0, 0, 0], regions={"auto": {"tolerance": 0.05, "gestures": [gesture]}})
    scene = lobe.Scene(document, mesh)
    again = sent(scene)
    assert (again.regions == scene.regions).all()
    assert again.warnings == scene.warnings and again.check() == scene.check() and again.to_dict() == scene.to_dict()
    lobe.World(again).restore(lobe.World(scene).save())


def test_a_scene_of_a_file_finds_its_files_from_any_folder(mesh, tmp_path, monkeypatch):
    (tmp_path / "organ").mkdir()
    mesh.save(tmp_path / "organ" / "mesh.vtu")
    monkeypatch.chdir(tmp_path)
    scene = lobe.Scene(dict(conftest.BEAM, mesh="mesh.vtu"), folder="organ")
    document = scene.to_dict()
    monkeypatch.chdir("/")
    data = pickle.dumps(scene)
    assert is_same_mesh(scene.mesh, mesh)
    assert is_same_mesh(pickle.loads(data).mesh, mesh)
    assert is_same_mesh(lobe.Scene(document).mesh, mesh)


@pytest.mark.parametrize("precision", ["single", "double"])
def test_a_checkpoint_is_the_same_after_pickle_and_from_its_file(scene, precision, tmp_path):
    world = lobe.World(scene, precision=precision)
    world.remove_tets([3, 4])
    world.advance(0.05)
    kept = world.save()
    kept.save(tmp_path / "state")
    world.advance(0.05)
    expected = world.snapshot().u
    for again in (kept, sent(kept), copy.copy(kept), copy.deepcopy(kept), lobe.read_checkpoint(tmp_path / "state")):
        other = lobe.World(scene, precision=precision)
        other.restore(again)
        other.advance(0.05)
        assert (other.snapshot().u == expected).all()


def test_what_is_no_checkpoint_is_refused(scene, tmp_path):
    file = tmp_path / "state"
    with pytest.raises(lobe.InputError, match="state"):
        lobe.read_checkpoint(file)
    file.write_bytes(b"something else")
    with pytest.raises(lobe.InputError, match="is not the state of a world"):
        lobe.read_checkpoint(file)
    lobe.World(scene).save().save(file)
    data = file.read_bytes()
    file.write_bytes(data[:-1])
    with pytest.raises(lobe.InputError, match="cut off"):
        lobe.read_checkpoint(file)
    file.write_bytes(data[:100] + bytes([data[100] ^ 1]) + data[101:])
    with pytest.raises(lobe.InputError, match="damaged"):
        lobe.read_checkpoint(file)
    with pytest.raises(lobe.InputError, match="cannot be written"):
        lobe.World(scene).save().save(tmp_path / "none" / "state")


def test_what_does_not_change_is_its_own_copy(mesh, scene):
    for value in (mesh, scene, lobe.World(scene).save()):
        assert copy.copy(value) is value and copy.deepcopy([value])[0] is value


def test_workers_that_are_spawned_go_on_with_the_same_bits(hybrid, tmp_path):
    world = lobe.World(hybrid)
    hand = world.grasp(near=(0.1, 0.01, 0.01), radius=0.012)
    world.advance(0.02)
    hand.move_to(hand.position + [0, 0, 0.004])
    world.advance(0.02)
    kept = world.save()
    kept.save(tmp_path / "state")
    world.restore(kept)
    world.advance(0.1)
    expected = world.snapshot().u
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        results = [pool.apply_async(workers.go_on, (hybrid, kept)),
                   pool.apply_async(workers.go_on_from_file, (hybrid, os.fspath(tmp_path / "state")))]
        for u, regions in (result.get(timeout=120) for result in results):
            assert (u == expected).all() and (regions == hybrid.regions).all()


def test_a_world_is_not_pickled(scene):
    with pytest.raises(TypeError, match="World"):
        pickle.dumps(lobe.World(scene))
