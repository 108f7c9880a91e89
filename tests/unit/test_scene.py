"""A scene: one way in for all functions, its parts, and grounds that have names."""

import ast
import copy
import inspect
import math
import pickle
from dataclasses import FrozenInstanceError, fields, replace
from fractions import Fraction
from importlib import metadata
from pathlib import Path
from typing import Any

import jax
import numpy as np
import pytest

import jaximpact
from jaximpact import (
    Block,
    Impact,
    ImpactResult,
    Scene,
    Soil,
    laws,
    simulate,
    simulate_batch,
)
from jaximpact.errors import InputError, UnusualValueWarning
from jaximpact.io.toml import read_scene, scene_from
from jaximpact.parameters import declared_of, parameter, parts_of
from jaximpact.quantities import (
    INPUT_COLUMNS,
    columns_of,
    leaf_places,
    why_unknown,
)
from jaximpact.scene_quantities import scene_of_values, scene_values
from jaximpact.shapes import RectangularPrism


@pytest.mark.slow
def test_a_scene_or_its_parts_are_the_same():
    parts = Block(aspect_ratio=2.0), Soil(c_v=0.5), Impact(angle=0.4)
    expected = simulate(Scene(*parts)).e_n
    for given in (parts, (Scene(*parts),), (parts,)):
        assert simulate(*given).e_n == expected
        assert simulate_batch(*given).e_n == expected
    by_name = simulate(impact=parts[2], scene=parts[0], soil=parts[1])
    assert by_name.e_n == expected
    # What is left out has its default.
    assert simulate(Scene()).e_n == simulate(Block()).e_n


def test_degrees():
    impact = Impact.from_degrees(
        10.0, angle=30.0, orientation=45.0, angular_velocity=90.0, slope=-20.0
    )
    expected = Impact(10.0, *np.radians([30.0, 45.0, 90.0, -20.0]))
    for name in ("speed", "angle", "orientation", "angular_velocity", "slope"):
        found = float(getattr(impact, name))
        assert found == pytest.approx(float(getattr(expected, name)), rel=1e-15)
    slope = jax.grad(lambda angle: Impact.from_degrees(angle=angle).angle)(30.0)
    assert float(slope) == pytest.approx(math.pi / 180.0, rel=1e-15)
    with pytest.raises(InputError, match=r"Impact.angle must be a number"):
        Impact.from_degrees(angle="steep")


def test_named_grounds():
    assert Soil.very_dense_sand() == Soil()
    for ground, gamma_v in (
        (Soil.supplement_gamma_v_1_70(), 1.70),
        (Soil.supplement_gamma_v_0_85(), 0.85),
    ):
        assert float(ground.c_v) == 0.5
        assert float(ground.gamma_v) == gamma_v
        assert f"gamma_v            {gamma_v:g} m/s" in str(ground)


def test_columns_are_read_off_the_scene_in_the_order_of_its_leaves():
    scene = Scene()
    assert columns_of(scene) == INPUT_COLUMNS
    places = leaf_places(scene)
    assert sorted(places.values()) == list(range(len(INPUT_COLUMNS)))
    leaves = jax.tree.leaves(scene)
    for name, column in INPUT_COLUMNS.items():
        # Half a unit in the last place of the conversion
        found = float(leaves[places[name]]) / column.factor
        assert found == pytest.approx(column.default, rel=1e-15, abs=0.0)


def test_columns_follow_laws_and_shape():
    scene = Scene(Block(shape="RectangularPrism"), Soil(flow="PowerNucleus"))
    columns = columns_of(scene)
    assert columns.keys() - INPUT_COLUMNS.keys() == {
        "corner_radius_ratio",
        "nucleus_exponent",
    }
    assert columns["nucleus_exponent"].requirement == "in [1, 20]"


def test_a_scene_is_told_and_found_again():
    block = Block(mass=3.0, shape="EllipticCylinder", aspect_ratio=2.0)
    scene = Scene(block, Soil(flow="PowerNucleus", nucleus_exponent=3.0, c_v=0.3))
    values = scene_values(scene)
    assert values["shape"] == "EllipticCylinder"
    again = scene_of_values(values)
    assert jax.tree.structure(again) == jax.tree.structure(scene)
    for found, expected in zip(
        jax.tree.leaves(again), jax.tree.leaves(scene), strict=True
    ):
        np.testing.assert_allclose(found, expected, rtol=1e-15)


def test_parts_are_pickled_and_compared():
    soil = Soil(flow="PowerNucleus", gamma_v=[1.0, 2.0])
    again = pickle.loads(pickle.dumps(soil))
    assert jax.tree.structure(again) == jax.tree.structure(soil)
    np.testing.assert_array_equal(again.gamma_v, soil.gamma_v)


