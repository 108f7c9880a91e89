"""Laws and shapes by name: in scene files, tables, sweeps and sensitivities."""

import dataclasses
import json
import os
import shutil
import subprocess
import sys

import jax
import numpy as np
import pytest
import xarray as xr
from error_messages import assert_one_line, assert_one_line_error
from own_laws import write_laws
from text_files import rows_of

from jaximpact import (
    Block,
    Impact,
    Scene,
    Soil,
    elasticities,
    morris,
    read_netcdf,
    simulate,
    simulate_batch,
    sobol,
    sweep,
    write_netcdf,
)
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.io.toml import read_scene
from jaximpact.quantities import SLOTS, columns_of, shipped_parts
from jaximpact.scene_quantities import scene_of_values, scene_values
from jaximpact.sensitivity import Check
from jaximpact.shapes import RectangularPrism

pytestmark = pytest.mark.slow

SCENE = """
[soil]
flow = "my_laws.py:Creeping"
my_rate = 5
my_creep_share = 0.1
[block]
shape = "my_shapes.py:Hollow"
aspect_ratio = 2
spread = 1.5
[impact]
angle_deg = 40
"""


@pytest.fixture(scope="module")
def folder_of_laws(tmp_path_factory):
    folder = tmp_path_factory.mktemp("laws")
    write_laws(folder)
    return folder


@pytest.fixture
def laws(folder_of_laws, monkeypatch):
    """A working directory with a law and a shape of the user's, and nothing else. They
    are the same for all tests, so that each is compiled once."""
    monkeypatch.chdir(folder_of_laws)
    before = {*folder_of_laws.iterdir()}
    yield folder_of_laws
    for path in {*folder_of_laws.iterdir()} - before:
        shutil.rmtree(path) if path.is_dir() else path.unlink()


@pytest.fixture
def scene(laws):
    """The scene of `SCENE`."""
    return Scene(
        Block(shape="my_shapes.py:Hollow", aspect_ratio=2.0, spread=1.5),
        Soil(flow="my_laws.py:Creeping", my_rate=5.0, my_creep=0.1),
        Impact.from_degrees(angle=40.0),
    )


# Scene files


def test_a_scene_file_names_laws_and_shape_of_files_beside_it(laws, scene, monkeypatch):
    (laws / "scene.toml").write_text(SCENE)
    (laws / "elsewhere").mkdir()
    monkeypatch.chdir(laws / "elsewhere")
    read = read_scene(laws / "scene.toml").scene
    assert columns_of(read) == columns_of(scene)
    assert scene_values(read) == scene_values(scene)
    assert type(read.soil.flow) is type(scene.soil.flow)
    assert float(read.soil.my_creep) == 0.1


def test_a_law_of_a_module(laws, monkeypatch):
    monkeypatch.syspath_prepend(laws)
    (laws / "laws_of_mine.py").write_text((laws / "my_laws.py").read_text())
    (laws / "scene.toml").write_text('flow = "laws_of_mine:Creeping"\nmy_rate = 3\n')
    read = read_scene(laws / "scene.toml").scene
    assert type(read.soil.flow).__module__ == "laws_of_mine"
    assert scene_values(read)["flow"] == "laws_of_mine:Creeping"


def test_two_laws_replaced_together_may_take_over_a_name(laws):
    (laws / "both.py").write_text(
        (laws / "my_laws.py").read_text().replace("my_rate", "c_v")
        + """
from jaximpact.laws import AbstractHardening

class Ideal(AbstractHardening):
    def __call__(self, flow, hardening, foundation):
        return 0.0 * hardening
"""
    )
    (laws / "scene.toml").write_text(
        'flow = "both.py:Creeping"\nhardening = "both.py:Ideal"\nc_v = 3\n'
    )
    assert float(read_scene(laws / "scene.toml").scene.soil.flow.c_v) == 3.0


# Simulate


