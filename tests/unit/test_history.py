"""Histories: forces and motion at times, from the steps of the integration and from
between them."""

import dataclasses

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import simpson

from jaximpact import Block, Impact, Scene, Soil, simulate
from jaximpact.backend import kernel_choice
from jaximpact.backend.xla_compilation import unfused_jit
from jaximpact.errors import InputError
from jaximpact.impact.problem import assemble, pose
from jaximpact.impact.results import empty_history
from jaximpact.integrator.rosenbrock import Rodas5P
from jaximpact.scene import GRAVITY

BALANCED = 1e-4
"""Relative error of a force that "balanced" may have between two steps."""
PLANAR = Scene(
    Block(aspect_ratio=1.7, mass=900.0),
    Soil(),
    Impact(speed=11.0, angle=0.4, orientation=0.3, slope=0.2),
)
VERTICAL = Scene(Block(mass=900.0), Soil(), Impact(speed=11.0))
TIMES = np.linspace(-0.002, 0.06, 32)
"""From before the contact to after its end."""


@pytest.fixture(scope="module")
def steps():
    return simulate(PLANAR, history=True)


def with_soil(k_E, gamma_v) -> Scene:
    soil = dataclasses.replace(VERTICAL.soil, k_E=k_E, gamma_v=gamma_v)
    return Scene(VERTICAL.block, soil, VERTICAL.impact)


def of_speeds(speed, times=TIMES):
    impact = dataclasses.replace(PLANAR.impact, speed=speed)
    scene = Scene(PLANAR.block, PLANAR.soil, impact)
    return simulate(scene, save_at=times, ledger=False).history


def test_histories_and_ledgers_show_values_with_units_and_meanings(steps):
    energy, history = steps.energy, steps.history
    value = f"{float(energy.kinetic_in):.6g} J"
    assert f"kinetic_in={value}" in repr(energy)
    assert f"kinetic_in    {value}" in str(energy)
    assert f"{value}</td>" in energy._repr_html_()
    lines = str(history).splitlines()
    assert lines[0] == f"History: {len(history.time)} times"
    assert any("normal_force" in x and x.endswith("normal force, N") for x in lines)
    assert "normal force, N" in history._repr_html_()


@pytest.mark.slow
def test_history_of_steps_and_at_their_times_are_the_same(steps):
    """To the last bit, as are the numbers, whichever code gives them."""
    again = simulate(PLANAR, save_at=steps.history.time)
    assert again.history.in_contact.all()
    for name, series in steps.history._asdict().items():
        if name != "in_contact":
            np.testing.assert_array_equal(series, getattr(again.history, name), name)
    plain = simulate(PLANAR)
    for one, other in ((steps, plain), (again, plain)):
        numbers = (dataclasses.replace(r, history=None) for r in (one, other))
        jax.tree.map(np.testing.assert_array_equal, *numbers)


def test_peaks_lie_where_the_numbers_say(steps):
    """A peak is that of a cubic through both ends of its step; the state there is that
    of another interpolant."""
    quantities = ("normal_force", "tangential_force", "moment", "penetration")
    times = [getattr(steps, f"time_of_max_{name}") for name in quantities]
    history = simulate(PLANAR, save_at=times).history
    for place, name in enumerate(quantities):
        assert abs(getattr(history, name)[place]) == pytest.approx(
            float(getattr(steps, f"max_{name}")), rel=BALANCED
        )


def test_impulse_and_energies_at_any_time():
    """Momentum and energy are balanced between the steps too. The tangential force has
    kinks, by which Simpson's rule misses some 1e-7."""
    duration = float(simulate(PLANAR, accuracy="reference").duration)
    times = np.linspace(0.0, duration * (1.0 - 1e-9), 4001)
    h = simulate(PLANAR, accuracy="reference", save_at=times).history
    slope, mass = float(PLANAR.impact.slope), float(PLANAR.block.mass)
    for force, velocity, gravity in (
        (h.normal_force, h.normal_velocity, GRAVITY * np.cos(slope)),
        (h.tangential_force, h.tangential_velocity, GRAVITY * np.sin(slope)),
    ):
        momentum = mass * (velocity[0] - velocity[-1] + gravity * times[-1])
        assert simpson(force, x=times) == pytest.approx(float(momentum), rel=1e-6)
    left = h.kinetic + h.elastic + h.viscoplastic + h.slider + h.dashpot
    given = h.kinetic[0] + h.gravity + h.arm + h.stiffness
    np.testing.assert_allclose(left, given, rtol=0.0, atol=1e-9 * h.kinetic[0])


def test_steps_go_from_the_touch_to_the_end(steps):
    history = steps.history
    assert history.time[0] == 0.0
    assert np.all(np.diff(history.time) > 0)
    for name in ("duration", "normal_velocity"):
        series = "time" if name == "duration" else name
        last = getattr(history, series)[-1]
        assert last == pytest.approx(float(getattr(steps, name)), rel=1e-6)
    for name in ("viscoplastic", "slider", "dashpot"):
        assert np.all(np.diff(getattr(history, name)) >= -1e-9)


