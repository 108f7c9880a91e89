"""The second way to the numbers: diffrax takes the machine code's steps, other solvers
come to the same results, and a contact in closed form is met exactly."""

import dataclasses

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
import optimistix as optx
import pytest
from jaxtyping import Array, Float
from kelvin_voigt import (
    DAMPING,
    MASS,
    SPEED,
    STIFFNESS,
    KelvinVoigt,
    exact_deepest,
    exact_restitution,
)

from jaximpact import PRESETS, Block, Impact, Scene, Soil, simulate
from jaximpact.backend.simd import KernelSet, compile_kernel
from jaximpact.backend.xla_compilation import unfused_jit
from jaximpact.errors import InputError
from jaximpact.impact.events import TIME_LIMIT
from jaximpact.impact.problem import assemble, pose
from jaximpact.impact.results import ImpactSummary
from jaximpact.integrator.accumulators import start_fold
from jaximpact.integrator.batched import Lanes, end_lanes, start_lanes, step_lanes
from jaximpact.integrator.diffrax_solvers import usable_solver
from jaximpact.integrator.rosenbrock import ORDER, Rodas5P
from jaximpact.integrator.single import (
    TERMS,
    SolverState,
    advance,
    diffrax_arguments,
    end_of,
    integrate,
    step_size_controller,
)
from jaximpact.integrator.summarise import summarise, summarise_lanes
from jaximpact.laws import AbstractFlow, displacement_rates, overstress, safe_power
from jaximpact.parameters import parameter
from jaximpact.shapes import RectangularPrism

OBLIQUE = Impact(angle=0.5, orientation=0.3, angular_velocity=-5.0)
LONG = Block(aspect_ratio=2.0)


class SlowFlow(AbstractFlow):
    """Perzyna's flow with a power of the overstress."""

    gamma_v: Float[Array, ""] = parameter(8.7, "m/s", "[0, inf)", "fluidity")
    exponent: Float[Array, ""] = parameter(1.5, "-", "[1, 3]", "exponent")

    def __call__(self, load, hardening, foundation, *, branch=None):
        nucleus = overstress(load.size, hardening, branch=branch)
        rate = self.gamma_v * safe_power(nucleus, self.exponent)
        return displacement_rates(rate, load, 0.0, branch=branch)


SCENES = {
    "vertical, a law of one's own": Scene(Block(), Soil(flow=SlowFlow()), Impact()),
    "dashpots": Scene(LONG, Soil(eta_N=0.2), OBLIQUE),
    "flat faces": Scene(Block(shape=RectangularPrism()), Soil(), OBLIQUE),
}


def by_diffrax(scene):
    """Times of the steps that diffrax takes with the package's method, and the numbers
    to which they lead."""
    assembly, setting = assemble(scene), PRESETS["balanced"]

    def run(scene, tolerance, floor):
        problem, vector = pose(scene, assembly, tolerance, floor)
        solution = diffrax.diffeqsolve(
            **diffrax_arguments(problem, vector) | {"max_steps": 500},
            saveat=diffrax.SaveAt(t0=True, steps=True),
        )
        count = solution.stats["num_accepted_steps"]
        last = jax.tree.map(lambda rows: rows[count], solution.ys)
        end = end_of(problem, last, solution.ts[count], True, True, count, 0)
        return solution.ts, summarise(scene, problem, end)

    times, numbers = unfused_jit(run)(scene, setting.tolerance, setting.floor)
    return times[np.isfinite(times)], numbers


def machine_code_along(scene, times, solver=None):
    """Numbers of a scene in machine code that takes the steps between given times, with
    the package's method or a solver of diffrax."""
    assembly, setting = assemble(scene), PRESETS["balanced"]
    leaves = jax.tree.leaves(scene)

    def begin(inputs):
        scenes, tolerance, floor, widths = inputs
        lanes = start_lanes(assembly, scenes, tolerance[0], floor[0])
        return lanes, jnp.stack(widths)

    def step(state):
        lanes, widths = state
        after, _ = advance(lanes.problem, lanes.state, lanes.time, widths[0], solver)
        time = lanes.time + widths[0]
        widths = jnp.concatenate([widths[1:], jnp.zeros_like(widths[:1])])
        lanes = lanes._replace(state=after, time=time, accepted=lanes.accepted + 1)
        return (lanes, widths), widths[0] > 0.0

    def finish(inputs, state):
        lanes = state[0]
        return summarise_lanes(inputs[0], lanes._replace(event=lanes.time > 0.0))

    one = jax.ShapeDtypeStruct((1,), float)
    widths = list(np.diff(times))
    scenes = jax.tree.unflatten(assembly.structure, [one] * len(leaves))
    kernel = compile_kernel(
        begin, step, finish, (scenes, one, one, [one] * len(widths))
    )
    inputs = np.array([*leaves, setting.tolerance, setting.floor, *widths], float)
    results, _ = KernelSet([kernel]).compute(inputs[:, None], threads=1)
    return jax.tree.unflatten(kernel.structure, list(results[:, 0]))


