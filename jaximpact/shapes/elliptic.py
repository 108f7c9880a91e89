r"""Blocks of elliptic section in the plane of motion: the paper's ellipsoid, and the
elliptic cylinder."""

import abc

import jax.numpy as jnp
import numpy as np

from .._jax_internals import namespace_of
from .._types import Scalar
from ..parameters import parameter
from .base import AbstractShape, Section, SemiAxes
from .circle import Circle, root_of_section
from .support import RoundBlock

USUAL_RATIO = (0.02, 50.0)


class AbstractElliptic(AbstractShape):
    """An ellipse in the plane of motion, of semi-axes H and R. Smooth everywhere."""

    aspect_ratio: Scalar = parameter(
        1.0,
        "-",
        "(0, inf)",
        "aspect ratio, major over minor semi-axis; below 1 oblate",
        usual=USUAL_RATIO,
    )
    out_of_plane_ratio: Scalar = parameter(
        1.0,
        "-",
        "(0, inf)",
        "out-of-plane ratio, out-of-plane over minor semi-axis",
        usual=USUAL_RATIO,
    )

    def support(self, axes, sin, cos, *, side=None) -> Scalar:
        r"""$r_y = \sqrt{H^2 c^2 + R^2 s^2}$ [m]. Source: Dattola et al. (2023), eq. 22,
        first line."""
        return jnp.sqrt((axes.major * cos) ** 2 + (axes.minor * sin) ** 2)

    def tangency_arm(self, axes, sin, cos, *, side=None) -> Scalar:
        r"""$T_{low} = -(H^2 - R^2)\, s\, c / r_y$ [m]; zero for a circle and at 0 and
        90 degrees."""
        difference = (axes.major**2 - axes.minor**2) * sin * cos
        return -difference / self.support(axes, sin, cos)

    def support_change(
        self, axes, start, now, sin_turn, *, start_side=None, side=None
    ) -> Scalar:
        r"""$(r_y^2 - r_{y0}^2) / (r_y + r_{y0})$ [m] with
        $r_y^2 - r_{y0}^2 = -(H^2 - R^2) \sin(2 \theta_0 + \theta) \sin\theta$, which
        keeps its digits at small rotations."""
        (sin_start, cos_start), (sin, cos) = start, now
        sin_sum = sin * cos_start + cos * sin_start
        difference = -(axes.major**2 - axes.minor**2) * sin_sum * sin_turn
        return difference / (
            self.support(axes, sin, cos) + self.support(axes, sin_start, cos_start)
        )

    def cut(
        self, axes: SemiAxes, sin, cos, height, sinking
    ) -> tuple[Scalar, Scalar, Scalar]:
        r"""Ends of the section, and $q = \sqrt{1 - (d/r_y)^2}$; see the head of
        `shapes.base`.

        Continuous, with continuous first derivatives, where an extreme point passes
        ground level; of square-root type in `sinking` at the onset, with a gradient of
        zero at zero.
        """
        major, minor, _ = axes
        support = self.support(axes, sin, cos)
        q = root_of_section(sinking / support)
        difference = (major**2 - minor**2) * sin * cos
        half_section = major * minor / support * q
        section_centre = -height * difference / support**2
        extreme = jnp.sqrt((major * sin) ** 2 + (minor * cos) ** 2)
        right_is_above = -height - difference / extreme < 0.0
        left_is_above = -height + difference / extreme < 0.0
        right = jnp.where(right_is_above, section_centre + half_section, extreme)
        left = jnp.where(left_is_above, section_centre - half_section, -extreme)
        return left, right, q

    def section(self, axes, sin, cos, height, sinking, *, side=None) -> Section:
        left, right, q = self.cut(axes, sin, cos, height, sinking)
        return Section(left, right, self.width(axes, height, q))

    @staticmethod
    @abc.abstractmethod
    def width(axes: SemiAxes, height: Scalar, q: Scalar) -> Scalar:
        """Size B_w of the section out of the plane of motion [m].

        Args:
            axes: half sizes [m]. height: of the centre over the ground [m].
            q: as `cut` gives it [-].
        """

    def is_upright(self, orientation):
        return super().is_upright(orientation) | self.is_round()

    def is_round(self):
        """Tell whether the section is a circle."""
        return namespace_of(self.aspect_ratio).asarray(self.aspect_ratio) == 1.0

    @property
    def bound(self) -> Scalar:
        """Radius of the circle about the ellipse, over R [-]."""
        return jnp.maximum(self.aspect_ratio, 1.0)

    def largest_bending(self, axes) -> Scalar:
        r"""Largest $r_y''$: $\max(H^2/R - R,\; R^2/H - H)$ [m]."""
        major, minor, _ = axes
        return jnp.maximum(major**2 / minor - minor, minor**2 / major - major)

    def parting_direction(self, axes, along, across) -> tuple[Scalar, Scalar]:
        """Normal, at the point, of the copy of the ellipse that passes through it.

        For the point at an end of a straight line this parts the ellipse from the line
        where its nearest point would: a line cuts an ellipse and its enlarged copies in
        chords with one midpoint. Where the line cuts the ellipse, the end is an end of
        the copy's chord, so that the normal leans to the side of the ellipse."""
        return along / axes.major**2, across / axes.minor**2

    def round_block(self, axes) -> RoundBlock:
        r"""Round block with the radius by Ramanujan's second formula for the perimeter:
        to 2e-7 at an aspect ratio of 2, and to 4e-5 at 6. The slope is $|H^2 - R^2|/(2
        H R)$."""
        major, minor, _ = axes
        h = ((major - minor) / (major + minor)) ** 2
        return RoundBlock(
            0.5 * (major + minor) * (1.0 + 3.0 * h / (10.0 + jnp.sqrt(4.0 - 3.0 * h))),
            jnp.maximum(major, minor),
            jnp.abs(major**2 - minor**2) / (2.0 * major * minor),
        )

    def outline(self, axes, count=180) -> np.ndarray:
        """Outline from the end of the major axis; see `AbstractShape.outline`."""
        turn = np.linspace(0.0, 2.0 * np.pi, count + 1)
        return np.column_stack(
            [float(axes.minor) * np.sin(turn), float(axes.major) * np.cos(turn)]
        )