def test_simulate_takes_a_law_by_its_file(laws, scene, capsys):
    (laws / "scene.toml").write_text(SCENE)
    assert main(["simulate", "scene.toml", "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    result = simulate(scene.block, scene.soil, scene.impact)
    assert shown["e_n"] == float(result.e_n)
    manifest = shown["manifest"]
    assert manifest["laws"]["flow"].startswith("my_laws.Creeping (")
    assert manifest["scene"]["my_creep_share"] == 0.1
    assert scene_values(scene_of_values(manifest["scene"])) == manifest["scene"]
    # With the parameters of Perzyna's flow it is that flow. It may flow below yield,
    # which other steps are made for: errors at `balanced` are 1e-6.
    alike = simulate(
        scene.block, Soil(flow="my_laws.py:Creeping", my_rate=8.7), scene.impact
    )
    usual = simulate(scene.block, Soil(), scene.impact)
    assert float(alike.e_n) == pytest.approx(float(usual.e_n), rel=1e-6)


def test_help_lists_laws_shapes_and_their_quantities(capsys):
    for command in ("simulate", "batch", "sweep"):
        with pytest.raises(SystemExit):
            main([command, "--help"])
        words = capsys.readouterr().out.replace(",", " ").split()
        names = {kind.__name__ for slot in SLOTS for kind in shipped_parts(slot)}
        assert {*SLOTS, *names, "corner_radius_ratio", "1/s"} <= set(words)


# Tables

TABLE = """name,speed_mps,angle_deg,aspect_ratio,flow,my_rate,my_creep_share
a,14,0,1,my_laws.py:Creeping,8.7,0
b,10,40,2,my_laws.py:Creeping,5,0.1
"""


def test_batch_takes_a_law_by_its_file(laws, scene):
    (laws / "scenes.csv").write_text(TABLE)
    assert main(["batch", "scenes.csv", "--out", "results.csv"]) == 0
    rows = rows_of("results.csv")
    soil = Soil(flow="my_laws.py:Creeping", my_rate=[8.7, 5.0], my_creep=[0.0, 0.1])
    impact = Impact.from_degrees(speed=[14.0, 10.0], angle=[0.0, 40.0])
    expected = simulate_batch(Scene(Block(aspect_ratio=[1.0, 2.0]), soil, impact))
    assert [float(row["e_n"]) for row in rows] == expected.e_n.tolist()
    assert [row["flow"] for row in rows] == 2 * ["my_laws.py:Creeping"]
    manifest = json.loads((laws / "results.csv.manifest.json").read_text())
    assert manifest["laws"]["flow"].startswith("my_laws.Creeping (")


def test_batch_takes_what_the_table_does_not_say_from_a_scene(laws, scene):
    (laws / "scene.toml").write_text(f'accuracy = "fast"\n{SCENE}')
    (laws / "scenes.csv").write_text("speed_mps,my_rate\n14,2\n10,3\n")
    command = ["batch", "scenes.csv", "--base", "scene.toml", "--out", "results.csv"]
    assert main(command) == 0
    rows = rows_of("results.csv")
    soil = Soil(flow=scene.soil.flow, my_rate=[2.0, 3.0])
    impact = Impact.from_degrees(speed=[14.0, 10.0], angle=40.0)
    expected = simulate_batch(Scene(scene.block, soil, impact), accuracy="fast")
    assert [float(row["e_n"]) for row in rows] == expected.e_n.tolist()
    manifest = json.loads((laws / "results.csv.manifest.json").read_text())
    assert manifest["base"]["spread"] == 1.5


# Sweeps


def test_a_sweep_over_parameters_of_a_law(laws, scene, capsys):
    # What varies has no value in the scene.
    text = SCENE.replace("my_rate = 5\nmy_creep_share = 0.1\n", "")
    (laws / "study.toml").write_text(
        f"{text}\n[axes]\nmy_rate = [2, 5]\nmy_creep_share = [0.0, 0.1]\n"
    )
    assert main(["sweep", "study.toml", "--out", "sweep.nc"]) == 0
    found = read_netcdf(laws / "sweep.nc")
    axes = {"my_rate": [2.0, 5.0], "my_creep_share": [0.0, 0.1]}
    base = Scene(scene.block, Soil(flow="my_laws.py:Creeping"), scene.impact)
    xr.testing.assert_identical(found, sweep(base, axes))
    alone = simulate(scene.block, scene.soil, scene.impact)
    point = found.sel(my_rate=5.0, my_creep_share=0.1)
    assert float(point.e_n) == pytest.approx(float(alone.e_n), rel=1e-9)
    assert json.loads(found.attrs["laws"])["flow"].startswith("my_laws.Creeping (")


def test_a_sweep_over_shapes(laws, capsys):
    (laws / "study.toml").write_text(
        "aspect_ratio = 1.5\n[axes]\n"
        'shape = ["Ellipsoid", "my_shapes.py:Hollow", "RectangularPrism"]\n'
        "orientation_deg = [30, 60]\n"
        "[axes.of_shape]\nspread = [1.0, 2.0]\ncorner_radius_ratio = [0.1, 0.3]\n"
    )
    assert main(["sweep", "study.toml", "--out", "sweep.nc"]) == 0
    found = read_netcdf(laws / "sweep.nc")
    assert found["shape"].values.tolist() == ["Ellipsoid", "Hollow", "RectangularPrism"]
    assert found.e_n.shape == (3, 2, 2)
    hollow = sweep(
        Scene(Block(shape="my_shapes.py:Hollow", aspect_ratio=1.5)),
        {"orientation_deg": [30.0, 60.0], "spread": [1.0, 2.0]},
    )
    np.testing.assert_array_equal(found.e_n.sel(shape="Hollow"), hollow.e_n)
    # What a shape has no parameter for changes nothing.
    same = found.e_n.sel(shape="Ellipsoid")
    np.testing.assert_array_equal(same.isel(of_shape=0), same.isel(of_shape=1))
    write_netcdf(laws / "again.nc", found)
    xr.testing.assert_identical(read_netcdf(laws / "again.nc"), found)
    assert json.loads(found.attrs["shapes"])["Hollow"][1].startswith("my_shapes.Hollow")


def test_shapes_that_vary_with_their_parameters(laws):
    together = {
        "block": {
            "name": ["round", "edged"],
            "shape": ["Ellipsoid", RectangularPrism],
            "mass_kg": [100.0, 200.0],
        }
    }
    found = sweep(Scene(), together)
    assert found["shape"].values.tolist() == ["Ellipsoid", "RectangularPrism"]
    alone = sweep(Scene(Block(shape=RectangularPrism())), {"mass_kg": [200.0]})
    assert float(found.e_n.sel(block="edged")) == float(alone.e_n[0])


# What is refused

MINE = '[soil]\nflow = "my_laws.py:Creeping"\n'
CORNERS = "shape,corner_radius_ratio\nEllipsoid,"
REFUSED = {
    "simulate": [
        ('[soil]\nflow = "none.py:A"', "none.py: cannot be read: No such"),
        ('[soil]\nflow = "Perzina"', "key flow: flow 'Perzina' is unknown; did you"),
        ('[soil]\nflow = "no.such:Law"', "no.such cannot be imported"),
        ("[soil]\nflow = 3", "key flow: must be a text, but is 3"),
        ('[block]\nflow = "Perzyna"', "key flow: stands in [block], but belongs into"),
        ('flow = "Perzyna"\n[soil]\nflow = "Perzyna"', "key flow: stands in [soil]"),
        (MINE + "my_rat = 3", "key soil.my_rat: is unknown; did you mean my_rate?"),
        (MINE + "my_rate = -3", "must be at least 0"),
        (MINE + "gamma_v = 3", "key soil.gamma_v: is unknown; it belongs to the flow"),
        ("[block]\ncorner_radius_ratio = 0.1", 'chosen (shape = "RectangularPrism")'),
        ('[soil]\nflow = "ends.py:A"', "a shape (line 2): SystemExit (which would"),
        ('[soil]\nflow = "goes.py:A"', "a shape (line 1): GeneratorExit"),
        ('[soil]\nflow = "mute.py:A"', "a shape (line 4): E"),
        ('[soil]\nflow = "lacks.py:A"', "ModuleNotFoundError: No module named 'not_"),
        ('[soil]\nflow = "made.py:A"', "cannot be made without arguments: SystemExit"),
        ("flow = 'exits.py:Creeping'", "flow Creeping: SystemExit"),
        # No check calls the inertia of a shape.
        ("shape = 'exits_too.py:Hollow'", "exits_too.py, row 15: SystemExit"),
    ],
    "batch": [
        (
            "flow,c_v\nPerzyna,1\nFluidityRate,1\n",
            "the same law in all rows",
        ),
        ("flow\nPerzyna\n\nmy_laws.py:Creping\n", "row 4, column flow: flow 'my_laws"),
        ("shape,mass_kg\n,1\n", "row 2, column shape: is empty, but a name is needed"),
        ("shape\nEllipse\n", "row 2, column shape: shape 'Ellipse' is unknown"),
        ("my_rate\n3\n", "row 1, column my_rate: is unknown; none of the"),
        ("corner_radius_ratio\n0.1\n", "row 1, column corner_radius_ratio: is unknown"),
        (CORNERS + "0.1\nRectangularPrism,0.1\n", "row 2, column corner_radius_ratio"),
        (CORNERS + "\nRectangularPrism,\n", "row 3, column corner_radius_ratio: is em"),
        (CORNERS + "\nRectangularPrism,1.5\n", "must be in (0, 1], but is 1.5"),
        ("shape,mass_kg,k_E\nEllipsoid,\n", "row 2: has 2 cells, but the header has 3"),
    ],
    "sweep": [
        ("my_rate = [1]", "key axes.my_rate: is unknown; none of the"),
        ('shape = ["Ellipse"]', "key axes.shape: shape 'Ellipse' is unknown; did you"),
        ("shape = [1]", "key axes.shape: must be a text, but is 1"),
        ('shape = "Ellipsoid"', "axis shape must be a list of names of shapes, but"),
        ("shape = []", "axis shape must be a list of names of shapes, but is []"),
        ('flow = ["Perzyna"]', "key axes.flow: is unknown; a sweep has one flow, that"),
        ("corner_radius_ratio = [0.1]", "it belongs to the shape RectangularPrism"),
        ('shape = ["Ellipsoid"]\n[axes.g]\nshape = ["Ellipsoid"]', "already varies"),
    ],
}


@pytest.mark.parametrize(
    ("command", "text", "said"),
    [(command, *row) for command, rows in REFUSED.items() for row in rows],
)
def test_what_cannot_be_used_is_told(laws, capsys, command, text, said):
    flow, shape = ((laws / f"my_{name}.py").read_text() for name in ("laws", "shapes"))
    made = flow.replace("Creeping", "A")
    for name, content in {
        "ends": "import sys\nsys.exit()\n",
        "goes": "raise GeneratorExit\n",
        "mute": "class E(Exception):\n    __str__ = None\n\nraise E\n",
        "lacks": "import not_there\n",
        "made": made + "    def __post_init__(self):\n        raise SystemExit(0)\n",
        "exits": "import sys\n" + flow.replace("  return", "  sys.exit(),"),
        "exits_too": "import sys\n" + shape.replace("  return", "  sys.exit(),"),
    }.items():
        (laws / f"{name}.py").write_text(content)
    head = "[axes]\n" if command == "sweep" else ""
    (laws / "study").write_text(head + text)
    out = ["--out", "results.csv"] if command == "batch" else []
    assert main([command, "study", *out]) == 2
    assert_one_line_error(capsys, said)


# Sensitivity

RANGES = {"my_rate": (2.0, 9.0), "my_creep_share": (0.0, 0.2), "c_v": (0.5, 2.0)}
OUTPUTS = ["e_n", "max_penetration_m"]


def test_sensitivity_to_parameters_of_a_law(scene):
    of_scene = elasticities(scene, RANGES, OUTPUTS)
    assert np.all(of_scene.check == Check.agrees)
    assert np.all(of_scene.elasticity != 0.0)
    provenance = json.loads(of_scene.attrs["laws"])
    assert provenance["flow"].startswith("my_laws.Creeping (")
    assert provenance["shape"].startswith("my_shapes.Hollow (")
    effects = morris(scene, RANGES, OUTPUTS, trajectories=4)
    indices = sobol(scene, RANGES, OUTPUTS, blocks=8)
    assert effects.parameter.values.tolist() == [*RANGES]
    assert np.all(effects.mean_absolute_effect > 0.0)
    assert np.all(np.isfinite(indices.total_order))


def test_derivatives_by_a_parameter_of_a_law(scene):
    """In both modes, by the kernels of the elasticities above."""

    def depth(creep):
        soil = dataclasses.replace(scene.soil, my_creep=creep)
        own = Scene(scene.block, soil, scene.impact)
        return simulate(own, accuracy="reference", ledger=False).max_penetration

    # A step so long that the error of results, 1e-7, is a small part of what it does;
    # derivatives at "reference" are good to 1e-4.
    at, step = 0.1, 1e-2
    difference = (depth(at + step) - depth(at - step)) / (2.0 * step)
    forward = jax.jacfwd(depth)(at)
    np.testing.assert_allclose(forward, difference, rtol=1e-3)
    np.testing.assert_allclose(jax.grad(depth)(at), forward, rtol=1e-12)


def test_elasticities_along_shapes(laws):
    axes = {"shape": ["Ellipsoid", "RectangularPrism"]}
    base = Scene(Block(aspect_ratio=1.5), impact=Impact.from_degrees(angle=20.0))
    parameters = ["mass_kg", "corner_radius_ratio"]
    found = elasticities(base, parameters, ["e_n"], axes=axes, check=False)
    round_block = elasticities(base, ["mass_kg"], ["e_n"], check=False)
    np.testing.assert_allclose(
        found.elasticity.sel(shape="Ellipsoid", parameter="mass_kg"),
        round_block.elasticity.sel(parameter="mass_kg"),
        rtol=1e-6,
    )
    corner = found.sel(parameter="corner_radius_ratio")
    assert float(corner.derivative.sel(shape="Ellipsoid")[0]) == 0.0


def test_parameters_not_named_are_those_that_the_laws_have(scene):
    found = elasticities(scene, outputs=["e_n"], check=False)
    assert found.parameter.values.tolist() == ["c_v", "k_E"]


@pytest.mark.parametrize(
    ("parameter", "said"),
    [
        ("gamma_v", "parameter gamma_v is unknown; it belongs to the flow Perzyna"),
        ("my_rat", "parameter my_rat is unknown; did you mean my_rate?"),
        ("my_creep_share", "my_creep_share must be in [0, 1], but ranges to 2"),
    ],
)
def test_ranges_that_cannot_be_used(scene, parameter, said):
    with pytest.raises(InputError) as caught:
        morris(scene, {"c_v": (1.0, 2.0), parameter: (0.0, 2.0)}, OUTPUTS)
    assert_one_line(caught.value, said)


PROGRAM = """
import jax
jax.config.update("jax_enable_x64", True)
from jaximpact import Scene, Soil, sweep
from jaximpact.laws import Perzyna

class Mine(Perzyna):
    pass

found = sweep(Scene(soil=Soil(flow=Mine())), {"gamma_v": [3.0, 5.0]}, accuracy="fast")
again = Soil(flow="program.py:Mine")
assert type(again.flow) is Mine
print(found.attrs["laws"])
"""


def test_a_law_of_the_program_that_runs_is_found_again(folder):
    (folder / "program.py").write_text(PROGRAM)
    command = [sys.executable, "program.py"]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    (laws,) = run.stdout.splitlines()  # and not run once more
    assert json.loads(laws)["flow"].startswith("program.Mine (")


# --- a law that was edited is another law, in every process and in notebooks


LAW = """from constants import FACTOR

from jaximpact.laws import AbstractFlow, Scalar, displacement_rates
from jaximpact.laws import overstress, parameter


class ScaledFlow(AbstractFlow):
    \"\"\"Flow by the overstress, scaled by a number from another file.\"\"\"

    flows_below_yield = False
    v_ref: Scalar = parameter(8.7, "m/s", "[0, inf)", "velocity of flow at Phi = 1")

    def __call__(self, load, hardening, foundation, *, branch=None):
        phi = overstress(load.size, hardening, branch=branch)
        return displacement_rates(FACTOR * self.v_ref * phi, load, 0.0, branch=branch)
"""
FACTORS = "1.0", "0.1"


def e_n_of(factor):
    """The same by the package's law, whose fluidity is the factor times 8.7 m/s."""
    return float(simulate(Block(), Soil(gamma_v=8.7 * float(factor))).e_n)


def write(folder, factor):
    (folder / "my_laws.py").write_text(LAW)
    (folder / "constants.py").write_text(f"FACTOR = {factor}\n")


def python(folder, *arguments):
    return subprocess.run(
        [sys.executable, "-B", *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), os.getcwd()])},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    ).stdout


