"""Kernels: machine code that takes lanes from their inputs to their results.

What a lane does is given by functions in JAX, which are traced for one lane and
compiled for vectors of eight. Eight columns of memory hold lanes under way; one that
has come to its end gives its place to the next. Lanes know nothing of each other: a
lane's results do not depend, to the last bit, on what runs beside it.
"""

import enum
import math
from collections.abc import Callable, Sequence
from itertools import count
from typing import Any, NamedTuple

import jax
import numpy as np

from .arrays import Dual
from .driver import Program
from .functions import Function, write_choice, write_function
from .graph import FLOAT, INPUT, NUMPY, Graph, Node, NoMachineCode, Value
from .llvm_ir import HALF, PACK, rows_read
from .lower_jaxpr import Translator
from .object_files import compile_functions, lanes_for, load, vectors_of
from .parts import Output, Rows
from .reverse import Reverse, reverse_sweep

MOST_DIRECTIONS = 8
"""Derivatives that share a run of an impact. Each costs some three quarters of the
value, and each needs 13 KB for eight lanes, which the processor's caches must hold."""


FORWARD_SWEEP = "begin", "step", "finish", "sample"
REVERSE_SWEEP = "from_end", "over_step", "to_start"
"""Names of functions, as in `Program`."""


class Mode(enum.StrEnum):
    """What code gives."""

    VALUES = "values"
    FORWARD = "forward"
    """Values, and their derivatives along directions."""
    REVERSE = "reverse"
    """Values, and a gradient of what is made of them."""


class Code(NamedTuple):
    """Compiled lane functions."""

    object_files: list[bytes]
    input_rows: int
    common_inputs: int
    """First rows of inputs, which copies of a lane have in common."""
    result_rows: int
    rows: int
    """Rows of inputs, state, results and samples together."""
    spare_rows: int
    """Rows behind them, for what functions keep while they run."""
    directions: int = 0
    """The most along which there are derivatives."""
    time_row: int = -1
    """Row of the state that holds the time reached; -1 where nothing is sampled."""
    sampled_rows: int = 0
    accepted_row: int = -1
    """Row of the state that counts the steps accepted; -1 without a reverse sweep."""
    taped_rows: tuple[int, ...] = ()
    """Rows that are recorded, as they are where each step begins, for that sweep."""


class Retries(NamedTuple):
    """Retries of a lane that has failed: with tolerances times each of the factors, but
    only one where it has used up its steps."""

    tolerance_row: int
    """Row of the tolerance among the inputs."""
    outcome_row: int
    """Row of the outcome among the results."""
    steps_row: int
    failed: float
    most_steps: float
    factors: tuple[float, ...]


class Kernel:
    """Compiled code that is ready to run; its results are a tree with a row for each
    leaf."""

    def __init__(self, code: Code, structure, retries: Retries | None = None):
        self.code, self.structure = code, structure
        self.engine = load(code.object_files)
        address = self.engine.get_function_address
        asked = code.rows - code.sampled_rows - 1  # after the results
        self.program = Program(
            begin=address("begin"),
            step=address("step"),
            finish=address("finish"),
            sample=address("sample") if code.sampled_rows else None,
            rows=code.rows + code.spare_rows,
            input_rows=code.input_rows,
            results_row=(asked if code.sampled_rows else code.rows) - code.result_rows,
            result_rows=code.result_rows,
            tolerance=-1,
            time=code.time_row,
            asked=asked,
            sampled_row=asked + 1,
            sampled_rows=code.sampled_rows,
        )
        if code.accepted_row >= 0:
            for name in REVERSE_SWEEP:
                setattr(self.program, name, address(name))
            self._taped_rows = np.array(code.taped_rows, np.int64)
            self.program.taped_rows = self._taped_rows.ctypes.data
            self.program.taped = len(code.taped_rows)
            self.program.accepted = code.accepted_row
        if retries is not None:
            self.program.tolerance = retries.tolerance_row
            self.program.outcome = retries.outcome_row
            self.program.steps = retries.steps_row
            self.program.failed = retries.failed
            self.program.most_steps = retries.most_steps
            self.program.retries[:] = retries.factors

    def program_along(self, directions: int) -> Program:
        """Return the program for so many of the directions: rows of the first ones."""
        code, program = self.code, Program.from_buffer_copy(self.program)
        of_all = code.input_rows - code.common_inputs
        program.input_rows -= of_all - of_all // max(code.directions, 1) * directions
        program.result_rows //= 1 + code.directions
        program.result_rows *= 1 + directions
        program.sampled_rows //= 1 + code.directions
        program.sampled_rows *= 1 + directions
        return program

    @property
    def layout(self) -> bytes:
        """Description of the code for the driver, without addresses, as bytes."""
        layout = Program.from_buffer_copy(self.program)
        for name in (*FORWARD_SWEEP, *REVERSE_SWEEP, "taped_rows"):
            setattr(layout, name, None)
        return bytes(layout) + repr(self.code.taped_rows).encode()


