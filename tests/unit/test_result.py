"""Results: indexed as arrays are, shown without hiding failures, and the same numbers
in words, frames and datasets."""

import copy
import dataclasses
import html
import json
import pickle
import re

import jax
import jax.numpy as jnp
import numpy as np
import pandas as pd
import pytest
import xarray as xr

from jaximpact import (
    Block,
    Impact,
    Outcome,
    Scene,
    Soil,
    read_netcdf,
    simulate,
    simulate_batch,
    sweep,
    write_netcdf,
)
from jaximpact.errors import InputError
from jaximpact.impact.results import History
from jaximpact.io.scene_table import read_table
from jaximpact.quantities import (
    ENERGY_COLUMNS,
    FURTHER_COLUMNS,
    RESULT_COLUMNS,
    columns_of,
)
from jaximpact.scene_quantities import with_shapes
from jaximpact.shapes import Ellipsoid, RectangularPrism
from jaximpact.units import variable_attributes

GAMMA_V = np.array([2.0, 5.0, 9.0])
ANGLE_DEG = np.array([0.0, 30.0])
SAME = 1e-9
"""Relative: a batch gives what a scene gives alone, to rounding."""


@pytest.fixture(scope="module")
def batch():
    """Of two quantities that vary, (6,); `e_t` has no meaning in every other impact."""
    return simulate_batch(
        Block(aspect_ratio=1.5),
        Soil(gamma_v=np.repeat(GAMMA_V, 2)),
        Impact(angle=np.tile(np.radians(ANGLE_DEG), 3), orientation=0.4),
        accuracy="fast",
        ledger=True,
    )


@pytest.fixture(scope="module")
def grid(batch):
    """The same as (3, 2)."""
    return jax.tree.map(lambda leaf: np.reshape(leaf, (3, 2)), batch)


@pytest.fixture(scope="module")
def of_shapes(batch):
    """As if of blocks of two shapes, one of which has a parameter of its own, on
    another ground than the usual."""
    scene = Scene(
        Block(aspect_ratio=np.array([1.5, 1.5, 2.0])),
        Soil(hardening="HardeningPerRootArea"),
        Impact(angle=0.3, orientation=0.4),
    )
    kinds = [RectangularPrism, Ellipsoid, Ellipsoid]
    return dataclasses.replace(batch[:3], scene=with_shapes(scene, kinds))


@pytest.fixture(scope="module")
def with_failure(batch):
    """The same impacts, as if the first were separating and the last had failed."""

    def known(leaf):
        return np.append(leaf[:-1], np.nan)

    codes = batch.outcome_code.copy()
    codes[0], codes[-1] = Outcome.separating, Outcome.failed
    numbers = {
        name: known(getattr(batch, name))
        for name in ("e_n", "tangential_ratio", "e_bar")
    }
    return dataclasses.replace(batch, outcome_code=codes, **numbers)


def numbers_of(result):
    return jax.tree.leaves(dataclasses.replace(result, scene=None))


INDICES = [
    3,
    -1,
    np.int64(2),
    slice(1, 4),
    slice(None, None, -2),
    [4, 0, 4],
    [],
    np.array([True, False, True, True, False, False]),
    (Ellipsis, 2),
    None,
]


@pytest.mark.parametrize("index", INDICES, ids=str)
@pytest.mark.parametrize("made", [np.asarray, jnp.asarray], ids=["NumPy", "JAX"])
def test_every_number_and_field_is_indexed_as_an_array_is(batch, index, made):
    result = jax.tree.map(made, batch)
    if made is jnp.asarray and isinstance(index, np.ndarray):
        index = made(index)
    taken = result[index]
    plain = np.asarray(index) if isinstance(index, jax.Array) else index
    assert taken.shape == np.arange(6)[plain].shape
    for before, after in zip(
        jax.tree.leaves(batch), jax.tree.leaves(taken), strict=True
    ):
        assert isinstance(after, np.ndarray if made is np.asarray else jax.Array)
        np.testing.assert_array_equal(after, before[plain])
    assert taken.accuracy == batch.accuracy