class Ellipsoid(AbstractElliptic):
    r"""An ellipsoid, the block of the paper.

    With the aspect ratio $A_r = H/R$ and the out-of-plane ratio $W/R$,

    $$ R = \left(\frac{3 m}{4 \pi \rho A_r (W/R)}\right)^{1/3},
       \qquad I = \tfrac{1}{5} m (H^2 + R^2), \qquad B_w = 2 W q $$

    and $B_w = 2 W$ once the centre is below the ground. An aspect ratio below 1 is an
    oblate block (the "major" axis is then the short one).

    Source: Dattola, Crosta and di Prisco (2023), eq. 7 and appendix D; the out-of-plane
    semi-axis is a parameter of its own here, where the paper sets W = R.
    """

    most_slender = None

    @property
    def unit_volume(self) -> Scalar:
        return 4.0 * jnp.pi / 3.0 * self.aspect_ratio * self.out_of_plane_ratio

    @property
    def unit_inertia(self) -> Scalar:
        return (self.aspect_ratio**2 + 1.0) / 5.0

    def semi_axes(self, mass, density) -> SemiAxes:
        minor = jnp.cbrt(
            3.0
            * mass
            / (4.0 * jnp.pi * density * self.aspect_ratio * self.out_of_plane_ratio)
        )
        return SemiAxes(
            self.aspect_ratio * minor, minor, self.out_of_plane_ratio * minor
        )

    def inertia(self, mass, axes) -> Scalar:
        return mass * (axes.major**2 + axes.minor**2) / 5.0

    @staticmethod
    def width(axes, height, q) -> Scalar:
        full = 2.0 * axes.out_of_plane
        return jnp.where(height > 0.0, 2.0 * axes.out_of_plane * q, full)

    def when_round(self):
        return _when_round(self, Ellipsoid)


class EllipticCylinder(AbstractElliptic):
    r"""A cylinder of elliptic section, its axis normal to the plane of motion.

    $$ R = \left(\frac{m}{2 \pi \rho A_r (W/R)}\right)^{1/3},
       \qquad I = \tfrac{1}{4} m (H^2 + R^2), \qquad B_w = 2 W $$

    The section in the plane of motion is the ellipsoid's. Plane strain: no cut out of
    the plane is left out.
    """

    @property
    def unit_volume(self) -> Scalar:
        return 2.0 * jnp.pi * self.aspect_ratio * self.out_of_plane_ratio

    @property
    def unit_inertia(self) -> Scalar:
        return (self.aspect_ratio**2 + 1.0) / 4.0

    @staticmethod
    def width(axes, height, q) -> Scalar:
        return 2.0 * axes.out_of_plane

    def when_round(self):
        return _when_round(self, EllipticCylinder)


def _when_round(shape: AbstractElliptic, kind: type[AbstractElliptic]):
    """Return the circle of a shape of a kind. A class derived from it may have another
    geometry, and keeps it."""
    return Circle(kind.width, kind.most_slender) if type(shape) is kind else shape
