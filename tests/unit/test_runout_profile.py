"""Profiles, from arrays and from files, and those that are refused."""

import numpy as np
import pytest
from error_messages import warned_once
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.path import Path
from paths import ROOT
from slope_study import slope_text

from jaximpact import Block, Soil
from jaximpact.errors import InputError, UnusualValueWarning
from jaximpact.runout import Profile, Release, read_profile, read_slope_study
from jaximpact.runout.flight.placement import check_release
from jaximpact.runout.study.drawing import _draw_ground, drawn_grounds
from jaximpact.runout.trajectory_drawing import bottom_of


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
        (
            ([0.0, 5e-324, 9.0], [9, 5, 0]),
            r"goes from 0 to 4.940656458e-324 at point 2",
        ),
        (([0.0, 5.0], [-9999.0] * 2), "y of point 1 is -9999, a mark for no data"),
        (([0.0, 1.0], [0.0, np.nan]), "y of point 2 must be finite, but is nan"),
        (([0.0, 1e9], [0.0, 1.0]), "x of point 2 must be within 1e[+]08 m of 0"),
        (
            ([0, 1], [0, 0], Soil(), -0.1),
            r"in \[0, 90\) deg, but is -0.1 rad .* segment 1",
        ),
        (
            ([0, 1, 2], [0, 0, 0], Soil(), 0.1, [0.1, np.nan]),
            r"roughness_deg must be in \[0, 30\] deg, but is nan .*on segment 2",
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
    with pytest.raises(ValueError, match=rf"{said}[^\n]*$"):
        Profile(*arguments)


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


def test_empty_columns_of_a_file_are_passed_over(tmp_path):
    """As Excel writes them, also before others."""
    path = tmp_path / "slope.csv"
    path.write_text("x_m,, y_m, ,\n0,,9,,\n\n 4,,0, ,\n,,,,\n")
    profile = read_profile(path)
    np.testing.assert_array_equal([profile.x, profile.y], [[0.0, 4.0], [9.0, 0.0]])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is empty"),
        ("x_m,y_m\n", "needs at least two points"),
        ("x_m\n0\n1\n", "row 1: needs a column y_m"),
        ("x_m,y_m,gama_v\n0,0,1\n1,0,1\n", "column gama_v: .* did you mean gamma_v"),
        ("x_m,x_m,y_m\n0,0,0\n", "stands twice"),
        ("x_m,y_m,\n0,0,\n1,0,5\n", "row 1, column 3: has no name"),
        (
            "x_m;y_m\n0;0\n1;0\n",
            "row 1: columns are separated by .;.; separate them by ','",
        ),
        ("x_m\ty_m\n0\t0\n", "row 1: columns are separated by tabs; separ"),
        ("x_m,y_m\n0,0\n1\n", "row 3: has 1 cells, but the header has 2"),
        ("x_m,y_m\n0,0\n1,low\n", "row 3, column y_m: must be a number, but is 'low'"),
        ("x_m,y_m\n0,0\n1,nan\n", "row 3, column y_m: must be finite, but is nan"),
        ("x_m,y_m\n0,9\n\n9,-32768\n20,0\n", "row 4, column y_m: is -32768 among 0"),
        ("x_m,y_m\n0,9\n9,1e20\n", "row 3, column y_m: must be within 1e[+]08 m"),
        ("x_m,y_m\n0,9\n-9999,5\n9,0\n", "row 3, column x_m: is -9999 among 0 to 9"),
        ("x_m,y_m\n1,0\n0,0\n", "x goes from 1 to 0"),
        ("x_m,y_m\n1,0\n", "at least two points, but got 1"),
        (
            "x_m,y_m,k_E\n0,0,-1\n1,0,1\n",
            "row 2, column k_E: must be above 0, but is -1",
        ),
    ],
)
def test_a_bad_file_is_refused_in_a_line(tmp_path, text, said):
    path = tmp_path / "slope.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=rf"slope.csv.*{said}[^\n]*$"):
        read_profile(path)


GROUND_IN_PA = """x_m,y_m,cohesion_kPa,c_v
0,230,20,0.5

200,115,20000,0.5
400,0,30000,0.5
1000,0,90000,5000
"""
"""Cohesion in Pa on two of three segments; the ground of the last point is not used."""


