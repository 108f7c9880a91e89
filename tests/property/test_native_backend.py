"""Machine code of the package's own: it computes what JAX computes, for every lane."""

import dataclasses
import hashlib
import importlib.resources

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax.extend.core import jaxpr_as_fun

from jaximpact import Block, Impact, Scene, Soil, simulate, simulate_batch
from jaximpact.backend.native_backend import compile_native
from jaximpact.backend.simd import (
    KernelSet,
    NoMachineCode,
    compile_kernel,
    kernel,
    repeated,
    target,
)
from jaximpact.backend.simd import lower_jaxpr as translation
from jaximpact.backend.simd.graph import Graph
from jaximpact.backend.simd.llvm_ir import HALF, PACK
from jaximpact.errors import IncompleteError, NoMachineCodeWarning
from jaximpact.impact.problem import Assembly
from jaximpact.impact.reduced_models import MODELS
from jaximpact.impact.specialize import depends
from jaximpact.laws import Vesic

ONE = jax.ShapeDtypeStruct((1,), float)


def native(function, *arguments):
    """A function of arrays `(lanes,)` in machine code: lanes end after a step that
    does nothing."""
    kernel = compile_kernel(
        lambda inputs: jnp.zeros(1),
        lambda state: (state, jnp.zeros(1, bool)),
        lambda inputs, state: function(*inputs),
        [ONE] * len(arguments),
    )
    arguments = np.stack(np.broadcast_arrays(*arguments)).astype(float)
    results, _ = KernelSet([kernel]).compute(arguments, threads=1)
    return jax.tree.unflatten(kernel.structure, list(results))


def spread(low, high, count=20_000):
    """Numbers of both signs, their logarithms evenly spread."""
    size = np.geomspace(low, high, count)
    return np.concatenate([-size, size])


FUNCTIONS = {
    "exp": (jnp.exp, np.exp, [spread(1e-20, 708.0)]),
    "log": (jnp.log, np.log, [np.geomspace(1e-307, 1e307), np.linspace(0.5, 2, 9999)]),
    "sin": (jnp.sin, np.sin, [spread(1e-20, 10.0), spread(1.0, 1e5)]),
    "cos": (jnp.cos, np.cos, [spread(1e-20, 10.0), spread(1.0, 1e5)]),
    "atan": (jnp.arctan, np.arctan, [spread(1e-20, 1e20), spread(0.1, 3.0)]),
    "cbrt": (jnp.cbrt, np.cbrt, [spread(1e-300, 1e300), spread(0.1, 3.0)]),
    "tan": (jnp.tan, np.tan, [spread(1e-20, 1.5)]),
}
WRITTEN = {
    "acos": (jnp.arccos, np.arccos, [spread(1e-20, 0.99999)]),
    "acosh": (jnp.arccosh, np.arccosh, [1.0 + np.geomspace(1e-10, 1e300, 20_000)]),
    "asin": (jnp.arcsin, np.arcsin, [spread(1e-20, 0.99999)]),
    "asinh": (jnp.arcsinh, np.arcsinh, [spread(1e-20, 1e300)]),
    "atanh": (jnp.arctanh, np.arctanh, [spread(1e-20, 0.99999)]),
    "ceil": (jnp.ceil, np.ceil, [spread(0.01, 1e18)]),
    "cosh": (jnp.cosh, np.cosh, [spread(1e-20, 700.0)]),
    "exp2": (jnp.exp2, np.exp2, [spread(1e-10, 5.0)]),
    "expm1": (jnp.expm1, np.expm1, [spread(1e-20, 700.0)]),
    "floor": (jnp.floor, np.floor, [spread(0.01, 1e18)]),
    "log1p": (jnp.log1p, np.log1p, [np.geomspace(1e-20, 1e300), spread(1e-20, 0.99)]),
    "logistic": (jax.nn.sigmoid, lambda x: 1 / (1 + np.exp(-x)), [spread(1e-9, 700)]),
    "rsqrt": (jax.lax.rsqrt, lambda x: 1 / np.sqrt(x), [np.geomspace(1e-300, 1e300)]),
    "sinh": (jnp.sinh, np.sinh, [spread(1e-20, 700.0)]),
    "tanh": (jnp.tanh, np.tanh, [spread(1e-20, 700.0)]),
}


