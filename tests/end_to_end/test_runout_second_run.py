"""The second run of elongated blocks, by the other kinematics, and the ledger of
impacts that says why it is there."""

import dataclasses
import json
import re

import jax
import numpy as np
import pytest
import xarray as xr
from slope_study import slope_text
from text_files import rows_of

from jaximpact import Block, Impact, Soil, simulate
from jaximpact.accuracy import get_accuracy
from jaximpact.batch import broadcast_scene, compute_part, summary_of
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.io.toml import Key
from jaximpact.laws import DeepestPoint, WorkConjugate
from jaximpact.runout import (
    Profile,
    Release,
    read_slope_study,
    run_slope_study,
    simulate_runout,
)
from jaximpact.runout.study.ground_file import GroundInput
from jaximpact.runout.study.intervals import is_apart
from jaximpact.runout.study.report_page import slope_report
from jaximpact.runout.study.results import PREFIX
from jaximpact.runout.study.run_study import simulate as simulate_blocks
from jaximpact.runout.study.second_run import (
    LEFT_OUT,
    OTHER_LAW,
    ROUND,
    differences,
)
from jaximpact.scene import Scene

pytestmark = pytest.mark.slow

TOP = "count = 40\nseed = 3\naccuracy = 'fast'\ncollectors_m = [60]"
NET = "[[barriers]]\nname = 'net'\nx_m = 60\nheight_m = 1\ncapacity_kJ = 20"
MIXED = "mass_kg = { mean = 100, sd = 20, least = 20 }\naspect_ratio = [1, 2]"


def study_of(folder, ground="", block=MIXED, contacts="law = 'full model'", top=TOP):
    path = folder / "slope.toml"
    path.write_text(
        slope_text(top, ground=ground, block=block, contacts=contacts) + f"\n{NET}\n"
    )
    return read_slope_study(path)


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """A study of spheres and ellipsoids, and what it gives."""
    study = study_of(tmp_path_factory.mktemp("both"))
    return study, run_slope_study(study)


