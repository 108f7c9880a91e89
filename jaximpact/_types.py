"""Names of kinds of values, for annotations."""

from jaxtyping import Array, Float

Scalar = Float[Array, ""]
"""One number as a float64 array of JAX; inside `vmap` one for each lane."""
