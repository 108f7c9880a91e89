"""Pages of the documentation print what they show, and every public name is on a page
of the reference, with its formulas. `make docs` builds the site, where warnings are
errors."""

import importlib
import inspect
import json
import re
from decimal import Decimal

import numpy as np
import pytest
from pages import all_pages, blocks_of, folder_of_a_page, run, words_of
from paths import DOCS, ROOT

PAGES = [page for page in all_pages() if blocks_of(page)]
NUMBER = re.compile(r"-?\d+(?:\.\d*)?(?:e[-+]?\d+)?")


def name_of(page) -> str:
    return page.relative_to(ROOT).as_posix()


def assert_prints(received: str, block) -> None:
    """Words are the same, and numbers but for rounding that differs by processor."""
    received, expected = words_of(received), words_of(block.printed)
    words = [NUMBER.sub("#", word) for word in received]
    assert words == [NUMBER.sub("#", word) for word in expected], str(block)
    texts = [NUMBER.findall(" ".join(words)) for words in (received, expected)]
    numbers = [np.array(found, float) for found in texts]
    # What lies between two roundings is printed as either.
    atol = 1e-12 + np.array([last_digit(text) for text in texts[1]])
    wrong = np.abs(numbers[0] - numbers[1]) > atol + 1e-4 * np.abs(numbers[1])
    assert not np.any(wrong), f"{numbers[0][wrong]} in {block}"


def last_digit(number: str) -> float:
    """The unit of a number's last digit, if it has so many that this is of no weight,
    else 0; whole numbers are exact."""
    _, digits, exponent = Decimal(number).as_tuple()
    is_whole = "." not in number and "e" not in number
    return 0.0 if is_whole or len(digits) < 4 else 10.0**exponent


@pytest.mark.docs
@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_a_page_prints_what_it_shows(page, tmp_path):
    names = {}
    with folder_of_a_page(tmp_path):
        for block in blocks_of(page):
            received = run(block, names)
            if block.printed is not None:
                assert_prints(received, block)


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_a_page_sets_double_precision_before_it_computes(page):
    """The tests have set it already; whoever copies the page has not."""
    code = [b.text for b in blocks_of(page) if b.language == "python" and not b.file]
    text = "".join(code).partition('jax.config.update("jax_enable_x64", True)')[0]
    used = re.findall(r"^(?:from|import) jaximpact.*", text, re.MULTILINE)
    # Reading a dataset computes nothing.
    assert set(used) <= {"from jaximpact import read_netcdf"}


def test_the_model_names_files_and_functions_that_there_are():
    page = (DOCS / "model.md").read_text(encoding="utf-8")
    named = re.findall(r"`([\w/]+\.py)`(?:,\s+`([\w.]+)`)?", page)
    assert named
    for file, name in named:
        places = [ROOT / "jaximpact" / file, ROOT / file]
        place = next((place for place in places if place.exists()), None)
        assert place is not None, f"model.md names {file}"
        last = name.rpartition(".")[2]
        assert last in place.read_text(encoding="utf-8"), f"{file} has no {name}"


STUDIES = re.findall(
    r"^\| `(\w+)` \|[^|]*\|([^|]*)\| *([^|]*?) *\|$",
    (DOCS / "calibration.md").read_text(encoding="utf-8").partition("\n| study |")[2],
    re.MULTILINE,
)
"""Names, outcomes and preferred laws of the studies that calibration.md lists."""
INTERVAL = re.compile(r"`(\w+)` between ([\d.]+) and ([\d.]+)")
BELOW = re.compile(r"the model is ([\d.]+) ± ([\d.]+) below the best")


def result_of(study) -> dict:
    path = ROOT / "calibration" / study / "result" / "fit.json"
    return json.loads(path.read_text(encoding="utf-8"))


def rounded_as(text, value) -> str:
    return f"{value:.{len(text.partition('.')[2])}f}"


def test_intervals_of_the_studies_are_those_of_their_results():
    found = [
        (study, *told)
        for study, outcome, _ in STUDIES
        for told in INTERVAL.findall(outcome)
    ]
    assert found
    for study, name, *told in found:
        variants = [one["parameters"][name] for one in result_of(study)["variants"]]
        known = [one["interval_95"] for one in variants if one["interval_95"]]
        results = [[*map(rounded_as, told, ends)] for ends in known]
        assert told in results, f"{study}: {name} is {known}"


def test_laws_that_the_studies_prefer_are_those_of_their_results():
    compared = [
        (study, told) for study, _, told in STUDIES if told not in ("", "not compared")
    ]
    assert compared
    for study, told in compared:
        comparison = result_of(study)["comparison"]
        if told.startswith("none is preferred"):
            assert "no law is preferred" in comparison["verdict"][0], study
        else:
            preferred = comparison["preferred"]
            assert told.removeprefix("the ").startswith(preferred), study
        model = next((one for one in comparison["laws"] if one["law"] == "model"), {})
        for printed in BELOW.findall(told):
            behind = -model["difference"], model["standard_error"]
            expected = tuple(map(rounded_as, printed, behind))
            assert printed == expected, f"{study}: {behind}"


def test_limits_and_the_page_of_run_outs_give_the_same_design_values():
    """Both of the same run, of elongated blocks by either kinematics."""
    page = (DOCS / "how-to" / "slope-runout.md").read_text(encoding="utf-8")
    table = page.partition("by DeepestPoint")[2]
    printed = []
    for value, unit in (("energy", "kJ"), ("lowest height", "m")):
        by_both = (
            rf" {value} +{unit} +([\d.]+) .*\n +- by DeepestPoint +{unit} +([\d.]+) "
        )
        printed += [float(x) for x in re.search(by_both, table).groups()]
    limits = (DOCS / "limits.md").read_text(encoding="utf-8")
    row = re.search(
        r"^\| 1\.5 \|.*\| ([\d.]+) m .* \| ([\d.]+) m .* \|(.*) kJ", limits, re.M
    )
    energies = [float(x) for x in row[3].split(",")]
    told = [*reversed(energies), float(row[2]), float(row[1])]
    np.testing.assert_allclose(told, printed, rtol=0.0, atol=0.0501)  # as rounded there


# --- the reference


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
