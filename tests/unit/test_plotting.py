"""The plot of one impact: every kind of outcome gives a figure, and files are whole."""

import io
from itertools import pairwise
from types import SimpleNamespace

import equinox as eqx
import jax
import matplotlib
import numpy as np
import pytest
import xarray as xr
from calibration_studies import study_of_columns
from matplotlib import pyplot
from matplotlib.figure import Figure
from PIL import Image

from jaximpact import Block, Impact, Outcome, Scene, Soil, simulate
from jaximpact.calibration.diagnostics.identifiability import (
    LikelihoodProfile,
    _within,
)
from jaximpact.calibration.problem.bounds import Bounds
from jaximpact.calibration.report.drawings import (
    draw_left_out,
    draw_profile,
    draw_residuals,
    draw_study,
    only_varying,
)
from jaximpact.errors import InputError
from jaximpact.plotting.impact import outline, scene_in_words
from jaximpact.plotting.style import (
    COLOURS,
    DPI,
    WIDTH,
    legend_outside,
    plotted,
    png_bytes,
)
from jaximpact.plotting.style import panels as panels_of
from jaximpact.reports.tables import at_x
from jaximpact.runout.back_analysis.drawing import draw_channel
from jaximpact.runout.back_analysis.observed import ObservedValues
from jaximpact.runout.back_analysis.predictive import ChannelPrediction
from jaximpact.runout.study.drawing import CURVES, draw_collectors, draw_stops

SPINNING = Impact.from_degrees(orientation=17, angular_velocity=20_000)
"""Its block separates at once: the side view is of one outline, and narrow."""
PANELS = ["contact force", "penetration", "rotation", "energy", "side view, to scale"]


def recorded(*scene):
    return simulate(*scene, accuracy="fast", history=True)


@pytest.fixture(scope="module")
def result():
    block = Block(aspect_ratio=2.0)
    return recorded(block, Soil(), Impact(angle=0.7, orientation=0.3, slope=0.2))


def panels(drawn):
    return {axes.get_title(): axes for axes in drawn}


@pytest.fixture(autouse=True)
def closed():
    """Figures of pyplot's are closed: more than 20 are a warning."""
    yield
    pyplot.close("all")


@pytest.mark.slow
def test_without_a_history_one_is_recorded_under_the_laws_of_the_result():
    result = simulate(Block(), Soil(flow="AbsoluteOverstress"), accuracy="fast")
    axes = result.plot()
    (depth, *_) = panels(axes)["penetration"].get_lines()
    drawn = np.max(np.abs(depth.get_ydata()))
    # In cm; of the steps' ends, between two of which the largest lies.
    np.testing.assert_allclose(0.01 * drawn, result.max_penetration, rtol=5e-3)
    usual = simulate(Block(), accuracy="fast").max_penetration
    assert abs(usual / result.max_penetration - 1.0) > 0.1
    # Without tangential velocity there is no coefficient of it.
    assert "e_t" not in axes[0].figure.get_suptitle()


def test_the_title_of_a_scene_of_many_words_stays_within_the_figure():
    block = Block(mass=500.0, aspect_ratio=2.0, shape="RectangularPrism")
    impact = Impact.from_degrees(angle=40, angular_velocity=100, slope=30)
    figure = Figure()
    title = figure.suptitle(scene_in_words(Scene(block, impact=impact)), fontsize=10)
    figure.set_size_inches(WIDTH, 9.0)
    figure.canvas.draw()
    assert [line.split(",")[0] for line in title.get_text().split("\n")] == [
        "500 kg",
        "14 m/s at 40°",
    ]
    assert title.get_window_extent().x0 > 0.0
    assert title.get_window_extent().x1 < figure.bbox.width


@pytest.mark.slow
def test_shows_what_the_history_holds(result):
    axes = result.plot()
    for words in ("100 kg", f"{np.degrees(0.7):.3g}°", str(result.outcome)):
        assert words in axes[0].figure.get_suptitle()
    drawn = panels(axes)
    assert list(drawn) == PANELS
    history = result.history
    lines = {line.get_label(): line for line in drawn["contact force"].get_lines()}
    # Milliseconds and kilonewtons.
    time, force = lines["N, normal"].get_data()
    np.testing.assert_allclose(time, 1e3 * history.time)
    np.testing.assert_allclose(force, 1e-3 * history.normal_force)
    assert "kN" in drawn["contact force"].get_ylabel()
    peak = f"{1e-3 * float(result.max_normal_force):.3g}"
    assert peak in [text.get_text() for text in drawn["contact force"].texts]


