"""Results on the map, and trajectories as a table.

Trajectories have positions at both ends of every flight, contact and leg along the
ground, and between them every tenth of a second.

GeoJSON has longitude and latitude [deg] of WGS 84, and the profile's height [m], as
RFC 7946 wants it. GeoPackage, which GIS programs open with all layers at once, has the
coordinates of the study.
"""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from ..._packages import needed
from ...io.files import replacing
from ...io.output_files import NewFile
from ...reports.tables import at_x
from ..trajectory import Runs
from .barriers import (
    DESIGN_PERCENTILES,
    DESIGN_QUANTITIES,
    barriers_in_json,
    estimates_of,
)
from .profile_file import GIS, LONGITUDE_AND_LATITUDE, MapPlacement, degrees_from
from .run_study import simulate
from .slope_file import SlopeStudy

SPACING = 0.1
"""Longest time between two positions [s]."""
PORTION = 50
"""Number of trajectories that are computed at a time."""
TRAJECTORY_FILE = "trajectories.csv"
TRAJECTORY_COLUMNS = (
    *("time_s", "x_m", "y_m", "v_x_mps", "v_y_mps", "orientation_rad"),
    "angular_velocity_radps",
)
"""Columns behind that of the block, in the order of `Runs.path`."""
MAP_FILES = ("trajectories.geojson", "stops.geojson", "maps.gpkg")
PLACE_FILE = "collectors.geojson"
"""File where there are collectors or barriers."""
NO_MAP = "No file for maps is written: [profile] has no origin, azimuth_deg and crs."
BLOCK_PROPERTIES = (
    *("block", "ending", "mass_kg", "x_m", "time_s", "impacts", "energy_at_end_J"),
    *("max_height_m", "max_speed_mps", "max_energy_J"),
)
"""Properties of trajectories and of their ends: variables of the dataset."""
PLACE_PROPERTIES = (
    *("kind", "name", "x_m", "height_m", "capacity_kJ", "blocks_passing"),
    *("share_over_of_all", "share_broken_of_all", "share_stopped_of_all"),
    *(f"{name}_p{p}" for name in DESIGN_QUANTITIES for p in DESIGN_PERCENTILES),
)
"""Properties of collectors and barriers."""


def names_of_map_files(study: SlopeStudy) -> tuple[str, ...]:
    """List the names of the files of trajectories and maps."""
    if study.inputs.placement is None:
        return (TRAJECTORY_FILE,)
    has_places = len(study.settings.collectors) or study.settings.barriers
    return (TRAJECTORY_FILE, *MAP_FILES, *([PLACE_FILE] if has_places else ()))


class Layer(NamedTuple):
    """Things of one kind on the map."""

    name: str
    is_line: bool  # true for lines, False for points
    positions: list[np.ndarray]
    """Easting, northing and height [m] of each thing, `(positions, 3)`; without any for
    what has no place."""
    properties: pd.DataFrame  # properties of each thing, one a row


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
    place = study.inputs.placement
    with contextlib.ExitStack() as stack:

        def begun(name: str) -> Path:
            return stack.enter_context(replacing(new(name)))

        lines = _write_trajectories(begun(TRAJECTORY_FILE), study, first)
        if place is None:
            return
        blocks = dataset[[*BLOCK_PROPERTIES[1:]]].to_dataframe().reset_index()
        blocks = blocks.reindex(columns=[*BLOCK_PROPERTIES]).astype({"impacts": int})
        ends = np.stack([dataset.x_m.values, dataset.y_m.values], axis=1)
        layers = [
            Layer("trajectories", True, lines, blocks.head(len(lines))),
            Layer(
                "stops",
                False,
                [_positions(place, *end[:, None]) for end in ends],
                blocks,
            ),
        ]
        if PLACE_FILE in names_of_map_files(study):
            places = _collectors_and_barriers(dataset)
            on_ground = [
                _positions(place, np.array([x]), study.profile.height([x]))
                for x in places["x_m"]
            ]
            layers.append(Layer("collectors", False, on_ground, places))
        write_geopackage(begun("maps.gpkg"), layers, place.crs)
        for layer in layers:
            write_geojson(begun(f"{layer.name}.geojson"), layer, place.code)


def _portions(study: SlopeStudy, first: Runs) -> Iterator[tuple[int, Runs, int]]:
    """Compute the trajectories that go to files once more, portion by portion.

    Yields:
        Number of the first block of a portion, the trajectories, and how many of them
        are wanted.
    """
    count = min(study.settings.export_trajectories, study.release.count)
    computed = first.release.count
    yield 0, first, min(count, computed)
    for start in range(computed, count, PORTION):
        chosen = np.arange(start, min(start + PORTION, count))
        yield start, simulate(study, chosen), len(chosen)


