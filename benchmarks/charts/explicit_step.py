"""The step at which an explicit method becomes unstable, over a contact.

The classical Runge-Kutta method of order 4 is stable as long as the step times the
rate of the fastest decay is below 2.785; other explicit methods have like limits.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from matplotlib.figure import Figure

from jaximpact.accuracy import PRESETS
from jaximpact.backend.xla_compilation import unfused_jit
from jaximpact.impact.problem import Assembly
from jaximpact.impact.reduced_models import PLANAR
from jaximpact.integrator.batched import start_lanes, step_lanes
from jaximpact.plotting.style import BLUE, GREEN, VERMILION, in_style, log_label, panels
from jaximpact.scene import Scene

from ..impacts import spread
from .section import Bench, Row, Section, Table
from .stability import base
from .style import log_axes

LIMIT = 2.785
"""Step times rate at which the method of order 4 loses stability."""
K_E = (1.0, 900.0, 1e6)
GAMMA_V = (1e-3, 8.7, 1e3)
"""[m/s]"""
OF_K_E = [(k_E, 8.7) for k_E in K_E]
OF_GAMMA_V = [(900.0, gamma_v) for gamma_v in GAMMA_V]
"""Pairs of both, one of them as usual."""
COLOURS = (GREEN, BLUE, VERMILION)


class Course(NamedTuple):
    """One state for each step, of each lane."""

    time: np.ndarray
    """`(steps, lanes)` [s]"""
    fastest: np.ndarray
    """Rate of the fastest decay or oscillation, `(steps, lanes)` [1/s]."""
    steps: np.ndarray
    """Steps that the integration took itself, `(lanes,)`."""


def fastest_rates(jacobians: np.ndarray, scales: np.ndarray) -> np.ndarray:
    """Largest eigenvalue of each Jacobian, by absolute value, `(lanes,)` [1/s].

    Args:
        jacobians: `(lanes, n, n)`; entries that are not finite count as zero.
        scales: of the unknowns, `(lanes, n)`. In units of them the eigenvalues are the
            same, and better conditioned.
    """
    scaled = jacobians * scales[:, None, :] / scales[:, :, None]
    scaled = np.where(np.isfinite(scaled), scaled, 0.0)
    return np.max(np.abs(np.linalg.eigvals(scaled)), axis=-1)


def _jacobian(problem, vector):
    return jax.jacfwd(lambda y: jnp.stack(problem.rates(list(y))))(vector)


_jacobians = unfused_jit(jax.vmap(_jacobian, in_axes=(-1, -1)))
_step = unfused_jit(step_lanes)
_start = unfused_jit(
    lambda scenes, tolerance, floor: start_lanes(
        Assembly(jax.tree.structure(scenes), PLANAR, ledger=False),
        *(scenes, tolerance, floor),
    )
)


def follow(scenes: Scene) -> Course:
    """The scenes integrated at `balanced`, looked at after every step."""
    preset = PRESETS["balanced"]
    lanes = _start(scenes, preset.tolerance, preset.floor)
    times, rates = [], []
    while np.any(lanes.going):
        lanes = _step(lanes)
        times.append(np.asarray(lanes.time))
        jacobians = np.asarray(_jacobians(lanes.problem, lanes.state.vector))
        rates.append(fastest_rates(jacobians, np.asarray(lanes.problem.scale).T))
    steps = np.asarray(lanes.accepted + lanes.rejected)
    return Course(np.stack(times), np.stack(rates), steps)


def measure(bench: Bench) -> list[Row]:
    """A row for each case and step."""
    pairs = list(dict.fromkeys((*OF_K_E, *OF_GAMMA_V)))
    k_E, gamma_v = np.transpose(pairs)
    bench.say(f"{len(pairs)} contacts")
    course = follow(spread(base({"k_E": k_E, "gamma_v": gamma_v}), len(pairs)))
    rows = []
    for lane, (k, g) in enumerate(pairs):
        time, first = np.unique(course.time[:, lane], return_index=True)
        rows += [
            {
                "k_E": k,
                "gamma_v": g,
                "time_s": float(t),
                "stable_step_s": float(LIMIT / rate),
                "own_steps": int(course.steps[lane]),
            }
            for t, rate in zip(time, course.fastest[first, lane], strict=True)
        ]
    return rows


@in_style
def draw(rows: Table) -> Figure:
    """The stable step over time: for three k_E, and for three gamma_v."""
    title = "14 m/s at 40° from the normal, $A_r$ = 2"
    both = {"sharex": True, "sharey": True}
    figure, (left, right) = panels(1, 2, height=4.0, title=title, **both)
    of_case = dict(iter(rows.groupby(["k_E", "gamma_v"])))
    k_E, gamma_v = map(log_label, K_E), (f"{log_label(g)} m/s" for g in GAMMA_V)
    for axes, title, cases, labels in (
        (left, "modulus number $k_E$", OF_K_E, k_E),
        (right, r"fluidity $\gamma_v$", OF_GAMMA_V, gamma_v),
    ):
        log_axes(axes, "time since touch [s]", "")
        for case, label, colour in zip(cases, labels, COLOURS, strict=True):
            own = of_case[case]
            axes.plot(own["time_s"], own["stable_step_s"], color=colour, label=label)
        axes.set(xlim=(1e-8, 2.0), ylim=(1e-14, 1.0))
        axes.legend(title=title, loc="lower right")
    left.set_ylabel("largest step at which RK4 is stable [s]")
    return figure


def steps_needed(own: Table) -> float:
    """Steps of an explicit method that always takes the largest stable one."""
    time, inverse = own["time_s"].to_numpy(), 1.0 / own["stable_step_s"].to_numpy()
    return float(np.trapezoid(inverse, time) + time[0] * inverse[0])


def table(rows: Table) -> list[tuple[str, ...]]:
    """Smallest stable step, steps needed and steps taken, for each case."""
    head = ["k_E", "gamma_v, m/s", "contact, ms"]
    head.append("smallest stable step after the first 1 %, s")
    head += ["steps of RK4, at least", "steps of balanced"]
    lines = [tuple(head)]
    for (k, g), own in rows.groupby(["k_E", "gamma_v"], sort=False):
        end = own["time_s"].iloc[-1]
        least = own.loc[own["time_s"] > 0.01 * end, "stable_step_s"].min()
        contact = f"{k:g}", f"{g:g}", f"{1e3 * end:.3g}", f"{least:.1e}"
        taken = own["own_steps"].iloc[0]
        lines.append((*contact, f"{steps_needed(own):.2g}", f"{taken:g}"))
    return lines


EXPLICIT_STEP = Section("explicit-step", measure, draw, table)