def drawn_boxes(texts):
    return [text.get_window_extent() for text in texts if text.get_text()]


UP_SLOPE = Block(aspect_ratio=1.7, mass=1e5), Soil(), Impact(angle=-1.2, speed=60.0)
"""T and rotation are negative."""
PRISM = (
    Block(aspect_ratio=1.5, shape="RectangularPrism"),
    Soil(),
    Impact(angle=1.2, speed=12.0, orientation=0.7, angular_velocity=20.0, slope=1.5),
)
"""It has a title of three lines."""


@pytest.mark.parametrize(("scene", "unit"), [(UP_SLOPE, "MN"), (PRISM, "kN")])
def test_numbers_stand_within_their_panel_and_beside_the_legend(scene, unit):
    axes = panels(recorded(*scene).plot())
    assert axes["contact force"].get_ylabel() == f"force [{unit}]"
    axes["rotation"].figure.canvas.draw()
    for name in ("contact force", "penetration", "rotation"):
        frame = axes[name].get_window_extent()
        numbers = drawn_boxes(axes[name].texts)
        assert numbers, name
        for box in numbers:
            assert frame.y0 < box.y0 < box.y1 < frame.y1, name
            words = drawn_boxes(axes[name].get_legend().get_texts())
            assert not any(box.overlaps(of_word) for of_word in words), name


@pytest.mark.parametrize(
    ("aspect_ratio", "impact"), [(2.0, SPINNING), (4.0, Impact(speed=1e-3))]
)
def test_numbers_of_a_narrow_side_view_do_not_collide(aspect_ratio, impact):
    """Their places are those of the figure as it is drawn."""
    view = recorded(Block(aspect_ratio=aspect_ratio), Soil(), impact).plot()[-1]
    view.figure.canvas.draw()
    boxes = drawn_boxes(view.get_xticklabels())
    between = [right.x0 - left.x1 for left, right in pairwise(boxes)]
    assert len(between) >= 2
    assert min(between) > boxes[0].height / 2  # half a letter's height


@pytest.mark.parametrize("slope", [-0.6, 0.3, 1.5])
@pytest.mark.parametrize("angle", [0.5, -0.9])
def test_gravity_stands_beside_the_block(slope, angle):
    """Beside one upright, whose view is as high as there is room, and one that lies,
    whose view is as wide."""
    orientation = 0.5 * np.pi * (angle < 0.0)
    impact = Impact(slope=slope, angle=angle, orientation=orientation, speed=12.0)
    view = recorded(Block(aspect_ratio=3.0), Soil(), impact).plot()[-1]
    view.figure.canvas.draw()
    (gravity,) = view.texts
    frame, drawn = view.get_window_extent(), gravity.get_window_extent()  # arrow too
    rightmost = max(
        view.transData.transform(line.get_xydata())[:, 0].max()
        for line in view.get_lines()[1:]  # of which the first is the ground
    )
    assert rightmost < drawn.x0 < drawn.x1 < frame.x1
    assert frame.y0 < drawn.y0 < drawn.y1 < frame.y1


def test_energy_fills_what_is_available(result):
    axes = panels(result.plot())["energy"]
    top = axes.collections[-1].get_paths()[0].vertices[:, 1].max()
    available = next(x for x in axes.get_lines() if x.get_label() == "available")
    # The ledger closes to the tolerance of the integration, 1e-3 here.
    assert top == pytest.approx(np.max(available.get_ydata()), rel=1e-2)


def test_outline_touches_the_ground_at_impact_and_turns_clockwise(result):
    at_impact = outline(result.scene, 0.0, 0.0, 0.0)
    size = float(result.scene.block.semi_axes.major)
    # 2 degrees between points: the lowest is off by its square over 8.
    assert at_impact[:, 1].min() == pytest.approx(0.0, abs=2e-4 * size)
    turned = outline(result.scene, 0.0, 0.1, 0.0)
    # Clockwise, down-slope to the right: the lower tip moves to the left.
    assert turned[0, 0] < at_impact[0, 0]
    moved = outline(result.scene, 0.05, 0.0, 0.2)
    np.testing.assert_allclose(
        moved - at_impact, [[0.2, -0.05]] * len(moved), atol=1e-15
    )


@pytest.mark.slow
@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_saves_a_whole_file_and_nothing_else(result, tmp_path, suffix):
    path = tmp_path / f"impact.{suffix}"
    path.write_text("old")
    result.plot(path)
    assert path.stat().st_size > 10_000
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


