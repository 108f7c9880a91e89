"""A default stands in one place, or is the same in all of them."""

import inspect
import re

import numpy as np
import pytest

from jaximpact.calibration.problem.config import ACCURACY, STARTS
from jaximpact.cli import calibrate, options, runout, tabulate
from jaximpact.lookup import Nodes
from jaximpact.lookup.tabulation import SPEEDS
from jaximpact.runout import Ground, Profile, read_profile, simulate_runout
from jaximpact.runout.study.slope_file import DEFAULT_BINS, DEFAULT_COUNT
from jaximpact.runout.terrain import ANGLE_COLUMNS


def default(function, name):
    return inspect.signature(function).parameters[name].default


def test_a_ground_is_as_rough_and_rolls_as_a_profile_does():
    profile = Profile([0.0, 1.0], [1.0, 0.0])
    for column in ANGLE_COLUMNS.values():
        if column.part == "ground":
            expected = column.factor * column.default
            assert getattr(Ground(), column.field) == expected
            assert np.all(getattr(profile, column.field) == expected)
            assert default(read_profile, column.field) == expected


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (runout.STUDY, f"count blocks (default: {DEFAULT_COUNT},"),
        (runout.STUDY, f"for the envelopes (default: {DEFAULT_BINS})"),
        (
            runout.STUDY,
            f"(defaults: {default(simulate_runout, 'time_limit'):g} and "
            f"{default(simulate_runout, 'event_limit')})",
        ),
        (
            runout.STUDY,
            "rolling_friction_angle_deg is "
            f"{ANGLE_COLUMNS['rolling_friction_angle_deg'].default:g}, an assumption, "
            f"and roughness_deg {ANGLE_COLUMNS['roughness_deg'].default:g}",
        ),
        (runout.STUDY, "seed of the random numbers (default: 0)"),
        (calibrate.DESCRIPTION, f"random numbers (default: {STARTS}, 0)"),
        (calibrate.DESCRIPTION, f"reference (default: {ACCURACY})"),
        (tabulate.DESCRIPTION, f"total_speeds_mps = {[0.1, 120]}"),
        (
            tabulate.DESCRIPTION,
            "nodes = { "
            + ", ".join(
                f"{name} = {count}" for name, count in Nodes()._asdict().items()
            ),
        ),
        (options.input_help(""), "out_of_plane_ratio - 1 above 0 out-of-plane over"),
    ],
)
def test_help_says_the_defaults(text, said):
    assert said in re.sub(r"\s+", " ", text)


def test_the_speeds_of_a_table_that_help_shows_are_the_default():
    assert SPEEDS == (0.1, 120.0)
