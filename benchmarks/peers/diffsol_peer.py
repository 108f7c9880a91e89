"""diffsol: solvers in Rust for stiff equations, called from JAX through diffsol-jax.

It takes a right-hand side in JAX and compiles it by way of its own language, which
knows neither `max` nor `where` nor `arctan`. So the equations of `model.py` stand here
once more, with every switch as an absolute value, and the arctangent as a series.

It cannot stop at an event, so an impact is integrated window by window, as in
`numbalsoda_peer.py`. Its start cannot be changed either: the unknowns are the
differences from the start of the window, which goes in among the parameters. Time is in
units of R over the speed, so that one first step suits all impacts.

Its TR-BDF2 is left out: where the last step ends a rounding short of the last time,
diffsol 0.14.2 ends the process, once in some thousand windows. With the two methods
here that was not seen in ten thousands of them.
"""

import functools
import math

import jax
import jax.numpy as jnp
import numpy as np
from diffsol_jax import ODEProblem
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import brentq

from ..impacts import Answer
from . import model
from .shared import Compiled, solve_scenes

WINDOW = 1.3
"""Length of a window, as for numbalsoda."""
POINTS = 48
"""Points of a window at tolerances of 1e-4 and more, as for numbalsoda."""
SHORTEST = 1e-3
"""Length of the shortest window over that of a whole one."""
FLOOR = 1e-4
"""Absolute over relative tolerance, for unknowns scaled to one. With 1e-2 more impacts
fail at the onset."""
FIRST_STEP = 1e-8
"""A hundredth of the time in which the block sinks as deep as it starts."""
TINY = 1e-30


def _positive(x):
    """The larger of x and 0."""
    return 0.5 * (x + abs(x))


def _larger(x, bound):
    return bound + _positive(x - bound)


def _smaller(x, bound):
    return x - _positive(x - bound)


def _arctangent(x):
    """Of x >= 0, to 1e-12: angles halved three times, then a series."""
    for _ in range(3):
        x = x / (1.0 + jnp.sqrt(1.0 + x * x))
    square = x * x
    series = 0.0
    for odd in (13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0):
        series = 1.0 / odd - square * series
    return 8.0 * x * series


def _foundation(u_n, theta, p):
    """Sinking, length, width, normal arm, tangential arm, tangency arm."""
    H2, R2 = p[model.H] * p[model.H], p[model.R] * p[model.R]
    sin, cos = p[model.SIN], p[model.COS]
    s_turn, c_turn = jnp.sin(theta), jnp.cos(theta)
    s, c = sin * c_turn + cos * s_turn, cos * c_turn - sin * s_turn
    r_y = jnp.sqrt(H2 * c * c + R2 * s * s)
    tilt = (H2 - R2) * s * c / jnp.sqrt(H2 * s * s + R2 * c * c) / r_y
    sum_sin = s * cos + c * sin
    sinking = u_n - (H2 - R2) * sum_sin * s_turn / (r_y + p[model.SUPPORT])
    x = _larger(sinking / r_y, 1e-12)

    def chord(limit):
        """Middle and half length; past the ellipse's widest point, those there."""
        at = _smaller(x, limit)
        middle = -(1.0 - at) * s * c * (H2 - R2) / r_y
        half = p[model.H] * p[model.R] * jnp.sqrt(at * (2.0 - at)) / r_y
        return middle, half

    middle_2, half_2 = chord(1.0 + tilt)
    middle_1, half_1 = chord(1.0 - tilt)
    t_2, t_1 = middle_2 + half_2, middle_1 - half_1
    deep = _smaller(x, 1.0)
    width = 2.0 * p[model.W] * jnp.sqrt(deep * (2.0 - deep))
    tangency = -(H2 - R2) * s * c / r_y
    return sinking, t_2 - t_1, width, r_y - sinking, 0.5 * (t_1 + t_2), tangency


