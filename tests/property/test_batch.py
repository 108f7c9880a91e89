"""Many impacts: lanes that change places give what each scene gives by itself."""

import itertools

import jax
import numpy as np
import pytest
from impact_scenes import mixed_scenes

from jaximpact import Block, Impact, Outcome, Scene, Soil, simulate, simulate_batch
from jaximpact.backend.rows import LANES_OF_XLA
from jaximpact.backend.threads import thread_count


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
        "jaximpact.backend.rows.computes_on_cpu", lambda: request.param == "native"
    )
    # More than all threads compute at once, and no multiple of that.
    scenes = mixed_scenes(4 * LANES_OF_XLA + 2048 * thread_count() + 123)
    seen = []
    result = simulate_batch(
        scenes, accuracy="fast", progress=lambda done, of: seen.append((done, of))
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
    other = simulate_batch(chosen(scenes, places), accuracy="fast")
    for name in ("e_n", "e_bar", "max_moment", "duration", "steps", "outcome_code"):
        # To the last bit: a lane's arithmetic does not depend on its neighbours.
        np.testing.assert_array_equal(
            getattr(other, name), getattr(result, name)[places]
        )


def test_as_one_by_one(batch):
    scenes, result, _ = batch
    for place in (0, 7, 1000, 2100):
        scene = chosen(scenes, place)
        alone = simulate(scene.block, scene.soil, scene.impact, accuracy="fast")
        assert int(alone.outcome_code) == int(result.outcome_code[place])
        # Rounding differs, and with it the steps at the onset: equal to the error of
        # "fast", whose largest in e_n is some 1e-4.
        assert float(alone.e_bar) == pytest.approx(result.e_bar[place], abs=5e-4)


def test_no_scenes_are_refused():
    scene = Scene(Block(mass=np.ones(0)), Soil(), Impact())
    with pytest.raises(ValueError, match="at least one scene"):
        simulate_batch(scene)
