"""The forward model of the fits: by machine code and by XLA, the same numbers."""

import jax
import numpy as np
import pytest
from calibration_studies import objective_of, study_of_columns

from jaximpact import Scene
from jaximpact.calibration import fit_study, read_study
from jaximpact.calibration.estimation.search import SOME_TESTS, some_tests
from jaximpact.calibration.problem.forward_model import models_of
from jaximpact.calibration.problem.objective import Objective
from jaximpact.calibration.problem.program import SIZES, ImpactProgram, _kept
from jaximpact.quantities import INPUT_COLUMNS, leaf_places

pytestmark = pytest.mark.slow

STUDY = 'data = "tests.csv"\n'
TABLE = """\
mass_kg,aspect_ratio,speed_mps,angle_deg,orientation_deg,e_n,max_sinking_m
500,2,15,40,30,0.1,0.2
100,1,8,20,0,0.1,0.2
"""
SOILS = ([0.5, 1.7, 900.0], [2.0, 5.0, 300.0])


@pytest.fixture
def study(tmp_path):
    (tmp_path / "tests.csv").write_text(TABLE)
    (tmp_path / "study.toml").write_text(STUDY)
    return read_study(tmp_path / "study.toml")


def test_every_column_is_a_leaf_of_the_scene(study):
    """What stands in a column's leaf is its value in SI."""
    scene, places = study.tests.scene({}), leaf_places(Scene())
    leaves = jax.tree.leaves(scene)
    assert set(places) == set(INPUT_COLUMNS)
    for name, column in INPUT_COLUMNS.items():
        value = getattr(getattr(scene, column.part), column.field)
        np.testing.assert_array_equal(leaves[places[name]], value)


def test_machine_code_and_xla_agree(monkeypatch):
    """Of vertical drops, whose model XLA compiles fastest. Steps differ by rounding
    alone, so that results agree far beyond the tolerance of 1e-8 with which both
    integrate; derivatives follow steps less closely."""
    drops = {"mass_kg": [500, 100], "speed_mps": [15, 8]}
    study = study_of_columns(drops | {"e_n": [0.1, 0.1], "max_sinking_m": [0.2, 0.2]})
    usual = objective_of(study)
    x = usual.bounds.coordinate(SOILS)
    expected = usual(x)
    monkeypatch.setattr(
        "jaximpact.backend.kernel_choice.computes_on_cpu", lambda: False
    )
    _kept.cache_clear()
    by_xla = models_of(study)[0]
    _kept.cache_clear()
    assert (usual.model.engine, by_xla.engine) == ("machine code", "XLA")
    received = Objective(study, study.variants[0], by_xla)(x)
    np.testing.assert_allclose(received.predicted, expected.predicted, rtol=1e-6)
    largest = np.max(np.abs(expected.jacobian), axis=(0, 1, 3), keepdims=True)
    np.testing.assert_allclose(
        received.jacobian / largest, expected.jacobian / largest, atol=1e-4
    )
    np.testing.assert_array_equal(received.outcomes, expected.outcomes)


def test_tests_without_a_measurement_change_no_cost(study):
    objective = objective_of(study)
    rest = objective.without(np.array([False, True]))
    x = objective.bounds.coordinate(SOILS)
    found, expected = rest.of_measured()(x), rest(x)
    assert found.predicted.shape == (2, 1, 2)
    # Impacts are the same; sums of fewer zeros differ by rounding.
    np.testing.assert_allclose(found.cost, expected.cost, rtol=1e-13)
    np.testing.assert_allclose(found.hessian, expected.hessian, rtol=1e-12)
    assert objective.of_measured() is objective


def test_values_alone_are_the_same_numbers(study):
    """To the last bit: which code computes them, and for how many impacts it was
    compiled, nobody shall see."""
    objective = objective_of(study)
    x = objective.bounds.coordinate(SOILS)
    expected = objective(x)
    for times in (1, SIZES[1] // len(TABLE.splitlines())):
        found = objective.values(np.tile(x, (times, 1))).take(slice(2))
        for name in ("predicted", "outcomes", "cost"):
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))
        assert not np.any(found.jacobian)
        assert not np.any(found.gradient)


