"""Verdicts, files and report of a calibration."""

import base64
import json
import re

import numpy as np
import pytest
from calibrated_twin import DROPS, TRUE

from jaximpact.calibration import api
from jaximpact.cli import main

pytestmark = pytest.mark.slow

MEASUREMENTS = 2 * len(DROPS["name"])


@pytest.fixture(scope="module")
def variant(twin):
    return twin.found.result.variants[0]


@pytest.fixture(scope="module")
def page(twin):
    return (twin.out / "report.html").read_text()


@pytest.fixture(scope="module")
def tree(twin):
    return json.loads((twin.out / "fit.json").read_text())


def test_the_twin_is_recovered(twin, variant):
    """To the accuracy of the impacts."""
    assert variant.members == 32  # eight for each unknown
    assert variant.agreed >= 16
    values = variant.parameters[: len(TRUE)]
    np.testing.assert_allclose(values, list(TRUE.values()), rtol=1e-4)
    assert np.all(variant.end_costs >= variant.cost)
    assert variant.failed == 0
    assert twin.found.result.engine == "machine code"


def test_verdicts_of_the_twin(variant):
    determined = {v.name: v.determined for v in variant.verdicts}
    assert determined == dict.fromkeys(TRUE, True) | {"alpha_s": False}
    assert "no influence" in variant.verdicts[3].reason
    flat = variant.profiles["alpha_s"]
    # Each point is a fit of its own, which may stop early: nothing beside 1.92, where a
    # 95 % interval ends.
    assert np.max(flat.rise) < 0.2
    assert np.median(flat.rise) < 1e-3
    assert (flat.low, flat.high) == (None, None)
    ends = variant.bounds.lower[3], variant.bounds.upper[3]
    np.testing.assert_allclose(flat.values[[0, -1]], ends)
    # Near the minimum a profile is the parabola of the standard error.
    profile = variant.profiles["c_v"]
    error = variant.uncertainty.standard_errors[0]
    apart = np.abs(np.log(profile.values / variant.parameters[0])) / error
    # Its 95 % interval ends within three standard errors; the rest is rounding.
    assert np.max(apart) < 3.001
    near = (apart > 0.5) & (apart < 2.5)
    assert np.any(near)
    np.testing.assert_allclose(np.sqrt(profile.rise[near]), apart[near], rtol=0.2)


def test_numbers_of_the_files(twin, tree):
    assert sorted(path.name for path in twin.out.iterdir()) == [
        *("fit.json", "fitted.csv", "jaximpact-study.json", "report.html")
    ]
    (table,) = twin.found.result.study.tests.files
    assert tree["manifest"]["data"] == [{"file": "tests.csv", "sha256": table.sha256}]
    assert tree["manifest"]["seed"] == 1
    (variant,) = tree["variants"]
    alpha_s = variant["parameters"]["alpha_s"]
    assert alpha_s["standard_error"] is None
    assert alpha_s["interval_95"] is None
    assert variant["left_out"]["campaign"]["groups"] == ["north", "south"]
    assert len(variant["left_out"]["test"]["predicted"]) == len(DROPS["name"])
    further = variant["further_tests"]["all_results"]
    assert len(further["chosen"]) == 3
    assert set(further["chosen"][0]["scene"]) == {"speed_mps", "angle_deg"}
    rows = [x.split(",") for x in (twin.out / "fitted.csv").read_text().splitlines()]
    assert len(rows) == 1 + MEASUREMENTS
    cells = dict(zip(*rows[:2], strict=True))
    assert (cells["row"], cells["test"]) == ("2", DROPS["name"][0])
    assert float(cells["low"]) < float(cells["model_low"]) < float(cells["model_high"])
    assert float(cells["left_out_deviation"]) >= float(cells["sigma"])


def test_the_page_needs_nothing_else(page):
    images = re.findall(r'<img src="data:image/png;base64,([^"]*)" alt="[^"]+">', page)
    assert len(images) == page.count("<img") > 8
    for data in images:
        assert base64.b64decode(data, validate=True).startswith(b"\x89PNG")
    assert not re.findall(r"href\s*=|url\(|@import|fetch\(|https?://", page)
    assert "A &lt;twin&gt; &amp; more" in page
    assert "members of the search agree" in page


def test_the_page_says_what_is_not_determined(page):
    verdict = page[page.index('class="verdict"') :]
    verdict = verdict[: verdict.index("</div>")]
    assert "alpha_s is not identifiable" in verdict
    assert "alpha_s" not in verdict.split("The tests identify")[1].split("</p>")[0]
    rows = re.findall(r"<tr><td[^>]*>alpha_s</td>(.*?)</tr>", page)
    parameters, _, _ = rows  # and the intervals and the correlation
    assert "not identifiable" in parameters
    assert "no end within the bounds" in parameters
    assert "%)" not in parameters


FEW = {
    "one measurement": (
        "500,15,0.2,",
        "Best identifiable combination",
        "the fit passes through every measurement",
    ),
    "limits alone": (
        "500,15,<0.3,>0.1\n500,25,>0.05,<0.5",
        "No combination of them is identifiable",
        "None: only limits are known, which have no residuals.",
    ),
}


@pytest.mark.parametrize(("rows", "words", "of_residuals"), FEW.values(), ids=FEW)
def test_a_report_of_next_to_nothing(tmp_path, capsys, rows, words, of_residuals):
    """Interrupted at first, which leaves no result behind."""
    text = "mass_kg,speed_mps,e_n,max_penetration_m\n" + rows
    (tmp_path / "tests.csv").write_text(text + "\n")
    study = 'data = "tests.csv"\nstarts = 2\naccuracy = "balanced"\n'
    if ",>0.1" not in rows:
        study += 'targets = ["e_n"]\n'
    (tmp_path / "study.toml").write_text(study)
    out = tmp_path / "out"
    command = ["calibrate", str(tmp_path / "study.toml"), "--out", str(out)]

    def interrupt(*arguments, **named):
        raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(api, "fit_study", interrupt)
        assert main(command) == 130
    assert [path.name for path in out.iterdir()] == ["jaximpact-study.json"]
    capsys.readouterr()
    assert main(command) == 0
    report = capsys.readouterr().out
    assert "No parameter is identifiable" in report
    assert words in " ".join(report.split())
    table = report.split("  bounds\n")[1].split("\n\n")[0]
    assert table.count("not identifiable") == 3
    assert report.count("None: ") == 1
    assert of_residuals in " ".join(report.split())
    json.loads((out / "fit.json").read_text())
