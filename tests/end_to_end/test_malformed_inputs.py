"""Malformed input, in files, on the command line and in Python, is refused at once, in
one line that says where and what. In one process."""

import json
import os
import pickle
import threading

import jax.numpy as jnp
import numpy as np
import pandas as pd
import pytest
from error_messages import assert_one_line, warned_once

from jaximpact import (
    Accuracy,
    Block,
    Impact,
    Scene,
    Soil,
    calibrate,
    elasticities,
    simulate,
    simulate_batch,
    sobol,
    sweep,
)
from jaximpact.calibration.arguments import table_given
from jaximpact.cli import main
from jaximpact.errors import InputError, UnusualValueWarning, did_you_mean, shown
from jaximpact.io.files import read_input
from jaximpact.io.scene_table import read_table
from jaximpact.runout import (
    ClosedForm,
    FullModel,
    Ground,
    Profile,
    Release,
    Uniform,
    draw,
    simulate_runout,
)
from jaximpact.shapes import Ellipsoid

HUGE = "1" + 400 * "0"
LONGER = "1" + 5_000 * "0"
SLOPE = """
[profile]
points_m = [[0, 100], [200, 0]]
[release]
x_m = 2
clearance_m = 1
"""
POINTS = "points_m = [[0, 100], [200, 0]]"
TWICE = "is a pipe, but is read more than once"
STUDY = 'data = "tests.csv"\n'
TESTS = "mass_kg,angle_deg,e_n\n100,10,0.2\n110,20,0.3\n"
OUT = {
    "simulate": [],
    "batch": ["--out", "out.csv"],
    "sweep": ["--out", "out.nc"],
    "runout": ["--out", "out"],
    "tabulate": ["--out", "out.nc"],
    "calibrate": ["--out", "out"],
}


def refused(capsys, *arguments):
    """The one line on stderr with which a command refuses its input."""
    assert main(list(arguments)) == 2
    out, err = capsys.readouterr()
    assert out == ""
    (line,) = err.splitlines()
    assert line.startswith("jaximpact: error: ")
    assert line.isprintable()
    assert len(line) < 800
    return line


