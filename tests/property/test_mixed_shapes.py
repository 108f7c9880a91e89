"""Several shapes in one scene: each lane is what its shape alone gives."""

import pickle

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from own_laws import write_laws

from jaximpact import Block, Impact, Scene, Soil, simulate, simulate_batch
from jaximpact.errors import InputError
from jaximpact.identity import name_of
from jaximpact.io.scene_table import SLICE_ROWS, read_table
from jaximpact.parameters import parameter
from jaximpact.quantities import columns_of, leaf_places
from jaximpact.scene_quantities import scene_of_values, scene_values
from jaximpact.shapes import (
    AbstractShape,
    Ellipsoid,
    EllipticCylinder,
    RectangularPrism,
    mixed,
    shape_of_each,
)

pytestmark = pytest.mark.slow

KINDS = (Ellipsoid, EllipticCylinder, RectangularPrism)


def scenes(count, seed=0):
    """Blocks of three shapes in no order, and which each has."""
    random = np.random.default_rng(seed)
    index = random.integers(0, len(KINDS), count)
    shape = mixed(*KINDS)(
        index=index,
        aspect_ratio=random.uniform(0.8, 2.5, count),
        corner_radius_ratio=random.uniform(0.05, 1.0, count),
    )
    impact = Impact(
        speed=random.uniform(5.0, 20.0, count),
        angle=random.uniform(-1.0, 1.0, count) * (random.uniform(size=count) < 0.8),
        orientation=random.uniform(0.1, 1.4, count),
    )
    return Scene(Block(shape=shape), Soil(), impact), index


def alone(scene, index, place):
    """The lanes of one shape, as a scene that knows no other."""
    chosen = index == place
    taken = jax.tree.map(
        lambda leaf: np.asarray(leaf)[chosen] if np.ndim(leaf) else leaf, scene
    )
    names = {"aspect_ratio", "out_of_plane_ratio"}
    if KINDS[place] is RectangularPrism:
        names.add("corner_radius_ratio")
    own = {name: getattr(taken.block, name) for name in names}
    return Scene(Block(shape=KINDS[place](**own)), taken.soil, taken.impact), chosen


def test_a_batch_gives_the_bits_of_each_shape_alone():
    scene, index = scenes(60)
    result = simulate_batch(scene, accuracy="fast", ledger=True)
    assert np.all(np.isfinite(result.e_bar[index == 0]))
    for place in range(len(KINDS)):
        part, chosen = alone(scene, index, place)
        expected = simulate_batch(part, accuracy="fast", ledger=True)
        for name in ("e_n", "max_moment", "rotation", "steps", "outcome_code"):
            np.testing.assert_array_equal(
                getattr(result, name)[chosen], getattr(expected, name)
            )
        np.testing.assert_array_equal(
            result.energy.viscoplastic[chosen], expected.energy.viscoplastic
        )


@pytest.mark.parametrize("place", range(len(KINDS)))
def test_sizes_are_those_of_the_lane_s_shape(place):
    kind = KINDS[place]
    values = {"aspect_ratio": 1.7, "out_of_plane_ratio": 0.8}
    corner = {"corner_radius_ratio": 0.3} if kind is RectangularPrism else {}
    one = kind(**values | corner)
    several = mixed(*KINDS)(index=place, corner_radius_ratio=0.3, **values)
    axes = one.semi_axes(100.0, 2600.0)
    for function in (
        lambda s: s.semi_axes(100.0, 2600.0),
        lambda s: s.inertia(100.0, axes),
        lambda s: (s.unit_volume, s.unit_inertia),
    ):
        assert jax.tree.leaves(function(several)) == jax.tree.leaves(function(one))


