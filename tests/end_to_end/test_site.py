"""The site: every public name is on a page of the reference, and it builds without a
warning."""

import importlib
import re
import subprocess
import sys

import pytest
from paths import DOCS, ROOT

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


@pytest.mark.docs
def test_the_site_builds_without_warnings(tmp_path):
    pytest.importorskip("sphinx", reason="the extra docs is not installed")
    pytest.importorskip("myst_nb", reason="the extra docs is not installed")
    command = [sys.executable, "-m", "sphinx", "-q", "-b", "html", "-W", "-n"]
    command += ["--keep-going", "-d", str(tmp_path / "trees")]
    done = subprocess.run(
        [*command, str(DOCS), str(tmp_path / "site")],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr[-4000:]
    page = (tmp_path / "site/reference/laws.html").read_text(encoding="utf-8")
    # A formula of a docstring, drawn by the browser
    assert "<math" in page
    assert "$$" not in page