@pytest.mark.parametrize(
    "index", [1, (1, 0), (slice(None), 1), (..., 0), np.eye(3, 2, dtype=bool)], ids=str
)
def test_several_axes_are_indexed_as_those_of_an_array(batch, grid, index):
    expected = np.arange(6).reshape(3, 2)[index]
    taken = grid[index]
    assert taken.shape == expected.shape
    np.testing.assert_array_equal(taken.e_n, batch.e_n[expected])
    angle = batch.scene.impact.angle[expected]
    np.testing.assert_array_equal(taken.scene.impact.angle, angle)


def test_a_field_that_is_one_number_stays_one(batch):
    scene = Scene(Block(), Soil(gamma_v=GAMMA_V[:, None]), Impact(angle=[0.0, 0.5]))
    result = dataclasses.replace(
        jax.tree.map(lambda leaf: leaf.reshape(3, 2), batch), scene=scene
    )
    taken = result[1:]
    assert np.shape(taken.scene.block.mass) == ()
    assert np.shape(taken.scene.soil.gamma_v) == (2, 2)
    np.testing.assert_array_equal(taken.scene.soil.gamma_v[:, 0], GAMMA_V[1:])
    assert float(result[2, 1].scene.soil.gamma_v) == GAMMA_V[2]
    assert float(result[2, 1].scene.impact.angle) == 0.5


@pytest.mark.parametrize("place", [0, 3])
def test_a_scene_taken_out_gives_its_numbers_again(batch, place):
    again = simulate(batch[place].scene, accuracy="fast")
    for received, expected in zip(
        numbers_of(again), numbers_of(batch[place]), strict=True
    ):
        # Work that is zero but for rounding is 1e-12 of the energies and less.
        assert received == pytest.approx(expected, rel=SAME, abs=1e-8, nan_ok=True)


@pytest.mark.slow
def test_a_scene_taken_out_has_its_own_shape(of_shapes):
    kinds = [type(one.scene.block.shape) for one in of_shapes]
    assert kinds == [RectangularPrism, Ellipsoid, Ellipsoid]
    together = simulate_batch(of_shapes.scene, accuracy="fast")
    alone = simulate(of_shapes[0].scene, accuracy="fast")
    assert float(alone.e_n) == pytest.approx(together.e_n[0], rel=SAME)
    # Several stay several.
    assert of_shapes[:1].scene.block.shape.kinds == (Ellipsoid, RectangularPrism)


def test_series_are_taken_with_their_impacts(batch):
    series = np.arange(24.0).reshape(6, 4)
    names = History._fields[1:]
    history = History(time=np.arange(4.0), **dict.fromkeys(names, series))
    result = dataclasses.replace(batch, history=history)
    np.testing.assert_array_equal(result[2].history.penetration, series[2])
    np.testing.assert_array_equal(result[..., 1:3].history.moment, series[1:3])
    np.testing.assert_array_equal(result[2].history.time, history.time)


def test_arrays_and_vmap_give_the_results_of_a_batch(grid):
    def of(gamma_v):
        impact = Impact(angle=np.radians(ANGLE_DEG), orientation=0.4)
        soil = Soil(gamma_v=gamma_v)
        return simulate(
            Block(aspect_ratio=1.5), soil, impact, accuracy="fast", ledger=True
        )

    # A field has its own axes, and under vmap those of each field come behind another.
    for result in (of(GAMMA_V[:, None]), jax.vmap(of)(GAMMA_V)):
        pd.testing.assert_frame_equal(
            result.to_dataframe(all_inputs=True),
            grid.to_dataframe(all_inputs=True),
            rtol=SAME,
        )
        one = result[2, 1]
        again = simulate(one.scene, accuracy="fast", ledger=True)
        assert float(again.e_n) == pytest.approx(float(one.e_n), rel=SAME)


def test_results_are_sequences_unless_they_are_of_one_impact(batch, grid):
    assert batch
    assert not batch[[]]
    assert len(batch) == 6
    assert [float(one.e_n) for one in batch] == batch.e_n.tolist()
    assert [row.shape for row in grid] == [(2,)] * 3
    one = batch[0]
    assert one
    assert one.shape == ()
    with pytest.raises(TypeError, match="no length"):
        len(one)
    with pytest.raises(TypeError, match="one impact, over which nothing"):
        iter(one)
    with pytest.raises(IndexError):
        one[0]


