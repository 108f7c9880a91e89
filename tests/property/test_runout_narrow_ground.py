"""Ground that is narrower than blocks: no centre goes into it unnoticed."""

import numpy as np
import pytest

from jaximpact import Block, ConstantCoefficients
from jaximpact.runout import ClosedForm, Ending, Profile, Release, simulate_runout


def walls(generator):
    """A slope with walls of centimetres and ditches between faces of 60 to 89°."""
    x, y = [0.0], [0.0]
    for _ in range(4):
        high, wide = generator.uniform(0.5, 6.0), generator.uniform(0.01, 0.6)
        turn = generator.choice([-1.0, 1.0])
        faces = high / np.tan(np.radians(generator.uniform(60.0, 89.0, 2)))
        for along, up in (
            *[(generator.uniform(2.0, 15.0), -generator.uniform(0.0, 8.0))],
            *[(faces[0], turn * high), (wide, 0.0), (faces[1], -turn * high)],
        ):
            x.append(x[-1] + along)
            y.append(y[-1] + up)
    return Profile([*x, x[-1] + 30.0], [*y, y[-1]])


@pytest.mark.parametrize("seed", range(12))
def test_no_centre_goes_into_the_ground_unnoticed(seed):
    """The centre of a block that did not fail is over the ground at every start of a
    piece, as far as rounding allows, and at its end."""
    generator = np.random.default_rng(seed)
    profile, count = walls(generator), 40
    x = generator.uniform(0.0, 0.8 * profile.x[-1], count)
    release = Release(
        Block(
            mass=2600.0 * 10.0 ** generator.uniform(-2.0, 1.0, count),
            aspect_ratio=generator.uniform(1.0, 4.0, count),
        ),
        x,
        np.max(profile.y) + 4.0,
        v_x=generator.uniform(-5.0, 15.0, count),
        orientation=generator.uniform(0.0, np.pi, count),
        angular_velocity=generator.normal(0.0, 10.0, count),
    )
    law = ClosedForm(ConstantCoefficients(e_n=0.35, e_t=0.85))
    runs = simulate_runout(profile, release, law)
    pieces, failed = runs.pieces, runs.ending == Ending.failed
    inside = profile.height(pieces.x) - pieces.y > 1e-9
    inside &= (pieces.x >= profile.x[0]) & (pieces.x <= profile.x[-1])
    assert np.all(failed[pieces.trajectory[inside]])
    stopped = runs.ending == Ending.stopped
    assert np.all(profile.height(runs.x) <= runs.y + 1e-9, where=stopped)
    assert np.all(np.isnan(runs.x) == failed)