# JAX's own, as it reads the marker, which is before anybody can ask.
@pytest.mark.filterwarnings("ignore:overflow encountered in cast:RuntimeWarning")
@pytest.mark.parametrize(
    "of", ["a soil", "a law", "a scene", "a result", "a history", "a ledger"]
)
def test_a_pickle_is_read_in_float64_alone(of):
    """JAX in float32 would cut its numbers, and make an infinity of a marker."""
    soil = Soil(gamma_v=5.1)
    scene = Scene(Block(), soil, Impact(angle=0.0))
    result = simulate(scene, save_at=[0.0])
    made = {"a soil": soil, "a law": soil.flow, "a scene": scene, "a result": result}
    made |= {"a history": result.history, "a ledger": result.energy}
    data = pickle.dumps(made[of])
    with jax.enable_x64(False), pytest.raises(RuntimeError, match="jax_enable_x64"):
        pickle.loads(data)
    assert jax.tree.leaves(pickle.loads(data))[0].dtype == np.float64


NUMBERS = [3, 3.0, np.float64(3), np.float32(3), np.array(3.0), Fraction(3)]


@pytest.mark.parametrize("value", NUMBERS, ids=lambda x: type(x).__name__)
def test_numbers_are_float64_arrays_that_are_known_wherever_they_are_made(value):
    def check(number):
        speed = Impact(speed=number).speed
        assert isinstance(speed, jax.Array)
        assert not isinstance(speed, jax.core.Tracer)
        assert np.asarray(speed) == 3.0
        assert (speed.dtype, speed.weak_type) == (np.float64, False)
        return speed

    speed = check(value)
    assert check(speed) is speed
    for of_jax in (jax.numpy.asarray(3.0), jax.numpy.float32(3.0)):
        check(of_jax)
    for transform, argument in (
        (jax.jit, 1.0),
        (jax.grad, 1.0),
        (jax.vmap, np.ones(2)),
    ):
        result = transform(lambda x: x * check(value))(argument)
        np.testing.assert_array_equal(result, 3.0)


@pytest.mark.parametrize("value", [math.nan, math.inf, -0.0])
def test_what_is_no_usual_number_is_kept(value):
    with jax.debug_nans(True), jax.debug_infs(True):
        found = np.asarray(Impact(angular_velocity=value).angular_velocity)
    np.testing.assert_array_equal(found, value)
    assert np.signbit(found) == np.signbit(value)


def test_numbers_are_arrays_of_jax_where_it_compiles_nothing():
    with jax.disable_jit():
        speed = Impact(speed=3.14159).speed
    assert isinstance(speed, jax.Array)
    assert isinstance(Impact(speed=3.14159).speed, jax.Array)


def test_a_parameter_by_its_name_is_that_of_a_part_made_anew():
    soil = Soil(gamma_v=np.float64(5.0), c_v=[0.1, 0.2], k_E=900)
    anew = Soil(
        flow=laws.Perzyna(gamma_v=5.0),
        hardening=laws.HardeningPerLength(c_v=[0.1, 0.2]),
        elasticity=laws.DuncanChang(k_E=900.0),
    )
    assert jax.tree.structure(soil) == jax.tree.structure(anew)
    for found, expected in zip(
        jax.tree.leaves(soil), jax.tree.leaves(anew), strict=True
    ):
        np.testing.assert_array_equal(found, expected)
    # The part that all soils share is not changed.
    assert Soil().gamma_v == laws.Perzyna().gamma_v != 5.0


def test_a_part_that_checks_its_parameters_checks_those_given_by_name_too():
    with pytest.raises(InputError, match="corner_radius_ratio must be"):
        Block(shape=RectangularPrism(), corner_radius_ratio=0.0)


def test_results_are_pickled_copied_and_replaced():
    """They are made without their constructor."""
    result = simulate(Block(), Soil(), Impact(angle=0.3))
    again = ImpactResult(**{f.name: getattr(result, f.name) for f in fields(result)})
    for other in (again, pickle.loads(pickle.dumps(result)), copy.deepcopy(result)):
        assert jax.tree.structure(other) == jax.tree.structure(result)
        assert jax.tree.leaves(other) == jax.tree.leaves(result)
    assert replace(result, e_n=0.5).e_n == 0.5
    with pytest.raises(FrozenInstanceError):
        result.e_n = 0.5


# --- a scene from TOML; what is refused is in test_malformed_inputs.py


@pytest.fixture
def scene_of(tmp_path):
    """Writes text to scene.toml and reads it."""

    def read(content):
        path = tmp_path / "scene.toml"
        path.write_text(content)
        return read_scene(path)

    return read


def test_an_empty_file_is_the_default_scene(scene_of):
    scene, accuracy = scene_of("")
    default = Scene(Block(), Soil(), Impact())
    assert jax.tree.leaves(scene) == jax.tree.leaves(default)
    assert accuracy is None


def test_tables_and_flat_keys_say_the_same(scene_of):
    nested = scene_of(
        'accuracy = "fast"\n[block]\nmass_kg = 3\n[soil]\nunit_weight_kNm3 = 20\n'
        "[impact]\nangle_deg = -45.0\n"
    )
    flat = scene_of(
        'accuracy = "fast"\nmass_kg = 3\nunit_weight_kNm3 = 20\nangle_deg = -45.0\n'
    )
    assert jax.tree.leaves(nested) == jax.tree.leaves(flat)
    assert nested.accuracy == "fast"
    assert float(nested.scene.block.mass) == 3.0
    assert float(nested.scene.soil.unit_weight) == 20e3
    assert float(nested.scene.impact.angle) == pytest.approx(-math.pi / 4, rel=1e-15)


