r"""Rodas5P: a stiffly accurate Rosenbrock method of order 5, in diffrax's interface.

Each stage of a step from $y_0$ by $h$ is one linear solve with the same matrix,

$$ (I - h\gamma J)\, u_i = h\gamma\, f\Bigl(y_0 + \sum_{j<i} a_{ij} u_j\Bigr)
   + \gamma \sum_{j<i} C_{ij} u_j, \qquad J = \partial f/\partial y\,(y_0), $$

and $y_1 = y_0 + \sum_j a_{8j} u_j + u_8$, with $u_8$ the error estimate of the embedded
method of order 4. L-stable, no iteration: what a step computes is explicit arithmetic,
so its derivatives are exact derivatives of the step.

Three things matter for speed and for gradients:

* The stage equation is not divided by h. Under `vmap` lanes that have finished take
  steps of h = 0; a division would be masked in the value and give NaN in the gradient.
* The matrix is factorised by unrolled elimination without pivoting, which fuses over
  lanes; LAPACK is called once a lane. Entries that are zero by structure are left out
  when the program is built: pass `pattern`, True where J may differ from zero.
* Only autonomous systems: f must not depend on t.

Coefficients: Steinebach (2023), BIT Numer. Math. 63:27,
https://doi.org/10.1007/s10543-023-00967-x, in the form of Hairer and Wanner.
"""

import functools
import operator
from collections.abc import Callable
from typing import ClassVar

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.custom_derivatives import SymbolicZero
from jax.extend.core import jaxpr_as_fun
from jaxtyping import Array, Float

ORDER = 5
GAMMA = 0.21193756319429014
# Rows i = 2..6 of a_ij; stages 7 and 8 start from stage 6 plus u_6, and plus u_7.
STAGE_WEIGHTS = (
    (),
    (3.0,),
    (2.849394379747939, 0.45842242204463923),
    (-6.954028509809101, 2.489845061869568, -10.358996098473584),
    (2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641),
    (
        -7.502846399306121,
        2.561846144803919,
        -11.627539656261098,
        -0.18268767659942256,
        0.030198172008377946,
    ),
)
COUPLING = (
    (),
    (-14.155112264123755,),
    (-17.97296035885952, -2.859693295451294),
    (147.12150275711716, -1.41221402718213, 71.68940251302358),
    (165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306),
    (
        24.854864614690072,
        -3.0009227002832186,
        47.4931110020768,
        5.5814197821558125,
        -0.6610691825249471,
    ),
    (
        30.91273214028599,
        -3.1208243349937974,
        77.79954646070892,
        34.28646028294783,
        -19.097331116725623,
        -28.087943162872662,
    ),
    (
        37.80277123390563,
        -3.2571969029072276,
        112.26918849496327,
        66.9347231244047,
        -40.06618937091002,
        -54.66780262877968,
        -9.48861652309627,
    ),
)
DENSE_WEIGHTS = np.array(
    [
        [
            25.948786856663858,
            -2.5579724845846235,
            10.433815404888879,
            -2.3679251022685204,
            0.524948541321073,
            1.1241088310450404,
            0.4272876194431874,
            -0.17202221070155493,
        ],
        [
            -9.91568850695171,
            -0.9689944594115154,
            3.0438037242978453,
            -24.495224566215796,
            20.176138334709044,
            15.98066361424651,
            -6.789040303419874,
            -6.710236069923372,
        ],
        [
            11.419903575922262,
            2.8879645146136994,
            72.92137995996029,
            80.12511834622643,
            -52.072871366152654,
            -59.78993625266729,
            -0.15582684282751913,
            4.883087185713722,
        ],
    ]
)


def _matrix(rows) -> np.ndarray:
    matrix = np.zeros((len(COUPLING), len(COUPLING)))
    for i, row in enumerate(rows):
        matrix[i, : len(row)] = row
    return matrix


STAGE_MATRIX = _matrix(
    (*STAGE_WEIGHTS, (*STAGE_WEIGHTS[-1], 1.0), (*STAGE_WEIGHTS[-1], 1.0, 1.0))
)
COUPLING_MATRIX = GAMMA * _matrix(COUPLING)


def per_width(change: Array | np.ndarray, width: Array) -> Array:
    """Change over a step divided by its width; 0 for a step of no width."""
    return jnp.where(width == 0.0, 0.0, change / jnp.where(width == 0.0, 1.0, width))


