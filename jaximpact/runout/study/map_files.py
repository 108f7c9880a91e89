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
import xarray as xr

from ..._packages import needed
from ...io.files import replacing
from ...io.output_files import NewFile
from ..trajectory import Runs
from .barriers import DESIGN_PERCENTILES, barriers_in_json, estimates_of
from .profile_file import GIS, LONGITUDE_AND_LATITUDE, MapPlacement, degrees_from
from .run_study import simulate
from .slope_file import SlopeStudy

SPACING = 0.1
"""Longest time between two positions [s]."""
PORTION = 50
"""Number of trajectories that are computed at a time."""
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
"""Kinds of the properties of trajectories and of their ends: variables of the
dataset."""
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
"""Kinds of the properties of collectors and barriers."""
WRITTEN = "1970-01-01T00:00:00.000Z"
"""Date of the layers, which must have one: the same study gives the same file."""
DEGREE_DECIMALS = 9
"""Decimals of degrees: a tenth of a millimetre."""


def names_of_map_files(study: SlopeStudy) -> tuple[str, ...]:
    """List the names of the files of trajectories and maps."""
    if study.inputs.placement is None:
        return (TRAJECTORY_FILE,)
    places = (
        PLACE_FILES if len(study.settings.collectors) or study.settings.barriers else ()
    )
    return (TRAJECTORY_FILE, *MAP_FILES, *places)


class Layer(NamedTuple):
    """Things of one kind on the map."""

    name: str
    is_line: bool
    """True for lines, False for points."""
    positions: list[np.ndarray]
    """Easting, northing and height [m] of each thing, `(positions, 3)`; without any for
    what has no place."""
    properties: list[dict]
    """Numbers and texts of each thing by their names; what is left out is not known."""
    kinds: dict[str, type]
    """Kinds of the properties."""


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
        table = stack.enter_context(replacing(new(TRAJECTORY_FILE)))
        lines = _write_trajectories(table, study, first)
        if place is None:
            return
        properties = _properties(dataset)
        ends = np.stack([dataset.x_m.values, dataset.y_m.values], axis=1)
        layers = [
            Layer(
                name="trajectories",
                is_line=True,
                positions=lines,
                properties=properties[: len(lines)],
                kinds=BLOCK_PROPERTIES,
            ),
            Layer(
                "stops",
                False,
                [_positions(place, *end[:, None]) for end in ends],
                properties,
                BLOCK_PROPERTIES,
            ),
        ]
        if PLACE_FILES[0] in names_of_map_files(study):
            told = [*_collectors(dataset), *_barriers(dataset)]
            x = np.array([one["x_m"] for one in told])[:, None]
            on_ground = [_positions(place, at, study.profile.height(at)) for at in x]
            layers.append(Layer("collectors", False, on_ground, told, PLACE_PROPERTIES))
        package = stack.enter_context(replacing(new("maps.gpkg")))
        write_geopackage(package, layers, place.crs)
        for layer in layers:
            file = stack.enter_context(replacing(new(f"{layer.name}.geojson")))
            write_geojson(file, layer, place.code)


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
    heads = (*TRAJECTORY_COLUMNS, *(("easting_m", "northing_m") if place else ()))
    with open(path, "w", encoding="utf-8", newline="\n") as table:
        table.write(",".join(heads) + "\n")
        for start, runs, count in _portions(study, first):
            for i in range(count):
                columns = _samples(runs, i)
                if place is not None:
                    _, x, y, *_ = columns
                    columns += place.coordinates(x)
                    lines.append(_line(place, x, y))
                for row in np.stack(columns, axis=1).tolist():
                    cells = ",".join(f"{number:.12g}" for number in row)
                    table.write(f"{start + i},{cells}\n")
    return lines


def _samples(runs: Runs, trajectory: int) -> list[np.ndarray]:
    """Sample a trajectory as the table has it, but for the block."""
    samples = runs.path(trajectory, SPACING)
    mass, inertia = (np.asarray(v)[trajectory] for v in runs.release.mass_properties)
    speeds = samples["v_x"] ** 2 + samples["v_y"] ** 2
    energy = 0.5 * (mass * speeds + inertia * samples["angular_velocity"] ** 2)
    return [*samples.values(), energy]


def _line(place: MapPlacement, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Place a trajectory on the map; positions at which it stays are there once."""
    positions = _positions(place, x, y)
    stays = np.all(positions[1:] == positions[:-1], axis=1)
    kept = positions[np.append(True, ~stays)]
    # A line takes two positions, that of a block that never moved too.
    return np.repeat(kept, 2, axis=0) if len(kept) == 1 else kept


def _positions(place: MapPlacement, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    known = np.isfinite(x) & np.isfinite(y)
    positions = np.stack([*place.coordinates(x[known]), y[known]], axis=1)
    return np.round(positions, DECIMALS)


def _properties(dataset: xr.Dataset) -> list[dict]:
    """List the properties of each block."""
    columns = [dataset[name].values.tolist() for name in BLOCK_PROPERTIES]
    return [
        dict(zip(BLOCK_PROPERTIES, row, strict=True))
        for row in zip(*columns, strict=True)
    ]


def _collectors(dataset: xr.Dataset) -> Iterator[dict]:
    for i, x in enumerate(
        dataset.collector.values if "collector" in dataset.dims else ()
    ):
        told = {"kind": "collector", "name": f"x = {x:g} m", "x_m": float(x)}
        told["blocks_passing"] = int(dataset.blocks_passing.values[i])
        for name, (variable, factor) in PASSAGES.items():
            percentiles = dataset[f"{variable}_percentiles"].isel(collector=i)
            for p in DESIGN_PERCENTILES:
                told[f"{name}_p{p}"] = factor * float(percentiles.sel(percentile=p))
        yield told


def _barriers(dataset: xr.Dataset) -> Iterator[dict]:
    for barrier in barriers_in_json(estimates_of(dataset)):
        estimates = barrier.pop("estimates")
        passing = {"blocks_passing": estimates["share_arriving"]["count"]}
        values = {name: found["value"] for name, found in estimates.items()}
        yield {"kind": "barrier"} | barrier | passing | values


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
        # Lists: an array of one number is deprecated by NumPy before 2.4.
        degrees = to_degrees(easting.tolist(), northing.tolist())
        return np.stack([*degrees, height], axis=1)

    places = [in_degrees(positions) for positions in layer.positions]
    _write(
        path=path,
        driver="GeoJSON",
        layer=layer,
        positions=places,
        crs=f"EPSG:{LONGITUDE_AND_LATITUDE}",
        RFC7946="YES",
        COORDINATE_PRECISION=DEGREE_DECIMALS,
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
    for name, kind in layer.kinds.items():
        unknown = np.nan if kind is float else None
        values = [properties.get(name, unknown) for properties in layer.properties]
        columns.append(np.array(values, object if kind is str else kind))
    pyogrio.set_gdal_config_options({"OGR_CURRENT_DATE": WRITTEN})
    try:
        pyogrio.raw.write(
            path,
            np.array(geometries, object),
            columns,
            [*layer.kinds],
            layer=layer.name,
            driver=driver,
            geometry_type="LineString Z" if layer.is_line else "Point Z",
            crs=crs,
            layer_options=options,
        )
    except RuntimeError as error:  # GDAL's
        raise OSError(f"{path} cannot be written: {error}") from error
    finally:
        pyogrio.set_gdal_config_options({"OGR_CURRENT_DATE": None})
