"""What a study, its tests, a call of `calibrate` or the file of a fit must not say: one
line each, before anything is fitted or predicted."""

import json

import numpy as np
import own_laws
import pytest
from error_messages import assert_one_line, assert_one_line_error
from paths import ROOT
from text_files import write_changed

from jaximpact import Soil, calibrate
from jaximpact.calibration import read_study, residuals
from jaximpact.calibration.arguments import study_given
from jaximpact.calibration.fitted_ground import read_fitted
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.laws import FluidityRate

STUDY = """\
data = ["north.csv", "south.csv"]
starts = 16
seed = 1
[soil]
flow = "my_laws.py:Creeping"
[parameters]
c_v = { start = 1.0, lower = 0.1, upper = 20.0 }
k_E = { start = 900.0, lower = 50.0, upper = 20000.0 }
alpha_s = { start = 0.9, lower = 0.3, upper = 2.0 }
my_rate = { start = 3.0, lower = 0.5, upper = 50.0 }
[nuisance.slope_deg]
by = "campaign"
prior = { mean = 25.0, sd = 10.0 }
[default_sigma]
e_n = 0.01
"""
TABLE = "mass_kg,speed_mps,angle_deg,e_n\n100,8,40,0.1\n400,12,50,0.2\n"
SECOND_LAW = '''
from jaximpact.laws import HardeningPerRootArea

class SecondRate(HardeningPerRootArea):
    """A hardening with a parameter of the flow's name."""

    my_rate: Float[Array, ""] = parameter(0.0, "-", "[0, inf)", "another rate")
'''


@pytest.fixture
def written(tmp_path):
    """A function that writes the study with a replacement, and its tables."""
    own_laws.write_laws(tmp_path)
    with (tmp_path / "my_laws.py").open("a") as file:
        file.write(SECOND_LAW)
    for name in ("north.csv", "south.csv"):
        (tmp_path / name).write_text(TABLE)
    return lambda *pairs: write_changed(tmp_path / "study.toml", STUDY, *pairs)


def before(table, text):
    """A replacement that puts a text before a table."""
    return table, f"{text}\n{table}"


def top(text):
    return before("[soil]", text)


def variant(text):
    return before("[default_sigma]", f"[[variants]]\n{text}")


def further(text):
    return before("[default_sigma]", f"[further_tests]\n{text}")


def block(text):
    return before("[default_sigma]", f"[block]\n{text}")


def c_v(entry):
    return ("c_v = { start = 1.0,", f"c_v = {{ start = 1.0, {entry},")


def tied(text):
    return (
        "alpha_s = { start = 0.9, lower = 0.3, upper = 2.0 }",
        f"alpha_s = {{ expression = {text!r} }}",
    )


