"""Barriers and places on the map as the study's file gives them; effects of barriers;
files of maps by hand."""

import json
import sys

import numpy as np
import pandas as pd
import pyogrio.raw
import pytest
import shapely
from error_messages import warned_once

from jaximpact.errors import InputError, UnusualValueWarning
from jaximpact.io.toml import Key
from jaximpact.runout import Barrier, Profile
from jaximpact.runout.study.barriers import effects_of, read_barriers
from jaximpact.runout.study.map_files import Layer, write_geojson, write_geopackage
from jaximpact.runout.study.page_data import kept_ranks
from jaximpact.runout.study.profile_file import read_map_placement

PROFILE = Profile([0.0, 100.0, 200.0], [50.0, 0.0, 0.0])
BARRIER = {"x_m": 120, "height_m": 3, "capacity_kJ": 250.5}
PLACE = {"origin": [2600000.0, 1200000], "azimuth_deg": 30, "crs": "EPSG:2056"}
LAYER = Layer(
    name="lines",
    is_line=True,
    positions=[np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.5]]), np.zeros((0, 3))],
    properties=pd.DataFrame(
        {"block": [0, 1], "name": ['a "b"', None], "m": [np.nan, 2.0]}
    ),
)


def barriers(tmp_path, *tables):
    return read_barriers(Key(tmp_path / "slope.toml"), {"barriers": [*tables]}, PROFILE)


def test_barriers_are_read_in_si(tmp_path):
    found = barriers(tmp_path, BARRIER | {"name": "fence"}, BARRIER)
    assert found == (
        Barrier("fence", 120.0, 3.0, 250_500.0),
        Barrier("barrier at 120 m", 120.0, 3.0, 250_500.0),
    )
    assert read_barriers(Key(tmp_path), {}, PROFILE) == ()


@pytest.mark.parametrize(
    ("message", "changes"),
    [
        ("1.heigth_m: .* did you mean height_m", {"heigth_m": 3}),
        ("1.x_m: .* between the ends .* but is 0", {"x_m": 0}),
        ("1.x_m: .* between the ends", {"x_m": 200}),
        ("1.x_m: must be a number", {"x_m": "a"}),
        ("1.height_m: must be above 0", {"height_m": 0}),
        ("1.capacity_kJ: must be above 0", {"capacity_kJ": -1}),
        ("1.capacity_kJ: must be finite", {"capacity_kJ": float("nan")}),
        ("1.capacity_kJ: must be finite", {"capacity_kJ": float("inf")}),
        ("1.capacity_kJ: must be a number", {"capacity_kJ": True}),
        ("1.name: must be a text", {"name": 3}),
        ("1.name: .* is empty", {"name": " "}),
        ("1.name: must be one line", {"name": "upper\nfence"}),
        ("1.name: must be one line", {"name": "fence\n"}),
        *((f"1.{missing}: is needed", {missing: None}) for missing in BARRIER),
    ],
)
def test_bad_barriers_are_refused(tmp_path, message, changes):
    table = {k: v for k, v in (BARRIER | changes).items() if v is not None}
    with pytest.raises(InputError, match=rf"slope.toml, key barriers\.{message}"):
        barriers(tmp_path, table)


@pytest.mark.parametrize(
    ("said", "changes"),
    [
        ("height_m: is 3000, while usual are up to 50; is it in", {"height_m": 3000}),
        # As a fence of 100 kJ would be in J.
        ("capacity_kJ: is 100000, while usual are up to 50000", {"capacity_kJ": 1e5}),
        (None, {"height_m": 25, "capacity_kJ": 4e4}),
    ],
)
def test_barriers_in_another_unit_are_warned_of(tmp_path, said, changes):
    said = said and rf"slope.toml, key barriers\.1\.{said}"
    with warned_once(UnusualValueWarning, said):
        barriers(tmp_path, BARRIER | changes)


def test_names_tell_barriers_apart(tmp_path):
    with pytest.raises(InputError, match=r"barriers\.2\.name: .*stands twice"):
        barriers(tmp_path, BARRIER, BARRIER)


@pytest.mark.parametrize("value", [BARRIER, [3], "fence"])
def test_barriers_must_be_tables(tmp_path, value):
    with pytest.raises(InputError, match=r"key barriers: must be tables"):
        read_barriers(Key(tmp_path / "slope.toml"), {"barriers": value}, PROFILE)


