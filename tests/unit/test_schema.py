"""Schemas of the TOML files: files that are read pass, what is refused does not."""

import json
import tomllib

import jsonschema
import pytest
from paths import ROOT

from jaximpact.cli import main
from jaximpact.cli.schema import FILES, toml_schema

STUDIES = sorted([*ROOT.glob("calibration/**/*.toml"), *ROOT.glob("slopes/*/*.toml")])


def problems(command, content):
    validator = jsonschema.Draft7Validator(toml_schema(command))
    return [error.message for error in validator.iter_errors(content)]


@pytest.mark.parametrize("command", FILES)
def test_schemas_are_schemas(command, tmp_path, capsys):
    jsonschema.Draft7Validator.check_schema(toml_schema(command))
    out = tmp_path / "study.schema.json"
    assert main(["schema", command, "--out", str(out)]) == 0
    assert json.loads(out.read_text(encoding="utf-8")) == toml_schema(command)
    assert main(["schema", command]) == 0
    assert json.loads(capsys.readouterr().out) == toml_schema(command)


@pytest.mark.parametrize("study", STUDIES, ids=lambda path: path.parent.name)
def test_studies_of_the_repository_pass(study):
    content = tomllib.loads(study.read_text(encoding="utf-8"))
    assert not problems("runout" if "profile" in content else "calibrate", content)


OWN = {"flow": "my_laws.py:MyFlow"}


@pytest.mark.parametrize(
    ("command", "content"),
    [
        ("simulate", OWN | {"my_rate": 3.0}),
        ("simulate", {"my_rate": 3.0, "soil": OWN}),
        ("sweep", OWN | {"axes": {"my_rate": [1, 2]}}),
        ("sweep", {"soil": OWN, "axes": {"g": {"my_rate": [1], "c_v": [1]}}}),
        ("sweep", {"axes": {"shape": ["my.py:Egg"], "my_bend": [1]}}),
        ("sweep", {"axes": {"g": {"shape": ["my.py:Egg"], "my_bend": [1]}}}),
    ],
)
def test_keys_of_own_laws_pass_where_one_is_named(command, content):
    assert not problems(command, content)
    of_ours = json.dumps(content).replace("my_laws.py:MyFlow", "Perzyna")
    assert problems(command, json.loads(of_ours.replace("my.py:Egg", "Ellipsoid")))


def test_values_of_all_kinds_pass():
    own = {"flow": "my_laws.py:MyFlow", "my_rate": 3.0}
    assert not problems("simulate", {"speed_mps": 10.0, "soil": own})
    axes = {
        "angle_deg": {"from": 10, "to": 80, "count": 15},
        "ground": {"name": ["dense", "loose"], "c_v": [1.0, 0.5]},
    }
    assert not problems("sweep", {"axes": axes, "block": {"aspect_ratio": 2.0}})
    random = {"mass_kg": {"mean": 100, "sd": 30, "least": 20}, "shape": ["Ellipsoid"]}
    assert not problems("runout", {"block": random, "collectors_m": [450]})
    assert not problems("tabulate", {"table": {"slopes_deg": [0, 10]}})


@pytest.mark.parametrize(
    ("command", "content", "said"),
    [
        ("calibrate", {"strats": 4}, "'strats' was unexpected"),
        ("calibrate", {"starts": 0}, "less than the minimum of 1"),
        ("calibrate", {"loss": "huber"}, "is not one of"),
        ("calibrate", {"weights": {"e_m": 1.0}}, "'e_m' was unexpected"),
        ("simulate", {"friction_angle_deg": 60}, "maximum of 60"),
        ("simulate", {"soil": {"flow": "Perzina"}}, "not valid under any"),
        ("runout", {"profile": {"point_m": []}}, "'point_m' was unexpected"),
        ("simulate", {"speed_mp": 3}, "'speed_mp' is not one of"),
        ("simulate", {"impact": {"speed_mp": 3}}, "'speed_mp' was unexpected"),
        ("simulate", {"soil": {"gama_v": 3}}, "'gama_v' is not one of"),
        ("sweep", {"axes": {"angle_dg": [1, 2]}}, "is not of type 'object'"),
        ("sweep", {"axes": {"g": {"angle_dg": [1]}}}, "'angle_dg' is not one of"),
        ("calibrate", {"further_tests": {"kount": 3}}, "'kount' was unexpected"),
    ],
)
def test_what_is_refused_does_not_pass(command, content, said):
    (problem,) = problems(command, content)
    assert said in problem


def test_a_schema_replaces_no_study(tmp_path, capsys):
    study = tmp_path / "mine.toml"
    study.write_text("[block]\n")
    assert main(["schema", "runout", "--out", str(study)]) == 2
    assert "--out must end in .json" in capsys.readouterr().err
    assert study.read_text() == "[block]\n"