# A replacement, and what the message names.
STUDIES = [
    # Of the study.
    (("starts = 16", "strats = 4"), "key strats", "starts"),
    (("starts = 16", "starts = 4.5"), "key starts", "whole number"),
    (("starts = 16", "starts ="), "not valid TOML"),
    (top('targets = ["en"]'), "key targets", "e_n"),
    (top('targets = ["e_bar"]'), "targets", "no column"),
    (top("targets = []"), "key targets"),
    (top('method = "adm"'), "key method", "adam"),
    (top('accuracy = "fats"'), "key accuracy", "fast"),
    (top('loss = "studnet"'), "key loss", "student"),
    (top("weights = { e_n = -1 }"), "weights.e_n", "above 0"),
    (top("weights = { e_n = 1e-300 }"), "weights.e_n", "from 1e-30 to 1e+30"),
    (top("weights = { e_t = 1.0 }"), "weights.e_t", "not fitted; targets are e_n"),
    (("e_n = 0.01", "e_n = 0.0"), "default_sigma.e_n", "above 0"),
    (("e_n = 0.01", "e_n = 1e-300"), "default_sigma.e_n", "from 1e-30 to 1e+30"),
    (("e_n = 0.01", "e_t = 0.01"), "default_sigma.e_t", "targets are e_n"),
    (('["north.csv", "south.csv"]', "[]"), "key data"),
    (('"south.csv"', '"north.csv"'), "key data", "twice"),
    (('"south.csv"', '"soth.csv"'), "soth.csv", "cannot be read"),
    # Of the parameters.
    (("k_E =", "kE ="), "parameters.kE", "k_E"),
    (("k_E =", "mass_kg ="), "parameters.mass_kg"),
    (("lower = 50.0", "low = 50.0"), "parameters.k_E.low", "lower"),
    (("start = 900.0", "start = 9.0"), "parameters.k_E.start", "50"),
    ((", lower = 0.3, upper = 2.0", ""), "parameters.alpha_s.lower"),
    (("lower = 0.1,", "lower = -0.1,"), "parameters.c_v.lower"),
    (c_v("prior = { mean = 1.0, sd = 0.0 }"), "parameters.c_v.prior.sd", "above 0"),
    (c_v("prior = { mean = 1.0, sd = 1e-300 }"), "c_v.prior.sd", "from 1e-30"),
    (c_v("prior = { sd = 1.0 }"), "parameters.c_v.prior.mean", "missing"),
    (c_v("prior = { mean = 40.0, sd = 2.0 }"), "c_v.prior", "bounds, 0.1 and 20"),
    (before("[parameters]", "k_E = 1.0"), "k_E", "is fitted"),
    (before("[parameters]", "k_F = 1.0"), "soil.k_F", "k_E"),
    (variant("x = 1"), "variants[1]"),
    # Parameters that differ by group.
    (c_v('by = "campaign", group_sd = "estimated"'), "must be a number"),
    (c_v('by = "campaign"'), "group_sd: is missing"),
    (c_v("group_sd = 0.3"), "by: is missing"),
    (c_v('by = "campaign", group_sd = -1.0'), "must lie above 0"),
    (c_v('by = "shape", group_sd = 0.3'), "by"),
    # Parameters that are expressions.
    (tied("__import__(1)"), "alpha_s.expression", "calls __import__"),
    (tied("c_v.real"), "alpha_s.expression", "alone"),
    (tied("c_v if c_v else 1"), "alone"),
    (tied("[c_v][0]"), "alone"),
    (tied("c_v @ c_v"), "alone"),
    (tied("True * c_v"), "truth value"),
    (tied("2 * c_w"), "did you mean 'c_v'"),
    (tied("2 *"), "is no expression"),
    (tied("1 - c_v"), "must be "),
    # At the start alone, in a hundredth of the range about it.
    (tied("1e4 * (c_v - 1)**2 - 1"), "must be "),
    (tied("c_v" + " + c_v" * 200), "must be a text"),
    (("alpha_s = { start = 0.9", "alpha_s = { expression = 3.0"), "alpha_s"),
    # Of nuisances.
    (("slope_deg]", "slop_deg]"), "nuisance.slop_deg", "slope_deg"),
    (("by =", "buy ="), "nuisance.slope_deg.buy", "by"),
    (('"campaign"', '"campain"'), "key nuisance.", ".by", "campaign"),
    (('"campaign"', '"test"'), "no column"),
    (("prior =", "# prior ="), "nuisance.slope_deg.prior", "missing"),
    (("mean = 25.0, ", ""), "prior.mean", "missing"),
    (("sd = 10.0", "sd = -1"), "prior.sd", "above 0"),
    (("mean = 25.0", "mean = 95.0"), "prior.mean", "(-90, 90)"),
    # Of the scatter.
    (top('scatter = "proportinal"'), "scatter: must be one of", "mean proportional"),
    (top('scatter = { e_n = "const" }'), "scatter.e_n", "did you mean constant"),
    (top("scatter = { e_n = 0.03 }"), "scatter.e_n: must be a text, but is 0.03"),
    (top("scatter = 0.03"), "scatter: must be one of", "or a table of them"),
    (top('scatter = { e_nn = "constant" }'), "scatter.e_nn: is unknown", "e_n"),
    (top('scatter = { e_n = "constant" }'), "scatter.e_n", "that of e_n is given"),
    (top('scatter = "constant"'), "scatter", "all are given"),
    # Of laws and shapes.
    (("my_rate =", "my_rat ="), "did you mean my_rate?"),
    (("my_rate =", "nucleus_exponent ="), "PowerNucleus"),
    ((", lower = 0.5, upper = 50.0", ""), "say lower and upper"),
    (("my_laws.py:", "your_laws.py:"), "soil.flow", "your_laws.py"),
    ((":Creeping", ":Creping"), "did you mean Creeping?"),
    ((":Creeping", ":SecondRate"), "must derive from AbstractFlow"),
    (('"my_laws.py:Creeping"', "3"), "soil.flow", "must be a name"),
    (
        before("[parameters]", "my_crep_share = 1"),
        "soil.my_crep_share",
        "my_creep_share",
    ),
    (
        variant('hardening = "my_laws.py:SecondRate"'),
        "variants[1]",
        "two parameters of one name",
    ),
    (
        variant('[[variants]]\nname = "b"\nflow = "Perzyna"'),
        "is no parameter of variant 'b', whose laws are flow Perzyna",
    ),
    (block("aspect_ratio = -1"), "above 0"),
    (block('shape = "Cube"'), "block.shape"),
    (block("corner_radius_ratio = 0.1"), "RectangularPrism"),
    # Of further tests.
    (further("candidats = {}"), "further_tests.candidats", "candidates"),
    (further("candidates = { sped_mps = [1] }"), "candidates.sped_mps", "speed_mps"),
    (further("candidates = { speed_mps = [0] }"), "candidates.speed_mps", "above 0"),
    (further("candidates = { speed_mps = 'fast' }"), "must hold numbers"),
    (further("candidates = { c_v = [1] }"), "candidates.c_v", "is fitted"),
    (further("measure = { en = 0.1 }"), "measure.en", "e_n"),
    (further("measure = { e_n = 0 }"), "measure.e_n", "above 0"),
    (further("measure = { e_n = { rel = 1 } }"), "measure.e_n.rel", "relative"),
    (further("count = 0"), "count", "at least 1"),
    (further('criterion = "E"'), "criterion", "D, A"),
    # Of a comparison of laws.
    (before("[soil]", "[compare]\nlaws = 3"), "a name or a list of names, but is 3"),
    (before("[soil]", "[compare]\nlaw = ['model']"), "did you mean laws"),
]


