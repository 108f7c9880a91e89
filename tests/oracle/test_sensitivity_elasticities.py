"""Elasticities: closed forms, differences, and what has none."""

import dataclasses
import importlib
import sys
import types

import jax
import numpy as np
import pytest

from jaximpact import (
    Block,
    Impact,
    Outcome,
    Scene,
    Soil,
    elasticities,
    read_netcdf,
    write_netcdf,
)
from jaximpact.batch import broadcast_scene
from jaximpact.errors import InputError
from jaximpact.quantities import INPUT_COLUMNS, RESULT_COLUMNS
from jaximpact.scene import GRAVITY
from jaximpact.scene_quantities import scene_with
from jaximpact.sensitivity import Check, State
from jaximpact.sensitivity.elasticities import differences
from jaximpact.sensitivity.figures import draw_heat_map, draw_tornado

VERTICAL = Scene(Block(mass=500.0))
OBLIQUE = Scene(
    Block(mass=500.0, aspect_ratio=2.0),
    impact=Impact(speed=15.0, angle=0.7, orientation=0.5),
)
OUTPUTS = ("e_n", "max_normal_force_N", "duration_s")


# --- exact facts


@pytest.mark.slow
def test_an_elastic_impact_has_the_elasticities_of_its_energy_integral():
    # Without flow the force is a function k_E f(u) of the depth u alone, and at the
    # deepest point k_E F(u) = m (v^2/2 + g u), F the integral of f. Differentiated:
    scene = dataclasses.replace(VERTICAL, soil=Soil(gamma_v=0.0))
    found = elasticities(
        scene, ("k_E", "speed_mps"), ("max_penetration_m", "max_normal_force_N", "e_n")
    )
    depth, force, e_n = found.output_value.values
    mass, speed = 500.0, float(scene.impact.speed)
    resistance = depth * (force - mass * GRAVITY)
    of_depth = found.elasticity.sel(output="max_penetration_m")
    kinetic = 0.5 * mass * speed**2
    expected = (
        -(kinetic + mass * GRAVITY * depth) / resistance,
        2.0 * kinetic / resistance,
    )
    # A block is set 1e-6 of its radius into the ground, 1e-6 to 1e-5 of the depth.
    np.testing.assert_allclose(of_depth, expected, rtol=1e-5)
    assert e_n == pytest.approx(1.0, abs=1e-7)
    # The error of derivatives at "balanced", 95 of 100 of which are within 9e-5.
    np.testing.assert_allclose(found.elasticity.sel(output="e_n"), 0.0, atol=9e-5)
    assert (found.check == Check.agrees).all()


def test_v_n_has_the_elasticities_of_e_n_and_one_more_by_the_speed():
    found = elasticities(VERTICAL, ("k_E", "speed_mps"), ("e_n", "v_n_mps"))
    of_e_n, of_v_n = (found.elasticity.sel(output=name) for name in found.output.values)
    # v_n = -e_n v: an identity of derivatives, to rounding.
    np.testing.assert_allclose(of_v_n - of_e_n, [0.0, 1.0], rtol=1e-12, atol=1e-12)


# --- against differences


@pytest.fixture(scope="module")
def random_scenes():
    random = np.random.default_rng(3)

    def uniform(lower, upper):
        return random.uniform(lower, upper, 60)

    return Scene(
        Block(mass=np.exp(uniform(4.0, 8.0)), aspect_ratio=uniform(1.0, 3.0)),
        Soil(c_v=uniform(0.3, 3.0), gamma_v=uniform(2.0, 50.0)),
        Impact(
            speed=uniform(5.0, 25.0),
            angle=uniform(0.1, 1.2),
            orientation=uniform(0.0, 3.0),
        ),
    )


@pytest.fixture(scope="module")
def of_random_scenes(random_scenes):
    return elasticities(random_scenes, ("k_E", "angle_deg"))


