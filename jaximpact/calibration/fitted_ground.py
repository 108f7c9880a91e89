"""Fitted ground of a finished calibration, read from its fit.json."""

import json
import os
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from .._checks import real_number, whole_number
from ..accuracy import PRESETS, Accuracy
from ..errors import InputError, check_choice, located
from ..io.checks import checked_names
from ..io.files import read_text
from ..parameters import Part
from ..quantities import TARGET_COLUMNS, InputColumn
from .comparison.fitted_law import SIMPLE_LAWS, FittedLaw, law_of_json
from .diagnostics.discrepancy import Discrepancy, discrepancy_of_json
from .diagnostics.posterior import FEWEST
from .problem.config import Variant
from .problem.expressions import Tied
from .problem.fitted_parameters import Parameter
from .problem.laws import parts_of_entries
from .problem.noise import ProportionalScatter
from .problem.nuisance import Prior

FILE = "fit.json"
FORMAT = 2
"""Version of the tree in it; other ones are refused."""
FILES = ("report.html", FILE, "fitted.csv")
"""Files that every calibration writes."""


class FittedVariant(NamedTuple):
    """Fit of one variant, with draws of its posterior."""

    variant: Variant
    unknowns: tuple[str, ...]
    """Names of the soil's parameters, then of the nuisance parameters."""
    best: np.ndarray
    """Best fit in the units of the columns, shape (unknowns,)."""
    draws: np.ndarray
    """Draws in the units of the columns, shape (draws, unknowns)."""
    weights: np.ndarray
    """Weights of the draws; their sum is 1."""
    undetermined: dict[str, str]
    """Reasons why parameters are not identifiable, by name."""
    allowed: dict[str, tuple[float | None, float | None]]
    """95 % profile-likelihood interval of each parameter; None for a bound."""
    sigma: dict[str, float]
    """Standard deviation of each target's measurements about the model; the median
    where it is proportional."""
    proportional: dict[str, ProportionalScatter]
    """Scatter of the targets where it was estimated as a fraction of the value."""
    estimated: dict[str, bool]
    """Whether the sigma of each target was estimated from the residuals."""
    inflation: float
    """Factor on the squares of the given sigmas."""
    freedom: dict[str, float]
    """Degrees of freedom of each target."""
    accuracy: Accuracy
    """Accuracy of the impacts that the draws need."""
    factors: dict[str, float]
    """Factors on given sigmas that were too small beside estimated ones, by target;
    `sigma` includes them."""
    discrepancy: Discrepancy | None = None
    """Error of the model outside the fitted tests; None where it is unknown."""

    @property
    def trusted(self) -> bool:
        """Whether the effective sample size is large enough."""
        return bool(1.0 / np.sum(self.weights**2) >= FEWEST)


class FittedGround(NamedTuple):
    """Fitted ground of a calibration, one for each variant."""

    title: str
    variants: tuple[FittedVariant, ...]
    parameters: tuple[Parameter, ...]
    soil: dict[str, float]
    """Values of fixed parameters in the units of their columns."""
    nuisances: dict[str, dict]
    targets: tuple[str, ...]
    accuracy: str
    seed: int
    ranges: dict[str, tuple[float, float]]
    """Smallest and largest value of every column in the fitted tests."""
    results: dict[str, dict]
    """Number, mean and standard deviation of the measurements of each target."""
    versions: dict[str, str]
    parts: dict[str, Part]
    """Laws, and the shape of blocks that do not state theirs, by slot."""
    block: dict[str, float]
    """Values of the block that all fitted tests share."""
    shapes: tuple[str, ...] = ()
    """Shapes of the fitted blocks, if known."""
    tied: tuple[Tied, ...] = ()
    """Soil parameters that are expressions of others."""
    simple: tuple[FittedLaw, ...] = ()
    """Simple laws fitted to the same tests."""
    compared: tuple[str, ...] = ()
    """Lines of a comparison of laws, if the calibration made one."""


def ground_of_tests(
    ranges: Mapping[str, tuple[float, float]],
    columns: Mapping[str, InputColumn],
    known: Collection[str],
) -> tuple[dict[str, float], dict[str, tuple[float, float]]]:
    """Collect what the tables of fitted tests say of the ground: values that all tests
    share and that are not the default, and the ranges of those that differ.

    Args:
        ranges: smallest and largest value of columns in the fitted tests.
        columns: columns of the ground.
        known: names of what the fit knows otherwise.
    """
    there = {n: ends for n, ends in ranges.items() if n in columns and n not in known}
    differing = {n: (low, high) for n, (low, high) in there.items() if low != high}
    shared = {
        name: low
        for name, (low, _) in there.items()
        if name not in differing and low != columns[name].default
    }
    return shared, differing


DAMAGED = (LookupError, TypeError, AttributeError, ValueError, ArithmeticError)
"""Exceptions of reading a tree of another form."""


