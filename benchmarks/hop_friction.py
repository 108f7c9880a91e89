r"""Rolling friction that loses as much energy as the hops of a block.

    python -m benchmarks.hop_friction [SPEED ...]

A block that is not round rolls by striking with one end after another. Where each of
these hops is an impact, it loses the kinetic and potential energy $\Delta E$ over a
distance L along level ground, as much as by the angle of rolling friction

$$ \tan\varphi_r = \frac{\Delta E}{m g L} $$

This depends on the block more than on the ground, and on the speed: see
`docs/limits.md`. Printed are the angles of blocks of 100 kg on the default ground, for
some speeds at the start.
"""

import sys

import jax
import jax.numpy as jnp
import numpy as np

from jaximpact import Block, Soil
from jaximpact.runout import (
    FullModel,
    Ground,
    MotionMode,
    Profile,
    Release,
    Runs,
    simulate_runout,
)
from jaximpact.scene import GRAVITY

ORIENTATIONS = 32
"""Orientations at the start of each block, evenly over half a turn."""
CLEARANCE = 1e-3
"""Height over the ground at the start [m]."""
ROUNDING = 1e-9
"""Heave, as a fraction of the radius, that is rounding."""
ASPECT_RATIOS = 1.2, 1.5, 2.0, 3.0, 4.0


def main() -> None:
    """Print the angles, a line for each speed."""
    jax.config.update("jax_enable_x64", True)
    print("m/s   ", *(f"A_r {ratio:<4g}" for ratio in ASPECT_RATIOS))
    for speed in map(float, sys.argv[1:] or ("6", "10", "20")):
        block = Block(mass=100.0, aspect_ratio=np.array(ASPECT_RATIOS))
        angles = np.degrees(rolling_friction_of_hops(block, Soil(), speed))
        print(f"{speed:<6g}", *(f"{angle:<8.1f}" for angle in angles))


def rolling_friction_of_hops(
    block: Block,
    soil: Soil,
    speed: float = 10.0,
) -> np.ndarray:
    """Find the angle of rolling friction that loses as much energy as hops [rad].

    The result has shape `(blocks,)`. Each block is released rolling on level ground, at
    32 orientations, and followed by the full model with each hop an impact
    (`hop_threshold` 0) until it rolls or slides; the losses from its second contact on
    are added up.

    Args:
        block, soil: fields that broadcast to `(blocks,)`.
        speed: speed at the start [m/s], from 0. A block loses the more over a distance
            the slower it is, so take the speed at which it rolls on the slope.

    Returns:
        Angles; NaN for round blocks, which do not hop, and for blocks that make no
        three contacts before they roll. To some hundredths of their tangents: more
        orientations change them by as much.
    """
    count = max(np.size(leaf) for leaf in jax.tree.leaves((block, soil)))

    def repeated(leaf):
        return np.repeat(
            np.broadcast_to(np.asarray(leaf, float), (count,)), ORIENTATIONS
        )

    blocks, soils = jax.tree.map(repeated, (block, soil))
    turns = (np.arange(ORIENTATIONS) + 0.5) / ORIENTATIONS * np.pi
    theta = np.tile(turns, count)
    radius, rolling = _radii(blocks, theta)
    release = Release(
        blocks,
        x=0.0,
        y=radius + CLEARANCE,
        v_x=speed,
        orientation=theta,
        angular_velocity=speed / rolling.radius,
    )
    far = 100.0 * (1.0 + speed**2 / GRAVITY)
    runs = simulate_runout(
        Profile([-far, far], [0.0, 0.0]),
        release,
        FullModel("fast"),
        ground=Ground(jax.tree.map(lambda leaf: leaf[:, None], soils)),
        hop_threshold=0.0,
    )
    lost, way = _losses(runs).reshape(2, count, ORIENTATIONS).sum(axis=2)
    is_round = rolling.tallest <= (1.0 + ROUNDING) * rolling.radius
    hops = (way > 0.0) & ~is_round[::ORIENTATIONS]
    return np.where(hops, np.arctan(lost / np.where(hops, way, 1.0)), np.nan)


def _radii(blocks: Block, theta: np.ndarray):
    """Compute the heights of the centres over the ground at the start [m], and the
    round blocks that roll in place of the blocks."""

    def of_one(block, theta):
        shape, axes = block.shape, block.semi_axes
        height = shape.support(axes, jnp.sin(theta), jnp.cos(theta))
        return height, shape.round_block(axes)

    return jax.tree.map(np.asarray, jax.jit(jax.vmap(of_one))(blocks, theta))


def _losses(runs: Runs) -> np.ndarray:
    """Compute the energy lost over the weight, and the way on which it was lost [m],
    `(2, blocks)`, from the second contact to the last one before the block rolls or
    slides."""
    contacts, pieces = runs.contacts, runs.pieces
    mass, inertia = runs.release.mass_properties
    found = np.zeros((2, runs.release.count))
    on_ground = np.isin(pieces.motion, [MotionMode.rolling, MotionMode.sliding])
    first = np.full(runs.release.count, np.inf)
    np.minimum.at(first, pieces.trajectory[on_ground], pieces.time[on_ground])
    hops = contacts.time <= first[contacts.trajectory]
    lanes = np.arange(runs.release.count)
    begin, end = (
        np.searchsorted(contacts.trajectory[hops], lanes, side)
        for side in ("left", "right")
    )
    lanes = lanes[end - begin > 2]
    row = np.flatnonzero(hops)
    squared = (
        contacts.normal_velocity_before**2
        + contacts.tangential_velocity_before**2
        + (inertia / mass)[contacts.trajectory] * contacts.angular_velocity_before**2
    )
    energy = 0.5 * squared / GRAVITY + contacts.y
    second, last = row[begin[lanes] + 1], row[end[lanes] - 1]
    found[0, lanes] = energy[second] - energy[last]
    found[1, lanes] = np.abs(contacts.x[last] - contacts.x[second])
    return found


if __name__ == "__main__":
    main()
