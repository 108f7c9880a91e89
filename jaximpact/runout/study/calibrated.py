r"""Ground parameters sampled for each block from the posterior of a calibration.

A calibration's samples are weighted and few; each block gets its own from the normal
distribution of the same mean and covariance, in the coordinates of the fit, truncated
at the bounds of the fit:

$$ x \sim N(\mu, C), \qquad x = \ln p \quad\text{or}\quad x = p / h . $$

Where the samples' effective size is too small, or there are none, these are the best
fit and the covariance from its curvature. A parameter with another input is held there,
and the others are sampled conditionally on its value:

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

from ...errors import InputError, nearest
from ...io.files import read_input
from ...parameters import parts_of
from ...scene import Soil
from ..random_inputs import uniforms
from ..terrain import ground_columns

FILE = "fit.json"
"""Name of the file in a calibration's directory."""
LEAST_EFFECTIVE = 0.1
"""Least effective sample size of a calibration, as a fraction of its samples, for them
to be used."""
ATTEMPTS = 100
"""Number of samples for a block until one lies between the bounds."""


class Calibrated(NamedTuple):
    """Posterior of the ground's parameters from a calibration."""

    file: Path
    checksum: str
    """SHA-256 of the file."""
    soil: Soil
    """Soil with the laws of the calibration."""
    fixed: dict[str, float]
    """Values of the soil in the calibration, in the units of their names."""
    names: tuple[str, ...]
    """Names of the fitted parameters."""
    undetermined: dict[str, str]
    """Reasons why parameters are not identifiable, by name."""
    mean: np.ndarray
    """Mean of the coordinates x, `(parameters,)`."""
    covariance: np.ndarray
    """Covariance of x, `(parameters, parameters)`."""
    lower: np.ndarray
    """Lower bounds of the parameters, in the units of their names, `(parameters,)`."""
    upper: np.ndarray
    """Upper bounds, likewise."""

    @property
    def scale(self) -> np.ndarray:
        """Half ranges h, `(parameters,)`."""
        return 0.5 * (self.upper - self.lower)

    def coordinates(self, values: np.ndarray) -> np.ndarray:
        """Transform values `(blocks, parameters)` to the coordinates x."""
        logarithm = np.log(np.where(self.lower > 0.0, values, 1.0))
        return np.where(self.lower > 0.0, logarithm, values / self.scale)

    def values(self, x: np.ndarray) -> np.ndarray:
        """Transform coordinates x to values, the inverse of `coordinates`."""
        exponential = np.exp(np.where(self.lower > 0.0, x, 0.0))
        return np.where(self.lower > 0.0, exponential, x * self.scale)

    def draw(
        self, given: Mapping[str, np.ndarray], count: int, seed: int
    ) -> dict[str, np.ndarray]:
        """Sample the parameters that are not given, `(count,)` each; block i gets the
        same whatever the count.

        Args:
            given: values of the other parameters, `(count,)` each.
        """
        is_given = np.array([name in given for name in self.names], bool)
        others, held = np.flatnonzero(~is_given), np.flatnonzero(is_given)
        if not len(others):
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
                    ndtri(
                        uniforms(seed, f"calibrated {self.names[i]}, {attempt}", count)
                    )
                    for i in others
                ],
                axis=1,
            )
            x = self.coordinates(values)
            x[:, others] = centre + standard @ root.T
            tried = self.values(x)
            inside = np.all((tried >= self.lower) & (tried <= self.upper), axis=1)
            accepted = np.ix_(np.flatnonzero(open_yet & inside), others)
            values[accepted] = tried[accepted]
            open_yet &= ~inside
            if not np.any(open_yet):
                return {self.names[i]: values[:, i] for i in others}
        raise InputError(
            "holds parameters of which hardly any draw lies between the bounds of the "
            "fit; say them under [ground]",
            file=self.file,
        )


def read_calibrated(path: Path, variant: str | None = None) -> Calibrated:
    """Read the posterior that `jaximpact calibrate` wrote.

    Args:
        path: directory of the calibration, or fit.json in there.
        variant: name of the study's variant, if it has several.

    Raises InputError, naming the file, for whatever cannot be used.
    """
    path = Path(path)
    file = path / FILE if os.path.isdir(path) else path
    data = read_input(file, once=False)
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
        _refuse_ties(file, content["manifest"].get("tied"))
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
        mean, covariance = _posterior(
            found, places, calibrated.coordinates(np.array(best, float))
        )
        # A slope is a group of its own.
        own = [_group_variance(content["manifest"], name) for name in names]
        covariance = covariance + np.diag(own)
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


def _refuse_ties(file: Path, tied: list | dict | None) -> None:
    if tied:
        raise InputError(
            f"has {', '.join(tied)} tied to other parameters by an expression, which a "
            "run-out does not take; say the values under [ground]",
            file=file,
        )


def _posterior(
    found: dict, places: list[int], best: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Read mean and covariance of the parameters, in the coordinates of the fit.

    Args:
        found: what fit.json says of the variant.
        places: places of the parameters among the unknowns.
        best: coordinates of the best fit.

    Raises ValueError or LinAlgError for a covariance that cannot be sampled from.
    """
    draws = found.get("draws")
    if draws and draws["effective_parts"][-1] >= LEAST_EFFECTIVE:
        mean, covariance = np.array(draws["mean"], float)[places], draws["covariance"]
    else:
        mean, covariance = best, found["covariance_of_logarithms_or_half_ranges"]
    covariance = np.array(covariance, float)[np.ix_(places, places)]
    if not np.all(np.isfinite(covariance)) or not np.all(np.isfinite(mean)):
        raise ValueError("no finite covariance")
    np.linalg.cholesky(covariance)
    return mean, covariance


def _group_variance(manifest: dict, name: str) -> float:
    """Compute the variance of the logarithm of a new group's factor on a parameter; 0
    for a parameter without groups."""
    entry = manifest.get("nuisances", {}).get(name, {})
    if not entry.get("pooled"):
        return 0.0
    return float(entry["prior"]["sd"]) ** 2


def _soil(file: Path, manifest: dict, variant: dict) -> Soil:
    """Make a soil with the laws of a calibration."""
    entries = manifest.get("parts", {}) | variant.get("parts", {})
    if not entries:
        return Soil()
    # A late import: it brings in all of the calibration, not needed without laws.
    from ...calibration.problem.laws import parts_of_entries

    parts = parts_of_entries(entries, file)
    return Soil(**{slot: parts[slot] for slot in parts_of(Soil) if slot in parts})


def _variant(file: Path, variants: list[dict], wanted: str | None) -> dict:
    names = [variant["name"] for variant in variants]
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
