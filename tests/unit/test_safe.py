"""Safe functions: finite with their gradient at the singular point, also batched."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaximpact.laws import safe_power, safe_sqrt

# Rounding of one or two elementary functions.
ROUNDING = 1e-14

ONE_VARIABLE = {
    "sqrt": safe_sqrt,
    "power 0.4": lambda x: safe_power(x, 0.4),
    "power 1": lambda x: safe_power(x, 1.0),
    "power 2": lambda x: safe_power(x, 2.0),
}
PLAIN = {
    "sqrt": (np.sqrt, lambda x: 0.5 / np.sqrt(x)),
    "power 0.4": (lambda x: x**0.4, lambda x: 0.4 * x**-0.6),
    "power 1": (lambda x: x, lambda x: np.ones_like(x)),
    "power 2": (lambda x: x**2, lambda x: 2.0 * x),
}


@pytest.mark.parametrize("name", ONE_VARIABLE)
@pytest.mark.parametrize("point", [0.0, -0.0, -1.0, -1e300])
def test_zero_with_zero_gradient_at_and_below_the_singular_point(name, point):
    function = ONE_VARIABLE[name]
    for differentiate in (jax.grad, jax.jacfwd):
        assert function(point) == 0.0
        assert differentiate(function)(point) == 0.0


@pytest.mark.parametrize("name", ONE_VARIABLE)
def test_batched_over_the_singular_point(name):
    # One lane at the singular point must not spoil its neighbours, nor they it.
    points = jnp.asarray([-2.0, 0.0, 1e-12, 0.3, 4.0])
    value, slope = jax.vmap(jax.value_and_grad(ONE_VARIABLE[name]))(points)
    plain_value, plain_slope = PLAIN[name]
    positive = np.asarray(points[2:])
    np.testing.assert_array_equal(value[:2], 0.0)
    np.testing.assert_array_equal(slope[:2], 0.0)
    # The power is an exponential of a logarithm near -28, whose rounding it magnifies.
    np.testing.assert_allclose(value[2:], plain_value(positive), rtol=28 * ROUNDING)
    np.testing.assert_allclose(slope[2:], plain_slope(positive), rtol=28 * ROUNDING)


def test_power_is_differentiable_in_its_exponent():
    slope = jax.grad(safe_power, argnums=1)
    assert slope(0.0, 0.4) == 0.0
    expected = np.log(0.3) * 0.3**0.4
    np.testing.assert_allclose(slope(0.3, 0.4), expected, rtol=ROUNDING)
