"""Validation: how claims are judged, on sets made up so that they hold, hold partly and
fail; the readings; the command; and the page that shows its result."""

import json
import math
import re

import numpy as np
import pytest
import xarray as xr
from error_messages import assert_one_line_error
from made_up_sets import A_R, ANGLE, LONG, ideal
from other_laws import other_laws
from text_files import rows_of
from validation_page import assert_page_shows, page

from jaximpact import (
    Block,
    ConstantCoefficients,
    Impact,
    Soil,
    parametric_set,
    simulate,
)
from jaximpact.cli import main as run_command
from jaximpact.parametric_sets import GROUNDS
from jaximpact.runout import ClosedForm, Ending
from jaximpact.scene_quantities import SLOTS
from paper import claim_data as study
from paper import validation as run
from paper.__main__ import make_parser
from paper.claim_data import RANDOM_SETS, SLOPE, Study
from paper.claims import JUDGES, read_claims
from paper.criteria import (
    FALLS,
    RISES,
    Finding,
    Judgement,
    NotComputed,
    Part,
    Verdict,
    combine,
    ranges,
    trend,
)
from paper.readings import (
    AS_IT_IS,
    READINGS,
    SLOPE_READINGS,
    ContactPoint,
    Reading,
    with_contact_at,
)
from paper.report import moves

pytestmark = pytest.mark.slow

SETS = ideal()


def main(argv):
    return run_command(argv, make_parser)


def test_a_trend_asks_for_every_step_and_for_the_ends():
    assert trend([1.0, 2.0, 3.0], RISES) == Part(Verdict.holds, 2, 2)
    assert trend([1.0, 3.0, 2.0], RISES) == Part(Verdict.partly, 1, 2)
    assert trend([2.0, 3.0, 1.0], RISES) == Part(Verdict.fails, 1, 2)
    assert trend([3.0, 2.0, 1.0], RISES) == Part(Verdict.fails, 0, 2)
    assert trend([3.0, 2.0, 1.0], FALLS) == Part(Verdict.holds, 2, 2)


def test_a_step_within_a_thousandth_of_the_largest_is_none():
    assert trend([10.0, 10.009], RISES).verdict is Verdict.fails
    assert trend([10.0, 10.011], RISES).verdict is Verdict.holds
    assert trend([0.0, 0.009, -10.0], RISES) == Part(Verdict.fails, 0, 2)


def test_parts_hold_together_fail_together_or_hold_partly():
    holds, partly, fails = Verdict.holds, Verdict.partly, Verdict.fails
    assert combine([holds, holds]) is holds
    assert combine([fails, fails]) is fails
    for mixed in ([holds, fails], [partly, partly], [holds, partly], [fails, partly]):
        assert combine(mixed) is partly


def test_ranges_join_neighbours():
    assert ranges([10.0, 20.0, 30.0, 40.0], [True, True, False, True]) == "10 to 20, 40"


def test_every_claim_has_a_function_or_says_what_it_needs():
    claims = read_claims()
    assert list(claims) == [f"C{number:02d}" for number in range(1, 39)]
    for name, claim in claims.items():
        assert all(claim)
        assert (name in JUDGES) != claim.criterion.startswith("not computed: ")
    assert set(JUDGES) <= set(claims)


@pytest.mark.parametrize("name", JUDGES)
def test_claims_hold_on_sets_made_to_their_words(name):
    judgement = JUDGES[name](SETS)
    assert judgement.verdict is Verdict.holds
    assert judgement.held == judgement.asked > 0
    assert judgement.evidence
    assert all(math.isfinite(number) for number in judgement.numbers.values())


def turned(name, variable, dimension="aspect_ratio", sets=SETS, **where):
    """Sets with a variable, at some places, in the opposite order along a dimension;
    without `where`, all of it."""
    values = sets[name][variable]
    opposite = values.copy(data=values.isel({dimension: slice(None, None, -1)}).values)
    chosen = xr.ones_like(values, bool)
    for key, at in where.items():
        chosen = chosen & values[key].isin(at)
    return sets.changed(name, **{variable: xr.where(chosen, opposite, values)})


def swapped(name, variable, first=2, second=3):
    """A set with two neighbours of a line exchanged."""
    values = SETS[name][variable].copy()
    values[[first, second]] = values[[second, first]].values
    return SETS.changed(name, **{variable: values})


