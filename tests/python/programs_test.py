import time
import urllib.request

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


def test_the_page_of_a_world_is_served(scene, monkeypatch, capfd):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    server = lobe.view(lobe.World(scene), port=0)
    try:
        address = ""
        for _ in range(200):
            address += capfd.readouterr().out
            if "token" in address and "\n" in address:
                break
            assert server.poll() is None
            time.sleep(0.05)
        with urllib.request.urlopen(address.split()[0], timeout=20) as page:
            assert b"<html" in page.read()
    finally:
        server.terminate()
        assert server.wait(timeout=20) == 0
