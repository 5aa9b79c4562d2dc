# The documentation site. `./dev docs` runs docs/site/build.py, which calls Sphinx with this file.
import os

project = "lobe"
author = "the authors of lobe"
extensions = ["myst_parser", "breathe", "sphinx.ext.mathjax"]
root_doc = "index"
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}

# Markdown as GitHub shows it: $formulas$, anchors of headings.
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
myst_dmath_double_inline = True
suppress_warnings = ["myst.header"]  # a page may begin with a heading of any level

# API reference: Doxygen reads the headers' comments, breathe draws them.
breathe_projects = {"lobe": os.environ["LOBE_DOXYGEN_XML"]}
breathe_default_project = "lobe"
breathe_show_include = False
primary_domain = "cpp"
highlight_language = "text"

# Formulas are set in the browser by MathJax, which is copied into the site: nothing is fetched from a
# network.
mathjax_path = "mathjax/MathJax.js?config=TeX-AMS_HTML"
mathjax2_config = {
    "HTML-CSS": {"availableFonts": ["TeX"], "webFont": "TeX", "imageFont": None},
    "messageStyle": "none",
    # MyST marks pages as to be ignored, and formulas by their class.
    "tex2jax": {"inlineMath": [["\\(", "\\)"]], "displayMath": [["\\[", "\\]"]], "processClass": "math",
                "ignoreClass": "tex2jax_ignore", "processEnvironments": False},
}

html_theme = "furo"
html_title = "lobe"
html_static_path = []
html_show_sphinx = False
html_copy_source = False
exclude_patterns = ["lib/**", "docs/site", "tests/**", "examples/**", "**/third_party/**", "**/build/**", "view/**", "meshing/**", "capi/**", "cholmod/**", "python/**", "benchmarks/validation/**", "benchmarks/stress/**"]