def test_ground_in_another_unit_is_warned_of_where_a_study_reads_it(folder):
    csv, study = folder / "p.csv", folder / "slope.toml"
    csv.write_text(GROUND_IN_PA)
    study.write_text(slope_text(profile='csv = "p.csv"'))
    said = r"p.csv, row 4, column cohesion_kPa: is 20000 kPa and 1 more rows; .*Pa\?"
    with warned_once(UnusualValueWarning, said):
        read_slope_study(study)
    # `simulate_runout` warns of what is read in Python.
    with warned_once(UnusualValueWarning, None):
        read_profile(csv)


@pytest.mark.parametrize(
    ("heights", "said"),
    [
        (("1.120", "998", "950"), "row 2, column y_m: is 1.12 m; .* write 1120$"),
        (("998", "1.009", "940.5"), None),  # digits that are no thousands
        (("30.125", "12", "0"), None),
        (("1.125", "0.998", "0"), None),
        (("1120.000", "998", "950"), None),
        (("1.120", "1.098", "1.050"), None),  # a small slope, as far as anyone knows
        (("998", "950", "900"), None),
    ],
)
def test_heights_with_points_that_separate_thousands_are_warned_of(
    tmp_path, heights, said
):
    rows = [f"{100 * i},{y}" for i, y in enumerate(heights)]
    path = tmp_path / "p.csv"
    path.write_text("\n".join(["x_m,y_m", *rows]))
    with warned_once(UnusualValueWarning, said):
        read_profile(path)


def test_the_measured_profile_of_the_repository_is_a_study():
    profile = read_slope_study(ROOT / "slopes/wallace-creek/study.toml").profile
    np.testing.assert_array_equal(profile.x, np.arange(0.0, 977.0, 2.0))
    # The wall that its SOURCE.md names.
    assert profile.height(252.0) - profile.height(294.0) == pytest.approx(21.95)


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
    everywhere = {"k_E": np.ones(3, bool)}
    drawn = drawn_grounds(profile, ("scree", "meadow", ""), everywhere)
    assert drawn.number == [0, 1, 2]
    assert drawn.words == ["scree", "meadow", "one ground"]
    assert drawn_grounds(profile, (), everywhere).words == ["one ground"]
    assert drawn_grounds(profile, ("scree", "meadow", "scree")).words == [
        "scree, k_E = 900",
        "meadow, k_E = 500",
    ]


@pytest.mark.parametrize("segments", [3, 24])
def test_grounds_are_drawn_apart_where_a_quantity_is_random_on_some(segments):
    """One by one, and in classes of many."""
    c_v = np.linspace(0.4, 0.9, segments)
    profile = Profile(np.arange(segments + 1.0), np.zeros(segments + 1), Soil(c_v=c_v))
    first = {"c_v": np.arange(segments) < 1}
    drawn = drawn_grounds(profile, (), first)
    words = [drawn.words[number] for number in drawn.number]
    assert words[0] == "c_v random"
    assert words.count("c_v random") == 1
    assert words[-1] == ("c_v = 0.9" if segments == 3 else "c_v = 0.804 to 0.9")
    assert len(set(drawn.colours)) == len(drawn.colours) == len(set(words))


def test_the_ground_is_drawn_by_few_artists_that_fill_all_segments():
    """One for each colour: one for each segment took 2 ms, and 10 s for 4000."""
    profile = Profile(
        np.arange(25.0), 0.1 * np.arange(25) ** 2, Soil(c_v=[0.5, 0.5, 0.9, 0.7] * 6)
    )
    drawn = drawn_grounds(profile)
    axes = Figure().subplots()
    _draw_ground(axes, profile, drawn)
    assert len(axes.collections) == len(drawn.colours) == 3
    below = [(x, profile.height(x) - 0.01) for x in np.arange(0.5, 24.0)]
    above = [(x, profile.height(x) + 0.01) for x in np.arange(0.5, 24.0)]
    for ground, filled in enumerate(axes.collections):
        assert to_hex(filled.get_facecolor()[0]) == drawn.colours[ground]
        shape = Path.make_compound_path(*filled.get_paths())
        inside = shape.contains_points(below).tolist()
        assert inside == [number == ground for number in drawn.number]
        assert not np.any(shape.contains_points(above))
    low, high = axes.get_ylim()
    assert low < bottom_of(profile) < profile.y.max() < high


def test_many_grounds_without_known_differences_have_one_colour():
    profile = Profile(np.arange(11.0), np.zeros(11), Soil(c_v=0.5))
    materials = [f"m{i}" for i in range(10)]
    for random in ({}, {"c_v": np.arange(10) < 5}, {"c_v": np.ones(10, bool)}):
        drawn = drawn_grounds(profile, materials, random)
        assert drawn.words == ["10 grounds without known differences"]
        assert drawn.number == [0] * 10
        assert len(drawn.colours) == 1