def test_a_scene_may_be_part_of_a_file():
    path = Path("study.toml")
    content = {"mass_kg": 3, "axes": {"angle_deg": [0, 1]}}
    scene, _ = scene_from(path, content, others=("axes",))
    assert float(scene.block.mass) == 3.0
    with pytest.raises(InputError, match="key axis: is unknown; did you mean axes"):
        scene_from(path, {"axis": {}}, others=("axes",))


@pytest.mark.parametrize(
    ("name", "part", "why"),
    [
        ("c_v", "block", "it is a quantity of the soil"),
        ("mass_kg", "soil", "it is a quantity of the block"),
        ("aspect_ratio", "soil", "it is a quantity of the block"),
        ("speed_mps", "soil", "it is a quantity of the impact"),
        ("nucleus_exponent", "soil", "it belongs to the flow PowerNucleus or"),
        ("nucleus_exponent", "block", "it is a quantity of the soil"),
        ("c_w", "soil", "did you mean c_v"),
    ],
)
def test_a_quantity_of_another_part_is_told(name, part, why):
    known = [other for other, column in INPUT_COLUMNS.items() if column.part == part]
    assert why_unknown(name, known).startswith(why)


@pytest.mark.parametrize("kind", [Soil, Block, Impact])
def test_signatures_name_every_parameter(kind):
    """For `help` and notebooks, and in the source for editors."""
    told = inspect.signature(kind).parameters
    whole = kind()
    for name in {**declared_of(kind), **parameters_of_parts(whole)}:
        assert told[name].default == float(getattr(whole, name))
    for slot in parts_of(kind):
        assert repr(told[slot].default) == f"{type(getattr(whole, slot)).__name__}()"
    tree = ast.parse(Path(inspect.getsourcefile(kind)).read_text(encoding="utf-8"))
    (stub,) = (
        node.args
        for of_kind in ast.walk(tree)
        if isinstance(of_kind, ast.ClassDef) and of_kind.name == kind.__name__
        for node in ast.walk(of_kind)
        if isinstance(node, ast.FunctionDef) and node.name == "__init__"
    )
    named = [a.arg for a in (*stub.args[1:], *stub.kwonlyargs, stub.kwarg) if a]
    assert named == [*told]


def parameters_of_parts(whole):
    parts = (getattr(whole, slot) for slot in parts_of(type(whole)))
    return {
        name: said for part in parts for name, said in declared_of(type(part)).items()
    }


class Leaning(laws.Coulomb):
    """A law with an angle."""

    tilt: Any = parameter(0.0, "deg", "[0, 45]", "tilt of the ground")


@pytest.mark.filterwarnings("always::jaximpact.errors.UnusualValueWarning")
@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Soil(friction_angle=30), "30 rad are 1719 deg, beyond 60 deg"),
        (lambda: Impact(angle=-45.0), r"write math.radians\(45\)"),
        (lambda: Impact(slope=[0.1, 30]), "Impact.slope is in radians"),
        (lambda: Impact(orientation=np.float64(45)), "beyond 360 deg"),
        (lambda: Soil(slider=Leaning(), tilt=30.0), r"write math.radians\(30\)"),
    ],
)
def test_degrees_in_place_of_radians_are_warned_of_where_they_are_given(make, said):
    with pytest.warns(UnusualValueWarning, match=said) as caught:
        make()
    assert [warned.filename for warned in caught] == [__file__]


@pytest.mark.filterwarnings("error::jaximpact.errors.UnusualValueWarning")
def test_radians_are_not_warned_of():
    """Nor angles that are traced: they cannot be looked at."""
    Soil(friction_angle=math.radians(59.0))
    Impact.from_degrees(angle=-90.0, orientation=360.0, slope=90.0)
    assert jax.grad(lambda angle: Impact(angle=angle).angle)(45.0) == 1.0


def test_version():
    assert jaximpact.__version__ == metadata.version("jaximpact")


def test_a_scene_in_a_tuple_is_whole():
    with pytest.raises(InputError, match="nothing beside it, but the tuple has 2"):
        simulate((Block(), Soil()), None, Impact(speed=5.0))
    with pytest.raises(InputError, match="the tuple has 0 entries"):
        simulate(())


def test_a_value_is_given_once():
    with pytest.raises(TypeError, match="Impact got two values of 'speed'"):
        Impact(1.0, speed=2.0)


@pytest.mark.parametrize("function", [simulate, simulate_batch])
def test_a_ledger_is_asked_for_by_a_truth_value(function):
    """Texts, true for Python, would make every impact fail."""
    for value in ("no", "arm", 2, 1.0, [True]):
        with pytest.raises(InputError, match=r"^ledger must be True or False, but is "):
            function(Scene(), ledger=value)
    for value in (True, 1, np.bool_(True)):
        assert function(Scene(), ledger=value).energy is not None
    for value in (False, 0):
        assert function(Scene(), ledger=value).energy is None