@pytest.mark.slow
def test_derivatives_agree_with_differences_on_random_scenes(of_random_scenes):
    check = of_random_scenes.check.values
    assert check.shape == (60, 2, len(RESULT_COLUMNS))
    # Measured: all but 2 in 1000 on wider ranges, the rest at a kink or at an end that
    # comes on hardly at all.
    assert (check == Check.agrees).mean() > 0.99
    assert (check != Check.unchecked).all()
    # Errors of reference: 3e-8 in the median.
    assert np.median(of_random_scenes.disagreement) < 1e-6


def test_a_wrong_derivative_is_called_so(monkeypatch):
    elasticity = importlib.import_module("jaximpact.sensitivity.elasticities")
    right = elasticity.derivatives

    def wrong(*arguments):
        numbers, slopes = right(*arguments)
        return numbers, jax.tree.map(lambda x: 1.02 * x, slopes)

    monkeypatch.setattr(elasticity, "derivatives", wrong)
    found = elasticities(VERTICAL, ("k_E",), OUTPUTS)
    assert found.check.values.tolist() == [
        [Check.differs, Check.agrees, Check.differs]
    ]  # the force changes by 0.003 % only: 2 % of that is nothing
    assert "?" in [t.get_text()[-1] for t in draw_heat_map(found).axes[0].texts]


class FakeModel:
    """Results that are a function of one parameter, in the unit of its column."""

    def __init__(self, monkeypatch, name, function):
        self.column, self.function = INPUT_COLUMNS[name], function
        # Not by its dotted name, which is that of the function.
        module = sys.modules[differences.__module__]
        monkeypatch.setattr(module, "simulate_batch", self.simulate_batch)

    def simulate_batch(self, scene, accuracy):
        owner = getattr(scene, self.column.part)
        values = np.asarray(getattr(owner, self.column.field)) / self.column.factor
        assert self.column.is_allowed(values).all()
        return types.SimpleNamespace(e_n=self.function(values))

    def slopes(self, at):
        scene, _ = broadcast_scene(scene_with(Scene(), {self.column.name: at}))
        outputs = (RESULT_COLUMNS["e_n"],)
        found = differences(scene, self.column, outputs, 1e-3, lambda count: None)
        return [values[:, 0] for values in found]


@pytest.mark.parametrize(
    ("name", "at"),
    [
        ("k_E", [500.0, 900.0]),
        ("relative_density", [1.0]),  # at the upper end of what is allowed
        ("c_v", [0.0, 1e-5]),  # at the lower end, and near it
        ("angle_deg", [0.0, -30.0]),
    ],
)
def test_differences_are_of_fourth_order_at_edges_too(monkeypatch, name, at):
    scale = INPUT_COLUMNS[name].default or 60.0
    fake = FakeModel(monkeypatch, name, lambda x: np.exp(x / scale))
    slope, roughness = fake.slopes(at)
    exact = np.exp(np.asarray(at) / scale) / scale
    # Steps of 1e-3 to the fourth, and rounding, 1e-16 over the step; at c_v = 1e-5
    # the step is 1e-8.
    accuracy = np.where(np.asarray(at) == 1e-5, 1e-7, 1e-11)
    assert (np.abs(slope / exact - 1.0) < accuracy).all()
    assert (roughness * scale < 1e-5).all()


@pytest.mark.parametrize("place", [0.0, 0.5, -1.5])
def test_kinks_and_jumps_among_the_points_are_rough(monkeypatch, place):
    at = 900.0
    kink = at * (1.0 + 1e-3 * place)
    fake = FakeModel(monkeypatch, "k_E", lambda x: 1e-3 * np.abs(x - kink))
    assert fake.slopes([at])[1] >= 1e-3  # half the change of slope, at least
    fake = FakeModel(monkeypatch, "k_E", lambda x: 1.0 * (x > kink))
    assert fake.slopes([at])[1] >= 1.0 / (1e-3 * at) * 0.999
    beyond = at * 1.01
    fake = FakeModel(monkeypatch, "k_E", lambda x: 1e-3 * np.abs(x - beyond))
    assert fake.slopes([at])[1] < 1e-9


# --- what has no elasticity


