"""An impact as an operation of JAX: the same numbers, to the last bit, whatever is done
around it."""

import concurrent.futures
import dataclasses
import functools
import math
import operator
import os
import subprocess
import sys
import time

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from paths import ROOT

from benchmarks.impacts import mixed_scenes
from jaximpact import Block, Impact, Outcome, Scene, Soil, simulate, simulate_batch
from jaximpact.accuracy import PRESETS
from jaximpact.backend import kernel_choice, operation
from jaximpact.backend import native_backend as machine
from jaximpact.backend.request import request
from jaximpact.backend.rows import columns_of
from jaximpact.backend.threads import thread_count
from jaximpact.impact.problem import Assembly
from jaximpact.impact.reduced_models import MODELS, PLANAR, exact_models
from jaximpact.impact.results import Solution
from jaximpact.laws import DampingRatios, DuncanChang, Perzyna
from jaximpact.shapes import Ellipsoid

pytestmark = pytest.mark.slow

FAST = functools.partial(simulate, accuracy="fast", ledger=False)
UNDAMPED = dict.fromkeys(("eta_N", "eta_T", "eta_R"), 0.0)
"""Known inside of `jit` too, which saves the models with dashpots."""
COUNT = 37
"""Not a multiple of the eight lanes of a vector."""


@pytest.fixture(scope="module")
def scenes() -> Scene:
    """Of all parametric sets: half of them fall vertically, without rotation."""
    return jax.tree.map(jnp.asarray, mixed_scenes(COUNT, seed=3))


@pytest.fixture(scope="module")
def expected(scenes):
    return simulate_batch(scenes, accuracy="fast")


def rebound(gamma_v, c_v, scene: Scene):
    soil = dataclasses.replace(scene.soil, gamma_v=gamma_v, c_v=c_v, **UNDAMPED)
    return FAST(Scene(scene.block, soil, scene.impact)).e_n


@pytest.fixture(scope="module")
def gradients(scenes):
    """Rebound and its derivatives, scene by scene, without any compilation."""
    gradient = jax.value_and_grad(rebound, argnums=(0, 1))
    each = [jax.tree.map(lambda x, k=k: x[k], scenes) for k in range(COUNT)]
    found = [gradient(scene.soil.gamma_v, scene.soil.c_v, scene) for scene in each]
    return jax.tree.map(lambda *x: np.array(x), *found)


def assert_same(result, expected):
    for name in ("e_n", "e_t", "e_bar", "max_normal_force", "duration", "outcome_code"):
        np.testing.assert_array_equal(getattr(result, name), getattr(expected, name))


def test_values_are_those_of_a_batch(scenes, expected):
    assert_same(jax.jit(jax.vmap(FAST))(scenes), expected)
    assert_same(FAST(scenes), expected)
    assert_same(jax.jit(FAST)(scenes), expected)


def test_fields_broadcast(scenes):
    """Axes of speed and of soil, in one call, in a nest of vmap, and in both."""
    speed, c_v = jnp.linspace(5.0, 20.0, 5), jnp.array([0.6, 0.8, 1.0])
    angle = jnp.array([0.0, 0.5])

    def at(speed, c_v, angle):
        return FAST(Block(), Soil(c_v=c_v), Impact(speed=speed, angle=angle)).e_n

    together = at(speed[:, None, None], c_v[:, None], angle)
    assert together.shape == (5, 3, 2)
    one_by_one = [[[at(v, c, a) for a in angle] for c in c_v] for v in speed]
    np.testing.assert_array_equal(together, one_by_one)
    inner = jax.vmap(jax.vmap(at, (None, None, 0)), (None, 0, None))
    nested = jax.vmap(inner, (0, None, None))
    np.testing.assert_array_equal(jax.jit(nested)(speed, c_v, angle), together)
    mixed = jax.vmap(lambda v: at(v, c_v[:, None], angle))
    np.testing.assert_array_equal(jax.jit(mixed)(speed), together)
    moved = jax.vmap(at, in_axes=(None, 0, None), out_axes=1)(
        speed[:, None], c_v, angle
    )
    np.testing.assert_array_equal(moved, together)


