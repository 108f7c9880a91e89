"""One impact: reference numbers, exact facts, symmetries, the ledger, singular
scenes."""

import math
import os
import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy import integrate, optimize

from jaximpact import Block, Impact, Outcome, Scene, Soil, simulate
from jaximpact.laws import Vesic
from jaximpact.shapes import Foundation

impact = Impact.from_degrees
TALL = Block(aspect_ratio=2.0)

# Rows of an independent implementation (SciPy Radau, rtol 1e-8), to the digits it gave.
REFERENCE = [
    ((1.0, {}, {}), (0.1295, None, 0.1295, 0.2119, 89828, 0.02900, 0.0)),
    (
        (2.0, {}, {"orientation": 30.0}),
        (-0.0998, None, 0.2237, 0.2610, 75769, 0.02990, 0.3003),
    ),
    (
        (2.0, {}, {"angle": 40.0}),
        (0.1085, 0.7352, 0.5076, 0.1844, 63219, 0.03248, 0.1465),
    ),
    (
        (4.0, {}, {"angle": 70.0}),
        (-0.0748, 0.8699, 0.8498, 0.1627, 16453, 0.05095, 0.2265),
    ),
    (
        (2.0, {"c_v": 0.5, "gamma_v": 0.85}, {"angle": 40.0}),
        (0.2214, 0.7544, 0.5638, 0.1118, 114447, 0.02160, 0.1564),
    ),
]


@pytest.mark.parametrize(("scene", "expected"), REFERENCE)
def test_reference_table(scene, expected):
    ratio, soil, how = scene
    block = Block(aspect_ratio=ratio)
    result = simulate(block, Soil(**soil), impact(**how), accuracy="reference")
    e_n, e_t, e_bar, penetration, force, duration, rotation = expected
    # Half a unit of the last printed digit.
    assert result.e_n == pytest.approx(e_n, abs=0.5e-4)
    if e_t is not None:
        assert result.e_t == pytest.approx(e_t, abs=0.5e-4)
    assert result.e_bar == pytest.approx(e_bar, abs=0.5e-4)
    assert result.max_penetration == pytest.approx(penetration, abs=0.5e-4)
    assert result.max_normal_force == pytest.approx(force, abs=0.5)
    assert result.duration == pytest.approx(duration, abs=0.5e-5)
    assert result.rotation == pytest.approx(rotation, abs=0.5e-4)
    assert result.outcome == Outcome.detached


def test_ledger_of_an_eccentric_impact():
    result = simulate(
        TALL,
        Soil(),
        Impact(orientation=math.radians(30.0), angle=0.3),
        accuracy="reference",
    )
    energy = result.energy
    # Published to 0.1 J.
    assert energy.kinetic_in == pytest.approx(9800.0, abs=0.05)
    assert energy.kinetic_out == pytest.approx(1486.4, abs=0.06)
    assert energy.viscoplastic == pytest.approx(7297.2, abs=0.06)
    assert energy.gravity == pytest.approx(226.6, abs=0.06)
    assert energy.arm == pytest.approx(-1381.6, abs=0.06)
    assert energy.stiffness == pytest.approx(138.6, abs=0.06)
    assert 0 <= energy.slider < 0.1
    assert 0 <= energy.elastic < 0.1
    assert energy.dashpot == 0.0
    # Closes to the solver's tolerance, 1e-8 of each unknown a step and 700 steps.
    assert abs(energy.residual) < 1e-6 * energy.kinetic_in


@pytest.mark.slow
@pytest.mark.parametrize("orientation_deg", [0.0, 90.0])
def test_without_yielding_a_vertical_impact_is_conservative(orientation_deg):
    soil, how = Soil(gamma_v=0.0), impact(orientation=orientation_deg)
    result = simulate(TALL, soil, how, accuracy="reference")
    # Gravity's work over the penetration left at the end is nil; e_n - 1 is error.
    assert result.e_n == pytest.approx(1.0, abs=1e-6)
    assert result.outcome == Outcome.detached

    # Deepest point from the energy integral, with u_ed = u_n = u:
    # m v0^2/2 + m g u = int_0^u k(u) u du
    axes = TALL.semi_axes
    along, across = axes.major, axes.minor
    if orientation_deg == 90.0:
        along, across = across, along

    def force(u):
        q = math.sqrt(u / along * (2 - u / along))
        sizes = 2 * float(across) * q, 2 * float(axes.out_of_plane) * q
        sizes = Foundation(*map(jnp.asarray, (*sizes, u, 0.0, 0.0, 0.0)))
        stiffness = soil.elasticity(sizes, soil.unit_weight, jnp.asarray(u))
        return float(stiffness.normal) * u

    def balance(u):
        stored = integrate.quad(force, 0.0, u, epsabs=1e-10, epsrel=1e-10)[0]
        return 0.5 * 100.0 * 14.0**2 + 100.0 * 9.81 * u - stored

    deepest = optimize.brentq(balance, 1e-3, 0.99 * float(along), xtol=1e-10)
    assert result.max_penetration == pytest.approx(deepest, rel=1e-5)


