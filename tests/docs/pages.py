#!/usr/bin/env python3
"""What the pages promise of themselves: short pages and paragraphs, a true table of folders, one glossary, figures with
commands; comments that are not too wide; and folders that do not need each other.

pages.py ROOT
"""
import graphlib
import re
import sys
from pathlib import Path

LONGEST = 80  # words of a paragraph, a list item or a table's cell
LARGEST = 2500  # words of a page; larger ones are divided by chapter
WIDEST = 110  # columns of a comment
SOURCES = "benchmarks capi cholmod cmake data docs examples lib meshing paper petsc pictures python tests view".split()
MARKS = {".h": "//", ".cpp": "//", ".c": "//", ".js": "//", ".mjs": "//", ".py": "#", ".cmake": "#", ".sh": "#", ".txt": "#"}


def documents(root):
    return [root / "README.md", root / "data" / "README.md"] + sorted((root / "docs").rglob("*.md"))


def paragraphs(text):
    """Paragraphs, list items and cells of tables, without code blocks and comments."""
    text = re.sub(r"<!--.*?-->", "", text, flags=re.S)
    text = re.sub(r"^```.*?^```$", "\n", text, flags=re.S | re.M)
    for part in re.split(r"\n\s*\n|\n(?=\s*(?:[-*] |\d+\. ))", text):
        if part.lstrip().startswith("|"):
            yield from (cell for row in part.splitlines() for cell in row.split("|"))
        else:
            yield part


def words(text):
    """Words of a text; a formula counts as one."""
    text = re.sub(r"\$\$.*?\$\$", " formula ", text, flags=re.S)
    text = re.sub(r"\$[^$\n]+\$", "formula", text)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    return len([w for w in text.split() if re.search(r"\w", w)])


def long_paragraphs(root):
    for page in documents(root):
        for part in paragraphs(page.read_text(encoding="utf-8")):
            if words(part) > LONGEST:
                yield f"{page.relative_to(root)}: {words(part)} words: {' '.join(part.split())[:70]} …"


def large_pages(root):
    for page in documents(root):
        count = words(re.sub(r"<!--.*?-->", "", page.read_text(encoding="utf-8"), flags=re.S))
        if count > LARGEST:
            yield f"{page.relative_to(root)}: {count} words, must be at most {LARGEST}: divide it by chapter"


def anchor(heading):
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def expanded(pattern):
    """lib/{a,b}.* becomes lib/a.*, lib/b.*"""
    match = re.search(r"\{([^}]*)\}", pattern)
    if not match:
        return [pattern]
    return [p for part in match[1].split(",") for p in expanded(pattern[: match.start()] + part + pattern[match.end():])]


def theory(root):
    """theory.md with its chapters."""
    chapters = sorted((root / "docs" / "theory").glob("*.md"))
    return "\n".join(page.read_text(encoding="utf-8") for page in [root / "docs" / "theory.md", *chapters])


def sections_of(text):
    return re.findall(r"^##? (\d+ .*)$", text, re.M)


def theory_table(root):
    text = (root / "docs" / "theory.md").read_text(encoding="utf-8")
    headings = sorted(sections_of(theory(root)), key=lambda heading: int(heading.split()[0]))
    if [int(heading.split()[0]) for heading in headings] != list(range(1, len(headings) + 1)):
        yield f"theory.md: the sections are {headings}"
    rows = re.findall(r"^\| \[(\d+ [^\]]*)\]\(([^)]*)\) \|(.*)\|$", text, re.M)
    if [row[0] for row in rows] != headings:
        yield f"theory.md: the table has {[row[0] for row in rows]}, the pages {headings}"
    # By the table, or by the sentence below it.
    named = re.findall(r"lib/lobe/[\w/]+", text[:text.index("\n## 1 ")])
    for title, target, cell in rows:
        page, _, mark = target.partition("#")
        chapter = root / "docs" / (page or "theory.md")
        if not chapter.is_file() or title not in sections_of(chapter.read_text(encoding="utf-8")):
            yield f"theory.md: {target} has no section {title}"
        if mark and mark != anchor(title) or not page and not mark:
            yield f"theory.md: {target}, must be #{anchor(title)}"
        for pattern in (p for code in re.findall(r"`([^`]*)`", cell) for p in expanded(code)):
            if not list(root.glob(pattern.rstrip("/"))):
                yield f"theory.md: section {title}: there is no {pattern}"
    for folder in sorted((root / "lib" / "lobe").iterdir()):
        path = f"lib/lobe/{folder.name}"
        if folder.is_dir() and list(folder.glob("*.h")) and not any(name.startswith(path) for name in named):
            yield f"theory.md: no section names {path}/"


