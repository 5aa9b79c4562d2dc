"""Packs the package of a build or of an install tree as a wheel, without a network.

    /usr/bin/python3 python/make_wheel.py build/python OUT [VERSION]

The wheel is for this Python on any Linux whose libc is not older than that of its tag (PEP 600). It holds the shared
libraries that not every such Linux has, with their licences. Its distribution is lobe-sim, the module is lobe.
Needs Debian: ldd, objdump, strip, patchelf, dpkg.
"""

import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile

NAME = "lobe_sim"
METADATA = """Metadata-Version: 2.1
Name: lobe-sim
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
# What every Linux of a manylinux tag has: libraries, and the newest versions of their symbols by the libc of
# the tag.
EVERYWHERE = r"(libc|libm|libdl|librt|libpthread|libgcc_s|libstdc\+\+|libz|ld-linux-x86-64)\.so\..*"
NEWEST = {(2, 34): {"GLIBCXX": (3, 4, 29), "CXXABI": (1, 3, 13)}, (2, 35): {"GLIBCXX": (3, 4, 30), "CXXABI": (1, 3, 13)},
          (2, 36): {"GLIBCXX": (3, 4, 30), "CXXABI": (1, 3, 13)}}


def run(*command):
    return subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True).stdout


def newest_symbols(files):
    """The newest version of the symbols that files need, by their names: {"GLIBC": (2, 34), …}."""
    newest = {}
    for file in files:
        for name, version in re.findall(r"\b(GLIBC|GLIBCXX|CXXABI)_([0-9.]+)\b", run("objdump", "-p", file)):
            version = tuple(int(part) for part in version.split("."))
            newest[name] = max(newest.get(name, version), version)
    return newest


def platform_of(files):
    """The oldest manylinux tag whose systems have all symbols that the files need."""
    needed = newest_symbols(files)
    for libc, policy in NEWEST.items():
        if needed["GLIBC"] <= libc and all(needed.get(name, (0,)) <= version for name, version in policy.items()):
            return f"manylinux_{libc[0]}_{libc[1]}_{sysconfig.get_platform().split('-')[-1]}"
    raise SystemExit(f"needs symbols of {needed}, which no known manylinux tag has")


def add_licence(library, folder):
    """Debian's licence of the package that a library belongs to."""
    package = run("dpkg", "-S", library).split(":")[0]
    folder.mkdir(exist_ok=True)
    shutil.copy(f"/usr/share/doc/{package}/copyright", folder / f"{package}.txt")


def add_libraries(module, folder, licences):
    """Copies the libraries that not every Linux has to a folder, and lets the module load those. Returns them."""
    copies = []
    for name, path in re.findall(r"(\S+) => (/\S+)", run("ldd", module)):
        if re.fullmatch(EVERYWHERE, name):
            continue
        path = pathlib.Path(path).resolve()
        digest = hashlib.sha256(path.read_bytes()).hexdigest()[:8]  # no other package brings this one
        folder.mkdir(exist_ok=True)
        copy = folder / re.sub(r"\.so", f"-{digest}.so", name, count=1)
        shutil.copy(path, copy)
        add_licence(path, licences)
        run("patchelf", "--set-soname", copy.name, copy)
        run("patchelf", "--replace-needed", name, copy.name, module)
        copies.append(copy)
    run("patchelf", "--set-rpath", f"$ORIGIN/{os.path.relpath(folder, module.parent)}", module)
    return copies


def make_wheel(tree, out, version):
    """Returns the wheel's path. tree: the folder in which the folder lobe lies."""
    package = pathlib.Path(tree) / "lobe"
    modules = list(package.glob("_lobe*.so"))
    if len(modules) != 1:
        raise SystemExit(f"{package}: has {len(modules)} modules _lobe, expected one; build lobe-python first")
    pathlib.Path(out).mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder) / f"{NAME}-{version}"
        shutil.copytree(package, root / "lobe", ignore=shutil.ignore_patterns("__pycache__"))
        info = root / f"{NAME}-{version}.dist-info"
        info.mkdir()
        module = root / "lobe" / modules[0].name
        run("strip", "--strip-unneeded", module)  # before patchelf, whose result strip would damage
        libraries = add_libraries(module, root / f"{NAME}.libs", info / "licenses")
        cpython = f"cp{sys.version_info.major}{sys.version_info.minor}"
        tag = f"{cpython}-{cpython}-{platform_of([module, *libraries])}"
        python = f"{sys.version_info.major}.{sys.version_info.minor}"
        (info / "METADATA").write_text(METADATA.format(version=version, python=python), encoding="utf-8")
        (info / "WHEEL").write_text(WHEEL.format(tag=tag), encoding="utf-8")
        run(sys.executable, "-m", "wheel", "pack", root, "-d", out)
    return pathlib.Path(out) / f"{NAME}-{version}-{tag}.whl"


if __name__ == "__main__":
    if len(sys.argv) < 3:
        raise SystemExit(__doc__)
    print(make_wheel(sys.argv[1], sys.argv[2], sys.argv[3] if len(sys.argv) > 3 else "0.1.0"))