def name_of(value):
    return value[1].strip()[:40] if isinstance(value, tuple) else None


@pytest.mark.parametrize(
    ("pair", "words"), [(pair, words) for pair, *words in STUDIES], ids=name_of
)
def test_a_study_that_cannot_be_used(written, pair, words):
    path = written(pair)
    with pytest.raises(InputError) as error:
        read_study(path)
    assert_one_line(error.value, str(path.parent), *words)


@pytest.mark.parametrize(
    ("pairs", "words"),
    [
        (
            [variant('name = "a"\nbeta = 1.0')],
            "nuisance.beta: stands in variants[1] too",
        ),
        (
            [before("[parameters]", "beta = 0.9"), tied("c_v * beta")],
            "alpha_s.expression: names beta, which is a nuisance",
        ),
    ],
    ids=["variant", "expression"],
)
def test_a_nuisance_that_is_stated_twice(written, pairs, words):
    nuisance = '[nuisance.beta]\nby = "campaign"\nprior = { mean = 0.9, sd = 0.1 }'
    path = written(before("[nuisance.slope_deg]", nuisance), *pairs)
    with pytest.raises(InputError) as error:
        read_study(path)
    assert_one_line(error.value, words)


def test_a_command_refuses_it_in_one_line_and_writes_nothing(written, capsys):
    path = written(("starts = 16", "strats = 4"))
    assert main(["calibrate", str(path), "--out", str(path.parent / "out")]) == 2
    assert_one_line_error(capsys, "study.toml", "key strats")
    assert not (path.parent / "out").exists()


# The table of tests, and what the message names.
TABLES = [
    ("e_n\n0.1\ninf\n", "row 3", "column e_n", "finite"),
    ("mass_kg\n1.0\n", "no measured result"),
    ("mass_kg,e_t\n1.0,0.5\n", "e_t"),
    ("e_n,sigma_e_n\n0.1,0.01\n0.2,\n,\n", "row 3", "column e_n", "sigma_e_n"),
    ("normal_force_N\n1e5\n", "needs time_s"),
    ("time_s,normal_force_N,e_n\n0.1,1e5,0.3\n", "row 2, column e_n", "of its own"),
    ("e_n,force_curve\n0.3,none.csv\n", "which is no file"),
    ("e_n,force_curve\n0.3,other.csv\n", "belongs into tests.csv"),
    ("e_n,force_curve\n0.3,short.csv\n", "must have time_s and normal_force_N"),
]


@pytest.mark.parametrize(
    ("table", "words"), [(table, words) for table, *words in TABLES], ids=repr
)
def test_a_table_that_cannot_be_used(tmp_path, table, words):
    (tmp_path / "other.csv").write_text("time_s,e_n\n0.1,0.5\n")
    (tmp_path / "short.csv").write_text("time_s\n0.1\n")
    (tmp_path / "tests.csv").write_text(table)
    with pytest.raises(InputError) as error:
        read_study(tmp_path / "tests.csv")
    assert_one_line(error.value, str(tmp_path), *words)