def _plastic_flow(normal, tangential, moment, rho, base, p):
    """Plastic rates along N, T and M."""
    sinking, length, width = base
    small, large = _smaller(length, width), _larger(length, width)
    depth = _positive(sinking)
    capacity = (0.25 * math.pi * length * width * p[model.GAMMA_N]) * (
        depth
        * p[model.N_Q]
        * (1.0 + small / large * p[model.TAN_P])
        * (1.0 + p[model.DEPTH] * _arctangent(depth / small))
        + 0.5 * small * p[model.N_G] * (1.0 - 0.4 * small / large)
    )
    h = tangential / (p[model.TAN_P] * capacity)
    m = moment / (p[model.PSI] * length * capacity)
    xi = _larger(normal / capacity, 1e-6 * (abs(h) + abs(m))) + TINY
    h, m = h / xi, m / xi
    square = h * h + m * m
    root = jnp.sqrt(square + model.VERTEX * model.VERTEX)
    eta = square / (root + model.VERTEX) + TINY
    w = eta ** (1.0 / p[model.BETA])
    inside = 1.0 / (1.0 - _smaller(w, model.TANGENT_FROM))
    slope = inside * inside
    factor = inside + slope * _positive(w - model.TANGENT_FROM)
    common = slope * w / (p[model.BETA] * eta) / root
    out = factor - common * square
    g_x = _positive(out) - p[model.DILATANCY] * _positive(-out)
    g_h, g_m = common * h, common * m
    rate = p[model.GAMMA_V] * _positive(xi * factor / rho - 1.0)
    rate = rate / jnp.sqrt(g_x * g_x + g_h * g_h + g_m * g_m)
    along_m = rate * g_m / (p[model.PSI] * length)
    return rate * g_x, rate * g_h / p[model.TAN_P], along_m


def _rates(y, p):
    """What `model.rates` computes, in the operations that diffsol-jax knows."""
    radius, speed, elastic = p[model.R], p[model.SPEED], p[model.ELASTIC]
    base = _foundation(y[0] * radius, y[1], p)
    sinking, length, width, r_n, r_t, tangency = base
    length, width = _larger(length, 1e-6 * radius), _larger(width, 1e-6 * radius)
    r_0 = 0.5 * jnp.sqrt(length * width)
    pressure = p[model.GAMMA_N] * r_0 / model.ATMOSPHERE
    shear = p[model.MODULUS] * pressure ** p[model.N_E]
    oblong = _larger(length, width) / _smaller(length, width)
    shape = 0.957 * jnp.exp(0.0394 * oblong)
    nu = p[model.NU]
    k_t = 8.0 * shear * r_0 / (2.0 - nu)
    normal = shape * 4.0 * shear * r_0 / (1.0 - nu) * y[5] * elastic
    normal = _positive(normal)
    tangential = k_t * y[6] * elastic
    k_r = 8.0 * shear * r_0 * r_0 * r_0 / (3.0 * (1.0 - nu))
    moment = k_r * y[7] * elastic / radius
    flow_n, flow_t, flow_r = _plastic_flow(
        normal, tangential, moment, y[8], (sinking, length, width), p
    )
    limit = normal * p[model.TAN_B]
    excess = _positive(tangential - limit) - _positive(-tangential - limit)
    slip = excess / (k_t * p[model.SLIDER])
    path = (
        _positive(flow_n)
        + p[model.ALPHA_VT] * abs(flow_t)
        + p[model.ALPHA_VR] * length * abs(flow_r)
    )
    v_n, v_t, spin = y[2] * speed, y[3] * speed, y[4] * speed / radius
    torque = tangential * r_n - normal * r_t - moment
    return (
        v_n / radius,
        spin,
        (p[model.G_N] - normal / p[model.MASS]) / speed,
        (p[model.G_T] - tangential / p[model.MASS]) / speed,
        torque / p[model.INERTIA] * radius / speed,
        (v_n + tangency * spin - flow_n) / elastic,
        (v_t - r_n * spin - flow_t - slip) / elastic,
        (spin - flow_r) * radius / elastic,
        p[model.C_V] * (1.0 - y[8]) * path / length,
    )


