"""Every notebook runs from top to bottom, and its stored outputs are those of a run."""

import re

import nbformat
import pytest
from nbclient import NotebookClient
from paths import ROOT
from store_notebooks import drop_progress

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
LONGEST = 240
"""Seconds for one cell; those that compile take about ten."""


@pytest.fixture(params=NOTEBOOKS, ids=lambda path: path.stem)
def notebook(request):
    return nbformat.read(request.param, as_version=4)


def code_cells(notebook):
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def shown(cell):
    """What a cell shows, without its numbers: the words that it prints, and the kinds
    of its other outputs. Numbers differ in their last digits among processors, and
    times from run to run. Of a fit that its tests do not determine the words differ
    too: where on its ridge it ends, and what is said of that, hangs on rounding."""
    printed = "".join(out.text for out in cell.outputs if out.output_type == "stream")
    kinds = [sorted(out.data) for out in cell.outputs if "data" in out]
    if "depends-on-rounding" in cell.metadata.get("tags", ()):
        return bool(printed), kinds
    return re.findall(r"[^\W\d_]{2,}", printed), kinds


def test_there_are_notebooks():
    assert NOTEBOOKS


def test_outputs_are_stored(notebook):
    """The documentation shows them, and executes nothing."""
    nbformat.validate(notebook)
    cells = code_cells(notebook)
    assert [cell.execution_count for cell in cells] == [*range(1, len(cells) + 1)]
    outputs = [output for cell in cells for output in cell.outputs]
    pictures = [out for out in outputs if "image/png" in out.get("data", {})]
    assert len(pictures) >= 2
    for output in outputs:
        assert output.output_type in {"stream", "display_data", "execute_result"}
        assert output.get("name") != "stderr"


@pytest.mark.docs
def test_runs_from_top_to_bottom(notebook, tmp_path, monkeypatch):
    # The kernel is another process: it gets the package's place and no display.
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    stored = [shown(cell) for cell in code_cells(notebook)]
    client = NotebookClient(
        notebook, timeout=LONGEST, resources={"metadata": {"path": str(tmp_path)}}
    )
    client.execute()
    drop_progress(notebook)
    assert not [
        output
        for cell in code_cells(notebook)
        for output in cell.outputs
        if output.output_type == "stream" and output.name == "stderr"
    ]
    # Stored outputs are not stale: `make notebooks` stores them anew.
    assert [shown(cell) for cell in code_cells(notebook)] == stored
