"""Place of a profile on the map: where x = 0 lies, and in which direction x grows."""

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..._packages import needed
from ...errors import InputError
from ...io.toml import number, typed
from ...units import DEGREE

KEYS = ("origin", "azimuth_deg", "crs")
"""Keys under `[profile]`, all of them or none."""
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
    given = [key for key in KEYS if key in table]
    if not given:
        return None
    for key in KEYS:
        if key not in table:
            raise InputError(
                f"is needed beside {given[0]}", file=path, key=f"profile.{key}"
            )
    key = "profile.origin"
    pair = typed(path, {key: table["origin"]}, key, list)
    if len(pair) != 2:
        raise InputError(
            f"must be [easting, northing], but is {pair!r}", file=path, key=key
        )
    easting, northing = (number(path, key, value) for value in pair)
    azimuth = number(path, "profile.azimuth_deg", table["azimuth_deg"])
    if not 0.0 <= azimuth <= 360.0:
        raise InputError(
            f"must be from 0, north, over 90, east, to 360, but is {azimuth:g}",
            file=path,
            key="profile.azimuth_deg",
        )
    place = MapPlacement(easting, northing, DEGREE * azimuth, _crs(path, table))
    longitude, latitude = degrees_from(place.code)([easting], [northing])
    if not np.all(np.isfinite([longitude, latitude])):
        raise InputError(
            f"is no place of {place.crs}: {pair!r}", file=path, key="profile.origin"
        )
    return place


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


def _crs(path: Path, table: dict) -> str:
    key = "profile.crs"
    crs = typed(path, {key: table["crs"]}, key, str)
    if not re.fullmatch(r"EPSG:[1-9][0-9]{3,5}", crs):
        raise InputError(
            f'must be a code such as "EPSG:2056", but is {crs!r}', file=path, key=key
        )
    pyproj = needed("pyproj", key, "maps")
    try:
        system = pyproj.CRS(crs)
    except pyproj.exceptions.CRSError:
        raise InputError(
            f"is {crs}, which the EPSG's register does not hold", file=path, key=key
        ) from None
    units = {axis.unit_name for axis in system.axis_info[:2]}
    if not system.is_projected or units != {"metre"}:
        raise InputError(
            f"must be a projected system in metres, but {crs} ({system.name}) is in "
            f"{' and '.join(sorted(units))}",
            file=path,
            key=key,
        )
    return crs
