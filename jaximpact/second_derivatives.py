"""Second derivatives by differences of first ones: an impact has no others."""

from collections.abc import Callable
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jax.flatten_util import ravel_pytree

from ._checks import real_number
from .errors import InputError

STEP = 1e-2
"""Step of the differences. First derivatives of `e_n` are smooth to 3e-6 at "balanced"
and 1e-8 at "reference"; the second ones, some 0.01, come out to 2 % and to 1e-4."""


def with_second_derivatives(
    function: Callable[[Any], Any], step: float = STEP
) -> Callable[[Any], Any]:
    """Make a function that calls `simulate` twice differentiable.

    For what asks for a Hessian and takes no other: Laplace approximations, implicit
    differentiation of an optimum, `check_grads(order=2)`. A fit by least squares does
    better with `J.T @ J`, of first derivatives alone.

    Args:
        function: of one array, or tree of arrays, of parameters whose size is about
            one, such as their logarithms. Whole numbers in it are not moved.
        step: by which each parameter is moved, to either side.

    Returns:
        The function, with the same values and first derivatives. The second ones are
        central differences of its Jacobian, and the same in either order. They take two
        Jacobians for each parameter. There are no third ones. Where a result is NaN a
        step to either side, as of an impact beyond the end of a range, second
        derivatives of it are NaN. Where the outcome is another there, as beyond an
        impact angle of 90 degrees, where the block separates, they are numbers and mean
        nothing. A smaller step stays on this side of both.

    Raises InputError for a step that is no number above 0 and, as it is differentiated,
    for results that are whole numbers.
    """
    step = real_number("step", step)
    if step <= 0.0:
        raise InputError(f"step must be above 0, but is {step:g}")

    @jax.custom_jvp
    def twice(parameters):
        return function(parameters)

    @twice.defjvp
    def first(primals, tangents):
        (parameters,), (tangent,) = primals, tangents
        value = function(parameters)
        for leaf in jax.tree.leaves(value):
            if not _is_real(leaf):
                raise InputError(
                    "with_second_derivatives needs a function of real results alone, "
                    f"but one of them is of type {jnp.result_type(leaf)}"
                )
        are_moved = jax.tree.map(_is_real, parameters)
        moved, fixed = eqx.partition(parameters, are_moved)
        at, tree = ravel_pytree(moved)
        along = ravel_pytree(eqx.filter(tangent, are_moved))[0]
        restored = ravel_pytree(value)[1]

        def once(at, fixed):
            """Return the Jacobian, and the values of which it is."""

            def values(at):
                flat = ravel_pytree(function(eqx.combine(tree(at), fixed)))[0]
                return flat, flat

            return jax.jacfwd(values, has_aux=True)(at)

        @jax.custom_jvp
        def jacobian(at, fixed):
            return once(at, fixed)[0]

        @jacobian.defjvp
        def second(primals, tangents):
            (at, fixed), (along, _) = primals, tangents
            here, values = once(at, fixed)

            def neighbours(moves):
                """Return Jacobians beside, NaN where a value is though it is not here:
                derivatives of an impact that fails are 0."""
                several = jax.vmap(once, (0, None))(at + moves, fixed)
                lost = jnp.isnan(several[1]) & ~jnp.isnan(values)
                return jnp.where(lost[..., None], jnp.nan, several[0])

            moves = step * jnp.eye(at.size)
            ahead, behind = jnp.split(neighbours(jnp.concatenate([moves, -moves])), 2)
            by_both = (ahead - behind) / (2.0 * step)
            by_both = 0.5 * (by_both + jnp.swapaxes(by_both, 0, 2))
            # Linear in the tangent, which is what reverse mode needs
            return here, jnp.tensordot(along, by_both, 1)

        return value, restored(jacobian(at, fixed) @ along)

    return twice


def _is_real(leaf) -> bool:
    return jnp.issubdtype(jnp.result_type(leaf), jnp.inexact)
