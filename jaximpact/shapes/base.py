r"""Shapes of blocks, and the equivalent foundation: the section at ground level.

The foundation in closed form. With $s, c = \sin\Theta, \cos\Theta$ of the orientation
$\Theta = \theta_0 + \theta$ and $d$ the height of the block's centre above the ground,
for the ellipsoid:

| quantity | formula | paper |
|---|---|---|
| support radius | $r_y = \sqrt{H^2 c^2 + R^2 s^2}$ | eq. 22 |
| sinking | $u_D = r_y - d$ | eqs. 38-42 |
| section | $q = \sqrt{1 - (d/r_y)^2}$, $a_t = H R q/r_y$, $a_w = W q$ | eqs. 18-21 |
| its centre | $t_{mid} = -d\,s\,c\,(H^2 - R^2)/r_y^2$ | eq. 19 |
| extreme points | $t = \pm\tau$, $\tau = \sqrt{H^2 s^2 + R^2 c^2}$ | eqs. 24-29 |
| sizes | $B_t = t_2 - t_1$, $B_w = 2 a_w$ or $2 W$ | eqs. 30-35 |
| arms | $r_n = d$, $r_t = (t_1 + t_2)/2$ | eqs. 36-37 |

Misprints of the paper mended here, each shown by a test: eq. 13 divides $w^2$ by $H^2$;
$b_1$ of eq. 22 has $R^2 + H^2$ for $H^2 - R^2$; $C_w$ of eq. 26 does not lie at the
level of the block's centre, $n = u_n - r_{y0}$; eq. 33 repeats $C_{w1}$; eq. 40 swaps
tangent and cosine.
"""

import abc
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from .._jax_internals import namespace_of
from .._types import Flag, Scalar
from ..parameters import Part
from .support import RoundBlock, farthest_direction, round_block


class SemiAxes(NamedTuple):
    """Half of the block's sizes [m]."""

    major: Scalar
    """Half size H in the plane of motion, along the axis from which orientation is
    measured."""
    minor: Scalar
    """Half size R in the plane of motion, across that axis."""
    out_of_plane: Scalar
    """Half size W normal to the plane of motion."""


class Section(NamedTuple):
    """Section of the block by the ground, from its centre [m]."""

    left: Scalar
    """Up-slope end t_1: of the section at ground level or, where it lies below the
    ground, the block's widest point on that side."""
    right: Scalar
    """Down-slope end t_2, as for t_1."""
    width: Scalar
    """Size B_w out of the plane of motion."""

    @property
    def middle(self) -> Scalar:
        """Centre r_t of the section, down-slope positive."""
        return 0.5 * (self.left + self.right)