def test_gradients_of_a_batch_are_those_of_each(scenes, gradients):
    values, by_each = gradients
    gradient = jax.value_and_grad(rebound, argnums=(0, 1))
    soil = scenes.soil
    together = jax.vmap(gradient)(soil.gamma_v, soil.c_v, scenes)
    compiled = jax.jit(jax.vmap(gradient))(soil.gamma_v, soil.c_v, scenes)
    for found in (together, compiled):
        np.testing.assert_array_equal(found[0], values)
        np.testing.assert_array_equal(found[1], by_each)

    def mean(gamma_v, c_v):
        return jnp.sum(jax.vmap(rebound)(gamma_v, c_v, scenes))

    of_mean = jax.jit(jax.grad(mean, argnums=(0, 1)))(soil.gamma_v, soil.c_v)
    np.testing.assert_array_equal(of_mean, by_each)


@pytest.mark.parametrize(
    "transform",
    [
        jax.jacfwd,
        jax.jacrev,
        lambda f: jax.jit(jax.jacfwd(f)),
        lambda f: lambda x: jax.linearize(f, x)[1](jnp.ones_like(x)),
        lambda f: lambda x: jax.jvp(f, (x,), (jnp.ones_like(x),))[1],
        lambda f: lambda x: jax.vjp(f, x)[1](jnp.ones_like(f(x)))[0],
        lambda f: jax.jit(jax.jacrev(jax.checkpoint(f))),
        lambda f: lambda x: jax.jit(jax.linearize(f, x)[1])(1.0),
        lambda f: lambda x: jax.vmap(jax.linearize(f, x)[1])(jnp.ones(2))[1],
        lambda f: lambda x: jax.jit(jax.vjp(f, x)[1])(1.0)[0],
        lambda f: jax.grad(lambda x: jax.jit(lambda e_n: 2.0 * e_n)(f(x)) / 2.0),
        lambda f: jax.grad(lambda x: jax.vmap(lambda w: w * f(x))(jnp.ones(2))[1]),
        lambda f: lambda x: jax.grad(lambda w: w * jax.vjp(f, x)[1](w)[0])(0.5),
    ],
    ids=[
        *("jacfwd", "jacrev", "jit", "linearize", "jvp", "vjp", "checkpoint"),
        *("linear in jit", "linear in vmap", "vjp in jit", "used in jit"),
        *("used in vmap", "vjp in grad"),
    ],
)
def test_transformations_give_one_derivative(scenes, gradients, transform):
    _, (by_gamma, _) = gradients
    k = 5
    scene = jax.tree.map(lambda x: x[k], scenes)
    found = transform(lambda x: rebound(x, scene.soil.c_v, scene))(scene.soil.gamma_v)
    # By two parameters at once, and by one: the same steps, in other code.
    np.testing.assert_allclose(found, by_gamma[k], rtol=1e-13)


def test_control_flow(scenes, gradients):
    """Inside scan, while, cond and map, and differentiated through scan."""
    values, (by_gamma, _) = gradients
    soil = scenes.soil

    def add(total, inputs):
        gamma_v, scene = inputs
        return total + rebound(gamma_v, scene.soil.c_v, scene), None

    def summed(gamma_v):
        return jax.lax.scan(add, 0.0, (gamma_v, scenes))[0]

    # Sums in order
    assert jax.jit(summed)(soil.gamma_v) == functools.reduce(np.add, values, 0.0)
    found = jax.jit(jax.grad(summed))(soil.gamma_v)
    np.testing.assert_allclose(found, by_gamma, rtol=1e-13)
    scene = jax.tree.map(lambda x: x[0], scenes)

    def grows(carry):
        gamma_v, _ = carry
        return 2.0 * gamma_v, rebound(2.0 * gamma_v, scene.soil.c_v, scene)

    _, last = jax.jit(
        lambda g: jax.lax.while_loop(lambda c: c[0] < 5.0, grows, (g, 0.0))
    )(1.0)
    assert last == rebound(8.0, scene.soil.c_v, scene)
    chosen = jax.jit(
        lambda yes: jax.lax.cond(
            yes, lambda: rebound(3.0, 0.8, scene), lambda: jnp.zeros(())
        )
    )
    assert chosen(True) == rebound(3.0, 0.8, scene)
    mapped = jax.lax.map(lambda s: FAST(s).e_n, scenes, batch_size=10)
    np.testing.assert_array_equal(mapped, values)