def _write_trajectories(path: Path, study: SlopeStudy, first: Runs) -> list[np.ndarray]:
    """Write the rows of the table; give the lines on the map, if there is one."""
    place, lines = study.inputs.placement, []
    with open(path, "w", encoding="utf-8", newline="\n") as file:
        for start, runs, count in _portions(study, first):
            masses, inertias = map(np.asarray, runs.release.mass_properties)
            for i in range(count):
                samples = runs.path(i, SPACING).values()
                table = pd.DataFrame(
                    dict(zip(TRAJECTORY_COLUMNS, samples, strict=True))
                )
                table.insert(0, "block", start + i)
                squared = table.v_x_mps**2 + table.v_y_mps**2
                turning = inertias[i] * table.angular_velocity_radps**2
                table["kinetic_energy_J"] = 0.5 * (masses[i] * squared + turning)
                if place is not None:
                    x, y = table.x_m.to_numpy(), table.y_m.to_numpy()
                    table["easting_m"], table["northing_m"] = place.coordinates(x)
                    if not len(x):  # it ended at its release
                        x, y = runs.x[i : i + 1], runs.y[i : i + 1]
                    lines.append(_line(place, x, y))
                table.to_csv(
                    file,
                    header=start + i == 0,
                    index=False,
                    na_rep="nan",
                    float_format="%.12g",
                    lineterminator="\n",
                )
    return lines


def _line(place: MapPlacement, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Place a trajectory on the map; positions at which it stays are there once."""
    positions = _positions(place, x, y)
    stays = np.all(positions[1:] == positions[:-1], axis=1)
    kept = np.concatenate([positions[:1], positions[1:][~stays]])
    # A line takes two positions, that of a block that never moved too.
    return np.repeat(kept, 2, axis=0) if len(kept) == 1 else kept


def _positions(place: MapPlacement, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Give the known positions on the map, to the millimetre."""
    known = np.isfinite(x) & np.isfinite(y)
    positions = np.stack([*place.coordinates(x[known]), y[known]], axis=1)
    return np.round(positions, 3)


def _collectors_and_barriers(dataset: xr.Dataset) -> pd.DataFrame:
    rows = []
    collectors = dataset.collector.values if "collector" in dataset.sizes else ()
    for i, x in enumerate(collectors):
        row = {"kind": "collector", "name": at_x(x), "x_m": float(x)}
        row["blocks_passing"] = int(dataset.blocks_passing.values[i])
        for name, (variable, _, factor, _) in DESIGN_QUANTITIES.items():
            values = dataset[f"passage_{variable}_percentiles"].isel(collector=i)
            for p in DESIGN_PERCENTILES:
                row[f"{name}_p{p}"] = factor * float(values.sel(percentile=p))
        rows.append(row)
    for row in barriers_in_json(estimates_of(dataset)):
        estimates = row.pop("estimates")
        row |= {name: estimate["value"] for name, estimate in estimates.items()}
        passing = estimates["share_arriving"]["count"]
        rows.append({"kind": "barrier", "blocks_passing": passing} | row)
    texts = {"kind": object, "name": object, "blocks_passing": int}
    kinds = {name: texts.get(name, float) for name in PLACE_PROPERTIES}
    return pd.DataFrame(rows).reindex(columns=[*PLACE_PROPERTIES]).astype(kinds)


def write_geopackage(path: Path, layers: list[Layer], crs: str) -> None:
    """Write layers to one file, in the coordinates of a reference system.

    Raises OSError where the file system refuses.
    """
    path.unlink(missing_ok=True)
    for layer in layers:
        _write(path, "GPKG", layer, layer.positions, crs)


def write_geojson(path: Path, layer: Layer, code: int) -> None:
    """Write a layer in degrees.

    Args:
        code: number of the positions' reference system in the EPSG's register.

    Raises OSError where the file system refuses.
    """
    to_degrees = degrees_from(code)

    def in_degrees(positions: np.ndarray) -> np.ndarray:
        easting, northing, height = positions.T
        # Lists: pyproj takes an array of one number for a scalar, which is deprecated.
        degrees = to_degrees(easting.tolist(), northing.tolist())
        return np.stack([*degrees, height], axis=1)

    _write(
        path=path,
        driver="GeoJSON",
        layer=layer,
        positions=[in_degrees(positions) for positions in layer.positions],
        crs=f"EPSG:{LONGITUDE_AND_LATITUDE}",
        RFC7946="YES",
        COORDINATE_PRECISION=9,  # a tenth of a millimetre
    )


def _write(
    path: Path,
    driver: str,
    layer: Layer,
    positions: list[np.ndarray],
    crs: str,
    **options: str | int,
) -> None:
    """Write a layer by GDAL, in the coordinates of the positions that are given."""
    pyogrio, shapely = (needed(package, "profile.crs", "maps") for package in GIS[1:])
    make = shapely.LineString if layer.is_line else shapely.Point
    geometries = [
        shapely.to_wkb(make(where if layer.is_line else where[0]))
        if len(where)
        else None
        for where in positions
    ]
    columns = []
    for _, values in layer.properties.items():
        if not pd.api.types.is_numeric_dtype(values):
            values = values.astype(object).where(values.notna(), None)
        columns.append(values.to_numpy())
    # Layers must have a date: with this one the same study gives the same file.
    date = {"OGR_CURRENT_DATE": "1970-01-01T00:00:00.000Z"}
    pyogrio.set_gdal_config_options(date)
    try:
        pyogrio.raw.write(
            path,
            np.array(geometries, object),
            columns,
            [*layer.properties],
            layer=layer.name,
            driver=driver,
            geometry_type="LineString Z" if layer.is_line else "Point Z",
            crs=crs,
            layer_options=options,
        )
    except RuntimeError as error:  # GDAL's
        raise OSError(f"{path} cannot be written: {error}") from error
    finally:
        pyogrio.set_gdal_config_options(dict.fromkeys(date))