def read_fitted(path: Path) -> FittedGround:
    """Read the fit.json that `calibrate` wrote.

    Args:
        path: fit.json, or the directory that holds it.

    Raises InputError for anything else.
    """
    path = Path(path)
    if os.path.isdir(path):
        path = path / FILE
    text = read_text(path)
    try:
        tree = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"must be the {FILE} of a calibration, or its directory, but is no JSON",
            file=path,
        ) from error
    if isinstance(tree, dict) and "model_check" in tree:
        raise InputError(
            "is the back-analysis of a slope; a calibration to impacts is needed",
            file=path,
        )
    if not isinstance(tree, dict) or tree.get("format") != FORMAT:
        raise InputError(
            f"is no {FILE} of a calibration of this version; calibrate again", file=path
        )
    try:
        parts, *laws = (
            parts_of_entries(entry["parts"], path)
            for entry in (tree["manifest"], *tree["variants"])
        )
        with located(file=path):
            return fitted_of(tree, parts, laws)
    except InputError:
        raise
    except DAMAGED as error:
        raise InputError(
            f"is no {FILE} of this version ({error!r}); calibrate again", file=path
        ) from error


def files_of_fit(path: Path) -> list[Path]:
    """List the files of a calibration, given as for `read_fitted`, but its pictures."""
    directory = path if path.is_dir() else path.parent
    return [path, *(directory / name for name in FILES)]


def fitted_of(
    tree: dict, parts: dict[str, Part], laws: list[dict[str, Part]]
) -> FittedGround:
    """Make the fitted ground from the numbers of fit.json, laws and shape of the study,
    and the laws in which each variant differs."""
    manifest, fitted = tree["manifest"], tree["manifest"]["parameters"]
    check_choice("accuracy", manifest["accuracy"]["name"], PRESETS)
    if not tree["variants"]:
        raise ValueError("no variants")
    return FittedGround(
        title=tree["title"],
        variants=tuple(
            _variant(tree, entry, of_variant)
            for entry, of_variant in zip(tree["variants"], laws, strict=True)
        ),
        parameters=tuple(
            Parameter(
                name,
                *(_number(fitted, name, key) for key in ("start", "lower", "upper")),
                prior=entry["prior"] and Prior(**entry["prior"]),
            )
            for name, entry in fitted.items()
        ),
        soil={n: real_number(n, v) for n, v in manifest["soil"].items()},
        nuisances=manifest["nuisances"],
        targets=checked_names("target", manifest["targets"], TARGET_COLUMNS),
        accuracy=manifest["accuracy"]["name"],
        seed=whole_number("seed", manifest["seed"], 0),
        ranges={
            name: (real_number(name, low), real_number(name, high))
            for name, (low, high) in tree["fitted_tests"]["ranges"].items()
        },
        results=tree["fitted_tests"]["results"],
        versions=manifest["versions"],
        parts=parts,
        block={n: real_number(n, v) for n, v in manifest["block"].items()},
        shapes=tuple(tree["fitted_tests"]["shapes"]),
        tied=tuple(
            Tied(name, entry["expression"], entry["constants"])
            for name, entry in manifest["tied"].items()
        ),
        simple=tuple(
            law_of_json(entry)
            for entry in tree["simple_laws"]
            if entry["law"] in SIMPLE_LAWS
        ),
        compared=tuple((tree["comparison"] or {"verdict": ()})["verdict"]),
    )


def _variant(tree: dict, entry: dict, laws: dict[str, Part]) -> FittedVariant:
    draws, fit = entry["draws"], entry["fit"]
    best = entry["parameters"] | entry["nuisances"]
    values, weights = (np.array(draws[key], float) for key in ("values", "weights"))
    if values.shape != (len(weights), len(entry["unknowns"])):
        raise ValueError("draws are not of the unknowns, each with a weight")
    if not np.all(np.isfinite(values)):
        raise ValueError("draws are not finite")
    if not (np.all(weights >= 0.0) and 0.0 < np.sum(weights) < np.inf):
        raise ValueError("weights of draws are not numbers above 0")
    return FittedVariant(
        variant=Variant(entry["name"], entry["soil"], laws),
        unknowns=tuple(entry["unknowns"]),
        best=np.array([_number(best, name, "value") for name in entry["unknowns"]]),
        draws=values,
        weights=weights / np.sum(weights),
        undetermined={
            name: one["reason"] or "no reason is given"
            for name, one in entry["parameters"].items()
            if not one["determined"]
        },
        allowed={
            name: (one["low_95"], one["high_95"])
            for name, one in entry["profiles"].items()
        },
        sigma={name: _number(fit, name, "sigma") for name in fit},
        proportional={
            name: ProportionalScatter(
                _number(fit, name, "part_of_size"), _number(fit, name, "least_size")
            )
            for name, one in fit.items()
            if "part_of_size" in one
        },
        estimated={
            name: not is_given for name, is_given in tree["sigma_given"].items()
        },
        inflation=_number(entry, "uncertainty", "inflation"),
        freedom={name: _number(fit, name, "degrees_of_freedom") for name in fit},
        accuracy=Accuracy(**draws["accuracy"]),
        factors={
            name: _number(fit, name, "times_given_sigma")
            for name, one in fit.items()
            if "times_given_sigma" in one
        },
        # Older files have none.
        discrepancy=discrepancy_of_json(entry.get("discrepancy")),
    )


def _number(entries: Mapping[str, Mapping], name: str, what: str) -> float:
    """Return a finite number of the entry of a name. Raises InputError for others."""
    return real_number(f"{what} of {name}", entries[name][what])
