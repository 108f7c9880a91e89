"""Result of a back-analysis."""

import dataclasses

from ...io.display import Rows, ShownAsTable
from .posterior import Posterior
from .predictive import Predicted
from .problem import SlopeFit
from .rounds import Searched


@dataclasses.dataclass(frozen=True, repr=False)
class SlopeCalibration(ShownAsTable):
    """Ground of a slope, fitted to where blocks stopped and how they passed."""

    fit: SlopeFit
    searched: Searched
    posterior: Posterior
    predicted: Predicted

    def display_rows(self) -> tuple[str, Rows]:
        """Give median and 95 % interval of each parameter."""
        rows = [
            (p.parameter.name, f"{p.median:.4g}", f"{p.low:.4g} to {p.high:.4g}")
            for p in self.posterior.fitted
        ]
        return f"SlopeCalibration: {self.fit.title}", rows
