#!/usr/bin/python3
"""Builds the documentation site.

build.py OUT [--pages]: OUT/html is the site (open OUT/html/index.html), OUT/source and OUT/doxygen are what it is made
of. With --pages the API reference, which takes most of the time, is left out.
Exit status 1: Sphinx failed; with --pages also if it warned, as of a link that leads nowhere.
"""
import os
import shutil
import subprocess
import sys
from pathlib import Path

from header_comments import filtered

ROOT = Path(__file__).resolve().parents[2]
SITE = ROOT / "docs" / "site"
MATHJAX = Path("/usr/share/javascript/mathjax")
NORMALIZE = Path("/usr/share/javascript/normalize.css/normalize.min.css")
# What the formulas of the pages need of MathJax; all of it would be 54 MB.
MATHJAX_PARTS = ["MathJax.js", "config/TeX-AMS_HTML.js", "extensions", "jax/element", "jax/input/TeX",
                 "jax/output/HTML-CSS", "fonts/HTML-CSS/TeX/woff"]
# Folders that the pages link to, and pages outside docs/.
STAGED = ["README.md", "LICENSE", "CITATION.cff", "docs", "data", "examples", "lib", "benchmarks", "tests", "capi",
          "cholmod", "view", "meshing", "python"]
SECTIONS = ("briefdescription detaileddescription user-defined public-type public-attrib public-static-attrib public-func "
            "public-static-func innerclass func enum var define")
FOLDER_TITLES = [
    ("lib/lobe", "The umbrella header and what all folders use"),
    ("capi", "C interface"),
]


def index_of_all_pages():
    """index.rst, and below it the pages that it does not list."""
    index = (SITE / "index.rst").read_text(encoding="utf-8")
    pages = [str(page.relative_to(ROOT).with_suffix("")) for page in sorted((ROOT / "docs").rglob("*.md"))]
    others = [page for page in pages if f"{page}\n" not in index and f"<{page}>" not in index]
    if others:
        index += "\n.. toctree::\n   :caption: More\n   :maxdepth: 1\n\n" + "".join(f"   {page}\n" for page in others)
    return index


def stage(out, with_api):
    """The pages as Sphinx reads them: links to the tree, and pages of the API made from the list of headers."""
    source = out / "source"
    shutil.rmtree(source, ignore_errors=True)
    source.mkdir(parents=True)
    for name in STAGED:
        (source / name).symlink_to(ROOT / name)
    (source / "index.rst").write_text(index_of_all_pages(), encoding="utf-8")
    if with_api:
        stage_api(source / "api")
    else:
        (source / "api").mkdir()
        (source / "api" / "index.rst").write_text("API reference\n=============\n", encoding="utf-8")
    return source


def first_sentence(header):
    """The first sentence of the comment at the top of a header."""
    words = []
    for line in header.read_text(encoding="utf-8").splitlines():
        if not line.startswith("//"):
            break
        words += line[2:].split()
    text = " ".join(words)
    end = min((i for i in (text.find(". "), text.find(": ")) if i >= 0), default=len(text))
    return text[:end].rstrip(".:")


def stage_api(api):
    """One page per folder of lib/lobe, with one section per header."""
    api.mkdir()
    folders = [ROOT / "lib/lobe"] + sorted(p for p in (ROOT / "lib/lobe").iterdir() if p.is_dir())
    folders.append(ROOT / "capi")
    titles = dict(FOLDER_TITLES)
    names = []
    for folder in folders:
        headers = sorted(folder.glob("*.h"))
        if not headers:
            continue
        path = str(folder.relative_to(ROOT))
        name = path.replace("/", "_")
        names.append(name)
        title = titles.get(path, path.removeprefix("lib/"))
        text = [title, "=" * len(title), ""]
        for header in headers:
            include = str(header.relative_to(ROOT)).removeprefix("lib/")
            heading = f"``{include}``"
            text += [heading, "-" * len(heading), "", f".. doxygenfile:: {header.relative_to(ROOT)}", "   :project: lobe",
                     f"   :sections: {SECTIONS if path == 'capi' else SECTIONS + ' typedef'}", ""]
        (api / f"{name}.rst").write_text("\n".join(text), encoding="utf-8")
    index = ["API reference", "=============", "",
             "One page per folder, one section per header, from the headers' comments. An engine includes",
             "``lobe/lobe.h``. All names are in the namespace ``lobe``. The :doc:`theory <../docs/theory>` has the equations.",
             "",
             ".. toctree::", "   :maxdepth: 1", ""]
    (api / "index.rst").write_text("\n".join(index + [f"   {name}" for name in names]) + "\n", encoding="utf-8")


def run_doxygen(out):
    headers = out / "headers"
    shutil.rmtree(headers, ignore_errors=True)
    for header in [*(ROOT / "lib/lobe").rglob("*.h"), *(ROOT / "capi").glob("*.h")]:
        copy = headers / header.relative_to(ROOT)
        copy.parent.mkdir(parents=True, exist_ok=True)
        lines = header.read_text(encoding="utf-8").splitlines()
        copy.write_text("\n".join(filtered(lines, header.name)) + "\n", encoding="utf-8")
    settings = (SITE / "Doxyfile").read_text(encoding="utf-8")
    settings += f"""
OUTPUT_DIRECTORY = {out / "doxygen"}
INPUT = {headers}
STRIP_FROM_PATH = {headers}
"""
    shutil.rmtree(out / "doxygen", ignore_errors=True)
    (out / "doxygen").mkdir(parents=True)
    subprocess.run(["doxygen", "-"], input=settings.encode(), check=True)


def copy_mathjax(html):
    for part in MATHJAX_PARTS:
        target = html / "_static" / "mathjax" / part
        target.parent.mkdir(parents=True, exist_ok=True)
        if (MATHJAX / part).is_dir():
            shutil.copytree(MATHJAX / part, target, dirs_exist_ok=True)
        else:
            shutil.copyfile(MATHJAX / part, target)


def mend_theme(html):
    """Debian's Furo asks for a style sheet by an address of a web server, and for a module that browsers do not load
    from files: both are put into the site."""
    static = html / "_static"
    sheet = static / "styles" / "furo.css"
    shutil.copyfile(NORMALIZE, sheet.parent / "normalize.css")
    text = sheet.read_text(encoding="utf-8")
    sheet.write_text(text.replace("/javascript/normalize.css/normalize.css", "normalize.css"), encoding="utf-8")
    script = static / "scripts" / "furo.js"
    module = (static / "scripts" / "gumshoe-patched.js").read_text(encoding="utf-8")
    text = script.read_text(encoding="utf-8")
    import_line = 'import Gumshoe from "./gumshoe-patched.js";'
    if import_line in text:
        module = module.replace("export default Gumshoe;", "")
        script.write_text(module + text.replace(import_line, ""), encoding="utf-8")


def main(out, with_api):
    if with_api:
        run_doxygen(out)
    source = stage(out, with_api)
    html = out / "html"
    os.environ["LOBE_DOXYGEN_XML"] = str(out / "doxygen" / "xml")
    strict = [] if with_api else ["-W", "--keep-going"]
    status = subprocess.run([sys.executable, "-m", "sphinx", "-q", *strict, "-j", "2", "-c", str(SITE),
                             "-d", str(out / "doctrees"), str(source), str(html)]).returncode
    copy_mathjax(html)
    mend_theme(html)
    return 1 if status else 0


if __name__ == "__main__":
    os.environ.setdefault("PYTHONWARNINGS", "ignore")
    sys.exit(main(Path(sys.argv[1]).resolve(), "--pages" not in sys.argv))
