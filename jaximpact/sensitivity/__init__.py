"""Which parameters matter: elasticities, Sobol indices and Morris's effects.

Drawings are in `jaximpact.sensitivity.drawing`.
"""

from .elasticity import elasticities
from .in_words import in_words
from .morris_effects import morris
from .ranges import Range
from .sobol_indices import sobol
from .verdicts import Check, State

__all__ = ["Check", "Range", "State", "elasticities", "in_words", "morris", "sobol"]
