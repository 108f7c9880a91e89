"""Sobol indices and elementary effects: known ones, with failures among the samples."""

import itertools
import json
import types

import numpy as np
import pytest
from SALib.sample import morris as morris_sample
from SALib.sample import sobol as sobol_sample
from SALib.test_functions import Ishigami

from jaximpact import (
    Block,
    Impact,
    Outcome,
    Range,
    Scene,
    morris,
    read_netcdf,
    sobol,
    write_netcdf,
)
from jaximpact.errors import InputError
from jaximpact.quantities import RESULT_COLUMNS
from jaximpact.sensitivity.figures import draw_heat_map, draw_sobol
from jaximpact.sensitivity.global_methods import (
    LEVELS,
    morris_of,
    problem_of,
    sobol_of,
)

ANGLES = (-np.pi, np.pi)
# f = sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1, Ishigami and Homma (1990): parts of its
# variance in closed form.
_A, _B, _PI4 = 7.0, 0.1, np.pi**4
_VARIANCE = _A**2 / 8 + _B * _PI4 / 5 + _B**2 * _PI4**2 / 18 + 0.5
_ALONE = 0.5 * (1 + _B * _PI4 / 5) ** 2, _A**2 / 8, 0.0
_TOGETHER = _B**2 * _PI4**2 * (1 / 18 - 1 / 50)  # of x1 and x3
FIRST = np.array(_ALONE) / _VARIANCE
TOTAL = FIRST + np.array([_TOGETHER, 0.0, _TOGETHER]) / _VARIANCE


@pytest.fixture(scope="module")
def ishigami_blocks():
    """4096 blocks of Ishigami's function, `(blocks, 5)`."""
    shares = sobol_sample.sample(
        problem_of("abc"), 4096, calc_second_order=False, seed=1
    )
    return Ishigami.evaluate((2.0 * shares - 1.0) * np.pi).reshape(-1, 5)


def with_failures(blocks, part, seed=2):
    """Some of the values made NaN."""
    failed = np.random.default_rng(seed).random(blocks.shape) < part
    return np.where(failed, np.nan, blocks)


# --- the estimators


def test_indices_of_pairs_of_ishigami_s_function():
    """Of its three pairs one acts together."""
    shares = sobol_sample.sample(
        problem_of("abc"), 4096, calc_second_order=True, seed=1
    )
    blocks = Ishigami.evaluate((2.0 * shares - 1.0) * np.pi).reshape(-1, 8)
    found = sobol_of(with_failures(blocks, 0.02), seed=0, second_order=True)
    exact = np.zeros((3, 3))
    exact[0, 2] = exact[2, 0] = _TOGETHER / _VARIANCE
    np.fill_diagonal(exact, np.nan)
    # Four standard deviations; the interval is 1.96 of them.
    away = np.abs(found["second_order"] - exact) / found["second_order_interval"]
    assert np.nanmax(away) < 2.1
    assert np.array_equal(np.isnan(found["second_order"]), np.eye(3, dtype=bool))
    assert np.abs(found["first_order"] - FIRST).max() < 0.05


def test_indices_of_ishigami_s_function_with_failures(ishigami_blocks):
    blocks = with_failures(ishigami_blocks, 0.05)
    found = sobol_of(blocks, seed=0)
    # 5 % of five impacts: a quarter of the blocks.
    assert found["groups_dropped"] == np.isnan(blocks).any(axis=1).sum()
    assert 0.2 < found["groups_dropped"] / 4096 < 0.25
    for index, interval, exact in (
        (found["first_order"], found["first_order_interval"], FIRST),
        (found["total_order"], found["total_order_interval"], TOTAL),
    ):
        # Four standard deviations; the interval is 1.96 of them.
        assert (np.abs(index - exact) < 2.0 * interval + 1e-12).all()
        assert (interval < 0.08).all()
    assert found["mean"] == pytest.approx(_A / 2, abs=0.2)
    assert found["standard_deviation"] ** 2 == pytest.approx(_VARIANCE, rel=0.1)


