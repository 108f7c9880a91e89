"""`jaximpact sweep`: impacts over a grid of quantities."""

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING

from ..accuracy import DEFAULT_ACCURACY
from ..errors import InputError
from ..interruption import resumable
from ..io.output_files import journal_path, output_files
from ..progress_lines import ProgressLines, say
from . import options

if TYPE_CHECKING:
    import xarray as xr

SUFFIX = ".nc"
ZARR = ".zarr"
DESCRIPTION = """\
Compute impacts over a grid of quantities and write them to a NetCDF file.

The study is a TOML file: a scene, as `jaximpact simulate` takes it, and a table [axes]
with a list or a range for each quantity that varies, which the scene then gives no
value. Every combination is computed; quantities that are to vary together stand in a
table of their own inside [axes]. Those of the scene's own laws and shapes can vary too,
and `shape` takes names of shapes.

    [impact]
    speed_mps = 14

    [axes]
    angle_deg = { from = 10, to = 80, count = 15 }
    k_E = { from = 1e2, to = 1e4, count = 5, spacing = "logarithmic" }

    [axes.ground]
    name = ["dense", "loose"]
    c_v = [1.0, 0.5]
    gamma_v = [8.7, 1.7]

Points that fail are nan with the outcome `failed`, and are counted. After a run that
was cut short the same command goes on where it stopped.

With --out file.zarr points are computed and written region by region, to a store that
may be larger than memory (needs jaximpact[cluster])."""


def add_parser(commands) -> None:
    """Add the command to the command line."""
    parser = options.add_command(
        commands,
        "sweep",
        run,
        help="impacts over a grid of quantities",
        description=DESCRIPTION,
        epilog=lambda: options.input_help("Quantities:"),
    )
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument(
        "study", type=Path, nargs="?", metavar="study.toml", help="scene and axes"
    )
    what.add_argument(
        "--set",
        metavar="NAME",
        help="one of the paper's parametric sets: I, II, III, IV or fig13",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="file.nc",
        help="NetCDF file, or a directory file.zarr (default: a NetCDF file named as "
        "the study or set, in this directory); an existing file is replaced once the "
        "new one is whole, a directory is taken up",
    )
    options.add_accuracy(parser, otherwise=f"the study's, else {DEFAULT_ACCURACY}")
    options.add_engine(parser)


def run(arguments: argparse.Namespace) -> None:
    """Compute the sweep."""
    from ..io.datasets import write_netcdf
    from ..sweeping import read_sweep_study, sweep

    if arguments.set is not None:
        from ..parametric_sets import parametric_set

        (base, axes), accuracy = parametric_set(arguments.set), None
        name = f"set_{arguments.set}"
    else:
        base, axes, accuracy = read_sweep_study(arguments.study)
        name = arguments.study.stem
    out = arguments.out or Path(name + SUFFIX)
    accuracy = arguments.accuracy or accuracy or DEFAULT_ACCURACY
    if out.suffix == ZARR:
        _write_store(
            arguments, out, sweep(base, axes, accuracy=accuracy, chunks="auto")
        )
        return
    if out.suffix != SUFFIX:
        raise InputError(f"--out must end in {SUFFIX} or {ZARR}, but is {out}")
    journal = journal_path(out)
    inputs = [arguments.study] if arguments.set is None else []
    files = output_files({"--out": out}, inputs=inputs, journals=[journal])
    with files, resumable():
        with options.engine_of(arguments) as executor, ProgressLines() as progress:
            dataset = sweep(
                base,
                axes,
                accuracy=accuracy,
                journal=journal,
                progress=progress,
                executor=executor,
            )
        write_netcdf(out, dataset)
    print(in_words(dataset))
    say(f"{dataset.e_n.size} impacts written to {out}")


def _write_store(
    arguments: argparse.Namespace, out: Path, dataset: "xr.Dataset"
) -> None:
    import xarray as xr

    from ..io.datasets import OUTCOMES
    from ..lazy import write_zarr

    with (
        resumable(),
        options.engine_of(arguments),
        ProgressLines() as progress,
    ):
        regions = write_zarr(out, dataset, progress=progress)
    counts = xr.open_zarr(out, chunks=None).attrs[OUTCOMES]
    print(_axes_and_outcomes(dataset.assign_attrs({OUTCOMES: counts})))
    say(
        f"{dataset.e_n.size} impacts in {out}: {regions.computed} of {regions.total} "
        f"regions computed, {regions.found} were there"
    )


def in_words(dataset: "xr.Dataset") -> str:
    """Dimensions, outcomes, and the range of each result."""
    import numpy as np

    from .._tables import align
    from ..quantities import RESULT_COLUMNS

    rows: list[tuple[str, ...]] = [("result", "unit", "least", "median", "largest")]
    for name, column in RESULT_COLUMNS.items():
        values = dataset[name].values
        values = values[np.isfinite(values)]
        cells = ["-"] * 3
        if values.size:
            statistics = values.min(), np.median(values), values.max()
            cells = [f"{value:.4g}" for value in statistics]
        rows.append((name, column.unit, *cells))
    return f"{_axes_and_outcomes(dataset)}\n{align(rows)}"


def _axes_and_outcomes(dataset: "xr.Dataset") -> str:
    from ..io.datasets import OUTCOMES

    sizes = [f"{name} {size}" for name, size in dataset.sizes.items()]
    counts = json.loads(dataset.attrs[OUTCOMES])
    ends = [f"{count} {name}" for name, count in counts.items()]
    return f"axes: {', '.join(sizes)}\noutcomes: {', '.join(ends)}"
