"""The benchmark: what it counts, that it goes on after an interruption, and that peers
solve the same impacts."""

import importlib
import json
import os
import sys

import jax
import numpy as np
import pandas as pd
import pytest
from error_messages import assert_one_line_error
from text_files import rows_of

from benchmarks.__main__ import make_parser
from benchmarks.charts import Settings, code_for_avx2, run, run_benchmark
from benchmarks.charts.explicit_step import LIMIT, fastest_rates, steps_needed
from benchmarks.charts.gradients import difference_gradient, forward_gradient
from benchmarks.charts.methods import Answer, Ours, count_of, find_peers
from benchmarks.charts.section import Bench, error_figures, interleaved_minima
from benchmarks.charts.stability import VERDICTS, believed, verdict
from benchmarks.charts.target import coarsest_within
from benchmarks.charts.work_precision import gradient_of
from benchmarks.impacts import mixed_scenes
from jaximpact import simulate_batch
from jaximpact.backend.simd import LEVELS, host
from jaximpact.cli import main

pytestmark = pytest.mark.slow

TINY = Settings(
    scenes=8,
    singles=2,
    budget_s=1e-3,
    least_impacts=4,
    repeats=1,
    jax_scenes=8,
    jax_singles=2,
    jax_repeats=1,
    batch_sizes=(1, 8),
    map_points=3,
    sweep_points=2,
    slider_times=(1e-5,),
    target_scenes=16,
    target_tuning_scenes=8,
    target_repeats=1,
)
FAKE = """
import numpy as np
from typing import NamedTuple

class Answer(NamedTuple):
    e_n: np.ndarray
    seconds: float

class Fake:
    name, family, tolerances = "fake", "numbalsoda", (1e-1, 1e-4)

    def solve(self, scenes, tolerance, batch):
        return Answer(np.asarray(scenes.block.aspect_ratio) + tolerance, 1e-3)

def methods():
    return [Fake()]
"""


class Known:
    """A method whose e_n is A_r, but for an error that is its tolerance."""

    name = family = "jaximpact"
    tolerances = (1e-2, 1e-5)

    def __init__(self):
        self.calls = 0

    def solve(self, scenes, tolerance, batch):
        self.calls += 1
        return Answer(np.asarray(scenes.block.aspect_ratio) + tolerance, 1e-3)


@pytest.fixture
def known(monkeypatch):
    """The method in place of this solver, and of what is exact."""
    method = Known()
    monkeypatch.setattr(run, "Ours", lambda: method)
    monkeypatch.setattr(run, "methods_for_avx2", lambda: [])
    for module in ("work_precision", "target", "stability"):
        place = importlib.import_module(f"benchmarks.charts.{module}")
        monkeypatch.setattr(
            place,
            "exact_e_n",
            lambda scenes, slider_time=None: np.asarray(scenes.block.aspect_ratio),
        )
    return method


@pytest.fixture
def peers(tmp_path, monkeypatch):
    """A directory with a peer, and one whose package is not installed."""
    place = tmp_path / f"peers_of_{tmp_path.name.replace('-', '_')}"
    place.mkdir()
    (place / "__init__.py").write_text("")
    (place / "fake_peer.py").write_text(FAKE)
    (place / "absent_peer.py").write_text("import no_such_package\n")
    monkeypatch.setattr(sys, "path", list(sys.path))
    return place


def test_failures_count_as_infinitely_wrong_and_unknowns_not_at_all():
    exact = np.array([0.0, 0.0, 0.0, 0.0, np.nan])
    found = error_figures(np.array([1e-3, 2e-3, 3e-3, np.nan, 5.0]), exact)
    assert found["error_median"] == pytest.approx(3e-3)
    assert found["error_95"] == np.inf
    assert found["failed"] == 0.25


def test_tasks_are_measured_in_turn_and_slow_ones_once():
    order, times = [], {"quick": iter([2.0, 1.0, 3.0]), "slow": iter([20.0])}

    def task(name):
        return lambda: order.append(name) or next(times[name])

    tasks = [task("quick"), task("slow")]
    assert interleaved_minima(tasks, 3, 10.0, lambda text: None) == [1.0, 20.0]
    assert order == ["quick", "slow", "quick", "quick"]


