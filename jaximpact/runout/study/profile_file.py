"""Profile of a study, from its file and those that it names: its points and its ground,
and its place on the map."""

import hashlib
import math
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..._packages import needed
from ...errors import InputError, UnusualValueWarning
from ...io.files import read_input
from ...io.toml import Key, known_table, number, of_kind, typed
from ...scene import Soil
from ...units import DEGREE
from ..coordinates import LARGEST
from ..dxf_profile import read_dxf_points
from ..profile_formats import ProfileTable, read_profile_table
from ..smoothing import Smoothing
from ..terrain import Profile, ground_columns, ground_values, with_ground_values
from .ground_file import GroundInput
from .ground_layout import GroundLayout, lay_out

SOURCES = ("points_m", "csv", "dxf")
"""Keys of the profile, of which one says its points."""
SMOOTHING = "smooth_m"
"""Key of the length over which the profile is smoothed [m]."""
SHAPING = ("layer", SMOOTHING)
"""Keys of the profile that say more of its points."""


def read_ground_profile(
    path: Path, content: dict, ground: GroundInput, checksums: dict[Path, str]
) -> GroundLayout:
    """Read the profile, with the ground that is alike for all blocks, and find where
    each ground holds; add the checksums of files that are read."""
    if ground.calibrated is not None:
        checksums[ground.calibrated.file] = ground.calibrated.checksum
    top = Key(path)
    key = top["profile"]
    table = known_table(top, content, "profile", (*SOURCES, *SHAPING, *MAP_KEYS))
    sources = [name for name in SOURCES if name in table]
    if len(sources) != 1:
        raise key.error("needs one of points_m, csv and dxf, and no other")
    if "layer" in table and "dxf" not in table:
        raise key["layer"].error("is of a dxf only")
    surface = with_ground_values(ground.soil, _alike(ground.everywhere, ground.soil))
    if "points_m" in table:
        points = typed(key, table, "points_m", list)
        profile = _of_points(key["points_m"], points, surface)
        given = ProfileTable(profile, (), None)
    else:
        file = path.parent / typed(key, table, sources[0], str)
        data = read_input(file, once=False)
        checksums[file] = hashlib.sha256(data).hexdigest()
        if "csv" in table:
            given = read_profile_table(file, *surface)
            _check_said_once(ground, file, given)
        else:
            layer = typed(key, table, "layer", str) if "layer" in table else None
            given = ProfileTable(_of_dxf(file, layer, surface), (), None)
    profile, smoothing = given.profile, None
    if SMOOTHING in table:
        # Before the profile is cut where the ground changes, so that it stays there.
        profile, smoothing = _smoothed(key[SMOOTHING], table[SMOOTHING], profile)
    layout = lay_out(
        top["ground"],
        profile,
        given.materials,
        ground.parts,
        ground.fields(),
        has_base=bool(ground.everywhere or given.quantities or ground.calibrated),
    )
    return _with_parts(layout._replace(smoothing=smoothing), ground)


def _smoothed(key: Key, given, profile: Profile) -> tuple[Profile, Smoothing]:
    length = number(key, given, above=0.0, unit="m")
    with key.located():
        smoothed = profile.smoothed(length)
    return smoothed, Smoothing.between(length, profile.y, smoothed.y)


def _of_points(key: Key, points: list, surface: tuple) -> Profile:
    try:
        if not all(type(c) in (int, float) for point in points for c in point):
            raise TypeError
        x, y = np.array(points, float).reshape(len(points), 2).T
        return Profile(x, y, *surface)
    except (TypeError, ValueError) as error:
        told = str(error)
        if not told.startswith("a profile"):
            told = f"must be a list of [x, y], but is {points!r}"
        raise key.error(told) from None


def _of_dxf(file: Path, layer: str | None, surface: tuple) -> Profile:
    x, y = read_dxf_points(file, layer)
    try:
        return Profile(x, y, *surface)
    except ValueError as error:
        raise InputError(str(error), file=file) from None


def _alike(quantities: dict, soil: Soil) -> dict[str, float]:
    """Select the quantities that are one number, in SI units."""
    columns, given = ground_columns(soil), quantities.items()
    return {n: columns[n].factor * v for n, v in given if isinstance(v, float)}


def _check_said_once(ground: GroundInput, csv: Path, given: ProfileTable) -> None:
    """Raise InputError for a distribution that a column of the profile would hide, and
    for a material's quantity that would hide a column."""
    key = Key(ground.path)["ground"]
    varied = [*ground.varied(), *ground.fields(), *ground.sampled_jointly()]
    for name in given.quantities:
        if f"ground.{name}" in varied:
            raise key[name].error(
                f"differs from block to block, but {csv.name} has a column of it"
            )
        for part in ground.parts.values():
            if part.segment is None and name in part.quantities:
                raise key[part.key][name].error(
                    f"is also a column of {csv.name}; leave one of them out"
                )