def scaled(name, variable, factor):
    return SETS.changed(name, **{variable: factor * SETS[name][variable]})


def lopsided(variable, where=True, sign=1.0):
    """Set IV with a variable that differs beyond 90°."""
    values = SETS["IV"][variable]
    other = values + sign * 0.01 * abs(values).max() * (values.orientation_deg > 90.0)
    return SETS.changed("IV", **{variable: xr.where(where, other, values)})


def outcomes(*names):
    return SETS.changed(
        "I",
        outcome=("aspect_ratio", np.array(names)),
        e_n=0.02 + 0.01 * A_R,
    )


def on_grounds(sets):
    return SETS.with_other(GROUNDS[1], sets).with_other(GROUNDS[2], sets)


def energetic(name, value):
    data = SETS[name]
    e_bar = data.e_bar.copy()
    e_bar[{dimension: 0 for dimension in e_bar.dims}] = value
    return SETS.changed(name, e_bar=e_bar)


def courses(**variables):
    return SETS.changed("courses", **variables)


def slope(**variables):
    return SETS.changed(SLOPE, **variables)


DOWN = SETS[SLOPE]
THREE_VALUES = np.where(np.arange(DOWN.sizes["impact"]) % 2, -0.9, 1.1)
UPRIGHT, INCLINED, TURNED = SETS["I"], SETS["III"], SETS["IV"]
COURSES, SPINS = SETS["courses"], SETS["fig13"]
SLOW = LONG & (A_R < 2.5)
ALL = ["detached"] * 7
BACK = slice(None, None, -1)
PARTLY = {
    "C01": swapped("I", "max_penetration_m"),
    "C02": swapped("I", "max_normal_force_N"),
    "C03": turned("I", "time_of_max_normal_force_s"),
    "C04": outcomes("arrested", "detached", "arrested", *ALL[3:]),
    "C05": swapped("II", "max_penetration_m"),
    "C06": swapped("II", "max_normal_force_N"),
    "C07": SETS.changed(
        "I", max_penetration_m=xr.where(SLOW, 0.1, UPRIGHT.max_penetration_m)
    ),
    "C08": SETS.changed(
        "I", max_penetration_m=xr.where(SLOW, 0.4, UPRIGHT.max_penetration_m)
    ),
    "C09": scaled("I", "duration_s", 1.6),
    "C10": SETS.changed(
        "I", max_normal_force_N=xr.where(SLOW, 1e4, UPRIGHT.max_normal_force_N)
    ),
    "C11": courses(rotation_rad=xr.where(SLOW, -1.0, 1.0) * COURSES.rotation_rad),
    "C12": courses(R_r=xr.where(A_R == 4.0, COURSES.R_r[{"step": BACK}], COURSES.R_r)),
    "C13": turned("III", "max_penetration_m", aspect_ratio=[2.0]),
    "C14": turned("III", "max_normal_force_N", "angle_deg"),
    "C15": turned("III", "rotation_rad"),
    "C16": turned("courses", "R_r"),
    "C17": turned("II", "e_n"),
    "C18": lopsided("e_n", A_R == 3.0),
    "C19": lopsided("max_penetration_m", A_R == 3.0),
    "C20": SETS.changed(
        "IV",
        rotation_rad=TURNED.rotation_rad
        * xr.where(TURNED.orientation_deg.isin([10.0, 170.0]), A_R**2, 1.0),
    ),
    "C21": lopsided("max_normal_force_N", A_R == 3.0),
    "C22": lopsided("max_moment_Nm", A_R == 3.0),
    "C23": turned("III", "e_n", angle_deg=[20.0]),
    "C24": turned("III", "e_t", angle_deg=[20.0]),
    "C25": SETS.changed("III", e_n=xr.where(A_R == 2.0, 0.3, INCLINED.e_n)),
    "C26": SETS.changed("III", e_n=xr.where(A_R == 2.0, 0.3, INCLINED.e_n)),
    "C27": turned("III", "e_t"),
    "C28": SETS.changed("III", e_n=xr.where(A_R == 2.0, 0.3, INCLINED.e_n)),
    "C29": energetic(RANDOM_SETS[0], 1.1),
    "C30": SETS.changed("fig13", e_contact=SPINS.e_contact - 0.15),
    "C31": turned("fig13", "e_n", "angular_velocity_degps"),
    "C32": SETS.changed(
        "fig13", e_n=SPINS.e_n + 0.01 * (SPINS.orientation_deg == 90.0)
    ),
    "C33": turned("II", "max_normal_force_N"),
    "C34": slope(paths_apart_m=2.0 * DOWN.paths_apart_m + 2.0),
    "C35": slope(bounces=0.0 * DOWN.bounces + 3.0),
    "C36": SETS.with_other(GROUNDS[1], slope(jump_height_m=DOWN.jump_height_m**0.3)),
    "C37": slope(e_n=DOWN.e_n - 1.0),
    "C38": SETS.with_other(GROUNDS[1], turned("I", "max_penetration_m")),
}
FAILS = {
    "C01": turned("I", "max_penetration_m"),
    "C02": turned("I", "max_normal_force_N"),
    "C03": turned(
        "I",
        "time_of_max_normal_force_s",
        sets=turned("I", "time_of_max_penetration_s"),
    ),
    "C04": outcomes(*ALL),
    "C05": turned("II", "max_penetration_m"),
    "C06": turned("II", "max_normal_force_N"),
    "C07": scaled("I", "max_penetration_m", 0.5),
    "C08": scaled("I", "max_penetration_m", 3.0),
    "C09": scaled("I", "duration_s", 2.5),
    "C10": scaled("I", "max_normal_force_N", 0.9),
    "C11": courses(rotation_rad=-COURSES.rotation_rad),
    # Up, down and up again by a third, without end; the sphere at its maximum
    "C12": courses(
        R_r=xr.DataArray([0.0, 2.0, 1.0, 3.0, 1.0], dims="step")
        * xr.ones_like(COURSES.R_r.isel(step=0, drop=True))
        + xr.DataArray([0.0, 0.0, 0.0, 0.0, 2.0], dims="step") * (A_R == 1.0)
    ),
    "C13": SETS.changed(
        "III", max_penetration_m=0.0 * INCLINED.e_n + ANGLE * (5.0 - A_R)
    ),
    "C14": SETS.changed("III", max_normal_force_N=0.0 * INCLINED.e_n + ANGLE * A_R),
    # Rises with angle and A_r, the sphere above all
    "C15": SETS.changed(
        "III", rotation_rad=0.0 * INCLINED.e_n + ANGLE * (A_R + 9.0 * (A_R == 1.0))
    ),
    "C16": courses(R_r=0.0 * COURSES.R_r + COURSES.angle_deg * (5.0 - A_R)),
    "C17": turned("I", "e_n").changed("II", e_n=5.0 + 0.1 * A_R),
    "C18": SETS.changed(
        "IV", e_n=0.0 * TURNED.e_n + TURNED.orientation_deg * (5.0 - A_R)
    ),
    "C19": lopsided("max_penetration_m"),
    "C20": SETS.changed("IV", rotation_rad=0.0 * TURNED.e_n + 0.1 * (5.0 - A_R)),
    "C21": lopsided("max_normal_force_N"),
    "C22": SETS.changed("IV", max_moment_Nm=0.0 * TURNED.e_n + TURNED.orientation_deg),
    "C23": turned("III", "e_n"),
    "C24": turned("III", "e_t"),
    "C25": SETS.changed("III", e_n=0.0 * INCLINED.e_n + ANGLE),
    "C26": SETS.changed("III", e_n=0.0 * INCLINED.e_n + 0.001 * ANGLE),
    "C27": turned("III", "e_n", sets=turned("III", "e_t")),
    "C28": SETS.changed("III", e_n=0.0 * INCLINED.e_n + ANGLE),
    "C29": energetic("III", 1.1),
    "C30": SETS.changed(
        "fig13",
        e_n=SPINS.e_n + 1.0,
        e_contact=SPINS.e_contact - 1.0,
        e_bar=SPINS.e_bar - 1.0,
    ),
    "C31": SETS.changed(
        "fig13",
        **{
            name: SPINS[name] * 0.0
            + SPINS.orientation_deg * (3e3 - SPINS.angular_velocity_degps)
            for name in ("e_n", "e_contact", "e_bar", "e_n_vijayakumar")
        },
    ),
    "C32": SETS.changed("fig13", e_n=SPINS.e_n + 0.01),
    "C33": turned(
        "I",
        "max_normal_force_N",
        sets=turned(
            "II",
            "max_normal_force_N",
            sets=turned("III", "max_normal_force_N"),
        ),
    ),
    "C34": slope(
        paths_apart_m=DOWN.paths_apart_m + 3.0,
        off_the_parabola_m=DOWN.off_the_parabola_m + 1e-3,
    ),
    # The sphere's bounces too high, the others' too many
    "C35": slope(bounces=0.0 * DOWN.bounces + 3.0, highest_bounce_m=5.0 + DOWN.bounces),
    "C36": slope(jump_height_m=DOWN.jump_height_m**0.3),
    "C37": slope(**{name: ("impact", THREE_VALUES) for name in ("e_n", "e_t")}),
}


