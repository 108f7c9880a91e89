"""Profile of a study, from its file and those that it names: its points and its ground,
and its place on the map."""

import hashlib
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..._packages import needed
from ...errors import InputError
from ...io.checks import warn_unusual
from ...io.files import read_input
from ...io.toml import Key, known_table, number, of_kind, typed
from ...units import DEGREE
from ..coordinates import LARGEST
from ..dxf_profile import read_dxf_points
from ..profile_formats import read_profile_table
from ..smoothing import Smoothing
from ..terrain import Profile, ground_values, with_ground_values
from .ground_file import GroundInput, GroundLayout, lay_out

SOURCES = ("points_m", "csv", "dxf")
"""Keys of the profile, of which one says its points."""
SMOOTHING = "smooth_m"
"""Key of the length over which the profile is smoothed [m]."""


def read_ground_profile(
    top: Key, content: dict, ground: GroundInput, checksums: dict[Path, str]
) -> GroundLayout:
    """Read the profile, with the ground that is alike for all blocks, and find where
    each ground holds; add the checksums of files that are read."""
    if ground.calibrated is not None:
        checksums[ground.calibrated.file] = ground.calibrated.checksum
    key, keys = top["profile"], (*SOURCES, "layer", SMOOTHING, *MAP_KEYS)
    table = known_table(top, content, "profile", keys)
    sources = [name for name in SOURCES if name in table]
    if len(sources) != 1:
        raise key.error("needs one of points_m, csv and dxf, and no other")
    if "layer" in table and "dxf" not in table:
        raise key["layer"].error("is of a dxf only")
    base = {name: v for k, name, v in ground.alike() if k == f"ground.{name}"}
    surface = with_ground_values(ground.soil, base)
    materials, columns = None, ()
    if "points_m" in table:
        points = typed(key, table, "points_m", list)
        profile = _of_points(key["points_m"], points, surface)
    else:
        file = top.file.parent / typed(key, table, sources[0], str)
        data = read_input(file, once=False)
        checksums[file] = hashlib.sha256(data).hexdigest()
        if "csv" in table:
            profile, columns, materials = read_profile_table(file, *surface, warn=True)
            _check_said_once(ground, file, columns)
        else:
            layer = typed(key, table, "layer", str) if "layer" in table else None
            profile = _of_dxf(file, layer, surface)
    _check_all_said(ground, columns)
    smoothing = None
    if SMOOTHING in table:
        # Before the profile is cut where the ground changes, so that it stays there.
        length = number(key[SMOOTHING], table[SMOOTHING], above=0.0, unit="m")
        with key[SMOOTHING].located():
            smoothed = profile.smoothed(length)
        smoothing = Smoothing.between(length, profile.y, smoothed.y)
        profile = smoothed
    has_base = bool(columns or ground.calibrated)
    has_base |= any(k.count(".") == 1 for k in ground.quantities)
    layout = lay_out(ground, profile, materials, has_base)
    profile = layout.profile
    values = {name: np.array(v) for name, v in ground_values(profile).items()}
    for k, name, value in ground.alike():
        if k != f"ground.{name}":
            values[name][layout.where(k)] = value
    surface = with_ground_values(profile.soil, values)
    profile = Profile(profile.x, profile.y, *surface)
    return layout._replace(profile=profile, smoothing=smoothing)


def _of_points(key: Key, points: list, surface: tuple) -> Profile:
    try:
        if not all(type(c) in (int, float) for point in points for c in point):
            raise TypeError
        x, y = np.array(points, float).reshape(len(points), 2).T
        return Profile(x, y, *surface)
    except (TypeError, ValueError) as error:
        problem = str(error)
        if not problem.startswith("a profile"):
            problem = f"must be a list of [x, y], but is {points!r}"
        raise key.error(problem) from None


def _of_dxf(file: Path, layer: str | None, surface: tuple) -> Profile:
    x, y = read_dxf_points(file, layer)
    try:
        return Profile(x, y, *surface)
    except ValueError as error:
        raise InputError(str(error), file=file) from None


def _check_said_once(ground: GroundInput, csv: Path, columns: tuple[str, ...]) -> None:
    """Raise InputError for a quantity of the ground that is a column of the profile
    too: one of them would count for nothing."""
    of_calibration = {} if ground.calibrated is None else ground.calibrated.fixed
    for key in (*ground.quantities, *ground.sampled_jointly()):
        name = key.split(".")[-1]
        if name in columns and name not in of_calibration:
            raise ground.top[key].error(
                f"is also a column of {csv.name}; leave one of them out"
            )


def _check_all_said(ground: GroundInput, columns: tuple[str, ...]) -> None:
    """Raise InputError for a quantity that differs between the tests of the
    calibration, unless the study or the profile says it."""
    differing = {} if ground.calibrated is None else ground.calibrated.differing
    for name, how in differing.items():
        if f"ground.{name}" not in ground.quantities and name not in columns:
            raise ground.top["ground"].error(f"must say {name}, which {how}")


MAP_KEYS = ("origin", "azimuth_deg", "crs")
"""Keys under `[profile]`, all of them or none."""
GIS = ("pyproj", "pyogrio", "shapely")
"""Packages that maps need."""
LONGITUDE_AND_LATITUDE = 4326
"""WGS 84 in the EPSG's register, the reference system of GeoJSON."""