def test_blocks_with_failures_count_as_if_they_were_not_there(ishigami_blocks):
    blocks = with_failures(ishigami_blocks[:512], 0.05)
    whole = blocks[~np.isnan(blocks).any(axis=1)]
    masked, by_hand = sobol_of(blocks, seed=5), sobol_of(whole, seed=5)
    for name in ("first_order", "first_order_interval", "total_order"):
        np.testing.assert_array_equal(masked[name], by_hand[name])
    assert masked["groups_kept"] == by_hand["groups_kept"] == len(whole)
    assert masked["groups_dropped"] == 512 - len(whole)


def test_trajectories_with_failures_count_as_if_they_were_not_there():
    shares = morris_sample.sample(problem_of("abc"), 100, num_levels=LEVELS, seed=1)
    shares = shares.reshape(100, 4, 3)
    values = Ishigami.evaluate((2.0 * shares.reshape(-1, 3) - 1.0) * np.pi)
    values = with_failures(values.reshape(100, 4), 0.05)
    taken = ~np.isnan(values).any(axis=1)
    masked = morris_of(shares, values, seed=5)
    by_hand = morris_of(shares[taken], values[taken], seed=5)
    effects = [name for name in masked if "effect" in name]
    assert len(effects) == 4
    for name in effects:
        np.testing.assert_array_equal(masked[name], by_hand[name])
    assert masked["groups_dropped"] == (~taken).sum() > 0


def test_effects_of_a_straight_line_are_its_slopes():
    shares = morris_sample.sample(problem_of("ab"), 10, num_levels=LEVELS, seed=1)
    values = 3.0 * shares[:, 0] - 2.0 * shares[:, 1]
    found = morris_of(shares.reshape(10, 3, 2), values.reshape(10, 3), seed=0)
    np.testing.assert_allclose(found["mean_effect"], [3.0, -2.0], rtol=1e-12)
    np.testing.assert_allclose(found["mean_absolute_effect"], [3.0, 2.0], rtol=1e-12)
    np.testing.assert_allclose(found["effect_deviation"], 0.0, atol=1e-12)


def test_what_cannot_be_estimated_is_not(ishigami_blocks):
    few = ishigami_blocks[:64].copy()
    few[:40, 0] = np.nan
    none = np.full((64, 5), np.nan)
    constant = np.full((64, 5), 0.1)
    for blocks, words, dropped in (
        (few, "less than half of the groups", 40),
        (none, "no group", 64),
        (few[39:41], "one group alone has", 1),
        (constant, "does not change", 0),
    ):
        found = sobol_of(blocks, seed=0)
        assert words in found["reason"]
        assert found["groups_dropped"] == dropped
        assert np.isnan(found["total_order"]).all()
        assert np.isnan(found["first_order_interval"]).all()


def test_every_seed_gives_the_same_again_zero_too(ishigami_blocks):
    # SALib takes a seed of 0 for none, and NumPy's global state instead.
    blocks = ishigami_blocks[:256]
    intervals = []
    for seed in (0, 0, 1):
        np.random.seed(len(intervals))  # noqa: NPY002
        intervals.append(sobol_of(blocks, seed)["total_order_interval"])
    np.testing.assert_array_equal(intervals[0], intervals[1])
    assert (intervals[0] != intervals[2]).any()


# --- ranges


def test_ranges_hold_what_they_say():
    shares = np.array([0.0, 0.25, 0.5, 1.0])
    np.testing.assert_allclose(Range(2.0, 10.0).values(shares), [2.0, 4.0, 6.0, 10.0])
    even = Range(0.1, 10.0, "log-uniform").values(shares)
    np.testing.assert_allclose(even, [0.1, 10.0**-0.5, 1.0, 10.0], rtol=1e-14)
    ends = Range(0.3, 1.0, "log-uniform").values(np.linspace(-1e-15, 1.0 + 1e-15, 99))
    assert ends.min() == 0.3
    assert ends.max() == 1.0


