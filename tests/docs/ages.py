#!/usr/bin/env python3
"""No table of benchmarks/results is older than the code that it measures, but for those that are known to be.

benchmarks/results/measured.csv has for each table the day on which it was measured, a digest of the table,
and one of each part of the sources that it measures (MEASURES) as they were then. Digests are of code alone:
comments, layout, texts of messages, and names and order of files do not count. They need no history, so a
clone without any can be tested.

A table fails if the code has changed since, and if it has changed itself without being told here.
KNOWN_TO_BE_OLD are those that were old when this test came; docs/benchmarks.md shows them. The list may only
shrink: a table that was measured again must be taken off it, and none is added.

ages.py ROOT                     says which tables are old, and which code has changed since
ages.py ROOT --measured TABLE…   after these tables were measured by a program of the present sources
"""
import csv
import datetime
import hashlib
import re
import sys
from pathlib import Path

# What the time of a step depends on.
STEP = ("lib/lobe/fem", "lib/lobe/region", "lib/lobe/body", "lib/lobe/time")
CUT = ("lib/lobe/cut", "lib/lobe/mesh", "lib/lobe/organ")
GESTURES = STEP + ("lib/lobe/lattice", "lib/lobe/condense", "lib/lobe/linearity", "benchmarks/gestures.cpp")
HAPTIC = ("lib/lobe/haptic", "lib/lobe/contact", "benchmarks/haptic*")
SCALPEL = ("lib/lobe/scalpel", "lib/lobe/mesh", "benchmarks/scalpel*")
ACCURACY = STEP + ("lib/lobe/solve", "lib/lobe/lattice", "lib/lobe/condense", "benchmarks/accuracy*")

MEASURES = {  # table: folders and files whose code decides its figures
    "accuracy": ACCURACY,
    "accuracy_undeclared": ACCURACY,
    "contact": ("lib/lobe/contact", "benchmarks/contact.cpp"),
    "cut": CUT + ("benchmarks/cut.cpp",),
    "elements": STEP + ("lib/lobe/solve", "benchmarks/elements.cpp", "benchmarks/element_frequency.cpp"),
    "features": STEP + ("lib/lobe/sim", "benchmarks/features.cpp"),
    "frames": STEP + ("lib/lobe/sim", "benchmarks/frames.cpp"),
    "frequencies": ("lib/lobe/lattice", "benchmarks/frequencies.cpp"),
    "gestures": GESTURES,
    "haptic": HAPTIC,
    "haptic_loop": HAPTIC,
    "huge": ("petsc/lobe_petsc", "benchmarks/huge.cpp"),
    "hybrid": STEP + ("lib/lobe/condense", "benchmarks/hybrid.cpp"),
    "kernels": ("lib/lobe/fem", "lib/lobe/region", "benchmarks/kernel*", "benchmarks/reference_kernel.cpp"),
    "kernels_quick": ("lib/lobe/fem", "lib/lobe/region", "benchmarks/kernel*", "benchmarks/reference_kernel.cpp"),
    "live": ("lib/lobe/live", "lib/lobe/snapshot", "benchmarks/live.cpp"),
    "meshing/fuzz": ("meshing/lobe_mesh", "meshing/programs/bench_fuzz.cpp"),
    "meshing/quality": ("meshing/lobe_mesh", "meshing/programs/bench_quality.cpp"),
    "own_steps": STEP + ("lib/lobe/contact", "benchmarks/own_steps.cpp"),
    "page": ("view/page", "view", "benchmarks/page.mjs"),
    "palpation": STEP + ("lib/lobe/contact", "benchmarks/palpation.cpp"),
    "realtime": STEP + ("lib/lobe/sim", "benchmarks/realtime.cpp"),
    "reduced": GESTURES,
    "reduced_setup": ("lib/lobe/lattice", "benchmarks/reduced_setup.cpp"),
    "resting": ("lib/lobe/region", "lib/lobe/time", "benchmarks/resting.cpp"),
    "scalpel": SCALPEL,
    "scalpel_beam": SCALPEL,
    "scalpel_beam_order": SCALPEL,
    "scalpel_limit": SCALPEL + ("lib/lobe/time",),
    "scalpel_precomputed": SCALPEL + ("lib/lobe/condense",),
    "silicone_beam_motion": ("lib/lobe/fem/prony.h", "benchmarks/validation/silicone*", "benchmarks/validation/swing.*"),
    "skin": ("lib/lobe/skin", "benchmarks/skin.cpp"),
    "soak_sessions": ("lib/lobe/live", "lib/lobe/run", "benchmarks/soak*"),
    "stress": STEP + CUT + ("benchmarks/stress",),
    "surface": ("lib/lobe/mesh", "benchmarks/surface.cpp"),
    "validation": STEP + ("lib/lobe/solve", "benchmarks/validation"),
}
WITHOUT_TIMES = {"validation"}  # the same program gives the same table
OTHER_PROGRAMS = {"peers"}  # dated on the pages; lobe's code does not change them

