#!/usr/bin/env python3
"""Compiles or runs every code block of the pages.

A comment above a block says what a test has to know, as GitHub does not show it:
  <!-- file: organ.json -->    the block is written to this file for the blocks that follow
  <!-- in: F& f, G& g -->      the C++ block stands in a function with these parameters
  <!-- options -->             commands that are too long for a test: their options are looked up in --help
  <!-- output -->              what the sh block above prints; numbers may differ by 2 %
Languages: cpp, c (compiled), python (run; python.md and learn.md have a test of their own), json (read;
as a scene, if it has "materials"), sh (run in a folder with data/ and examples/), csharp (compiled where Mono is),
text (a formula, a layout, an output).

blocks.py ROOT BIN CXX CC [INCLUDE]…: CXX "none" leaves the C++ blocks out
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

LANGUAGES = {"cpp", "c", "csharp", "python", "json", "sh", "text", "cmake"}
BLOCK = re.compile(r"(?:<!-- (?P<mark>[^\n]*?) -->\n+)?^```(?P<language>\w*)\n(?P<code>.*?)^```$", re.S | re.M)
NUMBER = re.compile(r"-?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?")
PRELUDE = "".join(f"#include <{header}>\n" for header in (
    "lobe/lobe.h", "lobe/live/session.h", "lobe/haptic/devices.h", "lobe/haptic/haptic_hand.h",
    "lobe/haptic/loop.h", "cstdio", "functional"))


def pages(root):
    found = [root / "README.md", root / "data" / "README.md"]
    return found + sorted((root / "docs").rglob("*.md"))


def blocks_of(page):
    text = page.read_text(encoding="utf-8")
    for match in BLOCK.finditer(text):
        line = text[: match.start("code")].count("\n") + 1
        yield line, match["language"], match["code"], match["mark"] or ""


class Tester:
    def __init__(self, root, binaries, cxx, cc, includes):
        self.root, self.binaries, self.cxx, self.cc, self.includes = root, binaries, cxx, cc, includes
        self.faults, self.count = [], 0
        self.cpp = []  # (place, code) of all pages, compiled at once
        self.help = {}

    def fault(self, place, text):
        self.faults.append(f"{place}: {text}")

    def page(self, page):
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            for name in ("data", "examples"):
                (folder / name).symlink_to(self.root / name)
            (folder / "build").mkdir()
            (folder / "build" / "bin").symlink_to(self.binaries)
            printed = ""
            for line, language, code, mark in blocks_of(page):
                place = f"{page.relative_to(self.root)}:{line}"
                self.count += 1
                if mark.startswith("file: "):
                    (folder / mark[6:]).write_text(code, encoding="utf-8")
                if language not in LANGUAGES:
                    self.fault(place, f'language "{language}", must be one of {", ".join(sorted(LANGUAGES))}')
                elif mark == "output":
                    self.compare(place, code, printed)
                elif mark == "options":
                    self.check_options(place, code)
                elif language == "cpp":
                    self.cpp.append((place, self.wrapped(code, mark, len(self.cpp))))
                elif language == "c":
                    self.compile(place, self.cc, ["-std=c99", "-x", "c"], code)
                elif language == "csharp":
                    self.compile_csharp(place, code, folder)
                elif language == "json":
                    self.read_json(place, code)
                elif language == "python" and page.name not in ("python.md", "learn.md"):
                    self.run(place, [sys.executable, "-c", code], folder)
                elif language == "sh":
                    printed = self.run(place, ["bash", "-euo", "pipefail", "-c", code], folder)

    def wrapped(self, code, mark, number):
        if "int main" in code:
            return code.replace("int main", f"int main_{number}")
        if mark.startswith("in: "):
            return f"void block_{number}({mark[4:]}) {{\n{code}}}\n"
        return code

    def compile(self, place, compiler, options, code):
        include = [flag for folder in self.includes for flag in ("-isystem", folder)]
        command = [compiler, "-fsyntax-only", "-Wall", "-Werror", *options, *include, "-"]
        done = subprocess.run(command, input=code, capture_output=True, text=True)
        if done.returncode:
            self.fault(place, done.stderr[:2000])

    def compile_csharp(self, place, code, folder):
        """As the body of a function, beside the classes of capi/csharp."""
        if not shutil.which("mcs"):
            return
        program = folder / "block.cs"
        program.write_text(f"using System;\nclass Block {{ static void Main() {{\n{code}}} }}\n", encoding="utf-8")
        sources = [str(file) for file in sorted((self.root / "capi" / "csharp").glob("*.cs"))]
        done = subprocess.run(["mcs", "-warnaserror", f"-out:{folder}/block.exe", str(program), *sources],
                              capture_output=True, text=True)
        if done.returncode:
            self.fault(place, done.stdout[-2000:] + done.stderr[-2000:])

    def compile_cpp(self):
        if self.cxx == "none":
            return
        text = PRELUDE + "".join(f'#line 1 "{place}"\n{code}' for place, code in self.cpp)
        options = ["-std=c++20", "-x", "c++", "-Wno-unused", "-Wno-return-type"]
        self.compile("C++ blocks", self.cxx, options, text)

    def read_json(self, place, code):
        whole = code if code.lstrip().startswith(("{", "[")) else "{" + code + "}"  # a few keys of an object
        try:
            json.loads(whole)
        except ValueError as error:
            self.fault(place, str(error))

    def run(self, place, command, folder):
        environment = dict(os.environ, PATH=f"{self.binaries}:{os.environ['PATH']}", LC_ALL="C.UTF-8")
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
        if done.returncode:
            self.fault(place, f"status {done.returncode}\n{done.stdout[-1000:]}{done.stderr[-1000:]}")
        return done.stdout + done.stderr

    def compare(self, place, expected, printed):
        """Each line that is shown, but for "…", was printed, with numbers within 2 %."""
        lines = printed.splitlines()
        for line in expected.splitlines():
            if line.strip() in ("", "…"):
                continue
            if not any(is_alike(line, other) for other in lines):
                self.fault(place, f"not printed: {line}\nprinted was:\n{printed[-1500:]}")
                return

    def help_of(self, words):
        key = " ".join(words)
        if key not in self.help:
            program = self.binaries / words[0]
            if not program.exists():
                return None
            done = subprocess.run([program, *words[1:], "--help"], capture_output=True, text=True)
            self.help[key] = done.stdout if done.returncode == 0 else ""
        return self.help[key]

    def has_target(self, name):
        lists = self.root.glob("*/**/CMakeLists.txt")
        return any(re.search(rf"add_executable\({re.escape(name)}\b", file.read_text(encoding="utf-8")) for file in lists)

    def check_script(self, place, words):
        """A script of the project is there and names its arguments."""
        script = self.root / words[0]
        text = script.read_text(encoding="utf-8") if script.is_file() else ""
        for word in words[1:]:
            if not re.search(rf"\b{re.escape(word)}\b", text):
                self.fault(place, f'{words[0]} does not name "{word}"')
        if not text:
            self.fault(place, f"{words[0]} is not there")

    def check_options(self, place, code):
        for command in code.replace("\\\n", " ").splitlines():
            words = command.replace("build/bin/", "").split("#")[0].split()
            while words and ("=" in words[0] or words[0] == "sudo"):
                words.pop(0)
            if not words:
                continue
            if words[0] == "./dev":
                if f"  {words[1]})" not in (self.root / "dev").read_text(encoding="utf-8"):
                    self.fault(place, f'./dev has no "{words[1]}"')
                continue
            if words[0].endswith(".sh"):
                self.check_script(place, words)
                continue
            if words[0] in ("apt", "cmake", "ctest", "cd", "git", "mpirun", "node", "ssh", "/usr/bin/python3"):
                continue
            plain = [w for w in words[1:3] if re.fullmatch(r"[a-z]+", w)]
            name = [words[0], *plain] if words[0] in ("lobe", "lobe-mesh-bench") else [words[0]]
            text = self.help_of(name) or self.help_of(name[:2])
            if text is None and self.has_target(words[0]):
                continue  # a program that is not built by default
            if not text:
                self.fault(place, f'"{" ".join(name)} --help" fails')
                continue
            for option in re.findall(r"(?<![\w-])--?[a-z][\w-]*", " ".join(words[1:])):
                if not re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])", text):
                    self.fault(place, f'"{" ".join(name)}" has no option {option}')


def is_alike(expected, printed):
    if NUMBER.sub("#", expected).split() != NUMBER.sub("#", printed).split():
        return False
    pairs = zip(NUMBER.findall(expected), NUMBER.findall(printed))
    values = [(float(a.replace(",", "")), float(b.replace(",", ""))) for a, b in pairs]
    return all(abs(a - b) <= 0.02 * max(abs(a), abs(b)) for a, b in values)


def main(arguments):
    root, binaries, cxx, cc = Path(arguments[0]).resolve(), Path(arguments[1]).resolve(), arguments[2], arguments[3]
    tester = Tester(root, binaries, cxx, cc, arguments[4:])
    for page in pages(root):
        tester.page(page)
    tester.compile_cpp()
    assert is_alike("a 1.00 b 2,000", "a  1.01 b 2010") and not is_alike("a 1", "a 2") and not is_alike("a 1", "b 1")
    print(f"{tester.count} blocks, {len(tester.faults)} faults")
    print("\n".join(tester.faults))
    return 1 if tester.faults or tester.count < 40 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
