"""lobe-petsc as its users start it, under mpirun and alone."""

import json
import os
import pathlib
import signal
import subprocess
import time
import xml.etree.ElementTree as xml

import lobe
import numpy as np
import pytest

BIN = pathlib.Path(os.environ["LOBE_BIN_DIR"])
DATA = pathlib.Path(os.environ["LOBE_DATA_DIR"])
ENVIRONMENT = {
    **os.environ,
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
}


def command(ranks, scene, out, *more, program=("lobe", "solve", "--solver", "petsc")):
    start = [os.environ["LOBE_MPIRUN"], "--oversubscribe", "-n", str(ranks)] if ranks else []
    return [*start, str(BIN / program[0]), *program[1:], str(scene), "-o", str(out), *more]


def solve(ranks, scene, out, *more, **keywords):
    return subprocess.run(
        command(ranks, scene, out, *more, **keywords), env=ENVIRONMENT, capture_output=True, text=True, timeout=120
    )


def arrays(file):
    """The arrays of a .vtu as lobe writes it, whose data follow the mark of AppendedData."""
    data = file.read_bytes()
    begin = data.index(b"_", data.index(b"<AppendedData")) + 1
    head = xml.fromstring(data[:begin] + b"</AppendedData></VTKFile>")
    types = {"Float64": np.float64, "Float32": np.float32, "Int32": np.int32, "Int64": np.int64, "UInt8": np.uint8}
    found = {}
    for node in head.iter("DataArray"):
        at = begin + int(node.get("offset"))
        size = int(np.frombuffer(data, np.uint64, 1, at)[0])
        dtype = types[node.get("type")]
        values = np.frombuffer(data, dtype, size // np.dtype(dtype).itemsize, at + 8)
        found[node.get("Name")] = values.reshape(-1, int(node.get("NumberOfComponents")))
    return found


def displacement(out, vertices):
    """Pieces of a solution, put together by the number of each vertex."""
    u = np.full((vertices, 3), np.nan)
    index = xml.parse(out / "solution.pvtu")
    pieces = [piece.get("Source") for piece in index.iter("Piece")]
    named = {node.get("Name") for node in index.iter("PDataArray")} - {"Points"}
    for piece in pieces:
        mesh = arrays(out / piece)
        assert named == set(mesh) - {"Points", "connectivity", "offsets", "types"}
        u[mesh["vertex"][:, 0]] = mesh["displacement"]
    return u, len(pieces)


EVERY_SELECTOR = {
    "mesh": str(DATA / "meshes" / "liver_2k.vtu"),
    "volume_penalty": 1e4,
    "materials": [
        {"name": "hard", "lame_lambda": 8e4, "lame_mu": 2e4, "density": 1000, "element": "tetrahedron", "where": {"tetrahedra": list(range(0, 900, 3))}},
        {"name": "soft", "lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000, "element": "tetrahedron"},
    ],
    "regions": [
        {"model": "tensor-mass", "where": {"nearest": {"point": [0, 0, 0], "count": 300}}},
        {"model": "precomputed", "where": {"all_of": [{"nearest": {"point": [0.1, 0, 0], "count": 700}}, {"not": {"label": 77}}]}},
    ],
    "boundary": [
        {"fix": True, "where": {"nearest": {"point": [0, 0, 0], "count": 40}}},
        {"displacement": [0.002, None, None], "where": {"vertices": [5, 17, 101]}},
        {"force": [0, 0, 0.2], "where": {"any_of": [{"tetrahedra": [3, 1000, 2000]}, {"vertices": [200]}]}},
        {"traction": [0, -50, 0], "where": {"not": {"label": 77}}},
    ],
    "gravity": [0, 0, -9.81],
    "time": {"duration": 1},
}


def write(folder, scene):
    file = folder / "scene.json"
    file.write_text(json.dumps(scene))
    return file


@pytest.mark.parametrize("ranks,method", [(0, "auto"), (2, "gamg"), (3, "mumps"), (4, "hypre")])
def test_a_scene_with_every_selector_is_solved_as_by_the_serial_solver(tmp_path, ranks, method):
    scene = write(tmp_path, EVERY_SELECTOR)
    reference = lobe.solve(lobe.read_scene(scene)).u
    ended = solve(ranks, scene, tmp_path / "out", "--method", method, "--tolerance", "1e-12", "--json")
    assert ended.returncode == 0, ended.stderr
    report = json.loads(ended.stdout)
    u, pieces = displacement(tmp_path / "out", len(reference))
    assert pieces == report["ranks"] == max(1, ranks)
    used = ~np.isnan(u[:, 0])
    assert np.abs(u - reference)[used].max() < 1e-8 * np.abs(reference).max()
    assert not reference[~used].any()
    assert report == json.loads((tmp_path / "out" / "report.json").read_text())
    assert sum(report["tetrahedra_of_rank"]) == report["tetrahedra"]


def test_a_mesh_of_another_format_is_read_by_rank_0_and_said_so(tmp_path):
    mesh = lobe.read_mesh(DATA / "meshes" / "beam_1k.vtu")
    mesh.save(tmp_path / "beam.mesh")
    scene = DATA / "scenes" / "accuracy_beam.json"
    ended = solve(2, scene, tmp_path / "out", "--mesh", tmp_path / "beam.mesh")
    assert ended.returncode == 0, ended.stderr
    assert "rank 0 has read all of it" in ended.stderr
    reference = lobe.solve(lobe.read_scene(scene)).u
    u, _ = displacement(tmp_path / "out", len(reference))
    assert np.abs(u - reference).max() < 1e-7 * np.abs(reference).max()


@pytest.mark.parametrize(
    "change,message",
    [
        ({"mesh": "nowhere.vtu"}, "nowhere.vtu"),
        ({"boundary": [{"fix": True, "where": {"sphere": {"center": [9, 9, 9], "radius": 0.1}}}]}, "/boundary/0/where: selects no vertex; the mesh spans ["),
        ({"boundary": [{"fix": True, "where": {"vertices": [0, 99999]}}]}, "/boundary/0/where/vertices/1: 99999, must be from 0 to 538"),
        ({"boundary": [{"fix": True, "where": {"vertices": [0]}}]}, "a piece of 2103 tetrahedra is not held"),
        ({"materials": [{"lame_lambda": 1e4, "lame_mu": 1e4, "density": 1e3, "nodal_pressure": 1}]}, "/materials/0/nodal_pressure: is not available with --solver petsc"),
        ({"materials": [{"lame_lambda": 1e4, "lame_mu": 1e4, "density": 1e3, "where": {"tetrahedra": [0, 1]}}]}, "/materials: 2101 tetrahedra have no material (the first: 2)"),
        ({"unknown": 1}, 'unknown key "unknown"'),
    ],
)
def test_bad_input_is_told_once_and_leaves_nothing(tmp_path, change, message):
    ended = solve(3, write(tmp_path, {**EVERY_SELECTOR, "regions": [], **change}), tmp_path / "out")
    assert ended.returncode == 2
    assert ended.stderr.count(message) == 1, ended.stderr
    assert not (tmp_path / "out").exists()


def test_bad_options(tmp_path):
    scene = write(tmp_path, EVERY_SELECTOR)
    for options, message in [
        (["--method", "jacobi"], '--method: "jacobi", must be one of auto, gamg, hypre, mumps'),
        (["--tolerance", "-1"], "--tolerance"),
        (["--mesh", tmp_path / "nothing.vtu"], "nothing.vtu"),
    ]:
        ended = solve(0, scene, tmp_path / "out", *options, program=("lobe-petsc",))
        assert ended.returncode == 2 and message in ended.stderr
    assert not (tmp_path / "out").exists()


def test_a_truncated_mesh_is_refused(tmp_path):
    whole = (DATA / "meshes" / "liver_2k.vtu").read_bytes()
    (tmp_path / "cut.vtu").write_bytes(whole[:-20000])
    ended = solve(2, write(tmp_path, EVERY_SELECTOR), tmp_path / "out", "--mesh", tmp_path / "cut.vtu")
    assert ended.returncode == 2 and "cut.vtu" in ended.stderr and not (tmp_path / "out").exists()


def test_more_ranks_than_tetrahedra(tmp_path):
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], dtype=float)
    lobe.Mesh(corners, np.array([[0, 1, 2, 3], [1, 2, 3, 4]])).save(tmp_path / "two.vtu")
    ended = solve(3, write(tmp_path, EVERY_SELECTOR), tmp_path / "out", "--mesh", tmp_path / "two.vtu")
    assert ended.returncode == 2 and "2 tetrahedra for 3 ranks" in ended.stderr


def test_a_rank_that_dies_ends_the_job_and_leaves_no_solution(tmp_path):
    fine = tmp_path / "fine.vtu"
    subprocess.run([str(BIN / "lobe"), "refine", str(DATA / "meshes" / "liver_10k.vtu"), "-o", str(fine)], check=True)
    scene = write(tmp_path, {**EVERY_SELECTOR, "regions": []})
    line = command(2, scene, tmp_path / "out", "--mesh", fine, program=("lobe-petsc",))
    job = subprocess.Popen(line, env=ENVIRONMENT, stderr=subprocess.PIPE, text=True)
    ranks = []
    while len(ranks) < 2 and job.poll() is None:
        time.sleep(0.05)
        children = pathlib.Path(f"/proc/{job.pid}/task/{job.pid}/children").read_text().split()
        ranks = [int(c) for c in children if "lobe-petsc" in pathlib.Path(f"/proc/{c}/cmdline").read_text()]
    time.sleep(0.5)
    assert job.poll() is None
    os.kill(ranks[1], signal.SIGKILL)
    _, messages = job.communicate(timeout=60)
    assert job.returncode != 0 and "signal 9" in messages
    assert not (tmp_path / "out").exists()