KNOWN_TO_BE_OLD = {
    "accuracy", "accuracy_undeclared", "frequencies",
    "gestures", "haptic", "haptic_loop", "huge", "hybrid", "live",
    "meshing/fuzz", "meshing/quality", "page", "palpation", "reduced", "reduced_setup",
    "scalpel", "scalpel_beam", "scalpel_beam_order", "scalpel_limit", "scalpel_precomputed",
    "soak_sessions", "stress"}

CODE = {".h", ".cpp", ".c", ".mjs", ".js"}
COMMENT_OR_TEXT = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])'", re.S)


def code_of(text):
    """A source without comments, texts, includes and layout."""
    text = re.sub(r"^#include [^\n]*$", "", text, flags=re.M)
    return re.sub(r"\s+", "", COMMENT_OR_TEXT.sub(lambda match: '"' if match[0][0] in "\"'" else " ", text))


def sha(text):
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def digest_of_sources(root, source):
    """Of the code of a folder, or of the files that a pattern names; empty if there are none."""
    path = root / source
    files = path.rglob("*") if path.is_dir() else path.parent.glob(path.name)
    digests = sorted(sha(code_of(file.read_text(encoding="utf-8"))) for file in files
                     if file.suffix in CODE and file.is_file() and "third_party" not in file.parts)
    return sha("".join(digests)) if digests else ""


def digest_of_table(root, table):
    return sha((root / "benchmarks" / "results" / f"{table}.csv").read_text(encoding="utf-8"))


def read(root):
    with open(root / "benchmarks" / "results" / "measured.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write(root, rows):
    with open(root / "benchmarks" / "results" / "measured.csv", "w", encoding="utf-8", newline="") as file:
        columns = ["table", "measured", "of_table", "sources", "of_sources"]
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(sorted(rows, key=lambda row: (row["table"], row["sources"])))


def tables(root):
    folder = root / "benchmarks" / "results"
    return {str(file.relative_to(folder).with_suffix("")) for file in folder.rglob("*.csv")} - {"measured"}


def changed(root, measures=None):
    """By table: which of its sources have other code than when it was measured."""
    measures = MEASURES if measures is None else measures
    then = {(row["table"], row["sources"]): row["of_sources"] for row in read(root)}
    found = {}
    for table, sources in measures.items():
        found[table] = [source for source in sources
                        if then.get((table, source)) != digest_of_sources(root, source)]
    return {table: sources for table, sources in found.items() if sources}


def faults(root, measures=None, known=None):
    measures, known = MEASURES if measures is None else measures, KNOWN_TO_BE_OLD if known is None else known
    of_table = {row["table"]: row["of_table"] for row in read(root)}
    old = changed(root, measures)
    for table in sorted(tables(root) - measures.keys() - OTHER_PROGRAMS):
        yield f"ages.py: MEASURES does not say which code {table}.csv measures"
    for table in sorted(measures):
        if not (root / "benchmarks" / "results" / f"{table}.csv").is_file():
            yield f"ages.py: there is no {table}.csv"
        elif of_table.get(table) != digest_of_table(root, table):
            yield (f"{table}.csv has changed; after measuring it say so: "
                   f"tests/docs/ages.py . --measured {table}")
        elif table in old and table not in known:
            yield f"{table}.csv is older than {', '.join(old[table])}: measure it again"
        elif table in known and table not in old:
            yield f"{table}.csv is no longer old: take it off KNOWN_TO_BE_OLD in ages.py"


def note_measured(root, names, today, measures=None):
    """Takes note of tables that were measured by a program of the present sources. A table of times that is
    the same as before was not measured again."""
    measures = MEASURES if measures is None else measures
    rows = read(root)
    before = {row["table"]: row["of_table"] for row in rows}
    for name in names:
        if name not in measures:
            sys.exit(f"{name}: there is no such table in MEASURES")
        if name not in WITHOUT_TIMES and before.get(name) == digest_of_table(root, name):
            sys.exit(f"{name}.csv is what it was before: measure it again first")
    rows = [row for row in rows if row["table"] not in names]
    for name in names:
        rows += [{"table": name, "measured": today, "of_table": digest_of_table(root, name), "sources": source,
                  "of_sources": digest_of_sources(root, source)} for source in measures[name]]
    write(root, rows)


def days(root):
    return {row["table"]: row["measured"] for row in read(root)}


def list_of_old(root):
    """The list of the page: tables that are older than the code that they measure, by the day."""
    by_day = {}
    for table, day in sorted(days(root).items()):
        if table in KNOWN_TO_BE_OLD:
            by_day.setdefault(day, []).append(f"`{table}`")
    return "\n".join(["| measured | tables |", "|---|---|"] +
                     [f"| {day} | {', '.join(found)} |" for day, found in sorted(by_day.items())])


def main(root, arguments):
    if arguments[:1] == ["--measured"]:
        return note_measured(root, arguments[1:], datetime.date.today().isoformat())
    for table, sources in changed(root).items():
        print(f"{table}.csv, {days(root).get(table)}: since then {', '.join(sources)}")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), sys.argv[2:]))
