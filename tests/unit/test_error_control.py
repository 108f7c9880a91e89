"""Widths of steps from their errors."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaximpact.integrator.error_control import ErrorControl
from jaximpact.integrator.rosenbrock import ORDER


class Errors(NamedTuple):
    """Errors of unknowns in units of what is allowed."""

    vector: jax.Array


def after_step(error, error_before=1.0, width=2.0):
    """Whether the step from 3 is kept, begin and width of the next, and the error to
    remember."""
    keep, begin, end, _, remembered, _ = ErrorControl().adapt_step_size(
        *(jnp.asarray(3.0), jnp.asarray(3.0 + width), None, None, None),
        Errors(jnp.asarray([error, -error])),
        ORDER,
        jnp.asarray(error_before),
    )
    return bool(keep), float(begin), float(end - begin), float(remembered)


@pytest.mark.parametrize("error", [0.01, 0.3, 0.999])
def test_the_next_width_follows_from_two_errors(error):
    keep, begin, width, remembered = after_step(error, 0.5)
    assert (keep, begin) == (True, 5.0)
    expected = 0.85 * error**-0.2 * 0.5**0.02
    np.testing.assert_allclose(width, 2.0 * expected, rtol=1e-14)
    np.testing.assert_allclose(remembered, error, rtol=1e-15)


def test_a_step_that_is_almost_too_long_is_kept_and_the_next_one_is_shorter():
    keep, _, width, _ = after_step(0.9)
    assert keep
    assert width < 2.0


@pytest.mark.parametrize("error", [1.0, 1.2, 1e6])
def test_a_step_that_is_too_long_is_taken_again_shorter(error):
    keep, begin, width, remembered = after_step(error, 1e-4)
    assert (keep, begin, remembered) == (False, 3.0, 1e-4)
    rounding = 1e-12
    assert 0.2 * 2.0 - rounding < width < 0.85 * 2.0 + rounding


def test_a_width_grows_tenfold_at_most():
    keep, _, width, remembered = after_step(0.0)
    assert keep
    # 0.85 of the factor that the least error counted allows
    np.testing.assert_allclose(width, 2.0 * 8.5, rtol=1e-12)
    assert remembered > 0.0