def test_lanes_may_be_given_away(scenes, expected):
    speed = jnp.array(scenes.impact.speed)
    impact = scenes.impact

    @functools.partial(jax.jit, donate_argnums=0)
    def solved(speed):
        changed = dataclasses.replace(impact, speed=speed)
        return FAST(Scene(scenes.block, scenes.soil, changed)).e_n

    np.testing.assert_array_equal(solved(speed), expected.e_n)


def test_threads_change_nothing(scenes, expected):
    """Several that call at once, and any number that compute."""
    solved = jax.jit(jax.vmap(FAST))
    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        for found in pool.map(lambda _: solved(scenes), range(8)):
            assert_same(found, expected)
    try:
        for count in (1, 2, 5):
            for _, driver in operation._registered.values():
                driver.operation.threads = count
            assert_same(solved(scenes), expected)
    finally:
        for _, driver in operation._registered.values():
            driver.operation.threads = thread_count()


def test_of_threads_that_ask_at_once_one_compiles():
    asked = []

    @machine._kept_here
    def compiled(assembly):
        asked.append(assembly)
        time.sleep(0.1)
        return object()

    with concurrent.futures.ThreadPoolExecutor(4) as pool:
        one, other = (Assembly(jax.tree.structure(x), PLANAR, False) for x in (0, ()))
        found = set(pool.map(compiled, [one, one, other, one]))
    assert len(asked) == 2
    assert {*asked} == {one, other}
    assert len(found) == 2


@pytest.fixture
def compiled(monkeypatch):
    """Names of the models that are compiled, from now on."""
    names = []

    def compile_and_note(assemblies, *how):
        names.extend(assembly.model.name for assembly in assemblies)
        return machine.compile_side_by_side(assemblies, *how)

    monkeypatch.setattr(kernel_choice, "_kernel_sets", {})
    monkeypatch.setattr(kernel_choice, "compile_side_by_side", compile_and_note)
    return names


def own_law(factor: float) -> Perzyna:
    """A law that no other test has: operations of JAX are there for good."""

    class Faster(Perzyna):
        def flow_size(self, load, hardening, foundation, branch):
            size = super().flow_size(load, hardening, foundation, branch)
            return factor * size

    return Faster()


def e_n_of_any(flow, angle, damping_ratio=0.0, k_E=900.0):
    ratios = DampingRatios(damping_ratio, damping_ratio, damping_ratio)
    soil = Soil(flow=flow, damping=ratios, elasticity=DuncanChang(k_E=k_E))
    scene = Scene(Block(aspect_ratio=2.0), soil, Impact(angle=angle))
    return simulate(scene, ledger=False).e_n


OBLIQUE, NONE = np.linspace(0.1, 0.7, 4), np.zeros(4)


def test_a_traced_scene_compiles_the_models_that_lanes_need(compiled):
    e_n = functools.partial(e_n_of_any, own_law(1.01))
    many = jax.jit(jax.vmap(e_n))
    first = many(OBLIQUE, NONE)
    assert compiled == ["planar"]
    with concurrent.futures.ThreadPoolExecutor(3) as pool:
        vertical = list(pool.map(many, [NONE] * 3, [NONE] * 3))
    assert compiled == ["planar", "vertical"]
    mixed = many(np.where(np.arange(4) < 2, OBLIQUE, 0.0), NONE + 0.1)
    assert sorted(compiled[2:]) == ["planar, with dashpots", "vertical, with dashpot"]
    for found, angle, ratio in (
        (first[0], 0.1, 0.0),
        *((of_thread[3], 0.0, 0.0) for of_thread in vertical),
        (mixed[0], 0.1, 0.1),
        (mixed[3], 0.0, 0.1),
    ):
        assert found == e_n(angle, ratio)


