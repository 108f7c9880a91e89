"""Derivatives of an impact: against differences, forward against reverse, under
vmap."""

import dataclasses
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from by_machine_code import computed, computed_along

from jaximpact import (
    PRESETS,
    Accuracy,
    Block,
    Impact,
    Scene,
    Soil,
    select_model,
    simulate,
)
from jaximpact.backend.xla_backend import compute
from jaximpact.backend.xla_compilation import unfused_jit
from jaximpact.impact.problem import Assembly
from jaximpact.impact.reduced_models import PLANAR, PLANAR_DAMPED

pytestmark = pytest.mark.slow

DEGREE = math.pi / 180.0
OUTPUTS = (
    "e_n",
    "e_t",
    "e_bar",
    "max_penetration",
    "max_normal_force",
    "duration",
    "rotation",
)
REFERENCE = PRESETS["reference"]
PARAMETERS = ("k_E", "gamma_v", "c_v")


def random_scenes(count, seed):
    draw = np.random.default_rng(seed).uniform

    def log(low, high):
        return np.exp(draw(np.log(low), np.log(high), count))

    return Scene(
        Block(mass=log(1.0, 1e3), aspect_ratio=log(0.6, 3.5)),
        Soil(k_E=log(200, 4000), gamma_v=log(0.5, 20), c_v=log(0.2, 4)),
        Impact(
            speed=draw(4, 35, count),
            angle=draw(3, 70, count) * DEGREE,
            orientation=draw(0, 180, count) * DEGREE,
            angular_velocity=draw(-3000, 3000, count) * DEGREE,
        ),
    )


def broadcast(scene, count):
    return jax.tree.map(lambda x: jnp.broadcast_to(x, (count,)), scene)


def with_logs(scene, logs):
    """A scene with other logarithms of k_E, gamma_v and c_v."""
    values = dict(zip(PARAMETERS, jnp.exp(logs), strict=True))
    return dataclasses.replace(scene, soil=dataclasses.replace(scene.soil, **values))


def outputs_of_logs(logs, scene):
    """Outputs by XLA, and the outcome."""
    assembly = Assembly(jax.tree.structure(Scene()), PLANAR, False)
    numbers = compute(assembly, with_logs(scene, logs), REFERENCE.tolerance, 1e-2)
    return jnp.stack([getattr(numbers, name) for name in OUTPUTS]), numbers.outcome_code


@pytest.fixture(scope="module")
def jacobians():
    """Values of random scenes by machine code, and Jacobians by AD with XLA and by
    central differences of the values."""
    count = 100
    scenes = broadcast(random_scenes(count, seed=3), count)
    logs = jnp.stack([jnp.log(getattr(scenes.soil, p)) for p in PARAMETERS], axis=1)
    exact, codes = unfused_jit(jax.vmap(jax.jacfwd(outputs_of_logs, has_aux=True)))(
        logs, scenes
    )

    def values(logs):
        numbers = computed(with_logs(scenes, logs.T), PLANAR, REFERENCE)
        outputs = np.stack([getattr(numbers, name) for name in OUTPUTS], axis=1)
        return outputs, numbers.outcome_code

    differences, same = [], np.ones(count, bool)
    # Values good to 1e-10 differ by steps of 2e-4: noise 1e-6 at worst.
    step = 2e-4
    for k in range(len(PARAMETERS)):
        shift = step * np.eye(len(PARAMETERS))[k]
        up, up_codes = values(logs + shift)
        down, down_codes = values(logs - shift)
        differences.append((up - down) / (2 * step))
        same &= np.asarray((up_codes == codes) & (down_codes == codes))
    base, _ = values(logs)
    return base, np.asarray(exact), np.stack(differences, -1), same


def test_derivatives_agree_with_central_differences(jacobians):
    value, exact, differences, same = jacobians
    # An outcome that changes within the step has no derivative to compare with.
    assert same.sum() >= 90
    scale = np.maximum(np.abs(differences), np.abs(value)[..., None])[same]
    error = np.abs(exact - differences)[same] / scale
    # Wanted, 1e-5. What is above comes from the differences: their second-order error,
    # and peaks that change place between the three impacts.
    assert np.median(error) < 1e-6
    assert np.quantile(error, 0.95) < 1e-5
    assert np.max(error) < 1e-3


def test_no_derivative_is_missing(jacobians):
    _, exact, _, _ = jacobians
    assert np.all(np.isfinite(exact))
    # k_E and gamma_v act on every impact; zero would mean a derivative that is lost.
    assert np.all(np.abs(exact[:, 0, :2]) > 0)


def e_n(k_E, angle):
    return simulate(
        Block(aspect_ratio=2.0), Soil(k_E=k_E), Impact(angle=angle), accuracy="balanced"
    ).e_n


def test_forward_equals_reverse():
    arguments = (900.0, 0.5)
    forward = jax.jacfwd(e_n, argnums=(0, 1))(*arguments)
    reverse = jax.grad(e_n, argnums=(0, 1))(*arguments)
    # The same derivative, transposed: equal to rounding.
    np.testing.assert_allclose(forward, reverse, rtol=1e-12)
    assert np.all(np.asarray(forward) != 0)


