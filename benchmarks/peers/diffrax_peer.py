"""diffrax's own solvers on jaximpact's equations.

Set up as well as we know: one margin to the end, `Bisection(flip=True)`, PI control of
the step, a root finder that is not stricter than the step, and the compiler's fusion
switched off as for our own solver. Unknowns are scaled to
one, so that the root finder's tolerances suit all of them.
"""

import concurrent.futures
import functools
import os
import time

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx

from jaximpact.backend.xla_compilation import unfused_jit
from jaximpact.impact.events import TIME_LIMIT, closing_velocity
from jaximpact.impact.problem import Assembly, pose
from jaximpact.impact.reduced_models import PLANAR

from ..impacts import PARAMETERS, Answer, shifted

FLOOR = 1e-2
"""Absolute over relative tolerance, for unknowns scaled to one."""
LANES = 32
"""Impacts side by side: fewer waste time on dispatch, more wait for the slowest."""


def _rates(t, scaled, problem):
    rows = list(scaled * problem.scale)
    return jnp.stack(problem.rates(rows)) / problem.scale


@jax.custom_jvp
def _finite_rates(t, scaled, problem):
    """The rates, with derivatives that are finite: where an iteration that has diverged
    is differentiated, lineax would raise an exception."""
    return _rates(t, scaled, problem)


@_finite_rates.defjvp
def _finite_rates_jvp(primals, tangents):
    t, scaled, problem = primals
    at = t, jnp.where(jnp.isfinite(scaled), scaled, 1.0), problem
    _, along = jax.jvp(_rates, at, tangents)
    return _rates(*primals), jnp.where(jnp.isfinite(along), along, 0.0)


def _margin(t, y, args, **kwargs):
    margins = args.margins(y * args.scale, args.force_scale)
    return jnp.min(jnp.stack(margins))


class Diffrax:
    """A solver of diffrax under `jax.vmap`."""

    family = "diffrax"

    def __init__(self, name, solver, tolerances, max_steps):
        self.name = f"diffrax {name}"
        self.solver, self.tolerances, self.max_steps = solver, tolerances, max_steps

    def e_n(self, scene, tolerance):
        """e_n of one scene; NaN where the integration failed."""
        problem, vector = pose(
            scene,
            Assembly(jax.tree.structure(scene), PLANAR, ledger=False),
            tolerance,
            FLOOR,
        )
        start = vector / problem.scale
        solution = diffrax.diffeqsolve(
            diffrax.ODETerm(_finite_rates),
            self.solver,
            t0=0.0,
            t1=TIME_LIMIT,
            dt0=None,
            y0=start,
            args=problem,
            stepsize_controller=diffrax.PIDController(
                rtol=tolerance, atol=FLOOR * tolerance, pcoeff=0.3, icoeff=0.3
            ),
            event=diffrax.Event(
                _margin, optx.Bisection(1e-10, 1e-10, flip=True), direction=False
            ),
            adjoint=diffrax.ForwardMode(),
            max_steps=self.max_steps,
            throw=False,
        )
        finished = diffrax.is_okay(solution.result)
        place = PLANAR.unknowns.index("normal_velocity")
        value = -solution.ys[0][place] / start[place]
        motion, _ = problem.contact(list(vector))
        separating = closing_velocity(problem.ground, motion) <= 0.0
        return jnp.where(separating, -1.0, jnp.where(finished, value, jnp.nan))

    @functools.cached_property
    def _single(self):
        return unfused_jit(self.e_n)

    @functools.cached_property
    def _lanes(self):
        return unfused_jit(jax.vmap(self.e_n, in_axes=(0, None)))

    def solve(self, scenes, tolerance: float, batch: bool) -> Answer:
        """Impacts in lanes, on a thread for each core; or one after another."""
        compute = self._lanes if batch else self._single
        return Answer(*_in_parts(compute, scenes, tolerance, batch))


class DiffraxForward(Diffrax):
    """The same with derivatives: of an implicit solver. Those through an explicit one
    grow without bound where the equations are stiff."""

    def _gradient(self, scene, tolerance):
        """Derivatives of e_n of one scene, as `forward_gradient` gives them."""
        return jax.jacfwd(lambda shift: self.e_n(shifted(scene, shift), tolerance))(
            jnp.zeros(len(PARAMETERS))
        )

    @functools.cached_property
    def _single_gradient(self):
        return unfused_jit(self._gradient)

    @functools.cached_property
    def _gradient_lanes(self):
        return unfused_jit(jax.vmap(self._gradient, in_axes=(0, None)))

    def gradient(self, scenes, batch: bool, tolerance: float):
        """Derivatives `(n, 3)`, and seconds, as `solve` does."""
        compute = self._gradient_lanes if batch else self._single_gradient
        return _in_parts(compute, scenes, tolerance, batch)


def _in_parts(compute, scenes, tolerance, batch) -> tuple[np.ndarray, float]:
    """Results of a compiled function, and seconds without compiling."""
    count = np.size(scenes.impact.speed)

    def part(places):
        here = jax.tree.map(lambda x: np.asarray(x)[places], scenes)
        return np.asarray(compute(here, tolerance))

    if batch:
        filled = np.resize(np.arange(count), -(-count // LANES) * LANES)
        parts = list(filled.reshape(-1, LANES))
    else:
        parts = list(range(count))
    part(parts[0])  # compiles
    begin = time.perf_counter()
    with concurrent.futures.ThreadPoolExecutor(
        (os.cpu_count() or 1) if batch else 1
    ) as pool:
        found = list(pool.map(part, parts))
    seconds = time.perf_counter() - begin
    return (np.concatenate if batch else np.stack)(found)[:count], seconds


def methods() -> list[Diffrax]:
    """What this module brings."""
    root_finder = diffrax.VeryChord(rtol=1e-4, atol=1e-4)
    return [
        DiffraxForward(
            "Kvaerno3",
            diffrax.Kvaerno3(root_finder=root_finder),
            (1e-3, 1e-4, 1e-5),
            5_000,
        ),
        DiffraxForward(
            "Kvaerno5",
            diffrax.Kvaerno5(root_finder=root_finder),
            (1e-3, 1e-4, 1e-5, 1e-6),
            5_000,
        ),
        Diffrax("Tsit5", diffrax.Tsit5(), (1e-3, 1e-5), 50_000),
    ]
