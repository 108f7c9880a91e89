r"""Posterior of the ground's parameters, from the calibration that a study names.

Each block gets one of the samples of the fit, by their weights. Where the study gives a
value $p_g$ for some of the parameters, the others of the sample follow by the
regression on these, in the coordinates x of the fit:

$$ x_o + C_{og} C_{gg}^{-1} (x(p_g) - x_g) $$

with the covariance C of the samples; for a normal posterior that is the conditional
distribution.
"""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.special import ndtri

from ...errors import InputError, did_you_mean
from ...io.checks import warn_unusual
from ...io.files import read_input
from ...parameters import parts_of
from ...quantities import InputColumn
from ...scene import Soil
from ..random_inputs import uniforms
from ..terrain import ground_columns

if TYPE_CHECKING:
    # All of the calibration, which takes a while to load.
    from ...calibration.fitted_ground import FittedGround, FittedVariant
    from ...calibration.problem.bounds import Bounds


class Calibrated(NamedTuple):
    """Posterior of the ground's parameters from a calibration."""

    file: Path
    checksum: str  # SHA-256 of the file
    soil: Soil  # soil with the laws of the calibration
    fixed: dict[str, float]  # values that were not fitted, in their units
    differing: dict[str, str]  # how values that the tests do not share differ, by name
    names: tuple[str, ...]  # names of the fitted parameters
    undetermined: dict[str, str]  # reasons why parameters are not identifiable, by name
    bounds: "Bounds"  # Bounds and coordinates of the fit
    samples: np.ndarray  # samples of the coordinates x, `(samples, parameters)`
    weights: np.ndarray  # weights of the samples, of sum 1, `(samples,)`
    group_sd: np.ndarray
    """Standard deviation of the logarithm of a group's factor on each parameter,
    `(parameters,)`; 0 for one that does not differ by group."""

    def draw(
        self, said: Mapping[str, np.ndarray], count: int, seed: int
    ) -> dict[str, np.ndarray]:
        """Sample the parameters that are not given, `(count,)` each as the given ones;
        block i gets the same whatever the count."""
        is_given = np.array([name in said for name in self.names], bool)
        others, fixed = np.flatnonzero(~is_given), np.flatnonzero(is_given)
        if not len(others):
            return {}
        place = np.searchsorted(
            np.cumsum(self.weights), uniforms(seed, "calibrated", count)
        )
        x = self.samples[np.minimum(place, len(self.weights) - 1)]
        # A slope is a group of its own.
        for i in np.flatnonzero(self.group_sd):
            stream = f"calibrated {self.names[i]}"
            x[:, i] += self.group_sd[i] * ndtri(uniforms(seed, stream, count))
        if len(fixed):
            values = self.bounds.parameter(x)
            for i in fixed:
                values[:, i] = said[self.names[i]]
                self._check(int(i), values[:, i])
            covariance = np.cov(self.samples.T, aweights=self.weights, ddof=0)
            covariance = np.atleast_2d(covariance) + np.diag(self.group_sd**2)
            across = np.linalg.pinv(covariance[np.ix_(fixed, fixed)])
            across = across @ covariance[np.ix_(fixed, others)]
            apart = self.bounds.coordinate(values)[:, fixed] - x[:, fixed]
            x[:, others] += apart @ across
        values = np.clip(self.bounds.parameter(x), self.bounds.lower, self.bounds.upper)
        return {self.names[i]: values[:, i] for i in others}

    def _check(self, place: int, values: np.ndarray) -> None:
        low, high = self.bounds.lower[place], self.bounds.upper[place]
        bad = ~((values >= low) & (values <= high))
        if np.any(bad):
            raise InputError(
                f"was fitted with {self.names[place]} between {low:g} and {high:g}, "
                f"but it is {values[bad][0]:g} for block {np.argmax(bad)}",
                file=self.file,
            )


def read_calibrated(path: Path, variant: str | None = None) -> Calibrated:
    """Read the posterior that `jaximpact calibrate` wrote: from its directory, or from
    fit.json in there; of one variant of the study, if it has several.

    Raises InputError, naming the file, for whatever cannot be used; warns of samples
    that hardly tell the posterior.
    """
    from ...calibration.fitted_ground import FILE, ground_of_tests, read_fitted
    from ...calibration.problem.bounds import Bounds

    file = path / FILE if path.is_dir() else path
    checksum = hashlib.sha256(read_input(file, once=False)).hexdigest()
    ground = read_fitted(file)
    fit = _variant(file, ground, variant)
    if ground.tied:
        raise InputError(
            f"has {', '.join(tied.name for tied in ground.tied)} tied to other "
            "parameters by an expression, which a run-out does not take; say the "
            "values under [ground]",
            file=file,
        )
    parts = ground.parts | fit.variant.laws
    soil = Soil(**{slot: parts[slot] for slot in parts_of(Soil) if slot in parts})
    names = tuple(parameter.name for parameter in ground.parameters)
    columns = ground_columns(soil)
    known = {*names, *ground.nuisances}
    shared, ranges = ground_of_tests(ground.ranges, columns, known)
    differing = _differing(ground, columns, ranges)
    fixed = shared | ground.soil | fit.variant.soil
    unknown = [name for name in (*names, *fixed) if name not in columns]
    if unknown:
        raise InputError(f"holds {unknown[0]}, which no ground has", file=file)
    if not fit.trusted:
        count = 1.0 / np.sum(fit.weights**2)
        warn_unusual(
            f"the effective sample size is {count:.0f} of {len(fit.weights)} samples, "
            "too small for the spread of the ground; `jaximpact calibrate --posterior` "
            "samples the posterior itself",
            "from",
            file=file,
        )
    ends = [(p.lower, p.upper, p.logarithmic) for p in ground.parameters]
    lower, upper, logarithmic = np.array(ends, float).reshape(-1, 3).T
    bounds = Bounds(lower, upper, logarithmic.astype(bool))
    places = [fit.unknowns.index(name) for name in names]
    groups = (ground.nuisances.get(name, {}) for name in names)
    return Calibrated(
        file=file,
        checksum=checksum,
        soil=soil,
        fixed={name: float(value) for name, value in fixed.items()},
        differing={n: how for n, how in differing.items() if n not in fixed},
        names=names,
        undetermined=fit.undetermined,
        bounds=bounds,
        samples=bounds.coordinate(fit.draws[:, places]),
        weights=fit.weights,
        group_sd=np.array(
            [entry["prior"]["sd"] if entry.get("pooled") else 0.0 for entry in groups]
        ),
    )


def _differing(
    ground: "FittedGround",
    columns: Mapping[str, InputColumn],
    ranges: Mapping[str, tuple[float, float]],
) -> dict[str, str]:
    """Say how quantities of the ground differ from test to test."""
    return {
        n: f"is {low:g} to {high:g} in the tests" for n, (low, high) in ranges.items()
    } | {
        name: f"has a value for each {entry['by']} in the tests"
        for name, entry in ground.nuisances.items()
        if name in columns and not entry.get("pooled")
    }


def _variant(file: Path, ground: "FittedGround", wanted: str | None) -> "FittedVariant":
    fits = {fit.variant.name: fit for fit in ground.variants}
    if wanted is None and len(fits) == 1:
        return ground.variants[0]
    if wanted is None:
        raise InputError(
            f"has {len(fits)} variants; variant must say which: {', '.join(fits)}",
            file=file,
        )
    if wanted not in fits:
        raise InputError(
            f"has no variant {wanted!r}; {did_you_mean(wanted, fits, repr)}",
            file=file,
        )
    return fits[wanted]
