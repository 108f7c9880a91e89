"""Types of values, for annotations."""

from typing import Any

from jaxtyping import Array, Bool, Float

Scalar = Float[Array, ""]
"""One number as a float64 array of JAX; inside `vmap` one for each lane."""
Flag = Bool[Array, ""]
"""One truth value as an array of JAX."""
Structure = Any
"""Structure of a pytree, `jax.tree_util.PyTreeDef`, which JAX declares as a value."""
