"""The undamped planar impact for compiled peers: a second implementation, in numba.

It shares no code with `jaximpact`; its equations are those of docs/model.md, kinks left
sharp, with a slider that relaxes in `slider_time`. Unknowns, each divided by its
magnitude over the impact so that one absolute tolerance suits all: u_n, theta, v_n,
v_t, Omega, the elastic displacements u_n, u_t, theta, and rho_c. They are fewer than
the paper's eleven, and let the error control see what the forces hang on; so peers are
given the best form that we know.
"""

import math

import jax
import numpy as np
from numba import njit

from jaximpact.scene import Block, Impact, Scene, Soil

GRAVITY = 9.81
ATMOSPHERE = 1e5
VERTEX = 0.01
TANGENT_FROM = 0.95
TIME_LIMIT = 1.0
STATES = 9

# Indices into the vector of parameters
H, R, W, MASS, INERTIA, SIN, COS, SUPPORT = range(8)
G_N, G_T, GAMMA_N, MODULUS, N_E, NU, BETA, C_V = range(8, 16)
GAMMA_V, ALPHA_VT, ALPHA_VR, PSI, DILATANCY, TAN_P, N_Q, N_G = range(16, 24)
DEPTH, TAN_B, SPEED, ENERGY, ELASTIC, FORCE, SLIDER = range(24, 31)
PARAMETERS = 31

compiled = njit(cache=True, nogil=True, error_model="numpy")


def parameters_and_start(
    scenes: Scene, slider_time: float = 1e-6
) -> tuple[np.ndarray, np.ndarray]:
    """Parameters `(n, 31)` and scaled states at the start `(n, 9)` of scenes."""
    block, soil, impact = jax.tree.map(
        lambda leaf: np.asarray(leaf, float),
        (scenes.block, scenes.soil, scenes.impact),
    )
    p = np.empty((np.size(impact.speed), PARAMETERS))
    p[:, SLIDER] = slider_time
    _fill_block(p, block, impact)
    _fill_soil(p, soil, impact.slope)
    speed, radius = p[:, SPEED], p[:, R]
    spin = impact.angular_velocity
    p[:, ENERGY] = 0.5 * p[:, MASS] * speed**2 + 0.5 * p[:, INERTIA] * spin**2
    shear = p[:, MODULUS] * (p[:, GAMMA_N] * radius / ATMOSPHERE) ** p[:, N_E]
    stiffness = 4.0 * shear * radius / (1.0 - p[:, NU])
    p[:, ELASTIC] = speed * np.sqrt(p[:, MASS] / stiffness)
    p[:, FORCE] = stiffness * p[:, ELASTIC]

    y = np.zeros((len(p), STATES))
    touch = 1e-6 * radius
    y[:, 0] = touch / radius
    y[:, 2] = speed * np.cos(impact.angle) / speed
    y[:, 3] = speed * np.sin(impact.angle) / speed
    y[:, 4] = spin * radius / speed
    y[:, 5] = touch / p[:, ELASTIC]
    y[:, 8] = 0.01
    return p, y


def _fill_block(p: np.ndarray, block: Block, impact: Impact) -> None:
    ratio, out_of_plane = block.aspect_ratio, block.out_of_plane_ratio
    volume_ratio = 4.0 * np.pi * block.density * ratio * out_of_plane
    p[:, R] = np.cbrt(3.0 * block.mass / volume_ratio)
    p[:, H], p[:, W] = ratio * p[:, R], out_of_plane * p[:, R]
    p[:, MASS] = block.mass
    p[:, INERTIA] = block.mass * (p[:, H] ** 2 + p[:, R] ** 2) / 5.0
    p[:, SIN], p[:, COS] = np.sin(impact.orientation), np.cos(impact.orientation)
    p[:, SUPPORT] = np.hypot(p[:, H] * p[:, COS], p[:, R] * p[:, SIN])
    p[:, SPEED] = impact.speed


def _fill_soil(p: np.ndarray, soil: Soil, slope: np.ndarray) -> None:
    phi = soil.friction_angle
    dense = soil.delta_1 * soil.relative_density
    phi_p = phi + np.radians(3.0) * np.clip(dense - soil.delta_2, 0.0, 4.0)
    tan_p = np.tan(phi_p)
    n_q = np.exp(np.pi * tan_p) * np.tan(np.pi / 4.0 + phi_p / 2.0) ** 2
    p[:, G_N], p[:, G_T] = GRAVITY * np.cos(slope), GRAVITY * np.sin(slope)
    p[:, GAMMA_N] = soil.unit_weight * np.cos(slope)
    p[:, MODULUS] = soil.S_ef * soil.k_E * ATMOSPHERE / (2.0 * (1.0 + soil.poisson))
    p[:, N_E], p[:, NU], p[:, BETA] = soil.n_E, soil.poisson, soil.beta
    p[:, C_V], p[:, GAMMA_V] = soil.c_v, soil.gamma_v
    p[:, ALPHA_VT], p[:, ALPHA_VR] = soil.alpha_vT, soil.alpha_vR
    p[:, PSI], p[:, DILATANCY] = soil.psi, soil.dilatancy
    p[:, TAN_P], p[:, N_Q], p[:, N_G] = tan_p, n_q, 2.0 * (n_q + 1.0) * tan_p
    p[:, DEPTH] = 2.0 * tan_p * (1.0 - np.sin(phi_p)) ** 2
    p[:, TAN_B] = soil.alpha_s * np.tan(phi)


