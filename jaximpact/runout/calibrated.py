r"""Ground parameters as tests leave them, drawn for each block.

A calibration's draws are weighted and few; each block gets its own from the normal
distribution of the same mean and covariance, in the coordinates of the fit, cut off at
the bounds of the fit:

$$ x \sim N(\mu, C), \qquad x = \ln p \quad\text{or}\quad x = p / h . $$

Where the calibration trusts its draws too little, or has none, these are the best fit
and the covariance of its curvature. A parameter that is said in another way is held
there, and the others are drawn as they are given its value:

$$ \mu_o + C_{og} C_{gg}^{-1} (x_g - \mu_g), \qquad
   C_{oo} - C_{og} C_{gg}^{-1} C_{go} . $$
"""

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri

from ..errors import InputError, nearest
from ..formats.reading import read_input
from ..parameters import parts_of
from ..soil import Soil
from .ground import ground_columns
from .quantities import shares

FILE = "fit.json"
"""Of a calibration's directory."""
TRUSTED_PART = 0.1
"""Part of a calibration's draws that must count for them to be used."""
ATTEMPTS = 100
"""Draws for a block until one lies between the bounds."""


class Calibrated(NamedTuple):
    """What a calibration says of the ground."""

    file: Path
    checksum: str
    """SHA-256 of the file."""
    soil: Soil
    """Its laws, as it was made with."""
    fixed: dict[str, float]
    """Values of the soil at which it was made, in the units of their names."""
    names: tuple[str, ...]
    """Of the fitted parameters."""
    undetermined: dict[str, str]
    """Those that the tests do not determine, and why."""
    mean: np.ndarray
    """Of x, `(parameters,)`."""
    covariance: np.ndarray
    """Of x."""
    lower: np.ndarray
    """Bounds of the parameters, in the units of their names."""
    upper: np.ndarray

    @property
    def scale(self) -> np.ndarray:
        """h"""
        return 0.5 * (self.upper - self.lower)

    def coordinates(self, values: np.ndarray) -> np.ndarray:
        """x of values `(blocks, parameters)`."""
        logarithm = np.log(np.where(self.lower > 0.0, values, 1.0))
        return np.where(self.lower > 0.0, logarithm, values / self.scale)

    def values(self, x: np.ndarray) -> np.ndarray:
        """The inverse of `coordinates`."""
        exponential = np.exp(np.where(self.lower > 0.0, x, 0.0))
        return np.where(self.lower > 0.0, exponential, x * self.scale)

    def draw(
        self, given: Mapping[str, np.ndarray], count: int, seed: int
    ) -> dict[str, np.ndarray]:
        """The parameters that are not given, `(count,)`; block i gets the same whatever
        the count.

        Args:
            given: values `(count,)` of the others.
        """
        others = [i for i, name in enumerate(self.names) if name not in given]
        held = [i for i, name in enumerate(self.names) if name in given]
        if not others:
            return {}
        values = np.tile(self.values(self.mean), (count, 1))
        for i in held:
            values[:, i] = given[self.names[i]]
            low, high = self.lower[i], self.upper[i]
            bad = ~((values[:, i] >= low) & (values[:, i] <= high))
            if np.any(bad):
                raise InputError(
                    f"was fitted with {self.names[i]} between {low:g} and {high:g}, "
                    f"but it is {values[bad, i][0]:g} for block {np.argmax(bad)}",
                    file=self.file,
                )
        across = np.linalg.solve(
            self.covariance[np.ix_(held, held)], self.covariance[np.ix_(held, others)]
        )
        apart = self.coordinates(values)[:, held] - self.mean[held]
        centre = self.mean[others] + apart @ across
        spread = (
            self.covariance[np.ix_(others, others)]
            - self.covariance[np.ix_(others, held)] @ across
        )
        root = np.linalg.cholesky(spread)
        open_yet = np.ones(count, bool)
        for attempt in range(ATTEMPTS):
            standard = np.stack(
                [
                    ndtri(shares(seed, f"calibrated {self.names[i]}, {attempt}", count))
                    for i in others
                ],
                axis=1,
            )
            x = self.coordinates(values)
            x[:, others] = centre + standard @ root.T
            tried = self.values(x)
            inside = np.all((tried >= self.lower) & (tried <= self.upper), axis=1)
            taken = np.ix_(np.flatnonzero(open_yet & inside), others)
            values[taken] = tried[taken]
            open_yet &= ~inside
            if not np.any(open_yet):
                return {self.names[i]: values[:, i] for i in others}
        raise InputError(
            "holds parameters of which hardly any draw lies between the bounds of the "
            "fit; say them under [ground]",
            file=self.file,
        )