# Command, study, and what its one line on stderr has.
STUDIES = [
    ("simulate", f"mass_kg = {HUGE}", "key mass_kg: holds a whole number beyond"),
    ("simulate", f"\nmass_kg = {LONGER}", "row 2: holds a whole number beyond"),
    ("simulate", "mass_kg = 1e400", "key mass_kg: must be finite, but is inf"),
    ("simulate", "unit_weight_kNm3 = 1e308", "unit_weight_kNm3: must be above 0"),
    ("simulate", "mass_kg = true", "must be a number, but is True"),
    ("simulate", "mass_kg = 1979-05-27", "must be a number, but is datetime.date"),
    ("simulate", "mass_kg = '" + 5_000 * "x" + "'", "must be a number, but is 'xx"),
    ("simulate", "a = " + 9_000 * "[" + 9_000 * "]", "more than 20 deep"),
    ("simulate", "[a" + 100_000 * ".a" + "]", "more than 20 deep"),
    ("simulate", '"\\u001b[2J" = 1', "key \\x1b[2J: holds a control character"),
    ("simulate", '"\\u202ekg" = 1', "key \\u202ekg: is unknown"),
    ("simulate", "friction_angle_deg = 90", "must be in (0, 60) deg, but is 90"),
    ("simulate", "relative_density = 90", "but is 90; %? 90 % is 0.9"),
    ("sweep", "[axes]\nk_E = [1, true]", "must be a number, but is True"),
    ("sweep", "[axes.g]\nname = [[1]]\nc_v = [1]", "name must be texts"),
    (
        "sweep",
        "[axes]\nk_E = { from = 1, to = 2, count = 1_000_000_000_000_000 }",
        "1000000000000000 values would take 7.45e+06 GiB of memory",
    ),
    ("runout", "count = 1_000_000_000_000\n" + SLOPE, "key count: 1000000000000"),
    ("runout", "bins = 1_000_000\n" + SLOPE, "key bins: must be at most 10000"),
    ("runout", SLOPE + "speed_mps=1e20\ndirection_deg=0", "v_x must be within 1e+08"),
    ("runout", SLOPE + "[block]\nmass_kg = [9, 1e31]", "release: semi-axes of blocks"),
    ("runout", f"seed = {HUGE}\n" + SLOPE, "key seed: holds a whole number"),
    ("runout", 'title = "a\\u0000"\n' + SLOPE, "key title: holds a control"),
    ("runout", SLOPE.replace("[0, 100]", f"[0, {HUGE}]"), "holds a whole number"),
    ("runout", '[profile]\ncsv = "a\\u0000b"', "csv: holds a control character"),
    ("runout", '[profile]\ncsv = "C:\\Users\\a.csv"', "write / or single quotes"),
    ("runout", '[profile]\ncsv = "..\\data.csv"', "write / or single quotes"),
    ("calibrate", 'data = "new\\tests.csv"', "write / or single quotes"),
    ("simulate", 'flow = "laws\\my.py:My"', "write / or single quotes"),
    (
        "runout",
        f"collectors_m = {[*range(1, 102)]}\n" + SLOPE,
        "collectors_m: holds 101",
    ),
    ("runout", SLOPE + "[[barriers]]\n" * 101, "key barriers: are 101, but at mo"),
    ("tabulate", "[table.nodes]\nspeed = 1_000_000_000_000", "table.nodes: "),
    ("calibrate", STUDY + "starts = 1_000_000_000_000_000", "key starts: "),
    ("calibrate", STUDY + "[further_tests]\ncount = 10_000_000_000", "at most 1000"),
    (
        "calibrate",
        'data = ["tests.csv", "link.csv"]',
        "names one file twice: tests.csv",
    ),
    ("calibrate", 'data = "/dev/zero"', "/dev/zero: is a device"),
    ("simulate", "mass_kg = \n", "not valid TOML", "line 1"),
    ("simulate", "mass_kg = 1\nmass_kg = 2\n", "not valid TOML", "line 2"),
    ("simulate", b"# \xe4\n", "UTF-8"),
    ("simulate", "mas_kg = 1\n", "key mas_kg", "mass_kg?"),
    ("simulate", "[soil]\nk_e = 1\n", "key soil.k_e", "k_E?"),
    ("simulate", "[sol]\nk_E = 1\n", "key sol", "soil?"),
    ("simulate", 'acuracy = "fast"\n', "key acuracy", "accuracy?"),
    ("simulate", "[soil]\nmass_kg = 1\n", "mass_kg", "[soil]", "[block]"),
    ("simulate", "mass_kg = 1\n[block]\nmass_kg = 1\n", "mass_kg", "remove one"),
    ("simulate", "block = 1\n", "key block", "table"),
    ("simulate", '[block]\nmass_kg = "1"\n', "mass_kg", "a number", "'1'"),
    ("simulate", "mass_kg = [1, 2]\n", "mass_kg", "a number"),
    ("simulate", "mass_kg = -1\n", "mass_kg", "above 0 kg", "-1"),
    ("simulate", "orientation_deg = nan\n", "orientation_deg", "finite", "nan"),
    ("simulate", 'accuracy = "exact"\n', "key accuracy", "reference", "'exact'"),
    ("simulate", "accuracy = [1]\n", "key accuracy", "fast"),
    ("sweep", "speed_mps = 3", "key axes: is needed"),
    ("sweep", "axes = 3", "key axes: must be a table"),
    ("sweep", "[axes]\nk_e = [1]", "key axes.k_e: is unknown; did you mean k_E"),
    ("sweep", "[axes]\nk_E = 3", "must be a list of numbers, or a range"),
    ("sweep", "[axes]\nk_E = {from=1, to=2}", "key axes.k_E: needs count"),
    ("sweep", "[axes]\nk_E = {from=1, to=2, cont=2}", "did you mean count"),
    ("sweep", "[axes]\nk_E = {from=1, to=2, count=0}", "must be at least 1"),
    ("sweep", "[axes]\nk_E={from=1, to=2, count=1}", "k_E.count: must be at least 2"),
    (
        "sweep",
        "[axes]\nk_E={from=0,to=2,count=2,spacing='logarithmic'}",
        "positive num",
    ),
    ("sweep", "[axis]\nk_E = [1]", "is unknown; did you mean axes"),
    ("tabulate", "[tabel]", "key tabel", "did you mean table?"),
    ("tabulate", "[block]\nmass_kg = -1", "block.mass_kg", "above 0"),
    ("tabulate", "[block]\nmass_kg = [100, 200]", "block.mass_kg", "must be a num"),
    ("tabulate", "[ground]\nspeed_mps = 4", "ground.speed_mps", "is unknown"),
    ("tabulate", "[table]\nslopes_deg = [0, -10]", "table.slopes_deg", "ascend"),
    ("tabulate", "[table]\nslopes_deg = [0, 90]", "slopes_deg", "in (-90, 90)"),
    ("tabulate", "[table]\nslopes_deg = 30", "table.slopes_deg", "list of numbers"),
    ("tabulate", "[table]\ntotal_speeds_mps = [40, 0.5]", "speeds_mps", "ascending"),
    ("tabulate", "[table.nodes]\nazimut = 9", "nodes.azimut", "mean azimuth?"),
    ("tabulate", "[table.nodes]\nazimuth = 1", "nodes.azimuth", "at least 2"),
    ("tabulate", 'accuracy = "best"', "key accuracy", "one of"),
    ("runout", SLOPE.replace(POINTS, 'csv = "pipe"'), TWICE),
    ("runout", SLOPE.replace(POINTS, 'dxf = "pipe"'), TWICE),
    ("runout", SLOPE + "[contacts]\nlaw = 'table'\nfiles = ['pipe']", TWICE),
    ("runout", SLOPE + "[ground]\nfrom = 'pipe'", TWICE),
    ("runout", SLOPE + "[contacts]\nlaw = 'pipe.py:Law'", "pipe.py: is no file"),
    ("simulate", "flow = 'pipe.py:Law'", "pipe.py: is no file"),
    ("simulate", "shape = 'pipe.py:Shape'", "pipe.py: is no file"),
    ("calibrate", "data = 'pipe'", "pipe: is a pipe that nobody writes to"),
]