def test_effects_at_a_barrier():
    barrier = Barrier("fence", 120.0, 3.0, 1000.0)
    heights = np.array([np.nan, 3.1, 3.0, -0.1, 0.0, 9.0])
    energies = np.array([np.nan, 10.0, 1000.0, 1001.0, 999.0, 5000.0])
    assert list(effects_of(barrier, heights, energies)) == [
        *("not reached", "passes over", "is stopped", "breaks it", "is stopped"),
        "passes over",
    ]


def test_places_on_the_map(tmp_path):
    place = read_map_placement(Key(tmp_path), {"profile": PLACE}, PROFILE)
    assert place is not None
    assert (place.crs, place.code) == ("EPSG:2056", 2056)
    easting, northing = place.coordinates(np.array([0.0, 100.0]))
    # Of 100 m in the direction N 30 E, half go to the east.
    np.testing.assert_allclose(easting, [2600000.0, 2600050.0], rtol=1e-15)
    np.testing.assert_allclose(northing, [1200000.0, 1200000 + 50 * 3**0.5])
    assert (
        read_map_placement(Key(tmp_path), {"profile": {"csv": "a.csv"}}, PROFILE)
        is None
    )
    assert read_map_placement(Key(tmp_path), {}, PROFILE) is None


@pytest.mark.parametrize(
    ("crs", "origin", "said"),
    [
        # 1 / cos(46 degrees) of the sphere, and 0.3 % less on the ellipsoid.
        ("EPSG:3857", [850_000, 5_779_900], "has lengths of 1.439 times those on"),
        ("EPSG:3395", [850_000, 5_750_000], "has lengths of 1.437 times those on"),
        ("EPSG:6933", [850_000, 5_300_000], "has lengths of 1.253 times those on"),
        ("EPSG:2056", [7.4, 46.9], "outside of the area .* and looks like degrees"),
        ("EPSG:32632", [7.4, 46.9], "EPSG:32632 .* and looks like degrees; are east"),
        ("EPSG:2056", [1_200_000, 2_600_000], "are easting and northing in this ord"),
        ("EPSG:2056", [2_600_000, 1_200_000], None),
        ("EPSG:32632", [380_000, 5_100_000], None),
        ("EPSG:32632", [130_000, 5_100_000], None),  # beside its zone
        ("EPSG:2154", [900_000, 6_500_000], None),
        ("EPSG:2193", [1_570_000, 5_180_000], None),
        ("EPSG:32760", [500_000, 5_000_000], None),  # at longitude 177
        ("EPSG:3035", [4_100_000, 2_600_000], None),
        ("EPSG:3857", [-7_910_000, 500_000], None),  # near the equator
    ],
)
def test_maps_with_other_lengths_are_warned_of(tmp_path, crs, origin, said):
    place = {"profile": PLACE | {"crs": crs, "origin": origin}}
    with warned_once(UnusualValueWarning, said):
        read_map_placement(Key(tmp_path / "slope.toml"), place, PROFILE)


def test_a_profile_far_from_its_origin_lies_where_it_lies(tmp_path):
    """An origin south of the Alps, or in the sea, with x that counts from there."""
    far = Profile(PROFILE.x + 500_000.0, PROFILE.y)
    for northing, said in ((700_000, None), (1_200_000, "outside of the area")):
        place = {"profile": PLACE | {"origin": [2_600_000, northing], "azimuth_deg": 0}}
        with warned_once(UnusualValueWarning, said):
            read_map_placement(Key(tmp_path / "slope.toml"), place, far)


@pytest.mark.parametrize(
    ("message", "changes"),
    [
        (r"origin: .*\[easting, northing\]", {"origin": [1.0]}),
        ("origin: must be a list", {"origin": 3.0}),
        ("origin: must be a number", {"origin": [1.0, "b"]}),
        ("azimuth_deg: .* from 0", {"azimuth_deg": 361}),
        ("azimuth_deg: .* from 0", {"azimuth_deg": -1}),
        ('crs: .* such as "EPSG:2056"', {"crs": "LV95"}),
        (r"crs: .*EPSG:4326 \(WGS 84\) is in degree", {"crs": "EPSG:4326"}),
        ("crs: .*is in US survey foot", {"crs": "EPSG:2225"}),
        ("crs: .*EPSG:1999.*register", {"crs": "EPSG:1999"}),
        (
            "origin: .*no place of EPSG:32632",
            {"origin": [1e30, 0], "crs": "EPSG:32632"},
        ),
        ("origin: .*no place of EPSG:2056", {"origin": [1e16, 1e16]}),
        ("crs: must be a text", {"crs": 2056}),
        *((f"{missing}: is needed beside", {missing: None}) for missing in PLACE),
    ],
)
def test_bad_places_are_refused(tmp_path, message, changes):
    table = {k: v for k, v in (PLACE | changes).items() if v is not None}
    with pytest.raises(InputError, match=rf"slope.toml, key profile\.{message}"):
        read_map_placement(Key(tmp_path / "slope.toml"), {"profile": table}, PROFILE)