def equation_numbers(root):
    """Equations are numbered in the order of the page, by section, and every number that is cited is one."""
    text = theory(root)
    tags = set()
    for section in re.split(r"^(?=##? \d+ )", text, flags=re.M)[1:]:
        number = re.match(r"##? (\d+)", section)[1]
        found = re.findall(r"\\tag\{([^}]*)\}", section)
        wanted = [f"{number}.{i + 1}" for i in range(len(found))]
        if found != wanted:
            yield f"theory.md: section {number} has the equations {found}, must be {wanted}"
        tags.update(found)
    cited = [("docs/theory.md", number) for number in re.findall(r"(?<![\w\\])\((\d+\.\d+)\)", re.sub(r"^\|.*$", "", text, flags=re.M))]
    others = [(page, page.read_text(encoding="utf-8")) for page in documents(root)]
    others += [(file, re.sub(rf"\n\s*{mark} ?", " ", file.read_text(encoding="utf-8"))) for file, mark in sources(root)]
    for file, content in others:
        for cites in re.findall(r"theory(?:\.md)?,? ((?:\(\d+\.\d+\)(?:,| to| and)? ?)+)|((?:\(\d+\.\d+\)(?:,| to| and)? ?)+)of the "
                                r"\[?theory", content):
            cited += [(file.relative_to(root), number) for number in re.findall(r"\d+\.\d+", "".join(cites))]
    for file, number in cited:
        if number not in tags:
            yield f"{file}: the theory has no equation ({number})"


def members(root):
    """`Class::member` in a page is in a header that declares the class."""
    headers = [file.read_text(encoding="utf-8") for folder in ("lib", "capi", "meshing", "view", "petsc")
               for file in sorted((root / folder).rglob("*.h"))]
    for page in documents(root):
        text = re.sub(r"^```.*?^```$|<!--.*?-->", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)
        for owner, name in sorted(set(re.findall(r"\b(?<!::)([A-Z]\w+)::(\w+)", text))):
            declares = rf"\b(?:class|struct|enum class) (?:alignas\(\w+\) )?{owner}\b"
            if not any(re.search(declares, header) and re.search(rf"\b{name}\b", header) for header in headers):
                yield f"{page.relative_to(root)}: there is no {owner}::{name}"


def section_numbers(root):
    """Comments that send the reader to a section of the theory name one that there is."""
    last = max(int(section.split()[0]) for section in sections_of(theory(root)))
    for file, mark in sources(root):
        comments = re.sub(rf"\n\s*{mark} ?", " ", file.read_text(encoding="utf-8"))
        for number in re.findall(r"theory, section (\d+)", comments):
            if int(number) > last:
                yield f"{file.relative_to(root)}: the theory has no section {number}"


def plain(text):
    return re.sub(r"[^\w/.;,: -]", "", text.replace("omega", "ω")).replace("ω_max", "").replace("ωmax", "")


def glossary(root):
    page = (root / "docs" / "README.md").read_text(encoding="utf-8")
    section = page[page.index("## Glossary"):]
    listed = dict(re.findall(r"^\| ([^|]+?) \| ([^|]+?) \|$", section, re.M))
    listed = {re.sub(r" \$.*", "", k): v for k, v in listed.items() if k not in ("word", "---")}
    header = (root / "lib" / "lobe" / "lobe.h").read_text(encoding="utf-8")
    block = header[header.index("// Glossary"):header.index("// Symbols")]
    entries = re.sub(r"\n//     ", " ", block)
    defined = dict(re.findall(r"^//   ([^:]+): (.*)\.$", entries, re.M))
    if len(listed) < 30:
        yield f"docs/README.md: the glossary has {len(listed)} words"
    for word in listed.keys() | defined.keys():
        if plain(listed.get(word, "")) != plain(defined.get(word, "")):
            yield f'glossary: "{word}" is "{listed.get(word)}" in docs/README.md, "{defined.get(word)}" in lobe.h'


def list_of_folders(root):
    """The umbrella header names every folder."""
    header = (root / "lib" / "lobe" / "lobe.h").read_text(encoding="utf-8")
    named = set(re.findall(r"^//   (\w+)/ ", header, re.M))
    there = {folder.name for folder in (root / "lib" / "lobe").iterdir() if list(folder.glob("*.h"))}
    for name in sorted(named ^ there):
        yield f"lobe.h: {name}/ is " + ("not in the list of folders" if name in there else "listed, but not there")


def cycle_of_folders(root):
    """No folder of the library needs itself by way of others."""
    library = root / "lib" / "lobe"
    needs = {}
    for file in sorted(library.glob("*/**/*")):
        if file.suffix in (".h", ".cpp"):
            folder = file.relative_to(library).parts[0]
            included = re.findall(r'#include "lobe/(\w+)/', file.read_text(encoding="utf-8"))
            needs.setdefault(folder, set()).update(set(included) - {folder})
    try:
        graphlib.TopologicalSorter(needs).prepare()
    except graphlib.CycleError as error:
        yield "lib/lobe: folders that need each other: " + " ← ".join(error.args[1])


def world(header):
    """Numbers of the public functions of World, with constructors and overloads, and of its members."""
    text = re.sub(r"//.*", "", header)
    parts = re.search(r"^class World {\n public:(.*?)^ private:(.*?)^};", text, re.S | re.M)
    public, private = parts.groups()
    public = re.sub(r"{[^{}]*}", ";", re.sub(r"<[^<>()]*>|\(\)", "", public))
    functions = [part for part in re.sub(r"\([^()]*\)", "", public).split(";") if part.strip()]
    return len(functions), len(re.findall(r"^  [\w:<>]+ \w+_(?:{[^\n]*})?;", private, re.M))