@pytest.mark.parametrize("index", [6, "e_n", 0.5, (0, 0)])
def test_an_index_that_is_none_is_refused(batch, index):
    with pytest.raises(IndexError):
        batch[index]


def test_outcomes_are_words(with_failure):
    expected = ["separating", *["detached"] * 4, "failed"]
    assert with_failure.outcome.dtype.kind == "U"
    assert with_failure.outcome.tolist() == expected
    assert with_failure[0].outcome is Outcome.separating
    assert with_failure[1:].outcome_counts() == {"detached": 4, "failed": 1}
    assert with_failure[with_failure.outcome == "failed"].shape == (1,)


def test_a_frame_has_what_varies_then_the_results(batch, grid):
    frame = batch.to_dataframe()
    assert list(frame) == ["gamma_v", "angle_deg", *RESULT_COLUMNS, "outcome"]
    np.testing.assert_array_equal(frame.gamma_v, np.repeat(GAMMA_V, 2))
    np.testing.assert_allclose(frame.angle_deg, np.tile(ANGLE_DEG, 3), rtol=1e-15)
    for name, column in RESULT_COLUMNS.items():
        np.testing.assert_array_equal(frame[name], getattr(batch, column.field))
    assert frame.outcome.tolist() == batch.outcome.tolist()
    assert grid.to_dataframe().e_n[2, 1] == batch.e_n[5]
    assert len(batch[0].to_dataframe()) == 1
    assert len(batch[[]].to_dataframe()) == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", ["batch", "of_shapes"])
def test_a_frame_of_all_inputs_is_a_table_of_the_scenes(name, request, tmp_path):
    result = request.getfixturevalue(name)
    frame = result.to_dataframe(all_inputs=True)
    assert set(columns_of(result.scene)) <= set(frame)
    inputs = frame.drop(columns=[*RESULT_COLUMNS, "outcome"])
    inputs.to_csv(tmp_path / "scenes.csv", index=False)
    read, expected = (
        simulate_batch(scene, accuracy="fast").e_n
        for scene in (read_table(tmp_path / "scenes.csv").scene(), result.scene)
    )
    # Units of the table and back cost a rounding of the inputs.
    np.testing.assert_allclose(read, expected, rtol=SAME)


def test_a_dataset_is_that_of_a_sweep(grid, tmp_path):
    dataset = grid.to_xarray(("gamma_v", "angle_deg"))
    write_netcdf(tmp_path / "impacts.nc", dataset)
    xr.testing.assert_identical(read_netcdf(tmp_path / "impacts.nc"), dataset)
    base = Scene(Block(aspect_ratio=1.5), impact=Impact(orientation=0.4))
    axes = {"gamma_v": GAMMA_V, "angle_deg": ANGLE_DEG}
    expected = sweep(base, axes, accuracy="fast")
    for name, column in ENERGY_COLUMNS.items():
        received = dataset[name]
        np.testing.assert_array_equal(received, getattr(grid.energy, column.field))
        assert received.attrs == variable_attributes(column.meaning, "J")
    of_sweep = dataset.drop_vars(ENERGY_COLUMNS)
    xr.testing.assert_allclose(of_sweep, expected, rtol=SAME)
    assert list(of_sweep) == [*RESULT_COLUMNS, *FURTHER_COLUMNS, "outcome"]
    for name in expected.variables:
        assert of_sweep[name].attrs == expected[name].attrs
    assert of_sweep.attrs.keys() == expected.attrs.keys()
    for name in expected.attrs.keys() - {"base"}:  # which says nothing of what varies
        assert of_sweep.attrs[name] == expected.attrs[name]