def test_simulate_gives_what_each_shape_gives_alone():
    """Of arrays, of one scene, with times, and under `jit`, where which block has which
    shape is known."""
    scene, index = scenes(9)
    times = np.linspace(0.0, 0.02, 5)
    result = simulate(scene, accuracy="fast", save_at=times)
    for place in range(len(KINDS)):
        part, chosen = alone(scene, index, place)
        expected = simulate(part, accuracy="fast", save_at=times)
        np.testing.assert_array_equal(result.e_bar[chosen], expected.e_bar)
        np.testing.assert_array_equal(
            result.history.normal_force[chosen], expected.history.normal_force
        )
    np.testing.assert_allclose(
        simulate(result[4].scene, accuracy="fast").e_bar, result.e_bar[4]
    )

    def upright(speed):
        still = Scene(scene.block, scene.soil, Impact(speed=speed))
        # With the ledger, whose planar kernels the batch above has.
        return simulate(still, accuracy="fast", ledger=True).e_bar

    speed = scene.impact.speed
    np.testing.assert_allclose(jax.jit(upright)(speed), upright(speed), rtol=1e-9)
    with pytest.raises(InputError, match="JAX traces which block has which shape"):
        jax.jit(lambda scene: simulate(scene, accuracy="fast").e_bar)(scene)


def test_derivatives_are_those_of_the_lane_s_shape():
    impact = Impact.from_degrees(angle=40.0, orientation=30.0)

    def of_several(aspect_ratio, corner):
        shape = mixed(Ellipsoid, RectangularPrism)(
            index=0, aspect_ratio=aspect_ratio, corner_radius_ratio=corner
        )
        return simulate(Block(shape=shape), Soil(), impact, accuracy="fast").e_n

    def of_one(aspect_ratio):
        block = Block(aspect_ratio=aspect_ratio)
        return simulate(block, Soil(), impact, accuracy="fast").e_n

    by_ratio, by_corner = jax.grad(of_several, argnums=(0, 1))(2.0, 0.2)
    np.testing.assert_allclose(by_ratio, jax.grad(of_one)(2.0), rtol=1e-6)
    assert float(by_corner) == 0.0


class Short(AbstractShape):
    """A shape whose parameters have other defaults and ranges."""

    aspect_ratio: jax.Array = parameter(0.5, "-", "(0, 1]", "H/R")
    out_of_plane_ratio: jax.Array = parameter(1.0, "-", "(0, inf)", "W/R")
    unit_volume, unit_inertia = 4.0, 0.4

    def support(self, axes, sin, cos, *, side=None):
        # Not defined for longer blocks, so that nothing else may come here.
        return axes.minor * jnp.sqrt(1.0 - self.aspect_ratio**2)

    def section(self, axes, sin, cos, height, sinking):
        raise NotImplementedError


def test_what_is_not_chosen_gets_what_it_allows():
    shape = mixed(Ellipsoid, Short)(index=0, aspect_ratio=3.0)
    assert float(shape.alone(0).aspect_ratio) == 3.0
    assert float(shape.alone(1).aspect_ratio) == 0.5

    def major(ratio):
        shape = mixed(Ellipsoid, Short)(index=0, aspect_ratio=ratio)
        return shape.semi_axes(100.0, 2600.0).major

    assert np.isfinite(jax.grad(major)(3.0))


class Oblate(EllipticCylinder):
    """A cylinder that is never longer than thick."""

    aspect_ratio: jax.Array = parameter(0.5, "-", "(0, 1]", "H/R")


def test_each_shape_keeps_its_defaults_and_its_range():
    shape = shape_of_each([Ellipsoid, Oblate, Ellipsoid])
    np.testing.assert_array_equal(shape.aspect_ratio, [1.0, 0.5, 1.0])
    column = columns_of(Scene(Block(shape=shape)))["aspect_ratio"]
    assert column.range_text == "above 0"
    ratio = np.array([2.0, 2.0, 2.0])
    scene = Scene(Block(shape=shape, aspect_ratio=ratio))
    with pytest.raises(InputError, match=r"in \(0, 1\], but is 2 .scene 1."):
        simulate_batch(scene)


class Metric(Short):
    """A shape whose parameter has the name of another's, in another unit."""

    corner_radius_ratio: jax.Array = parameter(0.1, "m", "[0, inf)", "radius")


