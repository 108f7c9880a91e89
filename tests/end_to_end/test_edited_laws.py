"""A law that was edited is another law, in every process and in notebooks."""

import csv
import os
import subprocess
import sys

import pytest

from jaximpact import Block, Soil, simulate

pytestmark = pytest.mark.slow

LAW = """from constants import FACTOR

from jaximpact.laws import AbstractFlow, Scalar, displacement_rates
from jaximpact.laws import overstress, parameter


class ScaledFlow(AbstractFlow):
    \"\"\"Flow by the overstress, scaled by a number from another file.\"\"\"

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


def test_a_constant_of_another_file(tmp_path):
    (tmp_path / "scenes.csv").write_text(
        "flow,speed_mps\nmy_laws.py:ScaledFlow,14\nmy_laws.py:ScaledFlow,12\n"
    )
    names = set()
    for factor in FACTORS:
        write(tmp_path, factor)
        out = tmp_path / f"r{factor}.csv"
        command = ["batch", "scenes.csv", "--out", out.name]
        python(tmp_path, "-m", "jaximpact", *command)
        with open(out, encoding="utf-8") as file:
            row = next(csv.DictReader(file))
        assert float(row["e_n"]) == pytest.approx(e_n_of(factor), abs=1e-9)
        names |= {path.read_text() for path in tmp_path.glob("r*.json")}
    assert all(f"FACTOR={factor}" in "".join(names) for factor in FACTORS)


SESSION = """
import pathlib, sys
from IPython.core.interactiveshell import InteractiveShell

shell = InteractiveShell.instance()


def cell(text):
    shell.run_cell(text, store_history=True).raise_error()


cell("import jax; jax.config.update('jax_enable_x64', True)")
cell("from jaximpact import Block, Impact, Soil, simulate, simulate_batch")
"""
RELOADED = """
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
OF_A_CELL = """
cell(LAW.replace("from constants import FACTOR", "FACTOR = 1.0"))
cell("soil = Soil(flow=ScaledFlow())")
for factor in ("1.0", "0.1"):
    cell(f"FACTOR = {factor}")
    cell("print(float(simulate(Block(), soil, Impact(speed=14.0)).e_n))")
    cell("print(float(simulate_batch(Block(), soil, Impact(speed=14.0)).e_n[0]))")
    cell("value = jax.jit(lambda v: simulate(Block(), soil, Impact(speed=v)).e_n)")
    cell("print(float(value(14.0)))")
"""


@pytest.mark.parametrize("session", [RELOADED, OF_A_CELL], ids=["file", "cell"])
def test_a_notebook_in_which_a_law_is_edited(tmp_path, session):
    write(tmp_path, "1.0")
    text = LAW.replace("from constants import FACTOR", "FACTOR = 1.0")
    (tmp_path / "my_laws.py").write_text(text)
    program = f"LAW = {LAW!r}\n{SESSION}{session}"
    found = [float(line) for line in python(tmp_path, "-c", program).split()]
    expected = [e_n_of(factor) for factor in FACTORS for _ in range(3)]
    assert found == pytest.approx(expected, abs=1e-9)
