"""Singular matrices, and the smallest studies that lead to them."""

import numpy as np
import pytest

from jaximpact.calibration import calibrate
from jaximpact.calibration.estimation.linear_algebra import inverse_positive
from jaximpact.calibration.problem.forward_model import ForwardModel

TESTS = {
    "mass_kg": [100.0, 100.0, 500.0, 500.0],
    "speed_mps": [5.0, 15.0, 5.0, 15.0],
    "angle_deg": [10.0, 40.0, 30.0, 20.0],
    "e_n": [0.22, 0.11, 0.15, 0.12],
}


def test_regular_matrices_are_inverted():
    random = np.random.default_rng(0)
    rows = random.normal(size=(3, 6, 4)) * [1.0, 1e4, 1e-4, 1.0]
    matrix = np.swapaxes(rows, 1, 2) @ rows
    expected = np.linalg.inv(matrix)
    # Condition numbers of some 1e17 by scale alone, 1e2 once scaled: 1e-16 * 1e2 * 1e2.
    np.testing.assert_allclose(inverse_positive(matrix), expected, rtol=1e-9)


def test_inverse_of_a_singular_matrix_is_finite_and_positive():
    row = np.array([1.0, 1e6, 0.0])
    received = inverse_positive(1e20 * np.outer(row, row) + np.diag([0.0, 0.0, 1.0]))
    assert np.all(np.isfinite(received))
    assert np.all(np.linalg.eigvalsh(received) > 0.0)


def few(count: int) -> dict:
    return {name: values[:count] for name, values in TESTS.items()}


def bounds(lower: float, upper: float) -> dict:
    return {"lower": lower, "upper": upper, "start": 0.5 * (lower + upper)}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("tests", "fit", "word"),
    [
        (few(1), None, "not identifiable"),
        # Along the normal the friction of the base has no effect.
        (
            few(4) | {"angle_deg": 0.0},
            {"c_v": {}, "alpha_s": bounds(0.1, 2.0)},
            "no influence",
        ),
        # Both act through the peak friction angle alone.
        (
            few(4),
            {"relative_density": bounds(0.5, 0.9), "delta_2": bounds(0.1, 1.4)},
            "acts only together with delta_2",
        ),
    ],
    ids=["one test", "no influence", "same influence"],
)
def test_studies_without_full_rank_end_with_a_verdict(tests, fit, word):
    found = calibrate(tests, fit=fit, starts=2)
    assert not all(entry["determined"] for entry in found.parameters.values())
    assert np.isfinite(found.result.variants[0].cost)
    assert word in " ".join(str(found).split())


@pytest.mark.slow
def test_a_study_of_one_test_that_does_not_fail(monkeypatch):
    """All others are computed to nothing."""
    evaluate = ForwardModel.evaluate

    def failing(*arguments, derivatives):
        predicted, *others = evaluate(*arguments, derivatives=derivatives)
        lost = np.arange(predicted.shape[1]) % 4 != 1
        predicted[:, lost] = np.nan
        return predicted, *others

    monkeypatch.setattr(ForwardModel, "evaluate", failing)
    found = calibrate(few(4), fit={"c_v": {}, "gamma_v": {}}, starts=2)
    assert not any(entry["determined"] for entry in found.parameters.values())
    assert "3 predictions could not be computed" in str(found)