def test_every_claim_is_tried_both_ways():
    # C38 fails only if no claim at all has the same verdict on another ground.
    assert set(PARTLY) == set(JUDGES) == {*FAILS, "C38"}


@pytest.mark.parametrize("name", PARTLY)
def test_claims_hold_partly_where_a_part_of_them_does(name):
    judgement = JUDGES[name](PARTLY[name])
    assert judgement.verdict is Verdict.partly
    assert judgement.held < judgement.asked


@pytest.mark.parametrize("name", FAILS)
def test_claims_fail_where_nothing_of_them_holds(name):
    judgement = JUDGES[name](FAILS[name])
    assert judgement.verdict is Verdict.fails
    assert judgement.held < judgement.asked


def test_what_differs_on_another_ground_is_named():
    judgement = JUDGES["C38"](PARTLY["C38"])
    assert "C01 fails" in judgement.evidence
    assert judgement.evidence.endswith("others: none")
    # C01, and C07 and C08, which look at the same depths
    assert judgement.numbers["different_with_c_v_0.5_gamma_v_1.70"] == 3
    assert judgement.numbers["different_with_c_v_0.5_gamma_v_0.85"] == 0


def test_what_gravity_gives_is_told_from_what_the_ground_gives():
    name = RANDOM_SETS[0]
    share = SETS[name].gravity_share
    given = energetic(name, 1.1).changed(name, gravity_share=share + 0.3)
    judgement = JUDGES["C29"](given)
    assert judgement.verdict is Verdict.partly
    assert judgement.numbers["above_1_without_gravity"] == 0
    judgement = JUDGES["C29"](energetic(name, 1.1))
    assert judgement.numbers["above_1_without_gravity"] == 1


