"""Many impacts: lanes that change places give what each scene gives by itself."""

import itertools
import os
import subprocess
import sys

import jax
import numpy as np
import pytest
from impact_scenes import mixed_scenes
from paths import HELPERS

from jaximpact import Block, Impact, Outcome, Scene, Soil, simulate, simulate_batch
from jaximpact.backend.xla_backend import WIDTH


def chosen(scenes, places):
    return jax.tree.map(
        lambda leaf: np.asarray(leaf)[places] if np.ndim(leaf) else leaf, scenes
    )


@pytest.fixture(
    scope="module", params=["native", pytest.param("XLA", marks=pytest.mark.xla)]
)
def batch(request):
    patch = pytest.MonkeyPatch()
    patch.setattr("jaximpact.batch.computes_on_cpu", lambda: request.param == "native")
    # More than two workers hold at once, and no multiple of what they hold.
    scenes = mixed_scenes(4 * WIDTH + 123)
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


DEVICES = """
import jax, numpy as np
jax.config.update("jax_enable_x64", True)
from impact_scenes import mixed_scenes
from jaximpact import batch, simulate_batch
from jaximpact.backend import xla_backend
batch.computes_on_cpu = lambda: False  # as on other devices
first, second = xla_backend.worker_devices()
assert first != second
numbers = []
# As many workers on one device as on two, so that programs are as wide.
for devices in ([first, first], [first, second]):
    xla_backend.worker_devices = lambda: devices
    result = simulate_batch(mixed_scenes(60), accuracy="fast")
    numbers.append([result.e_n, result.max_moment, result.steps])
    programs = xla_backend.compile_programs.cache_info().misses
    assert programs == len({*devices}), programs
np.testing.assert_array_equal(*numbers)
"""


@pytest.mark.xla
def test_several_devices_share_the_work():
    """Programs compiled for each of two devices, in a process that has two, give what
    those of one device give."""
    subprocess.run(
        [sys.executable, "-c", DEVICES],
        env=os.environ | {"XLA_FLAGS": "--xla_force_host_platform_device_count=2"},
        cwd=HELPERS,
        check=True,
    )
