"""One impact: exact facts, and what it needs. Its numbers against an independent
implementation are in test_oracle.py, its symmetries in test_shapes.py."""

import itertools
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from impact_scenes import mixed_scenes
from scipy import integrate, optimize

from jaximpact import Block, Impact, Outcome, Scene, Soil, simulate, simulate_batch
from jaximpact.backend.rows import LANES_OF_XLA
from jaximpact.backend.threads import thread_count
from jaximpact.shapes import Foundation

impact = Impact.from_degrees
TALL = Block(aspect_ratio=2.0)


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


# --- many impacts: lanes that change places give what each scene gives by itself


def chosen(scenes, places):
    return jax.tree.map(
        lambda leaf: np.asarray(leaf)[places] if np.ndim(leaf) else leaf, scenes
    )


@pytest.fixture(
    scope="module", params=["native", pytest.param("XLA", marks=pytest.mark.xla)]
)
def batch(request):
    patch = pytest.MonkeyPatch()
    patch.setattr(
        "jaximpact.backend.kernel_choice.computes_on_cpu",
        lambda: request.param == "native",
    )
    # More than are computed at once, and no multiple of that
    at_once = 4096 * thread_count() if request.param == "native" else 2 * LANES_OF_XLA
    scenes = mixed_scenes(at_once + 123)
    seen = []
    result = simulate_batch(
        scenes,
        accuracy="fast",
        ledger=True,
        progress=lambda done, of: seen.append((done, of)),
    )
    yield scenes, result, seen
    patch.undo()


def test_every_scene_has_its_result(batch):
    _, result, seen = batch
    codes = set(result.outcome_code.astype(int))
    assert {Outcome.detached, Outcome.separating} <= codes
    assert Outcome.failed not in codes
    assert np.all(np.isfinite(result.e_bar))
    assert seen[-1] == (len(result.e_n), len(result.e_n))
    assert all(a < b for (a, _), (b, _) in itertools.pairwise(seen))


def test_order_changes_nothing(batch):
    scenes, result, _ = batch
    places = np.random.default_rng(1).permutation(len(result.e_n))
    other = simulate_batch(chosen(scenes, places), accuracy="fast", ledger=True)
    for name in ("e_n", "e_bar", "max_moment", "duration", "steps", "outcome_code"):
        # To the last bit: a lane's arithmetic does not depend on its neighbours.
        np.testing.assert_array_equal(
            getattr(other, name), getattr(result, name)[places]
        )


def test_as_one_by_one(batch):
    scenes, result, _ = batch
    for place in (0, 7, 1000, len(result.e_n) - 1):
        scene = chosen(scenes, place)
        alone = simulate(scene.block, scene.soil, scene.impact, accuracy="fast")
        assert int(alone.outcome_code) == int(result.outcome_code[place])
        # Rounding differs, and with it the steps at the onset: equal to the error of
        # "fast", whose largest in e_n is some 1e-4.
        assert float(alone.e_bar) == pytest.approx(result.e_bar[place], abs=5e-4)


@pytest.mark.xla
def test_impacts_as_by_xla(monkeypatch):
    """In as many lanes as the batches above: by the same program of XLA."""
    scenes = chosen(mixed_scenes(40, seed=3), np.arange(LANES_OF_XLA) % 40)
    on_cpu = "jaximpact.backend.kernel_choice.computes_on_cpu"
    monkeypatch.setattr(on_cpu, lambda: True)
    mine = simulate_batch(scenes, accuracy="reference", ledger=True)
    monkeypatch.setattr(on_cpu, lambda: False)
    timing = {}
    theirs = simulate_batch(scenes, accuracy="reference", ledger=True, timing=timing)
    assert timing["engine"] == "XLA"
    np.testing.assert_array_equal(mine.outcome_code, theirs.outcome_code)
    # Rounding changes the steps at the onset, and results by less than the error of
    # "reference", 1e-7; the median is left with rounding.
    for name in ("e_n", "e_t", "e_bar", "rotation"):
        difference = np.abs(getattr(mine, name) - getattr(theirs, name))
        assert np.nanmax(difference) < 1e-7
        assert np.nanmedian(difference) < 1e-11
    for found, expected in zip(
        jax.tree.leaves(mine.energy), jax.tree.leaves(theirs.energy), strict=True
    ):
        scale = np.nanmax(np.abs(expected))
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-9 * scale)


def test_no_scenes_are_refused():
    scene = Scene(Block(mass=np.ones(0)), Soil(), Impact())
    with pytest.raises(ValueError, match="at least one scene"):
        simulate_batch(scene)