class LaneFunctions(NamedTuple):
    """Functions in JAX that say what a lane does."""

    begin: Callable
    """Function from inputs to a state."""
    step: Callable
    """Function from a state to the next one, and whether the lane goes on."""
    finish: Callable
    """Function from inputs and a state to results."""
    sample: Callable | None = None
    """Function from a state and a time that the last step has passed to samples
    there."""
    time: Callable | None = None
    """Function from a state to the time reached, which must be an array of the
    state."""


class Derivatives(NamedTuple):
    """Derivatives of results, and of samples, along directions."""

    directions: int
    inputs: Sequence[int]
    """Leaves of the inputs by which a direction may lead."""
    state: Sequence[int]
    """Leaves of the state that have derivatives; those of others count as zero."""


def compile_kernel(begin: Callable, step: Callable, finish: Callable, inputs) -> Kernel:
    """Compile functions of lanes, as for `LaneFunctions`, ready to run; inputs are as
    for `compile_code`."""
    code, results = _compiled(LaneFunctions(begin, step, finish), inputs)
    return Kernel(code, jax.tree.structure(results))


def compile_code(
    functions: LaneFunctions,
    inputs,
    derivatives: Derivatives | None = None,
    thorough: bool = False,
) -> Code:
    """Compile functions of lanes.

    Args:
        inputs: a tree of arrays, or of what stands for them, with one lane: every
            array of the functions has one axis of length 1, the lane's.
        derivatives: those along directions, which are worked out beside the values.
        thorough: whether to take twice the time to compile. Steps then also have code
            for vectors of half the lanes, which takes two thirds of the time where few
            lanes are under way.

    Rows are inputs, state and results; with samples the time asked for and samples.
    Behind inputs, state, results and samples stand the derivatives of each direction.
    The inputs' are those that the direction is given by: of each of the leaves that may
    vary, and with samples of the time.

    Raises NoMachineCode if a function does what has no native code.
    """
    return _compiled(functions, inputs, derivatives, thorough)[0]


def _compiled(
    functions: LaneFunctions,
    inputs,
    derivatives: Derivatives | None = None,
    thorough: bool = False,
) -> tuple[Code, Any]:
    """Give the code, and shapes of results."""
    begin, state = jax.make_jaxpr(functions.begin, return_shape=True)(inputs)
    step = jax.make_jaxpr(functions.step)(state)
    finish, results = jax.make_jaxpr(functions.finish, return_shape=True)(inputs, state)
    along = derivatives or Derivatives(0, (), ())
    layout = _Layout(along.directions)
    more = 0 if functions.sample is None else 1  # the time's
    at_inputs = layout.allot(inputs, along.inputs, more)
    at_state = layout.allot(state, along.state)
    at_results = layout.allot(results)
    to_write = [
        ("begin", begin, [at_inputs], [at_state], dict(masked=True)),
        ("step", step, [at_state], [at_state], dict(says=True, of_few=thorough)),
        ("finish", finish, [at_inputs, at_state], [at_results], {}),
    ]
    time_row, sampled_rows = -1, 0
    if functions.sample is not None and functions.time is not None:
        asked = jax.ShapeDtypeStruct((1,), float)
        sample, samples = jax.make_jaxpr(functions.sample, return_shape=True)(
            state, asked
        )
        at_asked = layout.asked(at_inputs)
        at_samples = layout.allot(samples)
        sampled_rows = at_samples.rows
        time_row = at_state.place_of(functions.time, state)
        sources = [at_state, at_asked]
        to_write.append(("sample", sample, sources, [at_samples], dict(masked=True)))
    written = [
        _written(layout, name, traced, sources, targets, **how)
        for name, traced, sources, targets, how in to_write
    ]
    functions_written = [one.function for one in written]
    code = Code(
        compile_functions(functions_written, layout.directions > 0, thorough),
        at_inputs.rows,
        at_inputs.size,
        at_results.rows,
        layout.rows,
        max(one.spare_rows for one in written),
        layout.directions,
        time_row,
        sampled_rows,
    )
    return code, results