def test_derivatives_too_compile_the_models_that_lanes_need(compiled):
    slope = jax.grad(functools.partial(e_n_of_any, own_law(1.02)), argnums=2)
    many = jax.jit(jax.vmap(lambda angle, k_E: slope(angle, 0.0, k_E)))
    stiffness = np.linspace(800.0, 900.0, 4)
    oblique = many(OBLIQUE, stiffness)
    assert compiled == ["planar"]
    vertical = many(NONE, stiffness)
    assert compiled == ["planar", "vertical"]
    assert oblique[0] == slope(0.1, 0.0, 800.0)
    assert vertical[0] == slope(0.0, 0.0, 800.0)


def test_models_that_wait_in_the_same_place_are_told_apart(compiled):
    """Beside the planar model with dashpots, the vertical one with its dashpot where
    that works, and else without."""
    flow = own_law(1.04)

    def e_n(eta_N, eta_T, angle):
        soil = Soil(flow=flow, damping=DampingRatios(eta_N, eta_T, 0.0))
        impact = Impact(angle=angle)
        return simulate(Block(aspect_ratio=2.0), soil, impact, ledger=False).e_n

    for ratios in ((0.1, 0.0), (0.0, 0.1)):
        of_angle = functools.partial(e_n, *ratios)
        found = jax.jit(jax.vmap(of_angle))(np.where(OBLIQUE < 0.3, 0.0, OBLIQUE))
        assert found[0] == of_angle(0.0)
        assert found[3] == of_angle(OBLIQUE[3])
    assert {"vertical", "vertical, with dashpot"} < set(compiled)


def test_machine_code_that_is_not_to_be_had_when_lanes_need_it(compiled, monkeypatch):
    many = jax.jit(jax.vmap(functools.partial(e_n_of_any, own_law(1.03))))
    expected = many(OBLIQUE, NONE)

    def interrupted(assemblies, *how):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(kernel_choice, "compile_side_by_side", interrupted)
        with pytest.raises(Exception, match="no machine code, which lanes need: Key"):
            jax.block_until_ready(many(NONE, NONE))
    kernel_choice._kernel_sets.clear()  # as an edit does
    with pytest.raises(Exception, match="a law was edited since"):
        jax.block_until_ready(many(NONE, NONE))
    assert np.array_equal(many(OBLIQUE, NONE), expected)


def test_a_lane_that_is_no_number_leaves_the_others_alone(scenes, expected):
    """Also in the order in which lanes begin, which goes by the speed."""
    speed = scenes.impact.speed.at[3].set(np.nan)
    impact = dataclasses.replace(scenes.impact, speed=speed)
    found = jax.jit(FAST)(Scene(scenes.block, scenes.soil, impact))
    assert found.outcome_code[3] == Outcome.failed
    assert np.isnan(found.e_n[3])
    np.testing.assert_array_equal(np.delete(found.e_n, 3), np.delete(expected.e_n, 3))


