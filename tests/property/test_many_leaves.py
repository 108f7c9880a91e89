"""Derivatives with respect to many leaves at once, by one run of forward or reverse
mode: they are those that are taken one by one."""

import functools
import operator
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from impact_scenes import mixed_scenes

from jaximpact import Block, Impact, Scene, Soil, simulate
from jaximpact.backend import many_leaves
from jaximpact.backend.native_backend import compile_native
from jaximpact.backend.simd import host
from jaximpact.errors import NoMachineCodeWarning
from jaximpact.laws import Perzyna
from jaximpact.parameters import parameter

pytestmark = pytest.mark.slow

FAST = functools.partial(simulate, accuracy="fast", ledger=False)
COUNT = 29
"""Not a multiple of the eight lanes of a vector."""
LEAVES = len(jax.tree.leaves(Scene()))
ROUNDING = 1e-6
"""Of sums of the same terms in another order: some 1e-13, but where terms cancel, as of
the derivative of a sphere by alpha_s."""


def scenes() -> Scene:
    """Spheres and elongated blocks, upright and oblique, in every fourth with dashpots,
    and one that no ground holds."""
    made = mixed_scenes(COUNT, seed=5)
    every = np.arange(COUNT)
    return eqx.tree_at(
        lambda scene: (
            scene.block.mass,
            scene.block.aspect_ratio,
            scene.soil.eta_N,
            scene.impact.angle,
        ),
        jax.tree.map(lambda x: jnp.broadcast_to(x, (COUNT,)), made),
        (
            jnp.where(every == 7, -1.0, made.block.mass),
            jnp.where(every % 5 == 0, 1.0, made.block.aspect_ratio),
            jnp.where(every % 4 == 0, 0.1, 0.0),
            jnp.where(every % 6 == 0, 0.0, made.impact.angle),
        ),
    )


def weighted(scene: Scene):
    """A sum of some results of each impact, of which those that failed count 0."""
    found = FAST(scene)
    total = found.e_n + 0.1 * found.R_r + 1e-6 * found.max_normal_force
    total = total + 20.0 * found.duration + found.final_penetration
    return jnp.where(jnp.isnan(total), 0.0, total)


@pytest.fixture
def one_by_one(monkeypatch):
    """Has derivatives taken one by one from now on."""
    return lambda: monkeypatch.setattr(many_leaves, "MOST_COLUMNS", 1000)


@pytest.fixture
def at_once(monkeypatch):
    """Has runs along all leaves for every law and shape."""
    monkeypatch.setattr(many_leaves, "MOST_WITHOUT_CODE", many_leaves.MOST_COLUMNS)


def assert_close(found, expected):
    for one, other in zip(*map(jax.tree.leaves, (found, expected)), strict=True):
        scale = np.abs(other) + 1e-3 * np.max(np.abs(other), initial=1e-9)
        assert np.all(np.abs(one - other) <= ROUNDING * scale)


def test_gradients_are_those_one_by_one(one_by_one, at_once):
    made = scenes()

    def total(scene):
        return jnp.sum(weighted(scene))

    ways = [
        jax.grad(total)(made),
        jax.jit(jax.grad(total))(made),
        jax.vmap(jax.grad(weighted))(made),
        jax.jit(jax.vmap(jax.grad(weighted)))(made),
    ]
    one_by_one()
    expected = jax.jit(jax.grad(lambda scene: total(scene)))(made)
    for found in ways:
        assert_close(found, expected)
    # But for the few damping ratios, whose derivatives XLA adds up
    one, other = (eqx.tree_at(lambda s: s.soil.damping, x, 0.0) for x in ways[1::2])
    assert eqx.tree_equal(one, other)
    leaves = jax.tree.leaves(ways[1])
    assert all(leaf[7] == 0.0 for leaf in leaves)  # failed
    assert sum(np.any(leaf) for leaf in leaves) > LEAVES - 4


def test_directional_derivatives_are_those_one_by_one(one_by_one, at_once):
    made = scenes()
    steps = jax.tree.map(lambda x: 0.1 + 0.01 * x, made)

    def along(scene, steps):
        return jax.jvp(weighted, (scene,), (steps,))[1]

    found = jax.jit(along)(made, steps)
    alone = jax.vmap(along)(made, steps)
    one_by_one()
    expected = jax.jit(lambda *both: along(*both))(made, steps)
    # Terms of both signs
    np.testing.assert_allclose(found, expected, rtol=1e-7)
    # Sums of results are XLA's.
    np.testing.assert_allclose(found, alone, rtol=1e-12)


