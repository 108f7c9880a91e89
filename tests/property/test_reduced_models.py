"""The ladder of models: the cheap ones are exact where they are taken."""

import dataclasses
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaximpact import (
    PRESETS,
    Block,
    Impact,
    Scene,
    Soil,
    select_model,
    simulate,
    simulate_batch,
)
from jaximpact.backend.native_backend import compile_native
from jaximpact.backend.simd import KernelSet
from jaximpact.backend.xla_compilation import UNFUSED
from jaximpact.batch import broadcast_scene
from jaximpact.impact.problem import Assembly
from jaximpact.impact.reduced_models import (
    PLANAR,
    PLANAR_DAMPED,
    VERTICAL,
    VERTICAL_DAMPED,
)
from jaximpact.impact.specialize import leave_out_known

TALL = Block(aspect_ratio=2.0)


@pytest.mark.parametrize(
    ("block", "soil", "impact", "model"),
    [
        (Block(), Soil(), Impact(), VERTICAL),
        (Block(), Soil(), Impact(orientation=0.4), VERTICAL),
        (TALL, Soil(), Impact(), VERTICAL),
        (TALL, Soil(), Impact(orientation=math.radians(90)), VERTICAL),
        (TALL, Soil(), Impact(orientation=math.radians(-270)), VERTICAL),
        (TALL, Soil(), Impact(orientation=math.radians(89.9)), PLANAR),
        (Block(), Soil(), Impact(angle=1e-9), PLANAR),
        (Block(), Soil(), Impact(angular_velocity=-1.0), PLANAR),
        (Block(), Soil(), Impact(slope=0.1), PLANAR),
        (Block(), Soil(eta_T=0.1, eta_R=0.1), Impact(), VERTICAL),
        (Block(), Soil(eta_N=0.1), Impact(), VERTICAL_DAMPED),
        (Block(), Soil(eta_R=0.1), Impact(slope=0.1), PLANAR_DAMPED),
    ],
)
def test_cheapest_exact_model_is_taken(block, soil, impact, model):
    assert select_model(block, soil, impact) == model


def computed(scene: Scene, model):
    """Numbers of scenes at "reference" by a model, whichever they would be given."""
    kernel = compile_native(Assembly(jax.tree.structure(scene), model, False))
    leaves, setting = np.stack(jax.tree.leaves(scene)), PRESETS["reference"]
    rows = np.array([[setting.tolerance], [setting.floor]])
    inputs = np.concatenate([leaves, np.broadcast_to(rows, (2, leaves.shape[1]))])
    results, _ = KernelSet([kernel]).compute(inputs, threads=1)
    return jax.tree.unflatten(kernel.structure, list(results))


def vertical_scenes(count, *, damped):
    draw = np.random.default_rng(4).uniform

    def log(low, high):
        return np.exp(draw(np.log(low), np.log(high), count))

    scene = Scene(
        Block(mass=log(0.1, 1e4), aspect_ratio=log(0.5, 4), out_of_plane_ratio=2.0),
        Soil(
            gamma_v=log(0.3, 30),
            c_v=log(0.1, 3),
            k_E=log(100, 4000),
            alpha_vR=1.0,
            dilatancy=draw(0, 1, count),
            eta_N=draw(0.01, 0.5, count) if damped else 0.0,
        ),
        Impact(
            speed=draw(1, 40, count), orientation=np.pi / 2 * (draw(size=count) < 0.5)
        ),
    )
    return broadcast_scene(scene)[0]


@pytest.mark.slow
@pytest.mark.parametrize("damped", [False, True])
def test_vertical_model_is_the_planar_one(damped):
    scene = vertical_scenes(500, damped=damped)
    pair = (VERTICAL_DAMPED, PLANAR_DAMPED) if damped else (VERTICAL, PLANAR)
    cheap, whole = (computed(scene, model) for model in pair)
    np.testing.assert_array_equal(cheap.outcome_code, whole.outcome_code)
    for name in ("e_n", "e_bar", "max_penetration", "max_normal_force", "duration"):
        # Both err by the tolerance over some hundred steps; where the forces of
        # springs and dashpots jump, by more. A rebound may be next to nothing.
        mine, theirs = getattr(cheap, name), getattr(whole, name)
        np.testing.assert_allclose(
            mine,
            theirs,
            rtol=1e-3 if damped else 1e-5,
            atol=1e-7 * np.max(np.abs(theirs)),
            err_msg=name,
        )
    assert np.all(np.asarray(cheap.rotation) == 0.0)
    assert np.all(np.asarray(cheap.max_moment) == 0.0)


@pytest.mark.slow
def test_batch_of_all_models_is_the_impacts_one_by_one():
    scene = Scene(
        Block(aspect_ratio=np.array([1.0, 2.0, 1.0, 2.0])),
        Soil(eta_N=np.array([0.0, 0.0, 0.1, 0.1])),
        Impact(angle=np.array([0.0, 0.5, 0.0, 0.5])),
    )
    together = simulate_batch(scene, accuracy="reference")
    for place in range(4):
        alone = simulate(together[place].scene, accuracy="reference")
        for name in ("e_n", "max_sinking", "duration"):
            # Rounding differs, and with it the steps: equal to the error of
            # "reference".
            assert getattr(together, name)[place] == pytest.approx(
                float(getattr(alone, name)), rel=1e-7
            )


@pytest.mark.slow
def test_derivative_out_of_the_symmetry_is_taken_with_the_whole_model():
    def tangential_velocity(angle):
        impact = dataclasses.replace(Impact(), angle=angle)
        return simulate(Block(), Soil(), impact, accuracy="fast").tangential_velocity

    # A sphere keeps part of the tangential velocity that it has.
    assert 1.0 < float(jax.grad(tangential_velocity)(0.0)) < 14.0


# --- what is known of a scene is left out of its program


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
