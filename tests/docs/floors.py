"""Refuses an include from a chapter of lib/lobe to one on a floor above it, names of kinds of regions in the
chapters that play time, revision numbers that are written elsewhere than where an edit is followed, a World
that does more than play, and mutable members of contact and skin: floors.py PROJECT

The floors are the list `chapters` in lib/lobe/CMakeLists.txt, from the lowest up; folders that it does not
have hold headers alone and stand where what they include lets them. `base` is lib/lobe itself, without
lobe.h. docs/guide/develop.md, where it is there, shows the same list. Kinds of regions may be named in
comments of `sim` and `time` alone: what these do with a region is what they do with any.
"""
import pathlib
import re
import sys


def floors(library):
    text = (library / "CMakeLists.txt").read_text()
    return re.search(r"set\(chapters ([^)]*)\)", text)[1].split()


def chapter_of(header):
    return header.split("/")[0] if "/" in header else "base"


def upward(library):
    """Lines that say which file includes what is above it."""
    order = floors(library)
    found = []
    for file in sorted(p for p in library.rglob("*") if p.suffix in (".h", ".cpp")):
        name = str(file.relative_to(library))
        own = chapter_of(name)
        if own not in order or name == "lobe.h":
            continue
        for header in re.findall(r'^#include "lobe/([^"]+)"', file.read_text(), re.M):
            other = chapter_of(header)
            if other in order and order.index(other) > order.index(own):
                found.append(f"{name}: includes {header}, but {other} is above {own}")
    return found


KINDS = re.compile(r"RegionModel::|[A-Z]\w+Region\b|"
                   r"(?i:tensor_?mass|precomputed|reduced|corotat|condens|expan[ds]|lattice|embed)")


def named_kinds(library):
    """Lines of the chapters that play time which name a kind of region outside of a comment."""
    found = []
    for file in sorted(p for chapter in ("sim", "time") for p in (library / chapter).glob("*.[hc]*")):
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
            kind = KINDS.search(line.split("//")[0])
            if kind:
                found.append(f"{file.relative_to(library)}:{number}: names a kind of region, {kind[0]}")
    return found


# Who writes revision numbers: what follows edits; and motion and masses of vertices, for steps and for states
# that are given.
WRITERS = ("organ/follow.cpp", "time/dynamics.cpp", "time/inertia.cpp")
WRITES = re.compile(r"(?:\+\+|--)\s*[\w.>()-]*\brevisions\.\w+|"
                    r"(?:\.revisions|\brevisions\.\w+)\s*(?:[+-]?=(?!=)|\+\+|--)")


def written_revisions(library):
    """Lines elsewhere that write a revision number."""
    found = []
    for file in sorted(p for p in library.rglob("*") if p.suffix in (".h", ".cpp")):
        name = str(file.relative_to(library))
        if name in WRITERS:
            continue
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
            if WRITES.search(line.split("//")[0]):
                found.append(f"{name}:{number}: writes revisions; make it a Change that organ/follow.cpp follows")
    return found


MOST_FUNCTIONS = 45  # of World


def functions_of(name, header):
    """The declarations of functions in a class, without its friends."""
    text = re.sub(r"//[^\n]*", "", header)
    depth, own = 0, ""
    for letter in text[text.index("{", text.index(f"class {name} {{")):]:
        depth += (letter == "{") - (letter == "}")
        if depth == 0:
            break
        if depth == 1 and letter != "{":
            own += ";" if letter == "}" else letter
    statements = [part.strip() for part in re.split(r";|public:|private:", own)]
    return [part for part in statements if "(" in part and not part.startswith("friend")]


def misshapen(library):
    """Lines on a World that does more than play, and on mutable members of contact and skin."""
    found = []
    world = library / "sim" / "world.h"
    if world.exists():
        count = len(functions_of("World", world.read_text(encoding="utf-8")))
        if count > MOST_FUNCTIONS:
            found.append(f"sim/world.h: World has {count} functions, must have at most {MOST_FUNCTIONS}")
    for file in sorted(p for chapter in ("contact", "skin") for p in (library / chapter).glob("*.h")):
        for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
            if re.search(r"\bmutable\b", line.split("//")[0]):
                found.append(f"{file.relative_to(library)}:{number}: is mutable: keep rest data, state and scratch apart")
    return found


def outdated(project):
    """A line if the page shows another list."""
    page = project / "docs" / "guide" / "develop.md"
    shown = f"`{' '.join(floors(project / 'lib' / 'lobe'))}`"
    if page.exists() and shown not in page.read_text(encoding="utf-8"):
        return [f"{page.name}: does not show the floors {shown}"]
    return []


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1])
    library = root / "lib" / "lobe"
    faults = (upward(library) + named_kinds(library) + written_revisions(library) + misshapen(library) +
              outdated(root))
    sys.exit("\n".join(faults) or 0)
