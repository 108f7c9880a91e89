"""Laws of one's own, of the soil and of rebound, down a slope and in tables."""

import json
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax.scipy.special import erf
from own_laws import FLOW
from runout_scenes import FLAT
from slope_study import assert_refused, slope_text
from text_files import write_changed

from jaximpact import Block, Impact, Soil, read_netcdf
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.lookup import Tabulated, read_table
from jaximpact.parameters import parameter
from jaximpact.rebound import AbstractRebound, Rebound
from jaximpact.runout import (
    ClosedForm,
    FullModel,
    Ground,
    Profile,
    Release,
    read_profile,
    read_slope_study,
    simulate_runout,
)
from jaximpact.shapes import EllipticCylinder, RectangularPrism

pytestmark = pytest.mark.slow

REBOUND = """
import jax
import jax.numpy as jnp

from jaximpact.parameters import parameter
from jaximpact.rebound import AbstractRebound, Rebound


class Fading(AbstractRebound):
    e_slow: object = parameter(0.5, "-", "[0, 1]", "restitution at no speed")
    half_speed: object = parameter(10.0, "m/s", "(0, inf)", "at which it is half")

    def __call__(self, block, impact):
        e_n = self.e_slow / (1.0 + impact.normal_velocity / self.half_speed)
        return Rebound(
            -e_n * impact.normal_velocity,
            0.8 * impact.tangential_velocity,
            impact.angular_velocity,
        )
"""
SLOPE = slope_text(
    top="seed = 1\ncount = 12",
    profile="points_m = [[0, 40], [50, 10], [150, 10]]",
    ground="""
[ground]
flow = "../my_laws.py:Creeping"
my_rate = { mean = 8.7, sd = 1, least = 5 }
my_creep_share = 0.1

[ground.segment.2]
my_creep_share = 0.5
""",
    block="""
shape = ["Ellipsoid", "RectangularPrism"]
corner_radius_ratio = [0.4, 0.6]
""",
    release="x_m = 5",
    contacts='law = "../my_rebound.py:Fading"\nhalf_speed = 5',
)


@pytest.fixture
def study(folder):
    """The file of a study in a directory of its own, the laws beside that."""
    (folder / "my_laws.py").write_text(FLOW)
    (folder / "my_rebound.py").write_text(REBOUND)
    (folder / "studies").mkdir()
    path = folder / "studies" / "slope.toml"
    path.write_text(SLOPE)
    return path


def test_a_study_with_laws_of_ones_own(study, capsys):
    assert main(["runout", str(study), "--out", "out"]) == 0
    capsys.readouterr()
    found = read_netcdf("out/blocks.nc")
    assert found.attrs["contacts"]
    contacts, laws = (json.loads(found.attrs[n]) for n in ("contacts", "laws"))
    assert contacts["law"] == "Fading"
    assert contacts["half_speed"] == 5.0
    assert contacts["e_slow"] == 0.5
    assert "my_rebound.Fading (" in contacts["class"]
    assert laws["flow"].startswith("my_laws.Creeping (")
    assert set(found["shape"].values) == {"Ellipsoid", "RectangularPrism"}
    assert found.ground_my_rate.attrs["units"] == "m/s"
    assert np.ptp(found.ground_my_rate.values) > 0.1
    assert {"my_rebound.py", "slope.toml"} <= set(json.loads(found.attrs["files"]))

    read = read_slope_study(study)
    np.testing.assert_allclose(read.profile.soil.my_creep, [0.1, 0.5])
    assert read.ground.soil.my_rate.shape == (12, 1)
    assert type(read.release.block.shape).__name__ == "MixedShapes"
    # Every shape with every radius, the radius fastest.
    np.testing.assert_array_equal(read.release.block.shape.index[:4], [0, 0, 1, 1])
    np.testing.assert_allclose(
        read.release.block.corner_radius_ratio[:4], [0.4, 0.6, 0.4, 0.6]
    )