ENDS = np.array([0.0, -0.0, np.inf, -np.inf, np.nan, -1.0, 1.0, -800.0, 800.0])


@pytest.mark.parametrize("name", FUNCTIONS | WRITTEN)
def test_functions_of_one_number(name):
    function, exact, ranges = (FUNCTIONS | WRITTEN)[name]
    x = np.concatenate([*ranges, ENDS])
    with np.errstate(all="ignore"):
        expected, at_ends = exact(x[: -len(ENDS)].astype(np.longdouble)), exact(ENDS)
    found, found_at_ends = np.split(native(function, x), [-len(ENDS)])
    # A quotient is a product with an inverse, which rounds once more; a tangent is one
    # of two numbers that are each within two units; what is written by others is made
    # of two to four operations.
    allowed = {"tan": 4.0, "atan": 2.5} | dict.fromkeys(WRITTEN, 5.0)
    error = np.abs(found - expected) / np.spacing(np.abs(expected).astype(float))
    assert np.max(error) < allowed.get(name, 2.0)
    rtol = 1e-13 if name in WRITTEN else 1e-15
    np.testing.assert_allclose(found_at_ends, at_ends, rtol=rtol, atol=0.0)


def test_functions_of_two_numbers_written_by_others():
    numbers = np.random.default_rng(0)
    a, b = numbers.uniform(0.01, 10.0, 5_000), numbers.uniform(-5.0, 5.0, 5_000)
    # exp(b log a) loses as many units as |b log a| is large.
    np.testing.assert_allclose(native(lambda x, y: x**y, a, b), a**b, rtol=1e-14)
    whole = np.round(b)
    found = native(lambda x, y: x**y, -a, whole)
    np.testing.assert_allclose(found, (-a) ** whole, rtol=1e-14)
    np.testing.assert_allclose(
        native(jnp.arctan2, b, a - 5.0), np.arctan2(b, a - 5.0), rtol=1e-15
    )
    for ours, theirs in ((jnp.fmod, np.fmod), (jnp.mod, np.mod)):
        np.testing.assert_allclose(native(ours, a, b), theirs(a, b), atol=2e-15)
    edges = np.array([0.0, 0.0, 0.0, -2.0, np.nan, 2.0])
    powers = np.array([2.0, 0.0, -1.5, 0.5, 2.0, np.nan])
    with np.errstate(all="ignore"):
        expected = edges**powers
    np.testing.assert_array_equal(native(lambda x, y: x**y, edges, powers), expected)
    clipped = native(lambda x: jax.lax.clamp(-1.0, x, 2.0), a - 5.0)
    np.testing.assert_array_equal(clipped, np.clip(a - 5.0, -1.0, 2.0))