@pytest.mark.parametrize("study", STUDIES, ids=lambda study: f"{study[0]}: {study[2]}")
def test_malformed_studies(folder, capsys, study):
    command, text, *said = study
    (folder / "tests.csv").write_text(TESTS)
    (folder / "link.csv").symlink_to("tests.csv")
    os.mkfifo("pipe")
    os.mkfifo("pipe.py")
    data = text if isinstance(text, bytes) else text.encode()
    (folder / "study.toml").write_bytes(data)
    line = refused(capsys, command, "study.toml", *OUT[command])
    for part in said:
        assert part in line


@pytest.mark.parametrize(
    "table",
    [
        (
            "mass_kg\n" + LONGER + "\n",
            "row 2, column mass_kg: must be finite and above 0",
        ),
        ("mass_kg\n\u0661\u0660\u0660\n", "row 2, column mass_kg: must be a number"),
        ("mass_kg\n\x1b[31m1\n", "row 2: holds b'\\x1b'"),
        ("\u202emass_kg\n1\n", "column \\u202emass_kg: is unknown"),
        ("x" * 3_000_000 + "\n1\n", "row 1"),
        ("mass_kg\n" + "1" * 200_000 + "\n", "row 2: is not valid CSV"),
        ("a," * 200_000 + "\n", "column a: is unknown"),
        ("mass_kg,name\n1,\ud800\n", "row 2: is not text in UTF-8"),
        ("poisson\n30\n", "but is 30; %? 30 % is 0.3"),
        ("", "is empty"),
        ("\n\n", "is empty"),
        ("mass_kg\n", "no rows"),
        ("mass_kg,sped_mps\n1,2\n", "row 1", "sped_mps", "speed_mps?"),
        ("gamma_w\n1\n", "row 1", "column gamma_w", "gamma_v?"),
        ("mass_kg,k_E,mass_kg\n1,2,3\n", "row 1", "mass_kg", "twice"),
        ("mass_kg,\n1,2\n", "row 1", "column 2", "no name"),
        ("100,14\n100,15\n", "row 1", "column 100", "must name"),
        ("mass_kg,e_n\n1,0.5\n", "row 1", "e_n", "is a result"),
        ("mass_kg;k_E\n1;2\n", "row 1", "separated by ';'"),
        ("mass_kg\tk_E\n1\t2\n", "row 1", "separated by tabs"),
        ("mass_kg\n1,5\n", "row 2", "2 cells", "has 1", "point"),
        ('mass_kg\n"1,5"\n', "row 2", "mass_kg", "'1,5'", "point"),
        ('mass_kg\n"1,500"\n', "'1,500'; write 1500, without a sep", "or 1.500"),
        (
            'mass_kg\n"-1,500.5"\n',
            "; write -1500.5, without a separator of thousands",
        ),
        ('mass_kg\n"0,500"\n', "'0,500'; write decimals with a point"),
        ('mass_kg\n"1,5000"\n', "'1,5000'; write decimals with a point"),
        ("mass_kg\n1,500\n", "row 2", "2 cells", "and thousands without a comma"),
        ('mass_kg,note\n5, "a, b"\n', "row 2", "3 cells", "has 2; remove the blank"),
        ("mass_kg,k_E\n1,2\n3\n", "row 3", "1 cells", "has 2"),
        ("k_E,mass_kg\n1,2\n3,heavy\n", "row 3", "column mass_kg", "'heavy'"),
        ("k_E,mass_kg\n1,2\n,2\n", "row 3", "column k_E", "is empty"),
        ("mass_kg\n1_000\n", "row 2", "mass_kg", "'1_000'"),
        ("mass_kg\nnan\n", "row 2", "mass_kg", "finite and above 0 kg, but is nan"),
        ("speed_mps\ninf\n", "row 2", "finite and above 0 m/s, but is inf"),
        ("orientation_deg\n1e999\n", "row 2", "finite", "1e999"),
        ("mass_kg\n1\n-5\n", "row 3", "mass_kg", "above 0 kg", "-5"),
        ("mass_kg\n\n1\n\n-1\n", "row 5", "mass_kg"),
        ('note,mass_kg\n"a\nb",1\nc,-1\n', "row 4", "mass_kg"),
        ('note,mass_kg\n"a,1\nb,2\n', "row 2", "not valid CSV"),
        (b"note,mass_kg\na,1\n\xe4,1\n", "row 3", "UTF-8"),
        (b"mass_kg\n1\n\x00\n", "row 3", "null"),
        (b"PK\x03\x04\x14\x00\x06\x00", "scenes.csv: is a workbook of Excel"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1\n", "scenes.csv: is a workbook", "CSV"),
        (b"note,mass_kg\ra,1\r\xe4,1\r", "row 3", "UTF-8"),
        (b"mass_kg\r\n1\r\x00\n", "row 3", "null"),
    ],
)
def test_malformed_tables(folder, capsys, table):
    data, *said = table
    is_text = isinstance(data, str)
    data = data.encode("utf-8", "surrogatepass") if is_text else data
    (folder / "scenes.csv").write_bytes(data)
    line = refused(capsys, "batch", "scenes.csv", *OUT["batch"])
    for part in ("scenes.csv", *said):
        assert part in line


@pytest.mark.parametrize(
    ("data", "said"),
    [
        ("x_m,y_m\n0," + "1" * 200_000 + "\n", "row 2: is not valid CSV"),
        ('x_m,y_m\n0,"1\n', "row 2: is not valid CSV"),
        ("x\0_\0m\0", "row 1: holds a null byte; is it a CSV"),
        ("x_m,y_m\n0,1_0\n200,0\n", "row 2, column y_m: must be a number"),
        ("x_m,y_m\n0,1e400\n200,0\n", "row 2, column y_m: must be finite"),
        ("x_m,y_m\n0,90\n100,-9999\n200,0\n", "row 3, column y_m: is -9999 among"),
    ],
)
def test_malformed_profiles(folder, capsys, data, said):
    (folder / "profile.csv").write_text(data)
    study = SLOPE.replace(POINTS, 'csv = "profile.csv"')
    (folder / "slope.toml").write_text(study)
    assert said in refused(capsys, "runout", "slope.toml", *OUT["runout"])


@pytest.mark.parametrize("command", OUT)
@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("a\0b", "null character"),
        ("folder", "cannot be read: Is a directory"),
        ("/dev/zero", "/dev/zero: is a device"),
        ("none\x1b[31m", "none\\x1b[31m: cannot be read"),
        ("loop", "cannot be read: Too many levels of symbolic links"),
        ("pipe", "pipe: is a pipe that nobody writes to; a file is needed"),
        ("x" * 5_000, "cannot be read: File name too long"),
    ],
)
def test_what_is_no_file(folder, capsys, command, path, said):
    (folder / "folder").mkdir()
    (folder / "loop").symlink_to("loop")
    os.mkfifo("pipe")
    assert said in refused(capsys, command, path, *OUT[command])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["simulate", "s.toml", "--plot", "a\0.png"], "null character"),
        (["simulate", "s.toml", "--bogus\x1b[31m"], "--bogus\\x1b[31m"),
        (["sweep", "--set", "\x1b[2J"], "\\x1b[2J is no parametric set"),
        (["predict", "x" * 5_000, "tests.csv"], "File name too long"),
        (["predict", ".", "tests.csv", "--out", "p.parquet"], "must end in .csv, but"),
    ],
)
def test_malformed_arguments(folder, capsys, arguments, said):
    assert said in refused(capsys, *arguments)


