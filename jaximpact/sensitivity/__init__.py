"""Sensitivity of results: elasticities, Sobol indices and Morris's effects.

Drawings are in `jaximpact.sensitivity.figures`.
"""

from .elasticities import Check, State, elasticities
from .global_methods import morris, sobol
from .ranges import Range

__all__ = ["Check", "Range", "State", "elasticities", "morris", "sobol"]