ANOTHER_STYLE = {
    **{
        "text.usetex": True,
        "font.family": "No Such Font",
        "mathtext.fontset": "custom",
    },
    **{"savefig.format": "pdf", "savefig.dpi": 30, "savefig.bbox": "tight"},
    **{"axes.unicode_minus": False, "figure.autolayout": True, "text.color": "red"},
    **{"path.sketch": (1, 100, 2), "figure.facecolor": "black"},
}
"""Settings of a user's matplotlibrc. That LaTeX is there is not asked."""


def test_files_are_drawn_in_our_style_whatever_the_users_is(result, tmp_path):
    result.plot(tmp_path / "plain.png")
    with matplotlib.rc_context(ANOTHER_STYLE), np.errstate(all="raise"):
        result.plot(tmp_path / "styled.png")
        assert matplotlib.rcParams["text.usetex"]
    plain, styled = (tmp_path / f"{name}.png" for name in ("plain", "styled"))
    assert styled.read_bytes() == plain.read_bytes()


def test_a_rare_colour_stays_what_it_is():
    """Of 256 colours, with many lines of two others and their smooth edges."""
    figure, (axes,) = panels_of()
    rng = np.random.default_rng(0)
    for number in range(30):
        axes.plot(np.cumsum(rng.standard_normal(300)), color=COLOURS[number % 2])
    axes.plot([0, 20], [-40, -40], color=COLOURS[3])
    drawn = np.asarray(Image.open(io.BytesIO(png_bytes(figure))).convert("RGB"))
    wanted = np.array([int(COLOURS[3][k : k + 2], 16) for k in (1, 3, 5)])
    # A difference of 3 of 255 is not seen.
    assert np.any(np.all(np.abs(drawn.astype(int) - wanted) <= 3, axis=-1))


def test_unknown_format_leaves_no_file(result, tmp_path):
    with pytest.raises(ValueError, match="format"):
        result.plot(tmp_path / "impact.nonsense")
    assert not list(tmp_path.iterdir())


def test_separating_block_is_drawn_without_a_course():
    leaving = recorded(
        Block(aspect_ratio=2.0),
        Soil(),
        Impact(angle=1.4, orientation=0.8, angular_velocity=100.0),
    )
    assert leaving.outcome is Outcome.separating
    axes = leaving.plot()
    assert "separating" in axes[0].figure.get_suptitle()
    assert len(panels(axes)["side view, to scale"].get_lines()) == 4


@pytest.mark.slow
@pytest.mark.parametrize("rows", [0, 1, 40])
def test_failed_impact_is_drawn_as_far_as_it_came(result, rows, tmp_path):
    broken = jax.tree.map(np.array, result.history)
    for series in jax.tree.leaves(broken):
        series[rows:] = np.nan
    numbers = jax.tree.map(lambda x: x * np.nan, eqx.filter(result, eqx.is_array))
    failed = eqx.tree_at(
        lambda r: (r.scene, r.history, r.outcome_code),
        eqx.combine(numbers, result),
        (result.scene, broken, float(Outcome.failed)),
    )
    axes = failed.plot(tmp_path / "failed.png")
    assert "FAILED" in axes[0].figure.get_suptitle()


@pytest.mark.parametrize(
    ("collectors", "title"),
    [(24, ""), (100, "24 of 100 collectors; the tables have all")],
)
def test_no_two_collectors_look_the_same(collectors, title):
    shape = ("block", "collector")
    values = np.linspace(1.0, 9.0, 3 * collectors).reshape(3, collectors)
    columns = dict.fromkeys([name for name, _, _ in CURVES], (shape, values))
    x = 10.0 + np.arange(collectors)
    dataset = xr.Dataset(
        columns | {"ending": ("block", ["stopped"] * 3)}, {"collector": x}
    ).assign_attrs(title="many")
    figure = draw_collectors({"law": dataset})
    lines = figure.axes[0].lines
    looks = {(line.get_color(), line.get_linestyle()) for line in lines}
    assert len(looks) == len(lines) == 24
    labels = [line.get_label() for line in lines]
    assert [labels[0], labels[-1]] == [at_x(x[0]), at_x(x[-1])]
    (legend,) = figure.legends
    assert legend.get_title().get_text() == title
    rows = draw_collectors({"one": dataset, "other": dataset}).axes
    assert len(rows) == 24 * len(CURVES)
    assert rows[-len(CURVES)].get_ylabel().startswith(f"{at_x(x[-1])}:")


