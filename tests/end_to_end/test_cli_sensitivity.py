"""`jaximpact sensitivity`: from a study to tables, drawings and a manifest."""

import json

import pytest
from error_messages import assert_one_line, assert_one_line_error
from text_files import rows_of

from jaximpact.cli import main
from jaximpact.cli.sensitivity import METHODS
from jaximpact.errors import InputError
from jaximpact.quantities import INPUT_COLUMNS
from jaximpact.sensitivity import study as study_file
from jaximpact.sensitivity.study import read_study

STUDY = """
title = "A sphere"
accuracy = "fast"
outputs = ["e_n", "e_t", "max_normal_force_N"]
blocks = 16
trajectories = 6
seed = 3

[block]
mass_kg = 500

[parameters]
c_v = { lower = 0.1, upper = 10, distribution = "log-uniform" }
speed_mps = { lower = 5, upper = 25 }
"""
FILES = {
    "elasticities": {"elasticities.csv", "elasticities.png", "tornado.png"},
    "morris": {"morris.csv", "morris.png"},
    "sobol": {"sobol.csv", "sobol.png"},
}
ALWAYS = {"report.txt", "manifest.json", "jaximpact-files.json"}


@pytest.fixture
def folder(folder):
    """A working directory with a study."""
    (folder / "study.toml").write_text(STUDY)
    return folder


def names_in(path):
    return {entry.name for entry in path.iterdir()}


@pytest.mark.slow
def test_a_study_becomes_a_report_tables_drawings_and_a_manifest(folder, capsys):
    assert main(["sensitivity", "study.toml", "--out", "out"]) == 0
    out, err = capsys.readouterr()
    assert names_in(folder / "out") == ALWAYS.union(*FILES.values())
    report = (folder / "out" / "report.txt").read_text()
    assert report == f"A sphere\n\n{out}"
    for words in ("Elasticities", "Elementary effects", "Sobol indices", "e_t: none"):
        assert words in out
    for words in ("elasticities", "18 of 18 impacts for morris", "64 of 64 impacts"):
        assert words in err

    rows = rows_of(folder / "out" / "elasticities.csv")
    assert len(rows) == 6
    first = rows[0]
    assert (first["parameter"], first["output"]) == ("c_v", "e_n")
    value = float(first["parameter_value"]) * float(first["derivative"])
    value /= float(first["output_value"])
    assert float(first["elasticity"]) == pytest.approx(value, rel=1e-12)
    assert f"{value:.3g}" in out
    assert [row["state"] for row in rows if row["output"] == "e_t"] == [
        "output has no value"
    ] * 2
    for name, columns in (
        ("morris", {"mean_absolute_effect", "effect_deviation", "groups_dropped"}),
        ("sobol", {"first_order", "total_order_interval", "reason"}),
    ):
        rows = rows_of(folder / "out" / f"{name}.csv")
        assert len(rows) == 6
        assert columns <= rows[0].keys()

    manifest = json.loads((folder / "out" / "manifest.json").read_text())
    assert manifest["scene"]["mass_kg"] == 500.0
    assert manifest["ranges"]["c_v"]["distribution"] == "log-uniform"
    assert (manifest["seed"], manifest["blocks"]) == (3, 16)
    of_sobol = manifest["methods"]["sobol"]
    assert of_sobol["accuracy"]["name"] == "fast"
    assert sum(of_sobol["outcomes"].values()) == 64
    assert of_sobol["groups_dropped"] == {
        "e_n": 0,
        "e_t": 16,
        "max_normal_force_N": 0,
    }
    for name, files in FILES.items():
        assert set(manifest["methods"][name]["files"]) == files


def test_a_method_may_be_chosen(folder, capsys):
    command = ["sensitivity", "study.toml", "--out", "out", "--method", "morris"]
    assert main([*command, "--accuracy", "balanced"]) == 0
    assert names_in(folder / "out") == ALWAYS | FILES["morris"]
    manifest = json.loads((folder / "out" / "manifest.json").read_text())
    assert manifest["methods"]["morris"]["accuracy"]["name"] == "balanced"
    assert "Sobol" not in capsys.readouterr().out


def test_a_run_that_was_cut_short_goes_on(folder, capsys, monkeypatch):
    command = ["sensitivity", "study.toml", "--out", "out", "--method", "sobol"]

    def full(study, datasets, report, new):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("jaximpact.sensitivity.study.write_study", full)
        assert main(command) == 1
    assert_one_line_error(capsys, "No space left on device")
    assert names_in(folder / "out") == {"sobol.journal"}

    def interrupted(*arguments, **how):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("jaximpact.sensitivity.study.sobol", interrupted)
        assert main(command) == 130
    assert_one_line_error(capsys, "the same command goes on from here")
    assert main(command) == 0
    # All is taken from the journal at once.
    assert capsys.readouterr().err.startswith("64 of 64 impacts for sobol (100 %)\n")
    assert names_in(folder / "out") == ALWAYS | FILES["sobol"]


