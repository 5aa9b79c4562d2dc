"""The wheel is packed, and installed in an environment of its own without a network. There it loads its own copies
of libraries that are no part of every Linux, and needs no newer libc than its tag says."""

import os
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
USE = """
import lobe, pathlib, sys
assert pathlib.Path(lobe.__file__).is_relative_to(sys.prefix), lobe.__file__
mesh = lobe.box_mesh((0.1, 0.02, 0.02), (8, 2, 2))
scene = lobe.Scene({"materials": [{"lame_lambda": 4e4, "lame_mu": 1e4, "density": 1000}], "gravity": [0, 0, -9.81],
                    "boundary": [{"fix": True, "where": {"vertices": [0, 9, 18, 27]}}]}, mesh)
world = lobe.World(scene)
assert world.advance(0.01).ok and abs(world.snapshot().u).max() > 0
loaded = {line.split()[-1] for line in open("/proc/self/maps") if ".so" in line}
for name in "libtbb", "libmetis", "libpugixml":
    found = [path for path in loaded if pathlib.Path(path).name.startswith(name)]
    assert found and all(path.startswith(sys.prefix) for path in found), (name, found)
print(lobe.__version__)
"""


def test_a_wheel_is_installed_without_a_network(tmp_path):
    environment = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "PYTHONDONTWRITEBYTECODE")}

    def run(*command):
        return subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout.strip()

    maker = HERE.parents[1] / "python" / "make_wheel.py"
    wheel = run(sys.executable, maker, os.environ["PYTHONPATH"].split(":")[0], tmp_path, os.environ["LOBE_VERSION"])
    # numpy is Debian's.
    run(sys.executable, "-m", "venv", "--without-pip", "--system-site-packages", tmp_path / "venv")
    python = tmp_path / "venv" / "bin" / "python"
    run(sys.executable, "-m", "pip", "--python", python, "install", "--no-index", "--no-deps", wheel)
    assert run(python, "-c", USE) == os.environ["LOBE_VERSION"]

    tag = tuple(int(number) for number in re.search(r"manylinux_(\d+)_(\d+)_x86_64\.whl$", wheel).groups())
    binaries = list((tmp_path / "venv").rglob("*.so*"))
    assert len(binaries) == 4  # the module and three libraries
    for binary in binaries:
        symbols = re.findall(r"\bGLIBC_(\d+)\.(\d+)", run("readelf", "--version-info", binary))
        assert symbols and max((int(a), int(b)) for a, b in symbols) <= tag, binary
    licences = {path.stem for path in (tmp_path / "venv").rglob("licenses/*.txt")}
    assert licences == {"libtbb12", "libmetis5", "libpugixml1v5"}
