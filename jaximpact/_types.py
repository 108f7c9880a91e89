"""Types of values, for annotations."""

from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import numpy as np
from jaxtyping import Array, Bool, Float


class Shown(NamedTuple):
    """A type or a default as signatures show it."""

    text: str

    def __repr__(self) -> str:
        return self.text


if TYPE_CHECKING:
    # Editors read constructors of laws off their fields, which take plain numbers too.
    Scalar = Any
else:
    Scalar = Float[Array, ""]
"""One number as a float64 array of JAX; inside `vmap` one for each lane."""
Flag = Bool[Array, ""]
"""One truth value as an array of JAX."""
if TYPE_CHECKING:
    Number = float | np.ndarray | jax.Array
else:
    Number = Shown("float | Array")
"""One number or an array of them, as users give it."""
Structure = Any
"""Structure of a pytree, `jax.tree_util.PyTreeDef`, which JAX declares as a value."""
