"""Code in parts, on vectors of half the lanes, and compiled by child processes: the
same numbers to the last bit."""

import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaximpact.backend.simd import (
    Derivatives,
    Kernel,
    KernelSet,
    LaneFunctions,
    compile_code,
    compiler,
    object_files,
    target,
)
from jaximpact.backend.simd import parts as in_parts

LANES = 37
INPUTS = np.random.default_rng(1).uniform(1.0, 40.0, (3, LANES))


def begin(inputs):
    start, scale, _ = inputs
    return start, jnp.log(scale)


def step(state):
    left, total = state
    more = jnp.exp(-left) / (1.0 + jnp.sin(left) ** 2)
    # A truth that values work out, and derivatives need
    more = jnp.where(left > 10.0, more * left, jnp.cos(left))
    return (left - 1.0, total + more), left > 0.0


def finish(inputs, state):
    start, scale, offset = inputs
    return scale * jnp.sqrt(state[1] + start) + offset * state[0]


def results(lanes=LANES, along=(0, 1, 2)):
    """Numbers of lanes that end at different steps, with their derivatives by inputs,
    and how many object files there are."""
    inputs = INPUTS[:, :lanes]
    directions = Derivatives(3, inputs=(0, 1, 2), state=(0, 1))
    functions = LaneFunctions(begin, step, finish)
    code = compile_code(functions, [jnp.ones(1)] * 3, directions)
    kernels = KernelSet([Kernel(code, None)]).along(len(along))
    rows, _ = kernels.compute(inputs, 1, along=along)
    return rows, len(code.object_files)


@pytest.fixture(scope="module")
def expected():
    rows, files = results()
    assert files == 1
    assert len(rows) == 4
    assert np.all(np.isfinite(rows))
    assert len(np.unique(rows)) == rows.size
    return rows


def test_derivatives_are_those_of_jax(expected):
    """To the rounding of 40 additions."""

    def value(inputs):
        state, going = begin(inputs), True
        while going:
            state, going = step(state)
        return finish(inputs, state)[0]

    for lane in range(4):
        at = [jnp.asarray(row[lane : lane + 1]) for row in INPUTS]
        numbers = [value(at), *(x[0] for x in jax.grad(value)(at))]
        np.testing.assert_allclose(expected[:, lane], numbers, rtol=1e-13)


@pytest.mark.parametrize("along", [(), (0,), (2,), (2, 0), (1, 1, 1)])
def test_directions_are_those_wanted(along, expected):
    rows, _ = results(along=along)
    wanted = expected[[0, *(1 + place for place in along)]]
    assert rows.tobytes() == wanted.tobytes()


@pytest.mark.parametrize("lanes", [1, 4, 5])
def test_few_lanes_leave_a_vector_empty(lanes, short_vectors, expected):
    rows, _ = results(lanes)
    assert rows.tobytes() == expected[:, :lanes].tobytes()


@pytest.fixture(autouse=True)
def nothing_kept(monkeypatch):
    monkeypatch.setattr(object_files, "_keep", lambda key, make: make())


@pytest.fixture
def small_parts(monkeypatch):
    monkeypatch.setattr(in_parts, "WHOLE", 20)
    monkeypatch.setattr(in_parts, "PART", 10)


@pytest.fixture
def short_vectors(monkeypatch):
    """As where a register holds four numbers."""
    if target.this_target().processor != "x86":
        pytest.skip("a processor of x86")
    monkeypatch.setattr(target, "host", lambda: ("x86-64-v3", "+avx2,+fma"))


@pytest.fixture
def children(monkeypatch):
    """What child processes are asked for."""
    asked, compile_apart = [], object_files.compile_apart

    def noted(machine, texts):
        asked.append(texts)
        return compile_apart(machine, texts)

    monkeypatch.setattr(object_files, "APART", 50)
    monkeypatch.setattr(object_files, "thread_count", lambda: 3)
    monkeypatch.setattr(object_files, "compile_apart", noted)
    return asked


@pytest.mark.parametrize(
    "ways",
    [
        ("small_parts",),
        ("children",),
        ("small_parts", "children"),
        ("short_vectors",),
        ("short_vectors", "small_parts", "children"),
    ],
    ids="+".join,
)
def test_the_same_bits_in_each_way(ways, expected, request):
    for way in ways:
        request.getfixturevalue(way)
    rows, files = results()
    assert rows.tobytes() == expected.tobytes()
    if "children" in ways and "small_parts" in ways:
        (texts,) = request.getfixturevalue("children")
        assert len(texts) == 3
        assert files == 4  # and one with what calls the parts


@pytest.mark.parametrize("executable", ["", None, "/opt/viewer/viewer", "/no/python"])
def test_without_an_interpreter_code_is_compiled_here(
    executable, children, expected, monkeypatch
):
    monkeypatch.setattr(sys, "executable", executable)
    rows, files = results()
    assert rows.tobytes() == expected.tobytes()
    assert files == 1
    assert children


def test_a_child_that_fails_leaves_the_work_to_its_parent():
    machine = target.this_target().machine(external_calls=False)
    whole, broken = "define void @f() {\n ret void\n}", "define void @f() {"
    assert len(compiler.compile_apart(machine, [whole, whole])) == 2
    assert compiler.compile_apart(machine, [whole, broken]) is None