@pytest.mark.parametrize(
    "path", ["block.mass", "soil.c_v", "impact.speed", "impact.orientation"]
)
def test_derivatives_of_what_is_no_number_are_none(path):
    """With respect to any leaf, in every mode; of the lanes beside it as ever."""
    scene = Scene(
        Block(aspect_ratio=1.7),
        Soil(c_v=jnp.array([0.7, 0.8, 0.9]), **UNDAMPED),
        Impact(speed=jnp.array([10.0, 11.0, 12.0]), angle=0.4, orientation=0.3),
    )
    leaf = operator.attrgetter(path)
    value = jnp.broadcast_to(leaf(scene), (3,))

    def rebound(gamma_v, value):
        lanes = eqx.tree_at(leaf, scene, value)
        soil = dataclasses.replace(lanes.soil, gamma_v=gamma_v)
        return FAST(Scene(lanes.block, soil, lanes.impact)).e_n

    gamma_v = jnp.full(3, 5.0)
    with_nan = value.at[1].set(jnp.nan)
    for by in (0, 1):

        def forward(gamma_v, value, by=by):
            steps = [jnp.zeros(3), jnp.zeros(3)]
            steps[by] = jnp.ones(3)
            return jax.jvp(rebound, (gamma_v, value), tuple(steps))

        def reverse(gamma_v, value, by=by):
            found, back = jax.vjp(rebound, gamma_v, value)
            return found, back(jnp.ones(3))[by]

        for ways in (forward, reverse, jax.jit(forward), jax.jit(reverse)):
            for found, expected in zip(
                ways(gamma_v, with_nan), ways(gamma_v, value), strict=True
            ):
                assert np.isnan(found[1])
                np.testing.assert_array_equal(found[::2], expected[::2])
    # What all lanes have in common is in the sum of one that is no number.
    of_sum = jax.jit(jax.grad(lambda *both: jnp.sum(rebound(*both))))
    assert np.isnan(of_sum(5.0, with_nan))


def test_derivatives_of_a_history_of_no_numbers_are_none():
    times = jnp.array([1e-3, 2e-3, 0.9])

    def forces(speed):
        impact = Impact(speed=speed)
        return simulate(Block(), Soil(**UNDAMPED), impact, save_at=times).history

    _, rates = jax.jvp(forces, (jnp.array([jnp.nan, 12.0]),), (jnp.ones(2),))
    found = rates.normal_force
    _, expected = jax.jvp(forces, (12.0,), (1.0,))
    assert np.all(np.isnan(found[0, :2]))
    np.testing.assert_array_equal(found[1], expected.normal_force)
    assert found[1, 2] == 0.0  # after the end


def test_an_impact_that_failed_leaves_the_derivatives_of_others_alone():
    """Also of what all have in common: in reverse mode 0 times NaN is NaN, where the
    impact is left out as well. No ground holds a mass below zero."""

    def mean(c_v, mass):
        found = FAST(Block(mass=mass), Soil(c_v=c_v, **UNDAMPED), Impact())
        sound = found.outcome_code != Outcome.failed
        return jnp.sum(jnp.where(sound, found.e_n, 0.0)), found.e_n

    of_both = jax.jit(jax.grad(mean, has_aux=True))
    gradient, found = of_both(0.8, jnp.array([-100.0, 100.0]))
    np.testing.assert_array_equal(np.isnan(found), [True, False])
    assert gradient == of_both(0.8, jnp.array([100.0]))[0] != 0.0


@pytest.mark.parametrize("kind", [jnp.float32, jnp.int64])
def test_leaves_of_another_type_are_taken_for_their_values(scenes, kind):
    def with_speed(speed):
        return eqx.tree_at(lambda s: s.impact.speed, scenes, speed)

    speed = (scenes.impact.speed + 0.3).astype(kind)
    other, expected = with_speed(speed), FAST(with_speed(speed.astype(float)))
    for solved in (FAST, jax.jit(FAST), jax.jit(jax.vmap(FAST))):
        assert_same(solved(other), expected)


def test_too_many_axes_are_refused_in_words():
    speed = jnp.full((1,) * 25, 14.0)
    with pytest.raises(jax.errors.JaxRuntimeError, match="arrays of at most 24 axes"):
        jax.jit(FAST)(Scene(impact=Impact(speed=speed)))


class OfNumbers(Ellipsoid):
    """A shape that tells of a number alone whether it is upright."""

    def is_upright(self, orientation):
        return abs(math.sin(2.0 * orientation)) < 1e-12


