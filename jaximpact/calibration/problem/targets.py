"""Targets, which a study compares with the tests, with weights, sigmas and scatter."""

import numpy as np

from ...errors import InputError, did_you_mean
from ...io.toml import Key, choice, typed, unknown
from ...quantities import (
    CURVE_COLUMNS,
    CURVE_FILE,
    RESULT_COLUMNS,
    TARGET_COLUMNS,
    TIME_COLUMN,
)
from .dataset import Measurements
from .noise import PROPORTIONAL, SCATTERS, least_size, root_mean_square
from .nuisance import Nuisance, read_size

NOMINAL_SIGMA = 0.05
"""Nominal sigma, where none is given, over a target's root mean square, or over each
value where scatter is proportional."""
DECADE = 10.0
"""Ratio of the largest and the smallest value of a target from which its kind of
scatter is chosen by the fit, unless it is stated."""


def read_targets(
    top: Key, content: dict, tests: Measurements, nuisances: tuple[Nuisance, ...]
) -> dict:
    """Read the fields of `Study` that hold targets, measurements, sigmas and
    weights."""
    targets = _targets(top, content, tests, nuisances)
    sigma, sigma_given = _sigma(top, content, tests, targets)
    proportional = _proportional(top, content, targets, sigma_given)
    measured = np.stack([tests.measured[name] for name in targets], axis=1)
    censored = np.stack([tests.censored[name] for name in targets], axis=1)
    size = np.fmax(np.abs(measured), least_size(measured, censored))
    weights = _of_targets(top, content, "weights", targets)
    return dict(
        targets=targets,
        measured=measured,
        censored=censored,
        sigma=np.where(proportional, NOMINAL_SIGMA * size, sigma),
        sigma_given=sigma_given,
        proportional=proportional,
        scatter_open=_open(content, targets, sigma_given, measured, censored),
        weights=np.array([float(weights.get(name, 1.0)) for name in targets]),
    )


def _targets(top: Key, content: dict, tests: Measurements, nuisances):
    first = tests.files[0].path
    present = [n for n, values in tests.measured.items() if np.any(np.isfinite(values))]
    if not tests.measured:
        raise InputError(
            "has no measured result to fit; add a column like e_n, or any of "
            f"{', '.join(list(RESULT_COLUMNS)[1:])}",
            file=first,
        )
    targets = typed(top, content, "targets", list, present or [*tests.measured])
    key = top["targets"]
    if not targets:
        raise key.error("names no result to fit")
    for name in targets:
        if name not in tuple(TARGET_COLUMNS):
            raise key.error(
                f"{name!r} is unknown; {did_you_mean(name, TARGET_COLUMNS)}"
            )
        if name not in tests.measured:
            raise key.error(f"{name} is no column of {first.name}")
        if targets.count(name) > 1:
            raise key.error(f"{name} stands twice")
        known = np.isfinite(tests.measured[name])
        if not np.any(known):
            raise InputError("holds no measurement; remove it", file=first, column=name)
        timed = tests.at_times(targets)
        if name not in CURVE_COLUMNS and np.any(known & timed):
            problem = (
                f"stands in a row with {TIME_COLUMN}, where forces alone are compared; "
                f"give it a row of its own, without {TIME_COLUMN}"
            )
            raise tests.error(np.flatnonzero(known & timed)[0], name, problem)
        if name in CURVE_COLUMNS and np.any(known & ~timed):
            raise InputError(
                f"needs {TIME_COLUMN} in its row, the time since first touch, or a "
                f"file of its curve in the column {CURVE_FILE}",
                file=first,
                column=name,
            )
    angles = tests.inputs.get("angle_deg", np.zeros(len(tests)))
    moved = any(nuisance.name == "angle_deg" for nuisance in nuisances)
    if "e_t" in targets and not moved:
        along_normal = np.isfinite(tests.measured["e_t"]) & (angles == 0.0)
        for test in np.flatnonzero(along_normal)[:1]:
            problem = "e_t has no meaning at angle_deg 0; leave the cell empty"
            raise tests.error(test, "e_t", problem)
    return tuple(targets)