@pytest.mark.parametrize(
    ("ranges", "words"),
    [
        ({"c_w": (0, 1), "k_E": (1, 2)}, "parameter c_w is unknown; did you mean c_v?"),
        ({"c_v": (0, 1)}, "at least two parameters"),
        ({"c_v": (-1, 1), "k_E": (1, 2)}, "c_v must be at least 0, but ranges to -1"),
        ({"c_v": (1, 1), "k_E": (1, 2)}, "must run upwards"),
        ({"c_v": 3.0, "k_E": (1, 2)}, "Range(lower, upper) or a pair"),
        (
            {"c_v": Range(0, 1, "log-uniform"), "k_E": (1, 2)},
            "must begin above 0 to be log-uniform",
        ),
        (
            {"c_v": Range(0, 1, "loguniform"), "k_E": (1, 2)},
            "did you mean log-uniform?",
        ),
    ],
)
def test_wrong_ranges_are_refused(ranges, words):
    for method in (sobol, morris):
        with pytest.raises(InputError) as caught:
            method(Scene(), ranges)
        assert words in str(caught.value)


def test_wrong_sizes_of_samples_are_refused():
    ranges = {"c_v": (0.5, 1.0), "k_E": (500, 900)}
    with pytest.raises(InputError, match="power of two, but is 1000; take 1024"):
        sobol(Scene(), ranges, blocks=1000)
    for blocks, needed in ((0, "at least 2, but is 0"), ("64", "a whole number")):
        with pytest.raises(InputError, match=f"blocks must be {needed}"):
            sobol(Scene(), ranges, blocks=blocks)
    with pytest.raises(InputError, match="18014398509481984 impacts, would take"):
        sobol(Scene(), ranges, blocks=2**52)
    with pytest.raises(InputError, match="3000000000000000 impacts, would take"):
        morris(Scene(), ranges, trajectories=10**15)
    with pytest.raises(InputError, match="at least 2, but is 1"):
        morris(Scene(), ranges, trajectories=1)
    with pytest.raises(InputError, match="seed must be at least 0, but is -1"):
        sobol(Scene(), ranges, seed=-1)
    with pytest.raises(ValueError, match="must be a scalar"):
        sobol(Scene(Block(mass=[1.0, 2.0])), ranges)


# --- whole studies

FAILED_ABOVE = 3.0


@pytest.fixture
def ishigami_model(monkeypatch):
    """Ishigami's function in the place of the model: e_n of orientation and of two
    numbers of the ground. Impacts with x3 above 3 fail; e_t has no value at all."""

    def simulate_batch(scene, **how):
        x = np.stack(
            [scene.impact.orientation, scene.soil.delta_1, scene.soil.delta_2], axis=1
        )
        failed = x[:, 2] > FAILED_ABOVE
        e_n = np.where(failed, np.nan, Ishigami.evaluate(x))
        result = dict.fromkeys((c.field for c in RESULT_COLUMNS.values()), 0.0 * e_n)
        codes = np.where(failed, Outcome.failed, Outcome.detached)
        changed = {"e_n": e_n, "e_t": np.full_like(e_n, np.nan), "outcome_code": codes}
        return types.SimpleNamespace(**result | changed)

    monkeypatch.setattr(
        "jaximpact.sensitivity.global_methods.simulate_batch", simulate_batch
    )


ISHIGAMI_RANGES = {
    "orientation_deg": (-180.0, 180.0),
    "delta_1": ANGLES,
    "delta_2": ANGLES,
}