def test_a_shape_that_knows_numbers_alone():
    """Where JAX traces, the model is one that is always exact."""

    def place(orientation):
        block = Block(shape=OfNumbers(aspect_ratio=2.0))
        return exact_models(Scene(block, Soil(), Impact(orientation=orientation)))[0]

    assert place(0.0) == 0
    assert jax.jit(place)(0.0) == MODELS.index(PLANAR)


def test_any_leaf_may_be_differentiated():
    """By all parameters of a scene at once, against central differences at "reference".
    Their error is that of the step, 1e-4 of the parameter, squared, and that of the
    values, some 1e-10 by 1e-4."""
    damped = Scene(
        Block(aspect_ratio=1.7, mass=900.0),
        Soil(dilatancy=0.2, alpha_vR=0.3, eta_N=0.1, eta_T=0.1, eta_R=0.1),
        Impact(speed=11.0, angle=0.4, orientation=0.3, angular_velocity=1.0, slope=0.2),
    )
    undamped = dataclasses.replace(damped.soil, **UNDAMPED)

    def rebound(scene):
        return simulate(scene, accuracy="reference", ledger=False).e_n

    for scene in (damped, Scene(damped.block, undamped, damped.impact)):
        by_path, structure = jax.tree_util.tree_flatten_with_path(scene)
        leaves = np.array([leaf for _, leaf in by_path])
        places = np.flatnonzero(leaves)  # zero is the end of a range
        steps = 1e-4 * np.diag(leaves)[places]
        sides = np.concatenate([leaves + steps, leaves - steps]).T
        values = np.asarray(rebound(jax.tree.unflatten(structure, sides)))
        above, below = np.split(values, 2)
        found = np.array(jax.tree.leaves(jax.grad(rebound)(scene)))
        for k, place in enumerate(places):
            expected = (above[k] - below[k]) / 2e-4
            assert found[place] * leaves[place] == pytest.approx(
                expected, rel=1e-4, abs=5e-6
            ), by_path[place][0]


@pytest.mark.parametrize("directions", [2, 3, 5, 8, 11])
def test_derivatives_of_few_impacts_are_those_of_many(scenes, directions):
    """To the last bit: the directions of one or two impacts are computed side by side,
    those of many one after another. Vertical and planar impacts are among them, and
    times before and after the end."""
    leaves, structure = jax.tree.flatten(jax.tree.map(np.asarray, scenes))
    times = np.array([1e-4, 0.02, 10.0])
    varied = list(range(1, 1 + directions))

    def computed(chosen):
        wanted, values = request(
            structure,
            [leaf[chosen] for leaf in leaves],
            PRESETS["fast"],
            False,
            sampled=True,
        )
        return columns_of(wanted, values, times, varied, in_jax=False)

    (numbers, samples), columns = computed(slice(None))
    for count in (1, 2, 3, 5):
        own = slice(COUNT - count, COUNT)
        few, by_leaf = computed(own)
        jax.tree.map(
            lambda x, y, own=own: np.testing.assert_array_equal(x, y[own]),
            few,
            Solution(numbers, samples),
        )
        for found, expected in zip(by_leaf, columns, strict=True):
            for part, whole in zip(found, expected, strict=True):
                np.testing.assert_array_equal(part, whole[:, own])


def test_second_derivatives_are_refused_in_words():
    def rebound(c_v):
        return FAST(Block(), Soil(c_v=c_v), Impact()).e_n

    for second in (jax.hessian(rebound), jax.jit(jax.grad(jax.grad(rebound)))):
        with pytest.raises(NotImplementedError, match="second derivatives of an im"):
            second(0.8)


