#!/usr/bin/env python3
"""ages.py finds tables that are older than their code, in a project made for that."""
import tempfile
from pathlib import Path

import ages

MEASURES = {"speed": ("lib/a", "bench/speed*")}


def put(root, name, text):
    file = root / name
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")


def found(root, known=()):
    return [fault.split(":")[0] for fault in ages.faults(root, MEASURES, set(known))]


def check(root):
    put(root, "lib/a/one.cpp", '#include "a.h"\nint one() { return f("text", \'"\', 1); }  // says one\n')
    put(root, "bench/speed.cpp", "int main() {}\n")
    put(root, "benchmarks/results/speed.csv", "ns\n1\n")
    put(root, "benchmarks/results/measured.csv", "table,measured,of_table,sources,of_sources\n")
    told = "speed.csv has changed; after measuring it say so"
    assert found(root) == [told]
    ages.note_measured(root, ["speed"], "2026-11-30", MEASURES)
    assert found(root) == [] and ages.days(root) == {"speed": "2026-11-30"}

    # Comments, texts, layout, includes and names of files are not code.
    put(root, "lib/a/one.cpp", '// One.\nint one()\n{\n  return f("other // text", \'"\', /* a */ 1);\n}\n')
    (root / "lib/a/one.cpp").rename(root / "lib/a/two.cpp")
    assert found(root) == []
    # What is known to be old, and is not, is taken off the list.
    assert found(root, ["speed"]) == ["speed.csv is no longer old"]

    put(root, "lib/a/two.cpp", 'int one() { return f("text", \'"\', 2); }\n')
    assert found(root) == ["speed.csv is older than lib/a"] and found(root, ["speed"]) == []
    try:
        ages.note_measured(root, ["speed"], "2026-12-01", MEASURES)
        raise AssertionError("the same table was taken for a new one")
    except SystemExit as refused:
        assert "measure it again" in str(refused)
    put(root, "benchmarks/results/speed.csv", "ns\n2\n")
    assert found(root) == [told]
    ages.note_measured(root, ["speed"], "2026-12-01", MEASURES)
    assert found(root) == []

    put(root, "lib/a/three.cpp", "int three() { return 3; }\n")
    put(root, "benchmarks/results/size.csv", "bytes\n1\n")
    assert [fault for fault in ages.faults(root, MEASURES, set())] == [
        "ages.py: MEASURES does not say which code size.csv measures",
        "speed.csv is older than lib/a: measure it again"]


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        check(Path(folder))
    print("done")