@pytest.mark.parametrize("shape", ["Ellipsoid", "RectangularPrism"])
def test_arm_work_kept_alone_is_that_of_the_ledger(shape):
    """Everything else has the same bits. The two integrate the same power over the same
    steps, one of fourth and one of sixth order; over a level face the arm jumps from
    one end to the other, which only the ledger sees at its place."""
    random, count = np.random.default_rng(5), 200
    block = Block(
        mass=random.uniform(50, 3000, count),
        aspect_ratio=random.uniform(1, 3, count),
        shape=shape,
    )
    impact = Impact(
        speed=random.uniform(2, 40, count),
        angle=random.uniform(0, 1.3, count),
        orientation=random.uniform(0, 3.1, count),
        angular_velocity=random.uniform(-10, 10, count),
        slope=random.uniform(0, 0.6, count),
    )
    scene, _ = broadcast_scene(Scene(block, Soil(), impact))
    whole, alone = (
        summary_of(compute_part(scene, count, get_accuracy("balanced"), items), items)
        for items in (True, "arm")
    )
    assert whole.energy is not None
    assert alone.energy is not None
    arm, energy = whole.energy.arm, whole.energy.kinetic_in
    assert np.mean(np.abs(arm) / energy) > 0.02  # else there is nothing to compare
    error = np.abs(alone.energy.arm - arm) / energy
    assert np.median(error) < 1e-6
    assert np.max(error) < (1e-4 if shape == "Ellipsoid" else 0.03)
    without = [dataclasses.replace(of, energy=None) for of in (whole, alone)]
    for one, other in zip(*map(jax.tree.leaves, without), strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_run_keeps_the_arm_work_of_its_impacts():
    slope = Profile([0.0, 60.0, 100.0], [50.0, 5.0, 5.0])
    block = Block(mass=200.0, aspect_ratio=2.0)
    runs = simulate_runout(slope, Release(block, x=2.0, y=55.0, orientation=0.4))
    contact = jax.tree.map(lambda column: column[0], runs.contacts)
    impact = Impact(
        speed=np.hypot(
            contact.normal_velocity_before, contact.tangential_velocity_before
        ),
        angle=np.arctan2(
            contact.tangential_velocity_before, contact.normal_velocity_before
        ),
        orientation=contact.orientation,
        angular_velocity=contact.angular_velocity_before,
        slope=contact.slope,
    )
    energy = jax.tree.map(float, simulate(block, Soil(), impact).energy)
    ledger = runs.impact_energies()
    assert ledger.energy[0] == pytest.approx(energy.kinetic_in, rel=1e-12)
    # By two quadratures of the same steps, an error of 1e-5 of the energy.
    assert contact.arm_work == pytest.approx(energy.arm, abs=1e-5 * energy.kinetic_in)
    assert abs(energy.arm) > 0.01 * energy.kinetic_in
    assert "arm work" in repr(runs)


def test_gains_and_high_coefficients_are_counted():
    """Of a run whose contacts were changed by hand."""
    slope = Profile([0.0, 60.0, 100.0], [50.0, 5.0, 5.0])
    release = Release(Block(mass=200.0), x=2.0, y=[55.0, 58.0])
    runs = simulate_runout(slope, release)
    before = runs.impact_energies()
    assert not np.any(before.gain > 0.0)
    contacts = runs.contacts
    second = np.flatnonzero(contacts.trajectory == 1)[0]
    faster = contacts.normal_velocity.copy()
    faster[second] = -3.0 * contacts.normal_velocity_before[second]
    runs = dataclasses.replace(runs, contacts=contacts._replace(normal_velocity=faster))
    sums = [ledger.sums(2) for ledger in (before, runs.impact_energies())]
    for name in ("impacts_of_high_e_n", "impacts_that_gain"):
        np.testing.assert_array_equal(sums[1][name] - sums[0][name], [0, 1])


def test_the_second_run_is_the_run_by_the_other_kinematics(both, tmp_path):
    """A study by that kinematics gives the same bits, in turn; spheres have the same by
    either."""
    _, dataset = both
    other = run_slope_study(study_of(tmp_path, "[ground]\nkinematics='DeepestPoint'"))
    kinematics = [json.loads(d.attrs["kinematics"]) for d in (dataset, other)]
    assert kinematics == ["WorkConjugate", "DeepestPoint"]
    assert json.loads(dataset.attrs["second_run"])["kinematics"] == "DeepestPoint"
    names = [n for n in map(str, dataset) if n.startswith(PREFIX)]
    assert len(names) > 20
    for name in names:
        first = name.removeprefix(PREFIX)
        np.testing.assert_array_equal(dataset[name].values, other[first].values)
        np.testing.assert_array_equal(other[name].values, dataset[first].values)
        if dataset[name].dims == ("block",):
            # The even blocks are spheres.
            pairs = dataset[name].values[::2], dataset[first].values[::2]
            np.testing.assert_array_equal(*pairs)
    assert np.any(dataset.x_m.values[1::2] != other.x_m.values[1::2])
    assert dataset.arm_work_given_J.values.sum() == 0.0
    assert other.arm_work_given_J.values[1::2].sum() > 0.0


@pytest.mark.parametrize(
    ("ground", "contacts", "block", "reason"),
    [
        ("", "law = 'full model'", "mass_kg = [80, 90]", ROUND),
        ("", "law = 'constant coefficients'\ne_n = 0.3\ne_t = 0.8", MIXED, OTHER_LAW),
    ],
)
def test_no_second_run_where_it_would_say_nothing(
    tmp_path, ground, contacts, block, reason
):
    top = "count = 4\ncollectors_m = [60]"
    dataset = run_slope_study(study_of(tmp_path, ground, block, contacts, top))
    assert json.loads(dataset.attrs["second_run"]) == reason
    assert not any(str(name).startswith(PREFIX) for name in dataset)


def test_a_round_block_comes_to_the_same_by_either_kinematics():
    soils = Soil(), Soil(kinematics=WorkConjugate())
    release = Release(Block(mass=200.0), x=2.0, y=[55.0, 58.0], angular_velocity=3.0)
    one, other = (
        simulate_runout(Profile([0.0, 60.0, 100.0], [50.0, 5.0, 5.0], soil), release)
        for soil in soils
    )
    for column, same in zip(one.contacts, other.contacts, strict=True):
        np.testing.assert_array_equal(column, same)


def test_the_kinematics_of_a_run_out(tmp_path):
    """By default the one without arm work; that of impacts beside tables, which were
    made with it; else what the file says."""
    assert isinstance(study_of(tmp_path).ground.soil.kinematics, WorkConjugate)
    named = study_of(tmp_path, "[ground]\nkinematics = 'DeepestPoint'")
    assert isinstance(named.ground.soil.kinematics, DeepestPoint)
    beside_tables = {"contacts": [{"law": "full model"}, {"law": "table"}]}
    soil = GroundInput.read(Key(tmp_path / "slope.toml"), beside_tables).soil
    assert isinstance(soil.kinematics, DeepestPoint)
    assert isinstance(Soil().kinematics, DeepestPoint)


def test_numbers_that_differ_are_marked_wherever_they_stand(folder, capsys):
    """In the table of the barriers, and in the manifest as sentences."""
    study_of(folder)
    assert main(["runout", "slope.toml", "--out", "out"]) == 0
    assert "- by DeepestPoint" in capsys.readouterr().out
    dataset = xr.open_dataset("out/blocks.nc")
    second = json.loads(dataset.attrs["second_run"])
    manifest = json.loads((folder / "out/manifest.json").read_text())
    assert manifest["second_run"] == second
    rows = rows_of(folder / "out/barriers.csv")
    assert all(row["second_run_value"] for row in rows)
    marked = [r for r in rows if r["second_run_differs"]]
    (net,) = manifest["barriers"]
    assert net["differs"] == [row["quantity"] for row in marked]
    assert net["second_run"].keys() == net["estimates"].keys()
    for row in rows:
        ends = [
            tuple(float(row[f"{run}{end}"] or "nan") for end in ("low", "high"))
            for run in ("", "second_run_")
        ]
        assert (row in marked) == is_apart(*ends)


def test_inputs_in_the_report_are_no_results(both):
    study, dataset = both
    page = slope_report(study, dataset, simulate_blocks(study, np.arange(3))).page()
    start = page.index("Blocks and releases")
    inputs = page[start : page.index("Ground along the profile", start)]
    cells = re.findall(r"<td[^>]*>([\w ]+)<", inputs)
    assert {"mass_kg", "aspect_ratio", "release_y_m"} <= {*cells}
    assert not [cell for cell in cells if cell.startswith((PREFIX, "max_", "impacts"))]


def test_stops_that_differ_in_national_coordinates(both):
    """Of many blocks, those of a study over again, for intervals with two ends."""
    dataset = both[1].isel(block=np.arange(400) % 40)
    far = dataset.assign(
        x_m=dataset.x_m + 2.6e6,
        **{f"{PREFIX}x_m": dataset[f"{PREFIX}x_m"] + 2600200.0},
    )
    (line,) = (text for text in differences(far) if "95 % of the blocks stop" in text)
    place = r"2600\d\d\d(\.\d)?"
    pattern = rf"stopped: {place} m \({place} to {place}\), but {place} m \({place} to"
    assert re.search(pattern, line)


def test_stops_far_to_the_left_are_compared(both):
    """Where the near ends of the two runs are the same, and the far ends are not."""
    dataset = both[1].isel(block=np.arange(400) % 40)
    near = -np.linspace(10.0, 50.0, 400)
    farther = np.where(near < np.median(near), near - 30.0, near)
    stopped = np.full(400, "stopped", object)
    columns = {"x_m": near, f"{PREFIX}x_m": farther}
    columns |= {"ending": stopped, f"{PREFIX}ending": stopped}
    left = dataset.assign({name: ("block", of) for name, of in columns.items()})
    lines = [text for text in differences(left) if text.startswith("x ")]
    assert [line.split(":")[0] for line in lines] == [
        f"x beyond which {percent} % of the blocks stopped" for percent in (95, 99)
    ]


def test_the_second_run_can_be_left_out(folder, capsys):
    study_of(folder, top="count = 6\naccuracy = 'fast'\ncollectors_m = [60]")
    assert main(["runout", "slope.toml", "--out", "out", "--no-second-run"]) == 0
    printed = capsys.readouterr()
    assert "by DeepestPoint" not in printed.out
    assert f"No second run: {LEFT_OUT}." in printed.out
    assert "6 of 6 blocks (100 %)" in printed.err


def test_an_interrupted_second_run_goes_on(both, tmp_path):
    study, whole = both

    def interrupt(done, total):
        assert total == 60  # of 40 blocks 20 are run again
        if done > 40:
            raise KeyboardInterrupt

    journal = tmp_path / "blocks.journal"
    with pytest.raises(KeyboardInterrupt):
        run_slope_study(study, journal=journal, progress=interrupt)
    with pytest.raises(InputError):
        run_slope_study(study, journal=journal, second_run=False)
    told = []
    again = run_slope_study(
        study, journal=journal, progress=lambda done, total: told.append(done)
    )
    assert min(told) >= 40
    xr.testing.assert_identical(again, whole)


def test_a_kinematics_of_ones_own_has_the_conjugate_one_beside_it(folder):
    """With a random parameter, which the other does not have."""
    (folder / "between.py").write_text(
        "from jaximpact.laws import AbstractKinematics, Scalar, parameter\n"
        "class Between(AbstractKinematics):\n"
        "    share: Scalar = parameter(0.5, '-', '[0, 1]', 'share of the arm')\n"
        "    def sinking_arm(self, foundation):\n"
        "        low, middle = foundation.tangency_arm, foundation.tangential_arm\n"
        "        return middle + self.share * (low - middle)\n"
    )
    ground = "[ground]\nkinematics = 'between.py:Between'\nshare = { from = 0, to = 1 }"
    top = "count = 4\naccuracy = 'fast'\ncollectors_m = [60]"
    dataset = run_slope_study(study_of(folder, ground, top=top))
    second = json.loads(dataset.attrs["second_run"])["kinematics"]
    assert second == "WorkConjugate"
    assert dataset.arm_work_given_J.values.sum() > 0.0
    assert dataset[f"{PREFIX}arm_work_given_J"].values.sum() == 0.0


@pytest.mark.parametrize(
    ("one", "other", "apart"),
    [
        ((1.0, 2.0), (3.0, 4.0), True),
        ((3.0, 4.0), (1.0, 2.0), True),
        ((1.0, 3.0), (2.0, 4.0), False),
        ((1.0, 2.0), (2.0, 3.0), False),
        ((1.0, np.nan), (3.0, 4.0), False),
        ((np.nan, 2.0), (3.0, np.nan), True),
    ],
)
def test_intervals_are_apart_where_they_are_known_not_to_overlap(one, other, apart):
    assert is_apart(one, other) == apart
