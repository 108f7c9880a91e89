"""Execute notebooks and store their outputs in them, as `make notebooks` does.

    python tests/helpers/store_notebooks.py [NOTEBOOK ...]

Without arguments all of `notebooks/`. Each runs in an empty directory.
"""

import os
import re
import sys
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from paths import ROOT

OVERWRITTEN = re.compile(r"(\r[^\r\n]*)+\n?")
"""Lines of progress, which overwrite each other."""


def drop_progress(notebook: nbformat.NotebookNode) -> None:
    """Take progress out of the outputs, which says how fast a machine was."""
    for cell in notebook.cells:
        kept = []
        for output in cell.get("outputs", ()):
            if output.get("name") == "stderr":
                output.text = OVERWRITTEN.sub("", output.text).strip()
            if output.get("text") != "":
                kept.append(output)
        if "outputs" in cell:
            cell.outputs = kept


def store(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        resources = {"metadata": {"path": folder}}
        NotebookClient(notebook, timeout=600, resources=resources).execute()
    drop_progress(notebook)
    # When and by which Python a cell ran would change with every run.
    notebook.metadata["language_info"] = {"name": "python"}
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
    nbformat.write(notebook, path)


if __name__ == "__main__":
    os.environ["PYTHONPATH"] = str(ROOT)
    for path in map(Path, sys.argv[1:] or sorted((ROOT / "notebooks").glob("*.ipynb"))):
        print(path.name, flush=True)
        store(path)
