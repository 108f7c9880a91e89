"""Second derivatives by differences of first ones."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax.test_util import check_grads

from jaximpact import Block, Impact, Soil, simulate, with_second_derivatives

pytestmark = pytest.mark.slow


def assert_close(found, expected, atol):
    close = functools.partial(np.testing.assert_allclose, rtol=0.0, atol=atol)
    jax.tree.map(close, found, expected)


def test_of_a_known_function_in_every_mode():
    """To the square of the step, by the size of the fourth derivatives: 1e-4."""

    def function(tree):
        x, y = tree["x"], tree["y"]
        return jnp.array([jnp.sin(x) * y[0] ** 3, jnp.exp(x * y[1])])

    at = {"x": jnp.asarray(0.7), "y": jnp.array([1.1, 0.4])}
    twice = with_second_derivatives(function)
    np.testing.assert_array_equal(twice(at), function(at))
    jax.tree.map(
        np.testing.assert_array_equal, jax.jacfwd(twice)(at), jax.jacfwd(function)(at)
    )
    expected = jax.hessian(function)(at)
    for outer in (jax.jacfwd, jax.jacrev):
        for inner in (jax.jacfwd, jax.jacrev):
            assert_close(jax.jit(outer(inner(twice)))(at), expected, 1e-3)
    both = jax.tree.map(lambda x: jnp.stack([x, 2.0 * x]), at)
    one = jax.tree.map(lambda x: x[0], jax.vmap(jax.hessian(twice))(both))
    # Rounding, by the step
    assert_close(one, jax.hessian(twice)(at), 1e-12)


def rebound(logs):
    c_v, gamma_v = jnp.exp(logs)
    impact = Impact(speed=jnp.array([5.0, 20.0]), angle=0.5)
    soil = Soil(c_v=c_v, gamma_v=gamma_v)
    return simulate(Block(), soil, impact, accuracy="reference").e_n


def test_of_impacts_they_are_those_of_the_values():
    """Against second differences of values over 0.02, whose error is 1e-4 of some 0.01;
    and by the ways in which a library asks for them."""
    logs = jnp.log(jnp.array([0.8, 6.0]))
    twice = with_second_derivatives(rebound)
    found = jax.hessian(twice)(logs)
    step = 0.02
    for k, move in enumerate(step * np.eye(2)):
        ends = rebound(logs + move) + rebound(logs - move) - 2.0 * rebound(logs)
        np.testing.assert_allclose(found[:, k, k], ends / step**2, rtol=2e-2, atol=1e-5)
    check_grads(twice, (logs,), order=2, modes=["fwd", "rev"], eps=1e-2, rtol=1e-2)


def test_there_are_no_third_ones():
    logs = jnp.log(jnp.array([0.8, 6.0]))
    with pytest.raises(NotImplementedError, match="with_second_derivatives"):
        jax.jacfwd(jax.hessian(with_second_derivatives(rebound)))(logs)
