"""Files of GeoJSON, written feature by feature.

Coordinates are easting, northing and height [m] in the reference system of the study,
which the member `crs` names as GIS programs read it. RFC 7946 itself knows longitude
and latitude only, and other systems by arrangement (its section 4): for web maps a file
must be transformed first.

Source: RFC 7946, The GeoJSON format; GJ2008, section 3, for `crs`.
"""

import contextlib
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from ...io.files import replacing


class Feature(NamedTuple):
    """Thing on the map."""

    is_line: bool
    """True for a line, False for a point."""
    positions: list[list[float]]
    """Easting, northing and height [m] of each position; none for what has no place."""
    properties: dict
    """Numbers, texts and None by their names."""


AddFeature = Callable[[Feature], None]


@contextlib.contextmanager
def geojson(path: Path, name: str, code: int) -> Iterator[AddFeature]:
    """Open a collection of features, which is written whole or not at all.

    Args:
        name: name of the layer.
        code: number of the reference system in the EPSG's register.

    Yields:
        Function that writes a feature.

    Raises OSError where the file system refuses.
    """
    crs = {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{code}"}}
    with replacing(path) as temporary, open(temporary, "w", encoding="utf-8") as file:
        head = f'"type":"FeatureCollection","name":"{name}","crs":{_text(crs)}'
        file.write(f'{{{head},"features":[')
        separator = "\n"

        def add(feature: Feature) -> None:
            nonlocal separator
            file.write(separator + _text(_as_tree(feature)))
            separator = ",\n"

        yield add
        file.write("\n]}\n")


def _as_tree(feature: Feature) -> dict:
    geometry = None
    if feature.positions:
        kind = "LineString" if feature.is_line else "Point"
        places = feature.positions if feature.is_line else feature.positions[0]
        geometry = {"type": kind, "coordinates": places}
    return {"type": "Feature", "geometry": geometry, "properties": feature.properties}


def _text(tree: dict) -> str:
    return json.dumps(tree, allow_nan=False, separators=(",", ":"))