def _right_hand_side(t, change, p):
    """Rates in units of time of R over the speed, of the changes since the start of
    the window, which stands behind the parameters."""
    y = [change[i] + p[model.PARAMETERS + i] for i in range(model.STATES)]
    unit = p[model.R] / p[model.SPEED]
    return tuple(rate * unit for rate in _rates(y, p))


@functools.cache
def _course(method: str):
    """The compiled course of a window at given times; NaN where diffsol gave up."""
    problem = ODEProblem(
        _right_hand_side,
        y0=jnp.zeros(model.STATES),
        params=jnp.ones(model.PARAMETERS + model.STATES),
    )

    @functools.partial(jax.jit, static_argnums=3)
    def states(p, start, times, tolerance):
        _, changes = problem.solve(
            jnp.concatenate([p, start]),
            times,
            ode_solver=method,
            h0=FIRST_STEP,
            rtol=tolerance,
            atol=FLOOR * tolerance,
        )
        return start + changes

    def course(p, start, times, tolerance):
        try:
            return np.asarray(states(p, start, times, tolerance))
        except (ValueError, jax.errors.JaxRuntimeError):
            return np.full((len(times), model.STATES), math.nan)

    return course


def _end(course, times, beyond, p):
    """v_n where the margin is zero on the cubic before the point `beyond`."""
    slopes = np.empty((2, model.STATES))
    for place, slope in zip((beyond - 1, beyond), slopes, strict=True):
        model.rates(course[place], p, slope)
    slopes *= p[model.R] / p[model.SPEED]
    ends = times[beyond - 1 : beyond + 1]
    cubic = CubicHermiteSpline(ends, course[beyond - 1 : beyond + 1], slopes)
    return cubic(brentq(lambda t: model.margin(cubic(t), p), *ends))[2]


def _integrate(p, start, tolerance, method):
    with jax.enable_x64(True):  # a process of a batch begins with float32
        return _by_windows(p, start, tolerance, method)


def _by_windows(p, start, tolerance, method):
    points = math.ceil(POINTS * max(1.0, (1e-4 / tolerance) ** 0.25))
    fall = math.sqrt(model.GRAVITY * p[model.R])
    full = width = WINDOW * p[model.SPEED] / (p[model.SPEED] + fall)
    left, state = model.TIME_LIMIT * p[model.SPEED] / p[model.R], start
    # A last window as short as the first step would end the process.
    while left > SHORTEST * full:
        times = np.linspace(0.0, min(width, left), points)
        course = _course(method)(p, state, times, tolerance)
        if not np.all(np.isfinite(course)):
            # It may have failed beyond the end: come nearer first.
            width *= 0.25
            if width < SHORTEST * full:
                return math.nan
            continue
        for place in range(1, points):
            if model.margin(course[place], p) <= 0.0:
                return -_end(course, times, place, p) / start[2]
        left, state = left - times[-1], course[-1]
        width = min(4.0 * width, full)
    return -state[2] / start[2]


class Diffsol(Compiled):
    """A method of diffsol."""

    family = "diffsol"

    def __init__(self, name: str, method: str, tolerances: tuple[float, ...]):
        self.name, self.method, self.tolerances = f"diffsol {name}", method, tolerances

    def solve(self, scenes, tolerance: float, batch: bool) -> Answer:
        """Impacts in as many processes as cores, or one after another here."""
        p, start = model.parameters_and_start(scenes, self.slider_time)
        if not batch:
            _integrate(p[0], start[0], tolerance, self.method)  # compiles
        return solve_scenes(_integrate, p, start, tolerance, batch, method=self.method)


def methods() -> list[Diffsol]:
    """What this module brings."""
    return [
        Diffsol("BDF", "bdf", (1e-3, 3e-4, 1e-4, 1e-5, 1e-6)),
        Diffsol("ESDIRK34", "esdirk34", (1e-3, 3e-4, 1e-4, 1e-5)),
    ]
