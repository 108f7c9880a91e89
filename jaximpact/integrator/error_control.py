r"""Proportional-integral (PI) step size control.

$$ h_{k+1} = h_k \, \mathrm{clip}\bigl(0.85 \, e_k^{-1/p} e_{k-1}^{0.2/p},\; 0.2,\; 10
   \bigr) $$

with the errors $e$ of accepted steps in units of what is allowed, and the order $p$ of
the estimate. A step with $e_k \ge 1$ is rejected, and taken again with 0.85 of its
width at most.

As a contact ends, widths must shrink step by step. `diffrax.PIDController` shrinks none
that was accepted: there it rejects every third step.

Source: Gustafsson (1991), Control theoretic techniques for stepsize selection in
explicit Runge-Kutta methods, ACM Transactions on Mathematical Software 17.
"""

from typing import Any

import diffrax
import jax
import jax.numpy as jnp
import optimistix as optx

from .._types import Scalar

SAFETY = 0.85
"""Fraction of the width that would bring the error to what is allowed."""
PROPORTIONAL = 0.2
"""Coefficient of the proportional part; that of the integral part is the rest of 1."""
SMALLEST_FACTOR, LARGEST_FACTOR = 0.2, 10.0
"""Smallest and largest factor from one width to the next."""


class ErrorControl(diffrax.AbstractStepSizeController):
    """PI step size control by the error of a solver, in units of what is allowed; its
    state is the error of the last step that was accepted."""

    def wrap(self, direction):
        return self

    def init(
        self, terms, t0, t1, y0, dt0, args, func, error_order
    ) -> tuple[Scalar, Scalar]:
        return t0 + dt0, jnp.ones_like(t0 + dt0)

    def adapt_step_size(
        self, t0, t1, y0, y1_candidate, args, y_error, error_order, controller_state
    ) -> tuple[Any, Scalar, Scalar, bool, Scalar, diffrax.RESULTS]:
        errors: Any = y_error
        # Below this the width grows by the largest factor whatever the error.
        least = LARGEST_FACTOR**-error_order
        error = jnp.maximum(jax.lax.stop_gradient(optx.rms_norm(errors.vector)), least)
        keep = error < 1.0
        factor = (
            SAFETY
            * error ** (-1.0 / error_order)
            * controller_state ** (PROPORTIONAL / error_order)
        )
        most = jnp.where(keep, LARGEST_FACTOR, SAFETY)
        width = jnp.clip(factor, SMALLEST_FACTOR, most) * (t1 - t0)
        next_t0 = jnp.where(keep, t1, t0)
        return (
            keep,
            next_t0,
            next_t0 + width,
            False,
            jnp.where(keep, error, controller_state),
            diffrax.RESULTS.successful,
        )