def test_inputs_are_coordinates_along_what_they_vary(batch, grid):
    assert dict(batch.to_xarray().sizes) == {"scene": 6}
    dataset = grid.to_xarray()
    assert {name: c.dims for name, c in dataset.coords.items()} == {
        "gamma_v": ("scene_0",),
        "angle_deg": ("scene_1",),
    }
    base = json.loads(dataset.attrs["base"])
    assert base.keys() == columns_of(grid.scene).keys() - {"gamma_v", "angle_deg"}
    assert base["aspect_ratio"] == 1.5
    # Named dimensions have their coordinate even where nothing varies.
    one = grid[:1, 1].to_xarray(("angle_deg",))
    np.testing.assert_allclose(one.angle_deg, [30.0], rtol=1e-15)
    assert not batch[0].to_xarray().coords


@pytest.mark.parametrize(
    ("dims", "message"),
    [
        ("ab", "must be a tuple of names, but is 'ab'"),
        ((0, 1), "must be a tuple of names"),
        (("a",), r"2 different names, one for each axis of the shape \(3, 2\)"),
        (("a", "a"), "2 different names"),
        (("e_n", "a"), "e_n cannot be .* that of a result"),
        (("angle_deg", "a"), "angle_deg cannot be .* it varies along a"),
    ],
)
def test_names_that_are_none_of_dimensions_are_refused(grid, dims, message):
    with pytest.raises(InputError, match=message):
        grid.to_xarray(dims)


def test_a_dataset_of_nothing_is_refused(batch):
    with pytest.raises(InputError, match=r"at least one impact, .* shape \(0,\)"):
        batch[[]].to_xarray()


def test_what_varies_along_two_dimensions_is_a_coordinate_over_both(grid):
    soil = Soil(gamma_v=np.arange(1.0, 7.0).reshape(3, 2))
    scene = Scene(grid.scene.block, soil, grid.scene.impact)
    dataset = dataclasses.replace(grid, scene=scene).to_xarray()
    assert dataset.gamma_v.dims == ("scene_0", "scene_1")


def cells(line):
    return re.split(r"\s{2,}", line.strip())


def test_one_impact_shows_its_numbers_with_units(batch):
    head, *lines = repr(batch[1]).splitlines()
    assert head == "ImpactResult: detached, accuracy fast"
    shown = {name: rest for name, *rest in map(cells, lines)}
    assert list(shown) == list(RESULT_COLUMNS)
    for name, column in RESULT_COLUMNS.items():
        value = float(getattr(batch, column.field)[1])
        assert shown[name] == [f"{value:.6g}", column.unit, column.meaning]


def test_many_impacts_count_what_their_statistics_leave_out(with_failure):
    head, *lines = repr(with_failure).splitlines()
    assert head == "ImpactResult: shape (6,), accuracy fast"
    assert cells(lines[0]) == ["outcomes: 4 detached, 1 separating, 1 failed"]
    assert cells(lines[1]) == ["varying: gamma_v, angle_deg"]
    assert cells(lines[2]) == ["left out of the statistics: 1 separating, 1 failed"]
    rows = {name: rest for name, *rest in map(cells, lines[4:])}
    counted = with_failure[1:5]
    ends = [f(counted.e_n) for f in (np.min, np.median, np.max)]
    assert rows["e_n"] == ["-", "4", *(f"{value:.6g}" for value in ends)]
    # Of the four, two came in along the normal.
    assert rows["e_t"][1] == str(np.count_nonzero(~np.isnan(counted.e_t))) == "2"


def test_where_all_failed_there_are_no_statistics(with_failure):
    assert repr(with_failure[5:]).splitlines()[1:] == [
        "  outcomes: 1 failed",
        "  varying: nothing",
    ]
    assert "outcomes: none" in repr(with_failure[[]])


def test_notebooks_show_the_same(batch, of_shapes):
    for result in (batch, batch[1], of_shapes):
        text = html.unescape(re.sub("<[^>]*>", " ", result._repr_html_()))
        assert text.split() == repr(result).split()
        assert result._repr_html_().count("<table>") == 1
    assert "varying: shape, aspect_ratio\n" in repr(of_shapes)


def test_inside_jit_results_are_indexed_and_shown(batch):
    result = jax.tree.map(jnp.asarray, batch)
    shown = []

    @jax.jit
    def parts(result, place):
        shown.extend([repr(result), result._repr_html_(), repr(result[0])])
        return result[place].e_n, result[1:3].e_n, [one.e_n for one in result]

    one, some, each = parts(result, 4)
    assert one == batch.e_n[4]
    np.testing.assert_array_equal(some, batch.e_n[1:3])
    np.testing.assert_array_equal(each, batch.e_n)
    assert all("ImpactResult" in text for text in shown)
    at_each = jax.vmap(lambda place: result[place].e_n)(np.arange(6))
    np.testing.assert_array_equal(at_each, batch.e_n)