def read_calibrated(path: Path, variant: str | None = None) -> Calibrated:
    """Read what `jaximpact calibrate` wrote.

    Args:
        path: its directory, or fit.json in there.
        variant: of the study, if it has several.

    Raises InputError, naming the file, for whatever cannot be used.
    """
    path = Path(path)
    file = path / FILE if os.path.isdir(path) else path
    data = read_input(file)
    try:
        content = json.loads(data)
        found = _variant(file, content["variants"], variant)
        names = tuple(found["parameters"])
        ranges = [content["manifest"]["parameters"][name] for name in names]
        places = [found["unknowns"].index(name) for name in names]
        lower, upper = (
            np.array([r[end] for r in ranges], float) for end in ("lower", "upper")
        )
        best = [found["parameters"][name]["value"] for name in names]
        fixed = content["manifest"]["soil"] | found["soil"]
        calibrated = Calibrated(
            file=file,
            checksum=hashlib.sha256(data).hexdigest(),
            soil=_soil(file, content["manifest"], found),
            fixed={name: float(value) for name, value in fixed.items()},
            names=names,
            undetermined={
                name: told["reason"] or "no reason is given"
                for name, told in found["parameters"].items()
                if not told["determined"]
            },
            mean=np.zeros(len(names)),
            covariance=np.zeros((len(names), len(names))),
            lower=lower,
            upper=upper,
        )
        draws = found.get("draws")
        if draws and draws["effective_parts"][-1] >= TRUSTED_PART:
            mean, covariance = draws["mean"], draws["covariance"]
            mean = np.array(mean, float)[places]
        else:
            mean = calibrated.coordinates(np.array(best, float))
            covariance = found["covariance_of_logarithms_or_half_ranges"]
        covariance = np.array(covariance, float)[np.ix_(places, places)]
        if not np.all(np.isfinite(covariance)) or not np.all(np.isfinite(mean)):
            raise ValueError("no finite covariance")
        np.linalg.cholesky(covariance)
    except InputError:
        raise
    except (
        *(LookupError, TypeError, AttributeError, ValueError, ArithmeticError),
        *(np.linalg.LinAlgError, RecursionError),
    ) as error:
        raise InputError(
            f"holds no calibration that can be drawn from ({error!r}); a fit.json of "
            "jaximpact calibrate is needed",
            file=file,
        ) from None
    columns = ground_columns(calibrated.soil)
    unknown = [name for name in (*names, *fixed) if name not in columns]
    if unknown:
        raise InputError(f"holds {unknown[0]}, which no ground has", file=file)
    return calibrated._replace(mean=mean, covariance=covariance)


def _soil(file: Path, manifest: dict, variant: dict) -> Soil:
    """The soil with the laws that a calibration was made with."""
    entries = manifest.get("parts", {}) | variant.get("parts", {})
    if not entries:
        return Soil()
    # It imports all that calibrates, which is not needed without laws.
    from ..calibration.laws import parts_of_entries

    parts = parts_of_entries(entries, file)
    return Soil(**{slot: parts[slot] for slot in parts_of(Soil) if slot in parts})


def _variant(file: Path, variants: list[dict], wanted: str | None) -> dict:
    names = [one["name"] for one in variants]
    if wanted is None and len(names) == 1:
        return variants[0]
    if wanted is None:
        raise InputError(
            f"holds {len(names)} variants; variant must say which: {', '.join(names)}",
            file=file,
        )
    if wanted not in names:
        raise InputError(
            f"holds no variant {wanted!r}; did you mean {nearest(wanted, names)!r}?",
            file=file,
        )
    return variants[names.index(wanted)]