def test_outside_of_the_contact_there_is_no_force(steps):
    end = float(steps.duration)
    h = simulate(
        PLANAR, save_at=[2.0 * end, -1e-9, 0.3 * end, 0.5 * end, np.inf]
    ).history
    assert h.in_contact.tolist() == [False, False, True, True, False]
    for force in (h.normal_force, h.tangential_force, h.moment):
        np.testing.assert_array_equal(force == 0.0, ~h.in_contact)
    np.testing.assert_array_equal(np.isnan(h.penetration), ~h.in_contact)
    assert h.time[3] == 0.5 * end


def test_a_time_that_is_the_duration_to_rounding_is_the_end():
    """The duration is the time of the last step with a correction, of either sign."""
    speed = np.linspace(3.0, 20.0, 50)

    impact = dataclasses.replace(PLANAR.impact, speed=speed)

    def at(times):
        scene = Scene(PLANAR.block, PLANAR.soil, impact)
        return simulate(scene, save_at=times, ledger=True)

    end = np.asarray(at([0.0]).duration)[:, None]
    result = at(end * (1.0 + np.array([-4.0, 0.0, 4.0, 1e10]) * 2.0**-52))
    history = result.history
    assert history.in_contact[:, :3].all()
    assert not history.in_contact[:, 3].any()
    for name in ("rotation", "normal_velocity", "angular_velocity"):
        for place in range(3):
            series = getattr(history, name)[:, place]
            np.testing.assert_allclose(series, getattr(result, name), rtol=1e-6)
    for name in ("kinetic", "viscoplastic", "arm"):
        assert np.isfinite(getattr(history, name)[:, :3]).all()


@pytest.mark.slow
def test_forces_after_other_ends():
    """A block that topples goes on pressing, and how is not known; one that separates
    never does."""
    impact = Impact(
        speed=np.array([14.0, 14.0, 1.0]),
        angle=np.array([0.0, 0.7, 1.39]),
        orientation=np.array([0.0, 0.0, np.pi / 4.0]),
        angular_velocity=np.array([0.0, 0.0, 349.0]),
    )
    # Ground that carries so much moment that the block topples under load
    scene = Scene(Block(aspect_ratio=3.0), Soil(psi=2.0), impact)
    result = simulate(scene, save_at=[-1.0, 0.0, 2.0], ledger=False)
    assert list(result.outcome) == ["detached", "toppled", "separating"]
    unknown = np.isnan(result.history.moment)
    np.testing.assert_array_equal(unknown[1], [False, False, True])
    assert not unknown[[0, 2]].any()
    np.testing.assert_array_equal(result.history.in_contact[:, 1], [True, True, False])


@pytest.mark.slow
def test_batch_is_one_by_one():
    """Lanes of different durations, by threads, in jit and vmap: to the last bit."""
    speed = np.linspace(3.0, 20.0, 19)
    together = of_speeds(speed)
    assert together.time.shape == together.in_contact.shape == (19, len(TIMES))
    counts = together.in_contact.sum(axis=-1)
    assert 0 < counts.min() < counts.max() < len(TIMES)
    one_by_one = [of_speeds(v) for v in speed]
    stacked = jax.tree.map(lambda *x: np.stack(x), *one_by_one)
    compiled = jax.jit(jax.vmap(of_speeds))(speed)
    for found in (together, compiled):
        jax.tree.map(np.testing.assert_array_equal, found, stacked)
    # Times of their own, not in order, traced, and on a further axis
    mixed = np.random.default_rng(5).permutation(np.stack([TIMES, TIMES + 1e-3]).T).T
    own = jax.jit(jax.vmap(of_speeds, (None, 0)))(speed[3], mixed).normal_force
    broadcast = of_speeds(speed[3], mixed).normal_force
    np.testing.assert_array_equal(own, broadcast)
    order = np.argsort(mixed[0])
    np.testing.assert_array_equal(broadcast[0][order], stacked.normal_force[3])
    at_none = lambda v: of_speeds(v, np.zeros(0)).moment  # noqa: E731
    assert at_none(speed).shape == (19, 0)
    assert jax.jvp(at_none, (14.0,), (1.0,))[1].shape == (0,)


def force(k_E, gamma_v, delay):
    times = jnp.asarray(TIMES) - delay
    result = simulate(
        with_soil(k_E, gamma_v), accuracy="reference", save_at=times, ledger=False
    )
    return result.history.normal_force