SPECIAL = np.array(
    [0.0, -0.0, 1.0, -1.0, 2.5, -2.5, 1e200, -1e200, np.inf, -np.inf, np.nan]
)
PAIRS = [side.ravel() for side in np.meshgrid(SPECIAL, SPECIAL)]
OPERATIONS = {
    "arithmetic": lambda a, b: (a + b, a - b, a * b, a / b, -a, a * 0.0, a + 0.0),
    "comparisons": lambda a, b: [
        jnp.where(c, 1.0, 0.0) for c in (a < b, a <= b, a > b, a >= b, a == b, a != b)
    ],
    "truths": lambda a, b: [
        jnp.where(c, a, b)
        for c in (
            (a > 0.0) & (b > 0.0),
            (a > 0.0) | (b > 0.0),
            (a > 0.0) != (b > 0.0),
            ~(a > 0.0),
            jnp.isfinite(a),
        )
    ],
    "extremes": lambda a, b: (
        *(jnp.maximum(a, b), jnp.minimum(a, b), jnp.maximum(a, 1.0)),
        *(jnp.minimum(1.0, b), jnp.clip(a, -1.0, 2.0), jnp.abs(a), jnp.sign(a)),
    ),
    "powers": lambda a, b: (
        *(a**2, a**3, a**-1, a**-2, b**0, jnp.sqrt(a), jnp.square(b)),
        jnp.abs(a) ** 0.2,
        jnp.abs(b) ** -0.06,
    ),
    "integers": lambda a, b: (
        jnp.where(jnp.isfinite(a), (a > 0).astype(int) + 2 * (b > 0) - 1, 0) * 1.0
    ),
    "rows": lambda a, b: (
        *jnp.stack([a, b, b])[1:],
        jnp.sum(jnp.stack([a, b, a]), 0),
        jnp.min(jnp.stack([a, b]), 0),
        jnp.max(jnp.stack([a, b]), 0),
        jnp.any(jnp.stack([a, b]) > 0.0, 0) * 1.0,
        jnp.all(jnp.stack([a, b]) > 0.0, 0) * 1.0,
        jnp.argmin(jnp.stack([a, b], -1), -1) * 1.0,
        *jnp.tensordot(np.array([[1.0, 2.0], [3.0, 4.0]]), jnp.stack([a, b]), 1),
    ),
    "parts": lambda a, b: (
        *jnp.split(jnp.stack([a, b, a, b]), [1, 3])[1],
        *jnp.unstack(jnp.stack([a, b], -1), axis=-1),
        *jnp.flip(jnp.stack([a, b]), 0),
        *jnp.tile(jnp.stack([a, b]), (2, *[1] * a.ndim)),
    ),
    "loop": lambda a, b: jax.lax.fori_loop(
        0, 3, lambda i, x: x.at[i].set(a * i + b), jnp.zeros((3, *a.shape))
    )[2],
}


@pytest.mark.parametrize("name", OPERATIONS)
def test_operations(name):
    function = OPERATIONS[name]
    found = native(function, *PAIRS)
    expected = jax.vmap(function, -1, -1)(*PAIRS)
    # Rounding of a logarithm up to 92, by which 1e200 is raised to 0.2.
    for mine, theirs in zip(
        jax.tree.leaves(found), jax.tree.leaves(expected), strict=True
    ):
        np.testing.assert_allclose(mine, theirs, rtol=2e-14, atol=0.0)


def test_entry_of_a_row_by_its_place():
    table = np.array([3.0, 1.0, 4.0])

    def pick(a, b, c):
        row = jnp.stack([a, b, c])
        place = jnp.argmin(row)
        return row[place], jnp.asarray(table)[place]

    rows = np.random.default_rng(0).normal(size=(3, 21))
    least, entry = native(jax.vmap(pick), *rows)
    np.testing.assert_array_equal(least, rows.min(0))
    np.testing.assert_array_equal(entry, table[rows.argmin(0)])


def test_what_has_no_native_code_is_named():
    with pytest.raises(NoMachineCode, match="'erf_inv'"):
        native(jax.scipy.special.erfinv, np.zeros(1))


@pytest.mark.parametrize(
    "function",
    [
        lambda x: jnp.maximum((x > 0.0).astype(int), 1),
        lambda x: ((x > 0.0).astype(int)) ** 2,
        lambda x: jax.lax.cond(x[0] > 0.0, jnp.sin, jnp.cos, x),
        lambda x: jax.lax.while_loop(lambda x: x[0] > 1.0, lambda x: 0.5 * x, x),
    ],
)
def test_what_might_be_taken_for_something_else_is_refused(function):
    with pytest.raises(NoMachineCode, match="no native"):
        native(function, np.ones(1))


@pytest.mark.skipif(
    target.this_target().processor != "x86", reason="a processor of x86"
)
def test_a_processor_without_fused_multiply_adds_calls_a_library(monkeypatch):
    # In the small code model llvmlite would abort the process at such a call.
    x = spread(1e-20, 10.0, 100)
    here = native(lambda x: jnp.sin(x) * x + 1.0, x)
    monkeypatch.setattr(target, "host", lambda: ("x86-64", "+sse2"))
    there = native(lambda x: jnp.sin(x) * x + 1.0, x)
    assert there.tobytes() == here.tobytes()


