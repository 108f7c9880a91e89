"""The model beside laws of others: how a comparison is made, and what each comes to."""

import numpy as np
import pytest
from validation_page import assert_page_shows

from jaximpact import Block, Impact, Outcome, Soil, simulate
from jaximpact.paper import Verdict
from jaximpact.paper.comparisons import STUDIES, compare_with_laws
from jaximpact.paper.comparisons.comparison import (
    TRIED,
    VALUES,
    Comparison,
    as_findings,
    changes_of,
    log_slope,
    relative_deviation,
    strike,
    variants_of,
    verdict_of,
)
from jaximpact.paper.comparisons.published_laws import (
    KatsuragiDurian,
    gerber_penetration_m,
    labiouse_max_force_kN,
)
from jaximpact.paper.comparisons.restitution_angle import average_restitution
from jaximpact.paper.comparisons.vertical_drops import (
    beads,
    implied_modulus_kPa,
    steel_sphere,
)
from jaximpact.quantities import columns_of_part

pytestmark = pytest.mark.slow

FAST = 1e-3
"""`fast` against `reference`, relative: 4e-5 in e_n, some 1e-4 in depth and force."""


@pytest.fixture(scope="module")
def rows():
    told = []
    found = compare_with_laws(lambda *counts: told.append(counts))
    assert told == [(done, len(STUDIES)) for done in range(1, len(STUDIES) + 1)]
    return {row.name: row for row in found}


def test_deviation_is_the_length_of_the_difference_over_that_of_the_law():
    assert relative_deviation([1.1], [1.0]) == pytest.approx(0.1)
    assert relative_deviation([0.0, -1.0], [3.0, 4.0]) == pytest.approx(34**0.5 / 5)


@pytest.mark.parametrize(
    ("deviation", "verdict"),
    [
        (0.0, Verdict.holds),
        (0.0999, Verdict.holds),
        (0.1001, Verdict.partly),
        (0.2999, Verdict.partly),
        (0.3001, Verdict.fails),
        (np.nan, Verdict.not_computed),
    ],
)
def test_verdicts_have_limits(deviation, verdict):
    assert verdict_of(deviation) is verdict


def test_a_failed_impact_leaves_the_verdict_open():
    row = Comparison(
        *("name", "e_n [-]", ("a", "b"), (1.0, 2.0), (1.0, np.nan)),
        *("over", "source", "note", (), "figure", lambda: None),
    )
    assert row.verdict is Verdict.not_computed


def test_log_slope_of_powers():
    x = np.geomspace(2.0, 50.0, 9)
    slopes = log_slope(x, [3.0 * x**1.2, x**-0.4, np.where(x > 9.0, x, -x)])
    np.testing.assert_allclose(slopes[:2], [1.2, -0.4], rtol=1e-13)
    assert np.isnan(slopes[2])


def test_variants_differ_from_the_soil_in_one_parameter_at_most():
    soil = Soil(friction_angle=0.4, c_v=0.7)
    variants = variants_of(soil)
    columns = columns_of_part("soil", soil)
    fields = [column.field for column in columns.values()]
    table = np.stack([getattr(variants, field) for field in fields])
    alone = np.array([float(getattr(soil, field)) for field in fields])
    differ = np.sum(table != alone[:, None], axis=0)
    assert differ[0] == 0
    assert differ.max() == 1
    for name, values in TRIED.items():
        assert len(values) == VALUES
        assert np.all(columns[name].is_allowed(values))


def test_every_soil_is_struck_by_every_impact():
    soils = Soil(gamma_v=[8.7, 0.85], dilatancy=[0.0, 1.0])
    speeds, numbers = np.array([5.0, 10.0, 20.0]), np.array([300.0, 900.0, 3000.0])
    found = strike(
        soils, Block(mass=20.0), Impact(speed=speeds, angle=0.5), k_E=numbers
    )
    assert found.e_n.shape == (2, 3)
    alone = simulate(
        Block(mass=20.0),
        Soil(gamma_v=0.85, dilatancy=1.0, k_E=900.0),
        Impact(speed=10.0, angle=0.5),
        accuracy="reference",
    )
    assert found.e_n[1, 1] == pytest.approx(float(alone.e_n), rel=FAST)
    assert found.max_normal_force[1, 1] == pytest.approx(
        float(alone.max_normal_force), rel=FAST
    )


def test_changes_name_what_helps_and_pass_over_failures():
    soil, law = Soil(), np.array([1.0, 1.0])
    model = np.full((1 + len(TRIED) * VALUES, 2), 0.5)
    places = {name: 1 + place * VALUES for place, name in enumerate(TRIED)}
    model[places["c_v"] + 3] = 0.9
    model[places["psi"] + VALUES - 1] = 0.8
    model[places["psi"] + 2] = np.nan
    model[places["k_E"] + 5] = 0.505  # half of what matters
    model[places["beta"]] = 0.2  # farther
    first, second = changes_of(soil, model, law)
    assert (first.parameter, first.at_the_edge) == ("c_v", False)
    assert first.nearest == TRIED["c_v"][3]
    assert first.present == 1.0
    assert first.model == (0.9, 0.9)
    assert first.deviation == pytest.approx(0.1)
    assert (second.parameter, second.at_the_edge) == ("psi", True)