class DenseOutput(diffrax.AbstractLocalInterpolation):
    r"""Interpolant of order 4 over one step.

    With $s = (t - t_0)/(t_1 - t_0)$:
    $y = (1-s) y_0 + s\,(y_1 + (1-s)(k_1 + s (k_2 + s k_3)))$.
    """

    t0: Float[Array, ""]
    t1: Float[Array, ""]
    y0: Float[Array, " n"]
    y1: Float[Array, " n"]
    change: Float[Array, " n"]
    """y1 less y0, without the rounding of either: the last step before an end may be so
    short that a difference would leave few digits of the rates."""
    k: Float[Array, "3 n"]
    bend_at_end: Float[Array, " n"]
    """Sum of the three k: by itself it costs a third of what they do."""

    def evaluate(self, t0, t1=None, left=True):
        del left
        if t1 is not None:
            return self.evaluate(t1) - self.evaluate(t0)
        # A finished lane has a step of no width; it is read at its start.
        s = per_width(t0 - self.t0, self.t1 - self.t0)
        bend = self.k[0] + s * (self.k[1] + s * self.k[2])
        return (1.0 - s) * self.y0 + s * (self.y1 + (1.0 - s) * bend)

    def rate(self, s: float) -> Float[Array, " n"]:
        """Compute the rate of change at a fraction of the step; 0 for a step of no
        width."""
        bend = self.k[0] + s * (self.k[1] + s * self.k[2])
        turn = self.k[1] + 2.0 * s * self.k[2]
        slope = self.change + (1.0 - 2.0 * s) * bend + s * (1.0 - s) * turn
        return per_width(slope, self.t1 - self.t0)

    def rate_at_end(self) -> Float[Array, " n"]:
        """Compute the rate of change at t1; 0 for a step of no width."""
        return per_width(self.change - self.bend_at_end, self.t1 - self.t0)


def factorise(rows: list[dict[int, Array]]) -> tuple[list[dict[int, Array]], list]:
    """Compute LU factors without pivoting, by rows; entries that are absent are zero.

    Args:
        rows: a dictionary column -> entry for each row, the diagonal included.

    Returns:
        The factors in the same form (L below the diagonal, U on and above it) and the
        inverse pivots.
    """
    rows = [dict(row) for row in rows]
    inverse_pivots = []
    for pivot, pivot_row in enumerate(rows):
        inverse_pivots.append(1.0 / pivot_row[pivot])
        for row in rows[pivot + 1 :]:
            if pivot not in row:
                continue
            row[pivot] = row[pivot] * inverse_pivots[pivot]
            for j, upper in pivot_row.items():
                if j > pivot:
                    product = row[pivot] * upper
                    row[j] = row[j] - product if j in row else -product
    return rows, inverse_pivots


def substitute(rows, inverse_pivots, right_hand_side: list[Array]) -> list[Array]:
    """Solve the factorised system for one right-hand side.

    What is worked out last enters each sum last, so that little waits for it: a step
    takes 2 % less time.
    """
    x = list(right_hand_side)
    for i, row in enumerate(rows):
        *early, last = [row[j] * x[j] for j in sorted(row) if j < i] or [None]
        if early:
            x[i] = x[i] - functools.reduce(operator.add, early)
        if last is not None:
            x[i] = x[i] - last
    for i, row in reversed(list(enumerate(rows))):
        for j in sorted(row, reverse=True):
            if j > i:
                x[i] = x[i] - row[j] * x[j]
        x[i] = x[i] * inverse_pivots[i]
    return x


@jax.custom_jvp
def solve(
    matrix: list[dict[int, Array]], factors: tuple[list, list], right_hand_side: list
) -> list[Array]:
    r"""Solve a system $W u = r$ whose factors are known.

    Its derivative is that of the equation, $W \dot u = \dot r - \dot W u$, which needs
    none of the factors: a tenth fewer operations in derivatives of a step.
    """
    return substitute(*factors, right_hand_side)


@functools.partial(solve.defjvp, symbolic_zeros=True)
def _solve_jvp(primals, tangents):
    matrix, factors, right_hand_side = primals
    changes, _, steps = tangents
    x = solve(matrix, factors, right_hand_side)
    remaining = []
    for row, step in zip(changes, steps, strict=True):
        left = jnp.zeros_like(x[0]) if isinstance(step, SymbolicZero) else step
        for j, change in row.items():
            if not isinstance(change, SymbolicZero):
                left = left - change * x[j]
        remaining.append(left)
    return x, solve(matrix, factors, remaining)


