"""Blocks that begin a run as the impact of a scene strikes the slope."""

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import ArrayLike

from ..fields import real_numbers
from ..scene import Scene
from .ground import Ground
from .profile import Profile
from .programs import closed_form
from .release import Release


@closed_form
def _at_touch(scene: Scene):
    """Velocities into and along the ground, and where the centre lies: over the ground,
    and up-slope of the point that touches."""
    shape, axes, impact = scene.block.shape, scene.block.semi_axes, scene.impact
    sin, cos = jnp.sin(impact.orientation), jnp.cos(impact.orientation)
    return (
        impact.normal_velocity,
        impact.tangential_velocity,
        shape.support(axes, sin, cos),
        shape.arm_at_touch(axes, sin, cos, impact.angular_velocity),
    )


def touching(scene: Scene, profile: Profile, x: ArrayLike) -> tuple[Release, Ground]:
    """The release of blocks that strike a profile as a scene says, and its ground.

    The impact is in the frame of the segment; its own `slope` is not used, as the
    profile says it. Rolling friction and roughness are the profile's.

    Args:
        scene: fields that broadcast to `(blocks,)`.
        profile: the slope; its soil is not used.
        x: where the blocks touch it [m], likewise.
    """
    x = np.asarray(real_numbers("x", x), float)
    leaves = [np.asarray(leaf, float) for leaf in jax.tree.leaves(scene)]
    shape = np.broadcast_shapes(*(leaf.shape for leaf in leaves), x.shape, (1,))
    of_blocks = jax.tree.map(lambda leaf: np.broadcast_to(leaf, shape), scene)
    v_n, v_t, support, arm = (np.asarray(found) for found in _at_touch(of_blocks))
    segment = np.clip(
        np.searchsorted(profile.x, x, side="right") - 1, 0, profile.segments - 1
    )
    slope = profile.slope[segment]
    sin, cos = np.sin(slope), np.cos(slope)
    release = Release(
        scene.block,
        x=x + support * sin - arm * cos,
        y=profile.height(x) + support * cos + arm * sin,
        v_x=v_t * cos - v_n * sin,
        v_y=-v_t * sin - v_n * cos,
        orientation=of_blocks.impact.orientation + slope,
        angular_velocity=of_blocks.impact.angular_velocity,
    )
    # One soil for each block, on whatever segment.
    soil = jax.tree.map(
        lambda leaf: np.reshape(leaf, (-1, 1)) if np.ndim(leaf) else leaf, scene.soil
    )
    return release, Ground(soil, profile.rolling_friction_angle, profile.roughness)