def test_many_scenes_are_refused(result):
    many = eqx.tree_at(lambda r: r.outcome_code, result, np.zeros(3))
    with pytest.raises(ValueError, match="one impact"):
        many.plot()


def test_axes_given_are_drawn_on_and_returned(result):
    figure, axes = pyplot.subplots(5, 1, figsize=(6.0, 12.0))
    assert result.plot(ax=axes) is axes
    assert [panel.get_title() for panel in axes] == PANELS
    assert pyplot.get_fignums() == [figure.number]
    with pytest.raises(InputError, match="one for each of 5 panels"):
        result.plot(ax=axes[:2])


def test_axes_of_a_subfigure_are_saved_with_the_whole_figure(result, tmp_path):
    left, right = pyplot.figure(figsize=(4.0, 6.0), dpi=50).subfigures(1, 2)
    right.subplots()
    result.plot(tmp_path / "impact.png", ax=left.subplots(5, 1))
    with Image.open(tmp_path / "impact.png") as image:
        assert image.size == (4.0 * DPI, 6.0 * DPI)


def test_figures_that_are_not_saved_are_pyplots(result, tmp_path):
    result.plot(tmp_path / "impact.png")
    assert not pyplot.get_fignums()
    axes = result.plot()
    assert [pyplot.figure(number) for number in pyplot.get_fignums()] == [
        axes[0].figure
    ]


def test_a_drawing_that_fails_leaves_no_figure():
    def fails(on):
        raise ValueError

    with pytest.raises(ValueError):  # noqa: PT011
        plotted(fails)
    assert not pyplot.get_fignums()


def is_within(artist, figure):
    box = artist.get_window_extent()
    return 0.0 < box.x0 < box.x1 < figure.bbox.width


def test_long_titles_and_labels_stay_within_the_figure():
    title = "The slope above the village, of which much is to be said: " * 3
    figure, (axes,) = panels_of(height=2.0, title=title)
    for number in range(3):
        axes.plot([number], label=f"variant {number} with the name of a law of ours")
    legend_outside(figure, ncols=3)
    figure.draw_without_rendering()
    assert " ".join(figure.get_suptitle().split()) == title.strip()
    assert is_within(figure.texts[0], figure)
    (legend,) = figure.legends
    assert is_within(legend, figure)
    assert len(legend.get_texts()) == 3
    assert axes.get_window_extent().height > 1.0 * figure.dpi


def test_tests_of_long_names_are_told_apart_at_an_axis():
    names = [f"{'drop of the block on the meadow' * 3} {number}" for number in "123"]
    study = study_of_columns(
        {"speed_mps": [5.0, 8.0, 9.0, 9.0], "e_n": [0.1] * 4, "name": [*names, "1"]}
    )
    predicted = np.zeros((4, 1))
    left = SimpleNamespace(quantile=2.0, standardised=lambda measured: predicted)
    figure = draw_left_out(SimpleNamespace(study=study), left)
    figure.draw_without_rendering()
    (axes,) = figure.axes
    shown = [label.get_text() for label in axes.get_xticklabels()]
    assert shown[:3] == [f"drop of th...e meadow {number}" for number in "123"]
    assert shown[3] == "1"
    for label in axes.get_xticklabels():
        assert is_within(label, figure)


SLOPE = {"prior": {"mean": 10.0, "sd": 1.0}}


@pytest.mark.parametrize(
    ("columns", "content", "along"),
    [
        ({}, {}, "speed_mps"),
        ({"mass_kg": [1.0, 2.0, 1.0, 2.0]}, {}, None),
        ({"shape": ["Ellipsoid", "RectangularPrism"] * 2}, {}, None),
        ({"shape": ["EllipticCylinder"] * 4}, {}, "speed_mps"),
        ({}, {"parameters": {"c_v": {"by": "campaign", "group_sd": 0.5}}}, None),
        ({}, {"nuisance": {"slope_deg": SLOPE | {"by": "row"}}}, None),
        ({}, {"nuisance": {"slope_deg": SLOPE | {"by": "source"}}}, "speed_mps"),
    ],
)
def test_a_fit_is_drawn_over_what_alone_differs(columns, content, along):
    """One line through tests of other shapes or groups would be a staircase."""
    tests = {
        "speed_mps": [5.0, 10.0, 5.0, 10.0],
        "max_sinking_m": [0.1, 0.2, 0.15, 0.3],
        "campaign": ["a", "a", "b", "b"],
        "source": ["one"] * 4,
    }
    study = study_of_columns(tests | columns, **content)
    assert only_varying(SimpleNamespace(study=study)) == along