def test_failed_random_impacts_are_counted_and_separating_ones_left_out():
    name = RANDOM_SETS[1]
    data = SETS[name].copy(deep=True)
    data["e_bar"][0] = np.nan
    data["outcome"][1] = "separating"
    data["e_bar"][1] = 2.0
    judgement = JUDGES["C29"](type(SETS)(SETS | {name: data}))
    assert judgement.verdict is Verdict.holds
    assert judgement.numbers["failed"] == 1
    assert "1 random impacts failed" in judgement.evidence


def test_readings_differ_from_the_model_and_from_each_other():
    every = (*READINGS, *SLOPE_READINGS)
    names = [reading.name for reading in every]
    assert len({*names, AS_IT_IS.name}) == len(every) + 1
    assert len({str(reading) for reading in every}) == len(every)
    for reading in every:
        elsewhere = reading.contact is not ContactPoint.foundation
        down = _differences(reading.slope, AS_IT_IS.slope)
        assert bool(reading.values) + elsewhere + len(down) == 1
        assert bool(down) == (reading in SLOPE_READINGS)
        if "case" in down:
            assert len(_differences(reading.slope.case, AS_IT_IS.slope.case)) == 1


def test_every_law_that_the_package_has_besides_the_usual_ones_is_a_reading():
    named = {
        (slot, name)
        for reading in READINGS
        for slot, name in reading.values.items()
        if slot in SLOTS
    }
    assert named == {(slot, kind.__name__) for slot, kind in other_laws()}


def _differences(one, other):
    return [name for name, value in vars(one).items() if value != vars(other)[name]]


