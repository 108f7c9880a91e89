"""Rodas5P: order, stability, exact derivatives of the discrete step, linear algebra."""

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from jaximpact import PRESETS, Accuracy, Block, Impact, Scene, Soil
from jaximpact.backend.xla_compilation import unfused_jit
from jaximpact.impact.dynamics import Motion
from jaximpact.impact.problem import Assembly, Problem, jacobian_pattern, pose
from jaximpact.impact.reduced_models import MODELS, PLANAR
from jaximpact.integrator.rosenbrock import (
    DenseOutput,
    Rodas5P,
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


def one_step(width):
    """State, error estimate and dense output at mid-step, of one step."""
    y0 = jnp.asarray(START)
    y1, error, stages = rodas5p_step(pendulum, y0, width, FULL)
    dense = DenseOutput(
        t0=jnp.zeros_like(width), t1=width, **dense_output(y0, y1, stages)
    )
    return y1, error, dense.evaluate(0.5 * width)


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


def local_errors(of_step):
    one = jax.jit(one_step)
    return [np.abs(of_step(*one(width), width)).max() for width in LOCAL_WIDTHS]


def test_dense_output_is_of_order_four_at_mid_step():
    errors = local_errors(lambda y1, error, middle, h: middle - pendulum_at(0.5 * h))
    assert observed_order(LOCAL_WIDTHS, errors) == pytest.approx(5.0, abs=0.25)


def test_embedded_method_is_of_order_four():
    errors = local_errors(lambda y1, error, middle, h: y1 - error - pendulum_at(h))
    assert observed_order(LOCAL_WIDTHS, errors) == pytest.approx(5.0, abs=0.25)


def test_error_estimate_exceeds_the_error_of_the_step():
    # The estimate is the embedded method's error, one order larger than the step's.
    ratios = local_errors(
        lambda y1, error, middle, h: (
            np.abs(y1 - pendulum_at(h)).max() / np.abs(error).max()
        )
    )
    assert max(ratios) < 0.1
    assert ratios[-1] < ratios[0]


def test_dense_output_meets_both_ends():
    y1, _, stages = rodas5p_step(pendulum, jnp.asarray(START), 0.1, FULL)
    step = DenseOutput(
        t0=jnp.asarray(3.0),
        t1=jnp.asarray(3.1),
        **dense_output(jnp.asarray(START), y1, stages),
    )
    # Rounding of the position within the step.
    np.testing.assert_allclose(step.evaluate(3.0), START, rtol=1e-14)
    np.testing.assert_allclose(step.evaluate(3.1), y1, rtol=1e-13)
    np.testing.assert_allclose(step.evaluate(3.0, 3.1), y1 - START, atol=1e-13)


def amplification(z):
    """R(z) of y' = z y over a step of 1."""
    one = np.ones((1, 1), bool)
    return rodas5p_step(lambda y: [z * y[0]], jnp.ones(1), 1.0, one)[0][0]


def test_amplification_is_the_exponential_near_zero():
    z = np.array([-0.2, -0.1, -0.05])
    errors = np.abs(jax.vmap(amplification)(z) - np.exp(z))
    # z^6 over 6!, times the method's error constant, which is below one.
    assert np.all(errors < np.abs(z) ** 6 / 720.0)


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


def van_der_pol(t, y, args):
    return jnp.stack([y[1], args * (1.0 - y[0] ** 2) * y[1] - y[0]])


@pytest.mark.slow
@pytest.mark.parametrize("pattern", [None, ((False, True), (True, True))])
def test_solves_van_der_pol_inside_diffrax(pattern):
    stiffness = 100.0
    solution = diffrax.diffeqsolve(
        diffrax.ODETerm(van_der_pol),
        Rodas5P(pattern),
        t0=0.0,
        t1=150.0,
        dt0=1e-4,
        y0=jnp.asarray([2.0, 0.0]),
        args=stiffness,
        stepsize_controller=diffrax.PIDController(rtol=1e-8, atol=1e-8),
        saveat=diffrax.SaveAt(ts=jnp.asarray([50.0, 81.0, 120.0, 150.0])),
        max_steps=4000,
    )
    reference = solve_ivp(
        lambda t, y: [y[1], stiffness * (1.0 - y[0] ** 2) * y[1] - y[0]],
        (0.0, 150.0),
        [2.0, 0.0],
        method="Radau",
        rtol=1e-10,
        atol=1e-12,
        t_eval=[50.0, 81.0, 120.0, 150.0],
    )
    # One jump lies between; its time carries the solvers' tolerances.
    np.testing.assert_allclose(solution.ys, reference.y.T, rtol=1e-5, atol=1e-7)
    # An explicit method's steps are bound by 1 / stiffness: tens of thousands.
    assert solution.stats["num_steps"] < 2000


@pytest.mark.slow
def test_step_of_no_width_leaves_the_state_and_has_finite_gradients():
    def state_after(y0, width):
        return rodas5p_step(pendulum, y0, width, FULL)[0]

    np.testing.assert_array_equal(state_after(jnp.asarray(START), 0.0), START)
    by_state, by_width = jax.jacfwd(state_after, argnums=(0, 1))(
        jnp.asarray(START), 0.0
    )
    np.testing.assert_allclose(by_state, np.eye(2), atol=1e-15)
    # The derivative by the width is the right-hand side; rounding of 40-fold weights.
    rate = np.stack(pendulum(START))
    np.testing.assert_allclose(by_width, rate, rtol=1e-12)
    error = jax.jacfwd(lambda width: rodas5p_step(pendulum, START, width, FULL)[1])(0.0)
    np.testing.assert_allclose(error, 0.0, atol=1e-13)


def test_dense_output_of_no_width_is_finite_with_its_gradient():
    value, slope = jax.jvp(lambda h: one_step(h)[2], (jnp.zeros(()),), (jnp.ones(()),))
    np.testing.assert_array_equal(value, START)
    assert np.all(np.isfinite(slope))


def test_finished_lanes_do_not_disturb_the_others():
    states = jnp.stack([START, START, 2.0 * START], axis=1)
    widths = jnp.asarray([0.0, 0.2, 0.1])
    together = rodas5p_step(pendulum, states, widths, FULL)[0]
    for lane in range(3):
        alone = rodas5p_step(pendulum, states[:, lane], widths[lane], FULL)[0]
        # Sums of eight terms may be ordered otherwise.
        np.testing.assert_allclose(together[:, lane], alone, rtol=1e-13)


def test_derivative_of_a_step_is_that_of_its_arithmetic():
    def state_after(y0, width):
        return rodas5p_step(pendulum, y0, width, FULL)[0]

    direction = (jnp.asarray([0.3, -0.7]), jnp.asarray(0.2))
    point = (jnp.asarray(START), jnp.asarray(0.5))
    _, derivative = jax.jvp(state_after, point, direction)
    # Central differences: truncation 1e-5^2, rounding 1e-16 / 1e-5, so 1e-9 has room.
    delta = 1e-5
    ends = [
        state_after(
            *(p + sign * delta * d for p, d in zip(point, direction, strict=True))
        )
        for sign in (1.0, -1.0)
    ]
    differences = (ends[0] - ends[1]) / (2.0 * delta)
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


def test_problem_is_posed_with_the_pattern_s_size():
    for model in MODELS:
        setting = PRESETS["fast"]
        scene = STRUCTURE_SCENES["inclined ellipsoid"]
        assembly = Assembly(jax.tree.structure(scene), model, False)
        problem, vector = pose(scene, assembly, setting.tolerance, setting.floor)
        assert isinstance(problem, Problem)
        assert np.shape(jacobian_pattern(problem)) == (vector.size, vector.size)
