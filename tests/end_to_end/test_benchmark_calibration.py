"""The benchmark of calibration: its arithmetic, and least squares on a peer that is
known in closed form."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import calibration, least_squares
from jaximpact.calibration import read_study

pytestmark = pytest.mark.slow

SOIL = {"c_v": 2.0, "gamma_v": 5.0, "k_E": 300.0}


class Product:
    """A peer whose e_n is a product of powers, of which the angle decides."""

    seconds = 0.25

    def __init__(self, failing=()):
        self.failing, self.calls = list(failing), 0

    def e_n(self, scene):
        soil, angle = scene.soil, scene.impact.angle
        logs = np.log(soil.c_v), np.log(soil.gamma_v), np.log(soil.k_E)
        return np.exp(-0.1 * (logs[0] + angle * logs[1] + angle**2 * logs[2]))

    def solve(self, scene, tolerance, batch):
        self.calls += 1
        e_n = self.e_n(scene)
        e_n[self.failing] = np.nan
        return SimpleNamespace(e_n=e_n, seconds=self.seconds)


@pytest.fixture
def misfit():
    """Of the study, on measurements that the peer itself gives for `SOIL`."""
    study, peer = read_study(calibration.STUDY), Product()
    of_soil = study.tests.scene(study.soil | SOIL)
    study.measured[:, 0] = peer.e_n(of_soil)
    return least_squares.Misfit(study, study.variants[0], peer, 1e-6)


def test_least_squares_finds_the_soil(misfit):
    """Differences of a thousandth leave an rms of a thousandth of what there was."""
    x = misfit.bounds.coordinate([1.0, 8.7, 900.0])
    before = np.sqrt(np.mean(misfit(1.0 + misfit.bounds.fraction(x)) ** 2))
    ended = least_squares.fit(misfit, x)
    assert ended.rms < 1e-3 * before
    # The call above is not counted.
    calls = misfit.peer.calls - 1
    assert ended.impacts == calls * len(misfit.study.tests)
    assert ended.seconds == pytest.approx(calls * Product.seconds)


def test_parts_are_the_study_s_parameters(misfit):
    """At the soil that is measured nothing is left, whatever the coordinates."""
    part = 1.0 + misfit.bounds.fraction(misfit.bounds.coordinate(list(SOIL.values())))
    np.testing.assert_allclose(misfit(part), 0.0, atol=1e-12)


def test_a_failed_impact_is_large_and_finite(misfit):
    misfit.peer.failing = [3]
    residuals = misfit(np.full(3, 1.5))
    assert residuals[3] == least_squares.FAILED
    assert np.all(np.isfinite(residuals))


def test_comparison():
    """Sums, minima and proportions of made-up fits."""
    ours = calibration.Fitted("ours", np.full((2, 1), 0.05), 8.0, 15.0, 400, True)
    rms = np.array([[0.2, 0.126], [0.06, 0.0741]])
    slow = calibration.Fitted("slow", rms, 100.0, float("nan"), 90)
    head, first, second = calibration.as_rows([ours, slow], starts=4, cold=8.0)
    assert len(head) == len(first) == len(second)
    assert first[:5] == ("ours", "search", "0.0500", "0.0500", "1 of 1")
    assert first[-3:] == ("15.0", "8", "1")
    assert second[:5] == ("slow", "2", "0.2000", "0.1260", "1 of 2")
    assert second[5:8] == ("0.0600", "0.0600", "1 of 2")
    assert second[8:] == ("90", "100.0", "-", "200", "25")


def test_a_missing_package_is_one_line(monkeypatch):
    monkeypatch.setitem(sys.modules, "numba", None)
    for name in [n for n in sys.modules if n.startswith("benchmarks.")]:
        monkeypatch.delitem(sys.modules, name)
    with pytest.raises(SystemExit, match=r"pip install 'jaximpact\[peers\]'$"):
        calibration.methods_of(calibration.PEERS)
