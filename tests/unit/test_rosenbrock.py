"""Rodas5P: order, stability, exact derivatives of the discrete step, linear algebra."""

from typing import NamedTuple

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from jaximpact import PRESETS, Accuracy, Block, Impact, Scene, Soil
from jaximpact.backend.xla_compilation import unfused_jit
from jaximpact.impact.dynamics import Motion
from jaximpact.impact.problem import Assembly, jacobian_pattern, pose
from jaximpact.impact.reduced_models import PLANAR
from jaximpact.integrator.error_control import ErrorControl
from jaximpact.integrator.rosenbrock import (
    ORDER,
    DenseOutput,
    dense_output,
    factorise,
    rodas5p_step,
    substitute,
)
from jaximpact.integrator.single import diffrax_arguments

FULL = np.ones((2, 2), bool)
START = np.array([1.2, 0.4])


def pendulum(y):
    """Smooth, nonlinear, autonomous."""
    return [y[1], -jnp.sin(y[0]) - 0.3 * y[1] * y[0] ** 2]


def pendulum_at(time):
    """The pendulum's state, to 1e-13 or so."""
    return solve_ivp(
        lambda t, y: [y[1], -np.sin(y[0]) - 0.3 * y[1] * y[0] ** 2],
        (0.0, time),
        START,
        method="DOP853",
        rtol=1e-13,
        atol=1e-15,
    ).y[:, -1]


def one_step(width, y0=START):
    """State, error estimate and dense output at mid-step, of one step."""
    y1, error, dense = dense_step(width, y0)
    return y1, error, dense.evaluate(0.5 * width)


def dense_step(width, y0=START):
    """State, error estimate and dense output of one step."""
    y0 = jnp.asarray(y0)
    y1, error, stages = rodas5p_step(pendulum, y0, width, FULL)
    dense = DenseOutput(
        t0=jnp.zeros_like(width), t1=width, **dense_output(y0, y1, stages)
    )
    return y1, error, dense


def observed_order(widths, errors):
    """Slope of log error over log width."""
    return np.polyfit(np.log(widths), np.log(errors), 1)[0]


def test_global_error_is_of_order_five():
    time, counts = 2.0, np.array([32, 48, 64, 96, 128])

    @jax.jit
    def integrate(count):
        def step(_, y):
            return rodas5p_step(pendulum, y, time / count, FULL)[0]

        return jax.lax.fori_loop(0, count, step, jnp.asarray(START))

    exact = pendulum_at(time)
    errors = [np.abs(integrate(count) - exact).max() for count in counts]
    # The errors, 1e-9 to 1e-12, lie above rounding; the next order's share, larger in
    # the widest steps, bends the line by less than 0.2.
    assert observed_order(time / counts, errors) == pytest.approx(5.0, abs=0.2)


# Error committed in one step of a method of order p is of order p + 1. Steps of 0.02 to
# 0.15 keep it above rounding, and the next order's share under 0.25.
LOCAL_WIDTHS = np.array([0.15, 0.1, 0.07, 0.05, 0.03])


COMPILED = jax.jit(one_step)


def local_errors(of_step):
    return [np.abs(of_step(*COMPILED(width), width)).max() for width in LOCAL_WIDTHS]


OF_ORDER_FOUR = {
    "dense output": lambda y1, error, middle, h: middle - pendulum_at(0.5 * h),
    "embedded method": lambda y1, error, middle, h: y1 - error - pendulum_at(h),
}


@pytest.mark.parametrize("name", OF_ORDER_FOUR)
def test_what_is_of_order_four(name):
    errors = local_errors(OF_ORDER_FOUR[name])
    assert observed_order(LOCAL_WIDTHS, errors) == pytest.approx(5.0, abs=0.25)


@pytest.mark.parametrize("width", [1e-6, 1e-12, 1e-18])
def test_rates_keep_their_digits_in_a_tiny_step(width):
    _, _, dense = dense_step(jnp.asarray(width))
    rates = jnp.stack(pendulum(jnp.asarray(START)))
    # They change by the width over the step. Weights of up to 100, which cancel, leave
    # a hundred roundings; a difference of states would leave no digit at 1e-18.
    allowed = 2.0 * width + 1e-13
    for found in (dense.rate(0.5), dense.rate_at_end()):
        np.testing.assert_allclose(found, rates, rtol=0.0, atol=allowed)


def test_error_estimate_exceeds_the_error_of_the_step():
    # The estimate is the embedded method's error, one order larger than the step's.
    ratios = local_errors(
        lambda y1, error, middle, h: (
            np.abs(y1 - pendulum_at(h)).max() / np.abs(error).max()
        )
    )
    assert max(ratios) < 0.1
    assert ratios[-1] < ratios[0]


