r"""Rectangular prism whose corners in the plane of motion are rounded."""

import jax.numpy as jnp
import numpy as np

from .._jax_internals import Tracer, namespace_of
from .._safe import safe_sqrt
from .._types import Scalar
from ..errors import InputError
from ..parameters import parameter
from .base import SYMMETRIC_WITHIN, AbstractShape, Section
from .elliptic import USUAL_RATIO
from .support import RoundBlock


class RectangularPrism(AbstractShape):
    r"""A rectangular prism of half sides H, R and W, rounded in the plane of motion.

    The section in the plane is a rectangle of half sides $a = H - \rho$ and
    $b = R - \rho$ with a circle of radius $\rho = \kappa \min(H, R)$ moved along it (a
    Minkowski sum): H and R are the half sides with the corners, $\kappa$ is
    `corner_radius_ratio`.

    $$ V = 2 W \left(4 H R - (4 - \pi) \rho^2\right), \qquad
       r_y = a |c| + b |s| + \rho, \qquad B_w = 2 W $$

    The inertia is that of the rounded section. With $\kappa = 1$ and H = R it is the
    circular cylinder. Sections at ground level are exact, and continuous with
    continuous first derivatives but where a face is level or upright.

    Rounding the corners leaves the faces flat: the lowest point jumps from one end of a
    face to the other where the face is level, and $r_y$ has a kink there. Steps of the
    integration end there, and derivatives are those of the side that the block comes
    from.

    The corners cannot be sharp. Under a sharp corner $B_t$ grows as the sinking does,
    and hardening per $B_t$ is then without bound at the first touch: results would
    depend on the sinking at which the integration begins. As $\kappa$ falls they go on
    changing with its logarithm.

    Source: model of the package; the paper has ellipsoids only.
    """

    aspect_ratio: Scalar = parameter(
        1.0,
        "-",
        "(0, inf)",
        "major over minor side; below 1 the major is shorter",
        usual=USUAL_RATIO,
    )
    out_of_plane_ratio: Scalar = parameter(
        1.0, "-", "(0, inf)", "out-of-plane over minor side", usual=USUAL_RATIO
    )
    corner_radius_ratio: Scalar = parameter(
        0.2, "-", "(0, 1]", "radius of the corners over the smaller of H and R"
    )

    def __check_init__(self):
        radius = self.corner_radius_ratio
        if not isinstance(radius, Tracer) and np.any(np.asarray(radius) == 0.0):
            raise InputError(
                "corner_radius_ratio must be in (0, 1], but is 0: at the first touch a "
                "sharp corner would harden the ground without bound; give a small "
                "radius, as 0.05"
            )

    def _radius(self, major, minor) -> Scalar:
        return self.corner_radius_ratio * jnp.minimum(major, minor)

    @property
    def unit_volume(self) -> Scalar:
        radius = self._radius(self.aspect_ratio, 1.0)
        area = 4.0 * self.aspect_ratio - (4.0 - jnp.pi) * radius**2
        return 2.0 * self.out_of_plane_ratio * area

    @property
    def unit_inertia(self) -> Scalar:
        r"""From the section's polar moment: two crossed rectangles less the square that
        they share, and four quarters of a circle about the corners' centres."""
        long, radius = self.aspect_ratio, self._radius(self.aspect_ratio, 1.0)
        a, b = long - radius, 1.0 - radius

        def rectangle(p, q):
            return 4.0 * p * q * (p**2 + q**2) / 3.0

        def quarters(p, q):
            # About the block's centre, of four quarters whose corners lie at (p, q):
            # the quarter's own moment, its area, and its centroid's distance.
            area, first = jnp.pi * radius**2, 4.0 / 3.0 * radius**3
            about_itself = 0.5 * jnp.pi * radius**4
            return about_itself + 2.0 * first * (p + q) + area * (p**2 + q**2)

        moment = (
            rectangle(long, b) + rectangle(a, 1.0) - rectangle(a, b) + quarters(a, b)
        )
        area = 4.0 * long - (4.0 - jnp.pi) * radius**2
        return moment / area

    def side_of(self, sin, cos) -> Scalar:
        r"""$\sin\Theta\cos\Theta$: zero where a face is level, each of the two corners
        that are lowest beside it having a sign of its own."""
        return sin * cos

    def is_upright(self, orientation):
        """Tell whether the block lies symmetric: also at 45 degrees for a square, and
        always for a circle."""
        xp = namespace_of(self.aspect_ratio, self.corner_radius_ratio, orientation)
        square = xp.asarray(self.aspect_ratio) == 1.0
        circle = square & (xp.asarray(self.corner_radius_ratio) == 1.0)
        on_corner = xp.abs(xp.cos(2.0 * xp.asarray(orientation))) <= SYMMETRIC_WITHIN
        return super().is_upright(orientation) | circle | (square & on_corner)

    @property
    def bound(self) -> Scalar:
        """Radius of the circle about the section, over R [-]."""
        long, radius = self.aspect_ratio, self._radius(self.aspect_ratio, 1.0)
        return jnp.hypot(long - radius, 1.0 - radius) + radius

    def _signs(self, sin, cos, side) -> tuple[Scalar, Scalar]:
        """Signs of sine and cosine, by the side that is told; 0 where a face is
        level."""
        if side is None:
            sin_sign, cos_sign = (
                jnp.where(jnp.abs(x) <= SYMMETRIC_WITHIN, 0.0, jnp.sign(x))
                for x in (sin, cos)
            )
            return sin_sign, cos_sign
        product = jnp.where(side, 1.0, -1.0)
        steep = jnp.abs(sin) > jnp.abs(cos)
        sin_sign = jnp.where(steep, jnp.sign(sin), product * jnp.sign(cos))
        return sin_sign, product * sin_sign

    def support(self, axes, sin, cos, *, side=None) -> Scalar:
        r"""$r_y = a |c| + b |s| + \rho$ [m]."""
        radius = self._radius(axes.major, axes.minor)
        sin_sign, cos_sign = self._signs(sin, cos, side)
        long, short = axes.major - radius, axes.minor - radius
        return long * cos_sign * cos + short * sin_sign * sin + radius

    def tangency_arm(self, axes, sin, cos, *, side=None) -> Scalar:
        r"""$T_{low} = b\, c\, \mathrm{sgn}\, s - a\, s\, \mathrm{sgn}\, c$ [m]; on a
        level face its middle."""
        radius = self._radius(axes.major, axes.minor)
        sin_sign, cos_sign = self._signs(sin, cos, side)
        long, short = axes.major - radius, axes.minor - radius
        return short * sin_sign * cos - long * cos_sign * sin

    def parting_direction(self, axes, along, across) -> tuple[Scalar, Scalar]:
        """Direction from the nearest point of the rectangle without its rounding; for a
        point inside of that one, the normal of the nearest face."""
        radius = self._radius(axes.major, axes.minor)
        beyond = jnp.abs(along) - (axes.major - radius)
        beside = jnp.abs(across) - (axes.minor - radius)
        inside = (beyond <= 0.0) & (beside <= 0.0)
        by_end = beyond >= beside
        first = jnp.where(inside, by_end.astype(float), jnp.maximum(beyond, 0.0))
        second = jnp.where(inside, (~by_end).astype(float), jnp.maximum(beside, 0.0))
        return (
            jnp.where(along < 0.0, -first, first),
            jnp.where(across < 0.0, -second, second),
        )

    def round_block(self, axes) -> RoundBlock:
        r"""Round block in closed form: the perimeter is $4(a + b) + 2\pi\rho$; the
        block falls over the corner of one of its faces, from the edge of the level
        one."""
        radius = self._radius(axes.major, axes.minor)
        a, b = axes.major - radius, axes.minor - radius
        return RoundBlock(
            2.0 / jnp.pi * (a + b) + radius,
            jnp.sqrt(a**2 + b**2) + radius,
            jnp.maximum(b / axes.major, a / axes.minor),
        )

    def section(self, axes, sin, cos, height, sinking, *, side=None) -> Section:
        major, minor, out_of_plane = axes
        radius = self._radius(major, minor)
        a, b = major - radius, minor - radius
        sin_sign, cos_sign = self._signs(sin, cos, side)
        deepest = a * cos_sign * cos + b * sin_sign * sin

        def rounded(end, direction):
            """End of the section from that of the rectangle with sharp corners."""
            along, across = height * cos - end * sin, height * sin + end * cos
            p, q = jnp.where(along < 0.0, -a, a), jnp.where(across < 0.0, -b, b)
            # Depth of the lowest point of the corner's circle; of the block's lowest
            # corner without rounding, which the onset needs
            depth = sinking + (p * cos + q * sin - deepest)
            half = safe_sqrt(depth * (2.0 * radius - depth))
            in_corner = (jnp.abs(along) > a) & (jnp.abs(across) > b)
            return jnp.where(in_corner, q * cos - p * sin + direction * half, end)

        left, right = _cut_of_rectangle(major, minor, sin, cos, height)
        left, right = rounded(left, -1.0), rounded(right, 1.0)
        extreme = a * sin_sign * sin + b * cos_sign * cos + radius
        # Depth of the right extreme point below the centre
        level = b * cos_sign * sin - a * sin_sign * cos
        return Section(
            jnp.where(-level - height < 0.0, left, -extreme),
            jnp.where(level - height < 0.0, right, extreme),
            2.0 * out_of_plane,
        )


def _cut_of_rectangle(long, short, sin, cos, height):
    """Ends of the cut of a rectangle of half sides `long` (along the major axis) and
    `short` by the ground."""
    # A face nearer to level or upright would be cut farther away than the block is
    # large.
    steep = jnp.where(jnp.abs(cos) < 1e-12, 1e-12, cos)
    level = jnp.where(jnp.abs(sin) < 1e-12, 1e-12, sin)
    first, first_half = -height * sin / steep, short / jnp.abs(steep)
    second, second_half = height * cos / level, long / jnp.abs(level)
    return (
        jnp.maximum(first - first_half, second - second_half),
        jnp.minimum(first + first_half, second + second_half),
    )
