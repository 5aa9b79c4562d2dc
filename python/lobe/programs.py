"""What lobe's programs do: meshing (GPL, a program of its own), the page, benchmarks."""

import csv
import json
import os
import pathlib
import shutil
import subprocess
import tempfile

import numpy

from ._lobe import InputError, Mesh, Scene, World, read_mesh


def _program():
    """The program `lobe`: $LOBE_PROGRAM, else the one of the build that this package is in, else the one on the path."""
    here = pathlib.Path(__file__).resolve().parent
    candidates = [os.environ.get("LOBE_PROGRAM"), here.parent.parent / "bin" / "lobe", shutil.which("lobe")]
    for candidate in candidates:
        if candidate and pathlib.Path(candidate).is_file():
            return str(candidate)
    raise FileNotFoundError("the program lobe: not found on the path, and LOBE_PROGRAM does not name it")


def _run(*arguments, allowed=(0,)):
    done = subprocess.run([_program(), *map(str, arguments)], capture_output=True, text=True)
    if done.returncode not in allowed:
        text = done.stderr.strip() or done.stdout.strip()
        raise InputError("lobe " + str(arguments[0]) + ": " + text)
    return done.stdout


def mesh(surface, *, edge, **options):
    """Tetrahedra inside a surface: a file, or a pair of points (n, 3) [m] and triangles (t, 3).

    edge: length of edges asked for [m]. Further options are those of `lobe mesh`: repair="wrap" is
    --repair wrap.
    """
    with tempfile.TemporaryDirectory() as folder:
        if not isinstance(surface, (str, os.PathLike)):
            points, triangles = surface
            file = pathlib.Path(folder) / "surface.obj"
            with open(file, "w", encoding="utf-8") as out:
                for x, y, z in numpy.asarray(points, dtype=float).reshape(-1, 3).tolist():
                    out.write(f"v {x!r} {y!r} {z!r}\n")
                for a, b, c in (numpy.asarray(triangles).reshape(-1, 3) + 1).tolist():
                    out.write(f"f {a} {b} {c}\n")
            surface = file
        result = pathlib.Path(folder) / "mesh.vtu"
        further = []
        for name, value in options.items():
            further += ["--" + name.replace("_", "-"), value]
        _run("mesh", surface, "--edge", edge, "-o", result, *further)
        return read_mesh(result)


def view(scene, *, port=None):
    """Opens the page in which an organ is held: of a scene (a file, or a Scene), or of a World.

    The page has a world of its own, which begins at time 0 with the scene that the given one was built from. Its
    regions are those of the Scene, also where lobe has chosen them. Returns the server's process: terminate() ends
    it.
    """
    arguments = [] if port is None else ["--port", str(port)]
    if isinstance(scene, World):
        scene = scene.scene
    if not isinstance(scene, Scene):
        if not isinstance(scene, (str, os.PathLike)):
            raise InputError("view: wants a file, a Scene or a World")
        return subprocess.Popen([_program(), "view", str(scene), *arguments])
    folder = pathlib.Path(tempfile.mkdtemp(prefix="lobe_view_"))
    try:
        scene.save(folder / "scene.json", chosen_regions=True)
        # The server removes the folder when it has read the scene.
        return subprocess.Popen([_program(), "view", str(folder / "scene.json"), "--temporary", *arguments])
    except BaseException:
        shutil.rmtree(folder)
        raise


def _scene_file(scene, folder, number):
    if not isinstance(scene, Scene):
        return pathlib.Path(scene)
    file = folder / f"scene_{number}.json"
    scene.save(file, chosen_regions=True)
    return file


