"""Values out of their range where JAX traces them, so that none is refused: such an
impact has failed, and those beside it are as ever."""

import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaximpact import Block, Impact, Outcome, Scene, Soil, simulate
from jaximpact.backend.xla_compilation import unfused_jit
from jaximpact.errors import InputError
from jaximpact.laws import AbstractSlider, Coulomb
from jaximpact.parameters import parameter
from jaximpact.quantities import RESULT_COLUMNS, columns_of, leaf_places

pytestmark = pytest.mark.slow

SOUND = Scene(
    Block(mass=500.0, aspect_ratio=2.0),
    Soil(),
    Impact(speed=15.0, angle=0.7, orientation=0.5),
)
ANGLE = "angle_deg"


def wrong_values() -> list[tuple[str, float]]:
    """Each column, and a value in its unit that is out of its range, at every end."""
    wrong = []
    for name, column in columns_of(SOUND).items():
        for end, allowed, away in (
            (column.lower, column.lower_allowed, -1e-9),
            (column.upper, column.upper_allowed, 1e-9),
        ):
            end = math.copysign(180.0, end) if name == ANGLE else end
            # Degrees are no whole numbers any more once they were radians.
            beyond = allowed or column.unit == "deg"
            wrong.append((name, end + away if beyond else end))
    return wrong


def lanes_of(wrong: list[tuple[str, float]]) -> list[np.ndarray]:
    """Leaves of scenes side by side, a sound one before each that is wrong."""
    places, columns = leaf_places(SOUND), columns_of(SOUND)
    leaves = [np.full(2 * len(wrong), float(x)) for x in jax.tree.leaves(SOUND)]
    for lane, (name, value) in enumerate(wrong):
        leaves[places[name]][2 * lane + 1] = value * columns[name].factor
    return leaves


def of_leaves(leaves, **how):
    scene = jax.tree.unflatten(jax.tree.structure(SOUND), leaves)
    return simulate(scene, ledger=True, **how)


def assert_failed(found, wrong: list[tuple[str, float]], expected):
    """`expected` are as many impacts, all sound."""
    told = [Outcome(int(code)) for code in found.outcome_code[1::2]]
    assert dict(zip(wrong, told, strict=True)) == dict.fromkeys(wrong, Outcome.failed)
    for name in (*(column.field for column in RESULT_COLUMNS.values()), "energy"):
        for leaf, sound in zip(
            *(jax.tree.leaves(getattr(each, name)) for each in (found, expected)),
            strict=True,
        ):
            assert np.all(np.isnan(leaf[1::2])), name
            np.testing.assert_array_equal(leaf[::2], sound[::2], name)


def test_every_range_is_held_by_machine_code():
    wrong = wrong_values()
    lanes, sound = lanes_of(wrong), lanes_of([("mass_kg", 500.0)] * len(wrong))
    expected = of_leaves(sound)
    assert_failed(jax.jit(of_leaves)(lanes), wrong, expected)
    assert_failed(jax.jit(jax.vmap(of_leaves))(lanes), wrong, expected)


@pytest.mark.xla
def test_ranges_are_held_by_diffrax():
    """Of vertical drops, whose model XLA compiles fastest."""

    @unfused_jit
    def found(c_v, friction_angle):
        soil = Soil(c_v=c_v, friction_angle=friction_angle)
        result = simulate(Block(), soil, Impact(), engine="diffrax", ledger=False)
        return result.e_n, result.outcome_code

    c_v, friction_angle = np.array([1.0, -0.5, 1.0]), np.array([0.6, 0.6, 30.0])
    e_n, codes = found(c_v, friction_angle)
    expected, _ = found(np.full(3, 1.0), np.full(3, 0.6))
    assert [Outcome(int(code)) for code in codes[1:]] == [Outcome.failed] * 2
    np.testing.assert_array_equal(e_n, [expected[0], np.nan, np.nan])


def test_a_history_out_of_range_is_no_number_and_others_are_as_ever():
    def history(c_v):
        soil = Soil(c_v=c_v)
        found = simulate(SOUND.block, soil, SOUND.impact, save_at=[-1.0, 0.0, 5e-3])
        return found.history

    found, alone = jax.jit(jax.vmap(history))(np.array([-0.5, 1.0])), history(1.0)
    assert np.all(np.isnan(found.normal_force[0]))
    assert not np.any(found.in_contact[0])
    np.testing.assert_array_equal(found.normal_force[1], alone.normal_force)


def test_gradients_of_lanes_in_range_are_as_ever():
    def e_bar(c_v):
        return simulate(SOUND.block, Soil(c_v=c_v), SOUND.impact).e_bar

    lanes = np.array([0.7, -0.5, 1.0])
    found = jax.jit(jax.vmap(jax.grad(e_bar)))(lanes)
    assert found[1] == 0.0
    np.testing.assert_array_equal(found[::2], [jax.grad(e_bar)(x) for x in lanes[::2]])


def test_a_block_that_turns_may_strike_as_its_centre_rises():
    """As it does down a slope, at more than the 90 degrees that users may write."""
    how = dict(orientation=0.5, angular_velocity=-200.0, speed=5.0)
    found = jax.jit(
        lambda angle: simulate(SOUND.block, SOUND.soil, Impact(angle=angle, **how))
    )(1.7)
    assert found.outcome == Outcome.detached
    with pytest.raises(InputError, match=r"Impact.angle must be in \(-90, 90\) deg"):
        simulate(SOUND.block, SOUND.soil, Impact(angle=1.7, **how))


class Rough(AbstractSlider):
    """Coulomb's slider, with a parameter that has an upper end."""

    roughness: jax.Array = parameter(0.5, "-", "[0, 1]", "roughness of the block")

    def friction(self, friction_angle):
        return self.roughness * jnp.tan(friction_angle)

    def __call__(self, tangential, normal, stiffness, friction, *, branch=None):
        return Coulomb()(tangential, normal, stiffness, friction, branch=branch)


def test_the_range_of_a_users_law_is_held():
    def e_n(roughness):
        soil = Soil(slider=Rough(roughness=roughness))
        return simulate(SOUND.block, soil, SOUND.impact).e_n

    found = jax.jit(jax.vmap(e_n))(np.array([1.0, 1.0 + 1e-9]))
    np.testing.assert_array_equal(found, [e_n(1.0), np.nan])