def test_every_section_has_its_files(known, peers, tmp_path):
    out = tmp_path / "new" / "out"
    names = ["work-precision", "target", "throughput", "stability"]
    said = []
    text = run_benchmark(out, only=names, peers=peers, settings=TINY, say=said.append)
    for name in names:
        assert name in text
        assert (out / f"{name}.png").stat().st_size > 5_000
        assert (out / f"{name}.md").read_text().startswith("| method |")
    # What is not there is told in one line.
    assert [line for line in said if "no_such_package" in line]
    assert not [line for line in said if "\n" in line]
    manifest = json.loads((out / "manifest.json").read_text())
    assert set(manifest) == set(names)
    assert manifest["target"]["methods"] == ["jaximpact", "fake"]
    assert manifest["target"]["versions"]["jax"] == jax.__version__
    rows = rows_of(out / "work-precision.csv")
    assert {row["mode"] for row in rows} == {"single", "batch"}
    for row in rows:
        # The error of these methods is their tolerance, to rounding.
        assert float(row["error_95"]) == pytest.approx(float(row["tolerance"]))
        assert float(row["seconds_per_impact"]) == 1e-3 / float(row["impacts"])


def test_interrupted_benchmark_goes_on(known, tmp_path, peers, monkeypatch):
    def interrupted(bench):
        raise KeyboardInterrupt

    whole = run.SECTIONS["throughput"]
    monkeypatch.setitem(run.SECTIONS, "throughput", whole._replace(measure=interrupted))
    out = tmp_path / "out"
    both = {"only": ["target", "throughput"], "peers": peers, "settings": TINY}
    with pytest.raises(KeyboardInterrupt):
        run_benchmark(out, **both)
    assert not (out / "throughput.csv").exists()
    first, calls = (out / "target.csv").read_bytes(), known.calls

    monkeypatch.setitem(run.SECTIONS, "throughput", whole)
    (out / "target.png").unlink()
    said = []
    run_benchmark(out, **both, say=said.append)
    assert (out / "target.csv").read_bytes() == first
    assert (out / "target.png").exists()
    assert (out / "throughput.csv").exists()
    assert [line for line in said if line.startswith("target: measured before")]

    # Other settings, or data that were changed, are measured again.
    calls = known.calls
    run_benchmark(out, **both)
    assert known.calls == calls
    (out / "target.csv").write_text("changed\n")
    run_benchmark(out, **both)
    assert (out / "target.csv").read_text() != "changed\n"


def test_target_takes_the_coarsest_tolerance_that_is_within(known):
    class Halved(Known):
        family = "a peer"
        tolerances = (2e-3, 5e-4, 1e-4)

    bench = Bench(TINY, [], "", lambda text: None)
    scenes = mixed_scenes(8, 0)
    exact = np.asarray(scenes.block.aspect_ratio)
    assert coarsest_within(bench, Halved(), scenes, exact) in (5e-4, 1e-4)
    assert coarsest_within(bench, Halved(), scenes, exact + 1.0) is None


def test_verdicts():
    assert [verdict(*pair) for pair in ((0.1, 0.105), (0.1, 0.2), (np.nan, 0.1))] == [
        *VERDICTS[:3]
    ]
    assert verdict(0.1, np.nan) == VERDICTS[3]
    first, second = np.array([0.1, 0.1, np.nan]), np.array([0.1001, 0.2, 0.3])
    np.testing.assert_array_equal(believed(first, second), [0.1, np.nan, 0.3])


def test_differences_are_those_of_the_logarithms():
    class Logarithms(Known):
        def solve(self, scenes, tolerance, batch):
            soil = scenes.soil
            e_n = np.log(soil.k_E) + 2.0 * np.log(soil.gamma_v) + 3.0 * np.log(soil.c_v)
            return Answer(np.asarray(e_n), 1.0)

    scenes = mixed_scenes(5, 0)
    found, seconds = difference_gradient(Logarithms(), 1e-3, 0.1, scenes, batch=True)
    # Linear in the logarithms: exact but for rounding over the step.
    np.testing.assert_allclose(found, [[1.0, 2.0, 3.0]] * 5, rtol=1e-12)
    assert seconds == 7.0  # the value and two sides of three parameters


