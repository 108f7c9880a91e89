"""The site: every public name is on a page of the reference, with its formulas. `make
docs` builds it, where warnings are errors."""

import importlib
import inspect
import re

import pytest
from paths import DOCS

MODULES = [
    "jaximpact",
    "jaximpact.calibration",
    "jaximpact.laws",
    "jaximpact.lookup",
    "jaximpact.rebound",
    "jaximpact.runout",
    "jaximpact.sensitivity",
    "jaximpact.shapes",
]
"""Rooms whose `__all__` says what is public."""
IN_WORDS = {"Scalar"}
"""Told in the text of their page: an annotation has no page of its own."""


def described() -> list:
    """Values that the pages of the reference list."""
    found = []
    for page in (DOCS / "reference").glob("*.md"):
        text = page.read_text(encoding="utf-8")
        for module, names in re.findall(r"```\{api\} (\S+)\n(.*?)```", text, re.DOTALL):
            room = importlib.import_module(module)
            found += [getattr(room, name) for name in names.split()]
    return found


@pytest.mark.parametrize("module", MODULES)
def test_every_public_name_is_in_the_reference(module):
    room, known = importlib.import_module(module), {id(value) for value in described()}
    names = [name for name in room.__all__ if id(getattr(room, name)) not in known]
    assert set(names) <= IN_WORDS


def test_no_name_is_described_twice():
    values = described()
    assert len({id(value) for value in values}) == len(values)


def test_formulas_of_docstrings_become_mathematics(monkeypatch):
    pytest.importorskip("sphinx", reason="the extra docs is not installed")
    monkeypatch.syspath_prepend(DOCS / "_ext")
    as_rst = importlib.import_module("docstrings").as_rst
    texts = [as_rst(inspect.getdoc(value) or "", {}) for value in described()]
    assert any(".. math:: " in text for text in texts)
    assert not [text for text in texts if "$" in text]