def jacobian_columns(f, y: list[Array]) -> list[list[Array]]:
    """Compute columns of df/dy, each by forward differentiation in one variable.

    One variable at a time, so that the program holds no arithmetic on tangents that are
    zero by structure; the parts that columns share are merged by the compiler.
    """
    columns = []
    for j, y_j in enumerate(y):

        def in_one_variable(value, j=j):
            return f([*y[:j], value, *y[j + 1 :]])

        _, column = jax.jvp(in_one_variable, (y_j,), (jnp.ones_like(y_j),))
        columns.append(column)
    return columns


def traced(f, rows: list[Array]):
    """Trace a function of rows; what is returned does the same, and its Python code
    runs no more. A step of a reduced model is traced in two thirds of the time."""
    of_rows = jaxpr_as_fun(jax.make_jaxpr(f)(rows))
    return lambda rows: of_rows(*rows)


def rodas5p_step(f, y0: Array, step_size: Array, pattern):
    """Take one step.

    Args:
        f: right-hand side, a list of n rows to a list of n rows; rows have the shape
            of `step_size`, whose axes are lanes that f treats one by one.
        y0: state `(n, ...)`.
        step_size: h, shape `(...)`; 0 leaves the state as it is.
        pattern: `pattern[i][j]` is True where df_i/dy_j may differ from zero.

    Returns:
        `y1`, the error estimate, and the eight stage increments `(8, n, ...)`.
    """
    scaled = step_size * GAMMA
    rows = list(y0)
    f = traced(f, rows)
    columns = jacobian_columns(f, rows)

    def entry(i, j):
        return (1.0 if i == j else 0.0) - scaled * columns[j][i]

    order = range(len(rows))
    matrix = [{j: entry(i, j) for j in order if pattern[i][j] or i == j} for i in order]
    factors = factorise(jax.lax.stop_gradient(matrix))

    # A loop, not eight copies of f, and in it a jitted function: XLA and the compiler
    # of machine code each compile it once.
    @jax.jit
    def increment(y, coupled):
        right = [scaled * rate + c for rate, c in zip(f(list(y)), coupled, strict=True)]
        return jnp.stack(solve(matrix, factors, right))

    def stage(i, stages):
        y = y0 + jnp.tensordot(jnp.asarray(STAGE_MATRIX)[i], stages, 1)
        coupled = jnp.tensordot(jnp.asarray(COUPLING_MATRIX)[i], stages, 1)
        return stages.at[i].set(increment(y, coupled))

    stages = jnp.zeros((len(COUPLING), *y0.shape), y0.dtype)
    stages = jax.lax.fori_loop(0, len(COUPLING), stage, stages)
    return y0 + change_over(stages), stages[-1], stages


def change_over(stages: Array) -> Array:
    """Compute the change of the state over a step, from the increments of its
    stages."""
    return jnp.tensordot(jnp.asarray(STAGE_MATRIX)[-1], stages, 1) + stages[-1]


def dense_output(y0: Array, y1: Array, stages: Array) -> dict[str, Array]:
    """Compute the coefficients of `DenseOutput` for a step, beside its times."""
    k, bend_at_end = (
        jnp.tensordot(jnp.asarray(weights), stages, 1)
        for weights in (DENSE_WEIGHTS, DENSE_WEIGHTS.sum(axis=0))
    )
    return dict(y0=y0, y1=y1, change=change_over(stages), k=k, bend_at_end=bend_at_end)


class Rodas5P(diffrax.AbstractAdaptiveSolver):
    """Rosenbrock method of order 5(4), L-stable, for autonomous stiff systems.

    The state must be one vector. `pattern[i][j]` is True where df_i/dy_j may differ
    from zero; None means everywhere.
    """

    pattern: tuple[tuple[bool, ...], ...] | None = eqx.field(default=None, static=True)

    term_structure: ClassVar = diffrax.ODETerm
    interpolation_cls: ClassVar[Callable[..., DenseOutput]] = DenseOutput

    def order(self, terms):
        del terms
        return ORDER

    def init(self, terms, t0, t1, y0, args):
        del terms, t0, t1, y0, args
        return None

    def func(self, terms, t0, y0, args):
        return terms.vf(t0, y0, args)

    def step(self, terms, t0, t1, y0, args, solver_state, made_jump):
        del made_jump
        size = y0.shape[0]
        pattern = np.array(self.pattern or np.ones((size, size), bool))

        def f(rows):
            return list(terms.vf(t0, jnp.stack(rows), args))

        y1, error, stages = rodas5p_step(f, y0, terms.contr(t0, t1), pattern)
        dense = dense_output(y0, y1, stages)
        return y1, error, dense, solver_state, diffrax.RESULTS.successful