class AbstractShape(Part):
    r"""Shape of a homogeneous block, symmetric about its three axes.

    A shape of one's own derives from this class, declares its parameters, of which
    `aspect_ratio` H/R and `out_of_plane_ratio` W/R are two, and defines `unit_volume`,
    `unit_inertia`, `support` and `section` in `jax.numpy`; the rest has defaults. Sizes
    come as `SemiAxes`, the orientation $\Theta$ from the ground's normal to the major
    axis as its sine and cosine (positive clockwise, down-slope to the right). All
    functions take and return scalars, and must be finite, with finite derivatives, for
    every finite input.

    A shape with flat faces defines `side_of` too; `support`, `tangency_arm` and
    `section` then take `side`, a keyword that other shapes are not given.
    """

    if TYPE_CHECKING:  # parameters that every shape declares
        aspect_ratio: Scalar = ...
        out_of_plane_ratio: Scalar = ...

    statements: ClassVar = {
        "tangency_arm": ("support",),
        "support_change": ("support",),
        "is_upright": ("support", "section", "cut"),
        "is_round": ("support", "section", "cut"),
        "bound": ("support",),
        "largest_bending": ("support",),
        "parting_direction": ("support",),
        "round_block": ("support",),
        "outline": ("support",),
    }
    most_slender: ClassVar[float | None] = 100.0
    """Largest ratio of the foundation's sizes in the correction J_s of the stiffness,
    which is 49 there. A block straight out of the plane of motion is beyond it down to
    a sinking of some 1e-4 R, and J_s, an exponential, would overflow; what it is there
    does not show in results. None: without limit, as the paper prints J_s."""

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
            axes: H, R and W [m]. sin, cos: of the orientation.
            side: of `side_of`, on which to stay; None for the one where it is.
        """

    @abc.abstractmethod
    def section(
        self,
        axes: SemiAxes,
        sin: Scalar,
        cos: Scalar,
        height: Scalar,
        sinking: Scalar,
        *,
        side: Flag | None = None,
    ) -> Section:
        """Section by the ground.

        Args:
            axes, sin, cos, side: as for `support`.
            height: of the centre over the ground [m]; negative once it has sunk below.
            sinking: depth of the lowest point [m], `support - height`. What is given
                where it is not positive is not used, but must be finite.
        """

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
        r"""Lowest point from the centre, down-slope positive:
        $T_{low} = dr_y/d\Theta$ [m].

        Args:
            side: as for `support`; with None, on a level face, its middle.
        """
        sides = on_side(side)
        return jax.jvp(
            lambda s, c: self.support(axes, s, c, **sides), (sin, cos), (cos, -sin)
        )[1]

    def arm_at_touch(
        self, axes: SemiAxes, sin: Scalar, cos: Scalar, spin: Scalar
    ) -> Scalar:
        """Tangency arm of a block that touches the ground with a spin [m].

        On a level face every point is lowest. The spin drives one of its ends into the
        ground: that is the one taken, so that the lowest point sinks at
        `v_n + b |spin|` with b half the face. Without spin the middle is.
        """
        if self.side_of(sin, cos) is None:
            return self.tangency_arm(axes, sin, cos)
        side, is_level = self.side_towards(sin, cos, spin)
        end = self.tangency_arm(axes, sin, cos, side=side)
        middle = self.tangency_arm(axes, sin, cos)
        return jnp.where(is_level & (spin == 0.0), middle, end)

    def support_change(
        self,
        axes: SemiAxes,
        start: tuple[Scalar, Scalar],
        now: tuple[Scalar, Scalar],
        sin_turn: Scalar,
        *,
        start_side: Flag | None = None,
        side: Flag | None = None,
    ) -> Scalar:
        """Change of the support from one orientation to another [m].

        Args:
            start, now: sine and cosine of the two. sin_turn: sine of the angle between.
            start_side, side: on which to be at the two.
        """
        before = self.support(axes, *start, **on_side(start_side))
        return self.support(axes, *now, **on_side(side)) - before

    def side_of(self, sin: Scalar, cos: Scalar) -> Scalar | None:
        """Function that changes sign at orientations where the lowest point jumps
        from one corner to another; None for a shape without flat faces. Steps of the
        integration end there, and between them `support` and `tangency_arm` stay on one
        side."""
        return None

    def side_towards(self, sin: Scalar, cos: Scalar, spin: Scalar) -> tuple[Flag, Flag]:
        """Side on which a block is, or where a face is level that to which a spin turns
        it; and whether one is level."""
        value, rate = jax.jvp(self.side_of, (sin, cos), (cos, -sin))
        is_level = jnp.abs(value) <= SYMMETRIC_WITHIN
        return jnp.where(is_level, rate * spin > 0.0, value > 0.0), is_level

    def is_upright(self, orientation):
        """Tell whether the block lies symmetric about the ground's normal, so that a
        central impact does not turn it: by default at multiples of 90 degrees. For
        arrays of NumPy, and of JAX while it traces [rad]; NaN stands for what is not
        known."""
        xp = namespace_of(orientation)
        return xp.abs(xp.sin(2.0 * xp.asarray(orientation))) <= SYMMETRIC_WITHIN

    def is_round(self):
        """Tell whether the section is a circle, so that nothing depends on the
        orientation: no shape by default. For arrays of NumPy, and of JAX while it
        traces; NaN stands for what is not known."""
        return np.zeros(np.shape(self.aspect_ratio), bool)

    def when_round(self) -> Any:
        """The same shape where it `is_round`, in fewer operations; by default
        itself."""
        return self

    @property
    def bound(self) -> Scalar:
        """Radius of the circle about the section in the plane of motion, over R [-]: by
        default that of the rectangle of its sizes."""
        return jnp.sqrt(self.aspect_ratio**2 + 1.0)

    def largest_bending(self, axes: SemiAxes) -> Scalar | None:
        """Upper bound of $r_y''$ [m], for the steps with which flights of a run-out are
        followed. None, the default, for a shape that may have flat faces; its flights
        are followed by the support at several orientations ahead."""
        return None

    def parting_direction(
        self, axes: SemiAxes, along: Scalar, across: Scalar
    ) -> tuple[Scalar, Scalar]:
        """Direction, of any length, that separates a point from the block if the point
        is outside: by default the one in which it is farthest outside, from the
        support.

        Args:
            along, across: coordinates of the point from the centre, along the major
                and the minor axis [m]; so is the direction.
        """
        return farthest_direction(self, axes, along, across)

    def round_block(self, axes: SemiAxes) -> RoundBlock:
        """Round block that rolls in place of this one in a run-out: by default from the
        support at many orientations."""
        return round_block(self, axes)

    def outline(self, axes: SemiAxes, count: int = 180) -> np.ndarray:
        """Outline in the plane of motion, for drawings [m].

        Args:
            axes: half sizes of one block.
            count: orientations, evenly spread, whose lowest points are joined.

        Returns:
            `(points, 2)`: across and along the major axis, once around and closed,
            beginning at or beside the end of the major axis. Flat faces have both their
            ends.
        """
        turn = 2.0 * np.pi * (np.arange(count) + 0.5) / count
        sin, cos = jnp.sin(turn), jnp.cos(turn)

        def lowest(s, c):
            return self.support(axes, s, c), self.tangency_arm(axes, s, c)

        support, arm = map(np.asarray, jax.vmap(lowest)(sin, cos))
        sin, cos = np.sin(turn), np.cos(turn)
        across, along = support * sin + arm * cos, support * cos - arm * sin
        points = np.column_stack([across, along])
        return np.concatenate([points, points[:1]])


def on_side(side: Flag | None) -> dict[str, Any]:
    """Return the keyword `side`, for a shape that has sides; else nothing."""
    return {} if side is None else {"side": side}


SYMMETRIC_WITHIN = 1e-12
"""sin(2 theta_0) within this counts as zero: 90 degrees in radians are rounded."""


class Foundation(NamedTuple):
    """The equivalent foundation at one moment; lengths in metres."""

    length: Scalar
    """Size B_t along the slope."""
    width: Scalar
    """Size B_w out of the plane of motion."""
    sinking: Scalar
    """Sinking u_D: depth of the block's deepest point."""
    normal_arm: Scalar
    """Height r_n of the block's centre above the ground."""
    tangential_arm: Scalar
    """Centre r_t of the foundation from the block's centre, down-slope positive."""
    tangency_arm: Scalar
    """Deepest point T_low of the block from its centre, down-slope positive."""
    most_slender: float | None = None
    """Largest ratio of the sizes in the laws [-]; see `AbstractShape`."""


