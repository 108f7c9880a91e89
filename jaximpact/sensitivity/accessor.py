"""Drawings of elasticities and Sobol indices as methods of their datasets."""

import os
from functools import partial

import xarray as xr


@xr.register_dataset_accessor("jaximpact")
class Drawings:
    """Drawings of a dataset of `elasticities` or `sobol`: `dataset.jaximpact`.

    Each method takes a `path` to save the figure in too, and `ax`, axes to draw on, one
    for each panel; it returns the axes. Without both the figure is one of
    `matplotlib.pyplot`, which notebooks show. A choice of outputs is drawn by
    `dataset.sel(output=[...]).jaximpact`.

    Raises ValueError for a dataset of many impacts, or of something else.
    """

    def __init__(self, dataset: xr.Dataset):
        self._dataset = dataset

    def plot_tornado(self, path: str | os.PathLike | None = None, *, ax=None):
        """Draw the elasticities of one impact as bars, a panel for each output.

        A bar that differences do not confirm is hatched, and its number bears a
        question mark. What has no elasticity has no bar, and the panel says why.
        """
        return self._plotted("draw_tornado", path, ax)

    def plot_heat_map(self, path: str | os.PathLike | None = None, *, ax=None):
        """Draw the elasticities of one impact, or total Sobol indices, as a table in
        colours: outputs down, parameters across, each with its number."""
        return self._plotted("draw_heat_map", path, ax)

    def plot_sobol(self, path: str | os.PathLike | None = None, *, ax=None):
        """Draw first-order and total Sobol indices with their 95 % intervals as bars, a
        panel for each output."""
        return self._plotted("draw_sobol", path, ax)

    def _plotted(self, drawing: str, path, ax):
        from ..plotting.style import plotted
        from . import figures

        return plotted(partial(getattr(figures, drawing), self._dataset), path, ax)