def test_inside_jit_and_vmap_as_alone():
    k_E = jnp.asarray([500.0, 900.0])
    alone = [jax.value_and_grad(e_n)(k, 0.5) for k in k_E]
    lanes = jax.vmap(jax.value_and_grad(e_n), in_axes=(0, None))(k_E, 0.5)
    for k, (value, slope) in enumerate(alone):
        # Lanes round otherwise and so step otherwise at the onset: equal to the error
        # of "balanced".
        assert lanes[0][k] == pytest.approx(float(value), rel=1e-5)
        assert lanes[1][k] == pytest.approx(float(slope), rel=1e-3)


def test_lanes_that_end_differently_keep_their_derivatives():
    """Detached, toppled and separating lanes side by side: none poisons another."""
    angle = jnp.asarray([0.0, 0.7, 1.39])
    orientation = jnp.asarray([0.0, 0.0, 45 * DEGREE])
    spin = jnp.asarray([0.0, 0.0, 20_000 * DEGREE])
    speed = jnp.asarray([14.0, 14.0, 1.0])

    def one(k_E, angle, orientation, spin, speed):
        impact = Impact(speed, angle, orientation, spin)
        # Ground that carries so much moment that the block topples under load.
        soil = Soil(k_E=k_E, psi=2.0)
        result = simulate(Block(aspect_ratio=3.0), soil, impact)
        return result.e_n, result.outcome_code

    slopes, codes = jax.vmap(jax.grad(one, has_aux=True), in_axes=(None, 0, 0, 0, 0))(
        900.0, angle, orientation, spin, speed
    )
    assert len(set(np.asarray(codes).tolist())) == 3
    assert np.all(np.isfinite(slopes))
    assert slopes[0] != 0
    assert slopes[1] != 0
    assert slopes[2] == 0


@pytest.mark.parametrize(
    ("aspect_ratio", "orientation", "angle"),
    [(1.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0, math.pi / 2, 0.0), (1.0, 0.3, 0.5)],
)
def test_derivatives_are_finite_at_symmetric_scenes(aspect_ratio, orientation, angle):
    def numbers(values):
        result = simulate(
            Block(aspect_ratio=values[0]),
            Soil(),
            Impact(orientation=values[1], angle=values[2]),
            accuracy="fast",
        )
        return jnp.stack(
            [result.e_n, result.e_bar, result.max_moment, result.rotation, result.R_r]
        )

    values = jnp.asarray([aspect_ratio, orientation, angle])
    assert np.all(np.isfinite(jax.jacfwd(numbers)(values)))


@pytest.mark.parametrize(("accuracy", "allowed"), [("fast", 1e-4), ("balanced", 1e-6)])
def test_stages_beyond_the_end_keep_the_derivative(accuracy, allowed):
    """The last step of a vertical impact lands on N = 0, with stages on either side of
    it. With the force cut off in those beyond, one derivative in eleven was off by
    0.013 at `balanced`, of 0.0005, and the value by nothing.

    Against central differences at `reference`, which are good to 3e-7: rounding and
    tolerance 3e-10, by a width of 2e-3.
    """
    block, impact = Block(mass=2000.0, aspect_ratio=1.0), Impact(speed=25.0, angle=0.0)
    logs = np.log(6.74) + 1e-3 * np.arange(-40, 41)
    soil = Soil(c_v=0.987, gamma_v=jnp.exp(logs), k_E=801.0)
    scene = broadcast(Scene(block, soil, impact), len(logs))
    along = jax.tree.map(np.zeros_like, scene)
    along = dataclasses.replace(
        along, soil=dataclasses.replace(along.soil, gamma_v=np.ones(len(logs)))
    )
    model = select_model(block, soil, impact)

    def solved(accuracy):
        return computed_along(scene, along, model, accuracy)

    values = solved("reference")[0].e_n
    differences = (values[2:] - values[:-2]) / 2e-3
    derivatives = solved(accuracy)[1].e_n
    by_log = (derivatives * np.exp(logs))[1:-1]
    np.testing.assert_allclose(by_log, differences, rtol=0.0, atol=allowed)


def test_accuracy_can_be_set_by_hand():
    custom = simulate(Block(), Soil(), Impact(), accuracy=Accuracy("mine", 1e-6, 1e-2))
    preset = simulate(Block(), Soil(), Impact(), accuracy="reference")
    assert custom.e_n == pytest.approx(float(preset.e_n), abs=1e-5)


def test_derivative_through_dashpots_is_that_of_differences():
    def scene_of(log_eta):
        soil = Soil(eta_N=jnp.exp(log_eta), eta_T=0.1, eta_R=0.1)
        return Scene(Block(aspect_ratio=2.0), soil, Impact(angle=0.7, orientation=0.5))

    def outputs(log_eta):
        assembly = Assembly(jax.tree.structure(Scene()), PLANAR_DAMPED, False)
        numbers = compute(
            assembly, scene_of(log_eta), accuracy.tolerance, accuracy.floor
        )
        return jnp.stack([getattr(numbers, name) for name in OUTPUTS])

    accuracy, point, step = Accuracy("1e-9", 1e-9, 1e-2), np.log(0.15), 1e-3
    slope = unfused_jit(jax.jacfwd(outputs))(point)
    numbers = computed(
        broadcast(scene_of(point + step * np.array([1.0, -1.0])), 2),
        PLANAR_DAMPED,
        accuracy,
    )
    above, below = np.stack([getattr(numbers, name) for name in OUTPUTS], axis=1)
    expected = (above - below) / (2.0 * step)
    # The differences err by the square of the step, and by the tolerance over it.
    slope, expected, size = np.asarray(slope), expected, np.abs(above)
    np.testing.assert_allclose(slope / size, expected / size, rtol=1e-4, atol=1e-5)