BLOCK, SOIL, IMPACT = Block(), Soil(), Impact()
PROFILE = Profile([0.0, 200.0], [100.0, 0.0])
RELEASE = Release(BLOCK, 2.0, 110.0)
GOOD = {"e_n": [0.2, 0.3], "mass_kg": [100, 110], "angle_deg": [10, 20]}
MASKED = np.ma.array([1.0, 2.0], mask=[False, True])


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: Block(mass="500"), "Block.mass must be a number.* is '500' .str"),
        (lambda: Block(mass=None), "Block.mass must be a number.* is None"),
        (lambda: Block(mass=True), "Block.mass must be a number.* is True .bool"),
        (lambda: Block(mass=[1, "2"]), "Block.mass must be a number"),
        (lambda: Block(mass=[[1], [2, 3]]), "Block.mass must be a number"),
        (lambda: Block(mass=10**400), "Block.mass must be .* too large"),
        (lambda: Block(mass=jnp.array([True])), "Block.mass must be a number"),
        (lambda: Block(mass=MASKED), "must be numbers, but value 1 is masked"),
        (lambda: Block(mass=pd.array(["1"])), "Block.mass must be a number"),
        (lambda: simulate(SOIL, BLOCK, IMPACT), "block must be of type Block"),
        (lambda: simulate(3), "block must be of type Block, but is 3"),
        (lambda: simulate(Scene(), SOIL), "a scene holds its soil and its impact"),
        (lambda: Soil(flow=3), "flow must be of a class derived from AbstractFlow"),
        (lambda: Soil(flow="Perzina"), "flow 'Perzina' is unknown; .* mean Perzyna"),
        (lambda: Block(shape=Ellipsoid), r"is the class Ellipsoid; write Ell"),
        (lambda: simulate(BLOCK, SOIL, IMPACT, accuracy=[]), "accuracy must be one of"),
        (lambda: simulate(Block(mass=-1), SOIL, IMPACT), "must be above 0 kg"),
        (
            lambda: simulate(Scene(impact=Impact(speed=np.nan))),
            "speed must be finite and",
        ),
        (lambda: simulate(Scene(), accuracy="balancd"), r"did you mean balanced\?"),
        (lambda: simulate(BLOCK, SOIL, Impact(angle=40)), "40 deg is 0.6981 rad"),
        (lambda: Accuracy("mine", np.nan, 0.01), "tolerance of an accuracy must be"),
        (
            lambda: simulate_batch(Scene(Block(mass=[1, 2]), Soil(k_E=[1, 2, 3]))),
            r"have shapes \(2,\), \(3,\)",
        ),
        (lambda: sweep(Scene(), [1]), "axes must be of type Mapping"),
        (lambda: sweep(Scene(), {"angle_deg": ["1"]}), "angle_deg must be a number"),
        (lambda: sweep(Scene(), {"angle_deg": MASKED}), "value 1 is masked"),
        (
            lambda: sweep(
                Scene(), dict.fromkeys(["k_E", "c_v", "psi"], np.ones(10**6))
            ),
            "10{18} points would take .* GiB of memory",
        ),
        (lambda: elasticities(Scene(), outputs=3), "outputs must be a list of names"),
        (lambda: sobol(Scene(), None), "ranges must be of type Mapping"),
        (
            lambda: sobol(Scene(), {"c_v": (1, 2), "k_E": (1, 2)}, blocks=2**52),
            "impacts, would take",
        ),
        (lambda: Profile([0, 1j], [1, 0]), "a profile's x must be a number"),
        (lambda: Profile([0, 1], [1, 0], soil=3), "soil must be of type Soil"),
        (lambda: Ground("soil"), "soil must be of type Soil"),
        (lambda: Ground(seed=1.5), "seed must be a whole number"),
        (lambda: Ground(rolling_friction_angle=20), "deg. 20 deg is 0.3491 rad"),
        (lambda: Release("block", 0, 0), "block must be of type Block"),
        (lambda: Release(BLOCK, "2", 0), "a release's x must be a number"),
        (lambda: ClosedForm(0.3), "law must be a law of rebound"),
        (lambda: FullModel("quick"), "accuracy must be one of"),
        (lambda: simulate_runout(None, RELEASE), "profile must be of type Profile"),
        (lambda: simulate_runout(PROFILE, RELEASE, 3), "must be a law of contacts"),
        (lambda: simulate_runout(PROFILE, RELEASE, event_limit=0), "be at least 1"),
        (lambda: draw({"a": Uniform(0, 1)}, 10**18, 0), "10{18} blocks would take"),
        (lambda: draw({"a": None}, 3, 0), "a must be a number"),
        (lambda: calibrate(GOOD, fit=3), "fit must be of type Iterable"),
        (lambda: calibrate(GOOD, fit={"c_v": 3}), "fit of c_v must be of type Mapping"),
        (lambda: calibrate(GOOD, ground=3), "ground must be of type Soil or Mapping"),
    ],
)
def test_wrong_values_in_python(call, said):
    with pytest.raises(InputError, match=said) as caught:
        call()
    assert_one_line(caught.value)


