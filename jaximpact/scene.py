"""Block, soil, impact, and the scene of all three; selections of many scenes."""

import dataclasses
from typing import TYPE_CHECKING, Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from . import laws
from ._checks import expect, real_numbers
from ._jax_internals import Tracer, broadcast_shapes
from ._settings import own_settings
from ._tables import html_table
from ._types import Scalar
from .errors import InputError
from .parameters import Composite, parameter, part, with_fields
from .shapes import AbstractShape, Ellipsoid, MixedShapes, SemiAxes
from .units import DEGREE


class Soil(Composite):
    """The ground under an impact; the defaults are Table 1, a very dense sand.

    It is made up of laws, each with parameters of its own and replaceable by another:
    `Soil(flow=FluidityRate())`. Parameters are set and read by their names alone,
    wherever they stand: `Soil(gamma_v=5.0)`, `soil.gamma_v`. Any of them can be swept,
    batched, differentiated and fitted. Angles in radians, unit weight in N/m3.

    Source: Dattola, Crosta and di Prisco (2023), Table 1. The paper does not print the
    functions in which these parameters stand; each law says of which source it is our
    reading.
    """

    unit_weight: Scalar = parameter(
        18.0, "kN/m3", "(0, inf)", "unit weight of the ground", usual=(1.0, 100.0)
    )
    friction_angle: Scalar = parameter(
        30.0, "deg", "(0, 60)", "friction angle phi'", usual=(2.0, 60.0)
    )
    relative_density: Scalar = parameter(
        0.90, "-", "[0, 1]", "relative density D_r0 (0 to 1, not percent)"
    )
    elasticity: laws.AbstractElasticity = part(
        laws.AbstractElasticity, laws.DuncanChang
    )
    damping: laws.AbstractDamping = part(laws.AbstractDamping, laws.DampingRatios)
    peak_friction: laws.AbstractPeakFriction = part(
        laws.AbstractPeakFriction, laws.Bolton
    )
    bearing: laws.AbstractBearing = part(laws.AbstractBearing, laws.Vesic)
    loading_surface: laws.AbstractLoadingSurface = part(
        laws.AbstractLoadingSurface, laws.NovaMontrasio
    )
    flow: laws.AbstractFlow = part(laws.AbstractFlow, laws.Perzyna)
    hardening: laws.AbstractHardening = part(
        laws.AbstractHardening, laws.HardeningPerLength
    )
    slider: laws.AbstractSlider = part(laws.AbstractSlider, laws.Coulomb)
    kinematics: laws.AbstractKinematics = part(
        laws.AbstractKinematics, laws.DeepestPoint
    )

    if TYPE_CHECKING:  # what the signature says at run time, for editors

        def __init__(
            self,
            unit_weight: Any = ...,
            friction_angle: Any = ...,
            relative_density: Any = ...,
            elasticity: Any = ...,
            damping: Any = ...,
            peak_friction: Any = ...,
            bearing: Any = ...,
            loading_surface: Any = ...,
            flow: Any = ...,
            hardening: Any = ...,
            slider: Any = ...,
            kinematics: Any = ...,
            *,
            k_E: Any = ...,
            n_E: Any = ...,
            poisson: Any = ...,
            S_ef: Any = ...,
            eta_N: Any = ...,
            eta_T: Any = ...,
            eta_R: Any = ...,
            delta_1: Any = ...,
            delta_2: Any = ...,
            cohesion: Any = ...,
            beta: Any = ...,
            psi: Any = ...,
            gamma_v: Any = ...,
            dilatancy: Any = ...,
            c_v: Any = ...,
            alpha_vT: Any = ...,
            alpha_vR: Any = ...,
            alpha_s: Any = ...,
            **of_other_parts: Any,
        ) -> None: ...

    @classmethod
    def very_dense_sand(cls) -> "Soil":
        """Return the very dense sand of Dattola, Crosta and di Prisco (2023), Table 1:
        the defaults."""
        return cls()

    @classmethod
    def supplement_gamma_v_1_70(cls) -> "Soil":
        """Return the ground of the paper's supplementary material with c_v = 0.5 and
        gamma_v = 1.70 m/s; the rest is Table 1.

        Source: Dattola, Crosta and di Prisco (2023), discussion of the parametric sets.
        """
        return cls(c_v=0.5, gamma_v=1.70)

    @classmethod
    def supplement_gamma_v_0_85(cls) -> "Soil":
        """Return the ground of the supplementary material with gamma_v = 0.85 m/s: the
        slowest flow, and the highest rebound, of the three."""
        return cls(c_v=0.5, gamma_v=0.85)


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

    if TYPE_CHECKING:  # what the signature says at run time, for editors

        def __init__(
            self,
            mass: Any = ...,
            density: Any = ...,
            shape: Any = ...,
            *,
            aspect_ratio: Any = ...,
            out_of_plane_ratio: Any = ...,
            **of_other_parts: Any,
        ) -> None: ...

    @property
    def semi_axes(self) -> SemiAxes:
        """Semi-axes H, R and W [m], shape of the block's parameters."""
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


