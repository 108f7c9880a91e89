"""What JAX can be set to, or asked for, around an impact: guards against transfers,
checks for NaN, shapes that are symbols."""

import functools
import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax import export

from jaximpact import Block, Impact, Scene, Soil, simulate, simulate_batch
from jaximpact.errors import InputError
from jaximpact.laws import Perzyna

pytestmark = pytest.mark.slow

SPEED = np.linspace(8.0, 14.0, 3)
KINDS = {
    "vertical sphere": (Block(), 0.0),
    "vertical, elongated": (Block(aspect_ratio=2.0), 0.0),
    "oblique, elongated": (Block(aspect_ratio=2.0), 0.4),
}


def result_of(kind: str, c_v=0.8, speed=SPEED, **how):
    block, angle = KINDS[kind]
    impact = Impact(speed=speed, angle=angle)
    return simulate(block, Soil(c_v=c_v), impact, **{"accuracy": "fast"} | how)


def e_n_of(*arguments, **how):
    return result_of(*arguments, **how).e_n


@pytest.fixture
def checked():
    with jax.debug_nans(True), jax.debug_infs(True):
        yield


@pytest.mark.parametrize("kind", KINDS)
def test_checks_for_nan_find_none_where_none_was_asked_for(checked, kind):
    """e_t has no value in a vertical impact, which is what an impact usually is."""

    def numbers(c_v):
        result = result_of(kind, c_v)
        return jnp.stack([result.e_n, result.e_bar, result.max_normal_force])

    forward, reverse = jax.jacfwd(numbers), jax.jacrev(numbers)
    for function in (numbers, jax.jit(numbers), forward, reverse, jax.jit(reverse)):
        assert np.all(np.isfinite(function(0.8)))
    for function in (numbers, forward):
        assert np.all(np.isfinite(jax.vmap(function)(jnp.array([0.8, 0.88]))))


def test_shapes_of_the_package_pass_a_check_of_ranks():
    """`jax_numpy_rank_promotion` finds shapes that a user did not mean."""

    class Own(Perzyna):
        """Another class, which is traced."""

    def numbers(gamma_v):
        soil, times = Soil(flow=Own(), gamma_v=gamma_v), np.linspace(0.0, 0.1, 5)
        impact = Impact(speed=SPEED, angle=np.array([0.1, 0.3, 0.5]))
        result = simulate(Block(), soil, impact, save_at=times, accuracy="fast")
        return result.e_n, result.history.normal_force

    with jax.numpy_rank_promotion("raise"):
        forward = jax.jacfwd(numbers)(3.0)
        reverse = jax.jit(jax.grad(lambda x: jnp.sum(numbers(x)[0])))(3.0)
        batched = jax.vmap(lambda x: numbers(x)[0])(jnp.array([3.0, 4.0]))
    assert float(reverse) == pytest.approx(float(jnp.sum(forward[0])), rel=1e-9)
    np.testing.assert_array_equal(batched[0], numbers(3.0)[0])


@pytest.mark.parametrize("kind", KINDS)
def test_checks_for_nan_let_a_whole_result_pass(checked, kind):
    block, angle = KINDS[kind]

    def whole(speed):
        return result_of(kind, speed=speed)

    for result in (whole(SPEED), jax.jit(whole)(SPEED), jax.vmap(whole)(SPEED)):
        assert np.all(np.isnan(result.e_t)) == (angle == 0.0)
        assert "e_n" in repr(result)
    # One time is in the contact, one after the end, where the motion is NaN.
    history = simulate(block, Soil(), Impact(angle=angle), save_at=[1e-3, 0.9]).history
    np.testing.assert_array_equal(np.isnan(history.penetration), [False, True])


@pytest.mark.xla
def test_checks_for_nan_pass_with_diffrax_too(checked):
    of = functools.partial(e_n_of, "vertical sphere", engine="diffrax")
    speed = SPEED[:1]
    found = jax.jvp(lambda c_v: of(c_v, speed=speed), (0.8,), (1.0,))
    assert np.all(np.isfinite(found))


