"""SciPy's least squares with finite differences, on a peer's impacts.

Set up as well as we know. The unknowns are the study's, logarithms between bounds, as
parts of their ranges from 1 to 2, so that a relative step of differences is one of the
range. That step, a thousandth of the parameter, drowns neither in the errors of the
impacts nor in the curvature. The 16 impacts of an evaluation run on every core.
"""

from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from jaximpact.calibration.problem.forward_model import bounds_of

STEP = 1e-4
"""Step of differences, as a fraction of the range."""
ENOUGH = 1e-6
"""Relative change of cost, unknowns and gradient at which a fit ends; less is the
noise of the impacts."""
MOST_STEPS = 60
FAILED = 10.0
"""Residual of an impact that the peer could not compute: large, and finite, which SciPy
insists on."""


class Ended(NamedTuple):
    """A fit from one start."""

    rms: float
    """Root mean square over the tests of predicted less measured."""
    seconds: float
    """Time in the peer's solver; the rest, which is little, is not counted."""
    impacts: int


class Misfit:
    """e_n by a peer less measured, for a variant of a study that fits the soil to e_n.

    Args:
        study, variant: what is fitted to what.
        peer: a method of a module `*_peer.py`.
        tolerance: of its impacts.
    """

    def __init__(self, study, variant, peer, tolerance: float):
        self.study, self.peer, self.tolerance = study, peer, tolerance
        self.soil = study.soil | variant.soil
        self.bounds = bounds_of(study)
        self.names = [parameter.name for parameter in study.parameters]
        self.seconds, self.impacts = 0.0, 0

    def __call__(self, part: np.ndarray) -> np.ndarray:
        """Residuals `(tests,)` at parts of the ranges, from 1 to 2."""
        p = self.bounds.parameter(self.bounds.at_fraction(part - 1.0))
        scene = self.study.tests.scene(
            self.soil | dict(zip(self.names, p, strict=True))
        )
        answer = self.peer.solve(scene, self.tolerance, batch=True)
        self.seconds += answer.seconds
        self.impacts += len(answer.e_n)
        apart = answer.e_n - self.study.measured[:, 0]
        return np.where(np.isfinite(apart), apart, FAILED)


def fit(misfit: Misfit, x: np.ndarray) -> Ended:
    """Fit from one start, in the study's coordinates."""
    misfit.seconds, misfit.impacts = 0.0, 0
    found = least_squares(
        misfit,
        1.0 + misfit.bounds.fraction(x),
        jac="2-point",
        diff_step=STEP,
        bounds=(1.0, 2.0),
        ftol=ENOUGH,
        xtol=ENOUGH,
        gtol=ENOUGH,
        max_nfev=MOST_STEPS,
    )
    rms = float(np.sqrt(np.mean(found.fun**2)))
    return Ended(rms, misfit.seconds, misfit.impacts)