def test_times_without_a_force_among_the_targets_mean_nothing(tmp_path):
    table = tmp_path / "tests.csv"
    for text in ("time_s,e_n\n0.1,0.3\n", "time_s,normal_force_N,e_n\n0.1,1e5,0.3\n"):
        table.write_text(text)
        path = tmp_path / "study.toml"
        path.write_text(
            'data = "tests.csv"\ntargets = ["e_n"]\n[parameters]\nk_E = {}\n'
        )
        assert np.all(read_study(path).comparable)


def test_a_study_and_a_table_that_do_not_fit(written):
    path = written(block('shape = "EllipticCylinder"'))
    (path.parent / "north.csv").write_text("shape,e_n\nEllipsoid,0.1\n")
    with pytest.raises(InputError, match=r"block\.shape: stands in north\.csv"):
        read_study(path)
    path = written(('"campaign"', '"test"'))
    (path.parent / "north.csv").write_text("test,e_n\na,0.1\n,0.2\n")
    with pytest.raises(InputError, match=r"north\.csv, row 3, column test: is empty"):
        read_study(path)


TESTS = {"speed_mps": [8.0, 12.0], "angle_deg": [40.0, 50.0], "e_n": [0.1, 0.2]}
# Tests, options, and what the message names.
CALLS = [
    (TESTS, {"fit": ["c_w"]}, "did you mean c_v"),
    (TESTS, {"fit": ["speed_mps"]}, "belongs to block or impact"),
    (TESTS, {"fit": ["alpha_s"]}, "alpha_s has no default bounds"),
    (TESTS, {"fit": ["nucleus_exponent"]}, "belongs to the flow PowerNucleus"),
    (TESTS, {"fit": []}, "names no parameter"),
    (TESTS, {"ground": {"bata": 1.0}}, "did you mean beta"),
    (TESTS, {"ground": {"mass_kg": 1.0}}, "stands in the table"),
    (TESTS, {"ground": {"beta": 3.0}}, "beta: must be in (0, 2)"),
    (TESTS, {"ground": {"c_v": 1.0}}, "is fitted"),
    (TESTS, {"ground": {"flow": "Perzina"}}, "did you mean Perzyna"),
    (TESTS, {"ground": Soil(beta=np.array([0.8, 0.9]))}, "must be one soil"),
    (TESTS, {"block": 3}, "block must be of type Block"),
    (TESTS, {"targets": ["e_nn"]}, "did you mean e_n"),
    (TESTS, {"sigma": {"e_n": 0.0}}, "must be above 0"),
    (TESTS, {"scatter": {"e_n": "const"}}, "scatter.e_n", "did you mean constant"),
    ({"speed_mps": [1.0, 2.0], "e_n": [0.1]}, {}, "column e_n: holds 1 values"),
    ({"e_n": [0.1, "high"]}, {}, "row 3, column e_n: must be a number"),
    (5, {}, "are of type int"),
]


@pytest.mark.parametrize(
    ("tests", "options", "words"), [(t, o, words) for t, o, *words in CALLS], ids=str
)
def test_a_call_that_cannot_be_used(tests, options, words):
    with pytest.raises(InputError) as error:
        calibrate(tests, **options)
    assert_one_line(error.value, *words)


def test_settings_of_a_study_are_not_given_again(written):
    with pytest.raises(InputError, match="seed is for the study itself"):
        calibrate(written(), seed=1)


def test_residuals_are_of_measurements_of_one_variant(tmp_path):
    path = tmp_path / "tests.csv"
    path.write_text(TABLE)
    with pytest.raises(InputError, match="variant 'other' is unknown"):
        residuals(path, "other")
    path.write_text(TABLE.replace("0.2", ">0.2"))
    with pytest.raises(InputError, match="limits"):
        residuals(path)


SETTINGS = [
    ("starts = 4.5", {"starts": 4.5}),
    ('method = "adm"', {"method": "adm"}),
    ('accuracy = "fats"', {"accuracy": "fats"}),
    ('loss = "studnet"', {"loss": "studnet"}),
    ("weights = { e_n = -1 }", {"weights": {"e_n": np.int64(-1)}}),
    ("[[variants]]\nx = 1", {"variants": ({"x": 1},)}),
    ("[nuisance.slope_deg]\nby = 'row'", {"nuisance": {"slope_deg": {"by": "row"}}}),
]


