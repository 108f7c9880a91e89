"""Profiles, from arrays and from files, and those that are refused."""

import numpy as np
import pytest

from jaximpact import Soil
from jaximpact.errors import InputError
from jaximpact.runout import Profile, read_profile
from jaximpact.runout.study.drawing import drawn_grounds


def test_segments_descend_and_rise():
    profile = Profile([0.0, 3.0, 4.0], [4.0, 0.0, 1.0], Soil(gamma_v=[8.7, 1.7]), 0.2)
    assert profile.segments == 2
    np.testing.assert_allclose(profile.length, [5.0, np.sqrt(2.0)])
    np.testing.assert_allclose(np.tan(profile.slope), [4.0 / 3.0, -1.0])
    np.testing.assert_allclose(profile.height([-1.0, 1.5, 3.5]), [4.0, 2.0, 0.5])
    np.testing.assert_allclose(profile.rolling_friction_angle, [0.2, 0.2])
    np.testing.assert_allclose(profile.soil.gamma_v, [8.7, 1.7])
    np.testing.assert_allclose(profile.soil.k_E, [900.0] * 2)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (([0.0], [0.0]), "a profile needs at least two points, but got 1"),
        (([0.0, 1.0], [0.0]), "needs as many y as x"),
        (([0.0, 2.0, 1.0], [0.0] * 3), "x goes from 2 to 1 at point 3"),
        (([0.0, 0.0], [0.0, 1.0]), "x goes from 0 to 0 at point 2; a wall"),
        (([0.0, 0.0], [1.0, 1.0]), "at point 2, which is the point before once more"),
        (([0.0, 1.0], [0.0, np.nan]), "point 2 has none"),
        (
            ([0, 1], [0, 0], Soil(), np.radians(-6.0)),
            r"rolling_friction_angle must be in \[0, 90\) deg, but is -6 on segment 1",
        ),
        (
            ([0, 1, 2], [0, 0, 0], Soil(), 0.1, [0.1, np.nan]),
            r"roughness must be in \[0, 30\] deg, but is nan on segment 2",
        ),
        (([0, 1], [0, 0], Soil(), [0.1, 0.1]), "takes one rolling_friction_angle"),
        (([0, 1], [0, 0], Soil(c_v=[1.0, 2.0])), "takes one Soil.c_v or as many"),
        (
            ([0, 1, 2], [0, 0, 0], Soil(friction_angle=[0.5, 2.0])),
            r"friction_angle_deg must be in \(0, 60\) deg, but is 2 rad = 114.6 deg on "
            r"segment 2; deg\?",
        ),
    ],
)
def test_what_is_no_profile_is_refused_in_a_line(arguments, said):
    with pytest.raises(ValueError, match=said) as error:
        Profile(*arguments)
    assert "\n" not in str(error.value)


def test_a_file_gives_points_and_ground(tmp_path):
    path = tmp_path / "slope.csv"
    path.write_text(
        "x_m, y_m, gamma_v, friction_angle_deg, rolling_friction_angle_deg\n"
        "0, 230, 8.7, 30, 25\n\n400, 0, 1.7, 35, 20\n1000, 0, 1, 1, 1\n"
    )
    profile = read_profile(path, Soil(c_v=0.5))
    np.testing.assert_allclose(profile.x, [0.0, 400.0, 1000.0])
    np.testing.assert_allclose(profile.y, [230.0, 0.0, 0.0])
    np.testing.assert_allclose(profile.soil.gamma_v, [8.7, 1.7])
    np.testing.assert_allclose(profile.soil.c_v, [0.5, 0.5])
    np.testing.assert_allclose(np.degrees(profile.soil.friction_angle), [30.0, 35.0])
    np.testing.assert_allclose(np.degrees(profile.rolling_friction_angle), [25.0, 20.0])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is empty"),
        ("x_m,y_m\n", "needs at least two points"),
        ("x_m\n0\n1\n", "row 1: needs a column y_m"),
        ("x_m,y_m,gama_v\n0,0,1\n1,0,1\n", "column gama_v: .* did you mean gamma_v"),
        ("x_m,x_m,y_m\n0,0,0\n", "stands twice"),
        ("x_m;y_m\n0;0\n1;0\n", "row 1: needs commas .* but has semicolons"),
        ("x_m\ty_m\n0\t0\n", "row 1: needs commas .* but has tabs"),
        ("x_m,y_m\n0,0\n1\n", "row 3: has 1 cells, but the header has 2"),
        ("x_m,y_m\n0,0\n1,low\n", "row 3, column y_m: must be a number, but is 'low'"),
        ("x_m,y_m\n0,0\n1,nan\n", "point 2 has none"),
        ("x_m,y_m\n1,0\n0,0\n", "x goes from 1 to 0"),
        ("x_m,y_m,k_E\n0,0,-1\n1,0,1\n", "k_E must be above 0, but is -1 on segment 1"),
    ],
)
def test_a_bad_file_is_refused_in_a_line(tmp_path, text, said):
    path = tmp_path / "slope.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=said) as error:
        read_profile(path)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_file_is_refused_in_a_line(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_profile(tmp_path / "none.csv")


def test_a_few_grounds_are_drawn_one_by_one_and_many_in_classes():
    few = drawn_grounds(Profile([0, 1, 2, 3], [3, 2, 1, 0], Soil(c_v=[0.5, 1.0, 0.5])))
    assert few.number == [0, 1, 0]
    assert few.words == ["c_v = 0.5", "c_v = 1"]
    c_v = np.linspace(0.4, 0.9, 24)
    soil = Soil(c_v=c_v, k_E=np.linspace(900.0, 905.0, 24))
    many = drawn_grounds(Profile(np.arange(25.0), np.zeros(25), soil))
    # By c_v, which varies more than k_E, in fifths of its range.
    assert many.words[0] == "c_v = 0.4 to 0.5"
    assert many.words[-1] == "c_v = 0.8 to 0.9"
    assert len(set(many.colours)) == len(many.words) == 5
    assert many.number == sorted(many.number)
    expected = np.minimum((c_v - 0.4) / 0.1, 4.0).astype(int)
    np.testing.assert_array_equal(many.number, expected)


def test_grounds_are_named_by_material_and_by_what_is_alike_for_all_blocks():
    profile = Profile([0, 1, 2, 3], [3, 2, 1, 0], Soil(c_v=0.5, k_E=[900, 500, 900]))
    drawn = drawn_grounds(profile, ("scree", "meadow", ""), {"k_E"})
    assert drawn.number == [0, 1, 2]
    assert drawn.words == ["scree", "meadow", "one ground"]
    assert drawn_grounds(profile, (), {"k_E"}).words == ["one ground"]
    assert drawn_grounds(profile, ("scree", "meadow", "scree")).words == [
        "scree, k_E = 900",
        "meadow, k_E = 500",
    ]
