"""What is made small: the differences between predicted and measured, by sigma."""

import dataclasses
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from ..columns import INPUT_COLUMNS, RESULT_COLUMNS
from ..problem import Assembly
from ..scene import Scene
from ..simulation import compute_lanes
from .transforms import Bounds, Parameters

FAILED_RESIDUAL = 1e3
"""Stands, with derivative zero, for a result that could not be computed: large, so that
a fit keeps away, and finite, so that it does not spoil the rest."""

Targets = Float[Array, "tests targets"]


class Program(NamedTuple):
    """What is compiled; the numbers are in the case."""

    assembly: Assembly
    fitted: tuple[str, ...]
    """Columns of the fitted soil parameters."""
    targets: tuple[str, ...]
    """Columns of the results that were measured."""


class Case(NamedTuple):
    """The numbers of a fit."""

    scene: Scene
    """The tests: every field an array `(tests,)`, the soil with its fixed values."""
    measured: Targets
    sigma: Targets
    bounds: Bounds
    tolerance: Float[Array, ""]
    floor: Float[Array, ""]


class Residuals(NamedTuple):
    """Residuals of all tests and targets, flat, tests first."""

    values: Float[Array, " residuals"]
    failed: Float[Array, " residuals"]
    """1 where there is no prediction, else 0."""


def predict(program: Program, case: Case, parameters: Parameters) -> Targets:
    """Predictions of all tests, NaN where there is none.

    Args:
        parameters: of the soil, in the units of their columns.
    """

    scene = case.scene
    tests = scene.block.mass.shape
    changed = {
        INPUT_COLUMNS[name].field: jnp.broadcast_to(
            INPUT_COLUMNS[name].factor * value, tests
        )
        for name, value in zip(program.fitted, parameters, strict=True)
    }
    soil = dataclasses.replace(scene.soil, **changed)
    numbers = compute_lanes(
        program.assembly,
        Scene(scene.block, soil, scene.impact),
        case.tolerance,
        case.floor,
    )
    fields = [RESULT_COLUMNS[name].field for name in program.targets]
    return jnp.stack([getattr(numbers, field) for field in fields], axis=-1)


def residuals(program: Program, case: Case, parameters: Parameters) -> Residuals:
    """Residuals for one soil; finite for every soil."""
    predicted = predict(program, case, parameters)
    known = jnp.isfinite(predicted)
    difference = (predicted - case.measured) / case.sigma
    values = jnp.where(known, difference, FAILED_RESIDUAL)
    failed = jnp.where(known, 0.0, 1.0)
    return Residuals(values.ravel(), failed.ravel())


def function_of_reals(program: Program, case: Case):
    """The residuals as a function of z, for a solver of least squares.

    Returns:
        `f(z, free, anchor)`, with `free` 1 where a parameter is fitted and 0 where it
        stays at that of `anchor`. Its derivative by z is taken forward through the
        integration, all columns at once, and is a matrix from then on: whatever the
        solver does with it, the impacts are integrated once.
    """

    def plain(z, free, anchor):
        used = jnp.where(free > 0.0, z, anchor)
        return residuals(program, case, case.bounds.parameter(used))

    function = jax.custom_jvp(plain)

    @function.defjvp
    def _(primals, tangents):
        z, free, anchor = primals

        def with_value(z):
            out = plain(z, free, anchor)
            return out.values, out

        jacobian, out = jax.jacfwd(with_value, has_aux=True)(z)
        return out, Residuals(jacobian @ tangents[0], jnp.zeros_like(out.failed))

    return function
