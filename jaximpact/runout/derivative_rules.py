"""Functions of one block whose derivatives are stated here, since JAX cannot find them
or would find NaN where nothing changes."""

import jax
import jax.numpy as jnp

from .lane_programs import Values


def _product(slope: Values, change: Values) -> Values:
    # 0 x inf is 0: an unchanged input changes nothing, however steep the function.
    return jnp.where(change == 0.0, 0.0, slope * change)


@jax.custom_jvp
def found_by_search(value: Values, moved: Values, slope: Values = 1.0) -> Values:
    """Give a value that a search found, together with its derivative.

    Args:
        value: result of the search, whose own derivative does not count.
        moved: quantity that the result follows.
        slope: derivative of the result with respect to that quantity.
    """
    return value


@found_by_search.defjvp
def _found_by_search_jvp(numbers, changes):
    value, _, slope = numbers
    return value, _product(slope, changes[1])


@jax.custom_jvp
def root(x: Values) -> Values:
    """Square root of `max(x, 0)`; its derivative at 0 is infinite where x changes, and
    0 where it does not."""
    return jnp.sqrt(jnp.maximum(x, 0.0))


@root.defjvp
def _root_jvp(numbers, changes):
    (x,), (change,) = numbers, changes
    value = root(x)
    return value, _product(jnp.where(x < 0.0, 0.0, 0.5 / value), change)
