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
    MODELS,
    PLANAR,
    PLANAR_DAMPED,
    ROUND,
    ROUND_DAMPED,
    VERTICAL,
    VERTICAL_DAMPED,
    exact_for_all,
    exact_models,
)
from jaximpact.impact.specialize import leave_out_known
from jaximpact.shapes import (
    Ellipsoid,
    EllipticCylinder,
    RectangularPrism,
    SemiAxes,
    foundation,
)

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
        (Block(), Soil(), Impact(angle=1e-9), ROUND),
        (Block(), Soil(), Impact(angular_velocity=-1.0), ROUND),
        (Block(out_of_plane_ratio=2.0), Soil(), Impact(slope=0.1), ROUND),
        (Block(shape=EllipticCylinder()), Soil(), Impact(slope=0.1), ROUND),
        (Block(shape=RectangularPrism()), Soil(), Impact(slope=0.1), PLANAR),
        (TALL, Soil(), Impact(slope=0.1), PLANAR),
        (Block(), Soil(eta_T=0.1, eta_R=0.1), Impact(), VERTICAL),
        (Block(), Soil(eta_N=0.1), Impact(), VERTICAL_DAMPED),
        (Block(), Soil(eta_R=0.1), Impact(slope=0.1), ROUND_DAMPED),
        (TALL, Soil(eta_R=0.1), Impact(slope=0.1), PLANAR_DAMPED),
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


def round_scenes(count, shape, *, damped):
    draw = np.random.default_rng(5).uniform

    def log(low, high):
        return np.exp(draw(np.log(low), np.log(high), count))

    scene = Scene(
        Block(mass=log(0.1, 1e4), shape=shape),
        Soil(
            gamma_v=log(0.3, 30),
            c_v=log(0.1, 3),
            k_E=log(100, 4000),
            dilatancy=draw(0, 1, count),
            eta_N=draw(0.01, 0.5, count) if damped else 0.0,
        ),
        Impact(
            speed=draw(1, 40, count),
            angle=draw(0, 1.3, count),
            slope=draw(0, 0.7, count),
            orientation=draw(0, 3, count),
            angular_velocity=draw(-10, 10, count),
        ),
    )
    return broadcast_scene(scene)[0]


@pytest.mark.slow
@pytest.mark.parametrize("kind", [Ellipsoid, EllipticCylinder])
@pytest.mark.parametrize("damped", [False, True])
def test_round_model_is_the_planar_one(kind, damped):
    scene = round_scenes(500, kind(out_of_plane_ratio=0.7), damped=damped)
    pair = (ROUND_DAMPED, PLANAR_DAMPED) if damped else (ROUND, PLANAR)
    cheap, whole = (computed(scene, model) for model in pair)
    np.testing.assert_array_equal(cheap.outcome_code, whole.outcome_code)
    for name in ("e_n", "e_bar", "rotation", "max_moment", "max_sinking", "duration"):
        # The arithmetic is the same but for its rounding. A step that it accepts or
        # not differs by the error allowed; where the forces of springs and dashpots
        # jump, by more.
        mine, theirs = getattr(cheap, name), getattr(whole, name)
        scatter = np.abs(mine - theirs) / (np.abs(theirs) + 1e-3 * np.max(theirs))
        assert np.median(scatter) < 1e-13, name
        assert np.max(scatter) < (1e-3 if damped else 1e-5), name


def test_a_shape_derived_from_the_ellipsoid_keeps_its_geometry():
    class Wide(Ellipsoid):
        @staticmethod
        def width(axes, height, q):
            return 1.5 * Ellipsoid.width(axes, height, q)

    assert select_model(Block(shape=Wide()), Soil(), Impact(angle=0.5)) is ROUND
    axes = SemiAxes(*np.ones(3))
    for shape, width in ((Wide(), 3.0), (Ellipsoid(), 2.0)):
        at_centre = foundation(shape.when_round(), axes, 0.0, 1.0, 1.0)
        assert at_centre.length == 2.0
        assert at_centre.width == width


def test_one_program_for_lanes_of_several_models_has_dashpots_if_one_lane_has():
    """A vertical impact with dashpots beside an oblique one without: XLA computes both
    by one model."""
    scene = Scene(
        Block(aspect_ratio=np.array([1.0, 2.0, 1.0])),
        Soil(eta_N=np.array([0.3, 0.0, 0.0])),
        Impact(angle=np.array([0.0, 0.5, 0.5])),
    )
    _, places = exact_models(scene)
    assert [MODELS[place] for place in places] == [VERTICAL_DAMPED, ROUND, PLANAR]
    assert exact_for_all(places) is PLANAR_DAMPED
    assert exact_for_all(places[:2]) is ROUND_DAMPED
    assert exact_for_all(places[1:]) is PLANAR


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


def test_arithmetic_on_zeros_of_the_function_itself_is_left_out():
    def own_zero(x):
        return x + jnp.zeros_like(x) * jnp.sin(x)

    x, _ = map(jnp.asarray, POINT)
    assert " sine(" in compiled(own_zero, x)
    assert " sine(" not in compiled(leave_out_known(own_zero, {}), x)
