import json
import pathlib
import shutil
import tempfile
import time
import urllib.request

import conftest
import lobe
import numpy as np
import pytest


def test_a_surface_of_arrays_becomes_tetrahedra():
    corners = np.array([[x, y, z] for z in (0, 0.1) for y in (0, 0.1) for x in (0, 0.1)])
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    mesh = lobe.mesh((corners, triangles), edge=0.03)
    assert mesh.volume == pytest.approx(1e-3, rel=1e-6)
    assert len(mesh.tets) > 50


def test_what_the_mesher_refuses_is_an_input_error(tmp_path):
    with pytest.raises(lobe.InputError, match="no such file|cannot|not"):
        lobe.mesh(tmp_path / "nothing.obj", edge=0.01)


def test_view_wants_a_scene():
    with pytest.raises(lobe.InputError, match="a file, a Scene or a World"):
        lobe.view(3)


def opened(scene, monkeypatch):
    """The scene that the server of view(scene) would read, and its dictionary."""
    commands = []
    with monkeypatch.context() as patch:
        patch.setattr(lobe.programs.subprocess, "Popen", lambda command: commands.append(command))
        lobe.view(scene, port=0)
    (command,) = commands
    file = pathlib.Path(command[2])
    assert "--temporary" in command
    read, document = lobe.read_scene(file), json.loads(file.read_text())
    read.regions  # which reads the mesh
    shutil.rmtree(file.parent)
    return read, document


def test_the_page_has_the_regions_of_the_scene(mesh, monkeypatch):
    codes = np.where(mesh.points[mesh.tets].mean(axis=1)[:, 0] < 0.05, 1, 2)
    frame = [{"model": "precomputed", "frame": "corotated", "where": {"all": True}}]
    scene = lobe.Scene(dict(conftest.BEAM, regions=frame), mesh, regions=codes)
    for what in (scene, lobe.World(scene)):
        read, document = opened(what, monkeypatch)
        assert (read.regions == codes).all()
        assert document["regions"][0]["frame"] == "corotated"


def test_the_page_has_the_regions_that_lobe_has_chosen(mesh, tip, monkeypatch):
    gesture = {"name": "poke", "where": {"vertices": tip}, "force": [0, 0, 0.001]}
    document = dict(conftest.BEAM, gravity=[0, 0, 0], regions={"auto": {"tolerance": 0.05, "gestures": [gesture]}})
    scene = lobe.Scene(document, mesh)
    read, _ = opened(scene, monkeypatch)
    assert (read.regions == scene.regions).all()