def test_help_explains_study_and_parameters(capsys):
    with pytest.raises(SystemExit) as exit_:
        main(["sensitivity", "--help"])
    assert exit_.value.code == 0
    words = capsys.readouterr().out.split()
    assert {"--out", "--method", "[parameters]", *INPUT_COLUMNS} <= set(words)
    for key in study_file.KEYS:
        assert any(key in word for word in words)
    assert (*study_file.METHODS, study_file.ALL) == METHODS


# --- what a study may say


def read(folder, text, method=None):
    (folder / "study.toml").write_text(text)
    return read_study(folder / "study.toml", method)


def test_without_ranges_there_are_elasticities_of_three_parameters(folder):
    study = read(folder, "")
    assert study.parameters == ("c_v", "gamma_v", "k_E")
    assert study.methods == ("elasticities",)
    assert study.title == "study"
    # A range left out leaves out what needs it.
    some = "[parameters]\nc_v = { lower = 1, upper = 2 }\ndilatancy = {}\n"
    assert read(folder, some).methods == ("elasticities",)
    assert read(folder, STUDY).methods == ("elasticities", "morris", "sobol")
    assert read(folder, STUDY, "sobol").methods == ("sobol",)
    assert read(folder, 'method = "morris"\n' + STUDY).methods == ("morris",)
    assert read(folder, 'method = "morris"\n' + STUDY, "all").methods == METHODS[:3]


def test_the_base_and_a_range_may_name_the_same_parameter(folder):
    study = read(folder, "c_v = 2\n[parameters]\nc_v = { lower = 1, upper = 3 }\n")
    assert float(study.base.soil.c_v) == 2.0
    assert study.ranges["c_v"].upper == 3.0


REFUSED = {
    "unknown key": ("parametres = 1\n", ["key parametres", "parameters?"]),
    "unknown parameter": ("[parameters]\nc_w = {}\n", ["c_w", "c_v?"]),
    "unknown output": ('outputs = ["e_nn"]\n', ["key outputs", "e_n?"]),
    "output no text": ("outputs = [[1]]\n", ["key outputs", "output [1] is unknown"]),
    "no parameter": ("[parameters]\n", ["key parameters", "at least one"]),
    "no table": ("[parameters]\nc_v = 1\n", ["parameters.c_v", "a table like", "1"]),
    "unknown end": (
        "[parameters]\nc_v = { low = 1, upper = 2 }\n",
        ["parameters.c_v.low", "lower?"],
    ),
    "one end": ("[parameters]\nc_v = { lower = 1 }\n", ["c_v.upper", "is missing"]),
    "out of range": (
        "[parameters]\nc_v = { lower = -1, upper = 2 }\n",
        ["parameters.c_v.lower", "at least 0", "-1"],
    ),
    "downwards": (
        "[parameters]\nc_v = { lower = 3, upper = 2 }\n",
        ["parameters.c_v", "run upwards"],
    ),
    "distribution": (
        '[parameters]\nc_v = { lower = 1, upper = 2, distribution = "normal" }\n',
        ["distribution", "log-uniform", "'normal'"],
    ),
    "logarithm of zero": (
        '[parameters]\nc_v = { lower = 0, upper = 2, distribution = "log-uniform" }\n',
        ["parameters.c_v", "above 0"],
    ),
    "method": ('method = "soboll"\n', ["key method", "sobol?"]),
    "method without ranges": (
        'method = "sobol"\n',
        ["parameters.c_v", "needs a range", "--method elasticities"],
    ),
    "one parameter": (
        'method = "sobol"\n[parameters]\nc_v = { lower = 1, upper = 2 }\n',
        ["key parameters", "at least two"],
    ),
    "blocks": ("blocks = 1000\n", ["key blocks", "power of two", "1024"]),
    "trajectories": ("trajectories = 1\n", ["key trajectories", "at least 2"]),
    "seed": ("seed = -1\n", ["key seed", "at least 0"]),
    "scene": ("mass_kg = -1\n", ["key mass_kg", "above 0"]),
}


@pytest.mark.parametrize(("text", "needed"), REFUSED.values(), ids=REFUSED)
def test_bad_studies_are_refused_in_one_line_that_says_where(folder, text, needed):
    with pytest.raises(InputError) as caught:
        read(folder, text)
    assert_one_line(caught.value, "study.toml", *needed)


@pytest.mark.parametrize(
    ("arguments", "part"),
    [
        (["study.toml"], "--out"),
        (["none.toml", "--out", "out"], "none.toml: cannot be read"),
        (["study.toml", "--out", "out", "--method", "saltelli"], "'saltelli'"),
        (["study.toml", "--out", "study.toml"], "--out study.toml cannot be made"),
    ],
)
def test_wrong_arguments_are_one_line_and_leave_nothing(
    folder, capsys, arguments, part
):
    assert main(["sensitivity", *arguments]) == 2
    assert_one_line_error(capsys, "error: ", part)
    assert names_in(folder) == {"study.toml"}