@pytest.mark.parametrize("package", ["pyproj", "pyogrio", "shapely"])
def test_maps_name_the_package_that_they_need(tmp_path, monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(InputError, match=rf"crs needs .* {package}.*jaximpact\[maps\]"):
        read_map_placement(Key(tmp_path), {"profile": PLACE}, PROFILE)


def test_geojson_by_hand(tmp_path):
    """By the Mercator projection of a sphere, whose inverse is known: x = R lambda and
    y = R log(tan(pi/4 + phi/2))."""
    path, mercator = tmp_path / "a.geojson", 3857
    write_geojson(path, LAYER, mercator)
    tree = json.loads(path.read_text(encoding="utf-8"))
    assert tree["type"] == "FeatureCollection"
    line, without_place = tree["features"]
    geometry, radius = line.pop("geometry"), 6378137.0
    x, y, heights = LAYER.positions[0].T
    latitude = 2.0 * np.arctan(np.exp(y / radius)) - np.pi / 2.0
    degrees = np.degrees([x / radius, latitude])
    assert geometry["type"] == "LineString"
    np.testing.assert_allclose(
        geometry["coordinates"], np.transpose([*degrees, heights]), atol=1e-9
    )
    assert line["properties"] == {"block": 0, "name": 'a "b"', "m": None}
    assert without_place["geometry"] is None


def test_a_place_in_switzerland(tmp_path):
    """The old observatory of Bern, the origin of Swiss coordinates, at 46 57 03.90 N
    and 7 26 19.08 E of WGS 84 (swisstopo, Formulas and constants), to the metre."""
    path = tmp_path / "a.geojson"
    bern = [np.array([[2600000.0, 1200000.0, 550.0]])]
    write_geojson(path, Layer("points", False, bern, pd.DataFrame(index=[0])), 2056)
    (found,) = json.loads(path.read_text(encoding="utf-8"))["features"]
    longitude, latitude, height = found["geometry"]["coordinates"]
    assert longitude == pytest.approx(7 + 26 / 60 + 19.08 / 3600, abs=1e-5)
    assert latitude == pytest.approx(46 + 57 / 60 + 3.90 / 3600, abs=1e-5)
    assert height == 550.0


def test_the_same_layers_give_the_same_package(tmp_path):
    for name in ("a.gpkg", "b.gpkg"):
        (tmp_path / name).write_text("what was there is replaced")
        layers = [LAYER, LAYER._replace(name="again")]
        write_geopackage(tmp_path / name, layers, "EPSG:2056")
    first, second = ((tmp_path / name).read_bytes() for name in ("a.gpkg", "b.gpkg"))
    assert first == second
    for name in ("lines", "again"):
        found, _, (geometry, nothing), (_, names, _) = pyogrio.raw.read(
            tmp_path / "a.gpkg", layer=name
        )
        assert found["crs"] == "EPSG:2056"
        lines = shapely.get_coordinates(shapely.from_wkb(geometry), include_z=True)
        np.testing.assert_array_equal(lines, LAYER.positions[0])
        assert nothing is None
        assert names.tolist() == ['a "b"', None]


def test_what_gdal_cannot_write_is_an_error_of_files(tmp_path):
    with pytest.raises(OSError, match="cannot be written"):
        write_geopackage(tmp_path / "no folder" / "a.gpkg", [LAYER], "EPSG:2056")


@pytest.mark.parametrize("count", [0, 1, 12, 13, 120, 1000, 100_000])
@pytest.mark.parametrize("most", [12, 120])
def test_ranks_of_curves(count, most):
    ranks = kept_ranks(count, most)
    assert len(ranks) <= most
    assert sorted(set(ranks)) == ranks
    if count:
        assert ranks[0] == 1
        assert ranks[-1] == count