def compile_reverse(
    functions: LaneFunctions, inputs, reverse: Reverse, thorough: bool = False
) -> Code:
    """Compile functions of lanes that have a forward and a reverse sweep, for gradients
    of what is made of their results; arguments as for `compile_code`.

    Behind the rows of inputs stand those of the cotangents of the results; behind the
    rows of results those of the cotangents of the inputs that vary.
    """
    sweep = reverse_sweep(functions.begin, functions.finish, reverse)
    begin, state = jax.make_jaxpr(functions.begin, return_shape=True)(inputs)
    step = jax.make_jaxpr(functions.step)(state)
    finish, results = jax.make_jaxpr(functions.finish, return_shape=True)(inputs, state)
    try:
        from_end, (of_inputs, of_state) = jax.make_jaxpr(
            sweep.from_end, return_shape=True
        )(inputs, results, state)
        over_step = jax.make_jaxpr(sweep.over_step)(state, of_state)
        to_start = jax.make_jaxpr(sweep.to_start)(inputs, of_inputs, of_state)
    except Exception as error:  # of a user's law that has forward mode alone
        problem, *_ = (str(error) or repr(error)).splitlines()
        raise NoMachineCode(f"JAX has no reverse mode of it: {problem}") from error
    layout = _Layout(0)
    at_inputs, at_cotangents = layout.allot(inputs), layout.allot(results)
    at_state, at_of_state = layout.allot(state), layout.allot(of_state)
    at_results, at_of_inputs = layout.allot(results), layout.allot(of_inputs)
    at_end = [at_inputs, at_cotangents, at_state]
    at_start = [at_inputs, at_of_inputs, at_of_state]
    backwards = dict(differentiated=True)
    few = dict(of_few=thorough)
    written = {
        name: _written(layout, name, traced, sources, targets, **how)
        for name, traced, sources, targets, how in (
            ("begin", begin, [at_inputs], [at_state], dict(masked=True)),
            ("step", step, [at_state], [at_state], dict(says=True, **few)),
            ("finish", finish, [at_inputs, at_state], [at_results], {}),
            ("from_end", from_end, at_end, [at_of_inputs, at_of_state], backwards),
            (
                "over_step",
                over_step,
                [at_state, at_of_state],
                [at_of_state],
                dict(masked=True, **few, **backwards),
            ),
            ("to_start", to_start, at_start, [at_of_inputs], backwards),
        )
    }
    return Code(
        compile_functions([x.function for x in written.values()], True, thorough),
        at_inputs.rows + at_cotangents.rows,
        at_inputs.rows + at_cotangents.rows,
        at_results.rows + at_of_inputs.rows,
        layout.rows,
        max(x.spare_rows for x in written.values()),
        accepted_row=at_state.place_of(reverse.accepted, state),
        taped_rows=tuple(sorted(written["over_step"].read & written["step"].changed)),
    )


class _Part(NamedTuple):
    """Rows that hold a tree, and behind them those of derivatives."""

    start: int
    shapes: list[tuple[int, ...]]
    varied: Sequence[int]
    """Leaves that have derivatives."""
    tangents: int
    """First row of the derivatives of the first direction."""
    stride: int
    """Rows from those of a direction to those of the next."""
    directions: int

    @property
    def size(self) -> int:
        """Rows of values."""
        return sum(map(math.prod, self.shapes))

    @property
    def rows(self) -> int:
        return self.size + self.directions * self.stride

    def place_of(self, choose: Callable, tree) -> int:
        """Return the row of a leaf, chosen from the tree."""
        leaves, structure = jax.tree.flatten(tree)
        chosen = choose(jax.tree.unflatten(structure, range(len(leaves))))
        return self.start + sum(map(math.prod, self.shapes[:chosen]))

    def rows_of_tangents(self) -> dict[int, int]:
        """Find the first row of each leaf's derivative along the first direction."""
        rows, row = {}, self.tangents
        for leaf in self.varied:
            rows[leaf] = row
            row += math.prod(self.shapes[leaf])
        return rows