def test_a_soil_law_of_ones_own_is_heeded(study):
    """With the parameters that make it the usual one, and with others."""
    law = "my_rate = { mean = 8.7, sd = 1, least = 5 }\nmy_creep_share = 0.1"
    shapes = '["Ellipsoid", "RectangularPrism"]\ncorner_radius_ratio = [0.4, 0.6]'
    plain = (
        ('[contacts]\nlaw = "../my_rebound.py:Fading"\nhalf_speed = 5\n', ""),
        ("[ground.segment.2]\nmy_creep_share = 0.5\n", ""),
        (f"shape = {shapes}\n", "aspect_ratio = 1.5\n"),
        ("count = 12", "count = 2"),
    )

    def runs_at(rate, usual=False):
        write_changed(study, SLOPE, *plain, (law, f"my_rate = {rate}"))
        own = read_slope_study(study, "fast")
        profile = own.profile
        if usual:
            soil = Soil(kinematics="WorkConjugate")
            profile = Profile(profile.x, profile.y, soil)
        contacts = FullModel("fast")
        return simulate_runout(profile, own.release, contacts, time_limit=3.0).contacts

    own, same, other = runs_at(8.7), runs_at(8.7, usual=True), runs_at(2.0)
    np.testing.assert_allclose(own.x[:2], same.x[:2], rtol=1e-9)
    velocity = same.normal_velocity[0]
    # A law that may flow below yield takes other steps: errors at `fast` are 1e-4.
    assert own.normal_velocity[0] == pytest.approx(velocity, rel=1e-4)
    assert abs(other.normal_velocity[0] - velocity) > 0


def test_columns_of_a_profile_are_those_of_its_laws(study):
    soil = read_slope_study(study).profile.soil
    soil = Soil(flow=type(soil.flow)())
    csv = study.parent / "profile.csv"
    csv.write_text("x_m,y_m,my_rate\n0,10,3\n20,5,4\n40,0,9\n")
    np.testing.assert_array_equal(read_profile(csv, soil).soil.my_rate, [3.0, 4.0])
    with pytest.raises(InputError, match="column my_rate: is unknown"):
        read_profile(csv)
    csv.write_text("x_m,y_m,flow\n0,10,Perzyna\n20,5,Perzyna\n")
    with pytest.raises(InputError, match="one flow for all its segments"):
        read_profile(csv, soil)
    with pytest.raises(InputError, match="my_rate must be at least 0 m/s"):
        Ground(Soil(flow=type(soil.flow)(my_rate=-1.0)))


@pytest.mark.parametrize(
    ("message", "old", "new"),
    [
        ("ground.flow ... no class Fast", "my_laws.py:Creeping", "my_laws.py:Fast"),
        ("ground.flow ... other.py ... cannot be read", "my_laws.py", "other.py"),
        ("flow ... did you mean Perzyna", "../my_laws.py:Creeping", "Perzina"),
        ("segment.2.flow ... for all", "my_creep_share = 0.5", 'flow = "Perzyna"'),
        (
            "segment.2.my_creep_share ... in [0, 1]",
            "my_creep_share = 0.5",
            "my_creep_share = 1.5",
        ),
        ("ground.gamma_v ... is unknown", "my_rate =", "gamma_v ="),
        ("block.shape ... 'Cube' is unknown", "RectangularPrism", "Cube"),
        ("block.shape ... twice", '"Ellipsoid", ', '"RectangularPrism", '),
        ("list of names", '["Ellipsoid", "RectangularPrism"]', "[1]"),
        ("corner_radius_ratio", '["Ellipsoid", "RectangularPrism"]', '"Ellipsoid"'),
        ("corner_radius_ratio ... in (0, 1]", "[0.4, 0.6]", "[0.4, 1.6]"),
        ("contacts.law ... no class jnp", "rebound.py:Fading", "rebound.py:jnp"),
        ("half_sped ... half_speed", "half_speed = 5", "half_sped = 5"),
        ("contacts.half_speed ... above 0", "half_speed = 5", "half_speed = -5"),
        ("contacts.e_slow ... in [0, 1]", "half_speed = 5", "e_slow = 2"),
    ],
)
def test_bad_laws_are_refused_in_one_line(study, capsys, message, old, new):
    write_changed(study, SLOPE, (old, new))
    assert_refused(capsys, f"slope.toml ... {message}", study)