@pytest.mark.parametrize("varied", [(0,), (1,), (0, 1)])
def test_the_rule_of_a_quotient_is_its_derivative(varied):
    operands, tangents = np.random.default_rng(0).uniform(0.5, 2.0, (2, 2, 100))
    equation = jax.make_jaxpr(jnp.divide)(*operands).eqns[0]
    rule = translation._rule_of(equation, varied)
    given = [tangents[k] for k in varied]
    found = jaxpr_as_fun(rule)(*operands, *given)
    moved = [tangents[k] if k in varied else 0.0 * tangents[k] for k in (0, 1)]
    _, expected = jax.jvp(jnp.divide, tuple(operands), tuple(moved))
    # A few roundings of terms of the size of one.
    np.testing.assert_allclose(found[0], expected, rtol=0.0, atol=1e-14)


@pytest.fixture(scope="module")
def counter():
    """Lanes that add up the numbers from their input down to 1, one a step."""
    kernel = compile_kernel(
        lambda start: (start, jnp.zeros(1)),
        lambda state: ((state[0] - 1.0, state[1] + state[0]), state[0] > 1.0),
        lambda start, state: state[1],
        ONE,
    )
    return KernelSet([kernel])


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("count", [0, 1, 7, 8, 9, 200])
def test_every_lane_comes_to_its_own_end(counter, count, threads):
    numbers = np.random.default_rng(count).integers(1, 300, count)
    (sums,), _ = counter.compute(numbers[None], threads, effort=-numbers)
    assert sums.tolist() == (numbers * (numbers + 1) // 2).tolist()


def test_inputs_of_another_shape_are_refused(counter):
    with pytest.raises(ValueError, match="got 2 rows of inputs, need 1"):
        counter.compute(np.zeros((2, 3)), threads=1)


def of_turns(x, y):
    """What a loop gives that calls a jitted function in each turn: with a number, a
    float and a truth that change, and a float and a truth that do not."""
    is_large, scale = x > 0.5, jnp.exp(y)

    @jax.jit
    def advance(turn, total, sign, weight):
        inner = jax.lax.fori_loop(0, 3, lambda k, s: s + jnp.sin(s * y), total)
        grown = jnp.where(is_large, inner, -inner) / (1.0 + scale * weight)
        return jnp.where(sign, grown, total + turn), ~sign

    # The weight is the same in the first two turns, but not in all.
    weights = jnp.array([1.0, 1.0, 1.0, 2.0, 1.0])

    def turn(i, carry):
        total, sign, all_totals = carry
        total, sign = advance(i.astype(float), total, sign, weights[i])
        return total, sign, all_totals.at[i].set(total)

    total, sign, all_totals = jax.lax.fori_loop(
        0, 5, turn, (x, y > 0.0, jnp.zeros((5, *x.shape)))
    )
    return total * scale + jnp.exp(y), jnp.sum(all_totals, axis=0), sign


@pytest.mark.parametrize("lanes", [HALF, PACK])
def test_a_function_that_a_loop_calls_is_called_in_machine_code(lanes, monkeypatch):
    calls = []
    call = Graph.call
    monkeypatch.setattr(
        Graph, "call", lambda *arguments: calls.append(1) or call(*arguments)
    )
    monkeypatch.setattr(repeated, "LEAST_BODY", 1)
    monkeypatch.setattr(kernel, "lanes_for", lambda differentiated: lanes)
    x, y = np.random.default_rng(0).uniform(-1.0, 1.0, (2, 50))
    mine = native(of_turns, x, y)
    # The first turn is written out, and that with another weight.
    assert len(calls) == 3
    for number, expected in zip(mine, of_turns(x, y), strict=True):
        np.testing.assert_allclose(number, expected, rtol=1e-13)


def oblique_scenes(count):
    draw = np.random.default_rng(3).uniform
    return Scene(
        Block(mass=draw(1.0, 500.0, count), aspect_ratio=draw(0.6, 3.0, count)),
        Soil(gamma_v=draw(1.0, 10.0, count)),
        Impact(
            speed=draw(5.0, 30.0, count),
            angle=draw(-1.2, 1.2, count),
            orientation=draw(0.0, np.pi, count),
            angular_velocity=draw(-50.0, 50.0, count),
        ),
    )


def test_kept_machine_code_runs(cache, monkeypatch):
    compile_native.cache_clear()
    scenes = oblique_scenes(20)
    made = simulate_batch(scenes, accuracy="fast")
    compile_native.cache_clear()
    monkeypatch.setattr("jaximpact.backend.lane_functions.compile_code", None)
    found = simulate_batch(scenes, accuracy="fast")
    for a, b in zip(jax.tree.leaves(made), jax.tree.leaves(found), strict=True):
        np.testing.assert_array_equal(a, b)
    compile_native.cache_clear()


class BearingWithoutMachineCode(Vesic):
    def factors(self, friction):
        # Nothing but a primitive that is not translated.
        return jax.tree.map(
            lambda x: x + 0.0 * jax.lax.digamma(x + 1.0), super().factors(friction)
        )


def on_ground_without_machine_code(scenes):
    soil = dataclasses.replace(scenes.soil, bearing=BearingWithoutMachineCode())
    return dataclasses.replace(scenes, soil=soil)


@pytest.mark.xla
def test_laws_without_native_code_run_by_xla_and_say_so():
    # Vertical drops, whose model XLA compiles fastest.
    scenes = Scene(Block(), Soil(gamma_v=np.array([2.0, 8.7])), Impact())
    others = on_ground_without_machine_code(scenes)
    timing = {}
    told = r"'digamma' \(.*test_native_backend.py:\d+, in BearingWithoutMachineCode.*\)"
    with pytest.warns(NoMachineCodeWarning, match=told):
        other = simulate_batch(others, accuracy="fast", timing=timing)
    # Once: here a second warning would be an error.
    structure = jax.tree.structure(others)
    assert compile_native(Assembly(structure, MODELS[0], ledger=True)) is None
    assert timing["engine"] == "XLA"
    result = simulate_batch(scenes, accuracy="fast", timing=timing)
    assert timing["engine"] == "machine code"
    # To the error of "fast".
    np.testing.assert_allclose(other.e_bar, result.e_bar, atol=5e-4)


@pytest.mark.slow
def test_the_slower_way_can_be_refused(monkeypatch):
    monkeypatch.setenv("JAXIMPACT_REQUIRE_MACHINE_CODE", "1")
    with pytest.raises(IncompleteError, match="no native code for the primitive"):
        simulate_batch(on_ground_without_machine_code(oblique_scenes(2)))
    with pytest.raises(IncompleteError, match="no native code for the primitive"):
        jax.jit(simulate)(on_ground_without_machine_code(oblique_scenes(2)))


def test_a_primitive_that_a_later_jax_describes_otherwise_is_named(monkeypatch):
    def described_otherwise(equation):
        return equation.params["count_of_constants"], 1

    monkeypatch.setattr(translation, "scan_counts", described_otherwise)
    with pytest.raises(NoMachineCode, match=r"JAX .* 'scan' .*count_of_constants"):
        native(OPERATIONS["loop"], *PAIRS)


def test_dependence_is_seen_through_calls():
    @jax.jit
    def inner(a, b):
        return 2.0 * a, a + b

    def function(a, b, c):
        first, second = inner(a, b)
        return first, second, c, jax.lax.stop_gradient(b) + c

    traced = jax.make_jaxpr(function)(1.0, 2.0, 3.0).jaxpr
    assert depends(traced, [True, False, False]) == [True, True, False, False]
    assert depends(traced, [False, True, False]) == [False, True, False, False]
    assert depends(traced, [False, False, True]) == [False, False, True, True]


def test_driver_is_made_from_its_source():
    """driver.ll, which runs, is that of driver.c, which is read: else `make driver`."""
    folder = importlib.resources.files("jaximpact.backend.simd")
    digest = hashlib.sha256((folder / "driver.c").read_bytes()).hexdigest()
    assert digest in (folder / "driver.ll").read_text().partition("\n")[0]