def test_parameters_of_one_name_in_two_units_are_refused():
    with pytest.raises(InputError, match=r"is in - .*but Metric\.corner_radius_r"):
        mixed(RectangularPrism, Metric)


def test_one_shape_is_itself():
    assert type(shape_of_each([Ellipsoid, Ellipsoid])) is Ellipsoid


def test_an_index_of_no_shape_is_refused():
    shape = mixed(*KINDS)(index=np.array([0, 3]))
    with pytest.raises(InputError, match="one of 0 to 2, but holds 3"):
        simulate_batch(Scene(Block(shape=shape)))


def test_the_index_is_no_column_but_the_names_are_told():
    scene, index = scenes(5)
    assert "index" not in columns_of(scene)
    assert set(leaf_places(scene)) == set(columns_of(scene))
    values = scene_values(scene)
    assert values["shape"] == [KINDS[place].__name__ for place in index]
    again = scene_of_values(values)
    assert scene_values(again) == values
    assert pickle.loads(pickle.dumps(scene)).block.shape.kinds == KINDS


def test_the_source_of_every_shape_counts(folder):
    write_laws(folder)
    mine = type(Block(shape="my_shapes.py:Hollow").shape)
    first = name_of(mixed(Ellipsoid, mine))
    assert first.startswith(
        "jaximpact.shapes.elliptic.Ellipsoid and my_shapes.Hollow ("
    )
    text = (folder / "my_shapes.py").read_text()
    (folder / "my_shapes.py").write_text(text.replace("self.spread *", "2.0 *"))
    edited = type(Block(shape="my_shapes.py:Hollow").shape)
    assert name_of(mixed(Ellipsoid, edited)) != first


# Tables


def test_rows_have_their_own_shapes(folder):
    write_laws(folder)
    rows = [
        "Ellipsoid,2,,",
        "my_shapes.py:Hollow,2,,1.5",
        "RectangularPrism,1.5,0.3,",
    ] * SLICE_ROWS  # more than are converted at once
    (folder / "scenes.csv").write_text(
        "shape,aspect_ratio,corner_radius_ratio,spread\n" + "\n".join(rows)
    )
    scene = read_table(folder / "scenes.csv").scene()
    shape = scene.block.shape
    names = [kind.__name__ for kind in shape.kinds]
    found = [names[int(place)] for place in shape.index]
    assert found == ["Ellipsoid", "Hollow", "RectangularPrism"] * SLICE_ROWS
    np.testing.assert_array_equal(shape.aspect_ratio[:3], [2.0, 2.0, 1.5])
    # What is not there has a value that is allowed.
    np.testing.assert_array_equal(shape.corner_radius_ratio[:3], [0.2, 0.2, 0.3])
    np.testing.assert_array_equal(shape.spread[-3:], [1.0, 1.5, 1.0])


def test_tables_of_tests_take_shapes_and_laws(folder):
    (folder / "tests.csv").write_text(
        "test,shape,corner_radius_ratio,flow,e_n\n"
        "a,Ellipsoid,,FluidityRate,>0.1\n"
        "b,RectangularPrism,0.4,FluidityRate,\n"
    )
    table = read_table(folder / "tests.csv", measured=True)
    scene = table.scene()
    assert type(scene.soil.flow).__name__ == "FluidityRate"
    np.testing.assert_array_equal(scene.block.corner_radius_ratio, [0.2, 0.4])
    assert table.labels == {"test": ["a", "b"]}
    np.testing.assert_array_equal(table.censored["e_n"], [1, 0])


def test_a_journal_heeds_which_lane_has_which_shape(tmp_path):
    def of(*index):
        return Scene(Block(shape=mixed(Ellipsoid, RectangularPrism)(index=[*index])))

    first = simulate_batch(of(0, 1), accuracy="fast", journal=tmp_path / "j")
    again = simulate_batch(of(0, 1), accuracy="fast", journal=tmp_path / "j")
    np.testing.assert_array_equal(first.e_n, again.e_n)
    with pytest.raises(InputError, match="no journal of this run"):
        simulate_batch(of(1, 0), accuracy="fast", journal=tmp_path / "j")
