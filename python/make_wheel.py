"""Packs the package of a build or of an install tree as a wheel, without a network.

    /usr/bin/python3 python/make_wheel.py build/python OUT [VERSION]

The wheel is for this Python and this Linux. Its module needs the shared libraries of Debian that it was linked to
(libtbb12, libmetis5, libpugixml1v5); none is in the wheel, so that it is no manylinux wheel.
"""

import pathlib
import shutil
import subprocess
import sys
import sysconfig
import tempfile

METADATA = """Metadata-Version: 2.1
Name: lobe
Version: {version}
Summary: Organs simulated in real time: hybrid linear / non-linear models
License: BSD-3-Clause
Requires-Python: =={python}.*
Requires-Dist: numpy
"""
WHEEL = """Wheel-Version: 1.0
Generator: make_wheel.py
Root-Is-Purelib: false
Tag: {tag}
"""


def make_wheel(tree, out, version):
    """Returns the wheel's path. tree: the folder in which the folder lobe lies."""
    package = pathlib.Path(tree) / "lobe"
    modules = list(package.glob("_lobe*.so"))
    if len(modules) != 1:
        raise SystemExit(f"{package}: has {len(modules)} modules _lobe, expected one; build lobe-python first")
    cpython = f"cp{sys.version_info.major}{sys.version_info.minor}"
    tag = f"{cpython}-{cpython}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
    pathlib.Path(out).mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder) / f"lobe-{version}"
        shutil.copytree(package, root / "lobe", ignore=shutil.ignore_patterns("__pycache__"))
        info = root / f"lobe-{version}.dist-info"
        info.mkdir()
        python = f"{sys.version_info.major}.{sys.version_info.minor}"
        (info / "METADATA").write_text(METADATA.format(version=version, python=python), encoding="utf-8")
        (info / "WHEEL").write_text(WHEEL.format(tag=tag), encoding="utf-8")
        subprocess.run([sys.executable, "-m", "wheel", "pack", root, "-d", out], check=True, stdout=subprocess.DEVNULL)
    return pathlib.Path(out) / f"lobe-{version}-{tag}.whl"


if __name__ == "__main__":
    if len(sys.argv) < 3:
        raise SystemExit(__doc__)
    print(make_wheel(sys.argv[1], sys.argv[2], sys.argv[3] if len(sys.argv) > 3 else "0.1.0"))