def assert_equal(found, expected, tolerance, of_times=None):
    """Every number within a tolerance, by its own size or, where that is next to
    nothing, by that of its kind; times of peaks within one of their own."""
    energy = float(expected.energy.kinetic_in)
    scales = {
        "rotation": 1.0,
        "angular_velocity": SPEED,
        "max_moment": float(expected.max_normal_force),
        "max_tangential_force": float(expected.max_normal_force),
    }
    for field in dataclasses.fields(ImpactSummary):
        mine, theirs = getattr(found, field.name), getattr(expected, field.name)
        if field.name == "energy":
            np.testing.assert_allclose(mine, theirs, rtol=0.0, atol=tolerance * energy)
        elif field.name != "steps":
            size = np.maximum(np.abs(theirs), scales.get(field.name, 0.0))
            size = np.where(np.isnan(size), 1.0, size)
            is_time = of_times and field.name.startswith("time_of")
            allowed = (of_times if is_time else tolerance) * size
            np.testing.assert_allclose(
                mine, theirs, rtol=0.0, atol=allowed, err_msg=field.name
            )


@pytest.mark.xla
@pytest.mark.parametrize("name", SCENES)
def test_the_same_steps_lead_to_the_same_numbers(name):
    scene = SCENES[name]
    times, theirs = by_diffrax(scene)
    assert_equal(machine_code_along(scene, times), theirs, 1e-12)
    if name == "dashpots":
        # The method once more, in the form in which any solver is used
        assert_equal(machine_code_along(scene, times, Rodas5P()), theirs, 1e-12)
    # Left to itself the machine code chooses its own steps, which rounding may change:
    # to the tolerance of `balanced`. A peak is flat: its time is certain to the square
    # root of what its value is.
    assert_equal(simulate(scene), theirs, 1e-5, of_times=3e-3)


@pytest.mark.xla
def test_other_solvers_come_to_the_same_numbers():
    scene = Scene(Block(), Soil(), Impact())
    expected = simulate(scene, accuracy="reference")
    found = simulate(scene, accuracy="reference", engine=diffrax.Dopri8(), history=True)
    assert found.manifest()["engine"] == found.engine == "diffrax, Dopri8"
    assert expected.manifest()["engine"] == "machine code"
    # A hundred times the tolerance, 1e-8: errors of the steps add up; and its square
    # root for the times of peaks, which are flat.
    assert_equal(found, expected, 1e-6, of_times=1e-3)
    assert found.history.time[-1] == pytest.approx(float(found.duration), rel=1e-9)


def results_of(scene, **how):
    """Some results as a function of fluidity, speed and mass."""

    def results(parameters):
        gamma_v, speed, mass = parameters
        block = dataclasses.replace(scene.block, mass=mass)
        soil = dataclasses.replace(scene.soil, gamma_v=gamma_v)
        impact = dataclasses.replace(scene.impact, speed=speed)
        result = simulate(block, soil, impact, accuracy="reference", **how)
        peaks = result.max_moment, result.time_of_max_penetration
        return jnp.stack([result.e_n, result.duration, *peaks])

    return results


AT = jnp.array([8.7, 14.0, 500.0])


@pytest.mark.xla
def test_derivatives_are_those_of_the_machine_code():
    """By the mass too, on which the first step's width depends. Those without dashpots
    are compared by the tests of calibration."""
    scene = SCENES["dashpots"]
    mine = results_of(scene)
    columns, along = jax.jacfwd(mine)(AT), jax.jvp(mine, (AT,), (AT,))[1]
    back = jax.vjp(mine, AT)[1](jnp.ones(4))[0]
    # linear in both modes, to rounding
    np.testing.assert_allclose(along, columns @ AT, rtol=1e-12)
    np.testing.assert_allclose(back, columns.sum(axis=0), rtol=1e-12)
    theirs = jax.jacfwd(results_of(scene, engine="diffrax"))(AT)
    # Rounding may change the steps: the error of derivatives at `reference`.
    np.testing.assert_allclose(columns, theirs, rtol=1e-5)


def test_derivatives_through_an_explicit_solver_are_refused():
    results = results_of(Scene(Block(), Soil(), Impact()), engine=diffrax.Tsit5())
    with pytest.raises(InputError, match="explicit solver Tsit5"):
        jax.jacfwd(results)(AT)


class WithArray(diffrax.Tsit5):
    """A solver with a number that is an array."""

    number: Array = dataclasses.field(default_factory=lambda: jnp.ones(()))


WRONG = {
    "a name": ("difrax", "machine code, diffrax.*'difrax'.*mean 'diffrax'"),
    "nothing": (None, "None was given"),
    "a class": (diffrax.Kvaerno5, r"class Kvaerno5; need .* Kvaerno5\(\)"),
    "no errors": (diffrax.Euler(), "Euler, which estimates no errors"),
    "two terms": (diffrax.KenCarp4(), "KenCarp4, which is for equations of several"),
    "an array": (WithArray(), "WithArray with an array among its fields"),
}


@pytest.mark.parametrize("name", WRONG)
def test_engines_that_cannot_be_are_refused(name):
    engine, told = WRONG[name]
    with pytest.raises(InputError, match=told) as raised:
        simulate(Block(), Soil(), Impact(), engine=engine)
    assert "\n" not in str(raised.value)