@pytest.fixture
def beside(tmp_path, monkeypatch):
    """A working directory whose modules this process can import, and forgets again."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    sys.modules.pop("constants", None)


def test_a_constant_of_another_file(beside):
    """First in this process, which leaves its machine code to the next one."""
    (beside / "scenes.csv").write_text(
        "flow,speed_mps\nmy_laws.py:ScaledFlow,14\nmy_laws.py:ScaledFlow,12\n"
    )
    for factor in FACTORS:
        write(beside, factor)
        command = ["batch", "scenes.csv", "--out", f"r{factor}.csv"]
        if factor == FACTORS[0]:
            assert main(command) == 0
        else:
            python(beside, "-m", "jaximpact", *command)
        row = rows_of(f"r{factor}.csv")[0]
        assert float(row["e_n"]) == pytest.approx(e_n_of(factor), abs=1e-9)
    names = {path.read_text() for path in beside.glob("r*.json")}
    assert all(f"FACTOR={factor}" in "".join(names) for factor in FACTORS)


SESSION = """
import pathlib, sys
from IPython.core.interactiveshell import InteractiveShell

shell = InteractiveShell.instance()


def cell(text):
    shell.run_cell(text, store_history=True).raise_error()


cell("import jax; jax.config.update('jax_enable_x64', True)")
cell("from jaximpact import Block, Impact, Soil, simulate, simulate_batch")

