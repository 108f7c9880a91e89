"""Sphinx's settings: `make docs` writes the site to out/docs.

The build reads nothing from the network, and every warning is an error.
"""

import json
import os
import shutil
import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "_ext"), str(HERE.parent)]
# Reading docstrings needs no accelerator.
os.environ.setdefault("JAX_PLATFORMS", "cpu")

project = "jaximpact"
author = "the jaximpact authors"
copyright = "the jaximpact authors, MIT licence"

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "commands",
    "docstrings",
    "gallery",
    "mathml",
]
exclude_patterns = ["_build", "_pictures"]
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence"]
myst_heading_anchors = 3
# ```math is a formula on GitHub's pages, and here too.
myst_fence_as_directive = ["math"]
# Notebooks are shown as they are stored. The tests execute them.
nb_execution_mode = "off"
nb_output_stderr = "remove"

autodoc_typehints = "none"
autodoc_preserve_defaults = True
autodoc_member_order = "bysource"
autodoc_inherit_docstrings = False
python_use_unqualified_type_names = True
add_module_names = False
napoleon_numpy_docstring = False
napoleon_use_rtype = False

highlight_language = "none"

html_theme = "sphinx_book_theme"
html_title = "jaximpact"
html_math_renderer = "mathml"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_theme_options = {
    "use_download_button": False,
    "show_navbar_depth": 1,
    "navbar_persistent": [],
    "show_toc_level": 2,
}
html_show_sourcelink = False
html_copy_source = False


def copy_notebooks() -> None:
    """Put the notebooks where Sphinx reads pages, their links to pages of docs/ too."""
    target = HERE / "notebooks"
    shutil.rmtree(target, ignore_errors=True)
    target.mkdir()
    for path in sorted((HERE.parent / "notebooks").glob("*.ipynb")):
        notebook = json.loads(path.read_text(encoding="utf-8"))
        for cell in notebook["cells"]:
            if cell["cell_type"] == "markdown":
                text = "".join(cell["source"])
                cell["source"] = text.replace("](../docs/", "](../")
        text = json.dumps(notebook, ensure_ascii=False)
        (target / path.name).write_text(text, encoding="utf-8")


copy_notebooks()


def link_copies(app, name: str, source: list[str]) -> None:
    """Let links to notebooks, as they are in the repository, lead to the copies."""
    source[0] = source[0].replace("../notebooks/", "notebooks/")


def setup(app) -> None:
    from pygments.lexers.special import TextLexer

    app.add_lexer("csv", TextLexer)
    app.connect("source-read", link_copies)
