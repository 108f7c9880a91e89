"""The ground as each block finds it: soil, rolling friction and roughness."""

import dataclasses

import jax
import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..fields import expect, real_numbers, whole_number
from ..formats.columns import InputColumn, columns_of_part
from ..soil import Soil
from ..units import DEGREE
from .profile import (
    ROLLING_COLUMN,
    ROLLING_FRICTION_ANGLE,
    ROUGHEST,
    ROUGHNESS_COLUMN,
    Profile,
)


def _angle(
    name: str, default: float, upper: float, upper_allowed: bool, meaning: str
) -> InputColumn:
    return InputColumn(
        *(name, "ground", name.removesuffix("_deg"), DEGREE, default / DEGREE),
        *(0.0, upper, True, upper_allowed, "deg", meaning),
    )


ANGLE_COLUMNS: dict[str, InputColumn] = {
    ROLLING_COLUMN: _angle(
        *(ROLLING_COLUMN, ROLLING_FRICTION_ANGLE, 90.0, False),
        "angle of rolling friction",
    ),
    ROUGHNESS_COLUMN: _angle(
        *(ROUGHNESS_COLUMN, 0.0, ROUGHEST / DEGREE, True),
        "standard deviation of the angle of the ground's facets",
    ),
}
"""Of the ground, beside those of its soil."""


def ground_columns(soil: Soil) -> dict[str, InputColumn]:
    """The columns of a ground: those of its soil, with those of its laws, and those of
    `ANGLE_COLUMNS`."""
    return columns_of_part("soil", soil) | ANGLE_COLUMNS


@dataclasses.dataclass(frozen=True)
class Ground:
    """What the ground is for each block of a run.

    Args:
        soil: fields that broadcast to `(blocks, segments)`.
        rolling_friction_angle: likewise [rad], in [0, pi/2); as a profile's if not
            given.
        roughness: standard deviation of the angle of facets [rad], likewise, from 0 to
            `ROUGHEST`; see `roughness`.
        seed: of the facets.
        numbers: of the blocks, `(blocks,)`, by which their facets are drawn; from 0 on
            if not given.

    Raises ValueError, in one sentence, for values out of range.
    """

    soil: Soil = dataclasses.field(default_factory=Soil)
    rolling_friction_angle: ArrayLike = ROLLING_FRICTION_ANGLE
    roughness: ArrayLike = 0.0
    seed: int = 0
    numbers: np.ndarray | None = None

    def __post_init__(self):
        # Arrays of NumPy: they are looked up lane by lane.
        expect("a ground's soil", self.soil, Soil)
        whole_number("a ground's seed", self.seed, 0)
        soil = jax.tree.map(lambda leaf: np.asarray(leaf, float), self.soil)
        object.__setattr__(self, "soil", soil)
        for name in ("rolling_friction_angle", "roughness"):
            values = real_numbers(f"a ground's {name}", getattr(self, name))
            object.__setattr__(self, name, np.asarray(values, float))
        for column in ground_columns(soil).values():
            values = getattr(soil if column.part == "soil" else self, column.field)
            allowed = column.is_allowed(values / column.factor)
            if not np.all(allowed):
                value = float(np.asarray(values)[~allowed].flat[0])
                raise InputError(
                    f"a ground's {column.name} must be {column.requirement}, but holds "
                    f"{column.told(value, column.si_unit)}"
                )

    @classmethod
    def of_profile(cls, profile: Profile, seed: int = 0) -> "Ground":
        """The profile's own, alike for all blocks."""
        return cls(
            profile.soil, profile.rolling_friction_angle, profile.roughness, seed
        )

    def of_blocks(self, chosen: np.ndarray) -> "Ground":
        """That of some blocks, which keep their numbers."""

        def take(values):
            own = values.ndim == 2 and len(values) > 1
            return values[chosen] if own else values

        return Ground(
            jax.tree.map(take, self.soil),
            take(self.rolling_friction_angle),
            take(self.roughness),
            self.seed,
            chosen if self.numbers is None else self.numbers[chosen],
        )


def spread(values: np.ndarray, blocks: int, segments: int) -> np.ndarray:
    """A quantity of the ground as `(blocks, segments)`, without a copy.

    Raises ValueError, in one sentence, where its shape does not allow that.
    """
    try:
        return np.broadcast_to(values, (blocks, segments))
    except ValueError:
        raise ValueError(
            f"fields of a ground must broadcast to {blocks} blocks and {segments} "
            f"segments, but one has shape {np.shape(values)}"
        ) from None
