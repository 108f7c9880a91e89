"""A study's contact law chosen by the error that its file allows."""

import numpy as np
import pytest
from error_messages import assert_one_line_error
from text_files import write_changed

from jaximpact import ConstantCoefficients, read_netcdf
from jaximpact.cli import main
from jaximpact.errors import InputError
from jaximpact.runout import (
    ClosedForm,
    FullModel,
    choose_contacts,
    read_slope_studies,
    read_slope_study,
    run_slope_study,
    simulate_runout,
)

pytestmark = pytest.mark.slow

SLOPE = """
count = 40
seed = 7
contact_error = 3

[profile]
points_m = [[0, 50], [50, 20], [80, 0], [200, 0]]

[block]
mass_kg = { mean = 100, sd = 30, least = 20 }

[release]
x_m = { from = 2, to = 6 }
clearance_m = 0.5
speed_mps = 5

[[contacts]]
law = "constant coefficients"
name = "low"
e_n = 0.1
e_t = 0.8

[[contacts]]
law = "constant coefficients"
name = "high"
e_n = 0.9
e_t = 0.8
"""


@pytest.fixture
def path(folder):
    (folder / "slope.toml").write_text(SLOPE)
    return folder / "slope.toml"


def error_of(study, law):
    """The 99 % error of a law, on the impacts of a run with the full model."""
    errors = []

    def both(block, soil, impact):
        found = FullModel()(block, soil, impact)
        other = ClosedForm(law)(block, soil, impact)
        radius = np.cbrt(block.mass / (4.0 / 3.0 * np.pi * block.density))
        changes = [
            abs(a - b) * unit
            for a, b, unit in zip(
                found.response[:3], other.response[:3], (1.0, 1.0, radius), strict=True
            )
        ]
        before = np.hypot(impact.speed, impact.angular_velocity * radius)
        errors.append(np.max(changes, axis=0) / before)
        return found

    simulate_runout(study.profile, study.release, both, ground=study.ground)
    return np.quantile(np.concatenate(errors), 0.99, method="higher")


def test_the_quickest_law_within_the_error_is_chosen(path):
    studies = read_slope_studies(path)
    assert [study.law_name for study in studies] == ["low", "high", "full model"]
    expected = {
        name: error_of(studies[0], ConstantCoefficients(e_n, 0.8))
        for name, e_n in (("low", 0.1), ("high", 0.9))
    }
    best = min(expected, key=expected.get)
    chosen = choose_contacts(studies)
    assert chosen.law_name == best
    told = chosen.law["errors of 99 % of the pilot impacts"]
    # Three digits are told.
    for name, error in expected.items():
        assert f"{name} {error:.3g}" in told
    assert "full model 0" in told
    just_below = 0.999 * expected[best]
    write_changed(path, SLOPE, ("error = 3", f"error = {just_below}"))
    assert choose_contacts(read_slope_studies(path)).law_name == "full model"


def test_the_command_uses_the_law_chosen_and_says_so(path, capsys):
    out = path.parent / "out"
    assert main(["runout", str(path), "--out", str(out)]) == 0
    said = capsys.readouterr()
    assert "chosen by contact_error" in said.err
    assert "chosen for an error of 3" in said.out
    found = read_netcdf(out / "blocks.nc")
    chosen = choose_contacts(read_slope_studies(path))
    same = run_slope_study(chosen)
    np.testing.assert_array_equal(found.x_m.values, same.x_m.values)


@pytest.mark.parametrize(
    ("old", "new", "parts"),
    [
        ("error = 3", "error = -1", ("contact_error", "must be at least 0")),
        ("error = 3", 'error = "low"', ("contact_error", "must be a number")),
        ("error = 3", "eror = 3", ("contact_eror", "contact_error")),
    ],
)
def test_a_bad_error_is_refused_in_a_line(path, old, new, parts, capsys):
    write_changed(path, SLOPE, (f"contact_{old}", f"contact_{new}"))
    assert main(["runout", str(path), "--out", str(path.parent / "out")]) != 0
    assert_one_line_error(capsys, *parts)


def test_a_study_without_an_error_has_nothing_to_choose_by(path):
    write_changed(path, SLOPE, ("contact_error = 3\n", ""))
    studies = read_slope_studies(path)
    assert len(studies) == 2
    with pytest.raises(InputError, match="contact_error"):
        choose_contacts(studies)
    with pytest.raises(InputError, match="names 2 laws"):
        read_slope_study(path)