GRAVITY = 9.81
"""Acceleration of gravity [m/s2]."""


class Impact(Composite):
    """State of the block as it touches the ground.

    Positive: n into the ground, t down-slope, rotation clockwise when down-slope is to
    the right.
    """

    speed: Float[Array, ""] = parameter(
        14.0, "m/s", "(0, inf)", "impact speed", column="speed_mps", usual=(1e-6, 300.0)
    )
    angle: Float[Array, ""] = parameter(
        0.0,
        "deg",
        "(-90, 90)",
        "impact angle from the ground's normal; negative up-slope",
    )
    orientation: Float[Array, ""] = parameter(
        0.0,
        "deg",
        "(-inf, inf)",
        "orientation, angle from the ground's normal to the major axis",
        usual=(-360.0, 360.0),
    )
    angular_velocity: Float[Array, ""] = parameter(
        0.0,
        "deg/s",
        "(-inf, inf)",
        "spin at impact, clockwise positive",
        usual=(-3e4, 3e4),
    )
    slope: Float[Array, ""] = parameter(0.0, "deg", "(-90, 90)", "slope angle")

    if TYPE_CHECKING:  # what the signature says at run time, for editors

        def __init__(
            self,
            speed: Any = ...,
            angle: Any = ...,
            orientation: Any = ...,
            angular_velocity: Any = ...,
            slope: Any = ...,
        ) -> None: ...

    @classmethod
    def from_degrees(
        cls, speed=14.0, angle=0.0, orientation=0.0, angular_velocity=0.0, slope=0.0
    ) -> "Impact":
        """Make an impact from angles in degrees, and spin in degrees a second."""
        angles = (angle, orientation, angular_velocity, slope)
        names = ("angle", "orientation", "angular_velocity", "slope")
        with own_settings():
            angles = {
                name: value * DEGREE
                if isinstance(value, jax.Array)
                else DEGREE * real_numbers(f"Impact.{name}", value)
                for name, value in zip(names, angles, strict=True)
            }
        return cls(speed=speed, **angles)

    @property
    def normal_velocity(self) -> Float[Array, ""]:
        """Normal velocity v_n at impact [m/s], positive into the ground."""
        return self.speed * jnp.cos(self.angle)

    @property
    def tangential_velocity(self) -> Float[Array, ""]:
        """Tangential velocity v_t at impact [m/s], positive down-slope."""
        return self.speed * jnp.sin(self.angle)


class Scene(eqx.Module):
    """A block, a soil and an impact: what one computation needs.

    Of many impacts the fields are arrays; different shapes broadcast. What is not given
    has its default.
    """

    block: Block = eqx.field(default_factory=Block)
    soil: Soil = eqx.field(default_factory=Soil)
    impact: Impact = eqx.field(default_factory=Impact)

    def __repr__(self) -> str:
        return (
            f"Scene({', '.join(f'{name}={getattr(self, name)!r}' for name in PARTS)})"
        )

    def __str__(self) -> str:
        """Write a table of all parameters, with units and meanings."""
        return "\n".join(str(getattr(self, name)) for name in PARTS)

    def _repr_html_(self) -> str:
        rows = []
        for name in PARTS:
            whole = getattr(self, name)
            rows += [(type(whole).__name__,), *whole.rows()]
        return html_table(["Scene"], rows)


KINDS = {"block": Block, "soil": Soil, "impact": Impact}
"""Fields of a scene, and their classes."""
PARTS = tuple(KINDS)

SceneLike = Scene | Block | tuple[Block, Soil, Impact]
"""Objects of which `as_scene` makes a scene."""


