"""Files of features for maps, written feature by feature: GeoJSON and GeoPackage.

GeoJSON has longitude and latitude [deg] of WGS 84, and the profile's height [m].
GeoPackage, which GIS programs open with all layers at once, has the coordinates of the
study; only what such a file must have is in it: tables of features with an identifier,
a geometry and properties, written with Python's SQLite.

Source: RFC 7946, The GeoJSON format; OGC 12-128r18, GeoPackage encoding standard 1.3.1,
clauses 1.1 and 2.1.
"""

import contextlib
import json
import sqlite3
import struct
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


APPLICATION, VERSION = 0x47504B47, 10301
WRITTEN = "1970-01-01T00:00:00.000Z"
"""Date of the layers, which must have one: the same study gives the same file."""
WGS84 = (
    'GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],'
    'PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433],AUTHORITY["EPSG","4326"]]'
)
TABLES = """
CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL,
  srs_id INTEGER NOT NULL PRIMARY KEY, organization TEXT NOT NULL,
  organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL,
  description TEXT);
CREATE TABLE gpkg_contents (table_name TEXT NOT NULL PRIMARY KEY,
  data_type TEXT NOT NULL, identifier TEXT UNIQUE, description TEXT DEFAULT '',
  last_change DATETIME NOT NULL, min_x DOUBLE, min_y DOUBLE, max_x DOUBLE,
  max_y DOUBLE, srs_id INTEGER REFERENCES gpkg_spatial_ref_sys(srs_id));
CREATE TABLE gpkg_geometry_columns (
  table_name TEXT NOT NULL UNIQUE REFERENCES gpkg_contents(table_name),
  column_name TEXT NOT NULL, geometry_type_name TEXT NOT NULL,
  srs_id INTEGER NOT NULL REFERENCES gpkg_spatial_ref_sys(srs_id),
  z TINYINT NOT NULL, m TINYINT NOT NULL, PRIMARY KEY (table_name, column_name));
"""
KINDS = {float: "DOUBLE", int: "INTEGER", str: "TEXT"}

OpenLayer = Callable[[str, bool, dict[str, type]], AddFeature]
"""Function of a layer's name, whether it is of lines, and the kinds of properties."""


@contextlib.contextmanager
def geopackage(path: Path, code: int) -> Iterator[OpenLayer]:
    """Open a file of layers, which is written whole or not at all.

    Args:
        code: number of the reference system in the EPSG's register.

    Yields:
        Function that begins a layer, and gives the one that adds a feature to it.

    Raises OSError where the file system refuses.
    """
    with replacing(path) as temporary:
        try:
            with contextlib.closing(sqlite3.connect(temporary)) as connection:
                # What is not whole is not kept: a journal would only lie beside it.
                connection.execute("PRAGMA journal_mode = MEMORY")
                connection.execute(f"PRAGMA application_id = {APPLICATION}")
                connection.execute(f"PRAGMA user_version = {VERSION}")
                connection.executescript(TABLES)
                systems = [
                    ("undefined cartesian", -1, "NONE", -1, "undefined", None),
                    ("undefined geographic", 0, "NONE", 0, "undefined", None),
                    ("WGS 84", 4326, "EPSG", 4326, WGS84, None),
                    # Programs know its definition by the number.
                    (f"EPSG:{code}", code, "EPSG", code, "undefined", None),
                ]
                insert = "INSERT INTO gpkg_spatial_ref_sys VALUES (?, ?, ?, ?, ?, ?)"
                connection.executemany(insert, systems)
                yield lambda *layer: _layer(connection, code, *layer)
                connection.commit()
        except sqlite3.OperationalError as error:
            raise OSError(f"{path} cannot be written: {error}") from error


def _layer(
    connection: sqlite3.Connection,
    code: int,
    name: str,
    is_line: bool,
    columns: dict[str, type],
) -> AddFeature:
    told = "".join(f', "{n}" {KINDS[kind]}' for n, kind in columns.items())
    kind = "LINESTRING" if is_line else "POINT"
    connection.execute(
        f"CREATE TABLE {name} (fid INTEGER PRIMARY KEY AUTOINCREMENT NOT NULL, "
        f"geom {kind}{told})"
    )
    connection.execute(
        "INSERT INTO gpkg_contents VALUES (?, 'features', ?, '', ?, NULL, NULL, NULL, "
        "NULL, ?)",
        (name, name, WRITTEN, code),
    )
    connection.execute(
        "INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', ?, ?, 1, 0)",
        (name, kind, code),
    )
    marks = ", ?" * (1 + len(columns))
    insert = f"INSERT INTO {name} VALUES (NULL{marks})"

    def add(feature: Feature) -> None:
        values = (feature.properties[column] for column in columns)
        connection.execute(insert, (_geometry(feature, code), *values))

    return add


def _geometry(feature: Feature, code: int) -> bytes | None:
    """Encode positions with the head of GeoPackage and the kinds of ISO WKB with z."""
    if not feature.positions:
        return None
    flags = 1  # little endian, no envelope
    head = struct.pack("<2sBBi", b"GP", 0, flags, code)
    numbers = [number for position in feature.positions for number in position]
    body = struct.pack(f"<{len(numbers)}d", *numbers)
    if not feature.is_line:
        return head + struct.pack("<BI", 1, 1001) + body
    return head + struct.pack("<BII", 1, 1002, len(feature.positions)) + body