def test_unknown_fields_name_the_nearest():
    with pytest.raises(TypeError, match="no parameter 'mas'; did you mean mass"):
        Block(mas=3.0)


@pytest.mark.parametrize(
    "value",
    [2, np.float32(2), [2.0], pd.Series([2], dtype="Int64"), range(2, 3)],
)
def test_whatever_is_a_number_is_taken(value):
    assert np.all(np.asarray(Block(mass=value).mass) == 2.0)


FRAME = pd.DataFrame(GOOD | {"name": ["a", "b"]})


@pytest.mark.parametrize(
    "frame",
    [
        FRAME,
        FRAME.set_index("name"),
        FRAME.set_index(["mass_kg", "name"]),
        FRAME.set_index(pd.Index([7, 8], name="other")),
        FRAME.astype({"mass_kg": "category", "name": "category"}),
        FRAME.astype({"mass_kg": "Int64", "e_n": "Float64"}),
        FRAME.astype(object),
    ],
)
def test_frames_of_every_kind_hold_the_same_tests(frame):
    table = table_given(frame)
    assert table.labels["name"] == ["a", "b"]
    for name, values in GOOD.items():
        np.testing.assert_array_equal(table.numbers[name], values)


@pytest.mark.parametrize(
    ("tests", "said"),
    [
        (pd.concat([FRAME, FRAME[["e_n"]]], axis=1), "column e_n: stands twice"),
        (FRAME.set_index("name", drop=False), "column name: stands twice"),
        (FRAME.T.set_index([[1, 2, 3, 4]]).T, "columns must be named by a text each"),
        (GOOD | {"mass_kg": MASKED}, "row 3, column mass_kg: is empty"),
        (GOOD | {"mass_kg": [True, 1]}, "must be a number, but is 'True'"),
        (GOOD | {"mass_kg": [10**400, 1]}, "must be finite and above 0 kg, but is 100"),
        (GOOD | {"name": ["\ud800", "b"]}, "is not text in UTF-8"),
        (GOOD | {"e_n": [0.1, 1e308]}, "row 3, column e_n: must be from 1e-30"),
        (GOOD | {"sigma_e_n": [0.1, 1e-308]}, "sigma_e_n: must be from 1e-30 to 1e+30"),
        (GOOD | {"e_n": [-9999, 0.2]}, "e_n: is -9999, a mark for no data; leave"),
        ({}, "hold no column"),
    ],
)
def test_tests_that_cannot_be_read(tests, said):
    with pytest.raises(InputError) as caught:
        table_given(tests)
    assert_one_line(caught.value, said)