def as_scene(
    scene: SceneLike,
    soil: Soil | None = None,
    impact: "Impact | None" = None,
) -> "Scene":
    """Make a scene from one, or from its block, soil and impact, side by side or in a
    tuple; what is left out has its default. Raises InputError for anything else."""
    if isinstance(scene, Scene):
        if soil is not None or impact is not None:
            raise InputError(
                "a scene holds its soil and its impact already; give the scene alone, "
                "or block, soil and impact"
            )
        return scene
    if isinstance(scene, tuple | list):
        if soil is not None or impact is not None or not 1 <= len(scene) <= 3:
            raise InputError(
                "a scene in a tuple is its block, soil and impact, and nothing beside "
                f"it, but the tuple has {len(scene)} entries"
            )
        return as_scene(*scene)
    components = {"block": scene, "soil": soil, "impact": impact}
    for name, value in components.items():
        if value is None:
            components[name] = KINDS[name]()
        else:
            expect(name, value, KINDS[name])
    return with_fields(Scene, components)


def shape_of(scene: Scene) -> tuple[int, ...]:
    """Find the shape that the fields of a scene broadcast to; InputError if they do
    not."""
    shapes = [np.shape(leaf) for leaf in jax.tree.leaves(scene)]
    try:
        return broadcast_shapes(*shapes)
    except ValueError:
        text = ", ".join(sorted({str(shape) for shape in shapes if shape}))
        raise InputError(
            "fields of a scene must be scalars or arrays that broadcast, but have "
            f"shapes {text}"
        ) from None


def with_axes(scene: Scene, count: int) -> Scene:
    """Give every field of a scene a number of axes, the missing ones of length one in
    front.

    Fields broadcast as before, and also after `jax.vmap` has put an axis in front of
    each, where those with fewer axes would no longer match.
    """

    def field(leaf):
        missing = count - jnp.ndim(leaf)
        return jnp.reshape(leaf, (1,) * missing + jnp.shape(leaf)) if missing else leaf

    return jax.tree.map(field, scene)


class Selection:
    """An index into impacts, to be applied to their numbers, scene and history.

    Args:
        shape: of the impacts.
        index: whatever NumPy takes as an index of an array of this shape.
        tree: what will be indexed; where JAX traces the tree or the index, JAX does it.
    """

    def __init__(self, shape: tuple[int, ...], index, tree):
        index = index if isinstance(index, tuple) else (index,)
        leaves = jax.tree.leaves((index, tree))
        self.traced = any(isinstance(leaf, Tracer) for leaf in leaves)
        self._shape = shape
        self._index = tuple(map(_as_array, index))
        # JAX takes 50 microseconds for each of 60 arrays, and compiles for each new
        # shape: it is for what NumPy cannot do.
        self._numpy = jnp if self.traced else np

    def of_numbers(self, tree):
        """Return the entries of arrays that have one entry for each impact."""
        return jax.tree.map(lambda leaf: self._entries(leaf, self._shape, 0), tree)

    def of_scene(self, scene: Scene) -> Scene:
        """Return the scenes of the impacts selected.

        A field that is one number for all impacts stays one number. A single scene has
        its own shape in place of several.
        """

        def of_field(leaf):
            return self._entries(leaf, self._shape, 0) if np.ndim(leaf) else leaf

        selected = jax.tree.map(of_field, scene)
        shape = selected.block.shape
        is_single = not any(map(np.ndim, jax.tree.leaves(selected)))
        mixed = isinstance(shape, MixedShapes) and not isinstance(shape.index, Tracer)
        if is_single and mixed:
            single = shape.alone(int(shape.index))
            block = dataclasses.replace(selected.block, shape=single)
            return Scene(block, selected.soil, selected.impact)
        return selected

    def of_history(self, history):
        """Return the entries of series, whose last axis is time; one for all impacts
        stays."""

        def of_series(leaf):
            if np.ndim(leaf) < 2:
                return leaf
            return self._entries(leaf, (*self._shape, np.shape(leaf)[-1]), 1)

        return jax.tree.map(of_series, history)

    def _entries(self, leaf, shape: tuple[int, ...], further_axes: int):
        if any(entry is Ellipsis for entry in self._index):
            index = self._index + (slice(None),) * further_axes
        else:
            index = (*self._index, ...)  # which gives arrays, never NumPy's scalars
        values = self._numpy.asarray(leaf)
        if values.shape != shape:
            values = self._numpy.broadcast_to(values, shape)
        return values[index]


def _as_array(entry):
    """Make an entry of an index one that NumPy and JAX both take."""
    if isinstance(entry, list):
        return np.asarray(entry) if entry else np.zeros(0, int)
    is_array = hasattr(entry, "__array__") and not isinstance(entry, Tracer)
    return np.asarray(entry) if is_array else entry