def test_the_cost_by_jax_is_that_of_numpy(study):
    """Its gradient too, as NUTS has it."""
    objective = objective_of(study)
    x = objective.bounds.coordinate(SOILS)
    expected = objective(x)
    cost, gradient = jax.vmap(jax.value_and_grad(objective.cost))(x)
    np.testing.assert_allclose(cost, expected.cost, rtol=1e-12)
    # Derivatives of impacts have errors of 5e-7 of the largest.
    largest = np.max(np.abs(expected.gradient))
    np.testing.assert_allclose(gradient, expected.gradient, atol=2e-6 * largest)


def test_many_tests_are_begun_with_some(tmp_path, monkeypatch):
    """A fit whose search saw half of the tests ends where one ends that saw all."""
    angles = np.linspace(0.0, 60.0, 12)
    restitution = 0.3 - 0.2 * angles / 60.0
    rows = (f"{a},{e}" for a, e in zip(angles, restitution, strict=True))
    (tmp_path / "tests.csv").write_text("\n".join(["angle_deg,e_n", *rows]))
    (tmp_path / "study.toml").write_text(STUDY + "starts = 6\n")
    study = read_study(tmp_path / "study.toml")
    expected = fit_study(study).variants[0]
    told = []
    monkeypatch.setattr("jaximpact.calibration.estimation.search.MANY_TESTS", 8)
    monkeypatch.setattr("jaximpact.calibration.estimation.search.SOME_TESTS", 6)
    found = fit_study(study, progress=told.append).variants[0]
    assert any(line.startswith("6 tests, search, generation 1") for line in told)
    assert found.predicted.shape == (12, 1)
    # Both end some thousandths of a standard error from the minimum.
    error = 1e-2 * found.sigma[0, 0]
    assert found.cost == pytest.approx(expected.cost, rel=1e-5)
    np.testing.assert_allclose(found.predicted, expected.predicted, atol=error)
    assert np.all(found.end_costs >= found.cost * (1.0 - 1e-9))


def test_some_tests_hold_what_is_seldom_measured(tmp_path):
    """Of 1000 tests of e_n, five with a depth and one without anything."""
    rows = [f"{i % 80},0.2," for i in range(1000)]
    rows[10] = "10,,"
    for place in (3, 500, 700, 800, 999):
        rows[place] = f"{place % 80},0.2,0.1"
    (tmp_path / "tests.csv").write_text(
        "\n".join(["angle_deg,e_n,max_sinking_m", *rows])
    )
    chosen = some_tests(read_study(tmp_path / "tests.csv"))
    assert {3, 500, 700, 800, 999} <= set(chosen)
    assert 10 not in chosen
    assert SOME_TESTS // 2 <= len(chosen) <= SOME_TESTS


def test_a_derivative_without_bound_spoils_no_fit(study, monkeypatch):
    """It counts as none, like that of a result that could not be computed; the other
    lane and the other target keep theirs."""

    run = ImpactProgram.run

    def steep(*arguments, derivatives):
        values, outcomes, slopes = run(*arguments, derivatives=derivatives)
        slopes[0, 0], slopes[1, 0] = np.inf, 1e200
        return values, outcomes, slopes

    objective = objective_of(study)
    x = objective.bounds.coordinate(SOILS)
    usual = objective(x)
    monkeypatch.setattr(ImpactProgram, "run", steep)
    found = objective(x)
    assert np.all(np.isfinite(found.hessian))
    assert np.all(np.isfinite(found.gradient))
    np.testing.assert_array_equal(found.hessian[1], usual.hessian[1])
    assert np.any(found.hessian[0] != usual.hessian[0])
