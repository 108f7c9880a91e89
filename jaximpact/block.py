"""The rock block: homogeneous, given by its mass, its density and its shape."""

from ._types import Scalar
from .parameters import Composite, parameter, part
from .shapes import AbstractShape, Ellipsoid, SemiAxes


class Block(Composite):
    """A homogeneous block.

    `Block(aspect_ratio=2.0)` is an ellipsoid of revolution twice as long as thick;
    `Block(shape=EllipticCylinder(aspect_ratio=2.0))` another shape. Parameters of the
    shape are set and read by their names alone: `block.aspect_ratio`.

    Sizes and inertia are recomputed from the parameters, so that gradients with respect
    to any of them are complete.
    """

    mass: Scalar = parameter(
        100.0, "kg", "(0, inf)", "mass", column="mass_kg", usual=(1e-6, 1e8)
    )
    density: Scalar = parameter(
        2577.8,
        "kg/m3",
        "(0, inf)",
        "density",
        column="density_kgm3",
        usual=(100.0, 2e4),
    )
    shape: AbstractShape = part(AbstractShape, Ellipsoid)

    @property
    def semi_axes(self) -> SemiAxes:
        """H, R and W [m]."""
        return self.shape.semi_axes(self.mass, self.density)

    @property
    def inertia(self) -> Scalar:
        """Moment of inertia about the out-of-plane axis through the centre [kg m2]."""
        return self.shape.inertia(self.mass, self.semi_axes)

    @property
    def sphericity(self) -> Scalar:
        r"""Sphericity index $S_p = A_r^{-2/3}$, of the lengths H and R = W alone,
        whatever the shape (eq. 8 of the paper by our count, see docs/model.md; others
        call it eq. 17)."""
        return self.aspect_ratio ** (-2.0 / 3.0)
