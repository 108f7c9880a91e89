"""The drawings of sensitivity studies; apart, since Matplotlib is slow to load."""

from .effects_plane import plot_morris
from .elasticity_map import plot_elasticity_map
from .heat_map import plot_heat_map
from .index_bars import plot_sobol
from .tornado import plot_tornado

__all__ = [
    "plot_elasticity_map",
    "plot_heat_map",
    "plot_morris",
    "plot_sobol",
    "plot_tornado",
]
