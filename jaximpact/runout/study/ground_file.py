r"""Ground of a study, from its file and from the calibration that it names.

From a calibration each block gets one of the samples of the fit, by their weights.
Where the study gives a value $p_g$ for some of the parameters, the others of the sample
follow by the regression on these, in the coordinates x of the fit:

$$ x_o + C_{og} C_{gg}^{-1} (x(p_g) - x_g) $$

with the covariance C of the samples; for a normal posterior that is the conditional
distribution.
"""

import hashlib
import re
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np
from scipy.special import ndtri

from ...errors import InputError, UnusualValueWarning, nearest
from ...io.files import read_input
from ...io.toml import Key, number, typed, unknown, with_named_parts
from ...parameters import parts_of
from ...scene import Soil
from ..random_inputs import Quantity, RandomField, uniforms
from ..terrain import Ground, ground_columns, ground_values, with_ground_values
from .ground_layout import GroundLayout, GroundPart
from .quantity import read_ground_quantity

if TYPE_CHECKING:
    # All of the calibration, which takes a while to load.
    from ...calibration.fitted_ground import FittedGround, FittedVariant
    from ...calibration.problem.bounds import Bounds


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
    bounds: "Bounds"
    """Bounds and coordinates of the fit."""
    samples: np.ndarray
    """Samples of the coordinates x, `(samples, parameters)`."""
    weights: np.ndarray
    """Weights of the samples, of sum 1, `(samples,)`."""
    group_sd: np.ndarray
    """Standard deviation of the logarithm of a group's factor on each parameter,
    `(parameters,)`; 0 for one that does not differ by group."""

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
        place = np.searchsorted(
            np.cumsum(self.weights), uniforms(seed, "calibrated", count)
        )
        x = self.samples[np.minimum(place, len(self.weights) - 1)]
        # A slope is a group of its own.
        for i in np.flatnonzero(self.group_sd):
            stream = f"calibrated {self.names[i]}"
            x[:, i] += self.group_sd[i] * ndtri(uniforms(seed, stream, count))
        if len(held):
            values = self.bounds.parameter(x)
            for i in held:
                values[:, i] = given[self.names[i]]
                self._check(int(i), values[:, i])
            covariance = np.cov(self.samples.T, aweights=self.weights, ddof=0)
            covariance = np.atleast_2d(covariance) + np.diag(self.group_sd**2)
            across = np.linalg.pinv(covariance[np.ix_(held, held)])
            across = across @ covariance[np.ix_(held, others)]
            apart = self.bounds.coordinate(values)[:, held] - x[:, held]
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
    """Read the posterior that `jaximpact calibrate` wrote.

    Args:
        path: directory of the calibration, or fit.json in there.
        variant: name of the study's variant, if it has several.

    Raises InputError, naming the file, for whatever cannot be used; warns of samples
    that hardly tell the posterior.
    """
    from ...calibration.fitted_ground import FILE, read_fitted
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
    fixed = ground.soil | fit.variant.soil
    columns = ground_columns(soil)
    unknown = [name for name in (*names, *fixed) if name not in columns]
    if unknown:
        raise InputError(f"holds {unknown[0]}, which no ground has", file=file)
    if not fit.trusted:
        count = 1.0 / np.sum(fit.weights**2)
        text = (
            f"{file}: the effective sample size is {count:.0f} of {len(fit.weights)} "
            "samples, too small for the spread of the ground; `jaximpact calibrate "
            "--posterior` samples the posterior itself"
        )
        warnings.warn(UnusualValueWarning(text, "from"), stacklevel=1)
    bounds = Bounds(
        np.array([parameter.lower for parameter in ground.parameters], float),
        np.array([parameter.upper for parameter in ground.parameters], float),
        np.array([parameter.logarithmic for parameter in ground.parameters], bool),
    )
    places = [fit.unknowns.index(name) for name in names]
    groups = (ground.nuisances.get(name, {}) for name in names)
    return Calibrated(
        file=file,
        checksum=checksum,
        soil=soil,
        fixed={name: float(value) for name, value in fixed.items()},
        names=names,
        undetermined=fit.undetermined,
        bounds=bounds,
        samples=bounds.coordinate(fit.draws[:, places]),
        weights=fit.weights,
        group_sd=np.array(
            [entry["prior"]["sd"] if entry.get("pooled") else 0.0 for entry in groups]
        ),
    )


