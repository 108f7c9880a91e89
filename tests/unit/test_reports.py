"""What all reports are made of: tables, trees for JSON, documents."""

import csv
import enum
import html.parser
import io
import json
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from matplotlib.figure import Figure

from jaximpact.accuracy import PRESETS
from jaximpact.reports.document import Box, Document, Picture, ReportSection
from jaximpact.reports.json_tree import json_text, plain
from jaximpact.reports.tables import Table, at_x, cell_text, listed, place_text


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        *((None, "-"), (np.nan, "-"), (np.inf, "-"), (3, "3"), ("a", "a")),
        *((1 / 3, "0.3333"), (np.float64(12345.6), "1.235e+04"), (-1e-17, "0")),
    ],
)
def test_cells(value, shown):
    assert cell_text(value) == shown


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        *((np.nan, "-"), (1 / 3, "0.3333"), (9999.4, "9999"), (9999.7, "9999.7")),
        *((-9999.96, "-10000"), (2600014.62, "2600014.6"), (-1e-17, "0")),
    ],
)
def test_coordinates(value, shown):
    assert place_text(value) == shown


def test_names_of_places():
    assert at_x(512345.6) == "x = 512345.6 m"
    assert at_x(999999.4) == "x = 999999.4 m"
    assert at_x(1234.567) == "x = 1234.57 m"
    assert place_text(12345.6, 5) == "12345.6"


def test_a_table_is_text_and_a_file_with_all_digits():
    table = Table(("name", "x [m]"), [("a", 1 / 3), ('b, "c"', None)])
    assert table.text() == '  name    x [m]\n  a       0.3333\n  b, "c"  -'
    rows = list(csv.reader(io.StringIO(table.csv())))
    assert rows == [["name", "x [m]"], ["a", repr(1 / 3)], ['b, "c"', ""]]
    assert table
    assert not Table(("name",), [])


def test_names_in_a_row():
    assert [listed(list("abc")[:n]) for n in range(4)] == [
        "",
        "a",
        "a and b",
        "a, b and c",
    ]


class Colour(enum.Enum):
    RED = 1

    def __str__(self):
        return "red"


class Pair(NamedTuple):
    low: float
    high: np.ndarray


def test_results_become_trees():
    found = plain(
        {
            "pair": Pair(np.nan, np.array([[1, 2], [3, 4]])),
            "accuracy": PRESETS["balanced"],
            Colour.RED: (Colour.RED, Path("a/b"), np.float64(2.0), np.bool_(True)),
        }
    )
    assert found["pair"] == {"low": None, "high": [[1, 2], [3, 4]]}
    assert found["accuracy"]["name"] == "balanced"
    assert found["red"] == ["red", str(Path("a/b")), 2.0, True]


def test_lists_of_numbers_are_lines_of_the_same_json():
    tree = {"a [\n 1 ]": [[1.5, None], [-2e-7, True]], "b": ["[\n2\n]", []], "c": {}}
    text = json_text(tree)
    assert json.loads(text) == tree
    assert "[1.5, null]" in text


@pytest.fixture
def document():
    return Document(
        "A <twin> & more",
        [
            Box("verdict", ["It is <b>", "and so on"]),
            None,
            Picture(Figure, "what <it> shows", "caption & all"),
        ],
        [
            ReportSection("Empty", ["", [], None, Table(("a",), [])]),
            ReportSection("Inner", ["x", ReportSection("Deep", [["one", "two"]])]),
            ReportSection("Long", [Table(("a < b",), [("$c$",), ("word " * 20,)])]),
            ReportSection("Page alone", ["secret"], printed=False),
        ],
    )


def test_a_document_as_text(document):
    text = document.text()
    assert text.startswith(
        "A <twin> & more\n===============\n\nIt is <b>\n  and so on\n"
    )
    assert "\n\nInner\n-----\nx\n\nDeep\n  one\n  two\n" in text
    assert "Empty" not in text
    assert "secret" not in text
    assert "caption" not in text


class Tags(html.parser.HTMLParser):
    """Tags that are open where a page ends."""

    def __init__(self, page):
        super().__init__()
        self.open = []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.open += [tag] if tag not in ("meta", "img") else []

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_a_page_escapes_what_it_is_given_and_folds_all_but_the_answer(document):
    page = document.page()
    assert "<h1>A &lt;twin&gt; &amp; more</h1>" in page
    assert '<th scope="col">a &lt; b</th>' in page
    assert 'alt="what &lt;it&gt; shows"' in page
    assert '<td class="number">$c$</td>' in page
    assert re.search(r"<td>(word ){20}</td>", page)
    assert re.findall(r"<summary><h2>(.*?)</h2>", page) == [
        "Inner",
        "Long",
        "Page alone",
    ]
    assert page.index('class="verdict"') < page.index("<img ") < page.index("<details>")
    assert "<details open" not in page
    assert Tags(page).open == []
    assert page.index("<h3>Deep</h3>") > page.index("Inner")
    # A notebook shows everything.
    shown = document.html()
    assert "<details" not in shown
    assert "<h2>Inner</h2>" in shown
