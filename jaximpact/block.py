"""The rock block: a homogeneous ellipsoid given by its mass and its proportions."""

from typing import NamedTuple

import equinox as eqx
import jax.numpy as jnp
from jaxtyping import Array, Float

from .fields import Parameters
from .precision import float64_leaf


class SemiAxes(NamedTuple):
    """Semi-axes of the ellipsoid [m]."""

    major: Float[Array, ""]
    """H, in the plane of motion, along the axis from which orientation is measured."""
    minor: Float[Array, ""]
    """R, in the plane of motion, across it."""
    out_of_plane: Float[Array, ""]
    """W, normal to the plane of motion."""


class Block(Parameters):
    r"""A homogeneous ellipsoidal block.

    With the aspect ratio $A_r = H/R$ and the out-of-plane ratio $W/R$,

    $$ R = \left(\frac{3 m}{4 \pi \rho A_r (W/R)}\right)^{1/3},
       \qquad I = \tfrac{1}{5} m (H^2 + R^2). $$

    An aspect ratio below 1 is an oblate block (the "major" axis is then the short one).
    Sizes and inertia are recomputed from the fields, so that gradients with respect to
    any of them are complete.

    Source: Dattola, Crosta and di Prisco (2023), eq. 7; the out-of-plane semi-axis is
    a parameter of its own here, where the paper sets W = R.
    """

    mass: Float[Array, ""] = eqx.field(default=100.0, converter=float64_leaf)  # [kg]
    density: Float[Array, ""] = eqx.field(  # [kg/m3]
        default=2577.8, converter=float64_leaf
    )
    aspect_ratio: Float[Array, ""] = eqx.field(default=1.0, converter=float64_leaf)
    out_of_plane_ratio: Float[Array, ""] = eqx.field(
        default=1.0, converter=float64_leaf
    )

    @property
    def semi_axes(self) -> SemiAxes:
        """H, R and W [m]."""
        minor = jnp.cbrt(
            3.0
            * self.mass
            / (
                4.0
                * jnp.pi
                * self.density
                * self.aspect_ratio
                * self.out_of_plane_ratio
            )
        )
        return SemiAxes(
            self.aspect_ratio * minor, minor, self.out_of_plane_ratio * minor
        )

    @property
    def inertia(self) -> Float[Array, ""]:
        """Moment of inertia about the out-of-plane axis through the centre [kg m2]."""
        axes = self.semi_axes
        return self.mass * (axes.major**2 + axes.minor**2) / 5.0

    @property
    def sphericity(self) -> Float[Array, ""]:
        r"""Sphericity index $S_p = A_r^{-2/3}$ (eq. 8 of the paper by our count, see
        docs/model.md; others call it eq. 17)."""
        return self.aspect_ratio ** (-2.0 / 3.0)