def _variant(file: Path, ground: "FittedGround", wanted: str | None) -> "FittedVariant":
    fits = {fit.variant.name: fit for fit in ground.variants}
    if wanted is None and len(fits) == 1:
        return ground.variants[0]
    if wanted is None:
        raise InputError(
            f"holds {len(fits)} variants; variant must say which: {', '.join(fits)}",
            file=file,
        )
    if wanted not in fits:
        raise InputError(
            f"holds no variant {wanted!r}; did you mean {nearest(wanted, [*fits])!r}?",
            file=file,
        )
    return fits[wanted]


LAWS = tuple(parts_of(Soil))
"""Keys of the ground that name laws."""
PARTS = ("segment", "materials")
NO_QUANTITIES = (*PARTS, "from", "variant", *LAWS)
"""Keys of the ground that are no quantities."""
ENDS = ("from_x_m", "to_x_m")
"""Keys of a material that are no quantities."""
SEGMENT_NAME, MATERIAL_NAME = "[1-9][0-9]*|0", r"[A-Za-z0-9_-]+"


class GroundInput(NamedTuple):
    """Ground as the file says it, in the units of its names."""

    path: Path
    soil: Soil
    """Soil with the laws; the values of parameters are in the other fields."""
    everywhere: dict[str, Quantity | RandomField]
    """Quantities of the whole slope, by name."""
    parts: dict[str, GroundPart]
    """Segments and materials with quantities of their own, by key."""
    calibrated: Calibrated | None
    """Calibration to sample parameters from, other than those in `everywhere`."""

    @classmethod
    def read(cls, path: Path, content: dict) -> "GroundInput":
        """Read the table [ground] of a study."""
        top = Key(path)
        key, table = top["ground"], typed(top, content, "ground", dict, {})
        calibrated = _calibrated(key, table)
        soil = calibrated.soil if calibrated else Soil()
        soil = cast(Soil, with_named_parts(key, table, soil))
        if all(kind in table for kind in PARTS):
            raise key.error(
                "has segments and materials; say what differs along the slope by one "
                "of them"
            )
        parts = _segments(key, table, soil) | _materials(key, table, soil)
        everywhere = {k: v for k, v in table.items() if k not in NO_QUANTITIES}
        everywhere = _quantities(key, everywhere, soil, NO_QUANTITIES)
        if calibrated is not None:
            _check_calibrated(key, table, calibrated, everywhere)
            everywhere = calibrated.fixed | everywhere
        return cls(path, soil, everywhere, parts, calibrated)

    def sampled_jointly(self) -> dict[str, str]:
        """List the parameters that are sampled from a calibration, by key."""
        names = self.calibrated.names if self.calibrated else ()
        return {f"ground.{n}": n for n in names if n not in self.everywhere}

    def sample_jointly(
        self, samples: Mapping[str, np.ndarray], count: int, seed: int
    ) -> dict[str, np.ndarray]:
        """Sample these parameters.

        Args:
            samples: samples of the quantities of `varied`, by key.

        Returns:
            Samples `(count,)` by key.
        """
        if self.calibrated is None or not self.sampled_jointly():
            return {}
        given = {}
        for name, value in self.everywhere.items():
            if name in self.calibrated.names:
                sampled = samples.get(f"ground.{name}")
                # Without samples a number: fields are refused beside a calibration.
                given[name] = np.full(count, value) if sampled is None else sampled
        found = self.calibrated.draw(given, count, seed)
        return {f"ground.{name}": values for name, values in found.items()}

    def _by_key(self) -> dict[str, Quantity | RandomField]:
        keys = {f"ground.{name}": q for name, q in self.everywhere.items()}
        for part in self.parts.values():
            keys |= {f"ground.{part.key}.{n}": q for n, q in part.quantities.items()}
        return keys

    def varied(self) -> dict[str, Quantity]:
        """List the quantities that differ from block to block by themselves, by key."""
        keys = self._by_key().items()
        return {k: q for k, q in keys if not isinstance(q, float | RandomField)}

    def fields(self) -> dict[str, RandomField]:
        """List the quantities that vary along the slope, by key."""
        return {k: q for k, q in self._by_key().items() if isinstance(q, RandomField)}

    def sample_fields(
        self, layout: GroundLayout, count: int, seed: int
    ) -> dict[str, np.ndarray]:
        """Sample these, `(count, segments where they hold)` by key."""
        start = layout.profile.x[0]
        return {
            key: field.values(
                key, field.cells(layout.middles[layout.where(key)], start), count, seed
            )
            for key, field in self.fields().items()
        }

    def of_blocks(self, layout: GroundLayout, samples: Mapping, seed: int) -> Ground:
        """Make the ground as each block finds it.

        Args:
            samples: samples by the keys of `varied`, `fields` and `sampled_jointly`.
        """
        profile = layout.profile
        columns, found = ground_columns(profile.soil), ground_values(profile)
        for key in (*self.sampled_jointly(), *self.varied(), *self.fields()):
            name = key.split(".")[-1]
            own = samples[key].reshape(len(samples[key]), -1)
            values, where = columns[name].factor * own, layout.where(key)
            if not np.all(where):
                whole = np.broadcast_to(found[name], (len(values), profile.segments))
                whole = np.array(whole)
                whole[:, where] = values
                values = whole
            found[name] = values
        return Ground(*with_ground_values(profile.soil, found), seed)