def foundation(
    shape: AbstractShape,
    axes: SemiAxes,
    sin: Scalar,
    cos: Scalar,
    sinking: Scalar,
    *,
    side: Flag | None = None,
) -> Foundation:
    r"""Sizes and arms of the equivalent foundation of a sunk block.

    Args:
        shape: shape of the block. axes: its half sizes [m].
        sin, cos: sine and cosine of the orientation $\Theta$.
        sinking: $u_D$ [m], depth of the deepest point. At or below zero there is no
            section: both sizes are 0, and their gradients are 0.
        side: on which the shape is to stay; see `AbstractShape.side_of`.

    As smooth as the shape's section.

    Source: Dattola et al. (2023), appendix D, mended as told in this module's head.
    """
    sides = on_side(side)
    height = shape.support(axes, sin, cos, **sides) - sinking
    section = shape.section(axes, sin, cos, height, sinking, **sides)
    # Without a section there is no foundation to extend to the extreme points.
    touching = sinking > 0.0
    return Foundation(
        length=jnp.where(touching, section.right - section.left, 0.0),
        width=jnp.where(touching, section.width, 0.0),
        sinking=sinking,
        normal_arm=height,
        tangential_arm=section.middle,
        tangency_arm=shape.tangency_arm(axes, sin, cos, **sides),
    )
