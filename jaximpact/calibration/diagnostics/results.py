"""Results of a fitted study."""

from typing import NamedTuple

import numpy as np

from ..estimation.branches import NEAR
from ..estimation.least_squares import Reason
from ..problem.bounds import Bounds
from ..problem.config import Study, Variant
from ..problem.objective import Objective, Points
from .identifiability import LikelihoodProfile, Verdict
from .posterior import Draws
from .uncertainty import Uncertainty


class VariantResult(NamedTuple):
    """Fit of one variant; parameters in the units of their columns."""

    variant: Variant
    bounds: Bounds
    names: list[str]
    """Names of the unknowns: the soil's parameters, then the nuisances."""
    parameters: np.ndarray
    """Values at the best fit, shape (unknowns,)."""
    cost: float
    """Objective function at the best fit."""
    predicted: np.ndarray
    """Predictions at the best fit, shape (tests, targets); NaN where there is none."""
    sigma: np.ndarray
    """Standard deviations of the measurements, given or estimated, the same shape."""
    outcomes: np.ndarray
    """Codes of the outcomes at the best fit, shape (tests,)."""
    failed: int
    """Number of measurements without a prediction."""
    uncertainty: Uncertainty
    verdicts: list[Verdict]
    """Verdict on each of the soil's parameters."""
    directions: list[str]
    """Parameter combinations in words, the best known first."""
    profiles: dict[str, LikelihoodProfile]
    """Likelihood profile of each of the soil's parameters."""
    end_parameters: np.ndarray
    """Ends of the fits from the best places of the search, shape (ends, unknowns)."""
    end_costs: np.ndarray
    """Objective function at these ends, shape (ends,)."""
    end_reasons: list[Reason]
    """Reason for which each fit stopped."""
    end_steps: np.ndarray
    """Number of points at which each computed the cost, shape (ends,)."""
    members: int
    """Size of the population that searched; 0 without a search."""
    agreed: int
    """Number of its members that came to one place, or one cost."""
    found_later: bool
    """Whether draws or profiles found the best fit, below where the search had led."""
    reason: Reason
    """Reason for which the reported fit stopped."""
    objective: Objective
    """Objective function with the estimated sigmas."""
    points: Points
    """Best fit, one lane."""
    jumps: np.ndarray
    """Share of the confidence region in which each prediction is beyond a jump, shape
    (tests, targets)."""
    draws: Draws
    """Draws of the posterior by importance sampling, not yet checked."""
    errors_of_draws: bool
    """Whether covariance and standard errors are those of the draws, since predictions
    jump; else they follow from derivatives."""

    def standard_error(self, index: int) -> float:
        """Compute a standard error in the unit of the unknown."""
        x = self.bounds.coordinate(self.parameters)
        slope = self.bounds.slope(x)[index]
        return float(self.uncertainty.standard_errors[index] * slope)

    def interval(self, index: int) -> tuple[float, float]:
        """Return the 95 % confidence interval of an identifiable parameter, in its
        unit: that of its profile, or of the standard error beside a jump, where the
        profile leaves measurements out, or takes a jump for a limit."""
        profile = self.profiles[self.names[index]]
        low, high = profile.low_95, profile.high_95
        beside_jump = np.any(self.jumps > NEAR)
        if beside_jump or low is None or high is None:
            return self.interval_of_error(index)
        return low, high

    def interval_of_error(self, index: int) -> tuple[float, float]:
        """Compute the 95 % confidence interval that follows from the standard error, in
        the unit of the unknown: symmetric in x, and cut at the bounds."""
        bounds, uncertainty = self.bounds, self.uncertainty
        x = bounds.coordinate(self.parameters)
        reach = uncertainty.quantile[index] * uncertainty.standard_errors[index]
        low = bounds.parameter(np.maximum(x - reach, bounds.low))
        high = bounds.parameter(np.minimum(x + reach, bounds.high))
        return float(low[index]), float(high[index])


class StudyResult(NamedTuple):
    """A study and the fits of its variants."""

    study: Study
    variants: list[VariantResult]
    seconds: float
    """Wall time of all fits, compilation included [s]."""
    engine: str
    """Engine that computed the impacts: machine code or XLA."""