def test_a_study_of_a_known_function(ishigami_model, tmp_path):
    found = sobol(Scene(), ISHIGAMI_RANGES, ("e_n", "e_t", "duration_s"), seed=4)
    e_n = found.sel(output="e_n")
    # Of five impacts in a block three have x3 from A and two from B, so a block is lost
    # with one of the two above 3.
    lost = 1.0 - (1.0 - (np.pi - FAILED_ABOVE) / (2.0 * np.pi)) ** 2
    assert int(e_n.groups_dropped) / 4096 == pytest.approx(lost, abs=0.002)
    outcomes = json.loads(found.attrs["outcomes"])
    assert sum(outcomes.values()) == 5 * 4096
    assert outcomes["failed"] / (5 * 4096) == pytest.approx(lost / 2, rel=0.05)
    # The indices are those of the function where the model has values: x3 in
    # (-pi, 3). There, with p = x3^4, f = (1 + 0.1 p) sin x1 + 7 sin^2 x2.
    x3 = np.linspace(-np.pi, FAILED_ABOVE, 20001)
    factor = 1.0 + _B * x3**4
    alone = 0.5 * factor.mean() ** 2, _A**2 / 8, 0.0
    together = 0.5 * factor.var()
    exact = np.array(alone) / (sum(alone) + together)
    assert (
        np.abs(e_n.first_order - exact) < 2 * e_n.first_order_interval + 1e-12
    ).all()
    assert "no group" in str(found.sel(output="e_t").reason.values)
    assert "does not change" in str(found.sel(output="duration_s").reason.values)
    assert found.attrs["seed"] == 4
    assert json.loads(found.attrs["ranges"])["delta_1"]["lower"] == -np.pi
    assert "SALib" in json.loads(found.attrs["versions"])

    write_netcdf(tmp_path / "indices.nc", found)
    assert read_netcdf(tmp_path / "indices.nc").total_order.equals(found.total_order)
    assert [t.get_text() for t in draw_heat_map(found).axes[0].texts][3:6] == [
        "none"
    ] * 3
    of_e_n, of_e_t, _ = draw_sobol(found).axes
    bars = [bar.get_width() for bar in of_e_n.patches]
    ranked = e_n.sortby("total_order")
    np.testing.assert_array_equal(bars, [*ranked.first_order, *ranked.total_order])
    assert "no group" in of_e_t.texts[0].get_text()


def box_of(artist):
    box = artist.get_window_extent()
    return box.x0, box.x1


def test_drawings_of_long_names_and_many_parameters_can_be_read(ishigami_model):
    found = sobol(Scene(), ISHIGAMI_RANGES, seed=4, blocks=8)
    names = ["max_sinking_m", "max_normal_force_N", "max_penetration_m", "e_t"]
    drawn = found.isel(output=[0, 0, 0, 1]).assign_coords(output=names)
    for longest in ("gamma_v", "angular_velocity_degps"):
        dataset = drawn.assign_coords(parameter=[longest, "angle_deg", "c_v"])
        figure = draw_sobol(dataset)
        figure.draw_without_rendering()
        for panel in figure.axes:
            left, right = box_of(panel.title)
            assert 0.0 < left < right < figure.bbox.width
            for words in panel.texts:  # why it is empty
                (low, high), (left, right) = box_of(panel), box_of(words)
                assert low < left < right < high
    # Five parameters of twelve outputs fit on a page of A4, and no names collide.
    some = found.isel(output=[0] * 12, parameter=[0, 1, 2, 0, 1])
    some = some.assign_coords(output=[*RESULT_COLUMNS][:12], parameter=[*"abcde"])
    figure = draw_sobol(some)
    assert figure.get_figheight() < 11.7
    figure.draw_without_rendering()
    for panel in figure.axes:
        boxes = [label.get_window_extent() for label in panel.get_yticklabels()]
        assert len(boxes) == 5
        for lower, upper in itertools.pairwise(boxes):
            assert lower.y1 < upper.y0
    # Thirty parameters, as many as an impact has.
    many = found.isel(output=[0], parameter=[0, 1, 2] * 10)
    heat_map = draw_heat_map(many)
    heat_map.draw_without_rendering()
    ends = [end for text in heat_map.axes[0].texts for end in box_of(text)]
    assert len(ends) == 60
    assert ends == sorted(ends)