def test_masked_measurements_are_empty():
    table = table_given(GOOD | {"e_n": np.ma.array([0.2, 0.3], mask=[True, False])})
    np.testing.assert_array_equal(table.numbers["e_n"], [np.nan, 0.3])


@pytest.mark.parametrize(
    ("name", "values", "said"),
    [
        ("e_n", ["-99.0", 0.2], "row 2, column e_n: is -99; if that is a mark for no"),
        ("e_n", [-99, -999], "row 2, column e_n: is -99 and 1 more rows; if that"),
        ("max_penetration_m", [0.1, -99], "row 3, column max_penetration_m: is -99;"),
        ("v_t_mps", [3.0, -999.0], "row 3, column v_t_mps: is -999; .*cell empty$"),
        ("v_t_mps", [3.0, -99.0], None),
        ("e_n", [-0.99, 0.2], None),
        ("max_normal_force_N", [-999.0, 1e4], None),
        ("tangential_impulse_Ns", [-999.0, 1e3], None),
        ("omega_radps", [-99.0, -999.0], None),
        ("angular_velocity_degps", [-99.0, -999.0], None),
        (
            "angular_velocity_degps",
            [9.0, -9999.0],
            "row 3, column angular_velocity_degps: is -9999; .*write the true value$",
        ),
        ("delta_1", [-99.0, 0.0], "row 2, column delta_1: is -99; if that is a mark"),
        ("delta_2", [0.0, -999.0], "row 3, column delta_2: is -999; if that is a mark"),
        ("orientation_deg", [-99.0, 0.0], None),
        ("orientation_deg", [0.0, -999.0], "row 3, .* is -999 deg; usual are -360 to"),
    ],
)
def test_values_that_may_be_marks_for_no_data_are_warned_of(name, values, said):
    """Where the value cannot be so large: a force or a spin may."""
    with warned_once(UnusualValueWarning, said):
        table_given(GOOD | {name: values})


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_files_warn_of_marks_for_no_data(tmp_path, suffix):
    path = tmp_path / f"tests.{suffix}"
    frame = FRAME.assign(e_n=[0.1, -999.0])
    frame.to_parquet(path) if suffix == "parquet" else frame.to_csv(path, index=False)
    with warned_once(UnusualValueWarning, f"{path.name}, row 3, column e_n: is -999;"):
        read_table(path, measured=True)


