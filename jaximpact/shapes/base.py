"""What the model takes from the shape of a block."""

import abc
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from ..parameters import Part
from .parting import farthest_direction
from .rolling import RoundBlock, round_block

Scalar = Float[Array, ""]
Flag = Bool[Array, ""]


class SemiAxes(NamedTuple):
    """Half of the block's sizes [m]."""

    major: Scalar
    """H, in the plane of motion, along the axis from which orientation is measured."""
    minor: Scalar
    """R, in the plane of motion, across it."""
    out_of_plane: Scalar
    """W, normal to the plane of motion."""


class Section(NamedTuple):
    """Where the ground cuts the block, from its centre; in metres."""

    left: Scalar
    """t_1, up-slope end: of the section at ground level or, where it lies below the
    ground, the block's widest point on that side."""
    right: Scalar
    """t_2, down-slope end, likewise."""
    width: Scalar
    """B_w, size out of the plane of motion."""


class AbstractShape(Part):
    r"""Shape of a homogeneous block, symmetric about its three axes.

    A shape of one's own derives from this class, declares its parameters, of which
    `aspect_ratio` H/R and `out_of_plane_ratio` W/R are two, and defines `unit_volume`,
    `unit_inertia`, `support` and `section` in `jax.numpy`; the rest has defaults. Sizes
    come as `SemiAxes`, the orientation $\Theta$ from the ground's normal to the major
    axis as its sine and cosine (positive clockwise, down-slope to the right). All
    functions take and return scalars, and must be finite, with finite derivatives, for
    every finite input.
    """

    @property
    @abc.abstractmethod
    def unit_volume(self) -> Scalar:
        """Volume over R^3 [-]."""

    @property
    @abc.abstractmethod
    def unit_inertia(self) -> Scalar:
        """Moment of inertia about the out-of-plane axis through the centre, over
        m R^2 [-]."""

    @abc.abstractmethod
    def support(
        self, axes: SemiAxes, sin: Scalar, cos: Scalar, *, side: Flag | None = None
    ) -> Scalar:
        r"""Height $r_y(\Theta)$ of the centre over a ground that the block touches [m].

        Args:
            side: of `side_of`, on which to stay; None for the one where it is.
        """

    @abc.abstractmethod
    def section(
        self, axes: SemiAxes, sin: Scalar, cos: Scalar, height: Scalar, sinking: Scalar
    ) -> Section:
        """Section by the ground with the centre at a `height` over it and the lowest
        point at a depth `sinking` [m] (positive; their sum is the support)."""

    def semi_axes(self, mass: Scalar, density: Scalar) -> SemiAxes:
        r"""H, R and W, with $R = \sqrt[3]{m / (\rho V_1)}$ and $V_1$ the unit volume.

        Args:
            mass: m [kg]. density: rho [kg/m3].
        """
        minor = jnp.cbrt(mass / (density * self.unit_volume))
        return SemiAxes(
            self.aspect_ratio * minor, minor, self.out_of_plane_ratio * minor
        )

    def inertia(self, mass: Scalar, axes: SemiAxes) -> Scalar:
        """Moment of inertia about the out-of-plane axis through the centre [kg m2]."""
        return self.unit_inertia * mass * axes.minor**2

    def tangency_arm(
        self, axes: SemiAxes, sin: Scalar, cos: Scalar, *, side: Flag | None = None
    ) -> Scalar:
        r"""The lowest point from the centre, down-slope positive:
        $T_{low} = dr_y/d\Theta$ [m]."""
        return jax.jvp(
            lambda s, c: self.support(axes, s, c, side=side), (sin, cos), (cos, -sin)
        )[1]

    def support_change(
        self,
        axes: SemiAxes,
        start: tuple[Scalar, Scalar],
        now: tuple[Scalar, Scalar],
        sin_turn: Scalar,
        *,
        side: Flag | None = None,
    ) -> Scalar:
        """Change of the support from one orientation to another [m].

        Args:
            start, now: sine and cosine of the two. sin_turn: sine of the angle between.
            side: of the second.
        """
        return self.support(axes, *now, side=side) - self.support(axes, *start)

    def side_of(self, sin: Scalar, cos: Scalar) -> Scalar | None:
        """A function that changes sign at orientations where the lowest point jumps
        from one corner to another; None for a shape without flat faces. Steps of the
        integration end there, and between them `support` and `tangency_arm` stay on one
        side."""
        return None

    def is_upright(self, orientation):
        """Whether the block lies symmetric about the ground's normal, so that a central
        impact does not turn it: by default at multiples of 90 degrees. For NumPy arrays
        [rad]."""
        import numpy as np

        return np.abs(np.sin(2.0 * np.asarray(orientation))) <= SYMMETRIC_WITHIN

    def is_round(self):
        """Whether nothing depends on the orientation, so that a table needs one node of
        it: no shape by default. For NumPy arrays."""
        import numpy as np

        return np.zeros(np.shape(self.aspect_ratio), bool)

    @property
    def bound(self) -> Scalar:
        """Radius of the circle about the section in the plane of motion, over R [-]: by
        default that of the rectangle of its sizes."""
        return jnp.sqrt(self.aspect_ratio**2 + 1.0)

    def largest_bending(self, axes: SemiAxes) -> Scalar | None:
        """Upper bound of $r_y''$ [m], for the steps with which flights of a run-out are
        followed. None, the default, for a shape that may have flat faces; its flights
        are followed by what the circle of `bound` allows."""
        return None

    def parting_direction(
        self, axes: SemiAxes, along: Scalar, across: Scalar
    ) -> tuple[Scalar, Scalar]:
        """Direction, of any length, that parts a point from the block if the point is
        outside: by default the one in which it is farthest outside, by the support.

        Args:
            along, across: coordinates of the point from the centre, along the major
                and the minor axis [m]; so is the direction.
        """
        return farthest_direction(self, axes, along, across)

    def round_block(self, axes: SemiAxes) -> RoundBlock:
        """The round block that rolls in place of this one in a run-out: by default by
        the support at many orientations."""
        return round_block(self, axes)

    def outline(self, axes: SemiAxes, count: int = 181):
        """Points of the outline for drawings, `(count, 2)`, along the minor and the
        major axis [m]: the tangency points of all orientations."""
        import numpy as np

        turn = np.linspace(0.0, 2.0 * np.pi, count)
        points = []
        for angle in turn:
            sin, cos = jnp.sin(angle), jnp.cos(angle)
            support = float(self.support(axes, sin, cos))
            arm = float(self.tangency_arm(axes, sin, cos))
            points.append((arm * cos + support * sin, support * cos - arm * sin))
        return np.array(points, float)


SYMMETRIC_WITHIN = 1e-12
"""sin(2 theta_0) within this counts as zero: 90 degrees in radians are rounded."""