@pytest.mark.parametrize("engine", ["machine code", "diffrax"])
def test_derivatives_inside_of_derivatives_are_refused(engine):
    """By other values: each alone would be that of a number, 0."""

    def rebound(gamma_v, angle):
        impact = Impact(angle=angle, orientation=0.3)
        return FAST(Block(), Soil(gamma_v=gamma_v), impact, engine=engine).e_n

    def value_inside(angle):
        return jax.value_and_grad(rebound)(8.0, angle)[0]

    nested = (
        lambda: jax.jacfwd(jax.grad(rebound, 0), 1)(8.0, 0.5),
        lambda: jax.grad(value_inside)(0.5),
        lambda: jax.jvp(value_inside, (0.5,), (1.0,)),
    )
    for derivative in nested:
        with pytest.raises(NotImplementedError, match="of one inside of another"):
            derivative()


def test_a_derivative_inside_of_one_by_what_is_no_input():
    def rebound(gamma_v):
        return FAST(Block(), Soil(gamma_v=gamma_v), Impact(angle=0.5)).e_n

    expected = jax.grad(rebound)(8.0)
    assert jax.grad(lambda a: a * jax.grad(rebound)(8.0))(0.5) == expected
    assert jax.grad(lambda a: jax.jvp(rebound, (8.0,), (a,))[1])(0.5) == expected


def test_results_that_are_used_one_by_one_outside_of_jit():
    """Of arrays that broadcast, of an impact after another, and beside the value."""
    speed = jnp.array([[5.0], [8.0], [12.0]])

    def last(gamma_v, speed):
        soil = Soil(gamma_v=gamma_v)
        first = FAST(Block(), soil, Impact(speed=speed, angle=jnp.array([0.2, 0.5])))
        return FAST(Block(), soil, Impact(speed=5.0 + first.e_n)), first

    def total(*inputs):
        last_one, first = last(*inputs)
        return jnp.sum(last_one.e_n * jnp.array([1.0, 2.0])), (first, last_one.e_t)

    gradient = jax.value_and_grad(total, (0, 1), has_aux=True)
    (value, (first, e_t)), by_each = gradient(8.0, speed)
    (in_jit, (_, e_t_in_jit)), expected = jax.jit(gradient)(8.0, speed)
    # XLA may add up in another order.
    np.testing.assert_allclose(value, in_jit, rtol=1e-13)
    np.testing.assert_array_equal(e_t, e_t_in_jit)
    for found, wanted in zip(by_each, expected, strict=True):
        assert found.shape == wanted.shape
        np.testing.assert_allclose(found, wanted, rtol=1e-11)
    assert all(type(x) is type(e_t) for x in jax.tree.leaves(first))
    forward = jax.jacfwd(lambda *inputs: total(*inputs)[0], (0, 1))(8.0, speed)
    for found, wanted in zip(forward, expected, strict=True):
        np.testing.assert_allclose(found, wanted, rtol=1e-11)


def test_empty_and_single_lanes():
    assert FAST(Block(), Soil(), Impact(speed=jnp.zeros(0))).e_n.shape == (0,)
    # Also of what decides the model; alone, in `jit` and in derivatives
    none = Impact(angle=np.zeros((3, 0)))
    of_stiffness = lambda k_E: FAST(Block(), Soil(k_E=k_E), none).e_n  # noqa: E731
    for function in (of_stiffness, jax.jit(of_stiffness), jax.jacfwd(of_stiffness)):
        assert function(500.0).shape == (3, 0)
    one = FAST(Block(), Soil(), Impact(speed=jnp.array([14.0])))
    assert one.e_n.shape == (1,)
    assert float(one.e_n[0]) == float(FAST(Block(), Soil(), Impact(speed=14.0)).e_n)


# --- in processes of their own: over several devices, and programs that JAX keeps


COMMON = """
import functools
import jax
jax.config.update("jax_enable_x64", True)
import jax.numpy as jnp
import numpy as np
from jaximpact import Block, Impact, Soil, simulate

def rebound(c_v, speed):
    impact = Impact(speed=speed, angle=0.4, orientation=0.3)
    return simulate(Block(), Soil(c_v=c_v), impact, accuracy="fast").e_n

c_v, speed = jnp.linspace(0.5, 1.0, 22), jnp.linspace(5.0, 25.0, 22)
"""