def test_peers_take_their_own_derivatives_and_slow_differences_are_left_out():
    class WithGradient(Known):
        def gradient(self, scenes, batch, tolerance):
            return np.full((count_of(scenes), 3), tolerance), 1.0

    class Slow(Known):
        def solve(self, scenes, tolerance, batch):
            return super().solve(scenes, tolerance, batch)._replace(seconds=100.0)

    told = []
    bench = Bench(TINY, [], "", told.append)
    scenes, exact = mixed_scenes(4, 0), np.zeros((4, 3))
    own = gradient_of(bench, WithGradient(), 1e-3, scenes, exact)
    np.testing.assert_array_equal(own(scenes, batch=True)[0], np.full((4, 3), 1e-3))
    assert gradient_of(bench, Known(), 1e-3, scenes, exact) is not None
    assert gradient_of(bench, Slow(), 1e-3, scenes, exact) is None
    assert "left out" in told[-1]


def test_fastest_rate_and_steps_needed():
    scales = np.array([[1.0, 1e-6, 1e3]])
    rotation = np.array([[0.0, 2.0, 0.0], [-2.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    # A change of units leaves the eigenvalues 2i, -2i and -1.
    jacobian = rotation * scales[0][:, None] / scales[0]
    np.testing.assert_allclose(fastest_rates(jacobian[None], scales), [2.0])
    rows = pd.DataFrame({"time_s": [0.0, 1e-3], "stable_step_s": LIMIT / 1e6})
    assert steps_needed(rows) == pytest.approx(1e3 / LIMIT)


@pytest.mark.parametrize(
    "package", ["numbalsoda", "scipy", "sksundae", "diffrax", "diffsol_jax"]
)
def test_every_peer_answers(package):
    pytest.importorskip("numba")
    pytest.importorskip(package)
    said = []
    found = find_peers(None, said.append)
    name = {
        "sksundae": "CVODE",
        "diffrax": "diffrax Kvaerno3",
        "scipy": "SciPy LSODA",
        "diffsol_jax": "diffsol BDF",
    }.get(package, package)
    peer = next(method for method in found if method.name.startswith(name))
    scenes = mixed_scenes(3, seed=5)
    exact = simulate_batch(scenes).e_n
    answer = peer.solve(scenes, 1e-4, batch=False)
    # Ten times what they were measured to err by at that tolerance.
    np.testing.assert_allclose(answer.e_n, exact, atol=5e-3)
    assert answer.seconds > 0.0
    # In processes or threads of their own
    others = peer.solve(scenes, 1e-4, batch=True)
    np.testing.assert_allclose(others.e_n, answer.e_n, atol=1e-6)


def level_of(scenes):
    """The level of processors for which this process makes code."""
    return host()[0]


@pytest.mark.skipif(host()[0] not in LEVELS, reason="a processor without AVX2")
def test_code_for_avx2_runs_in_its_own_process_and_gives_the_same_bits():
    method, scenes = code_for_avx2.OursForAvx2(), mixed_scenes(9, seed=5)
    assert code_for_avx2._in_process(level_of, scenes) == code_for_avx2.LEVEL
    for batch in (True, False):
        there = method.solve(scenes, 1e-3, batch)
        np.testing.assert_array_equal(there.e_n, Ours().solve(scenes, 1e-3, batch).e_n)
        assert there.seconds > 0.0
        found, _ = method.gradient(scenes, batch, 1e-3)
        np.testing.assert_array_equal(found, forward_gradient(scenes, batch, 1e-3)[0])


def ends_its_process(p, start, tolerance, at):
    """Give e_n, but for a few impacts at which all ends, as a library may do it."""
    if p[0] in at:
        os._exit(1)
    return p[0]


def test_an_impact_that_ends_its_process_is_not_finished():
    pytest.importorskip("numba")
    model = importlib.import_module("benchmarks.peers.model")
    shared = importlib.import_module("benchmarks.peers.shared")
    p, start = model.parameters_and_start(mixed_scenes(40, seed=5), 1e-6)
    p[:, 0] = np.arange(40.0)
    lost = {7.0, 39.0}
    answer = shared.solve_scenes(ends_its_process, p, start, 1e-3, True, at=lost)
    expected = [np.nan if number in lost else number for number in p[:, 0]]
    np.testing.assert_array_equal(answer.e_n, expected)


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ("--out out --only work-precison", ["did you mean work-precision?"]),
        ("--out out --peers .", ["--peers", "*_peer.py"]),
        ("--out file/out", ["--out"]),
    ],
)
def test_what_cannot_be_used_is_a_one_line_error(folder, capsys, arguments, parts):
    (folder / "file").touch()
    assert main(arguments.split(), make_parser) == 2
    assert_one_line_error(capsys, *parts)
