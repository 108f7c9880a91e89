"""Second derivatives by differences of first ones: an impact has no others."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax.flatten_util import ravel_pytree

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
            one, such as their logarithms.
        step: by which each parameter is moved, to either side.

    Returns:
        The function, with the same values and first derivatives. The second ones are
        central differences of its Jacobian, and the same in either order. They take two
        Jacobians for each parameter. There are no third ones.

    Raises InputError as it is differentiated, for results that are whole numbers.
    """

    @jax.custom_jvp
    def twice(parameters):
        return function(parameters)

    @twice.defjvp
    def first(primals, tangents):
        value, along = function(*primals), ravel_pytree(*tangents)[0]
        for leaf in jax.tree.leaves(value):
            if not jnp.issubdtype(jnp.result_type(leaf), jnp.inexact):
                raise InputError(
                    "with_second_derivatives needs a function of real results alone, "
                    f"but one of them is of type {jnp.result_type(leaf)}"
                )
        at, tree = ravel_pytree(*primals)
        restored = ravel_pytree(value)[1]

        def once(at):
            return jax.jacfwd(lambda flat: ravel_pytree(function(tree(flat)))[0])(at)

        @jax.custom_jvp
        def jacobian(at):
            return once(at)

        @jacobian.defjvp
        def second(primals, tangents):
            (at,), (along,) = primals, tangents
            moves = step * jnp.eye(at.size)
            jacobians = jax.vmap(once)(jnp.concatenate([at + moves, at - moves]))
            ahead, behind = jnp.split(jacobians, 2)
            by_both = (ahead - behind) / (2.0 * step)
            by_both = 0.5 * (by_both + jnp.swapaxes(by_both, 0, 2))
            # Linear in the tangent, which is what reverse mode needs
            return once(at), jnp.tensordot(along, by_both, 1)

        return value, restored(jacobian(at) @ along)

    return twice