def test_what_moves_a_claim_is_named_with_the_nearest():
    def of(verdict, held):
        return Judgement(verdict, f"evidence {held}", held=held, asked=4)

    table = moves(
        {
            AS_IT_IS.name: {
                "C01": of(Verdict.holds, 4),
                "C02": of(Verdict.partly, 2),
                "C03": of(Verdict.fails, 0),
            },
            "up": {
                "C01": of(Verdict.fails, 0),
                "C02": of(Verdict.holds, 4),
                "C03": of(Verdict.fails, 0),
            },
            "down": {
                "C01": of(Verdict.holds, 4),
                "C02": of(Verdict.fails, 0),
                "C03": of(Verdict.fails, 0),
            },
        }
    )
    rows = table.splitlines()[2:]
    assert rows == [
        "| C02 | partly, 2 of 4 | up | down | up: holds, 4 of 4: evidence 4 |",
        "| C03 | fails, 0 of 4 | none | none | none |",
    ]


def test_datasets_are_those_of_single_impacts():
    sets = Study(reading=Reading("soft", {"k_E": 300.0}))
    alone = simulate(
        Block(aspect_ratio=2.0), Soil(k_E=300.0), Impact(orientation=math.pi / 2)
    )
    point = sets["II"].sel(aspect_ratio=2.0)
    # Vectors of impacts and one alone differ by rounding.
    assert float(point.e_n) == pytest.approx(float(alone.e_n), rel=1e-9)
    other = sets.on(GROUNDS[2])
    assert other.on(GROUNDS[0]) is sets
    alone = simulate(
        Block(aspect_ratio=2.0),
        Soil(k_E=300.0, c_v=0.5, gamma_v=0.85),
        Impact(orientation=math.pi / 2),
    )
    point = other["II"].sel(aspect_ratio=2.0)
    assert float(point.e_n) == pytest.approx(float(alone.e_n), rel=1e-9)


def test_the_contact_coefficient_elsewhere_is_that_of_velocities():
    base, _ = parametric_set("fig13")
    data = Study()["fig13"]
    spin, turn = 500.0, 30.0
    at = {"angular_velocity_degps": spin, "orientation_deg": turn}
    found = data.sel(at)
    major, minor, _ = (float(axis) for axis in base.block.semi_axes)

    def arm(orientation):
        sin, cos = math.sin(orientation), math.cos(orientation)
        radius = math.hypot(major * cos, minor * sin)
        return -(major**2 - minor**2) * sin * cos / radius

    start = math.radians(turn)
    closing = 14.0 + arm(start) * math.radians(spin)
    for point, place in (
        (ContactPoint.first, start),
        (ContactPoint.deepest, start + float(found.rotation_rad)),
    ):
        other = with_contact_at(data, base, point).sel(at)
        opening = float(found.v_n_mps + arm(place) * found.omega_radps)
        assert float(other.e_contact) == pytest.approx(-opening / closing, rel=1e-12)
        assert float(other.e_n_vijayakumar) != float(found.e_n_vijayakumar)
    kept = with_contact_at(data, base, ContactPoint.foundation)
    assert kept.identical(data)


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    directory = tmp_path_factory.mktemp("validation") / "made"
    assert main(["claims", "--out", str(directory)]) == 0
    return directory


def findings(directory):
    whole = json.loads((directory / "validation.json").read_text())
    return whole["findings"]


def test_the_command_writes_what_it_finds(out, capsys):
    rows = findings(out)
    claims = read_claims()
    assert [row["id"] for row in rows] == list(claims)
    for row in rows:
        claim = claims[row["id"]]
        assert (row["where"], row["claim"]) == (claim.where, claim.claim)
        assert (row["verdict"] == "not computed") == (row["id"] not in JUDGES)
        assert bool(row["numbers"]) == (row["id"] in JUDGES)
    table = rows_of(out / "validation.csv")
    for key in ("id", "verdict", "evidence", "criterion"):
        assert [row[key] for row in table] == [row[key] for row in rows]
    manifest = json.loads((out / "validation.json").read_text())["manifest"]
    assert manifest["accuracy"]["tolerance"] == 1e-5
    assert "jax" in manifest["versions"]


def test_the_page_shows_what_the_command_finds(out):
    found = [
        Finding(
            *(row[key] for key in ("id", "where", "claim", "criterion")),
            Judgement(Verdict(row["verdict"]), row["evidence"]),
        )
        for row in findings(out)
    ]
    assert_page_shows(found, "C")


def test_the_page_says_how_claims_are_judged():
    for name, claim in read_claims().items():
        if name in JUDGES:
            criterion = claim.criterion.replace("|", "\\|")
            assert f"| {name} | {criterion} |" in page()