def _table_file(data, folder, number):
    if isinstance(data, (str, os.PathLike)):
        return pathlib.Path(data)
    file = folder / f"data_{number}.csv"
    columns = ["quantity", "at", "component", "value", "unit", "sigma", "time"]
    with open(file, "w", newline="", encoding="utf-8") as out:
        writer = csv.DictWriter(out, columns, restval="")
        writer.writeheader()
        for row in data:
            unknown = sorted(set(row) - set(columns))
            if unknown:
                raise InputError(f"fit: a measurement has the unknown key {unknown[0]!r}; there are {', '.join(columns)}")
            at = row.get("at", "")
            at = " ".join(repr(float(x)) for x in at) if hasattr(at, "__len__") and not isinstance(at, str) else at
            writer.writerow(dict(row, at=at))
    return file


def fit(scene, data, *, parameters=("young_modulus",)):
    """Finds parameters of materials and attachments from measurements, as `lobe fit` does.

    scene: a Scene or a file; or a list of them, one for each load. data: for each scene a file (.csv), or a
    list of dicts with these keys:

    - quantity: "displacement", "force" or "frequency";
    - at: the point at rest [m]; the number of the entry of "boundary" or the name of a tool; the number of
      the frequency;
    - component: "x", "y", "z" or "length";
    - value, unit, if known sigma, and in motion time [s].

    parameters: their names, "liver.young_modulus" where there are several materials.

    Returns the dict that `lobe fit --json` prints: "ok", "parameters" (each with "name", "start", "value", "low",
    "high", "identifiable"), "misfit", "notes" and others.
    """
    if isinstance(parameters, str):
        parameters = [parameters]
    if not isinstance(scene, (list, tuple)):
        scene, data = [scene], [data]
    if len(scene) != len(data):
        raise InputError(f"fit: {len(scene)} scenes and {len(data)} tables; each scene needs one")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        arguments = [_scene_file(each, folder, i) for i, each in enumerate(scene)]
        for i, each in enumerate(data):
            arguments += ["--to", _table_file(each, folder, i)]
        return json.loads(_run("fit", *arguments, "--parameters", ",".join(parameters), "--json", allowed=(0, 1)))


def sensitivity(scene):
    """Which material, held part or model moves the sag and the forces of a scene most, as `lobe sensitivity` says.

    Returns a list of dicts, one for the weight and one for each grasp: "gesture", "largest_displacement_m",
    "force_N", "effects" (the largest first; each with "of", "displacement", "largest", "force", all relative) and others.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = _scene_file(scene, pathlib.Path(folder), 0)
        return json.loads(_run("sensitivity", file, "--json", allowed=(0, 1)))


def rest(scene, output, *, tolerance=1e-5):
    """Finds the unloaded shape of a body whose mesh is its shape under the loads, as `lobe rest` does.

    output: the scene to write (.json), with its mesh beside it; or the mesh alone (.vtu). tolerance: how near
    the loaded shape must come to the mesh [m].

    Returns the dict that `lobe rest --json` prints: "ok", "reason", "iterations",
    "largest_distance_loaded_m", "mean_distance_loaded_m", "largest_distance_unloaded_m", "files" and others.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = _scene_file(scene, pathlib.Path(folder), 0)
        arguments = ["-o", output, "--tolerance", repr(float(tolerance)), "--json"]
        return json.loads(_run("rest", file, *arguments, allowed=(0, 1)))


def read_table(file):
    """A table of a benchmark (CSV) as a structured array: table["ns_per_tet"]."""
    with open(file, newline="", encoding="utf-8") as text:
        rows = list(csv.reader(text))
    if not rows:
        raise InputError(f"{file}: is empty")
    names, values = rows[0], rows[1:]
    columns = []
    for i, name in enumerate(names):
        column = [row[i] if i < len(row) else "" for row in values]
        try:
            columns.append(numpy.array([float(cell) if cell else numpy.nan for cell in column]))
        except ValueError:
            columns.append(numpy.array(column))
    return numpy.rec.fromarrays(columns, names=names)


def bench(name, *arguments):
    """Runs `lobe bench NAME` with further arguments; returns its tables by name, as read_table() gives them."""
    with tempfile.TemporaryDirectory() as folder:
        _run("bench", name, *arguments, "-o", folder)
        return {file.stem: read_table(file) for file in sorted(pathlib.Path(folder).glob("*.csv"))}