@pytest.mark.parametrize(("text", "argument"), SETTINGS)
def test_arguments_are_refused_as_a_study_is(text, argument, tmp_path):
    tests = {"speed_mps": [8.0, 12.0], "e_n": [0.1, 0.2]}
    (tmp_path / "tests.csv").write_text("speed_mps,e_n\n8,0.1\n12,0.2\n")
    (tmp_path / "study.toml").write_text(f"data = 'tests.csv'\n{text}\n")
    with pytest.raises(InputError) as in_study:
        read_study(tmp_path / "study.toml")
    with pytest.raises(InputError) as in_call:
        calibrate(tests, **argument)
    assert in_call.value.problem == in_study.value.problem
    assert in_call.value.place["key"] == in_study.value.place["key"]


def test_arguments_make_the_study_that_a_file_does(tmp_path):
    (tmp_path / "tests.csv").write_text("speed_mps,e_n\n8,0.1\n12,0.2\n")
    (tmp_path / "study.toml").write_text("""
data = "tests.csv"
starts = 1
loss = "student"
method = "adam"
accuracy = "fast"
weights = { e_n = 2.0 }
nuisance.slope_deg = { by = "row", prior = { mean = 30.0, sd = 3.0 } }
variants = [{ dilatancy = 0.0 }, { name = "rate", flow = "FluidityRate" }]
""")
    of_file = read_study(tmp_path / "study.toml")
    of_call = study_given(
        str(tmp_path / "tests.csv"),
        starts=np.int64(1),
        loss="student",
        method="adam",
        accuracy="fast",
        weights={"e_n": 2.0},
        nuisance={"slope_deg": {"by": "row", "prior": {"mean": 30.0, "sd": 3.0}}},
        variants=({"dilatancy": 0.0}, {"name": "rate", "flow": FluidityRate()}),
    )
    for name in ("starts", "loss", "method", "accuracy", "weights"):
        assert getattr(of_call, name) == getattr(of_file, name)
    assert [str(v) for v in of_call.variants] == [str(v) for v in of_file.variants]
    assert str(of_call.nuisances) == str(of_file.nuisances)


FIT = ROOT / "calibration" / "beladjine2007" / "result" / "fit.json"
FIRST = "variants", 0
DAMAGES = {
    "a draw is null": ((*FIRST, "draws", "values", 0, 0), None),
    "weights are of fewer draws": ((*FIRST, "draws", "weights"), [1.0]),
    "weights are 0": ((*FIRST, "draws", "weights"), [0.0] * 1536),
    "a weight is below 0": ((*FIRST, "draws", "weights", 0), -1.0),
    "a weight is null": ((*FIRST, "draws", "weights", 0), None),
    "a value is null": ((*FIRST, "parameters", "c_v", "value"), None),
    "a value is text": ((*FIRST, "parameters", "c_v", "value"), "a"),
    "a sigma is null": ((*FIRST, "fit", "e_n", "sigma"), None),
    "a bound is null": (("manifest", "parameters", "c_v", "lower"), None),
    "a range is null": (("fitted_tests", "ranges", "mass_kg"), [None, None]),
    "the accuracy is unknown": (("manifest", "accuracy", "name"), "finest"),
    "the seed is negative": (("manifest", "seed"), -1),
    "the seed is no whole number": (("manifest", "seed"), 1.5),
    "a target is unknown": (("manifest", "targets"), ["foo"]),
    "there is no variant": (("variants",), []),
    "the discrepancy is null": ((*FIRST, "discrepancy", "factor"), None),
    "its freedom is null": ((*FIRST, "discrepancy", "freedom"), None),
    "its count is null": ((*FIRST, "discrepancy", "left_out"), None),
    "its groups are null": ((*FIRST, "discrepancy", "groups"), None),
    "its scatter is null": ((*FIRST, "discrepancy", "scatter", 0), None),
    "its places are null": ((*FIRST, "discrepancy", "places", 0), [None, 0.0, 0.0]),
    "a simple law's value is null": (("simple_laws", 0, "values", 0), None),
    "its sigma is null": (("simple_laws", 0, "sigma", 0), None),
}


@pytest.mark.parametrize(("place", "value"), DAMAGES.values(), ids=DAMAGES)
def test_a_result_with_damaged_values_is_refused(tmp_path, place, value):
    """By an error that names the file, not later or by other numbers."""
    tree = json.loads(FIT.read_text())
    assert len(tree["variants"][0]["draws"]["weights"]) == 1536
    entry = tree
    for key in place[:-1]:
        entry = entry[key]
    assert entry[place[-1]] != value
    entry[place[-1]] = value
    (tmp_path / "fit.json").write_text(json.dumps(tree))
    with pytest.raises(InputError) as error:
        read_fitted(tmp_path)
    assert_one_line(error.value, "fit.json: ")