def of_one(scene: Scene):
    found = FAST(scene)
    return jnp.stack([found.e_n, found.e_t, found.duration, found.R_r])


def test_jacobians_are_the_same_by_columns_and_by_rows(at_once):
    one = jax.tree.map(operator.itemgetter(3), scenes())
    by_rows, by_columns = jax.jacrev(of_one)(one), jax.jacfwd(of_one)(one)
    assert_close(by_rows, by_columns)
    many = scenes()
    assert_close(
        jax.jit(jax.vmap(jax.jacrev(of_one)))(many),
        jax.jit(jax.vmap(jax.jacfwd(of_one)))(many),
    )


def test_few_cotangents_and_few_steps_take_runs(monkeypatch, at_once):
    """Of a single scene, with an axis of `vmap` for them alone; a run each, where it
    costs less than derivatives one by one."""
    one = jax.tree.map(operator.itemgetter(3), scenes())
    weights = jnp.array([[1.0, 0.0, 2.0, -1.0], [0.5, 1.0, 0.0, 3.0]])
    _, pull_back = jax.vjp(of_one, one)
    expected = jax.vmap(pull_back)(weights)
    _, along = jax.linearize(of_one, one)
    steps = jax.tree.map(lambda x: x * jnp.array([0.1, -0.2]), one)
    changes = jax.vmap(along)(steps)
    monkeypatch.setattr(many_leaves, "RUN_FORWARD", 0)
    monkeypatch.setattr(many_leaves, "RUN_BACKWARD", 0)
    assert_close(jax.vmap(pull_back)(weights), expected)
    assert_close(jax.jit(jax.vmap(pull_back))(weights), expected)
    np.testing.assert_allclose(jax.vmap(along)(steps), changes, rtol=1e-7)
    # The two are the transposes of each other, twice over.
    product = np.vdot(changes, weights)
    pairs = zip(*map(jax.tree.leaves, (expected[0], steps)), strict=True)
    assert np.isclose(sum(np.vdot(x, y) for x, y in pairs), product, rtol=1e-7)
    back_again = jax.linear_transpose(jax.vmap(pull_back), weights)
    np.testing.assert_allclose(back_again((steps,))[0], changes, rtol=1e-7)


def shared(soil: Soil, speeds, angles):
    """A sum over impacts on one ground, by an axis of `vmap` for each of the two."""

    def of_one(speed, angle):
        block, impact = Block(aspect_ratio=2.0), Impact(speed=speed, angle=angle)
        return FAST(Scene(block, soil, impact)).e_n

    of_speeds = jax.vmap(of_one, (0, None))
    return jnp.sum(jax.vmap(of_speeds, (None, 0))(speeds, angles))


def test_what_impacts_share_is_added_up(one_by_one):
    """Also in derivatives by a step that the impacts share, and of a Jacobian."""
    speeds, angles = jnp.linspace(5.0, 20.0, 3), jnp.array([0.2, 0.5])
    soil, steps = Soil(), jax.tree.map(lambda x: 0.1 * x, Soil())

    def of_each(soil):
        return jax.vmap(lambda speed: shared(soil, speed[None], angles))(speeds)

    def along(steps):
        return jnp.sum(jax.jvp(of_each, (soil,), (steps,))[1])

    def gradient(soil):
        return jax.grad(shared)(soil, speeds, angles)

    found = [gradient(soil), jax.jit(gradient)(soil), jax.jit(jax.grad(along))(steps)]
    by_rows = jax.jit(jax.jacrev(of_each))(soil)
    found.append(jax.tree.map(lambda rows: jnp.sum(rows, 0), by_rows))
    one_by_one()
    expected = jax.grad(lambda soil: shared(soil, speeds, angles))(soil)
    for each in found:
        assert_close(each, expected)


def test_lanes_do_not_depend_on_their_neighbours(at_once):
    """To the last bit, whatever is beside a lane, in which order lanes begin, and alone
    outside of `jit`."""
    made = scenes()
    gradient = jax.jit(jax.vmap(jax.grad(weighted)))
    expected = gradient(made)
    places = np.random.default_rng(1).permutation(COUNT)[:11]
    some = gradient(jax.tree.map(lambda x: x[places], made))
    for one, all_ in zip(*map(jax.tree.leaves, (some, expected)), strict=True):
        np.testing.assert_array_equal(one, np.asarray(all_)[places])
    alone = jax.grad(weighted)(jax.tree.map(lambda x: x[4], made))
    for one, all_ in zip(*map(jax.tree.leaves, (alone, expected)), strict=True):
        assert one == all_[4]


