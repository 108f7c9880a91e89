"""Loading surface of the macro-element: how large a load is, and which way is
outward."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from ...safe import TINY, safe_power

Scalar = Float[Array, ""]

VERTEX_ROUNDING = 0.01
"""e [-], rounds the vertex of the surface on the axis of pure normal load."""
LARGEST_RATIO = 1e6
"""Tangential and moment loads count as at most so many times the normal load; at the
edge of toppling or slip they are of its order. Keeps powers of the ratio finite."""
TANGENT_FROM = 0.95
"""Value of w beyond which F is continued by its tangent line."""


class Load(NamedTuple):
    """A dimensionless load and the outward gradient there."""

    size: Scalar
    """rho*, size of the surface through the load."""
    normal: Scalar
    """Derivative of rho* by xi."""
    tangential: Scalar
    """Derivative of rho* by h."""
    rotational: Scalar
    """Derivative of rho* by m."""


def loading_surface(
    xi: Scalar,
    h: Scalar,
    m: Scalar,
    beta: Scalar,
    *,
    rounding: float = VERTEX_ROUNDING,
) -> Load:
    r"""Size of the surface through the load (xi, h, m), and its gradient.

    $$ \eta = \sqrt{(h^2 + m^2)/\xi^2 + e^2} - e, \quad w = \eta^{1/\beta}, \quad
       \rho^* = \xi F(w), \quad F(w) = \frac{1}{1 - w}, $$

    so that $\rho^* = \rho_c$ is the surface
    $h^2 + m^2 = \xi^2 (1 - \xi/\rho_c)^{2\beta}$ with its vertex rounded. F goes on
    along its tangent beyond $w = 0.95$. $\rho^*$ is homogeneous of degree one, so that
    load times gradient is $\rho^* \ge 0$.

    Args:
        xi: $N/V_M$ [-]; below a millionth of the other two together it counts as that.
        h: $T/(\mu V_M)$ [-].
        m: $M/(\psi B_t V_M)$ [-].
        beta: exponent $\beta$ [-], in (0, 2).
        rounding: $e$ [-], positive.

    Continuous also as xi goes to zero and below. Smooth for `xi > 0` but for a jump of
    the second derivative at $w = 0.95$; at h = m = 0 the gradient is continuous for
    beta below 2.

    Source: a reading; Nova and Montrasio (1991), radial size measure after
    di Prisco and Vecchiotti (2006).
    """
    least = (jnp.abs(h) + jnp.abs(m)) / LARGEST_RATIO
    divisor = jnp.maximum(jnp.maximum(xi, least), TINY)
    h_ratio, m_ratio = h / divisor, m / divisor
    square = h_ratio**2 + m_ratio**2
    root = jnp.sqrt(square + rounding**2)
    # eta = root - e, without cancellation; TINY keeps the power's gradient finite at 0
    eta = square / (root + rounding) + TINY
    w = safe_power(eta, 1.0 / beta)
    inside = jnp.minimum(w, TANGENT_FROM)
    slope = 1.0 / (1.0 - inside) ** 2
    factor = 1.0 / (1.0 - inside) + slope * (w - inside)
    # dF/d(ratio) / ratio: F'(w) w'(eta) / root
    common = slope * (w / (beta * eta)) / root
    return Load(
        size=divisor * factor,
        normal=factor - common * square,
        tangential=common * h_ratio,
        rotational=common * m_ratio,
    )