def test_the_page_finds_all_files_of_the_scene(mesh, tmp_path, monkeypatch):
    folder = tmp_path / "organ"
    folder.mkdir()
    for name in ("skin.obj", "tip.obj", "table.obj"):
        (folder / name).write_text("v 0 0 1\nv 1 0 1\nv 0 1 1\nv 0 0 2\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    mesh.save(folder / "beam.vtu")
    monkeypatch.chdir(tmp_path)
    shape = lambda name: {"mesh": {"file": name}}
    document = dict(conftest.BEAM, skin="skin.obj",
                    contact={"obstacles": [{"shape": shape("table.obj"), "position": [0, 0, 1]}]},
                    tools=[{"type": "probe", "shape": shape("tip.obj"), "path": [[0, 0, 0, 1], [1, 0, 0, 1]]}])
    (folder / "scene.json").write_text(json.dumps(dict(document, mesh="beam.vtu")))
    for scene, beam in ((lobe.Scene(document, mesh, folder="organ"), None),
                        (lobe.Scene(dict(document, mesh="beam.vtu"), folder="organ"), "beam.vtu"),
                        (lobe.read_scene("organ/scene.json"), "beam.vtu")):
        _, written = opened(scene, monkeypatch)
        assert written["skin"] == str(folder / "skin.obj")
        assert written["tools"][0]["shape"]["mesh"]["file"] == str(folder / "tip.obj")
        assert written["contact"]["obstacles"][0]["shape"]["mesh"]["file"] == str(folder / "table.obj")
        if beam:
            assert written["mesh"] == str(folder / beam)
    assert sorted(file.name for file in folder.iterdir()) == ["beam.vtu", "scene.json", "skin.obj", "table.obj", "tip.obj"]


def test_nothing_is_left_where_the_server_cannot_start(scene, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setattr(lobe.programs, "_program", lambda: str(tmp_path / "no program"))
    with pytest.raises(FileNotFoundError):
        lobe.view(scene)
    assert list(tmp_path.iterdir()) == []


def test_the_page_of_a_world_is_served(scene, monkeypatch, capfd, tmp_path):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    server = lobe.view(lobe.World(scene), port=0)
    try:
        address = ""
        for _ in range(1200):
            address += capfd.readouterr().out
            if "token" in address and "\n" in address:
                break
            assert server.poll() is None
            time.sleep(0.05)
        assert list(tmp_path.iterdir()) == []  # it has read what view() has written
        with urllib.request.urlopen(address.split()[0], timeout=60) as page:
            assert b"<html" in page.read()
    finally:
        server.terminate()
        assert server.wait(timeout=60) == 0


def test_a_modulus_is_found_again_from_a_solution(scene, tip):
    sag = lobe.solve(scene).u[tip[0], 2]
    point = scene.mesh.points[tip[0]]
    measured = [dict(quantity="displacement", at=point, component="z", value=1000 * sag, unit="mm")]
    guess = lobe.Scene(dict(conftest.BEAM, materials=[{"lame_lambda": 9e4, "lame_mu": 2.25e4, "density": 1000}]), scene.mesh)
    found = lobe.fit(guess, measured)
    assert found["ok"]
    (modulus,) = found["parameters"]
    assert modulus["start"] == pytest.approx(6.3e4)
    assert modulus["value"] == pytest.approx(2.8e4, rel=1e-5)
    assert found["measurements"][0]["computed"] == pytest.approx(sag, rel=1e-6)
    with pytest.raises(lobe.InputError, match="unknown key 'valeu'"):
        lobe.fit(guess, [dict(quantity="force", valeu=1)])
    with pytest.raises(lobe.InputError, match="is no parameter of the scene"):
        lobe.fit(guess, measured, parameters=["yung"])
    with pytest.raises(lobe.InputError, match="each scene needs one"):
        lobe.fit([guess, guess], [measured])


def test_a_modulus_is_found_again_from_a_motion(scene, tip):
    world = lobe.World(scene, precision="double")
    measured = []
    point = scene.mesh.points[tip[0]]
    for _ in range(5):
        world.advance(1 / 30)
        sag = world.snapshot().u[tip[0], 2]
        measured.append(
            dict(quantity="displacement", at=point, component="z", value=sag, unit="m", time=world.time))
    stiffer = [{"lame_lambda": 5e4, "lame_mu": 1.25e4, "density": 1000}]
    found = lobe.fit(lobe.Scene(dict(conftest.BEAM, materials=stiffer), scene.mesh), measured)
    assert found["ok"]
    assert found["parameters"][0]["value"] == pytest.approx(2.8e4, rel=2e-3)


def test_density_and_modulus_matter_alike_to_the_sag(scene):
    (weight,) = lobe.sensitivity(scene)
    by = {effect["of"]: effect["largest"] for effect in weight["effects"]}
    assert by["tissue.density + 10 %"] == pytest.approx(-by["tissue.young_modulus + 10 %"], rel=1e-5)
    assert by["tissue.density + 10 %"] > 0.05


def test_a_scene_at_rest_sags_into_the_shape_that_was_given(scene, tmp_path):
    told = lobe.rest(scene, tmp_path / "rest.json", tolerance=1e-7)
    assert told["ok"]
    assert told["largest_distance_loaded_m"] <= 1e-7
    rest = lobe.read_scene(tmp_path / "rest.json")
    back = rest.mesh.points + lobe.solve(rest).u - scene.mesh.points
    assert abs(back).max() <= 1e-7
    assert told["largest_distance_unloaded_m"] > 1e-4
    with pytest.raises(lobe.InputError, match="give the scene to write"):
        lobe.rest(scene, tmp_path / "rest.txt")
