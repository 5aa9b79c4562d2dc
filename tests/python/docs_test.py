"""Every snippet of docs/python.md and docs/learn.md runs, one after the other."""

import pathlib
import re

import pytest

DOCS = pathlib.Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("page, least", [("python.md", 6), ("learn.md", 3)])
def test_snippets(page, least, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "data").symlink_to(DOCS.parent / "data")
    text = (DOCS / page).read_text(encoding="utf-8")
    found = re.finditer(r"```python\n(.*?)```", text, re.S)
    snippets = [(text[: m.start()].count("\n") + 2, m.group(1)) for m in found]
    assert len(snippets) >= least
    names = {}
    for line, code in snippets:
        exec(compile("\n" * (line - 1) + code, str(DOCS / page), "exec"), names)
