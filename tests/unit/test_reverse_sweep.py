"""Gradients in reverse mode, of lanes that end at different steps: those of JAX."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaximpact.backend.simd import (
    Kernel,
    KernelSet,
    LaneFunctions,
    NoMachineCode,
    Reverse,
    compile_reverse,
)

LANES = 21
"""Not a multiple of the eight lanes of a vector."""
DRAW = np.random.default_rng(4)
INPUTS = np.stack([DRAW.uniform(1.0, 90.0, LANES), DRAW.uniform(0.9, 1.1, LANES)])
WEIGHTS = DRAW.normal(size=(2, LANES))


def begin(inputs):
    steps, factor = inputs
    still = jnp.zeros_like(steps)
    return steps, factor, jnp.sin(factor), still, still


def advance(state):
    """A step that is accepted."""
    left, factor, x, total, accepted = state
    return left, factor, factor * jnp.cos(x), total + x * factor, accepted


def step(state):
    """A third of the steps are rejected, which leaves all as it is but those left. A
    lane that has ended stands still."""
    going = state[0] > 0.0
    keep = going & (jnp.sin(2.0 * state[0]) > -0.5)
    left, factor, *changed, accepted = (
        jnp.where(keep, new, old)
        for new, old in zip(advance(state), state, strict=True)
    )
    left, accepted = jnp.where(going, left - 1.0, left), accepted + keep
    return (left, factor, *changed, accepted), left > 0.0


def finish(inputs, state):
    return state[2] * inputs[1], jnp.log(state[3])


def gradient(finish=finish, advance=advance):
    reverse = Reverse((1,), (1, 2, 3), advance, lambda state: state[4])
    functions = LaneFunctions(begin, step, finish)
    code = compile_reverse(functions, (jnp.ones(1), jnp.ones(1)), reverse)
    kernels = KernelSet([Kernel(code, None)])
    return kernels.compute(np.concatenate([INPUTS, WEIGHTS]), 2)[0]


def results_of(factor, steps):
    state, goes_on = begin((steps, factor)), True
    while goes_on:
        state, goes_on = step(state)
    return finish((steps, factor), state)


def test_gradients_are_those_of_jax():
    """To the rounding of 60 steps."""
    first, second, found = gradient()
    assert len({*np.floor(INPUTS[0])}) > 10
    for lane, (steps, factor) in enumerate(INPUTS.T[:11]):
        results, pull_back = jax.vjp(lambda x, n=steps: results_of(x, n), factor)
        np.testing.assert_allclose((first[lane], second[lane]), results, rtol=1e-12)
        expected = pull_back(tuple(WEIGHTS[:, lane]))
        np.testing.assert_allclose(found[lane], *expected, rtol=1e-10)


def test_results_that_are_no_number_have_no_part():
    def some(inputs, state):
        first, second = finish(inputs, state)
        return first, jnp.where(inputs[0] > 45.0, jnp.nan, second)

    found, expected = gradient(some), gradient()
    short = INPUTS[0] <= 45.0
    np.testing.assert_array_equal(found[:, short], expected[:, short])
    assert np.all(np.isnan(found[1, ~short]))
    assert np.all(np.isfinite(found[2]))
    assert np.all(found[2, ~short] != expected[2, ~short])


def test_what_jax_cannot_reverse_has_no_code():
    @jax.custom_jvp
    def forward_alone(x):
        return x

    forward_alone.defjvps(lambda step, _, x: jnp.sign(step) * jnp.abs(step))

    def advance_forward(state):
        left, factor, x, *rest = advance(state)
        return left, factor, forward_alone(x), *rest

    with pytest.raises(NoMachineCode, match="no reverse mode"):
        gradient(advance=advance_forward)
