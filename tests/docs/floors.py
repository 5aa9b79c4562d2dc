"""Refuses an include from a chapter of lib/lobe to one on a floor above it: floors.py PROJECT

docs/guide/develop.md lists the floors, from the lowest up, after the comment <!-- floors -->. Folders that it does not
list hold headers alone and stand where what they include lets them. `base` is lib/lobe itself, without lobe.h.
"""
import pathlib
import re
import sys


def floors(project):
    text = (project / "docs" / "guide" / "develop.md").read_text(encoding="utf-8")
    return re.search(r"<!-- floors -->\n`([^`]*)`", text)[1].split()


def chapter_of(header):
    return header.split("/")[0] if "/" in header else "base"


def upward(project):
    """Lines that say which file includes what is above it."""
    library, order = project / "lib" / "lobe", floors(project)
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


if __name__ == "__main__":
    sys.exit("\n".join(upward(pathlib.Path(sys.argv[1]))) or 0)
