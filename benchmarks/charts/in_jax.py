"""What the operation of JAX costs beside what it computes: in `jit`, `vmap` and `grad`,
and of one impact."""

import dataclasses
import functools
import time
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from matplotlib.figure import Figure

from jaximpact.accuracy import PRESETS
from jaximpact.backend.native_backend import compile_native
from jaximpact.backend.simd import KernelSet
from jaximpact.batch import simulate_batch
from jaximpact.impact.problem import Assembly
from jaximpact.impact.reduced_models import PLANAR
from jaximpact.plotting.style import BLUE, GREY, in_style, panels
from jaximpact.scene import Block, Impact, Scene, Soil
from jaximpact.simulation import simulate

from ..impacts import PARAMETERS, mixed_scenes, shifted
from .section import Bench, Row, Section, Table, interleaved_minima
from .style import grouped

BATCH = "simulate_batch"
VALUES = "jit(vmap)"
GRADIENTS = "jit(grad(mean(vmap)))"
BY_ALL = "jit(grad(mean(vmap))) by the scenes"
STEPS = "machine code alone"
JITTED = "jit"
EAGER = "simulate"
EAGER_GRADIENT = "value_and_grad"


def _alone() -> Scene:
    """Make the single impact: three degrees of freedom, no dashpots."""
    return Scene(Block(aspect_ratio=2.0), Soil(), Impact(angle=0.5))


def _e_n(scene: Scene):
    return simulate(scene, ledger=False).e_n


def _e_n_of_parameters(*values):
    one = _alone()
    soil = dataclasses.replace(one.soil, **dict(zip(PARAMETERS, values, strict=True)))
    return _e_n(Scene(one.block, soil, one.impact))


def _mean(shift, scenes: Scene):
    return jnp.mean(jax.vmap(lambda scene: _e_n(shifted(scene, shift)))(scenes))


def _mean_of_scenes(scenes: Scene):
    return jnp.mean(jax.vmap(_e_n)(scenes))


def _calls(count: int) -> dict[str, Callable[[], object]]:
    """What is measured, by name: functions of nothing, compiled."""
    scenes = mixed_scenes(count, seed=0)
    arrays, nothing = jax.tree.map(jnp.asarray, scenes), jnp.zeros(len(PARAMETERS))
    alone = _alone()
    on_device = jax.tree.map(jnp.asarray, alone)
    values, one = jax.jit(jax.vmap(_e_n)), jax.jit(_e_n)
    gradient, by_all = jax.jit(jax.grad(_mean)), jax.jit(jax.grad(_mean_of_scenes))
    own = jax.value_and_grad(_e_n_of_parameters, argnums=range(len(PARAMETERS)))
    parameters = [getattr(alone.soil, name) for name in PARAMETERS]
    calls = {
        BATCH: lambda: simulate_batch(scenes),
        VALUES: lambda: values(arrays),
        GRADIENTS: lambda: gradient(nothing, arrays),
        BY_ALL: lambda: by_all(arrays),
        JITTED: lambda: one(on_device),
        EAGER: lambda: _e_n(alone),
        EAGER_GRADIENT: lambda: own(*parameters),
    }
    for call in calls.values():
        jax.block_until_ready(call())
    return calls


def _seconds(call: Callable[[], object], calls: int) -> float:
    """The shortest of so many calls."""
    shortest = np.inf
    for _ in range(calls):
        begin = time.perf_counter()
        jax.block_until_ready(call())
        shortest = min(shortest, time.perf_counter() - begin)
    return shortest


def _seconds_of_steps(calls: int) -> float:
    """An impact in machine code, without what a call from Python takes: that is what no
    impact takes."""
    accuracy = PRESETS["balanced"]
    one = _alone()
    kernel = compile_native(Assembly(jax.tree.structure(one), PLANAR, ledger=False))
    assert kernel is not None
    kernels = KernelSet([kernel])
    setting = [accuracy.tolerance, accuracy.floor]
    column = np.array([*jax.tree.leaves(one), *setting], float)[:, None]
    impact, nothing = (
        _seconds(functools.partial(kernels.compute, lanes, 1), calls)
        for lanes in (column, column[:, :0])
    )
    return impact - nothing


def measure(bench: Bench) -> list[Row]:
    """A row for each way to compute."""
    settings = bench.settings
    bench.say("compiling")
    calls = _calls(settings.jax_scenes)
    together = (BATCH, VALUES, GRADIENTS, BY_ALL)
    times = {name: 1 if name in together else settings.jax_singles for name in calls}
    tasks = [functools.partial(_seconds, calls[name], times[name]) for name in calls]
    tasks.append(functools.partial(_seconds_of_steps, settings.jax_singles))
    seconds = interleaved_minima(tasks, settings.jax_repeats, np.inf, bench.say)
    return [
        {
            "way": name,
            "impacts": settings.jax_scenes if name in together else 1,
            "seconds": shortest,
        }
        for name, shortest in zip([*calls, STEPS], seconds, strict=True)
    ]


@in_style
def draw(rows: Table) -> Figure:
    """Impacts a second of many, and the time of one."""
    figure, (many, one) = panels(2, 1, height=1.7)
    several, alone = rows[rows["impacts"] > 1], rows[rows["impacts"] == 1]
    many.set_xlabel("impacts per second [1/s], all cores")
    one.set_xlabel("time of one impact [µs]")
    for axes, own, values in (
        (many, several, several["impacts"] / several["seconds"]),
        (one, alone, 1e6 * alone["seconds"]),
    ):
        colours = [GREY if way == STEPS else BLUE for way in own["way"]]
        bars = axes.barh(own["way"], values, color=colours)
        axes.bar_label(bars, [grouped(value) for value in values], padding=4)
        axes.invert_yaxis()
        axes.margins(x=0.18)
    return figure


def table(rows: Table) -> list[tuple[str, ...]]:
    """Each measure."""
    seconds = rows.set_index("way")["seconds"]
    of_values = seconds[BATCH] / seconds[VALUES]
    of_gradients = seconds[VALUES] / seconds[GRADIENTS]
    of_all = seconds[VALUES] / seconds[BY_ALL]
    overhead = seconds[JITTED] - seconds[STEPS]
    three, gradient = ", ".join(PARAMETERS), seconds[EAGER_GRADIENT]
    return [
        ("measure", "found"),
        (f"values in {VALUES} over those of {BATCH}", f"{of_values:.2f}"),
        (f"{GRADIENTS} by {three} over values in {VALUES}", f"{of_gradients:.2f}"),
        (f"{BY_ALL} over values in {VALUES}", f"{of_all:.2f}"),
        ("one impact inside jit, without its own steps", f"{1e6 * overhead:.0f} µs"),
        ("one impact, its own steps", f"{1e6 * seconds[STEPS]:.0f} µs"),
        (f"one impact, {EAGER}", f"{1e6 * seconds[EAGER]:.0f} µs"),
        (f"one impact, {EAGER_GRADIENT} by {three}", f"{1e6 * gradient:.0f} µs"),
    ]


IN_JAX = Section("in-jax", measure, draw, table)
