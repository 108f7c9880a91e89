"""The problem of a study as a plain function of JAX."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaximpact.calibration import read_study, residuals
from jaximpact.calibration.problem.forward_model import models_of
from jaximpact.calibration.problem.objective import Objective, start_of

TABLE = """campaign,mass_kg,speed_mps,angle_deg,e_n,sigma_e_n,e_t
a,100,5,10,0.2,0.01,0.7
a,100,15,40,0.1,0.01,
b,500,10,30,,,0.8
b,500,12,20,0.12,0.02,0.75
"""
STUDY = """
title = "four"
data = "tests.csv"
weights = { e_t = 2.0 }
[parameters]
c_v = { start = 0.5, prior = { mean = 0.8, sd = 0.3 } }
gamma_v = { start = 6.0 }
[nuisance.slope_deg]
by = "campaign"
prior = { mean = 1.0, sd = 2.0 }
"""


@pytest.fixture
def study(tmp_path):
    (tmp_path / "tests.csv").write_text(TABLE)
    (tmp_path / "study.toml").write_text(STUDY)
    return read_study(tmp_path / "study.toml")


GROUPED = STUDY.replace(
    "[nuisance.slope_deg]",
    'k_E = { by = "campaign", group_sd = 0.3 }\n'
    'alpha_vR = { expression = "0.5 * c_v" }\n[nuisance.slope_deg]',
)


@pytest.mark.slow
@pytest.mark.parametrize("text", [STUDY, GROUPED], ids=["plain", "grouped and tied"])
def test_half_the_sum_of_squares_is_the_cost(study, text):
    study.path.write_text(text)
    study = read_study(study.path)
    function, start = residuals(study)
    objective = Objective(study, study.variants[0], models_of(study)[0])
    expected = objective(start_of(study)[None])
    received, slope = jax.jit(
        jax.value_and_grad(lambda tree: 0.5 * jnp.sum(function(tree) ** 2))
    )(start)
    # Both are machine code of the same equations at one tolerance.
    assert received == pytest.approx(expected.cost[0], rel=1e-9)
    by_x = objective.bounds.slope(start_of(study))
    flat = np.concatenate([np.ravel(slope[name]) for name in start])
    # Derivatives of impacts have errors of 5e-7 of the largest.
    largest = np.max(np.abs(expected.gradient))
    np.testing.assert_allclose(flat * by_x, expected.gradient[0], atol=2e-6 * largest)


@pytest.mark.slow
def test_a_path_and_a_variant_by_name(study):
    function, start = residuals(study.path, study.variants[0].name)
    assert function(start).shape == (3 + 3 + 1 + 2,)
