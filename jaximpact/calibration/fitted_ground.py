"""What a finished calibration says of the ground, read again from its numbers."""

import json
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..accuracy import Accuracy
from ..errors import InputError
from ..formats.reading import read_text
from ..parameters import Part
from .draws import FEWEST
from .laws import parts_of_entries
from .nuisance import Prior
from .proportional import PartOfSize
from .study_file import Parameter, Variant

FILE = "fit.json"
FILES = ("report.html", "report.md", "report.txt", FILE, "fitted.csv", "fit.png")
"""That every calibration writes."""


class FittedVariant(NamedTuple):
    """One variant, with draws of what the tests leave open."""

    variant: Variant
    unknowns: tuple[str, ...]
    """Of the soil's parameters, then of the nuisances."""
    best: np.ndarray
    """The best fit, in the units of the columns, `(unknowns,)`."""
    draws: np.ndarray
    """`(draws, unknowns)`"""
    weights: np.ndarray
    undetermined: tuple[str, ...]
    allowed: dict[str, tuple[float | None, float | None]]
    """What the profile of each parameter leaves at 95 %; None for the bound."""
    sigma: dict[str, float]
    """Scatter of each target's measurements about the model; their median where it is
    proportional."""
    proportional: dict[str, PartOfSize]
    """Of the targets whose scatter was estimated as a part of the value."""
    estimated: dict[str, bool]
    """Whether it comes from the scatter about the fit."""
    inflation: float
    """Of the sigmas' squares."""
    freedom: dict[str, float]
    """Degrees of freedom that the fit left of each target."""
    accuracy: Accuracy
    """Of impacts, that the draws were found to need."""

    @property
    def trusted(self) -> bool:
        """Whether enough draws count."""
        return bool(1.0 / np.sum(self.weights**2) >= FEWEST * len(self.weights))


class FittedGround(NamedTuple):
    """A calibration."""

    title: str
    variants: tuple[FittedVariant, ...]
    parameters: tuple[Parameter, ...]
    soil: dict[str, float]
    """Values that were held, in the units of the columns."""
    nuisances: dict[str, dict]
    targets: tuple[str, ...]
    accuracy: str
    seed: int
    ranges: dict[str, tuple[float, float]]
    """Least and largest value of every column in the fitted tests."""
    results: dict[str, dict]
    """Of each target how many were measured, their mean and standard deviation."""
    versions: dict[str, str]
    parts: dict[str, Part]
    """Laws, and the shape of blocks that do not say theirs, by what they are for."""
    block: dict[str, float]
    """Values of the block that the fitted tests had in common."""
    shapes: tuple[str, ...] = ()
    """Those that fitted blocks had, if it is known."""


DAMAGED = (LookupError, TypeError, AttributeError, ValueError, ArithmeticError)
"""What reading a tree of another form leads to."""


def read_fitted(path: Path) -> FittedGround:
    """Read what `calibrate` wrote.

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
    try:
        parts, *laws = (
            parts_of_entries(entry.get("parts", {}), path)
            for entry in (tree["manifest"], *tree["variants"])
        )
        return fitted_of(tree, parts, laws)
    except InputError:
        raise
    except DAMAGED as error:
        raise InputError(
            f"is no {FILE} of this version ({error!r}); calibrate again", file=path
        ) from error


def files_of_fit(path: Path) -> list[Path]:
    """The files of a calibration, named as for `read_fitted`; not its pictures."""
    directory = path if path.is_dir() else path.parent
    return [path, *(directory / name for name in FILES)]


def fitted_of(
    tree: dict, parts: dict[str, Part], laws: list[dict[str, Part]]
) -> FittedGround:
    """The same of the numbers themselves.

    Args:
        parts: laws and shape of the study.
        laws: of each variant, where they differ.
    """
    manifest = tree["manifest"]
    return FittedGround(
        title=tree["title"],
        variants=tuple(
            _variant(tree, entry, of_variant)
            for entry, of_variant in zip(tree["variants"], laws, strict=True)
        ),
        parameters=tuple(
            Parameter(
                name, entry["start"], entry["lower"], entry["upper"], _prior(entry)
            )
            for name, entry in manifest["parameters"].items()
        ),
        soil=manifest["soil"],
        nuisances=manifest["nuisances"],
        targets=tuple(manifest["targets"]),
        accuracy=manifest["accuracy"]["name"],
        seed=manifest["seed"],
        ranges={n: tuple(v) for n, v in tree["fitted_tests"]["ranges"].items()},
        results=tree["fitted_tests"]["results"],
        versions=manifest["versions"],
        parts=parts,
        block=manifest.get("block", {}),
        shapes=tuple(tree["fitted_tests"].get("shapes", ())),
    )


def _prior(entry: dict) -> Prior | None:
    return Prior(**entry["prior"]) if "prior" in entry else None


def _variant(tree: dict, entry: dict, laws: dict[str, Part]) -> FittedVariant:
    draws = entry["draws"]
    best = entry["parameters"] | entry["nuisances"]
    return FittedVariant(
        variant=Variant(entry["name"], entry["soil"], laws),
        unknowns=tuple(entry["unknowns"]),
        best=np.array([best[name]["value"] for name in entry["unknowns"]]),
        draws=np.array(draws["values"]),
        weights=np.array(draws["weights"]) / np.sum(draws["weights"]),
        undetermined=tuple(
            name for name, one in entry["parameters"].items() if not one["determined"]
        ),
        allowed={
            name: (one["low_95"], one["high_95"])
            for name, one in entry["profiles"].items()
        },
        sigma={name: one["sigma"] for name, one in entry["fit"].items()},
        proportional={
            name: PartOfSize(one["part_of_size"], one["least_size"])
            for name, one in entry["fit"].items()
            if "part_of_size" in one
        },
        estimated={name: not given for name, given in tree["sigma_given"].items()},
        inflation=entry["inflation"],
        freedom={n: one["degrees_of_freedom"] for n, one in entry["fit"].items()},
        accuracy=Accuracy(**draws["accuracy"]),
    )