def test_readings_of_the_page_are_those_of_the_command():
    for readings in (READINGS, SLOPE_READINGS):
        for number, reading in enumerate(readings, start=1):
            assert f"\n{number}. {reading.name}\n" in page()


def test_runs_down_a_slope_have_readings_of_their_own(monkeypatch, capsys):
    def made_up(name, sets, criterion):
        """Nothing holds on the ground otherwise read, nor in other runs."""
        as_it_is = sets.reading is AS_IT_IS
        return Judgement(Verdict.holds if as_it_is else Verdict.fails, "", asked=1)

    firm = Reading("firm", {"gamma_v": 0.85})
    monkeypatch.setattr(run, "READINGS", (firm,))
    monkeypatch.setattr(run, "SLOPE_READINGS", SLOPE_READINGS[:2])
    monkeypatch.setattr(run, "_judge", made_up)
    assert main(["readings", "--only", "C01", "C34"]) == 0
    printed = capsys.readouterr().out
    assert re.search(r"C01  H    F\nhold 1    0\n\n   1  firm", printed)
    assert re.search(r"C34  H    F  F\nhold 1    0  0\n\n   1  released", printed)


def test_runs_that_fail_are_no_ground_for_a_verdict(monkeypatch):
    usual = study.simulate_runout

    def with_failure(*arguments, **options):
        runs = usual(*arguments[:2], ClosedForm(ConstantCoefficients(0.0, 1.0)))
        runs.ending[[3, 7]] = Ending.failed, Ending.time_limit
        return runs

    monkeypatch.setattr(study, "simulate_runout", with_failure)
    with pytest.raises(NotComputed, match="2 of 45 runs failed or came to a limit"):
        Study()[SLOPE]


def test_readings_go_on_where_they_stopped(tmp_path, monkeypatch, capsys):
    firm = Reading("firm", {"hardening": "HardeningPerMetre"})
    monkeypatch.setattr(run, "READINGS", (firm, Reading("soft", {"k_E": 300.0})))
    judged = []
    judge = run._judge

    def stopping(name, sets, criterion):
        if sets.reading.name == "soft":
            raise KeyboardInterrupt
        judged.append(sets.reading.name)
        return judge(name, sets, criterion)

    monkeypatch.setattr(run, "_judge", stopping)
    command = ["readings", "--out", str(tmp_path), "--only", "C01", "C06"]
    assert main(command) == 130
    assert_one_line_error(capsys, "goes on from here")
    assert judged.count("firm") == 2

    monkeypatch.setattr(run, "_judge", judge)
    assert main(command) == 0
    printed, errors = capsys.readouterr()
    assert "1 readings computed before" in errors
    assert re.search(r"C06  H    F  ·", printed)
    rows = rows_of(tmp_path / "readings.csv")
    assert [(row["reading"], row["id"]) for row in rows] == [
        (reading, name) for reading in ("firm", "soft") for name in ("C01", "C06")
    ]


def test_what_cannot_be_computed_is_said_and_the_rest_goes_on(monkeypatch, capsys):
    def failing(sets, name):
        if name == "II":
            raise NotComputed("2 of 7 impacts of set II failed")
        return SETS[name]

    monkeypatch.setattr(study.Study, "_compute", failing)
    assert main(["claims", "--only", "C01", "C05"]) == 1
    printed, errors = capsys.readouterr()
    assert "2 of 7 impacts of set II failed" in printed
    assert "2 claims: 1 hold, 1 not computed" in printed
    assert errors.splitlines()[-1] == "jaximpact: error: not computed: C05"


def test_a_set_with_a_failed_impact_is_no_ground_for_a_verdict(monkeypatch):
    usual = study.sweep

    def with_failure(*arguments, **options):
        dataset = usual(*arguments, **options)
        dataset["outcome"][2] = "failed"
        return dataset

    monkeypatch.setattr(study, "sweep", with_failure)
    with pytest.raises(NotComputed, match="1 of 7 impacts of set I failed"):
        Study()["I"]


def test_unknown_claims_are_refused(capsys, tmp_path):
    assert main(["claims", "--only", "c07"]) == 2
    assert_one_line_error(capsys, "'c07'", "did you mean 'C07'")
    (tmp_path / "file").touch()
    assert main(["claims", "--only", "C01", "--out", str(tmp_path / "file")]) == 2
    assert_one_line_error(capsys, "--out", "cannot be made")