class _Layout:
    """Rows reserved one after the other."""

    def __init__(self, directions: int):
        self.directions, self.rows = directions, 0

    def allot(self, tree, varied: Sequence[int] | None = None, more: int = 0) -> _Part:
        """Reserve rows for a tree, and for the derivatives of some of its leaves, by
        default of all, with so many rows more for each direction."""
        shapes = [leaf.shape for leaf in jax.tree.leaves(tree)]
        if varied is None:
            varied = range(len(shapes))
        if not self.directions:
            varied, more = (), 0
        tangents = self.rows + sum(map(math.prod, shapes))
        stride = sum(math.prod(shapes[leaf]) for leaf in varied) + more
        part = _Part(self.rows, shapes, varied, tangents, stride, self.directions)
        self.rows += part.rows
        return part

    def asked(self, inputs: _Part) -> _Part:
        """Reserve a row for the time asked for, whose derivative is among those of the
        inputs, the last of each direction."""
        part = _Part(self.rows, [(1,)], (), 0, 0, 0)
        self.rows += 1
        if not self.directions:
            return part
        tangents, stride = inputs.tangents + inputs.stride - 1, inputs.stride
        return part._replace(varied=(0,), tangents=tangents, stride=stride)


class _Written(NamedTuple):
    """A function that is written."""

    function: Function
    spare_rows: int
    read: set[int]
    changed: set[int]
    """Rows that it reads, and those that it changes."""


def _written(
    layout: _Layout,
    name: str,
    traced,
    sources: Sequence[_Part],
    targets: Sequence[_Part],
    masked: bool = False,
    says: bool = False,
    of_few: bool = False,
    differentiated: bool = False,
) -> _Written:
    """Write a traced function for LLVM. Its arguments are in the rows of the sources,
    its results go to those of the targets, but for the truth that it `says` last. It
    has code `of_few` lanes beside that of all, if vectors have all."""
    graph, kinds = Graph(), iter(traced.in_avals)

    def inputs(row: int, shape: tuple[int, ...], kind: str, along=False) -> np.ndarray:
        values = np.empty(shape, object)
        for index in np.ndindex(shape):
            values[index] = graph.input(row, kind, along)
            row += 1
        return values

    arguments = []
    for part in sources:
        row, tangents = part.start, part.rows_of_tangents()
        for leaf, shape in enumerate(part.shapes):
            values = inputs(row, shape, NUMPY[next(kinds).dtype.kind])
            tangent = None
            if leaf in tangents:
                tangent = inputs(tangents[leaf], shape, FLOAT, along=True)
            arguments.append(Dual(values, tangent))
            row += math.prod(shape)
    results = Translator(graph).run(traced.jaxpr, traced.consts, arguments)
    said: Value = False
    if says:
        *results, truth = results
        said = truth.values.item()

    outputs, remaining = [], iter(results)
    for part in targets:
        row, tangents = part.start, part.rows_of_tangents()
        for leaf, shape in enumerate(part.shapes):
            result = next(remaining)
            outputs += map(Output, count(row), result.values.ravel())
            row += math.prod(shape)
            if leaf in tangents:
                tangent = np.zeros(shape) if result.tangent is None else result.tangent
                values = tangent.ravel().tolist()
                outputs += map(Output, count(tangents[leaf]), values)
    # What is in its row already stays there.
    changed = [
        output
        for output in outputs
        if not isinstance(output.value, Node)
        or (output.value.operation, output.value.arguments) != (INPUT, (output.row,))
    ]
    strides = {
        row + place: part.stride
        for part in (*sources, *targets)
        for leaf, row in part.rows_of_tangents().items()
        for place in range(math.prod(part.shapes[leaf]))
    }
    rows = Rows(layout.rows, layout.directions, strides)
    read = rows_read([*(output.value for output in changed), said], graph.calls)
    to = {output.row for output in changed}
    lanes = lanes_for(differentiated or layout.directions > 0)

    def written(name: str, lanes: int) -> tuple[Function, int]:
        vectors = vectors_of(lanes)
        return write_function(name, changed, said, rows, vectors, masked, graph.calls)

    if not of_few or lanes != PACK:
        return _Written(*written(name, lanes), read, to)
    ways, spare_rows = {}, []
    for width in PACK, HALF:
        own = f"{name}_{width}"
        ways[own], spare = written(own, width)
        spare_rows.append(spare)
    return _Written(write_choice(name, ways), max(spare_rows), read, to)
