"""One step of any solver of diffrax, in place of the package's own.

The solver is given the problem in units in which its step is from 0 to 1 and an error
of 1 is what is allowed. So one absolute tolerance suits every unknown, at the onset
too: also the root finder's, if the solver is implicit.
"""

from typing import Any

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp
import optimistix as optx
from jaxtyping import Array, Float

from .._types import Scalar
from ..errors import InputError
from ..impact.problem import Problem
from ..laws import Branch
from .rosenbrock import per_width

EXPLICIT = diffrax.AbstractERK, diffrax.Euler, diffrax.ReversibleHeun


class SolverStep(eqx.Module):
    """Interpolant of a solver's step in units of the problem; times count from the
    start of the step."""

    t1: Scalar
    """Width of the step [s]."""
    y1: Float[Array, " n"]
    unit: Float[Array, " n"]
    """Error of each unknown that was allowed."""
    inside: diffrax.AbstractLocalInterpolation
    """The solver's interpolant, in its own units."""

    @property
    def t0(self) -> Scalar:
        return jnp.zeros_like(self.t1)

    def evaluate(self, time: Scalar) -> Float[Array, " n"]:
        """Return the state at a time."""
        return self.unit * self.inside.evaluate(per_width(time, self.t1))

    def rate(self, s: float) -> Float[Array, " n"]:
        """Compute the rate of change at a fraction of the step; 0 for a step of no
        width."""
        change = self.inside.derivative(jnp.asarray(s, float))
        return per_width(self.unit * change, self.t1)

    def rate_at_end(self) -> Float[Array, " n"]:
        """Compute the rate of change at the end; 0 for a step of no width."""
        return self.rate(1.0)


def _rates(t, scaled, args):
    problem, branch, stalled, width, unit = args
    rates = problem.rates(list(unit * scaled), branch, stalled)
    return width * jnp.stack(rates) / unit


@jax.custom_jvp
def _finite_rates(t, scaled, args):
    """Compute the rates for an implicit solver, finite everywhere, with derivatives
    that are.

    Where its iteration is not finite the step is given up; but the iteration
    is differentiated all the same, by a linear solve, in which lineax raises an
    exception at numbers that are not finite.
    """
    rates = _rates(t, jnp.where(jnp.isfinite(scaled), scaled, 1.0), args)
    return jnp.where(jnp.isfinite(rates), rates, 0.0)


@_finite_rates.defjvp
def _finite_rates_jvp(primals, tangents):
    t, scaled, args = primals
    at = t, jnp.where(jnp.isfinite(scaled), scaled, 1.0), args
    rates, along = jax.jvp(_rates, at, tangents)
    is_finite = jnp.isfinite(rates) & jnp.isfinite(along)
    return jnp.where(jnp.isfinite(rates), rates, 0.0), jnp.where(is_finite, along, 0.0)


def solver_step(
    solver: diffrax.AbstractAdaptiveSolver,
    problem: Problem,
    vector: Float[Array, " n"],
    width: Scalar,
    branch: Branch,
    stalled: Scalar | None,
    largest_force: Scalar,
) -> tuple[Float[Array, " n"], Float[Array, " n"], SolverStep]:
    """Take one step of a solver, restarted: the branch may be another one than that of
    the step before.

    Returns:
        The state after the step; the error estimate, not finite where the solver gave
        the step up; and what lies in between.
    """
    # The units are no part of the method: they are not differentiated.
    unit = jax.lax.stop_gradient(problem.allowed_error(jnp.abs(vector), largest_force))
    is_implicit = isinstance(solver, diffrax.AbstractImplicitSolver)
    terms = diffrax.ODETerm(_finite_rates if is_implicit else _rates)
    args = problem, branch, stalled, width, unit
    start, end, scaled = jnp.zeros(()), jnp.ones(()), vector / unit
    state = solver.init(terms, start, end, scaled, args)
    result: Any = solver.step(terms, start, end, scaled, args, state, made_jump=False)
    scaled_after, error, dense, _, outcome = result
    after = unit * scaled_after
    error = jnp.where(diffrax.is_okay(outcome), unit * error, jnp.inf)
    if solver.interpolation_cls is diffrax.LocalLinearInterpolation:
        # A straight line would not tell where in the step a force has its peak.
        inside = diffrax.ThirdOrderHermitePolynomialInterpolation(
            t0=start,
            t1=end,
            y0=scaled,
            y1=scaled_after,
            k0=_rates(start, scaled, args),
            k1=_rates(end, scaled_after, args),
        )
    else:
        inside = solver.interpolation_cls(t0=start, t1=end, **dense)
    return after, error, SolverStep(width, after, unit, inside)


def usable_solver(solver: diffrax.AbstractSolver) -> diffrax.AbstractAdaptiveSolver:
    """Complete a user's solver for `solver_step`. Raises InputError for one that cannot
    integrate an impact."""
    name = type(solver).__name__
    if not isinstance(solver, diffrax.AbstractAdaptiveSolver):
        raise InputError(
            f"engine is the solver {name}, which estimates no errors; need one that "
            "does, such as diffrax.Kvaerno5()"
        )
    terms = solver.term_structure
    if not isinstance(terms, type) or not issubclass(diffrax.ODETerm, terms):
        raise InputError(
            f"engine is the solver {name}, which is for equations of several terms; "
            "need one for ordinary differential equations, such as diffrax.Kvaerno5()"
        )
    try:
        hash(solver)
    except TypeError as problem:
        raise InputError(
            f"engine is the solver {name} with an array among its fields; need plain "
            "numbers there, because the solver is part of the compiled program"
        ) from problem
    return _completed(solver)


def require_derivatives(solver: diffrax.AbstractAdaptiveSolver | None) -> None:
    """Raise InputError for a solver whose steps must not be differentiated.

    The error control of an explicit one keeps its steps near the limit of stability,
    and the errors of what is stiff small. A derivative has no such control: it grows as
    those errors do from rounding up to what is allowed, by 1e280 in one impact.
    """
    if isinstance(solver, EXPLICIT):
        raise InputError(
            f"engine is the explicit solver {type(solver).__name__}, whose derivatives "
            "grow without bound where the equations are stiff; need an implicit one, "
            "such as diffrax.Kvaerno5(), or differences"
        )


def _completed(solver) -> Any:
    """Complete a solver as `diffrax.diffeqsolve` would, which does not see it."""
    if isinstance(getattr(solver, "solver", None), diffrax.AbstractSolver):
        inner = _completed(solver.solver)
        return eqx.tree_at(lambda s: s.solver, solver, inner)
    if isinstance(solver, diffrax.AbstractRungeKutta) and solver.scan_kind is None:
        # The loop that diffrax chooses otherwise has no forward derivative.
        solver = eqx.tree_at(
            lambda s: s.scan_kind, solver, "lax", is_leaf=lambda x: x is None
        )
    if isinstance(solver, diffrax.AbstractImplicitSolver):
        finder = solver.root_finder
        # The root finders of diffrax stop at a hundredth of the error allowed.
        wanted = {"rtol": 0.0, "atol": 1.0, "norm": optx.max_norm}
        # diffrax marks what it would fill in by an object of a class of its own.
        missing = [
            name
            for name in wanted
            if type(getattr(finder, name)).__name__ == "_UseStepSizeTol"
        ]
        if missing:
            solver = eqx.tree_at(
                lambda s: [getattr(s.root_finder, name) for name in missing],
                solver,
                [wanted[name] for name in missing],
            )
    return solver
