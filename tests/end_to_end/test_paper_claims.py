"""The paper's claims: how each is judged, on sets made up so that it holds and fails;
the readings; the commands; and the page that shows what they find."""

import math
import re

import numpy as np
import pytest
from error_messages import assert_one_line_error
from made_up_sets import A_R, ANGLE, ideal
from other_laws import other_laws
from paths import DOCS
from text_files import rows_of

from jaximpact import (
    Block,
    ConstantCoefficients,
    Impact,
    Soil,
    parametric_set,
    simulate,
)
from jaximpact.cli import main
from jaximpact.parametric_sets import GROUNDS
from jaximpact.runout import ClosedForm, Ending
from jaximpact.scene_quantities import SLOTS
from paper import judging, study
from paper.__main__ import make_parser
from paper.claims import JUDGES, SLOPE_CLAIMS, read_claims
from paper.criteria import (
    FALLS,
    RISES,
    Judgement,
    NotComputed,
    Part,
    Verdict,
    combine,
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
from paper.study import RANDOM_SETS, SLOPE, Study

pytestmark = pytest.mark.slow

HOLDS, PARTLY, FAILS = Verdict.holds, Verdict.partly, Verdict.fails


# --- criteria


@pytest.mark.parametrize(
    ("values", "direction", "part"),
    [
        ([1.0, 2.0, 3.0], RISES, Part(HOLDS, 2, 2)),
        ([1.0, 3.0, 2.0], RISES, Part(PARTLY, 1, 2)),
        ([2.0, 3.0, 1.0], RISES, Part(FAILS, 1, 2)),
        ([3.0, 2.0, 1.0], RISES, Part(FAILS, 0, 2)),
        ([3.0, 2.0, 1.0], FALLS, Part(HOLDS, 2, 2)),
        # A step within a thousandth of the largest is none.
        ([10.0, 10.009], RISES, Part(FAILS, 0, 1)),
        ([10.0, 10.011], RISES, Part(HOLDS, 1, 1)),
        ([0.0, 0.009, -10.0], RISES, Part(FAILS, 0, 2)),
    ],
)
def test_a_trend_asks_for_every_step_and_for_the_ends(values, direction, part):
    assert trend(values, direction) == part


def test_parts_hold_together_fail_together_or_hold_partly():
    assert combine([HOLDS, HOLDS]) is HOLDS
    assert combine([FAILS, FAILS]) is FAILS
    for mixed in ([HOLDS, FAILS], [PARTLY, PARTLY], [HOLDS, PARTLY], [FAILS, PARTLY]):
        assert combine(mixed) is PARTLY


# --- judges

SETS = ideal()


def test_every_claim_has_a_judge():
    claims = read_claims()
    assert list(claims) == [f"C{number:02d}" for number in range(1, 39)]
    assert all(all(claim) for claim in claims.values())
    assert set(JUDGES) == set(claims)


@pytest.mark.parametrize("name", JUDGES)
def test_claims_hold_on_sets_made_to_their_words(name):
    judgement = JUDGES[name](SETS)
    assert judgement.verdict is HOLDS
    assert judgement.met == judgement.asked > 0
    assert judgement.evidence


def changed(name, **functions):
    """Sets with variables that are functions of what they were."""
    values = {v: function(SETS[name][v]) for v, function in functions.items()}
    return SETS.changed(name, **values)


def energetic(name, value):
    """Sets with one energetic coefficient of a value."""
    e_bar = SETS[name].e_bar.copy()
    e_bar[dict.fromkeys(e_bar.dims, 0)] = value
    return SETS.changed(name, e_bar=e_bar)


def backwards(values):
    return values.copy(data=values.values[::-1])


def lopsided(values):
    """More beyond 90° of orientation than before it."""
    return values + 0.01 * abs(values).max() * (values.orientation_deg > 90.0)


TWO_VALUES = SETS[SLOPE].e_n.copy(data=np.resize([1.1, -0.9], SETS[SLOPE].e_n.size))
FAILING = {
    # One for each kind of criterion. What each claim looks at is seen in the page.
    # A trend
    "C01": changed("I", max_penetration_m=backwards),
    # Trends at several places
    "C13": changed("III", max_penetration_m=lambda u: 0.0 * u + ANGLE * (5.0 - A_R)),
    # A condition
    "C07": changed("I", max_penetration_m=lambda u: 0.5 * u),
    # Conditions at several places
    "C26": changed("III", e_n=lambda e_n: 0.0 * e_n + ANGLE * 0.001),
    # One of single impacts
    "C29": energetic("III", 1.1),
    # A symmetry
    "C19": changed("IV", max_penetration_m=lopsided),
    # Distributions
    "C36": changed(SLOPE, jump_height_m=lambda height: height**0.3),
    "C37": changed(SLOPE, e_n=lambda _: TWO_VALUES, e_t=lambda _: TWO_VALUES),
}


@pytest.mark.parametrize("name", FAILING)
def test_claims_fail_where_nothing_of_them_holds(name):
    judgement = JUDGES[name](FAILING[name])
    assert judgement.verdict is FAILS
    assert judgement.met < judgement.asked


def test_what_differs_on_another_ground_is_named():
    judgement = JUDGES["C38"](SETS.with_other(GROUNDS[1], FAILING["C01"]))
    assert judgement.verdict is PARTLY
    # C07 and C08 look at the same depths.
    assert "others: C01 fails, C07 partly, C08 partly;" in judgement.evidence
    assert judgement.evidence.endswith("others: none")


def test_energy_of_gravity_and_failed_or_separating_impacts_stand_apart():
    level, fast, _ = RANDOM_SETS
    sets = energetic(level, 1.1)
    judgement = JUDGES["C29"](sets)
    assert judgement.verdict is PARTLY
    assert judgement.evidence.endswith("with gravity's work taken off 1")
    gravity = sets.changed(level, gravity_share=SETS[level].gravity_share + 0.3)
    assert JUDGES["C29"](gravity).evidence.endswith("gravity's work taken off 0")

    data = SETS[fast].copy(deep=True)
    data["e_bar"][:2] = [np.nan, 2.0]
    data["outcome"][1] = "separating"
    judgement = JUDGES["C29"](type(SETS)(SETS | {fast: data}))
    assert judgement.verdict is HOLDS
    assert judgement.evidence.endswith("1 random impacts failed")


# --- readings


def test_every_law_that_the_package_has_besides_the_usual_ones_is_a_reading():
    named = {
        (slot, name)
        for reading in READINGS
        for slot, name in reading.values.items()
        if slot in SLOTS
    }
    # For grounds that the paper does not write of, chosen by measurements.
    beside = {("bearing", "VesicWithInertia")}
    assert named | beside == {(slot, kind.__name__) for slot, kind in other_laws()}
    assert not named & beside


def test_what_moves_a_claim_is_named_with_the_nearest():
    def of(verdict, held):
        return Judgement(verdict, f"evidence {held}", held, 4)

    table = moves(
        {"C01": of(HOLDS, 4), "C02": of(PARTLY, 2), "C03": of(FAILS, 0)},
        {
            "up": {"C01": of(FAILS, 0), "C02": of(HOLDS, 4), "C03": of(FAILS, 0)},
            "down": {"C01": of(HOLDS, 4), "C02": of(FAILS, 0), "C03": of(FAILS, 0)},
        },
    )
    assert table.splitlines()[2:] == [
        "| C02 | partly, 2 of 4 | up | down | up: holds, 4 of 4: evidence 4 |",
        "| C03 | fails, 0 of 4 | none | none | none |",
    ]


def test_the_contact_coefficient_elsewhere_is_that_of_velocities():
    base, _ = parametric_set("fig13")
    data = Study()["fig13"]
    spin, turn = 500.0, 30.0
    at = {"angular_velocity_degps": spin, "orientation_deg": turn}
    there = data.sel(at)
    major, minor, _ = (float(axis) for axis in base.block.semi_axes)

    def arm(orientation):
        sin, cos = math.sin(orientation), math.cos(orientation)
        radius = math.hypot(major * cos, minor * sin)
        return -(major**2 - minor**2) * sin * cos / radius

    start = math.radians(turn)
    closing = 14.0 + arm(start) * math.radians(spin)
    for point, place in (
        (ContactPoint.first, start),
        (ContactPoint.deepest, start + float(there.rotation_rad)),
    ):
        other = with_contact_at(data, base, point).sel(at)
        opening = float(there.v_n_mps + arm(place) * there.omega_radps)
        assert float(other.e_contact) == pytest.approx(-opening / closing, rel=1e-12)
        assert float(other.e_n_vijayakumar) != float(there.e_n_vijayakumar)
    assert with_contact_at(data, base, ContactPoint.foundation).identical(data)


# --- datasets


def test_datasets_are_those_of_single_impacts():
    soft = Study(reading=Reading("soft", {"k_E": 300.0}))
    other = soft.on(GROUNDS[2])
    assert other.on(GROUNDS[0]) is soft
    for sets, soil in (
        (soft, Soil(k_E=300.0)),
        (other, Soil(k_E=300.0, c_v=0.5, gamma_v=0.85)),
    ):
        alone = simulate(Block(aspect_ratio=2.0), soil, Impact(orientation=math.pi / 2))
        point = sets["II"].sel(aspect_ratio=2.0)
        # Vectors of impacts and one alone differ by rounding.
        assert float(point.e_n) == pytest.approx(float(alone.e_n), rel=1e-9)


def test_what_failed_is_no_ground_for_a_verdict(monkeypatch):
    sweep, simulate_runout = study.sweep, study.simulate_runout

    def with_failed_impact(*arguments, **options):
        dataset = sweep(*arguments, **options)
        dataset["outcome"][2] = "failed"
        return dataset

    def with_failed_runs(slope, release, _, **options):
        runs = simulate_runout(slope, release, ClosedForm(ConstantCoefficients(0.0, 1)))
        runs.ending[[3, 7]] = Ending.failed, Ending.time_limit
        return runs

    monkeypatch.setattr(study, "sweep", with_failed_impact)
    monkeypatch.setattr(study, "simulate_runout", with_failed_runs)
    with pytest.raises(NotComputed, match="1 of 7 impacts of set I failed"):
        Study()["I"]
    with pytest.raises(NotComputed, match="2 of 45 runs failed or came to a limit"):
        Study()[SLOPE]


# --- commands


def run(*argv):
    return main(argv, make_parser)


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    """All claims, by the command."""
    directory = tmp_path_factory.mktemp("claims") / "made"
    assert run("claims", "--out", str(directory)) == 0
    return directory


@pytest.fixture(scope="module")
def page():
    return (DOCS / "validation.md").read_text(encoding="utf-8")


def rows_of_page(text):
    """Cells of claims, and criteria, by the ids of the claims."""
    lines = re.findall(r"^\| (C\d\d .*) \|$", text, re.M)
    rows = [re.split(r" (?<!\\)\| ", line) for line in lines]
    judged = [row for row in rows if len(row) == 5 and row[3].strip("*") in [*Verdict]]
    return {row[0]: row[1:] for row in judged}, {
        r[0]: r[1] for r in rows if len(r) == 2
    }


def test_the_page_shows_what_the_command_finds(out, page):
    """Words, verdicts and criteria, and numbers to three digits. Numbers of runs down
    the slope are left out, in which rounding grows from impact to impact: another
    processor has other ones."""
    written = (out / "claims.md").read_text(encoding="utf-8")
    (found, criteria), (shown, shown_criteria) = map(rows_of_page, (written, page))
    assert shown_criteria == criteria
    assert list(found) == list(shown) == list(criteria) == sorted(JUDGES)
    for name, (*words, evidence) in found.items():
        assert shown[name][:-1] == words
        if name not in SLOPE_CLAIMS:
            # What is zero is so to rounding.
            np.testing.assert_allclose(
                numbers_in(shown[name][-1]),
                numbers_in(evidence),
                rtol=5e-3,
                atol=1e-4,
                err_msg=name,
            )
    assert written.split("\n\n")[1] in page  # how many hold


def numbers_in(text):
    return [float(x) for x in re.findall(r"-?\d+\.?\d*(?:e[-+]\d+)?", text)]


def test_the_table_is_of_the_claims_and_their_verdicts(out):
    rows = rows_of(out / "claims.csv")
    found, _ = rows_of_page((out / "claims.md").read_text(encoding="utf-8"))
    for row, claim in zip(rows, read_claims().values(), strict=True):
        assert {name: row[name] for name in claim._fields} == claim._asdict()
        assert row["verdict"] == found[row["id"]][2].strip("*")
        assert 0 <= int(row["met"]) <= int(row["asked"])


def test_readings_of_the_page_are_those_of_the_command(page):
    for readings in (READINGS, SLOPE_READINGS):
        for number, reading in enumerate(readings, start=1):
            assert f"\n{number}. {reading.name}\n" in page


def test_runs_down_a_slope_have_readings_of_their_own(monkeypatch, capsys):
    def made_up(name, sets):
        as_it_is = sets.reading is AS_IT_IS
        return Judgement(HOLDS if as_it_is else FAILS, "", asked=1)

    monkeypatch.setattr(judging, "READINGS", (Reading("firm", {"gamma_v": 0.85}),))
    monkeypatch.setattr(judging, "SLOPE_READINGS", SLOPE_READINGS[:2])
    monkeypatch.setattr(judging, "judge_claim", made_up)
    assert run("readings", "--only", "C01", "C34") == 0
    printed = capsys.readouterr().out
    assert "1. firm\n\n" in printed
    assert "| C01 | H | F |\n| hold | 1 | 0 |\n" in printed
    assert "1. released 10° downwards\n2. " in printed
    assert "| C34 | H | F | F |\n| hold | 1 | 0 | 0 |\n" in printed


def test_readings_go_on_where_they_stopped(tmp_path, monkeypatch, capsys):
    firm = Reading("firm", {"hardening": "HardeningPerMetre"})
    monkeypatch.setattr(judging, "READINGS", (firm, Reading("soft", {"k_E": 300.0})))
    judge, judged = judging.judge_claim, []

    def stopping(name, sets):
        if sets.reading.name == "soft":
            raise KeyboardInterrupt
        judged.append(sets.reading.name)
        return judge(name, sets)

    monkeypatch.setattr(judging, "judge_claim", stopping)
    command = ["readings", "--out", str(tmp_path), "--only", "C01", "C06"]
    assert run(*command) == 130
    assert_one_line_error(capsys, "goes on from here")
    assert judged == ["as it is"] * 2 + ["firm"] * 2

    monkeypatch.setattr(judging, "judge_claim", judge)
    assert run(*command) == 0
    printed, errors = capsys.readouterr()
    assert "2 readings computed before" in errors
    assert "| C06 | H | F | · |" in printed
    assert printed == (tmp_path / "readings.md").read_text(encoding="utf-8")
    rows = rows_of(tmp_path / "readings.csv")
    assert [(row["reading"], row["id"]) for row in rows] == [
        (name, claim)
        for name in ("as it is", "firm", "soft")
        for claim in ("C01", "C06")
    ]


def test_what_cannot_be_computed_is_said_and_the_rest_goes_on(monkeypatch, capsys):
    def failing(sets, name):
        if name == "II":
            raise NotComputed("2 of 7 impacts of set II failed")
        return SETS[name]

    monkeypatch.setattr(Study, "_compute", failing)
    assert run("claims", "--only", "C01", "C05") == 1
    printed, errors = capsys.readouterr()
    assert "2 of 7 impacts of set II failed" in printed
    assert "2 claims: 1 hold, 1 not computed" in printed
    assert errors == "jaximpact: error: not computed: C05\n"


def test_unknown_claims_are_refused(capsys, tmp_path):
    assert run("claims", "--only", "c07") == 2
    assert_one_line_error(capsys, "'c07'", "did you mean C07?")
    (tmp_path / "file").touch()
    assert run("claims", "--only", "C01", "--out", str(tmp_path / "file")) == 2
    assert_one_line_error(capsys, "--out", "cannot be made")