UNUSUAL = "jaximpact.errors.UnusualValueWarning"


@pytest.mark.filterwarnings(f"always::{UNUSUAL}")
@pytest.mark.parametrize(
    ("scene", "said"),
    [
        (Scene(impact=Impact(orientation=30)), "1719 deg.*30 deg is 0.5236 rad"),
        (Scene(impact=Impact(angular_velocity=2e3)), "2000 deg/s is 34.91 rad/s"),
        (Scene(Block(density=2.58)), "2.58 g/cm3 is 2580 kg/m3"),
        (Scene(Block(density=2577800)), "g/m3 is 2578 kg/m3"),
        (Scene(Block(mass=1e9)), "usual are 1e-06 to 1e[+]08 kg"),
        (Scene(soil=Soil(unit_weight=18)), "18 N/m3 = 0.018 kN/m3.*is 1.8e[+]04 N/m3"),
        (Scene(soil=Soil(k_E=5e7)), "Soil.k_E is 5e[+]07; usual are 1 to 1e[+]06$"),
        (Scene(Block(density=np.full(9, 2.58))), r"\(scene 0 and 8 more\)"),
    ],
)
def test_unusual_values_are_warned_of_once(scene, said):
    with pytest.warns(UnusualValueWarning, match=said) as caught:
        simulate_batch(scene, accuracy="fast")
    assert len(caught) == 1
    assert caught[0].filename == __file__


