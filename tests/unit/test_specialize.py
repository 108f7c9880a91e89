"""Leaving out arithmetic on values known when a program is built."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaximpact.backend.xla_compilation import UNFUSED
from jaximpact.impact.specialize import leave_out_known


def mixed(x, y, z):
    """Whatever y = 0 does away with, and what it does not."""
    return {
        "gone": y * jnp.sin(x) / (1.0 + x * x) + jnp.where(y > 0.0, jnp.exp(x), y),
        "stays": jnp.sqrt(x * z) + y,
        "known": jnp.exp(y),
        "clipped": jnp.clip(x, -1.0, y + 0.5),
    }


def compiled(function, *arguments):
    """Program that XLA makes, without fusion, as text."""
    return (
        jax.jit(function, compiler_options=UNFUSED)
        .lower(*arguments)
        .compile()
        .as_text()
    )


POINT = np.array([0.3, 1.7]), np.array([2.0, 0.4])


@pytest.mark.parametrize("value", [0.0, 1.0, 0.7])
def test_result_is_that_of_the_function(value):
    x, z = map(jnp.asarray, POINT)
    found = leave_out_known(mixed, {1: value})(x, z)
    expected = mixed(x, jnp.full_like(x, value), z)
    assert jax.tree.structure(found) == jax.tree.structure(expected)
    for name, values in expected.items():
        # Arithmetic in another order.
        np.testing.assert_allclose(found[name], values, rtol=1e-15)


def test_arithmetic_on_zero_is_left_out():
    x, z = map(jnp.asarray, POINT)
    reduced = leave_out_known(mixed, {1: 0.0})
    program = compiled(reduced, x, z)
    assert " sine(" not in program
    assert " exponential(" not in program
    assert " sqrt(" in program
    assert " sine(" in compiled(mixed, x, z, x)


def test_derivatives_and_vmap_go_through():
    x, z = map(jnp.asarray, POINT)

    def whole(x, z):
        return sum(mixed(x, jnp.zeros_like(x), z).values())

    def reduced(x, z):
        return sum(leave_out_known(mixed, {1: 0.0})(x, z).values())

    for argument in (0, 1):
        slopes = [
            jax.jit(jax.vmap(jax.grad(function, argument)))(x, z)
            for function in (reduced, whole)
        ]
        np.testing.assert_allclose(*slopes, rtol=1e-14)


def test_nothing_known_is_the_function_itself():
    assert leave_out_known(mixed, {}) is mixed