X, Y = np.array([0.0, 100.0, 200.0, 400.0, 1000.0]), np.array([230.0, 170, 115, 0, 0])


@pytest.mark.parametrize("base", [0.0, 1700.0])
@pytest.mark.parametrize("place", [0, 2, 4])
@pytest.mark.parametrize(
    "mark",
    [
        *(-9999, -99999, -32768, -32767, -999, 9999, 99999, 32767, 65535),
        *(1e20, 3.4e38, -3.4028235e38, -1.7976931348623157e308, np.nan, np.inf),
    ],
)
def test_marks_of_no_data_are_no_heights(base, place, mark):
    y = Y + base
    y[place] = mark
    with pytest.raises(ValueError, match=rf"y of point {place + 1} .* without data"):
        Profile(X, y)


FEET = 1.0 / 0.3048


@pytest.mark.parametrize(
    ("x", "y", "said"),
    [
        (X + 2_600_000.0, Y + 4000.0, None),  # a national grid, high up
        (X + 32_500_000.0, Y + 8600.0, None),  # with the number of the zone
        (X, Y - 999.0, None),  # the foot at -999 in a local system
        (X, Y - 430.0, None),  # at the Dead Sea
        ([9990.0, 9999.0, 10010.0], [9.0, 5.0, 0.0], None),
        ([0.0, 150.0, 300.0, 900.0], [1100.0, 500.0, 100.0, 0.0], None),  # El Capitan
        ([0.0, 10.0, 10.01, 40.0], [30.0, 30.0, 0.0, 0.0], None),  # a wall
        ([-1e5, 1e5], [0.0, 0.0], None),  # a plane without end
        ([0.0, 6.0], [2.0, 0.0], None),
        (7.65 + X / 78e3, 46.0 + Y / 111e3, "smaller than any .* degrees of longitude"),
        (7.65 + X / 78e3, Y + 1700.0, "steeper than any slope; is x in degrees or kil"),
        (X / 1e3, Y / 1e3, "1 m long and 0.23 m high, smaller than any slope; kilomet"),
        (X, Y * 1e3, "steeper than any slope; is y in millimetres"),
        (X * 1e3, Y * 1e3, "are millimetres, it is 1000 m long and 230 m high"),
        (2 * X * FEET, Y * FEET, "are feet, it is 2000 m long and 230 m high"),
        (
            X * FEET,
            (Y + 2800.0) * FEET,
            "above all mountains; .* are feet, it is 1000 m",
        ),
        (X, np.where(X == 200.0, 0.0, Y + 1700.0), "1870 m to 0 m .* at point 3, more"),
        (X + 1.06e6, Y + 5.8e6, "above all mountains; is y a northing"),
        (X - 7.4e5, Y - 1.04e6, "below all mountains; is y a northing"),
        (X * 1e2, Y, "1e[+]05 m long and 230 m high, while usual are up to 5000 and"),
    ],
)
def test_slopes_that_are_none_on_earth_are_warned_of(x, y, said):
    with warned_once(UnusualValueWarning, said):
        Profile(x, y)


def test_a_block_far_above_the_ground_is_warned_of():
    profile = Profile(X, Y)
    with pytest.warns(UnusualValueWarning, match="block 1 is released 2770 m above"):
        check_release(Release(Block(), 100.0, [180.0, 2940.0]), profile)


def test_coordinates_must_resolve_the_block():
    profile = Profile(X + 9e7, Y)
    pebble, rock = (Block(mass=mass) for mass in (0.001, 1.0))
    check_release(Release(rock, 9e7 + 100.0, 180.0), profile)
    with pytest.raises(ValueError, match=r"block 0, .* coordinates of 9.0001e[+]07 m"):
        check_release(Release(pebble, 9e7 + 100.0, 180.0), profile)
    with pytest.raises(ValueError, match=r"release's y must be within 1e[+]08 of 0"):
        Release(rock, 100.0, 1e16)


def test_the_row_of_x_that_does_not_increase_is_named(tmp_path):
    path = tmp_path / "profile.csv"
    path.write_text("x_m,y_m\n0,50\n\n60,20\n60,10\n90,0\n")
    with pytest.raises(InputError, match=r"row 5: .* x goes from 60 to 60 at point 3"):
        read_profile(path)
