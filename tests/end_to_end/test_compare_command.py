"""`jaximpact calibrate` with a comparison of laws, and its files."""

import csv
import json

import numpy as np
import pytest
from calibration_studies import write_study_of

from jaximpact.cli import main

STUDY = """
data = "tests.csv"
starts = 4
[compare]
laws = ["model", "constant coefficients", "Pfeiffer and Bowen", "my_laws.py:Halving"]
by = "speed_mps"
"""
LAW = '''
from jaximpact.parameters import parameter
from jaximpact.rebound import AbstractRebound, Rebound

class Halving(AbstractRebound):
    """e_n of half its value at a speed."""

    half_speed: float = parameter(
        8.0, "m/s", "(0, inf)", "speed of half the rebound", usual=(1.0, 100.0)
    )

    def __call__(self, block, impact):
        part = 1.0 / (1.0 + impact.speed / self.half_speed)
        return Rebound(
            -part * impact.normal_velocity,
            0.8 * impact.tangential_velocity,
            impact.angular_velocity,
        )
'''
COLUMNS = ("mass_kg", "speed_mps", "angle_deg", "e_n", "max_penetration_m")


def rows(count=10):
    random = np.random.default_rng(0)
    speeds = np.repeat([4.0, 7.0, 10.0, 14.0, 20.0], count // 5)
    e_n = 1.0 / (1.0 + speeds / 6.0) + 0.01 * random.normal(size=count)
    angles = np.tile([10.0, 40.0], count // 2)
    depth = 0.02 * speeds
    return [[100.0, *values] for values in zip(speeds, angles, e_n, depth, strict=True)]


@pytest.mark.slow
def test_a_study_compares_laws(tmp_path, capsys):
    path = write_study_of(tmp_path, STUDY, COLUMNS, rows())
    (tmp_path / "my_laws.py").write_text(LAW)
    out = tmp_path / "out"
    assert main(["calibrate", str(path), "--out", str(out)]) == 0
    text = capsys.readouterr().out
    assert "Laws compared" in text
    assert "Left out: max_penetration_m" in text
    words = "use Halving: it predicts tests left out better than all other laws"
    assert words in " ".join(text.split())
    page = (out / "report.html").read_text()
    assert "Which law the tests prefer" in page
    tree = json.loads((out / "fit.json").read_text())
    assert tree["comparison"]["preferred"] == "Halving"
    # Six standard errors of a tenth.
    (own,) = (law for law in tree["comparison"]["laws"] if law["law"] == "Halving")
    assert own["values"] == pytest.approx([6.0], abs=0.6)
    assert [law["law"] for law in tree["simple_laws"]] == [
        "constant coefficients",
        "Pfeiffer and Bowen",
    ]
    lines = list(csv.DictReader((out / "comparison.csv").read_text().splitlines()))
    assert {line["law"] for line in lines} >= {"model", "Halving"}
    assert len(lines) == 4 * len(rows())
    # Predictions stand beside those of the simple laws, of the file too.
    assert main(["predict", str(out), str(tmp_path / "tests.csv")]) == 0
    text = capsys.readouterr().out
    assert "Simple laws fitted to the same tests" in text
    assert "constant coefficients" in text
    assert f"laws of rebound included, {words}" in " ".join(text.split())