def test_a_check_for_nan_still_finds_a_failed_impact_and_a_use_of_e_t():
    speed = jnp.array([np.nan, 14.0])
    with jax.debug_nans(True):
        # JAX computes what gave NaN once more, outside of jit, where NaN is refused.
        with pytest.raises(InputError, match=r"Impact.speed must be .* \(scene 0\)"):
            jax.jit(lambda v: e_n_of("vertical sphere", speed=v))(speed)
        with pytest.raises(FloatingPointError):
            2.0 * result_of("vertical sphere").e_t


def test_e_t_of_a_mean_over_impacts_is_nan_where_one_has_none():
    """What stands for NaN in the tree must not be taken for a number."""
    results = simulate(Block(), Soil(), Impact(angle=np.array([0.0, 0.3, 0.5])))
    for mean in (jnp.mean, jnp.sum, jnp.max):
        assert np.isnan(jax.tree.map(mean, results).e_t)
    assert np.isfinite(jax.tree.map(jnp.mean, results[1:]).e_t)
    shapes = jax.eval_shape(lambda: results)
    assert shapes.e_t.shape == (3,)


@pytest.mark.parametrize("level", ["disallow", "disallow_explicit"])
def test_transfers_of_the_package_pass_a_guard(level):
    of = functools.partial(e_n_of, "oblique, elongated")
    expected = of()
    at, step, speed = jnp.asarray(0.8), jnp.ones(()), jnp.asarray(SPEED)

    def new():
        """Numbers that no soil had before, which are kept."""
        new.last += 1e-6
        return new.last

    new.last = 0.7
    with jax.transfer_guard(level):
        np.testing.assert_array_equal(of(at), expected)
        assert of(new()).shape == (3,)
        scene = Scene(Block(mass=100.0 + new()), Soil(c_v=new()), Impact(speed=speed))
        assert simulate(scene).e_n.shape == (3,)
        assert simulate_batch(scene).e_n.shape == (3,)
        assert simulate(scene, save_at=[1e-3, 2e-3]).history.time.shape == (3, 2)
        np.testing.assert_array_equal(
            jax.vmap(lambda v: of(at, speed=v))(speed), expected
        )
        _, forward = jax.jvp(of, (at,), (step,))
        _, back = jax.vjp(of, at)
        np.testing.assert_allclose(back(forward)[0], forward @ forward, rtol=1e-13)
        np.testing.assert_array_equal(jax.jit(jax.jacfwd(of))(at), forward)


def exported(function, *arguments):
    program = jax.jit(function)
    names = re.findall(r"jaximpact_[0-9a-f]{32}", program.lower(*arguments).as_text())
    allowed = [export.DisabledSafetyCheck.custom_call(name) for name in names]
    return export.export(program, disabled_checks=allowed)(*arguments)


def test_shapes_may_be_symbols():
    lanes, others = export.symbolic_shape("lanes, others")
    some, more = (jax.ShapeDtypeStruct((n,), float) for n in (lanes, others))

    def rebound(speed, angle=0.4):
        impact = Impact(speed=speed, angle=angle)
        return simulate(Block(aspect_ratio=2.0), Soil(), impact, accuracy="fast").e_n

    def over_both(speed, angle):
        return rebound(speed[:, None], angle)

    def gradient(speed):
        return jax.grad(lambda speed: jnp.sum(rebound(speed)))(speed)

    def forces(speed, times):
        impact = Impact(speed=speed)
        return simulate(Block(), Soil(), impact, save_at=times).history.normal_force

    angle, times = jnp.array([0.0, 0.5]), jnp.array([1e-3, 2e-3])
    for speed in (jnp.asarray(SPEED), jnp.linspace(5.0, 20.0, 11)):
        for function, given, kinds in [
            (rebound, (speed,), (some,)),
            (jax.vmap(rebound), (speed,), (some,)),
            (gradient, (speed,), (some,)),
            (jax.vmap(jax.grad(rebound)), (speed,), (some,)),
            (over_both, (speed, angle), (some, more)),
            (forces, (speed, times), (some, more)),
        ]:
            found = exported(function, *kinds).call(*given)
            np.testing.assert_array_equal(found, jax.jit(function)(*given))
    with pytest.raises(InputError, match=r"broadcast, but have shapes \(lanes,\), "):
        exported(rebound, some, more)
