"""Results on the map, and trajectories as a table.

Trajectories have positions at both ends of every flight, contact and leg along the
ground, and between them every tenth of a second.

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
import xarray as xr

from ...io.files import replacing
from ...io.output_files import NewFile
from ..trajectory import Runs
from .barriers import DESIGN_PERCENTILES, barriers_in_json, estimates_of
from .profile_file import MapPlacement, degrees_from
from .run_study import simulate
from .slope_file import SlopeStudy

SPACING = 0.1
"""Longest time between two positions [s]."""
PORTION = 50
"""Number of trajectories that are held at a time."""
DECIMALS = 3
"""Decimals of coordinates on the map: millimetres."""
TRAJECTORY_FILE = "trajectories.csv"
TRAJECTORY_COLUMNS = (
    *("block", "time_s", "x_m", "y_m", "v_x_mps", "v_y_mps", "orientation_rad"),
    *("angular_velocity_radps", "kinetic_energy_J"),
)
MAP_FILES = ("trajectories.geojson", "stops.geojson", "maps.gpkg")
PLACE_FILES = ("collectors.geojson",)
"""Files where there are collectors or barriers."""
NO_MAP = "No file for maps is written: [profile] has no origin, azimuth_deg and crs."
BLOCK_PROPERTIES = {
    "block": int,
    "ending": str,
    "mass_kg": float,
    "x_m": float,
    "time_s": float,
    "impacts": int,
    "energy_at_end_J": float,
    "max_height_m": float,
    "max_speed_mps": float,
    "max_energy_J": float,
}
"""Properties of trajectories and of their ends: variables of the dataset."""
PASSAGES = {
    "energy_kJ": ("passage_energy_J", 1e-3),
    "speed_mps": ("passage_speed_mps", 1.0),
    "centre_height_m": ("passage_centre_height_m", 1.0),
    "lowest_height_m": ("passage_lowest_height_m", 1.0),
}
"""Quantities at collectors: variable and factor."""
SHARES = ("share_over_of_all", "share_broken_of_all", "share_stopped_of_all")
PLACE_PROPERTIES = {
    **{"kind": str, "name": str, "x_m": float, "height_m": float},
    **{"capacity_kJ": float, "blocks_passing": int},
    **dict.fromkeys(SHARES, float),
    **{f"{name}_p{p}": float for name in PASSAGES for p in DESIGN_PERCENTILES},
}
"""Properties of collectors and barriers; None for what a collector does not have."""
LAYERS = {
    "trajectories": (True, BLOCK_PROPERTIES),
    "stops": (False, BLOCK_PROPERTIES),
    "collectors": (False, PLACE_PROPERTIES),
}
"""Layers of maps: whether they are of lines, and the kinds of their properties."""


def names_of_map_files(study: SlopeStudy) -> tuple[str, ...]:
    """List the names of the files of trajectories and maps."""
    if study.placement is None:
        return (TRAJECTORY_FILE,)
    places = PLACE_FILES if len(study.collectors) or study.barriers else ()
    return (TRAJECTORY_FILE, *MAP_FILES, *places)


class Feature(NamedTuple):
    """Thing on the map."""

    is_line: bool
    """True for a line, False for a point."""
    positions: list[list[float]]
    """Easting, northing and height [m] of each position; none for what has no place."""
    properties: dict
    """Numbers, texts and None by their names."""


AddFeature = Callable[[Feature], None]


def write_map_files(
    study: SlopeStudy, dataset: xr.Dataset, first: Runs, new: NewFile
) -> None:
    """Write trajectories.csv and, for a profile with a place on the map, the files of
    `names_of_map_files`; each whole or not at all.

    Args:
        dataset: result of the study.
        first: trajectories of the first blocks, computed already.
        new: gives the path of a file by its name.

    Raises OSError where the file system refuses.
    """
    place, names = study.placement, names_of_map_files(study)
    with contextlib.ExitStack() as stack:
        table = stack.enter_context(replacing(new(TRAJECTORY_FILE)))
        if place is None:
            _write_trajectories(table, study, dataset, first, None)
            return
        open_layer = stack.enter_context(geopackage(new("maps.gpkg"), place.code))
        add = {}
        for name, (is_line, columns) in LAYERS.items():
            if f"{name}.geojson" in names:
                file = new(f"{name}.geojson")
                sink = stack.enter_context(geojson(file, name, place.code))
                add[name] = _both(sink, open_layer(name, is_line, columns))
        _write_trajectories(table, study, dataset, first, add["trajectories"])
        for feature in _stops(dataset, place):
            add["stops"](feature)
        for feature in _places(study, dataset, place):
            add["collectors"](feature)


def _both(first: AddFeature, second: AddFeature) -> AddFeature:
    def add(feature: Feature) -> None:
        first(feature)
        second(feature)

    return add


def _portions(study: SlopeStudy, first: Runs) -> Iterator[tuple[int, Runs, int]]:
    """Compute the trajectories that go to files once more, portion by portion.

    Yields:
        Number of the first block of a portion, the trajectories, and how many of them
        are wanted.
    """
    count = min(study.export_trajectories, study.release.count)
    computed = first.release.count
    yield 0, first, min(count, computed)
    for start in range(computed, count, PORTION):
        chosen = np.arange(start, min(start + PORTION, count))
        yield start, simulate(study, chosen), len(chosen)


def _write_trajectories(
    path: Path,
    study: SlopeStudy,
    dataset: xr.Dataset,
    first: Runs,
    add: AddFeature | None,
) -> None:
    """Write the rows of the table, and add lines to the map, if there is one."""
    place, properties = study.placement, _properties(dataset)
    heads = (*TRAJECTORY_COLUMNS, *(("easting_m", "northing_m") if place else ()))
    with open(path, "w", encoding="utf-8", newline="\n") as table:
        table.write(",".join(heads) + "\n")
        for start, runs, count in _portions(study, first):
            for i in range(count):
                columns = _samples(runs, i)
                if place is not None and add is not None:
                    _, x, y, *_ = columns
                    columns += place.coordinates(x)
                    line = _line(place, x, y)
                    add(Feature(True, line, properties[start + i]))
                for row in np.stack(columns, axis=1).tolist():
                    cells = ",".join(f"{number:.12g}" for number in row)
                    table.write(f"{start + i},{cells}\n")


def _samples(runs: Runs, trajectory: int) -> list[np.ndarray]:
    """Sample a trajectory as the table has it, but for the block."""
    samples = runs.path(trajectory, SPACING)
    mass, inertia = (np.asarray(v)[trajectory] for v in runs.release.mass_properties)
    speeds = samples["v_x"] ** 2 + samples["v_y"] ** 2
    energy = 0.5 * (mass * speeds + inertia * samples["angular_velocity"] ** 2)
    return [*samples.values(), energy]


def _line(place: MapPlacement, x: np.ndarray, y: np.ndarray) -> list[list[float]]:
    """Place a trajectory on the map; positions at which it stays are there once."""
    positions = _positions(place, x, y)
    kept = [p for i, p in enumerate(positions) if i == 0 or p != positions[i - 1]]
    # A line takes two positions, that of a block that never moved too.
    return 2 * kept if len(kept) == 1 else kept


def _positions(place: MapPlacement, x: np.ndarray, y: np.ndarray) -> list[list[float]]:
    known = np.isfinite(x) & np.isfinite(y)
    positions = np.stack([*place.coordinates(x[known]), y[known]], axis=1)
    return np.round(positions, DECIMALS).tolist()


def _properties(dataset: xr.Dataset) -> list[dict]:
    """List the properties of each block; None for a number that is not known."""
    columns = [
        [_plain(kind, value) for value in dataset[name].values.tolist()]
        for name, kind in BLOCK_PROPERTIES.items()
    ]
    return [
        dict(zip(BLOCK_PROPERTIES, row, strict=True))
        for row in zip(*columns, strict=True)
    ]


def _plain(kind: type, value):
    return None if isinstance(value, float) and not np.isfinite(value) else kind(value)


def _stops(dataset: xr.Dataset, place: MapPlacement) -> Iterator[Feature]:
    """Give the end of each block; a block that failed has no place."""
    x, y = dataset.x_m.values, dataset.y_m.values
    for block, properties in enumerate(_properties(dataset)):
        here = slice(block, block + 1)
        yield Feature(False, _positions(place, x[here], y[here]), properties)


def _places(
    study: SlopeStudy, dataset: xr.Dataset, place: MapPlacement
) -> Iterator[Feature]:
    """Give collectors, then barriers, each at the ground, with design values."""
    for told in (*_collectors(dataset), *_barriers(dataset)):
        x = np.array([told["x_m"]])
        positions = _positions(place, x, study.profile.height(x))
        yield Feature(False, positions, {n: told.get(n) for n in PLACE_PROPERTIES})


def _collectors(dataset: xr.Dataset) -> Iterator[dict]:
    for i, x in enumerate(
        dataset.collector.values if "collector" in dataset.dims else ()
    ):
        told = {"kind": "collector", "name": f"x = {x:g} m", "x_m": float(x)}
        told["blocks_passing"] = int(dataset.blocks_passing.values[i])
        for name, (variable, factor) in PASSAGES.items():
            percentiles = dataset[f"{variable}_percentiles"].isel(collector=i)
            for p in DESIGN_PERCENTILES:
                value = factor * float(percentiles.sel(percentile=p))
                told[f"{name}_p{p}"] = _plain(float, value)
        yield told


def _barriers(dataset: xr.Dataset) -> Iterator[dict]:
    for barrier in barriers_in_json(estimates_of(dataset)):
        estimates = barrier.pop("estimates")
        passing = {"blocks_passing": estimates["share_arriving"]["count"]}
        values = {name: found["value"] for name, found in estimates.items()}
        yield {"kind": "barrier"} | barrier | passing | values


DEGREE_DECIMALS = 9
"""Decimals of degrees: a tenth of a millimetre."""


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
    with (
        replacing(path) as temporary,
        open(temporary, "w", encoding="utf-8", newline="\n") as file,
    ):
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
        degrees = np.round(to_degrees(eastings, northings), DEGREE_DECIMALS).tolist()
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