def test_a_missing_input_is_missing_in_its_lane_alone(at_once):
    made = scenes()
    speed = made.impact.speed.at[2].set(jnp.nan)
    made = eqx.tree_at(lambda scene: scene.impact.speed, made, speed)
    for leaf in jax.tree.leaves(jax.jit(jax.vmap(jax.grad(weighted)))(made)):
        np.testing.assert_array_equal(np.flatnonzero(np.isnan(leaf)), [2])


@pytest.mark.parametrize("jit", [jax.jit, lambda function: function])
def test_second_derivatives_are_refused(jit, at_once):
    one = jax.tree.map(operator.itemgetter(3), scenes())
    gradient = jit(jax.grad(weighted))
    for second in (
        jax.grad(lambda scene: gradient(scene).soil.c_v),
        jit(jax.hessian(weighted)),
        lambda scene: jax.jvp(gradient, (scene,), (scene,)),
    ):
        with pytest.raises(NotImplementedError, match="second derivatives"):
            second(one)


@pytest.mark.skipif(
    host()[0] is None or not many_leaves._has_code(jax.tree.structure(Scene()), False),
    reason="code for reverse mode is not shipped for this computer",
)
def test_gradients_of_the_usual_scene_compile_nothing(monkeypatch):
    compile_native.cache_clear()
    monkeypatch.setattr("jaximpact.backend.lane_functions.code_of_lanes", None)
    gradient = jax.grad(weighted)(Scene(Block(aspect_ratio=2.0), Soil(), Impact()))
    assert all(np.all(np.isfinite(leaf)) for leaf in jax.tree.leaves(gradient))


TERMS = 33
"""More than a scene has parameters."""


def series_law(function):
    """A flow whose fluidity is a power series of the load, with many coefficients."""
    names = [f"coefficient_{k}" for k in range(TERMS)]
    declared = {
        name: parameter(1.0, "-", "[0, inf)", "coefficient of a power of the load")
        for name in names
    }

    def flow_size(self, load, hardening, foundation, branch):
        x, factor = load.size / (1.0 + load.size), 0.0
        for name in names:
            factor = factor * x + getattr(self, name)
        flow = Perzyna.flow_size(self, load, hardening, foundation, branch)
        return function(factor) * flow

    of_class = dict(__annotations__=dict.fromkeys(names, jax.Array), **declared)
    of_class |= dict(flow_size=flow_size, __module__=__name__)
    of_laws: Any = type(Perzyna)
    return of_laws("Series", (Perzyna,), of_class)


def e_n_of(flow, coefficients, speed):
    flow = flow(**{f"coefficient_{k}": coefficients[k] for k in range(TERMS)})
    scene = Scene(Block(aspect_ratio=1.5), Soil(flow=flow), Impact(speed=speed))
    return simulate(scene, accuracy="balanced", ledger=False).e_n


def test_a_law_with_more_parameters_than_a_scene():
    """One run of reverse mode, against differences of 1e-3 of all coefficients along a
    random direction, whose error is that of the step squared."""
    flow, draw = series_law(lambda x: x), np.random.default_rng(2)
    first, step = draw.uniform(0.5, 2.0, TERMS), 1e-3 * draw.normal(size=TERMS)
    speeds = np.linspace(5.0, 20.0, 3)
    assert many_leaves.MOST_WITHOUT_CODE < TERMS

    def total(coefficients):
        return jnp.sum(e_n_of(flow, coefficients, speeds))

    gradient = jax.jit(jax.grad(total))(first)
    change = total(first + step) - total(first - step)
    assert np.isclose(2.0 * gradient @ step, change, rtol=1e-4)


@jax.custom_jvp
def forward_alone(x):
    return x


@forward_alone.defjvp
def _forward_alone_jvp(primals, tangents):
    # The same, but JAX does not see that it is linear, and cannot transpose it.
    (step,) = tangents
    return primals[0], jnp.sign(step) * jnp.abs(step)


def test_a_law_without_reverse_mode_is_differentiated_forwards(one_by_one):
    flow, first = series_law(forward_alone), np.linspace(0.5, 2.0, TERMS)

    def gradient():
        return jax.grad(lambda x: e_n_of(flow, x, 12.0))(first)

    with pytest.warns(NoMachineCodeWarning):
        found = gradient()
    one_by_one()
    np.testing.assert_array_equal(found, gradient())