@pytest.mark.slow
def test_derivatives_of_a_misfit():
    """By two parameters and by the moment of touch, which a measured curve does not
    tell, in both modes, against central differences at "reference". Their error is
    that of the step, 1e-3 of the parameter, squared, and that of the values, some
    1e-8, by 1e-3."""
    parameters = tuple(float(getattr(VERTICAL.soil, n)) for n in ("k_E", "gamma_v"))
    at = *parameters, 1e-4
    wanted = force(1.2 * at[0], 0.9 * at[1], 0.0)
    scale = float(jnp.max(wanted))

    def misfit(k_E, gamma_v, delay):
        return jnp.sum(((force(k_E, gamma_v, delay) - wanted) / scale) ** 2)

    by_all = (0, 1, 2)
    value, gradient = jax.jit(jax.value_and_grad(misfit, by_all))(*at)
    forward = jax.jacfwd(misfit, by_all)(*at)
    assert np.isfinite(value)
    np.testing.assert_allclose(forward, gradient, rtol=1e-10)
    for place, derivative in enumerate(gradient):
        width = 1e-3 * at[place]
        sides = [
            float(misfit(*at[:place], at[place] + sign * width, *at[place + 1 :]))
            for sign in (1.0, -1.0)
        ]
        expected = (sides[0] - sides[1]) / (2.0 * width)
        assert float(derivative) == pytest.approx(expected, rel=1e-4)


def test_dataset_has_units_and_one_time_base():
    speed = np.array([[9.0], [11.0]])
    dataset = of_speeds(speed, TIMES).to_xarray(("speed", "one"))
    assert dataset.normal_force.dims == ("speed", "one", "time")
    assert dataset.normal_force.attrs["units"] == "N"
    assert all("long_name" in variable.attrs for variable in dataset.variables.values())
    np.testing.assert_array_equal(dataset.time, TIMES)
    assert set(of_speeds(11.0).to_xarray().sizes) == {"time"}
    own_times = of_speeds(11.0, np.stack([TIMES, 2.0 * TIMES]))
    with pytest.raises(ValueError, match="one time base"):
        own_times.to_xarray()
    with pytest.raises(ValueError, match="dims must be 2 names"):
        of_speeds(speed, TIMES).to_xarray(("speed",))
    for name in ("time", "penetration"):
        with pytest.raises(InputError, match=f"{name} cannot be the name of a dimen"):
            of_speeds(speed, TIMES).to_xarray(("speed", name))
    none = jax.tree.map(lambda _: np.zeros((0, 5)), empty_history(ledger=False))
    with pytest.raises(InputError, match=r"at least one impact, .* shape \(0,\)"):
        none.to_xarray()


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"save_at": [0.1, np.nan]}, "time 1 is NaN"),
        ({"save_at": 0.1}, "must be a series of times"),
        ({"save_at": np.zeros((3, 4)), "speed": np.ones(2)}, "broadcast"),
        ({"save_at": [0.1], "history": True}, "not both"),
        ({"save_at": [0.1], "engine": "diffrax"}, "engine diffrax"),
        ({"history": True, "speed": np.ones(2)}, "save_at=times"),
    ],
)
def test_refusals(how, said):
    impact = Impact(speed=how.pop("speed", 11.0))
    with pytest.raises(ValueError, match=said):
        simulate(Scene(Block(), Soil(), impact), **how)


@pytest.mark.xla
def test_as_diffrax_interpolates_the_same_steps():
    """The equations as diffrax integrates them over the same steps, without the
    package's control of steps, its events and its branches."""
    result = simulate(VERTICAL, history=True, accuracy="reference")
    steps = result.history.time
    times = np.linspace(0.0, steps[-1], 50)[:-1]
    problem, vector = pose(VERTICAL, assemble(VERTICAL), 1e-5, 1e-5)

    @unfused_jit
    def course(vector):
        return diffrax.diffeqsolve(
            diffrax.ODETerm(lambda t, y, _: jnp.stack(problem.rates(list(y)))),
            Rodas5P(),
            *(0.0, steps[-1], None, vector),
            stepsize_controller=diffrax.StepTo(ts=jnp.asarray(steps)),
            saveat=diffrax.SaveAt(ts=jnp.asarray(times)),
            max_steps=len(steps),
        ).ys

    history = simulate(VERTICAL, save_at=times, accuracy="reference").history
    expected = course(vector)
    for column, name in enumerate(problem.model.unknowns):
        if name in ("penetration", "normal_velocity", "hardening"):
            series = expected[:, column]
            # Where the laws switch, a step of diffrax's may start on the other side.
            np.testing.assert_allclose(
                getattr(history, name), series, rtol=1e-8, atol=1e-8 * abs(series).max()
            )


@pytest.mark.xla
def test_xla_samples_the_same(monkeypatch):
    """Where there is no machine code. Steps differ by roundings, which the control of
    steps makes larger, so that forces differ by the error of the steps."""

    def result(times):
        return simulate(VERTICAL, save_at=times, accuracy="fast")

    native = result(TIMES)
    monkeypatch.setattr(kernel_choice, "computes_on_cpu", lambda: False)
    found = result(TIMES)
    forces = (of.history.normal_force / of.max_normal_force for of in (found, native))
    np.testing.assert_allclose(*forces, rtol=0.0, atol=1e-6)
    at_end = result(np.full_like(TIMES, float(found.duration) * (1.0 + 1e-12)))
    assert at_end.history.in_contact.all()
