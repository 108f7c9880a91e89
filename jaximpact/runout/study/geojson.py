"""Files of GeoJSON, written feature by feature.

Coordinates are longitude and latitude [deg] of WGS 84, and the profile's height [m].

Source: RFC 7946, The GeoJSON format.
"""

import contextlib
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ...io.files import replacing
from .map_placement import degrees_from

DECIMALS = 9
"""Decimals of degrees: a tenth of a millimetre."""


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
        code: number of the positions' reference system in the EPSG's register.

    Yields:
        Function that writes a feature.

    Raises OSError where the file system refuses.
    """
    to_degrees = degrees_from(code)
    with replacing(path) as temporary, open(temporary, "w", encoding="utf-8") as file:
        file.write(f'{{"type":"FeatureCollection","name":"{name}","features":[')
        separator = "\n"

        def add(feature: Feature) -> None:
            nonlocal separator
            file.write(separator + _text(_as_tree(feature, to_degrees)))
            separator = ",\n"

        yield add
        file.write("\n]}\n")


def _as_tree(feature: Feature, to_degrees: Callable) -> dict:
    geometry = None
    if feature.positions:
        kind = "LineString" if feature.is_line else "Point"
        eastings, northings, heights = zip(*feature.positions, strict=True)
        degrees = np.round(to_degrees(eastings, northings), DECIMALS).tolist()
        places = [list(place) for place in zip(*degrees, heights, strict=True)]
        places = places if feature.is_line else places[0]
        geometry = {"type": kind, "coordinates": places}
    return {"type": "Feature", "geometry": geometry, "properties": feature.properties}


def _text(tree: dict) -> str:
    return json.dumps(tree, allow_nan=False, separators=(",", ":"))
