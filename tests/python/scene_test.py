import json

import conftest
import lobe
import numpy as np
import pytest


def test_a_dictionary_and_its_text_are_the_same_scene(mesh):
    text = json.dumps(dict(conftest.BEAM, mesh="in memory"))
    assert lobe.Scene(text, mesh).to_dict() == lobe.Scene(conftest.BEAM, mesh).to_dict()


def test_the_dictionary_is_left_as_it_was(mesh):
    document = dict(conftest.BEAM)
    lobe.Scene(document, mesh)
    assert document == conftest.BEAM


def test_all_faults_are_named(mesh):
    with pytest.raises(lobe.InputError) as caught:
        lobe.Scene(dict(conftest.BEAM, gravty=[0, 0, 0], materials=[{"lame_lambda": 1}]), mesh)
    places = [place for place, _ in caught.value.faults]
    assert len(places) == 2 and any("materials" in place for place in places)


def test_a_selection_of_nothing_is_refused_when_it_is_needed(mesh):
    document = dict(conftest.BEAM, boundary=[{"fix": True, "where": {"vertices": [10**6]}}])
    with pytest.raises(lobe.InputError):
        lobe.World(lobe.Scene(document, mesh))


def test_regions_by_tetrahedron(mesh):
    codes = np.where(mesh.points[mesh.tets].mean(axis=1)[:, 0] < 0.05, 0, 2)
    scene = lobe.Scene(conftest.BEAM, mesh, regions=codes)
    assert (scene.regions == codes).all()
    for wrong in (codes[:-1], codes + 3, codes.astype(float)):
        with pytest.raises(lobe.InputError):
            lobe.Scene(conftest.BEAM, mesh, regions=wrong)


def test_linear_regions_are_wrong_where_they_turn(mesh):
    exact = lobe.solve(lobe.Scene(conftest.BEAM, mesh)).u
    linear = lobe.solve(lobe.Scene(conftest.BEAM, mesh, regions=np.zeros(len(mesh.tets), int))).u
    assert 0.01 < lobe.compare(mesh, linear, exact).l2 < 1
    assert lobe.compare(mesh, exact, exact).l2 == 0


def test_proposed_regions_keep_the_tolerance(mesh, tip):
    scene = lobe.Scene(dict(conftest.BEAM, gravity=[0, 0, 0]), mesh)
    force = [0, 0, 0.001]
    proposal = lobe.propose_regions(scene, 0.05, precomputed=False,
                                    gestures=[{"name": "poke", "vertices": tip, "force": force}])
    assert proposal.gestures[0].name == "poke" and proposal.gestures[0].measured <= 0.05
    assert len(proposal.regions) == len(mesh.tets)
    for gesture in ({"vertices": tip}, {"vertices": tip, "force": force, "at": 1}, "poke"):
        with pytest.raises(lobe.InputError) as caught:
            lobe.propose_regions(scene, gestures=[gesture])
        assert caught.value.place.startswith("gestures/0")


def test_a_run_writes_what_the_program_writes(mesh, tmp_path):
    document = dict(conftest.BEAM)
    document["time"] = dict(conftest.BEAM["time"], duration=0.1)
    report = lobe.run(lobe.Scene(document, mesh), tmp_path / "out")
    assert report["ok"]
    assert (tmp_path / "out" / "report.json").exists() and list((tmp_path / "out").glob("*.vtu"))


def test_tables_are_arrays(tmp_path):
    (tmp_path / "t.csv").write_text("name,us,ratio\nsvk,1.5,\nstep,3,2\n")
    table = lobe.read_table(tmp_path / "t.csv")
    assert table["name"].tolist() == ["svk", "step"]
    assert table["us"].sum() == 4.5 and np.isnan(table["ratio"][0])


def test_the_stub_names_what_there_is():
    import ast
    import pathlib

    interface = ast.parse((pathlib.Path(lobe.__file__).parent / "__init__.pyi").read_text())
    declared = {}
    for node in interface.body:
        if isinstance(node, ast.ClassDef):
            declared[node.name] = {m.name for m in node.body if isinstance(m, ast.FunctionDef)}
        elif isinstance(node, ast.FunctionDef):
            declared[node.name] = None
        elif isinstance(node, ast.AnnAssign):
            declared[node.target.id] = None
    assert set(lobe.__all__) <= set(declared)
    for name, members in declared.items():
        if name.startswith("_") and name != "__version__":
            continue
        assert hasattr(lobe, name), name
        if members is None or name == "InputError":
            continue
        public = {m for m in vars(getattr(lobe, name)) if not m.startswith("_")}
        assert public == {m for m in members if not m.startswith("_")}, name