def _segments(ground: Key, table: dict, soil: Soil) -> dict[str, GroundPart]:
    parts, segments = {}, typed(ground, table, "segment", dict, {})
    for name in segments:
        key = ground["segment"][name]
        if not re.fullmatch(SEGMENT_NAME, name):
            raise key.error("must be the number of a segment")
        values = typed(ground["segment"], segments, name, dict)
        quantities = _quantities(key, values, soil)
        parts[f"segment.{name}"] = GroundPart(
            f"segment.{name}", quantities, int(name) - 1
        )
    return parts


def _materials(ground: Key, table: dict, soil: Soil) -> dict[str, GroundPart]:
    parts, materials = {}, typed(ground, table, "materials", dict, {})
    for name in materials:
        key = ground["materials"][name]
        if not re.fullmatch(MATERIAL_NAME, name):
            raise key.error("must be a name of letters, digits, _ and -")
        values = dict(typed(ground["materials"], materials, name, dict))
        ends = [number(key[end], values.pop(end)) for end in ENDS if end in values]
        quantities = _quantities(key, values, soil, ENDS)
        if len(ends) == 1 or (ends and not ends[0] < ends[1]):
            raise key.error("needs from_x_m and to_x_m, the larger one")
        parts[f"materials.{name}"] = GroundPart(
            f"materials.{name}", quantities, ends=tuple(ends) or None
        )
    return parts


def _quantities(
    table: Key, values: dict, soil: Soil, others: tuple = ()
) -> dict[str, Quantity | RandomField]:
    """Read quantities of the ground.

    Args:
        others: further keys that the table may hold.
    """
    columns = ground_columns(soil)
    for name in values:
        if name in LAWS:
            raise table[name].error(
                f"names a law of one part of the slope, but a slope has one {name} for "
                "all; name it under [ground]"
            )
        if name not in columns:
            raise unknown(table, name, (*columns, *others))
    return {
        name: read_ground_quantity(table[name], value, columns[name])
        for name, value in values.items()
    }


def _calibrated(ground: Key, table: dict) -> Calibrated | None:
    """Read the calibration that the table names, if it names one."""
    if "from" not in table:
        if "variant" in table:
            raise ground["variant"].error("needs from too")
        return None
    variant = typed(ground, table, "variant", str) if "variant" in table else None
    directory = ground.file.parent
    return read_calibrated(directory / typed(ground, table, "from", str), variant)


def _check_calibrated(
    key: Key, table: dict, calibrated: Calibrated, said: dict
) -> None:
    """Raise InputError for a law beside a calibration, for a parameter that is neither
    in the table nor identifiable, and for a fitted one that varies along the slope.

    Args:
        said: quantities in the table.
    """
    for slot in LAWS:
        if slot in table:
            raise key[slot].error(
                "comes with the calibration that from names; remove it"
            )
    for name, reason in calibrated.undetermined.items():
        if name not in said:
            raise key.error(
                f"must say {name}, which the tests do not determine: {reason}"
            )
    for name in calibrated.names:
        if isinstance(said.get(name), RandomField):
            raise key[name].error(
                "varies along the slope, but the calibration samples other parameters "
                "conditional on it; leave out correlation_length_m"
            )
