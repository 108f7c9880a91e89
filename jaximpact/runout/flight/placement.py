"""Placement of blocks at release: above the ground, lying on it, or touching it."""

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import ArrayLike

from ..._checks import expect, real_numbers
from ...io.checks import warn_unusual
from ...scene import Scene
from ...shapes import shape_by_shape
from .. import libm
from ..blocks import BlockOutline, Body, Release, common_shape, fly
from ..coordinates import HIGHEST_CLIFF, RESOLVED
from ..lane_programs import closed_form
from ..terrain import Ground, Profile
from .flights import follow_flights


def check_release(release: Release, profile: Profile) -> None:
    """Raise ValueError, in one sentence, for a block that does not start on or above
    the ground of the profile, or that the coordinates do not resolve; warn of one that
    starts higher above the ground than any cliff is."""
    expect("profile", profile, Profile)
    expect("release", release, Release)
    outside = ~((release.x >= profile.x[0]) & (release.x <= profile.x[-1]))
    if np.any(outside):
        i = int(np.argmax(outside))
        raise ValueError(
            f"block {i} is released at x = {release.x[i]:.10g}, but the profile goes "
            f"from {profile.x[0]:.10g} to {profile.x[-1]:.10g}"
        )
    body, outline = release.body, release.outline
    _check_resolution(release, outline.smallest, profile)
    lying = lying_height(profile, outline, body.x, body.orientation)
    buried = body.y < lying - 1e-6 * outline.smallest  # more than rounding
    if np.any(buried):
        i = int(np.argmax(buried))
        ground = float(profile.height(release.x[i]))
        raise ValueError(
            f"block {i} is released in the ground, with its centre at y = "
            f"{release.y[i]:.10g}; at x = {release.x[i]:.10g} the ground is at y = "
            f"{ground:.10g}, and the centre must lie about {outline.smallest[i]:.3g} m "
            "above it, or more"
        )
    above = release.y - profile.height(release.x)
    if np.max(above) > HIGHEST_CLIFF:
        i = int(np.argmax(above))
        warn_unusual(
            f"block {i} is released {above[i]:.4g} m above the ground, higher than any "
            "cliff; is its y counted from where the profile's is, in the same unit?",
            "y_m",
        )


def _check_resolution(release: Release, size: np.ndarray, profile: Profile) -> None:
    corners = (profile.x[0], profile.x[-1], np.min(profile.y), np.max(profile.y))
    farthest = max(float(np.max(np.abs(c))) for c in (corners, release.y))
    coarse = np.spacing(farthest) > RESOLVED * size
    if np.any(coarse):
        i = int(np.argmax(coarse))
        raise ValueError(
            f"block {i}, of a smallest semi-axis of {size[i]:.3g} m, is too small for "
            f"coordinates of {farthest:g} m, where floating-point numbers lie "
            f"{np.spacing(farthest):.2g} m apart; count from an origin near the slope"
        )


def lying_height(
    profile: Profile, outline: BlockOutline, x: np.ndarray, orientation: np.ndarray
) -> np.ndarray:
    """Compute the height y of the centre of a block lying on the ground [m]: where it
    comes down, without turning, from above all ground."""

    def fall(outline, x, orientation):
        top = np.max(profile.y) + 2.0 * outline.largest
        still = np.zeros(len(x))
        body = Body(x, top, still, still, orientation, still)
        # Every fall has ended within a million seconds.
        ends = follow_flights(body, outline, profile, np.full(len(x), 1e6))
        return np.where(ends.touched, fly(body, ends.time).y, -np.inf)

    return shape_by_shape(fall, outline, x, orientation)


@closed_form
def _at_touch(scene: Scene):
    """Compute velocities into and along the ground, and the place of the centre: above
    the ground, and up-slope of the point that touches."""
    shape, axes, impact = scene.block.shape, scene.block.semi_axes, scene.impact
    sin, cos = jnp.sin(impact.orientation), jnp.cos(impact.orientation)
    return (
        impact.normal_velocity,
        impact.tangential_velocity,
        shape.support(axes, sin, cos),
        shape.arm_at_touch(axes, sin, cos, impact.angular_velocity),
    )


def release_at_touch(
    scene: Scene, profile: Profile, x: ArrayLike
) -> tuple[Release, Ground]:
    """Release blocks as they strike a profile at x [m] in the way that a scene says.

    The impact is in the frame of the segment; its own `slope` is not used: the profile
    gives it, and rolling friction and roughness, but not its soil.

    Returns:
        The release, and the ground with the soil of the scene.

    Raises InputError for an x that does not broadcast with the scene.
    """
    x = np.asarray(real_numbers("x", x), float)
    shape = common_shape("x and the fields of a scene", (x, scene))
    of_blocks = jax.tree.map(lambda leaf: np.broadcast_to(leaf, shape), scene)
    v_n, v_t, support, arm = shape_by_shape(_at_touch, of_blocks)
    segment = np.clip(
        np.searchsorted(profile.x, x, side="right") - 1, 0, profile.segments - 1
    )
    slope = profile.slope[segment]
    sin, cos = libm.sin(slope), libm.cos(slope)
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