@pytest.mark.parametrize(
    "changed",
    [
        lambda leaf: None,
        lambda leaf: 0,
        lambda leaf: jax.ShapeDtypeStruct(leaf.shape, leaf.dtype),
        lambda leaf: leaf + 0.5,
    ],
    ids=["empty", "axes", "shapes", "no outcomes"],
)
def test_what_is_no_result_is_shown_without_words(batch, changed):
    tree = jax.tree.map(changed, batch)
    assert "outcomes" not in repr(tree)
    assert repr(tree).startswith("ImpactResult(")
    assert tree._repr_html_().startswith("<pre>")
    in_part = dataclasses.replace(batch, e_n=changed(batch.e_n + 0.0))
    assert "e_n" in repr(in_part)


def test_histories_are_shown_whatever_is_known():
    """Before and after the contact there is no motion; means over all have no times."""
    speed, times = np.array([5.0, 10.0]), [-1e-3, 1e-3, 0.9]
    result = simulate(Block(), Soil(), Impact(speed=speed), save_at=times)
    for one in (result, result[0]):
        assert "accuracy balanced, history of 3 times" in repr(one)
    depths = result.history.penetration[:, 1]
    line = f"{depths.min():.6g} to {depths.max():.6g} m (2, 3), 4 nan"
    assert line in str(result.history)
    assert "history of" not in repr(jax.tree.map(np.mean, result))


def test_what_needs_known_numbers_says_so_in_a_derivative():
    for method in ("plot", "to_dataframe", "to_xarray", "manifest"):

        def used(speed, method=method):
            result = simulate(Block(), Soil(), Impact(speed=speed), accuracy="fast")
            getattr(result, method)()
            return result.e_n

        with pytest.raises(ValueError, match=f"{method} needs numbers that are known"):
            jax.grad(used)(5.0)


def test_a_result_that_was_donated_is_shown(batch):
    result = jax.tree.map(jnp.array, batch)
    for leaf in jax.tree.leaves(result):
        leaf.delete()
    assert repr(result).startswith("ImpactResult(")


@pytest.mark.parametrize(
    "copied",
    [copy.copy, copy.deepcopy, lambda result: pickle.loads(pickle.dumps(result))],
    ids=["copy", "deepcopy", "pickle"],
)
@pytest.mark.parametrize("name", ["batch", "of_shapes"])
def test_copies_are_the_same(name, copied, request):
    result = request.getfixturevalue(name)
    again = copied(result)
    assert repr(again) == repr(result)
    for received, expected in zip(
        jax.tree.leaves(again), jax.tree.leaves(result), strict=True
    ):
        np.testing.assert_array_equal(received, expected)


def test_an_outcome_is_its_code_and_its_word():
    """As arrays of words of many impacts compare with a word."""
    outcome = Outcome.in_contact
    assert outcome == "in contact"
    assert (outcome != "in contact") is False
    assert outcome != "failed"
    assert outcome == 3
    assert outcome in ("in contact", "failed")
    assert f"{outcome:>11}" == " in contact"
    assert {outcome: 1}[Outcome(3)] == 1
    np.testing.assert_array_equal(np.array([0, 3]) == outcome, [False, True])


def test_a_batch_is_not_traced():
    with pytest.raises(InputError, match="take simulate"):
        jax.jit(lambda mass: simulate_batch(Block(mass=mass)).e_n)(np.ones(3))


def test_derivatives_are_not_shown_as_an_impact():
    """The derivative of an outcome's code is 0, the code of `detached`."""

    def of_fluidity(gamma_v):
        return simulate(Block(), Soil(gamma_v=gamma_v), Impact())

    assert repr(of_fluidity(8.7)).startswith("ImpactResult: detached")
    assert "detached" not in repr(jax.jacfwd(of_fluidity)(8.7))
