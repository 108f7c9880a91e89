"""Variants of a study on threads of their own: the same numbers, and an end to all of
them when one fails."""

import dataclasses
import multiprocessing
import threading
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest
from test_calibration import STUDY, write_study

from jaximpact import PRESETS
from jaximpact.calibration import fit_study, read_study
from jaximpact.calibration.comparison.comparison import compare_study
from jaximpact.calibration.diagnostics.examination import examine
from jaximpact.calibration.estimation.fit_cache import FitCache
from jaximpact.calibration.problem.forward_model import engine_of
from jaximpact.calibration.problem.objective import Objective
from jaximpact.progress import Progress
from jaximpact.tasks import run_in_threads

pytestmark = pytest.mark.slow

VARIANTS = """
[[variants]]
name = "loose"
relative_density = 0.3
[[variants]]
name = "dense"
relative_density = 0.9
"""


def two_variants(folder):
    measured = np.array(
        [[0.2, 0.2, 4e4], [0.25, 0.6, 2e5], [0.1, 0.4, 8e4], [0.3, 0.7, 4e5]]
    )
    text = STUDY.replace("starts = 16", "starts = 3") + VARIANTS
    return read_study(write_study(folder, text, measured))


def test_variants_are_fitted_as_they_are_alone(tmp_path):
    """To the last bit: what runs beside an impact does not change it."""
    study = two_variants(tmp_path)
    lines = []
    both = fit_study(study, progress=lines.append).variants
    for place, variant in enumerate(study.variants):
        (alone,) = fit_study(dataclasses.replace(study, variants=(variant,))).variants
        np.testing.assert_array_equal(both[place].parameters, alone.parameters)
        np.testing.assert_array_equal(both[place].start_costs, alone.start_costs)
        assert any(line.startswith(f"{variant.name}: ") for line in lines)


def test_fits_of_an_executor_are_those_of_this_process(tmp_path, monkeypatch):
    """To the last bit: several variants, tests left out, and laws compared."""
    study, laws = two_variants(tmp_path), ["model", "ContactPressureModulus"]
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawn) as pool:
        sent, submit = [], pool.submit
        monkeypatch.setattr(
            pool, "submit", lambda task: sent.append(task) or submit(task)
        )
        here, there = (fit_study(study, executor=executor) for executor in (None, pool))
        left = [examine(here, executor=executor) for executor in (None, pool)]
        compared = [
            compare_study(study, laws, executor=executor) for executor in (None, pool)
        ]
    assert len(sent) > 10
    for one, other in zip(here.variants, there.variants, strict=True):
        np.testing.assert_array_equal(one.parameters, other.parameters)
        np.testing.assert_array_equal(one.start_costs, other.start_costs)
    for one, other in zip(*left, strict=True):
        np.testing.assert_array_equal(one.each.x, other.each.x)
        np.testing.assert_array_equal(one.each.deviation, other.each.deviation)
    one, other = compared
    assert [law.name for law in one.laws] == [law.name for law in other.laws]
    np.testing.assert_array_equal(one.by_test.scores, other.by_test.scores)


class Interrupted(ThreadPoolExecutor):
    """An executor at whose fourth fit Ctrl-C is pressed."""

    fits = 0

    def submit(self, task):
        self.fits += 1
        if self.fits > 3:
            raise KeyboardInterrupt
        return super().submit(task)


def test_an_interrupted_fit_goes_on_from_what_its_executor_had_finished(tmp_path):
    study, cache = two_variants(tmp_path), FitCache(tmp_path / "fits")
    with Interrupted(1) as pool, pytest.raises(KeyboardInterrupt):
        fit_study(study, cache=cache, executor=pool)
    kept = len([*cache.folder.iterdir()])
    assert kept > 0
    with ThreadPoolExecutor(1) as pool:
        found = fit_study(study, cache=cache, executor=pool).variants
    assert cache.found >= kept
    for one, other in zip(found, fit_study(study).variants, strict=True):
        np.testing.assert_array_equal(one.parameters, other.parameters)
        np.testing.assert_array_equal(one.start_costs, other.start_costs)


def test_results_stand_in_the_order_of_the_items():
    first_waits = threading.Event()

    def work(item, tell):
        if item == 0:
            assert first_waits.wait(10.0)
        first_waits.set()
        return item * 10

    assert run_in_threads(work, [0, 1], Progress()) == [0, 10]


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_one_that_fails_ends_the_others(error):
    both_run, turns = threading.Barrier(2, timeout=10.0), []

    def work(item, tell):
        both_run.wait()
        if item == 1:
            raise error("enough")
        for turn in range(10_000):
            turns.append(turn)
            tell("still here")
            threading.Event().wait(1e-3)

    with pytest.raises(error, match="enough"):
        run_in_threads(work, [0, 1], Progress())
    assert len(turns) < 10_000


def test_accuracy_follows_the_sigmas(tmp_path):
    """Coarser impacts only where their errors are small beside every sigma."""
    study = two_variants(tmp_path)
    objective = Objective(study, study.variants[0], engine_of(study))
    size = np.abs(study.measured)
    fine = objective.with_sigma(0.5e-3 * size)
    coarse = objective.with_sigma(2e-3 * size)
    assert objective.accuracy == PRESETS["reference"]
    assert fine.no_finer_than_sigmas().accuracy == PRESETS["reference"]
    assert coarse.no_finer_than_sigmas().accuracy == PRESETS["balanced"]
    fast = coarse.at(PRESETS["fast"])
    assert fast.no_finer_than_sigmas().accuracy == PRESETS["fast"]