SHARDED = """
from jax.sharding import AxisType, PartitionSpec as P

assert len(jax.devices()) == 2
mesh = jax.make_mesh((2,), ("lanes",), axis_types=(AxisType.Auto,))
over = functools.partial(jax.shard_map, mesh=mesh, out_specs=P("lanes"))
both = over(in_specs=(P("lanes"), P("lanes")))
one = over(in_specs=(P(), P("lanes")))
derivative = jax.grad(rebound)
expected = rebound(c_v, speed)
by_c_v = jax.jit(jax.vmap(derivative))(c_v, speed)

def same(found, expected):
    np.testing.assert_array_equal(np.asarray(found), np.asarray(expected))

same(both(rebound)(c_v, speed), expected)
same(jax.jit(both(jax.vmap(rebound)))(c_v, speed), expected)
same(jax.jit(both(jax.vmap(derivative)))(c_v, speed), by_c_v)
of_sum = jax.grad(lambda c_v: jnp.sum(both(jax.vmap(rebound))(c_v, speed)))
same(jax.jit(of_sum)(c_v), by_c_v)
# A parameter that all devices have in common
same(jax.jit(one(rebound))(0.8, speed), rebound(0.8, speed))
summed = jax.grad(lambda c_v: jnp.sum(one(rebound)(c_v, speed)))(0.8)
alone = jnp.sum(jax.vmap(derivative, (None, 0))(0.8, speed))
# Sums in another order
np.testing.assert_allclose(summed, alone, rtol=1e-14)
"""

KEPT = """
hits = []
jax.monitoring.register_event_listener(lambda event, **_: hits.append(event))
program = jax.jit(jax.vmap(jax.value_and_grad(rebound)))
value, derivative = program(c_v, speed)
print(np.asarray(value).tobytes().hex(), np.asarray(derivative).tobytes().hex())
print(sum(event == "/jax/compilation_cache/cache_hits" for event in hits))
"""

EXPORTED = """
import pathlib
import re
from jax import export

derivative = jax.jit(jax.vmap(jax.value_and_grad(rebound), (None, 0)))
some = jax.ShapeDtypeStruct(export.symbolic_shape("lanes"), float)
text = derivative.lower(0.8, some).as_text()
path = pathlib.Path("exported")
if path.exists():
    program = export.deserialize(bytearray(path.read_bytes()))
else:
    names = set(re.findall(r"jaximpact_[0-9a-f]{32}", text))
    allowed = [export.DisabledSafetyCheck.custom_call(name) for name in names]
    program = export.export(derivative, disabled_checks=allowed)(0.8, some)
    path.write_bytes(program.serialize())
value, slope = program.call(0.8, speed)
np.testing.assert_array_equal(value, rebound(0.8, speed))
print(np.asarray(value).tobytes().hex(), np.asarray(slope).tobytes().hex())
"""


def run(text: str, **variables: str) -> list[str]:
    """Runs Python and gives what it printed."""
    done = subprocess.run(
        [sys.executable, "-c", COMMON + text],
        env=os.environ | variables,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def test_over_several_devices():
    run(SHARDED, XLA_FLAGS="--xla_force_host_platform_device_count=2")


def test_programs_that_jax_has_kept(tmp_path):
    """Another process finds them, and the operation that they call."""
    kept = {
        "JAX_COMPILATION_CACHE_DIR": str(tmp_path),
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
        "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
    }
    (first, _), (second, hits) = run(KEPT, **kept), run(KEPT, **kept)
    assert second == first
    assert int(hits) > 0


def test_an_exported_program_runs_in_another_process(tmp_path, monkeypatch):
    """It has to lower such a program, and to compute none, before."""
    pytest.importorskip("flatbuffers")
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    monkeypatch.chdir(tmp_path)
    first, second = run(EXPORTED, PYTHONPATH=path), run(EXPORTED, PYTHONPATH=path)
    assert first == second
