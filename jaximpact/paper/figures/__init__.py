"""Figures 4 to 14 of the paper, computed again.

A figure is a table, computed from the paper's parametric sets, and a drawing of that
table alone. Source: Dattola et al. (2023), section 3 and Fig. 13.
"""

from .tables import PaperFigure, Study
from .write import PAPER_FIGURES, write_figures

__all__ = ["PAPER_FIGURES", "PaperFigure", "Study", "write_figures"]
