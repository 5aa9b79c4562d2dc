"""Reads the committed tables of benchmarks/results, for claims.py."""
import csv
import sys
from pathlib import Path

ROOT = Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def rows(table, **wanted):
    """Rows of a table; `tets__ge=10000` and `tets__le` compare, other keys select."""
    with open(ROOT / "benchmarks" / "results" / f"{table}.csv", encoding="utf-8") as file:
        found = [{k: number(v) for k, v in row.items()} for row in csv.DictReader(file)]
    for key, value in wanted.items():
        name, _, test = key.partition("__")
        compare = {"": lambda a: a in value if isinstance(value, (list, tuple)) else a == value,
                   "ge": lambda a: a >= value, "le": lambda a: a <= value, "ne": lambda a: a != value}[test]
        found = [row for row in found if compare(row[name])]
    if not found:
        raise LookupError(f"{table}.csv has no row with {wanted}")
    return found


def low(found, column):
    return min(row[column] for row in found)


def high(found, column):
    return max(row[column] for row in found)


def span(found, column, digits=1, factor=1):
    """1.1 to 1.2, or 1.1 where both ends read alike."""
    a, b = (f"{factor * f(found, column):.{digits}f}" for f in (low, high))
    return a if a == b else f"{a} to {b}"


def ends(values, form):
    return " to ".join(format(end, form) for end in (min(values), max(values)))


def one(table, column, **wanted):
    found = rows(table, **wanted)
    if len(found) != 1:
        raise LookupError(f"{table}.csv has {len(found)} rows with {wanted}")
    return found[0][column]


def percent(value, digits=1):
    return f"{round(100 * value, digits) + 0.0:.{digits}f} %"  # no -0.0


def thousands(value):
    return f"{int(value):,}"


def corrected(**wanted):
    return rows("gestures", regions="selective-mass-corrected", tolerance=0.02, **wanted)


def alone(**wanted):
    return rows("gestures", regions="selective-mass-alone", tolerance=0.02, **wanted)


def kernel(name, column="ratio", **wanted):
    chosen = {"precision": "single", "threads": 1, "tets": 48000, "mesh": "cube"} | wanted
    return one("kernels", column, kernel=name, **chosen)