@pytest.fixture(scope="module")
def upright():
    """Of the vertical impact of a sphere, which neither slides nor turns."""
    return elasticities(VERTICAL, ("k_E", "angle_deg"))


def test_what_is_zero_or_has_no_value_has_no_elasticity_but_a_reason(upright):
    def state(parameter, output):
        return int(upright.state.sel(parameter=parameter, output=output))

    assert state("k_E", "e_n") == State.defined
    assert state("k_E", "omega_radps") == State.output_is_zero
    assert state("k_E", "e_t") == State.output_has_no_value
    assert state("angle_deg", "e_n") == State.parameter_is_zero
    defined = upright.state == State.defined
    assert (np.isfinite(upright.elasticity) == defined).all()
    has_value = upright.state != State.output_has_no_value
    assert (np.isfinite(upright.derivative) == has_value).all()
    assert (upright.check == Check.unchecked).equals(~has_value)


def test_the_derivative_at_a_zero_is_given_and_checked():
    # Rocking may harden the ground not at all, and no less: differences look to one
    # side.
    entry = elasticities(OBLIQUE, ("alpha_vR",), ("e_n",)).squeeze()
    assert entry.state == State.parameter_is_zero
    assert abs(entry.derivative) > 1e-4
    assert entry.check == Check.agrees


def test_a_kink_at_zero_is_not_taken_for_a_zero_derivative(upright):
    # e_n is even in the angle, and changes with its absolute value; v_t over the angle
    # tends to no limit.
    for output in ("e_n", "v_t_mps"):
        entry = upright.sel(parameter="angle_deg", output=output)
        assert entry.check == Check.undecided


def test_a_failed_impact_has_no_elasticity(monkeypatch):
    elasticity = importlib.import_module("jaximpact.sensitivity.elasticities")
    right = elasticity.derivatives

    def second_fails(*arguments):
        numbers, slopes = right(*arguments)
        for leaf in jax.tree.leaves((numbers, slopes)):
            leaf[1] = np.nan
        numbers.outcome_code[1] = Outcome.failed
        return numbers, slopes

    monkeypatch.setattr(elasticity, "derivatives", second_fails)
    scene = dataclasses.replace(VERTICAL, block=Block(mass=[100.0, 500.0]))
    found = elasticities(scene, ("k_E",), OUTPUTS)
    assert found.outcome.values.tolist() == ["detached", "failed"]
    assert (found.state[0] == State.defined).all()
    assert (found.state[1] == State.impact_failed).all()
    assert np.isnan(found.elasticity[1]).all()
    assert (found.check[1] == Check.unchecked).all()


# --- many impacts, names, files


def test_axes_and_arrays_of_scenes_give_what_each_scene_gives(tmp_path):
    told = []
    grid = elasticities(
        VERTICAL,
        ("k_E",),
        OUTPUTS,
        axes={"speed_mps": [5.0, 15.0], "mass_kg": [100.0, 500.0, 900.0]},
        progress=lambda done, total: told.append((done, total)),
    )
    assert grid.elasticity.dims == ("speed_mps", "mass_kg", "parameter", "output")
    assert grid.mass_kg.attrs["units"] == "kg"
    assert told[-1] == (36, 36)
    speed, mass = np.meshgrid([5.0, 15.0], [100.0, 500.0, 900.0], indexing="ij")
    scene = Scene(Block(mass=mass.ravel()), impact=Impact(speed=speed.ravel()))
    row = elasticities(scene, ("k_E",), OUTPUTS, check=False)
    assert row.elasticity.dims == ("scene", "parameter", "output")
    assert row.mass_kg.values.tolist() == mass.ravel().tolist()
    # A lane does not depend on its neighbours.
    assert (row.elasticity.values == grid.elasticity.values.reshape(6, 1, 3)).all()
    assert (row.check == Check.unchecked).all()
    one = elasticities(Scene(Block(mass=500.0), impact=Impact(speed=5.0)), ["k_E"])
    np.testing.assert_array_equal(
        one.elasticity.sel(output=list(OUTPUTS)), grid.elasticity[0, 1]
    )
    write_netcdf(tmp_path / "grid.nc", grid)
    assert read_netcdf(tmp_path / "grid.nc").elasticity.equals(grid.elasticity)

    with pytest.raises(ValueError, match="choose with"):
        grid.jaximpact.plot_tornado()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((("k_e",),), "parameter k_e is unknown; did you mean k_E?"),
        ((("k_E", "k_E"),), "parameter k_E stands twice"),
        (("k_E",), "must be a list of names, but is 'k_E'"),
        (((),), "at least one parameter"),
        ((("k_E",), ("e_nn",)), "output e_nn is unknown; did you mean e_n?"),
        ((("k_E",), ("steps",)), "output steps is unknown"),
    ],
)
def test_wrong_names_are_refused_with_the_nearest(arguments, words):
    with pytest.raises(InputError) as caught:
        elasticities(VERTICAL, *arguments)
    assert words in str(caught.value)


