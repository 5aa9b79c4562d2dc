import lobe
import numpy as np
import pytest


def test_arrays_come_back_and_inside_out_tetrahedra_are_turned():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
    mesh = lobe.Mesh(points, [[0, 2, 1, 3]], labels=[7])
    assert (mesh.points == points).all()
    assert mesh.volume == pytest.approx(1 / 6, rel=1e-15)
    assert sorted(mesh.tets[0]) == [0, 1, 2, 3]
    assert mesh.labels.tolist() == [7]


def test_views_are_read_only_share_memory_and_outlive_the_mesh():
    mesh = lobe.box_mesh((1, 1, 1), (2, 2, 2))
    view, again = mesh.points, mesh.points
    assert np.shares_memory(view, again)
    with pytest.raises(ValueError):
        view[0, 0] = 1
    with pytest.raises(ValueError):
        view.flags.writeable = True
    expected = view.copy()
    del mesh, again
    assert (view == expected).all()


def test_any_order_and_type_of_numbers_is_taken():
    mesh = lobe.box_mesh((1, 1, 1), (1, 1, 1))
    fortran = np.asfortranarray(mesh.points)
    every_other = np.repeat(mesh.tets, 2, axis=0)[::2].astype(np.uint64)
    same = lobe.Mesh(fortran.astype(np.float32), every_other)
    assert (same.points == mesh.points).all() and (same.tets == mesh.tets).all()


@pytest.mark.parametrize(
    "points, tets, place, text",
    [
        (np.zeros((4, 2)), [[0, 1, 2, 3]], "points", "(4, 2), must be (n, 3)"),
        (np.zeros((4, 3), complex), [[0, 1, 2, 3]], "points", "complex128"),
        (np.zeros((4, 3), object), [[0, 1, 2, 3]], "points", "object"),
        ("abc", [[0, 1, 2, 3]], "points", "must be (n, 3)"),
        (np.eye(4, 3), [[0.0, 1, 2, 3]], "tets", "whole numbers"),
        (np.eye(4, 3), [[0, 1, 2]], "tets", "(1, 3), must be (n, 4)"),
        (np.eye(4, 3), [[0, 1, 2, -3]], "tets", "-3 in row 0 is no index"),
        (np.eye(4, 3), [[0, 1, 2, 9]], "mesh", "9"),
        (np.full((4, 3), np.nan), [[0, 1, 2, 3]], "mesh", "nan"),
    ],
)
def test_what_is_no_mesh_is_refused_with_its_place(points, tets, place, text):
    with pytest.raises(lobe.InputError) as caught:
        lobe.Mesh(points, tets)
    assert caught.value.place.startswith(place)
    assert text in str(caught.value)


def test_a_file_has_the_same_numbers(tmp_path):
    mesh = lobe.box_mesh((0.3, 0.2, 0.1), (3, 2, 1))
    mesh.save(tmp_path / "box.vtu")
    same = lobe.read_mesh(tmp_path / "box.vtu")
    assert (same.points == mesh.points).all() and (same.tets == mesh.tets).all()