# Known to 15 digits: e, and its derivatives by stiffness and damping
RESTITUTION = 0.751957448328637
SLOPES = (2.52891006754e-8, -1.01156402702e-5)
BY = jnp.array([STIFFNESS, DAMPING])
TIGHT = jnp.asarray(1e-13)


def test_the_closed_form():
    both = jax.jit(jax.value_and_grad(lambda by: exact_restitution(*by)))
    found, slopes = both(BY)
    assert found == pytest.approx(RESTITUTION, abs=1e-15)
    np.testing.assert_allclose(slopes, SLOPES, rtol=1e-11)


@pytest.mark.slow
def test_contact_in_closed_form_through_the_packages_steps_and_landing():
    def restitution(by):
        problem = KelvinVoigt(*by, TIGHT)
        end = integrate(problem, problem.start)
        return -end.vector[1] / SPEED, end

    slopes, end = unfused_jit(jax.jacfwd(restitution, has_aux=True))(BY)
    assert end.event
    assert -end.vector[1] / SPEED == pytest.approx(RESTITUTION, abs=1e-12)
    # Errors of steps are those of the value, some 1e-13, over the change that it makes.
    np.testing.assert_allclose(slopes, SLOPES, rtol=1e-10)


OF_SECOND_ORDER = {
    "wrapped": diffrax.HalfSolver(diffrax.Heun()),
    # Its interpolant is a straight line, which is not used.
    "without interpolant": diffrax.ReversibleHeun(),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", OF_SECOND_ORDER)
def test_what_is_gathered_over_the_steps_of_any_solver(kind):
    solver = usable_solver(OF_SECOND_ORDER[kind])
    problem = KelvinVoigt(*BY, jnp.asarray(1e-6))
    end = unfused_jit(lambda problem: integrate(problem, problem.start, solver))(
        problem
    )
    deepest, when = exact_deepest(*BY)
    # A hundred times the tolerance: errors of the steps add up.
    assert float(-end.vector[1] / SPEED) == pytest.approx(RESTITUTION, rel=1e-4)
    assert float(end.fold.peaks.penetration) == pytest.approx(deepest, rel=1e-4)
    assert float(end.fold.peak_times.penetration) == pytest.approx(when, rel=1e-4)


@pytest.mark.slow
def test_too_many_steps_are_a_failure():
    problem = KelvinVoigt(*BY, TIGHT, max_steps=20)
    solve = unfused_jit(lambda problem: integrate(problem, problem.start, Rodas5P()))
    end = solve(problem)
    assert end.steps + end.rejected == 20
    assert not end.event
    assert not end.finished


def test_contact_in_closed_form_in_machine_code():
    def begin(inputs):
        def lane(stiffness, damping):
            problem = KelvinVoigt(stiffness, damping, TIGHT)
            start = problem.start
            state = SolverState(start, start_fold(problem, start))
            zero = jnp.zeros_like(stiffness)
            until, control = step_size_controller().init(
                TERMS, zero, TIME_LIMIT, state, None, problem, None, ORDER
            )
            none = jnp.zeros((), int)
            return Lanes(problem, state, zero, until, control, zero > 0.0, none, none)

        return jax.vmap(lane, out_axes=-1)(*inputs)

    def step(lanes):
        lanes = step_lanes(lanes)
        return lanes, lanes.going

    one = jax.ShapeDtypeStruct((1,), float)
    kernel = compile_kernel(
        begin, step, lambda inputs, lanes: end_lanes(lanes).vector[:, 1], [one, one]
    )
    stiffness = np.geomspace(1e6, 1e8, 20)
    damping = np.full(20, DAMPING)
    inputs = np.stack([stiffness, damping])
    (speeds,), _ = KernelSet([kernel]).compute(inputs, threads=1)
    np.testing.assert_allclose(
        -speeds / SPEED, exact_restitution(stiffness, damping), atol=1e-12
    )


@pytest.mark.slow
def test_contact_in_closed_form_through_diffrax_in_reverse():
    def restitution(by):
        stiffness, damping = by

        def rates(t, y, args):
            return jnp.stack([y[1], -(stiffness * y[0] + damping * y[1]) / MASS])

        solution = diffrax.diffeqsolve(
            diffrax.ODETerm(rates),
            Rodas5P(),
            0.0,
            1.0,
            None,
            jnp.array([0.0, SPEED]),
            stepsize_controller=diffrax.PIDController(rtol=1e-13, atol=1e-15),
            event=diffrax.Event(
                lambda t, y, args, **kwargs: (
                    (stiffness * y[0] / damping + y[1]) / SPEED
                ),
                optx.Newton(1e-13, 1e-13),
                direction=False,
            ),
            max_steps=4096,
        )
        return -solution.ys[0, 1] / SPEED

    found, slopes = unfused_jit(jax.value_and_grad(restitution))(BY)
    assert found == pytest.approx(RESTITUTION, abs=1e-12)
    np.testing.assert_allclose(slopes, SLOPES, rtol=1e-8)