# A law of a cell, whose constant changes
cell(LAW.replace("from constants import FACTOR", "FACTOR = 1.0"))
cell("soil = Soil(flow=ScaledFlow())")
for factor in ("1.0", "0.1"):
    cell(f"FACTOR = {factor}")
    cell("print(float(simulate(Block(), soil, Impact(speed=14.0)).e_n))")
    cell("print(float(simulate_batch(Block(), soil, Impact(speed=14.0)).e_n[0]))")
    cell("value = jax.jit(lambda v: simulate(Block(), soil, Impact(speed=v)).e_n)")
    cell("print(float(value(14.0)))")

# A law of a file that is edited
cell("%load_ext autoreload")
cell("%autoreload 2")
cell("from my_laws import ScaledFlow; soil = Soil(flow=ScaledFlow())")
for factor in ("1.0", "0.1"):
    text = LAW.replace("from constants import FACTOR", f"FACTOR = {factor}")
    pathlib.Path("my_laws.py").write_text(text)
    cell("print(float(simulate(Block(), soil, Impact(speed=14.0)).e_n))")
    cell("print(float(simulate_batch(Block(), soil, Impact(speed=14.0)).e_n[0]))")
    cell("from my_laws import ScaledFlow")
    cell("print(float(simulate(Block(), Soil(flow=ScaledFlow())).e_n))")
"""


def test_a_notebook_in_which_a_law_is_edited(tmp_path):
    text = LAW.replace("from constants import FACTOR", "FACTOR = 1.0")
    (tmp_path / "my_laws.py").write_text(text)
    program = f"LAW = {LAW!r}\n{SESSION}"
    found = [float(line) for line in python(tmp_path, "-c", program).split()]
    expected = [e_n_of(factor) for factor in FACTORS for _ in range(3)]
    assert found == pytest.approx(2 * expected, abs=1e-9)