def test_a_study_has_pairs_where_asked_for(ishigami_model):
    found = sobol(
        Scene(), ISHIGAMI_RANGES, ("e_n", "e_t"), blocks=64, second_order=True
    )
    pairs = found.second_order
    assert pairs.dims == ("output", "parameter", "with")
    assert sum(json.loads(found.attrs["outcomes"]).values()) == 8 * 64
    one, other = ({"parameter": a, "with": b} for a, b in (PAIR, PAIR[::-1]))
    assert pairs.sel(output="e_n", **one) == pairs.sel(output="e_n", **other)
    assert np.all(np.isnan(pairs.sel(output="e_t")))


PAIR = "orientation_deg", "delta_2"


def test_effects_of_a_known_function(ishigami_model):
    found = morris(Scene(), ISHIGAMI_RANGES, ("e_n",), trajectories=64)
    # The levels are at thirds of the range, of which x3 = pi fails: half of its steps
    # of two thirds reach it.
    assert 0 < int(found.groups_dropped[0]) < 64
    assert int(found.groups_dropped[0]) + int(found.groups_kept[0]) == 64
    found = morris(
        Scene(), ISHIGAMI_RANGES | {"delta_2": (-np.pi, 2.9)}, ("e_n",), trajectories=64
    )
    assert int(found.groups_dropped[0]) == 0
    # At the levels, -pi, -pi/3, pi/3 and pi, sin^2 is 0, 3/4, 3/4 and 0: every step
    # changes 7 sin^2 by as much.
    effect = found.sel(output="e_n", parameter="delta_1")
    exact = 7.0 * 0.75 / (2.0 / 3.0)
    assert float(effect.mean_absolute_effect) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize(
    ("method", "size"), [(sobol, "blocks"), (morris, "trajectories")]
)
def test_the_largest_seed_can_be_written(ishigami_model, tmp_path, method, size):
    largest, file = 2**31 - 1, tmp_path / "found.nc"
    write_netcdf(file, method(Scene(), ISHIGAMI_RANGES, seed=largest, **{size: 8}))
    assert read_netcdf(file).attrs["seed"] == largest
    with pytest.raises(InputError, match=f"seed must be at most {largest}, but is"):
        method(Scene(), ISHIGAMI_RANGES, seed=largest + 1, **{size: 8})


# --- with the model

RANGES = {
    "c_v": Range(0.1, 10.0, "log-uniform"),
    "k_E": Range(200.0, 5000.0, "log-uniform"),
    "speed_mps": (5.0, 25.0),
}
BASE = Scene(Block(mass=500.0), impact=Impact())


def test_a_seed_repeats_a_study_and_a_journal_goes_on(tmp_path):
    journal = tmp_path / "journal"
    told = []

    def stop_half_way(done, total):
        told.append(done)
        if done > total / 2:
            raise KeyboardInterrupt

    how = {"blocks": 64, "accuracy": "fast", "journal": journal}
    with pytest.raises(KeyboardInterrupt):
        sobol(BASE, RANGES, progress=stop_half_way, **how)
    resumed = []
    found = sobol(BASE, RANGES, progress=lambda *now: resumed.append(now), **how)
    assert resumed[0][0] >= max(told) / 2
    assert resumed[-1] == (320, 320)
    again = sobol(BASE, RANGES, blocks=64, accuracy="fast")
    assert again.identical(found)
    with pytest.raises(InputError, match="is no journal of this run"):
        sobol(BASE, RANGES, seed=1, **how)
    other = sobol(BASE, RANGES, blocks=64, accuracy="fast", seed=1)
    assert not other.total_order.equals(found.total_order)
    # A sphere that comes in along the normal neither slides nor turns.
    assert "no group" in str(found.sel(output="e_t").reason.values)
    assert "does not change" in str(found.sel(output="omega_radps").reason.values)


def test_ends_of_ranges_may_be_numbers_of_numpy():
    """As the least and the largest value of a column are."""
    ranges = {"angle_deg": np.array([0, 80]), "k_E": (np.float32(100.0), np.int64(900))}
    found = sobol(Scene(), ranges, ["e_n"], blocks=8, accuracy="fast")
    assert json.loads(found.attrs["ranges"])["k_E"]["lower"] == 100.0