def test_the_mean_over_orientations_counts_every_one():
    angles = (40.0, 70.0)
    average = average_restitution(Soil(), 2.0, angles)
    assert sum(average.outcomes.values()) == 36 * len(angles)
    assert str(Outcome.failed) not in average.outcomes
    block, turns = (
        Block(mass=500.0, aspect_ratio=2.0),
        (np.arange(36) + 0.5) * np.pi / 36,
    )
    alone = [
        float(
            simulate(
                block,
                Soil(),
                Impact(speed=15.0, angle=np.radians(50.0), orientation=turn),
            ).e_n
        )
        for turn in turns
    ]
    # The error of `fast` in e_n
    assert average.mean[0, 0] == pytest.approx(np.mean(alone), abs=1e-4)
    assert average.spread[0, 0] == pytest.approx(np.std(alone), abs=1e-4)


def test_rows_are_whole(rows):
    assert len(rows) == 15
    for row in rows.values():
        assert len(row.law) == len(row.model) == len(row.places)
        assert row.verdict is not Verdict.not_computed
        assert row.over
        assert row.source
        assert row.note
        deviations = [change.deviation for change in row.changes]
        assert deviations == sorted(deviations)
        assert all(deviation < row.deviation for deviation in deviations)


@pytest.mark.parametrize(
    ("name", "law", "model", "verdict"),
    [
        # As measured, to the digits written; the laws as printed
        ("largest force against speed", 1.2, 1.23, Verdict.holds),
        ("penetration against speed", 0.8, 0.57, Verdict.partly),
        ("largest force against mass", 2 / 3, 0.82, Verdict.partly),
        ("penetration against mass", 1 / 3, 0.21, Verdict.fails),
        ("largest force against k_E for M_E", 0.4, 0.00, Verdict.fails),
        ("penetration against k_E for M_E", -0.4, -0.02, Verdict.fails),
        ("largest force against c_v for M_E", 0.4, 0.29, Verdict.partly),
        ("penetration against c_v for M_E", -0.4, -0.26, Verdict.fails),
    ],
)
def test_exponents(rows, name, law, model, verdict):
    row = rows[name]
    assert row.law[0] == pytest.approx(law, rel=1e-12)
    assert row.model[0] == pytest.approx(model, abs=0.006)
    assert row.verdict is verdict


def test_stopping_depths_are_those_of_single_impacts(rows):
    sphere = steel_sphere()
    assert 2.0 * float(sphere.semi_axes.minor) == pytest.approx(0.0254, rel=1e-12)
    for name, soil in (("Table 1 as it is", Soil()), ("beads", beads())):
        row = rows[f"stopping depth, {name}"]
        np.testing.assert_allclose(row.law, [3.36, 5.02, 6.37, 7.50], atol=0.005)
        impact = Impact(speed=3.0)
        alone = simulate(sphere, soil, impact, accuracy="reference")
        expected = 100.0 * float(alone.max_penetration)
        assert row.model[2] == pytest.approx(expected, rel=FAST)
        assert row.verdict is Verdict.fails
    row = rows["stopping depth against speed, beads"]
    depths = KatsuragiDurian().stopping_depth(np.array([1.0, 4.0]))
    # The slope of a curve that is nearly straight is near its chord's.
    assert row.law[0] == pytest.approx(
        float(np.log(depths[1] / depths[0]) / np.log(4)), abs=0.01
    )


def test_restitution_of_the_sphere_is_that_of_single_impacts(rows):
    row = rows["e_n against angle, sphere"]
    alone = simulate(
        Block(mass=500.0),
        Soil(),
        Impact(speed=15.0, angle=np.radians(60.0)),
        accuracy="reference",
    )
    place = row.places.index("30 deg")
    assert row.model[place] == pytest.approx(float(alone.e_n), abs=1e-4)
    assert row.law[place] == pytest.approx(19.5 * 30.0**-1.03)


def test_the_moduli_that_the_laws_imply():
    """With its modulus each law gives what the model gives."""
    moduli = implied_modulus_kPa()
    block = Block(mass=500.0)
    alone = simulate(block, Soil(), Impact(speed=15.0), accuracy="reference")
    force = labiouse_max_force_kN(
        moduli["largest force"],
        block.semi_axes.minor,
        500.0 * 9.81 / 1e3,
        15.0**2 / (2 * 9.81),
    )
    assert 1e3 * float(force) == pytest.approx(float(alone.max_normal_force), rel=FAST)
    depth = gerber_penetration_m(500.0, moduli["penetration"], 15.0)
    assert float(depth) == pytest.approx(float(alone.max_penetration), rel=FAST)


def test_figures_have_axes_with_units_and_finite_lines(rows, tmp_path):
    drawn = {row.figure_name: row.draw for row in rows.values()}
    assert len(drawn) == 3
    for name, draw in drawn.items():
        figure = draw()
        for axes in figure.axes:
            assert "[" in axes.get_xlabel()
            for line in axes.get_lines():
                assert np.all(np.isfinite(np.asarray(line.get_xydata(), float)))
        path = tmp_path / f"{name}.png"
        figure.savefig(path)
        assert path.stat().st_size > 10_000


def test_the_page_shows_the_comparisons(rows):
    assert_page_shows(as_findings(list(rows.values())), "L")
