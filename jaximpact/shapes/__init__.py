"""Shapes of blocks: what a shape has to give, and those that there are."""

from .base import AbstractShape, Foundation, Section, SemiAxes, foundation
from .elliptic import AbstractElliptic, Ellipsoid, EllipticCylinder
from .mixed import MixedShapes, each_shape, mixed, shape_by_shape, shape_of_each
from .prism import RectangularPrism
from .support import RoundBlock

__all__ = [
    "AbstractElliptic",
    "AbstractShape",
    "Ellipsoid",
    "EllipticCylinder",
    "Foundation",
    "MixedShapes",
    "RectangularPrism",
    "RoundBlock",
    "Section",
    "SemiAxes",
    "each_shape",
    "foundation",
    "mixed",
    "shape_by_shape",
    "shape_of_each",
]
