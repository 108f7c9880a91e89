"""The page of a run-out study in a real browser, where there is one: what it shows at
two places of the slider, and its print."""

import re
import shutil
import subprocess

import numpy as np
import pytest
from slope_study import FAR

from jaximpact.reports.document import Document, ReportSection
from jaximpact.runout import read_slope_study, run_slope_study
from jaximpact.runout.study.report_page import slope_report
from jaximpact.runout.study.run_study import simulate

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))),
    None,
)
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(BROWSER is None, reason="no Chromium is installed"),
]
FLAGS = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic"),
    *("--no-first-run", "--disable-background-networking", "--disable-sync"),
    *("--disable-component-update", "--virtual-time-budget=2000"),
)


def browse(page, folder, *arguments, place):
    command = [BROWSER, *FLAGS, f"--user-data-dir={folder / 'profile'}", *arguments]
    address = f"{page.as_uri()}#x={place}"
    done = subprocess.run([*command, address], capture_output=True, timeout=120)
    assert done.returncode == 0, done.stderr.decode(errors="replace")[-2000:]
    return done.stdout.decode()


@pytest.mark.parametrize("place", [25, 95])
def test_the_slider_shows_the_blocks_in_a_bin(slope_results, tmp_path, place):
    dataset = slope_results.dataset
    shown = browse(
        slope_results.folder / "report.html", tmp_path, "--dump-dom", place=place
    )
    here = dataset.sel(bin=place, method="nearest")
    count = int(here.blocks_in_bin)
    where = re.search(r'<strong id="where">(.*?)</strong>', shown)[1]
    low, high = float(here.bin_left_m), float(here.bin_right_m)
    assert where == f"x from {low:g} to {high:g} m: {count} of 90 blocks come there"
    body = re.search(r'<tbody id="numbers">(.*?)</tbody>', shown, re.DOTALL)[1]
    rows = [re.findall("<td>(.*?)</td>", row) for row in body.split("</tr>")[:-1]]
    for row, name in zip(rows, ("height_m", "speed_mps", "energy_J"), strict=True):
        factor = 1e-3 if name == "energy_J" else 1.0
        expected = factor * here[f"envelope_{name}_percentiles"].values
        # Four digits are shown.
        np.testing.assert_allclose([float(v) for v in row[1::2]], expected, rtol=6e-4)
        assert row[-1].endswith("to -")  # 90 blocks have no upper end at 99 %
    # A curve in each panel, and labels of the profile's places.
    assert shown.count("<polyline") == 3
    assert re.search(r"<text [^>]*>upper, fence</text>", shown)
    assert re.search(r"<text [^>]*>x = 60 m</text>", shown)


def page_of(text, folder):
    """The page of a study, written into a folder, and the study's results."""
    path, page = folder / "slope.toml", folder / "report.html"
    path.write_text(text)
    study = read_slope_study(path)
    dataset = run_slope_study(study)
    page.write_text(slope_report(study, dataset, simulate(study, np.arange(3))).page())
    return page, dataset


def test_names_of_places_are_whole(tmp_path):
    """One near the right end stands to the left of its place."""
    text = FAR.replace("[2600029]", "[2600029, 2600725]")
    page, _ = page_of(text, tmp_path)
    shown = browse(page, tmp_path, "--dump-dom", place=2600029.0)
    before, last = (
        re.search(rf"<text ([^>]*)>x = {x} m</text>", shown) for x in (2600029, 2600725)
    )
    assert "text-anchor" not in before[1]
    assert 'text-anchor="end"' in last[1]


def test_a_bin_in_national_coordinates(tmp_path):
    page, dataset = page_of(FAR, tmp_path)
    shown = browse(page, tmp_path, "--dump-dom", place=2600029.0)
    where = re.search(r'<strong id="where">(.*?)</strong>', shown)[1]
    here = dataset.sel(bin=2600029.0, method="nearest")
    count = int(here.blocks_in_bin)
    ends = "x from 2600014.6 to 2600029.2 m"
    assert where == f"{ends}: {count} of 20 blocks come there"


def test_what_is_folded_is_printed(tmp_path):
    """Lines of several pages, in a section that the browser shows folded."""
    page, target = tmp_path / "page.html", tmp_path / "page.pdf"
    lines = [f"line {number}" for number in range(200)]
    page.write_text(
        Document("Long", ["short"], [ReportSection("Folded", lines)]).page()
    )
    browse(page, tmp_path, f"--print-to-pdf={target}", place=0)
    printed = target.read_bytes()
    assert printed.startswith(b"%PDF")
    assert len(re.findall(rb"/Type\s*/Page\b", printed)) > 3