class MapPlacement(NamedTuple):
    r"""Place of a profile on the map.

    $$ E = E_0 + x \sin a, \qquad N = N_0 + x \cos a $$

    The map's height is the profile's y.
    """

    easting: float
    """Easting E0 of x = 0 [m]."""
    northing: float
    """Northing N0 of x = 0 [m]."""
    azimuth: float
    """Direction a in which x grows, from north clockwise [rad]."""
    crs: str
    """Coordinate reference system, projected and in metres, such as EPSG:2056."""

    def coordinates(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Compute easting and northing at places along the profile [m]."""
        return (
            self.easting + x * math.sin(self.azimuth),
            self.northing + x * math.cos(self.azimuth),
        )

    @property
    def code(self) -> int:
        """Number of the reference system in the EPSG's register."""
        return int(self.crs.partition(":")[2])


def read_map_placement(
    top: Key, content: dict, profile: Profile
) -> MapPlacement | None:
    """Read the place of the profile on the map; None where the file gives none.

    Raises InputError, naming file and key, where one of the three keys is missing or
    cannot be used.
    """
    table = content.get("profile", {})
    present = [key for key in MAP_KEYS if key in table]
    if not present:
        return None
    key = top["profile"]
    for package in GIS:
        needed(package, "profile.crs", "maps")
    for name in MAP_KEYS:
        if name not in table:
            raise key[name].error(f"is needed beside {present[0]}")
    origin = key["origin"]
    pair = typed(key, table, "origin", list)
    if len(pair) != 2:
        raise origin.error(f"must be [easting, northing], but is {pair!r}")
    easting, northing = (number(origin, value) for value in pair)
    azimuth = number(key["azimuth_deg"], table["azimuth_deg"])
    if not 0.0 <= azimuth <= 360.0:
        raise key["azimuth_deg"].error(
            f"must be from 0, north, over 90, east, to 360, but is {azimuth:g}"
        )
    crs = _crs(key["crs"], table["crs"])
    place = MapPlacement(easting, northing, DEGREE * azimuth, crs)
    # The origin may be far from where the profile lies.
    middle = place.coordinates(0.5 * (profile.x[0] + profile.x[-1]))
    longitude, latitude = degrees_from(place.code)(*middle)
    known = np.all(np.isfinite([longitude, latitude]))
    if not known or max(map(abs, (*pair, *middle))) > LARGEST:
        raise origin.error(f"is no place of {place.crs}: {pair!r}")
    _warn_of_distant(origin, pair, place, longitude, latitude)
    return place


def _warn_of_distant(
    key: Key, pair: list, place: MapPlacement, longitude: float, latitude: float
) -> None:
    """Warn of a place where the map's lengths are not those on the ground, or that the
    reference system is not made for; longitude and latitude are those of the profile's
    middle [deg], the pair is the origin as the file has it."""
    pyproj = needed("pyproj", "profile.crs", "maps")
    system = pyproj.CRS(place.crs)
    factors = pyproj.Proj(system).get_factors(longitude, latitude)
    scales = factors.meridional_scale, factors.parallel_scale
    scale = max(scales, key=lambda scale: abs(scale - 1.0))
    where = f"at longitude {longitude:.4g} and latitude {latitude:.4g}"
    area = system.area_of_use
    degrees = ", and looks like degrees" if max(map(abs, pair)) <= 180.0 else ""
    far = area is not None and not _is_near(area, longitude, latitude)
    if far or degrees:
        of = ", outside of the area of" if far else " by"
        text = (
            f"{pair!r} puts the profile {where}{of} {place.crs} ({system.name})"
            f"{degrees}; are easting and northing in this order, and of this system?"
        )
    elif not abs(scale - 1.0) <= 0.01:  # in a zone of UTM it is 0.001
        text = (
            f"{place.crs} ({system.name}) has lengths of {scale:.4g} times those on "
            f"the ground {where}; x and y of the profile must be metres on the ground: "
            "take a UTM zone or a national grid"
        )
    else:
        return
    warn_unusual(text, "crs", **key.place)


def _is_near(area, longitude: float, latitude: float) -> bool:
    """Tell whether a place is within a reference system's area of use, or within 3
    degrees of it, half a zone of UTM, where it may still be used."""
    # An area across longitude 180 goes from west to a smaller number in the east.
    width = (area.east - area.west) % 360.0 or 360.0
    east = (longitude - area.west + 3.0) % 360.0
    north = area.south - 3.0 <= latitude <= area.north + 3.0
    return north and east <= width + 6.0


def degrees_from(code: int) -> Callable:
    """Make the function from eastings and northings [m] to longitudes and latitudes
    [deg], given a projected reference system by its number in the EPSG's register.

    Without the network, from what pyproj brings: grids of corrections that it lacks
    cost up to some metres in old national systems.
    """
    pyproj = needed("pyproj", "profile.crs", "maps")
    transformer = pyproj.Transformer.from_crs(
        code, LONGITUDE_AND_LATITUDE, always_xy=True
    )
    return transformer.transform


def _crs(key: Key, value) -> str:
    crs = of_kind(key, value, str)
    if not re.fullmatch(r"EPSG:[1-9][0-9]{3,5}", crs):
        raise key.error(f'must be a code such as "EPSG:2056", but is {crs!r}')
    pyproj = needed("pyproj", "profile.crs", "maps")
    try:
        system = pyproj.CRS(crs)
    except pyproj.exceptions.CRSError:
        raise key.error(f"is {crs}, which the EPSG's register does not hold") from None
    units = {axis.unit_name for axis in system.axis_info[:2]}
    if not system.is_projected or units != {"metre"}:
        raise key.error(
            f"must be a projected system in metres, but {crs} ({system.name}) is in "
            f"{' and '.join(sorted(units))}"
        )
    return crs