def _of_targets(
    top: Key, content: dict, table: str, targets: tuple[str, ...]
) -> dict[str, float]:
    """Read a table of positive numbers for targets."""
    values = typed(top, content, table, dict, {})
    for name, value in values.items():
        if name not in TARGET_COLUMNS:
            raise unknown(top[table], name, TARGET_COLUMNS)
        read_size(top[table][name], value)
        if name not in targets:
            raise top[table][name].error(
                f"is for a result that is not fitted; targets are {', '.join(targets)}"
            )
    return values


def _sigma(top, content, tests, targets) -> tuple[np.ndarray, np.ndarray]:
    """Collect sigmas (tests, targets), and the mask of targets with given ones."""
    defaults = _of_targets(top, content, "default_sigma", targets)
    columns, is_given = [], []
    for name in targets:
        measured = tests.measured[name]
        sigma = tests.stated_sigma(name)
        if name in defaults:
            sigma = np.where(np.isfinite(sigma), sigma, float(defaults[name]))
        stated = bool(np.any(np.isfinite(sigma)))
        if not stated:
            scale = root_mean_square(measured, tests.censored[name])
            sigma = np.full(len(tests), NOMINAL_SIGMA * scale)
        for test in np.flatnonzero(np.isfinite(measured) & ~np.isfinite(sigma))[:1]:
            problem = (
                f"has no sigma_{name}, but other rows have; give all, or a sigma for "
                f"the rest, default_sigma.{name} in a study"
            )
            raise tests.error(test, name, problem)
        # Without a measurement any number serves, but not NaN.
        columns.append(np.where(np.isfinite(sigma), sigma, np.nanmedian(sigma)))
        is_given.append(stated)
    return np.stack(columns, axis=1), np.array(is_given)


def _open(content, targets, sigma_given, measured, censored) -> tuple[str, ...]:
    """List the targets whose kind of scatter the fit chooses, by their exact values."""
    stated = content.get("scatter", {})
    if isinstance(stated, str):
        return ()
    # With `fmax` an empty cell would count as a small value.
    exact = np.isfinite(measured) & (censored == 0)
    size = np.maximum(np.abs(measured), least_size(measured, censored))
    largest = np.max(size, axis=0, where=exact, initial=0.0)
    wide = largest >= DECADE * np.min(size, axis=0, where=exact, initial=np.inf)
    below = np.any(exact & (measured < 0.0), axis=0)
    of_one_sign = ~(below & np.any(exact & (measured > 0.0), axis=0))
    chosen = zip(targets, wide & of_one_sign & ~sigma_given, strict=True)
    return tuple(name for name, is_open in chosen if is_open and name not in stated)


def _proportional(top, content, targets, sigma_given) -> np.ndarray:
    """Find the targets whose scatter is stated as proportional, shape (targets,)."""
    key, stated = top["scatter"], content.get("scatter", {})
    if isinstance(stated, str):
        # One word holds for all targets whose sigmas are estimated.
        choice(top, content, "scatter", stated, SCATTERS)
        if np.all(sigma_given):
            raise key.error("is for sigmas that are estimated, but all are given")
        return ~sigma_given & (stated == PROPORTIONAL)
    if not isinstance(stated, dict):
        raise key.error(
            f"must be one of {', '.join(SCATTERS)}, or a table of them by target, but "
            f"is {stated!r}"
        )
    for name, word in stated.items():
        if name not in TARGET_COLUMNS:
            raise unknown(key, name, TARGET_COLUMNS)
        choice(key, stated, name, word, SCATTERS)
        if name in targets and sigma_given[targets.index(name)]:
            raise key[name].error(
                f"is for a sigma that is estimated, but that of {name} is given"
            )
    return np.array([stated.get(name) == PROPORTIONAL for name in targets])
