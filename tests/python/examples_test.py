"""The examples run and print what they promise."""

import os
import pathlib
import re
import subprocess
import sys

import pytest

EXAMPLES = pathlib.Path(__file__).parents[2] / "examples" / "python"


@pytest.mark.parametrize(
    "name, printed",
    [
        ("01_gesture.py", r"lifted by 20 mm: 2\.97 N, the body has moved by up to 20\.\d mm"),
        ("02_cut.py", r"burnt: 41 tetrahedra, left: 2062; 27 of 682 triangles"),
        ("03_time_against_error.py", r"tolerance +5%: .* error [0-4]\.\d\d %"),
        ("04_fit_material.py", r"λ = (3[5-9]|4[0-5])\.\d kPa .* μ = (9|10)\.\d\d kPa"),
        ("05_learn.py", r"gain  2\.0: \d\d\.\d steps to the target\ngain 10\.0: 1\d\.\d steps"),
    ],
)
def test_example(name, printed, tmp_path):
    environment = dict(os.environ, MPLBACKEND="Agg", PYTHONIOENCODING="utf-8")
    done = subprocess.run([sys.executable, EXAMPLES / name], capture_output=True, encoding="utf-8", cwd=tmp_path,
                          env=environment)
    assert done.returncode == 0, done.stderr
    assert re.search(printed, done.stdout), done.stdout
    if name.startswith("03"):
        assert (tmp_path / "time_against_error.png").stat().st_size > 5000