@pytest.mark.slow
@pytest.mark.filterwarnings(f"always::{UNUSUAL}")
@pytest.mark.parametrize(
    ("command", "name", "text", "said"),
    [
        ("simulate", "s.toml", "density_kgm3 = 2.58", "key density_kgm3: is 2.58"),
        (
            "batch",
            "s.csv",
            "mass_kg,friction_angle_deg\n1,30\n1,0.5236\n1,0.5236\n",
            "s.csv, row 3, column friction_angle_deg: is 0.5236 deg and 1 more rows; "
            "usual are 2 to 60 deg; rad? 0.5236 rad is 30 deg",
        ),
        (
            "sweep",
            "s.toml",
            "[axes]\nfriction_angle_deg = [0.4, 0.52]",
            "s.toml, key axes.friction_angle_deg: is 0.4 deg; usual are 2 to 60 deg; "
            "rad? 0.4 rad is 22.92 deg",
        ),
    ],
)
def test_commands_warn_of_unusual_values_in_one_line(
    folder, capsys, command, name, text, said
):
    (folder / name).write_text(text)
    assert main([command, name, "--accuracy", "fast", *OUT[command]]) == 0
    err = capsys.readouterr().err
    assert err.count("warning") == 1
    assert said in err


@pytest.mark.parametrize(
    "error", [InputError("x", row=2), UnusualValueWarning("x", "y")]
)
def test_errors_are_pickled(error):
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a\nb\x1b[0m\u202e\ud800", "a\\nb\\x1b[0m\\u202e\\ud800"),
        ("Böschung 30° ☺", "Böschung 30° ☺"),
        ("x" * 10_000, "x" * 300 + " ... " + "x" * 300),
    ],
)
def test_what_is_shown_of_a_text(text, expected):
    assert shown(text) == expected


def test_the_nearest_name_of_an_endless_one_is_found_at_once():
    known = ["mass_kg", "k_E"]
    assert did_you_mean("mass" + "x" * 10_000_000, known) == "known are mass_kg, k_E"


@pytest.mark.parametrize(
    ("name", "known", "words"),
    [
        ("c_w", ["c_v", "k_E"], "did you mean c_v?"),
        ("VOLUME", ["volume_m3", "mass_kg"], "did you mean volume_m3?"),
        ("ground", ["impact", "soil", "friction_angle_deg"], "did you mean soil?"),
        ("min", ["median", "least", "most"], "did you mean least?"),
        ("min", ["prior", "lower", "upper"], "did you mean lower?"),
        ("Sphere", ["EllipticCylinder", "Ellipsoid"], "did you mean Ellipsoid?"),
        ("Rn", ["bearing", "mass_kg"], "known are bearing, mass_kg"),
        ("flow", map(str, range(40)), "none of the 40 known names is like it"),
    ],
)
def test_what_may_have_been_meant(name, known, words):
    assert did_you_mean(name, known) == words


def test_a_pipe_is_read(folder):
    """As `<(...)` of a shell gives it; its writer may still have nothing to say."""
    reading, writing = os.pipe()
    later = threading.Timer(0.1, lambda: (os.write(writing, b"abc"), os.close(writing)))
    later.start()
    assert read_input(f"/dev/fd/{reading}") == b"abc"
    later.join()
    os.close(reading)


@pytest.mark.parametrize(
    "tree", [[], {"format": 2, "manifest": 3}, {"format": 2, "variants": [[]]}, 10**400]
)
def test_a_damaged_fit_is_refused(folder, capsys, tree):
    (folder / "fit.json").write_text(json.dumps(tree))
    (folder / "tests.csv").write_text(TESTS)
    assert "fit.json" in refused(capsys, "predict", "fit.json", "tests.csv")
    (folder / "slope.toml").write_text(SLOPE + '[ground]\nfrom = "fit.json"\n')
    assert "fit.json" in refused(capsys, "runout", "slope.toml", "--out", "out")
