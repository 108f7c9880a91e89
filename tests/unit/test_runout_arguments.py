"""Arguments of run-outs in Python: numbers of every kind, and what is refused, in one
sentence."""

from decimal import Decimal
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaximpact import Block, Scene, Soil
from jaximpact.errors import InputError
from jaximpact.rebound import ConstantCoefficients, Rebound
from jaximpact.runout import (
    ClosedForm,
    Ground,
    Lognormal,
    Normal,
    PowerLaw,
    Profile,
    Release,
    Uniform,
    draw,
    first_passages,
    maxima_along,
    passages,
    simulate_runout,
)
from jaximpact.runout.study.slope_file import by_name

PROFILE = Profile([0.0, 50.0, 100.0], [40.0, 10.0, 0.0])
RELEASE = Release(Block(mass=np.full(3, 100.0)), x=2.0, y=42.0)
LAW = ClosedForm(ConstantCoefficients(0.3, 0.8))


@pytest.fixture(scope="module")
def runs():
    return simulate_runout(PROFILE, RELEASE, LAW)


def test_profiles_and_releases_show_national_coordinates():
    profile = Profile([2600000.0, 2600730.5], [1520.0, 1400.0])
    release = Release(Block(mass=[100.0, 100.0]), [2600001.25, 2600002.5], 1521.0)
    assert "2600000 to 2600730.5" in repr(profile)
    assert "2600001.2 to 2600002.5" in repr(release)


@pytest.mark.parametrize("count", [1, 2, 4])
def test_a_law_has_parameters_for_each_block(count):
    law = ConstantCoefficients(np.full(count, 0.3), 0.8)
    with pytest.raises(InputError, match=r"the shape \(3,\), one for each block"):
        simulate_runout(PROFILE, RELEASE, ClosedForm(law))


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ([0, 1], "one for each of 3 blocks, but are 2"),
        ([0, 1, 2, 3], "one for each of 3 blocks, but are 4"),
        ([0.5, 1, 2], "whole numbers from 0"),
        ([-1, 0, 1], "whole numbers from 0"),
        ([np.nan, 0, 1], "whole numbers from 0"),
        ([np.inf, 0, 1], "whole numbers from 0"),
        (3, "whole numbers from 0"),
    ],
)
def test_the_numbers_of_a_ground(numbers, words):
    with pytest.raises(InputError, match=words):
        simulate_runout(PROFILE, RELEASE, LAW, ground=Ground(numbers=numbers))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((-1,), "trajectory must be at least 0"),
        ((3,), "trajectory must be at most 2"),
        ((1.5,), "trajectory must be a whole number"),
        ((0, 0.0), "spacing must be above 0 s"),
        ((0, np.nan), "spacing must be a finite number"),
    ],
)
def test_paths(runs, arguments, words):
    with pytest.raises(InputError, match=words):
        runs.path(*arguments)


def test_limits_and_paths_take_numbers_of_every_kind(runs):
    again = simulate_runout(
        PROFILE,
        RELEASE,
        LAW,
        time_limit=Decimal(600),
        event_limit=np.int16(10_000),
        hop_threshold=Decimal(1),
        width=np.uint8(2),
    )
    np.testing.assert_array_equal(again.x, runs.x)
    samples, same = runs.path(2, 0.1), again.path(np.int8(2), Decimal("0.1"))
    np.testing.assert_array_equal(samples["x"], same["x"])


def test_more_blocks_than_the_type_of_the_width_can_count():
    release = Release(Block(mass=np.full(300, 100.0)), x=2.0, y=42.0)
    found = simulate_runout(PROFILE, release, LAW, width=np.uint8(200))
    assert found.count_endings() == {"stopped": 300}


@pytest.mark.parametrize("place", [np.nan, np.inf, [1.0, 2.0], "a"])
def test_collectors(runs, place):
    with pytest.raises(InputError, match="x must be a"):
        passages(runs, place)


@pytest.mark.parametrize(
    ("blocks", "words"),
    [
        *((1, "blocks must be at least 3"), (2.5, "blocks must be a whole number")),
        (None, "blocks must be a whole number"),
    ],
)
def test_numbers_of_blocks(runs, blocks, words):
    found = passages(runs, 20.0)
    assert list(found.trajectory) == [0, 1, 2]
    with pytest.raises(InputError, match=words):
        first_passages(found, blocks)