def is_separating(p: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Which blocks move away from the ground as they touch it."""
    arm = -(p[:, H] ** 2 - p[:, R] ** 2) * p[:, SIN] * p[:, COS] / p[:, SUPPORT]
    return y[:, 2] + arm / p[:, R] * y[:, 4] <= 0.0


@compiled
def foundation(u_n, theta, p):
    """Sinking, length, width, normal arm, tangential arm, tangency arm."""
    H2, R2 = p[H] * p[H], p[R] * p[R]
    s_turn, c_turn = math.sin(theta), math.cos(theta)
    s = p[SIN] * c_turn + p[COS] * s_turn
    c = p[COS] * c_turn - p[SIN] * s_turn
    r_y = math.sqrt(H2 * c * c + R2 * s * s)
    # r_y^2 - r_y0^2 without cancellation
    sum_sin = s * p[COS] + c * p[SIN]
    sinking = u_n - (H2 - R2) * sum_sin * s_turn / (r_y + p[SUPPORT])
    d = r_y - sinking
    x = sinking / r_y
    q = math.sqrt(x * (2.0 - x)) if 0.0 < x < 2.0 else 0.0
    a_t = p[H] * p[R] * q / r_y
    middle = -d * s * c * (H2 - R2) / (r_y * r_y)
    tau = math.sqrt(H2 * s * s + R2 * c * c)
    tilt = (H2 - R2) * s * c / tau
    t_2 = middle + a_t if -d - tilt < 0.0 else tau
    t_1 = middle - a_t if -d + tilt < 0.0 else -tau
    width = 2.0 * p[W] * q if d > 0.0 else 2.0 * p[W]
    tangency = -(H2 - R2) * s * c / r_y
    return sinking, t_2 - t_1, width, d, 0.5 * (t_1 + t_2), tangency


@compiled
def forces(y, p):
    """Forces N, T and M before the cut of N at zero, their stiffnesses, and the
    foundation."""
    sinking, length, width, r_n, r_t, tangency = foundation(y[0] * p[R], y[1], p)
    length, width = max(length, 1e-6 * p[R]), max(width, 1e-6 * p[R])
    r_0 = 0.5 * math.sqrt(length * width)
    shear = p[MODULUS] * (p[GAMMA_N] * r_0 / ATMOSPHERE) ** p[N_E]
    shape = 0.957 * math.exp(0.0394 * max(length, width) / min(length, width))
    k_n = shape * 4.0 * shear * r_0 / (1.0 - p[NU])
    k_t = 8.0 * shear * r_0 / (2.0 - p[NU])
    k_r = 8.0 * shear * r_0**3 / (3.0 * (1.0 - p[NU]))
    normal = k_n * y[5] * p[ELASTIC]
    tangential = k_t * y[6] * p[ELASTIC]
    moment = k_r * y[7] * p[ELASTIC] / p[R]
    base = sinking, length, width, r_n, r_t, tangency
    return (normal, tangential, moment), (k_n, k_t, k_r), base


@compiled
def plastic_flow(normal, tangential, moment, rho, base, p):
    """Plastic rates along N, T and M."""
    sinking, length, width = base[0], base[1], base[2]
    small, large = min(length, width), max(length, width)
    u = max(sinking, 0.0)
    s_q = 1.0 + small / large * p[TAN_P]
    s_g = 1.0 - 0.4 * small / large
    d_q = 1.0 + p[DEPTH] * math.atan(u / small)
    capacity = (0.25 * math.pi * length * width * p[GAMMA_N]) * (
        u * p[N_Q] * s_q * d_q + 0.5 * small * p[N_G] * s_g
    )
    xi = normal / capacity
    h = tangential / (p[TAN_P] * capacity)
    m = moment / (p[PSI] * length * capacity)
    ratio2 = h * h + m * m
    xi = max(xi, 1e-6 * math.sqrt(ratio2))
    if not xi > 0.0:  # NaN too
        return 0.0, 0.0, 0.0
    z2 = ratio2 / (xi * xi)
    root = math.sqrt(z2 + VERTEX * VERTEX)
    eta = z2 / (root + VERTEX)
    w = wp = 0.0
    if eta > 0.0:
        w = eta ** (1.0 / p[BETA])
        wp = w / (p[BETA] * eta)
    # Beyond TANGENT_FROM the tangent there
    F = 1.0 / (1.0 - min(w, TANGENT_FROM))
    slope = F * F
    F += slope * max(w - TANGENT_FROM, 0.0)
    over = xi * F / rho - 1.0
    if not over > 0.0:
        return 0.0, 0.0, 0.0
    g_x = F - slope * wp * z2 / root
    if g_x < 0.0:
        g_x *= p[DILATANCY]
    g_h = slope * wp * h / (xi * root)
    g_m = slope * wp * m / (xi * root)
    rate = p[GAMMA_V] * over / math.sqrt(g_x * g_x + g_h * g_h + g_m * g_m)
    return rate * g_x, rate * g_h / p[TAN_P], rate * g_m / (p[PSI] * length)


@compiled
def rates(y, p, dy):
    """Right-hand side: scaled rates into `dy`."""
    (normal, tangential, moment), (_, k_t, _), base = forces(y, p)
    _, length, _, r_n, r_t, tangency = base
    normal = max(normal, 0.0)
    v_n, v_t = y[2] * p[SPEED], y[3] * p[SPEED]
    spin = y[4] * p[SPEED] / p[R]
    rho = y[8]
    flow_n, flow_t, flow_r = plastic_flow(normal, tangential, moment, rho, base, p)
    slip = 0.0
    excess = abs(tangential) - normal * p[TAN_B]
    if excess > 0.0:
        slip = math.copysign(excess / (k_t * p[SLIDER]), tangential)
    hardening = (
        max(flow_n, 0.0)
        + p[ALPHA_VT] * abs(flow_t)
        + p[ALPHA_VR] * length * abs(flow_r)
    )
    dy[0] = v_n / p[R]
    dy[1] = spin
    dy[2] = (p[G_N] - normal / p[MASS]) / p[SPEED]
    dy[3] = (p[G_T] - tangential / p[MASS]) / p[SPEED]
    torque = tangential * r_n - normal * r_t - moment
    dy[4] = torque / p[INERTIA] * p[R] / p[SPEED]
    dy[5] = (v_n + tangency * spin - flow_n) / p[ELASTIC]
    dy[6] = (v_t - r_n * spin - flow_t - slip) / p[ELASTIC]
    dy[7] = (spin - flow_r) * p[R] / p[ELASTIC]
    dy[8] = p[C_V] * (1.0 - rho) * hardening / length


@compiled
def margin(y, p):
    """The least dimensionless distance to an end of the impact; negative beyond it."""
    (normal, tangential, moment), (k_n, k_t, k_r), base = forces(y, p)
    sinking, length, _, _, _, tangency = base
    # A moment that is mere rounding must not topple a symmetric block.
    lever = 0.5 * normal * length - abs(moment) + 1e-12 * p[FORCE] * p[R]
    topple = max(lever / (p[FORCE] * p[R]), 1e-3 - sinking / p[R])
    spin = y[4] * p[SPEED] / p[R]
    left = 0.5 * p[MASS] * (y[2] ** 2 + y[3] ** 2) * p[SPEED] ** 2
    left += 0.5 * p[INERTIA] * spin * spin
    left += 0.5 * (
        normal * normal / k_n + tangential * tangential / k_t + moment * moment / k_r
    )
    arrest = left / p[ENERGY] - 1e-4
    # A force that is zero to rounding while the block sinks is no end.
    sinks = y[2] + tangency / p[R] * y[4]
    force = max(y[5], sinks)
    return min(force, sinking / p[R] - 0.5e-6, topple, arrest)


@compiled
def jacobian(y, p, matrix, work):
    """Forward differences of `rates`, with steps that suit the physics.

    Differences of generic width drown in rounding: loads at the onset are a billionth
    of what they grow to.
    """
    base, moved, state = work[0], work[1], work[2]
    rates(y, p, base)
    for i in range(STATES):
        state[i] = y[i]
    load = abs(y[5]) + abs(y[6]) + abs(y[7])
    for j in range(STATES):
        if j <= 1:
            step = 1e-6 * max(abs(y[0]), 1e-9)
        elif 5 <= j <= 7:
            step = 1e-6 * max(abs(y[j]), 1e-3 * load, 1e-13)
        else:
            step = 1e-7 * max(abs(y[j]), 1e-3)
        state[j] = y[j] + step
        rates(state, p, moved)
        for i in range(STATES):
            matrix[i, j] = (moved[i] - base[i]) / step
        state[j] = y[j]