def amplification(z):
    """R(z) of y' = z y over a step of 1."""
    one = np.ones((1, 1), bool)
    return rodas5p_step(lambda y: [z * y[0]], jnp.ones(1), 1.0, one)[0][0]


def test_l_stable():
    z = -np.logspace(4, 8, 5)
    values = np.abs(jax.vmap(amplification)(z))
    # R vanishes at infinity as C/z: what a merely A-stable method would not do.
    assert values[2] < 1e-4  # at -1e6
    assert values[4] < 1e-6  # at -1e8
    np.testing.assert_allclose(values[2:] * -z[2:], 12.5, rtol=0.01)


def test_stable_along_the_imaginary_axis():
    def radius(frequency):
        def rotation(y):
            return [-frequency * y[1], frequency * y[0]]

        return jnp.linalg.norm(
            rodas5p_step(rotation, jnp.asarray([1.0, 0.0]), 1.0, FULL)[0]
        )

    assert np.max(jax.vmap(radius)(np.logspace(-2, 6, 200))) <= 1.0 + 1e-12


def test_stiffly_accurate_on_prothero_robinson():
    rate = 1e6

    def problem(y):
        slow = y[1] + 1.0
        return [-rate * (y[0] - jnp.sin(slow)) + jnp.cos(slow), jnp.ones_like(slow)]

    pattern = np.array([[True, True], [False, False]])

    @jax.jit
    def integrate(count):
        def step(_, y):
            return rodas5p_step(problem, y, 2.0 / count, pattern)[0]

        return jax.lax.fori_loop(0, count, step, jnp.asarray([np.sin(1.0), 0.0]))[0]

    counts = np.array([4, 8, 16])
    errors = [abs(integrate(count) - np.sin(3.0)) for count in counts]
    # Far less than the step's own truncation error, for the error at the stiff limit
    # goes down with the rate; and no reduction below order 3.
    assert max(errors) < 1e-9
    assert observed_order(2.0 / counts, errors) > 3.0


@pytest.mark.slow
def test_step_of_no_width_leaves_the_state_and_has_finite_gradients():
    def of_step(y0, width):
        return one_step(width, y0)

    start = jnp.asarray(START), jnp.zeros(())
    state, _, middle = COMPILED(start[1])
    np.testing.assert_array_equal(state, START)
    np.testing.assert_array_equal(middle, START)
    by_state, (by_width, error, of_middle) = (
        jax.jit(jax.jacfwd(of_step, argnums=place))(*start) for place in (0, 1)
    )
    np.testing.assert_allclose(by_state[0], np.eye(2), atol=1e-15)
    # The derivative by the width is the right-hand side; rounding of 40-fold weights.
    rate = np.stack(pendulum(START))
    np.testing.assert_allclose(by_width, rate, rtol=1e-12)
    np.testing.assert_allclose(error, 0.0, atol=1e-13)
    assert np.all(np.isfinite(of_middle))


def test_derivative_of_a_step_is_that_of_its_arithmetic():
    def state_after(y0, width):
        return rodas5p_step(pendulum, y0, width, FULL)[0]

    direction = (jnp.asarray([0.3, -0.7]), jnp.asarray(0.2))
    point = (jnp.asarray(START), jnp.asarray(0.5))
    _, derivative = jax.jvp(state_after, point, direction)
    # Central differences: truncation 1e-5^2, rounding 1e-16 / 1e-5, so 1e-9 has room.
    delta = 1e-5
    above, below = (
        state_after(
            *(p + sign * delta * d for p, d in zip(point, direction, strict=True))
        )
        for sign in (1.0, -1.0)
    )
    differences = (above - below) / (2.0 * delta)
    np.testing.assert_allclose(derivative, differences, atol=1e-9)
    # The exact flow's derivative differs by the step's truncation error, which the test
    # can see: it is the arithmetic that is differentiated.
    assert state_after(*point) != pytest.approx(pendulum_at(0.5), abs=1e-8)


@pytest.mark.parametrize("seed", range(8))
def test_unrolled_elimination_solves_what_lapack_solves(seed):
    generator = np.random.default_rng(seed)
    size = int(generator.integers(2, 13))
    pattern = generator.random((size, size)) < generator.uniform(0.1, 0.9)
    np.fill_diagonal(pattern, True)
    matrix = np.where(pattern, generator.normal(size=(size, size)), 0.0)
    # A heavy diagonal, as I - h gamma J has: elimination does not pivot.
    np.fill_diagonal(matrix, size + generator.random(size))
    right = generator.normal(size=size)
    rows = [
        {j: jnp.asarray(matrix[i, j]) for j in range(size) if pattern[i, j]}
        for i in range(size)
    ]
    solution = np.stack(substitute(*factorise(rows), list(jnp.asarray(right))))
    # Condition numbers are below 100.
    np.testing.assert_allclose(solution, np.linalg.solve(matrix, right), atol=1e-13)