@pytest.mark.parametrize(
    ("scene", "shapes"),
    [
        (Scene(Block(mass=[100.0, 200.0, 300.0])), r"\[\(\), \(2,\), \(3,\)\]"),
        (Scene(Block(mass=np.ones((2, 3)))), r"\[\(\), \(2,\), \(2, 3\)\]"),
    ],
)
def test_places_of_a_scene(scene, shapes):
    with pytest.raises(InputError, match=f"must broadcast .* have shapes {shapes}"):
        simulate_runout(PROFILE, scene, LAW, x=[10.0, 20.0])


@pytest.mark.parametrize(
    "edges", [[], [3.0], [5.0, 1.0], [0.0, 0.0], [0.0, np.nan], np.zeros((2, 2))]
)
def test_edges_of_bins(runs, edges):
    with pytest.raises(InputError, match="edges must be increasing numbers"):
        maxima_along(runs, edges)


@pytest.mark.parametrize(
    ("distribution", "words"),
    [
        (Normal(0.0, -1.0), "a.sd must be above 0"),
        (Normal(np.nan, 1.0), "a.mean must be a finite number"),
        (Normal(0.0, 1.0, 5.0, 1.0), "a needs least below most"),
        (Normal(0.0, 1.0, None, 5.0), "a.least must be a number"),
        (Normal(0.0, 1.0, 0.0, np.nan), "a.most must be a finite number"),
        (Normal(0.0, 1.0, 50.0, 60.0), "a holds nothing between least and most"),
        (Uniform(5.0, 1.0), "a must go up"),
        (Lognormal(-1.0, 2.0), "a.median must be above 0"),
        (Lognormal(1.0, 0.5), "a.geometric_sd must be above 1"),
        (PowerLaw(1.0, 5.0, 2.0), "a needs least below most"),
    ],
)
def test_distributions(distribution, words):
    with pytest.raises(InputError, match=words):
        draw({"a": distribution}, 3, 0)


def test_draws_take_numbers_of_every_kind():
    half = Decimal("0.5")
    found = draw({"a": Normal(half, half, Decimal(0))}, np.uint8(200), np.int8(3))
    expected = draw({"a": Normal(0.5, 0.5, 0.0)}, 200, 3)
    np.testing.assert_array_equal(found["a"], expected["a"])


def test_a_seed_of_the_ground_is_a_number_of_python():
    assert type(Ground(seed=np.uint8(3)).seed) is int


def test_files_of_one_name_are_told_apart():
    files = {Path("a/t.nc"): "1", Path("b/t.nc"): "2", Path("a/slope.toml"): "3"}
    assert by_name(files) == {"a/t.nc": "1", "b/t.nc": "2", "slope.toml": "3"}


@jax.tree_util.register_static
class Lost:
    """A law that gives no number."""

    def __call__(self, block, impact):
        spin = 0.0 * impact.angular_velocity
        return Rebound(jnp.sqrt(-1.0 - spin**2), impact.tangential_velocity, spin)


def test_blocks_that_fail_end_nowhere():
    runs = simulate_runout(PROFILE, RELEASE, ClosedForm(Lost()))
    assert runs.count_endings() == {"failed": 3}
    assert np.all(np.isnan([runs.x, runs.y]))
    assert np.all(np.isfinite(runs.time))


def test_a_ground_of_other_blocks_is_refused_in_a_line():
    """The natural mistake of (blocks,) for (blocks, 1)."""
    profile = Profile([0.0, 50.0, 100.0], [50.0, 20.0, 0.0], Soil())
    release = Release(Block(mass=[100.0, 200.0, 300.0]), x=2.0, y=55.0)
    ground = Ground(Soil(gamma_v=[1.0, 2.0, 3.0]))
    law = ClosedForm(ConstantCoefficients(e_n=0.3, e_t=0.8))
    with pytest.raises(ValueError, match="must broadcast to 3 blocks and 2 segments"):
        simulate_runout(profile, release, law, ground=ground)
    with pytest.raises(InputError, match="a is an empty list"):
        draw({"a": ()}, 3, 0)
