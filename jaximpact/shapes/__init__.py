"""Shapes of blocks: what a shape has to give, and those that there are."""

from .base import AbstractShape, Section, SemiAxes
from .elliptic import AbstractElliptic, Ellipsoid, EllipticCylinder
from .foundation import Foundation, foundation
from .prism import RectangularPrism
from .rolling import RoundBlock

__all__ = [
    "AbstractElliptic",
    "AbstractShape",
    "Ellipsoid",
    "EllipticCylinder",
    "Foundation",
    "RectangularPrism",
    "RoundBlock",
    "Section",
    "SemiAxes",
    "foundation",
]