@pytest.mark.parametrize("name", ["parameter", "output_unit", "state", "derivative"])
def test_an_axis_has_a_name_of_its_own(name):
    axes = {name: {"name": ["dense", "loose"], "c_v": [1.0, 0.5]}}
    with pytest.raises(InputError, match=f"axis {name} needs another name"):
        elasticities(VERTICAL, ("k_E",), axes=axes)


# --- text and drawings


def test_a_tornado_has_the_strongest_on_top(of_random_scenes, tmp_path):
    of_one = of_random_scenes.isel(scene=0).sel(output=["e_n"])
    axes = of_one.jaximpact.plot_tornado(tmp_path / "tornado.png")
    assert (tmp_path / "tornado.png").exists()
    widths = np.abs([bar.get_width() for bar in axes.patches])
    heights = [bar.get_y() for bar in axes.patches]
    values = np.abs(of_one.elasticity.values.ravel())
    assert widths[np.argmax(heights)] == values.max()
    top = axes.get_yticklabels()[-1].get_text()
    assert top == of_one.parameter.values[np.argmax(values)]
    assert "elasticity" in axes.get_xlabel()


def test_numbers_of_a_tornado_are_in_its_panels():
    """Beside a parameter of a long name, bars of one sign, and one without a number."""
    scene = Scene(Block(aspect_ratio=2.0), Soil(), Impact(angle=0.3, orientation=0.4))
    parameters = ("gamma_v", "k_E", "angular_velocity_degps")
    outputs = ("e_n", "max_penetration_m", "max_normal_force_N")
    panels = elasticities(scene, parameters, outputs).jaximpact.plot_tornado()
    figure = panels[0].figure
    figure.canvas.draw()
    for axes in panels:
        for text in axes.texts:
            place = text.get_window_extent()
            assert axes.bbox.x0 < place.x0 < place.x1 < axes.bbox.x1
        assert axes.title.get_window_extent().x1 < figure.bbox.x1


def test_a_heat_map_has_a_number_or_a_reason_in_each_cell(upright):
    axes = draw_heat_map(upright).axes[0]
    texts = [text.get_text() for text in axes.texts]
    assert len(texts) == 2 * len(RESULT_COLUMNS)
    first = float(upright.elasticity.sel(parameter="k_E", output="e_n"))
    assert texts[:2] == [f"{first:.2g}", "x=0"]
    assert {"y=0", "none"} < set(texts)
    with pytest.raises(ValueError, match="must hold elasticity"):
        upright.drop_vars("elasticity").jaximpact.plot_tornado()


@pytest.mark.parametrize(
    "chosen", [("output",), ("parameter",), ("output", "parameter")]
)
def test_one_output_or_parameter_is_drawn(upright, chosen):
    one = upright.isel(dict.fromkeys(chosen, 0))
    whole = upright.isel({name: [0] for name in chosen})
    for draw in (draw_heat_map, draw_tornado):
        texts = [
            [text.get_text() for axes in draw(data).axes for text in axes.texts]
            for data in (one, whole)
        ]
        assert texts[0] == texts[1]