def test_measurements_that_are_all_limits_have_one_entry_in_the_legend():
    tests = {"speed_mps": [5.0, 9.0], "mass_kg": [1.0, 2.0], "e_n": [">0.1", "<0.4"]}
    study = study_of_columns(tests)
    fitted = SimpleNamespace(predicted=np.array([[0.2], [0.3]]))
    figure = draw_study(SimpleNamespace(study=study, variants=[fitted]))
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["best fit, limit"]


def test_a_profile_crosses_its_levels_at_the_ends_of_its_intervals():
    """Also where few points are about a parameter that is not identifiable."""
    bounds = Bounds(np.array([0.05]), np.array([500.0]), np.array([True]))
    rise, limit = np.array([90.0, 8.4, 1.3, 0.4, 0.0]), 2.0**2
    values = np.array([0.5, 5.0, 30.0, 120.0, 500.0])
    ends = [*_within(np.log(values), rise, 1.0), *_within(np.log(values), rise, limit)]
    low, _, low_95, _ = (end and np.exp(end) for end in ends)
    profile = LikelihoodProfile(
        *("gamma_v", values, rise, low, None, low_95, None),
        best_cost=0.0,
        lowest_cost=0.0,
        lowest_x=np.log(values[-1:]),
    )
    variant = SimpleNamespace(
        names=("gamma_v",),
        bounds=bounds,
        uncertainty=SimpleNamespace(quantile=np.array([2.0])),
        verdicts=[SimpleNamespace(determined=False)],
        objective=SimpleNamespace(scene=Scene()),
    )
    (axes,) = draw_profile(variant, profile).axes
    curve = axes.get_lines()[0].get_xydata()
    for end, level in ((low, 1.0), (low_95, limit)):
        # Between the 300 points of the curve it is a line.
        at_end = np.interp(np.log(end), np.log(curve[:, 0]), curve[:, 1])
        assert at_end == pytest.approx(level, rel=1e-3)


def test_residuals_of_a_target_that_is_predicted_to_be_zero_are_drawn():
    """As forces are at times after every contact; NumPy has nothing to warn of."""
    result = SimpleNamespace(study=SimpleNamespace(targets=("e_n", "normal_force_N")))
    variant = SimpleNamespace(predicted=np.array([[0.2, 0.0], [0.4, 0.0]]))
    residuals = SimpleNamespace(values=np.array([[1.0, -1.0], [np.nan, -2.0]]))
    (axes,) = draw_residuals(result, variant, residuals, "prediction").axes
    drawn = {line.get_label(): list(line.get_xdata()) for line in axes.lines}
    assert drawn["e_n"] == [1.0, 2.0]
    assert drawn["normal_force_N"] == [0.0, 0.0]


@pytest.mark.parametrize("blocks", [1, 3])
def test_what_was_observed_of_one_block_is_drawn_too(blocks):
    """A line of a single point would not be seen."""
    values = 60.0 + np.arange(blocks)
    predicted = np.sort(np.random.default_rng(0).uniform(55, 65, (20, blocks)), axis=1)
    channel = ObservedValues("x_m", None, values)
    (axes,) = draw_channel(ChannelPrediction(channel, predicted)).axes
    (observed,) = (one for one in axes.lines if one.get_label() == "observed")
    shares = observed.get_ydata()
    assert (shares[0], shares[-1]) == (0.0, 1.0)
    np.testing.assert_array_equal(np.unique(observed.get_xdata()), values)
    assert np.sum(np.diff(shares) > 0.0) == blocks


@pytest.mark.parametrize("start", [181.31, 2_600_181.31])
def test_places_of_stops_are_whole_numbers(start):
    """Where they are within centimetres too, and on a national grid."""
    x = start + np.linspace(0.0, 0.04, 20)
    columns = {"x_m": ("block", x), "ending": ("block", ["stopped"] * 20)}
    (axes,) = draw_stops(xr.Dataset(columns, attrs={"title": "slope"})).axes
    axes.figure.draw_without_rendering()
    assert axes.xaxis.get_offset_text().get_text() == ""
    labels = axes.get_xticklabels()
    assert all(label.get_text().startswith(f"{int(start)}.3") for label in labels)
    for left, right in pairwise(drawn_boxes(labels)):
        assert left.x1 < right.x0
