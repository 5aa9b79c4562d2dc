"""Every snippet of docs/python.md runs, one after the other."""

import pathlib
import re

PAGE = pathlib.Path(__file__).parents[2] / "docs" / "python.md"


def test_snippets(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = PAGE.read_text(encoding="utf-8")
    found = re.finditer(r"```python\n(.*?)```", text, re.S)
    snippets = [(text[: m.start()].count("\n") + 2, m.group(1)) for m in found]
    assert len(snippets) >= 6
    names = {}
    for line, code in snippets:
        exec(compile("\n" * (line - 1) + code, str(PAGE), "exec"), names)
