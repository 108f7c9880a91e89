"""Sensitivity of results: elasticities, Sobol indices and Morris's effects.

Datasets of elasticities and of Sobol indices draw themselves: `dataset.jaximpact`.
"""

from .accessor import Drawings
from .elasticities import Check, State, elasticities
from .global_methods import morris, sobol
from .ranges import Range

__all__ = ["Check", "Drawings", "Range", "State", "elasticities", "morris", "sobol"]
