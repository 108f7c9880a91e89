"""Tables in files: NetCDF to go on with, CSV for other programs."""

import dataclasses
import json
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pandas as pd
import xarray as xr

from .._packages import versions
from ..accuracy import Accuracy
from ..errors import InputError
from ..identity import part_names
from ..impact.events import Outcome
from ..io.datasets import read_netcdf, write_netcdf
from ..io.output_files import replacing_with_manifest
from ..io.result_table import outcomes_in_words
from ..quantities import OUTCOME_COLUMN
from ..scene import Scene
from ..scene_quantities import scene_of_values, scene_values
from ..units import DEGREE
from .table import ReboundTable, TableError, gravity_speed, slip_factor_of
from .tabulation import axes_of, impacts_at, speeds_between

DIMENSIONS = (
    *("total_speed_mps", "elevation_deg", "azimuth_deg", "orientation_deg"),
    "slope_deg",
)
ENTRIES = {
    "normal_velocity_change": "change of v_n over sqrt(w^2 + g R)",
    "tangential_velocity_change": "change of v_t over sqrt(w^2 + g R)",
    "rotation_velocity_change": "change of Omega R over sqrt(w^2 + g R)",
    "duration_s": "duration of contact",
    "rotation_rad": "rotation during contact",
    "final_sinking_m": "sinking at the end",
}
SAME = 1e-9
"""Difference of nodes, as a fraction of the largest, that is rounding."""


def write_table(path: Path, table: ReboundTable) -> None:
    """Write a table as NetCDF; the file appears whole or not at all.

    Raises OSError where the file system refuses.
    """
    variables = {
        name: (DIMENSIONS, np.asarray(table.entries[..., k]), {"long_name": meaning})
        for k, (name, meaning) in enumerate(ENTRIES.items())
    }
    variables["outcome_code"] = (
        DIMENSIONS,
        np.asarray(table.outcomes, np.int32),
        {"long_name": ", ".join(f"{o.value} {o}" for o in Outcome)},
    )
    title, *others = _provenance(table).items()
    attributes = dict([title, *((name, json.dumps(value)) for name, value in others)])
    write_netcdf(Path(path), xr.Dataset(variables, _coordinates(table), attributes))


def read_table(path: Path) -> ReboundTable:
    """Read what `write_table` wrote.

    Other programs may have transposed what it holds, or left out slopes.

    Raises InputError for a file that cannot be read or holds no such table, or other
    nodes than a table has.
    """
    path = Path(path)
    dataset = read_netcdf(path)
    try:
        factor = slip_factor_of(dataset.sizes["orientation_deg"])
        if json.loads(dataset.attrs["slip_factor"]) != factor:
            raise InputError(
                f"was made with azimuths of another factor than {factor:g}; tabulate "
                "again",
                file=path,
            )
        scene = _scene(path, dataset)
        *entries, outcomes = (
            dataset[name].transpose(*DIMENSIONS).values
            for name in (*ENTRIES, "outcome_code")
        )
        table = ReboundTable(
            block=scene.block,
            soil=scene.soil,
            entries=jnp.asarray(np.stack(entries, axis=-1)),
            outcomes=jnp.asarray(outcomes.astype(int)),
            speeds=jnp.asarray(dataset[DIMENSIONS[0]].values),
            slopes=jnp.asarray(dataset["slope_rad"].values),
            accuracy=Accuracy(**json.loads(dataset.attrs["accuracy"])),
            error=TableError(**json.loads(dataset.attrs["error"])),
        )
        _check_nodes(path, dataset, table)
        return table
    except InputError:
        raise
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"holds no table of impacts ({error!r}); one from write_table is needed",
            file=path,
        ) from None


def _check_nodes(path: Path, dataset: xr.Dataset, table: ReboundTable) -> None:
    """Raise InputError for nodes that are not those by which a table is looked up, as
    where some were left out."""
    axes = axes_of(table)
    axes[0] = speeds_between(table.block, axes[0][[0, -1]], len(axes[0]))
    for name, own in zip(DIMENSIONS, _in_units(axes), strict=True):
        least = 1 if name in ("orientation_deg", "slope_deg") else 2
        apart = np.abs(dataset[name].values - own)
        good = len(own) >= least and np.all(np.diff(own) > 0.0)
        if not good or not np.all(apart <= SAME * np.max(np.abs(own))):
            raise InputError(
                f"holds nodes of {name} that are not those of a table, left out or "
                "in another order; the file as write_table wrote it is needed",
                file=path,
            )