def test_elimination_fills_only_where_the_pattern_demands():
    # An arrow matrix whose point comes last stays as sparse as it was.
    rows = [{0: 2.0, 3: 1.0}, {1: 3.0, 3: 1.0}, {2: 4.0, 3: 1.0}]
    rows.append({0: 1.0, 1: 1.0, 2: 1.0, 3: 9.0})
    factors, _ = factorise(rows)
    assert [sorted(row) for row in factors] == [[0, 3], [1, 3], [2, 3], [0, 1, 2, 3]]


STRUCTURE_SCENES = {
    "inclined ellipsoid": Scene(
        Block(aspect_ratio=2.0), Soil(alpha_vR=1.0), Impact(angle=0.7, orientation=0.4)
    ),
    "spinning on a slope, sliding": Scene(
        Block(aspect_ratio=0.6, out_of_plane_ratio=1.3),
        Soil(alpha_s=0.3, alpha_vR=0.5, dilatancy=1.0),
        Impact(angle=-1.1, orientation=1.2, angular_velocity=40.0, slope=0.5),
    ),
}


@unfused_jit
def states_and_jacobians(scene: Scene):
    """Scaled Jacobians at the end of every step of an impact."""
    setting = Accuracy("", PRESETS["fast"].tolerance, PRESETS["fast"].floor)
    problem, vector = pose(
        scene,
        Assembly(jax.tree.structure(scene), PLANAR, False),
        setting.tolerance,
        setting.floor,
    )
    solution = diffrax.diffeqsolve(
        **diffrax_arguments(problem, vector), saveat=diffrax.SaveAt(steps=True)
    )
    vectors = solution.ys.vector[:200]

    def jacobian(vector):
        return jax.jacfwd(lambda y: jnp.stack(problem.rates(list(y))))(vector)

    return jax.vmap(jacobian)(vectors), solution.stats["num_accepted_steps"]


@pytest.mark.slow
def test_pattern_covers_the_jacobian_and_no_more():
    scene = STRUCTURE_SCENES["inclined ellipsoid"]
    assembly = Assembly(jax.tree.structure(scene), PLANAR, False)
    pattern = np.array(jacobian_pattern(pose(scene, assembly, 1e-6, 1e-2)[0]))
    assert len(pattern) == len(Motion._fields)
    reached = np.zeros_like(pattern)
    for scene in STRUCTURE_SCENES.values():
        jacobians, count = states_and_jacobians(scene)
        jacobians = np.asarray(jacobians)[: int(count)]
        assert len(jacobians) > 20
        assert np.all(jacobians[:, ~pattern] == 0.0)
        reached |= np.any(jacobians != 0.0, axis=0)
    np.testing.assert_array_equal(reached, pattern)


# --- widths of steps from their errors


class Errors(NamedTuple):
    """Errors of unknowns in units of what is allowed."""

    vector: jax.Array


def after_step(error, error_before=1.0, width=2.0):
    """Whether the step from 3 is kept, begin and width of the next, and the error to
    remember."""
    keep, begin, end, _, remembered, _ = ErrorControl().adapt_step_size(
        *(jnp.asarray(3.0), jnp.asarray(3.0 + width), None, None, None),
        Errors(jnp.asarray([error, -error])),
        ORDER,
        jnp.asarray(error_before),
    )
    return bool(keep), float(begin), float(end - begin), float(remembered)


@pytest.mark.parametrize("error", [0.01, 0.3, 0.999])
def test_the_next_width_follows_from_two_errors(error):
    keep, begin, width, remembered = after_step(error, 0.5)
    assert (keep, begin) == (True, 5.0)
    expected = 0.85 * error**-0.2 * 0.5**0.04
    np.testing.assert_allclose(width, 2.0 * expected, rtol=1e-14)
    np.testing.assert_allclose(remembered, error, rtol=1e-15)


def test_a_step_that_is_almost_too_long_is_kept_and_the_next_one_is_shorter():
    keep, _, width, _ = after_step(0.9)
    assert keep
    assert width < 2.0


@pytest.mark.parametrize("error", [1.0, 1.2, 1e6])
def test_a_step_that_is_too_long_is_taken_again_shorter(error):
    keep, begin, width, remembered = after_step(error, 1e-4)
    assert (keep, begin, remembered) == (False, 3.0, 1e-4)
    rounding = 1e-12
    assert 0.2 * 2.0 - rounding < width < 0.85 * 2.0 + rounding


def test_a_width_grows_tenfold_at_most():
    keep, _, width, remembered = after_step(0.0)
    assert keep
    # 0.85 of the factor that the least error counted allows
    np.testing.assert_allclose(width, 2.0 * 8.5, rtol=1e-12)
    assert remembered > 0.0