def world_is_small(root):
    """World has fewer public functions than 30, and fewer members than 15."""
    functions, members = world((root / "lib" / "lobe" / "sim" / "world.h").read_text(encoding="utf-8"))
    if not 0 < functions < 30 or not 0 < members < 15:
        yield f"world.h: {functions} public functions and {members} members, must be below 30 and 15"


def makes(root, command, picture):
    """Whether a command exists that can make a picture: of ./dev, an example or a benchmark."""
    words = command.split()
    if words[0] == "./dev":
        scripts = [*(root / "docs" / "pictures").glob("*.gp"), *(root / "benchmarks" / "results").glob("*.gp")]
        draws = words[1] != "plots" or any(Path(output).name == Path(picture).name for script in scripts for output in
                                           re.findall(r"set output '([^']*)'", script.read_text(encoding="utf-8")))
        return draws and f"  {words[1]})" in (root / "dev").read_text(encoding="utf-8")
    if words[0].startswith("build/bin/"):
        return (root / "examples" / f"{Path(words[0]).name}.cpp").exists()
    pages = [root / "docs" / "commands.md", *sorted((root / "docs" / "commands").glob("*.md"))]
    return any(" ".join(words[:3]) in page.read_text(encoding="utf-8") for page in pages)


def figures(root):
    """Every figure says in the text below it which command makes it."""
    for page in documents(root):
        lines = page.read_text(encoding="utf-8").splitlines()
        for i, line in enumerate(lines):
            for picture in re.findall(r"!\[[^\]]*\]\(([^)]*)\)", line):
                made = re.search(r"Made by `([^`]*)`", "\n".join(lines[i:i + 8]))
                if not made or not makes(root, made[1], picture):
                    yield f"{page.relative_to(root)}:{i + 1}: " + (
                        f"`{made[1]}` cannot make {picture}" if made else f"no command beside {picture}")


def sources(root):
    yield root / "dev", "#"
    for file in (file for folder in SOURCES for file in sorted((root / folder).rglob("*"))):
        is_list = file.suffix != ".txt" or file.name == "CMakeLists.txt"
        if file.suffix in MARKS and is_list and "third_party" not in file.parts and file.is_file():
            yield file, MARKS[file.suffix]


def has_comment(line, mark):
    """Whether a line is a comment, or ends with one."""
    if mark == "//" and re.match(r"\s*(/\*| \* )", line):
        return True
    return re.match(rf"\s*{mark}", line) or re.search(rf"\S\s+({mark}|/\*) (?=[^\"']*$)", line)


def wide_comments(root):
    for file, mark in sources(root):
        for i, line in enumerate(file.read_text(encoding="utf-8").splitlines()):
            if len(line) > WIDEST and has_comment(line, mark):
                yield f"{file.relative_to(root)}:{i + 1}: a comment of {len(line)} columns, must be at most {WIDEST}"


NO_LIBRARIES = {"Threads", "PkgConfig", "Python", "lobe"}  # that CMake finds: parts of the system or of lobe
FINDS = r"\b(?:find_package|lobe_find_library|lobe_image_library|pkg_check_modules)\((\w+)"


def letters(name):
    return re.sub(r"[^a-z]", "", name.lower())


def licences(root):
    """README's licences name each library that is linked into what is built, tests aside."""
    readme = (root / "README.md").read_text(encoding="utf-8")
    section = re.search(r"^## Licences\n(.*?)(?=^## |\Z)", readme, re.S | re.M)[1]
    named = [letters(word) for word in section.split()]
    lists = [root / "CMakeLists.txt"] + [
        file for folder in SOURCES if folder != "tests"
        for file in sorted((root / folder).rglob("CMakeLists.txt"))]
    for file in lists:
        text = file.read_text(encoding="utf-8")
        found = set(re.findall(FINDS, text)) | set(re.findall(r"find_path\(LOBE_(\w+)_INCLUDE_DIR", text))
        for name in sorted(found - NO_LIBRARIES):
            if not any(letters(name) in word for word in named):
                yield f"README.md: {file.relative_to(root)} links {name}, which the licences do not name"


CHECKS = (long_paragraphs, large_pages, theory_table, equation_numbers, section_numbers, members, glossary,
          list_of_folders, cycle_of_folders, world_is_small, figures, licences, wide_comments)


def main(root):
    assert has_comment("a = 1;  // b", "//") and has_comment("  # b", "#") and not has_comment('"http://a"', "//")
    assert words("$a b$ c d](e f)") == 3 and anchor("8 A frame, and what") == "8-a-frame-and-what"
    assert expanded("a/{b,c}.*") == ["a/b.*", "a/c.*"]
    faults = [fault for check in CHECKS for fault in check(root)]
    print("\n".join(faults))
    print(f"{len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