def _with_parts(layout: GroundLayout, ground: GroundInput) -> GroundLayout:
    """Give segments and materials the quantities that are numbers."""
    profile = layout.profile
    values = {name: np.array(v) for name, v in ground_values(profile).items()}
    for part in ground.parts.values():
        for name, value in _alike(part.quantities, profile.soil).items():
            values[name][layout.places[part.key]] = value
    surface = with_ground_values(profile.soil, values)
    return layout._replace(profile=Profile(profile.x, profile.y, *surface))


MAP_KEYS = ("origin", "azimuth_deg", "crs")
"""Keys under `[profile]`, all of them or none."""
BESIDE = 3.0
"""Distance beyond the area of a reference system [deg]: half a zone of UTM."""
LARGEST_DISTORTION = 0.01
"""Deviation of a map's scale from 1 that is warned of; it is 0.001 in a zone of UTM."""
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


def read_map_placement(path: Path, content: dict) -> MapPlacement | None:
    """Read the place of the profile on the map; None where the file gives none.

    Args:
        content: content of the file.

    Raises InputError, naming file and key, where one of the three keys is missing or
    cannot be used.
    """
    table = content.get("profile", {})
    given = [key for key in MAP_KEYS if key in table]
    if not given:
        return None
    key = Key(path)["profile"]
    for package in GIS:
        needed(package, "profile.crs", "maps")
    for name in MAP_KEYS:
        if name not in table:
            raise key[name].error(f"is needed beside {given[0]}")
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
    longitude, latitude = degrees_from(place.code)(easting, northing)
    known = np.all(np.isfinite([longitude, latitude]))
    if not known or max(abs(easting), abs(northing)) > LARGEST:
        raise origin.error(f"is no place of {place.crs}: {pair!r}")
    _warn_of_distant(origin, pair, place, longitude, latitude)
    return place


def _warn_of_distant(
    key: Key, pair: list, place: MapPlacement, longitude: float, latitude: float
) -> None:
    """Warn of a place where the map's lengths are not those on the ground, or that the
    reference system is not made for.

    Args:
        pair: origin as the file has it.
        longitude, latitude: of the origin [deg].
    """
    pyproj = needed("pyproj", "profile.crs", "maps")
    system = pyproj.CRS(place.crs)
    factors = pyproj.Proj(system).get_factors(longitude, latitude)
    scales = factors.meridional_scale, factors.parallel_scale
    scale = max(scales, key=lambda scale: abs(scale - 1.0))
    where = f"at longitude {longitude:.4g} and latitude {latitude:.4g}"
    area = system.area_of_use
    degrees = ", and looks like degrees" if max(map(abs, pair)) <= 180.0 else ""
    if area is not None and not _is_near(area, longitude, latitude):
        text = (
            f"{pair!r} is {where}, outside of the area of {place.crs} "
            f"({system.name}){degrees}; are easting and northing in this order, and "
            "of this system?"
        )
    elif not abs(scale - 1.0) <= LARGEST_DISTORTION:
        text = (
            f"{place.crs} ({system.name}) has lengths of {scale:.4g} times those on "
            f"the ground {where}; x and y of the profile must be metres on the ground: "
            "take a UTM zone or a national grid"
        )
    else:
        return
    text = f"{key.file}, key {key.name}: {text}"
    warnings.warn(UnusualValueWarning(text, "crs"), stacklevel=1)


def _is_near(area, longitude: float, latitude: float) -> bool:
    """Tell whether a place is within a reference system's area of use, or so near that
    it may still be used there, as a zone of UTM is beside its own."""
    # An area across longitude 180 goes from west to a smaller number in the east.
    width = (area.east - area.west) % 360.0 or 360.0
    east = (longitude - area.west + BESIDE) % 360.0
    north = area.south - BESIDE <= latitude <= area.north + BESIDE
    return north and east <= width + 2.0 * BESIDE


def degrees_from(code: int) -> Callable:
    """Make the function from eastings and northings [m] to longitudes and latitudes
    [deg].

    Args:
        code: number of a projected reference system in the EPSG's register.

    Without the network, from what pyproj brings: grids of corrections that it lacks
    cost up to some metres in old national systems.
    """
    pyproj = needed("pyproj", "profile.crs", "maps")
    found = pyproj.Transformer.from_crs(code, LONGITUDE_AND_LATITUDE, always_xy=True)
    return found.transform


def _crs(key: Key, given) -> str:
    crs = of_kind(key, given, str)
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