NUMBERS = ("e_n", "e_t", "e_bar", "max_penetration", "max_normal_force", "duration")
SAME = 1e-6
"""Relative difference allowed between scenes that are the same by symmetry. Their
arithmetic rounds differently, the step sizes at the onset, where errors are rounding,
then differ, and so results differ by the error of the integration, below 1e-7."""


def test_a_sphere_does_not_know_its_orientation():
    how = impact(angle=35.0, orientation=np.array([0.0, 33.0, 90.0]))
    result = simulate(Block(), Soil(), how, accuracy="reference")
    for name in NUMBERS:
        values = getattr(result, name)
        np.testing.assert_allclose(values, values[0], rtol=SAME)


@pytest.mark.parametrize("aspect_ratio", [1.0, 2.5])
@pytest.mark.parametrize("orientation_deg", [0.0, 90.0])
def test_a_symmetric_vertical_impact_does_not_turn(aspect_ratio, orientation_deg):
    result = simulate(
        Block(aspect_ratio=aspect_ratio), Soil(), impact(orientation=orientation_deg)
    )
    assert result.outcome == Outcome.detached
    # cos(90 deg) is 6e-17 in floating point: what rotation there is grows from it.
    assert abs(result.rotation) < 1e-10
    assert abs(result.max_moment) < 1e-6
    assert abs(result.tangential_velocity) < 1e-9
    assert np.isnan(result.e_t)
    assert result.e_contact == pytest.approx(float(result.e_n), abs=1e-10)


def test_a_block_that_moves_away_leaves_as_it_came():
    # Falling along the slope with a spin that lifts the low point faster than it falls.
    how = impact(1.0, angle=80.0, orientation=45.0, angular_velocity=20_000.0)
    result = simulate(Block(aspect_ratio=3.0), Soil(), how)
    assert result.outcome == Outcome.separating
    assert result.e_n == -1.0
    assert result.e_t == 1.0
    assert result.e_bar == 1.0
    assert result.max_normal_force == 0.0
    assert result.duration == 0.0
    assert result.energy.residual == 0.0


@pytest.mark.slow
def test_dashpots_that_do_nothing_change_nothing():
    how = impact(angle=40.0)
    without = simulate(TALL, Soil(), how, accuracy="reference")
    # 1e-12 of critical damping takes the path with the loop for the forces.
    with_loop = simulate(TALL, Soil(eta_N=1e-12), how, accuracy="reference")
    for name in NUMBERS:
        assert getattr(with_loop, name) == pytest.approx(
            float(getattr(without, name)), rel=1e-6
        )


class TwiceAsStrong(Vesic):
    def __call__(self, *arguments, **branch):
        return 2.0 * super().__call__(*arguments, **branch)


@pytest.mark.slow
def test_laws_can_be_replaced_one_by_one():
    ours = simulate(Block(), Soil(), Impact())
    theirs = simulate(Block(), Soil(bearing=TwiceAsStrong()), Impact())
    assert theirs.max_penetration < 0.9 * ours.max_penetration
    assert theirs.max_normal_force > 1.1 * ours.max_normal_force
    assert ours.manifest()["laws"]["bearing"] == "jaximpact.laws.bearing.Vesic"
    assert "test_simulate.TwiceAsStrong (" in theirs.manifest()["laws"]["bearing"]


@pytest.mark.slow
def test_importing_needs_no_float64():
    """JAX may be set up after jaximpact is imported, as its commands do."""
    script = "import jaximpact, jaximpact.calibration, jaximpact.runout"
    environment = os.environ | {"JAX_ENABLE_X64": "0"}
    subprocess.run([sys.executable, "-c", script], env=environment, check=True)


def test_float32_is_refused():
    scene = Scene()
    for use in (Block, lambda: simulate(scene)):
        with jax.enable_x64(False), pytest.raises(RuntimeError, match="jax_enable_x64"):
            use()


@pytest.mark.parametrize(
    "values",
    [{"angle": 40.0}, {"orientation": 30.0}, {"angle": -60.0}],
)
def test_the_block_ends_where_its_centre_and_its_rotation_say(values):
    """The final sinking is that of the ellipse as it has turned."""
    scene = impact(**values)
    result = simulate(TALL, Soil(), scene)
    major, minor, _ = TALL.semi_axes

    def height(orientation):
        return np.hypot(major * np.cos(orientation), minor * np.sin(orientation))

    start = float(scene.orientation)
    centre = height(start) - float(result.final_penetration)
    expected = height(start + float(result.rotation)) - centre
    # To rounding; the block is placed with a sinking of 1e-6 R at the start, which is
    # counted as penetration.
    assert float(result.final_sinking) == pytest.approx(expected, abs=1e-12)
    assert 0.0 < float(result.final_sinking) <= float(result.max_sinking)
    assert float(result.final_penetration) <= float(result.max_penetration)
