"""Why a fit stopped, and when it does."""

import enum
from typing import NamedTuple


class Reason(enum.Enum):
    """Why a fit stopped. Values are (words, whether it has come to a minimum)."""

    converged = "converged: the gradient is nothing", True
    noise = "converged: smaller steps are lost in the accuracy of the impacts", True
    flat = "converged: the cost no longer falls", True
    joined = "converged: at a minimum that another start has found", True
    jump = "stuck where the outcome of an impact changes", False
    stuck = "stuck: no shorter step lowers the cost", False
    above = "stuck in a minimum above the best fit", False
    step_limit = "limit of steps reached", False
    failed = "failed: an impact could not be computed", False

    @property
    def words(self) -> str:
        """For reports."""
        return self.value[0]

    @property
    def at_minimum(self) -> bool:
        """Whether the fit is where a fit should end."""
        return self.value[1]


class Patience(NamedTuple):
    """How long a fit goes on.

    How far a point is from its minimum is told by the fall of the cost that a full
    Gauss-Newton step promises: half the square of the distance in standard errors, if
    the cost is one of known sigmas; otherwise that, times s^2 = 2 cost / (degrees of
    freedom).
    """

    promise: float
    """Below this a fit has converged."""
    part: float
    """Below this part of s^2 likewise."""
    lost: float
    """Below this, in units of s^2 and at least 1, one has of which `FEW_REJECTED` steps
    in a row find no better point."""
    blurred: float
    """Below this, likewise, one has of which `rejected` steps find none."""
    rejected: int
    """Steps in a row, each shorter, none of which lowered the cost, after which a fit
    is given up."""
    flat: float
    """Part of the cost; one that falls by less over `FLAT_STEPS` accepted steps has
    come to its end."""
    steps: int
    joins: bool
    """Whether fits that come to where another is go on as that one."""


FLAT_STEPS, FEW_REJECTED = 5, 2
ROUGH = Patience(1e-4, 1e-2, 1e-2, 1e-2, rejected=6, flat=1e-2, steps=30, joins=True)
"""For telling starts apart, and for profiles: some tenth of a standard error."""
FINE = Patience(1e-10, 1e-6, 1e-8, 1e-4, rejected=10, flat=1e-6, steps=60, joins=False)
"""For what is reported: a thousandth of a standard error."""