def _scene(path: Path, dataset: xr.Dataset) -> Scene:
    """Make block and ground that a table was made for; InputError for a law or a shape
    that is not found again as it was."""
    values = json.loads(dataset.attrs["scene"])
    names = json.loads(dataset.attrs["laws"])
    try:
        scene = scene_of_values(values)
    except InputError as error:
        raise InputError(
            f"was made with a law or a shape that cannot be had: {error}", file=path
        ) from error
    for slot, name in part_names(scene.soil, scene.block).items():
        if names.get(slot) != name:
            raise InputError(
                f"was made with {slot} {names.get(slot)}, but there is {name} now; "
                "tabulate again",
                file=path,
            )
    return scene


def write_csv(path: Path, table: ReboundTable) -> None:
    """Write the nodes of a table as CSV for other programs.

    A row for each node, with a manifest beside it. The first five columns are the
    table's axes, on which the nodes are a grid, the last axis fastest; then come the
    impact and what it does, in the units of the tables of results. `nan` where there is
    no number. Both files appear whole or not at all.

    Raises OSError where the file system refuses.
    """
    places, impact = impacts_at(table.block, axes_of(table))
    scale = np.hypot(places[0], float(gravity_speed(table.block)))
    radius = float(table.block.semi_axes.minor)
    change = np.asarray(table.entries).reshape(-1, len(ENTRIES))
    codes = np.asarray(table.outcomes).ravel()
    v_n, v_t = map(np.asarray, (impact.normal_velocity, impact.tangential_velocity))
    after_n = v_n + change[:, 0] * scale
    after_t = v_t + change[:, 1] * scale
    spin = impact.angular_velocity + change[:, 2] * scale / radius
    with np.errstate(divide="ignore", invalid="ignore"):
        e_n, e_t = (
            np.where(before != 0.0, ratio, np.nan)
            for before, ratio in ((v_n, -after_n / v_n), (v_t, after_t / v_t))
        )
    numbers = {
        "e_n": e_n,
        "e_t": e_t,
        "normal_velocity_mps": after_n,
        "tangential_velocity_mps": after_t,
        "angular_velocity_after_degps": spin / DEGREE,
        "duration_s": change[:, 3],
        "rotation_deg": change[:, 4] / DEGREE,
        "final_sinking_m": change[:, 5],
    }
    failed = codes == Outcome.failed
    columns = {
        **dict(zip(DIMENSIONS, _in_units(places), strict=True)),
        "speed_mps": impact.speed,
        "angle_deg": impact.angle / DEGREE,
        "angular_velocity_degps": impact.angular_velocity / DEGREE,
        **{name: np.where(failed, np.nan, values) for name, values in numbers.items()},
        OUTCOME_COLUMN: outcomes_in_words(codes),
    }
    with replacing_with_manifest(Path(path), _provenance(table)) as temporary:
        pd.DataFrame(columns).to_csv(
            temporary, index=False, na_rep="nan", lineterminator="\n"
        )


def _in_units(places):
    """Return the speeds in m/s, angles in degrees."""
    return [places[0], *(angle / DEGREE for angle in places[1:])]


def _coordinates(table: ReboundTable) -> dict:
    units = ("m/s", *["deg"] * 4)
    axes = axes_of(table)
    coordinates = {
        name: (name, np.asarray(values), {"units": unit})
        for name, values, unit in zip(DIMENSIONS, _in_units(axes), units, strict=True)
    }
    # As they are, so that a slope is found again to the last bit.
    slopes = np.asarray(table.slopes)
    return coordinates | {"slope_rad": ("slope_deg", slopes, {"units": "rad"})}


def _provenance(table: ReboundTable) -> dict:
    """Collect the title, and what is needed to make the table again, ready for JSON."""
    assert table.error is not None  # of a finished table it is measured
    return {
        "title": "jaximpact: impacts of one block on one ground, tabulated",
        "scene": scene_values(Scene(table.block, table.soil)),
        "accuracy": dataclasses.asdict(table.accuracy),
        "error": {name: float(x) for name, x in table.error._asdict().items()},
        "laws": part_names(table.soil, table.block),
        "slip_factor": slip_factor_of(table.outcomes.shape[3]),
        "versions": versions(),
    }