class ByErrorFunction(AbstractRebound):
    """An operation without machine code."""

    e_slow: object = parameter(0.5, "-", "[0, 1]", "restitution at no speed")

    def __call__(self, block, impact):
        e_n = self.e_slow * (1.0 - 0.5 * erf(impact.normal_velocity))
        return Rebound(
            -e_n * impact.normal_velocity, 0.8 * impact.tangential_velocity, 0.0
        )


FALLING = Release(Block(), [10.0, 20.0], [3.0, 2.0])


def test_laws_without_machine_code_are_computed_by_xla():
    with pytest.warns(UserWarning, match="no machine code"):
        runs = simulate_runout(FLAT, FALLING, ClosedForm(ByErrorFunction()))
    before = runs.contacts.normal_velocity_before[0]
    assert runs.contacts.normal_velocity[0] == pytest.approx(
        -0.5 * before * (1.0 - 0.5 * math.erf(before))
    )


class WithNumPy(AbstractRebound):
    def __call__(self, block, impact):
        return Rebound(-0.5 * np.asarray(impact.normal_velocity), 0.0, 0.0)


class OfTwo(AbstractRebound):
    def __call__(self, block, impact):
        return -0.5 * impact.normal_velocity, impact.tangential_velocity


class OfVectors(AbstractRebound):
    def __call__(self, block, impact):
        return Rebound(jnp.zeros(2), 0.0, 0.0)


class OfABlockAlone(AbstractRebound):
    def __call__(self, block):
        return Rebound(0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (OfABlockAlone(), "OfABlockAlone cannot be computed: TypeError.* an impact"),
        (WithNumPy(), "WithNumPy .* jnp in place of np"),
        (OfTwo(), r"OfTwo must return Rebound\(.*three scalars"),
        (OfVectors(), r"OfVectors must return Rebound\(.*\(2,\)"),
    ],
)
def test_what_a_law_does_wrong_is_said_with_the_cure(law, words):
    with pytest.raises(InputError, match=words):
        simulate_runout(FLAT, FALLING, ClosedForm(law))


def test_a_class_in_place_of_a_law_is_refused():
    with pytest.raises(InputError, match=r"write ByErrorFunction\(...\)"):
        ClosedForm(ByErrorFunction)


TABLE = """
[block]
shape = "RectangularPrism"
corner_radius_ratio = 1

[ground]
flow = "my_laws.py:Creeping"
my_rate = 6

[table]
total_speeds_mps = [2, 20]
nodes = { speed = 2, elevation = 2, azimuth = 3, orientation = 4 }
"""


def test_tables_of_laws_and_shapes(folder, capsys):
    (folder / "my_laws.py").write_text(FLOW)
    (folder / "table.toml").write_text(TABLE)
    assert main(["tabulate", "table.toml", "--out", "table.nc"]) == 0
    assert "shape RectangularPrism" in capsys.readouterr().out
    table = read_table(folder / "table.nc")
    assert isinstance(table.block.shape, RectangularPrism)
    assert float(table.soil.my_rate) == 6.0
    # However round, a prism has orientations.
    assert table.outcomes.shape == (2, 2, 3, 4, 1)
    contacts = Tabulated(table)
    impact = jax.tree.map(
        lambda value: np.full(1, value), Impact(speed=10.0, angle=0.1)
    )
    blows = contacts(table.block, table.soil, impact)
    assert np.isfinite(blows.response.normal_velocity[0])
    for block, soil in (
        (Block(), table.soil),
        (table.block, Soil(gamma_v=6.0)),
        (Block(shape=EllipticCylinder()), table.soil),
    ):
        with pytest.raises(InputError, match=r"no table was made for"):
            contacts(block, soil, impact)
    block, level = Release(Block(), [0.0], [9.0]).block, np.zeros((1, 1))
    problem = contacts.problem_with(block, table.soil, level, level)
    assert "shape is jaximpact.shapes.elliptic.Ellipsoid" in problem
    (folder / "my_laws.py").write_text(FLOW.replace("0.0, b", "0.1, b"))
    with pytest.raises(InputError, match=r"was made with flow .* tabulate again"):
        read_table(folder / "table.nc")
    (folder / "my_laws.py").unlink()
    with pytest.raises(InputError, match="cannot be had"):
        read_table(folder / "table.nc")
