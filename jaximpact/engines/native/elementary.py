"""Elementary functions in vector arithmetic.

Reductions of the argument and polynomials are those of fdlibm (Sun Microsystems, 1993),
with the cases taken by selection. Errors are below two units in the last place, of the
tangent below four, and of its inverse below two and a half. Numbers
below the smallest normal one count as zero, as they do in XLA's programs on CPU.
"""

import math

from .graph import Graph, Value, bits_of

ROUNDER = 1.5 * 2.0**52
"""Added, it rounds a float to an integer, found in its lowest bits."""
SMALLEST = 2.0**-1022
SIGN = -(2**63)
LOG2_HIGH, LOG2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10
# The three add up to pi / 2.
QUARTERS = (1.5707963267948966, 6.123233995736766e-17, -1.4973849048591833e-33)
LOG_TERMS = (
    6.666666666666735130e-01,
    3.999999999940941908e-01,
    2.857142874366239149e-01,
    2.222219843214978396e-01,
    1.818357216161805012e-01,
    1.531383769920937332e-01,
    1.479819860511658591e-01,
)
SINE_TERMS = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
COSINE_TERMS = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)
ARC_TERMS = (
    3.33333333333329318027e-01,
    -1.99999999998764832476e-01,
    1.42857142725034663711e-01,
    -1.11111104054623557880e-01,
    9.09088713343650656196e-02,
    -7.69187620504482999495e-02,
    6.66107313738753120669e-02,
    -5.83357013379057348645e-02,
    4.97687799461593236017e-02,
    -3.65315727442169155270e-02,
    1.62858201153657823623e-02,
)
EXP_TERMS = tuple(1.0 / math.factorial(n) for n in range(2, 14))


def _polynomial(graph: Graph, x: Value, terms: tuple[float, ...]) -> Value:
    """The sum of `terms[n] x**n`, by pairs, so that few operations wait for others."""
    values = list(terms)
    while len(values) > 1:
        pairs = [
            graph.apply("fused", values[i + 1], x, values[i])
            for i in range(0, len(values) - 1, 2)
        ]
        values = pairs + values[2 * len(pairs) :]
        if len(values) > 1:
            x = graph.apply("multiply", x, x)
    return values[0]


def exp(graph: Graph, x: Value) -> Value:
    """Exponential."""
    at = graph.apply
    rounded = at("fused", x, 1.0 / math.log(2.0), ROUNDER)
    count = at("subtract", rounded, ROUNDER)
    rest = at("fused", count, -LOG2_HIGH, x)
    rest = at("fused", count, -LOG2_LOW, rest)
    bend = _polynomial(graph, rest, EXP_TERMS)
    power = at("add", at("fused", at("multiply", rest, rest), bend, rest), 1.0)
    shifted = at("shift_left", at("to_bits", rounded), 52)
    result = at("from_bits", at("integer_add", at("to_bits", power), shifted))
    result = graph.choose(at("less", x, -708.3964185322641), 0.0, result)
    return graph.choose(at("less", 709.782712893384, x), math.inf, result)


def log(graph: Graph, x: Value) -> Value:
    """Natural logarithm."""
    at = graph.apply
    bits = at("to_bits", x)
    exponent = at(
        "shift_right", at("integer_subtract", bits, bits_of(math.sqrt(0.5))), 52
    )
    part = at("from_bits", at("integer_subtract", bits, at("shift_left", exponent, 52)))
    count = at("to_float", exponent)
    f = at("subtract", part, 1.0)
    s = at("divide", f, at("add", f, 2.0))
    z = at("multiply", s, s)
    rest = at("multiply", z, _polynomial(graph, z, LOG_TERMS))
    half = at("multiply", at("multiply", f, f), 0.5)
    small = at("multiply", s, at("add", half, rest))
    small = at("fused", count, LOG2_LOW, small)
    result = at("subtract", half, small)
    result = at("subtract", f, result)
    result = at("fused", count, LOG2_HIGH, result)
    result = graph.choose(at("equal", x, math.inf), x, result)
    outside = graph.choose(
        at("less", at("magnitude", x), SMALLEST), -math.inf, math.nan
    )
    return graph.choose(at("at_most", SMALLEST, x), result, outside)


def _quarter_turns(graph: Graph, x: Value) -> tuple[Value, Value, Value]:
    """Sine and cosine of what is left of an angle after whole quarter turns, and the
    number of these."""
    at = graph.apply
    rounded = at("fused", x, 2.0 / math.pi, ROUNDER)
    count = at("subtract", rounded, ROUNDER)
    rest = x
    for part in QUARTERS:
        rest = at("fused", count, -part, rest)
    z = at("multiply", rest, rest)
    sine = at(
        "fused",
        at("multiply", z, rest),
        _polynomial(graph, z, SINE_TERMS),
        rest,
    )
    half = at("multiply", z, 0.5)
    most = at("subtract", 1.0, half)
    lost = at("subtract", at("subtract", 1.0, most), half)
    cosine = at(
        "fused",
        at("multiply", z, z),
        _polynomial(graph, z, COSINE_TERMS),
        lost,
    )
    return sine, at("add", most, cosine), at("to_bits", rounded)


def _signed(graph: Graph, value: Value, turns: Value) -> Value:
    """With the other sign in the third and fourth quarter."""
    at = graph.apply
    sign = at("shift_left", at("bits_and", turns, 2), 62)
    return at("from_bits", at("bits_differ", at("to_bits", value), sign))


def _is_odd(graph: Graph, turns: Value) -> Value:
    return graph.apply("integer_equal", graph.apply("bits_and", turns, 1), 1)


def sin(graph: Graph, x: Value) -> Value:
    """Sine, of angles up to 1e9."""
    sine, cosine, turns = _quarter_turns(graph, x)
    return _signed(graph, graph.choose(_is_odd(graph, turns), cosine, sine), turns)


def cos(graph: Graph, x: Value) -> Value:
    """Cosine, of angles up to 1e9."""
    sine, cosine, turns = _quarter_turns(graph, x)
    value = graph.choose(_is_odd(graph, turns), sine, cosine)
    return _signed(graph, value, graph.apply("integer_add", turns, 1))


def atan(graph: Graph, x: Value) -> Value:
    """Arc tangent."""
    at = graph.apply
    size = at("magnitude", x)
    steep = at("less", math.tan(3.0 * math.pi / 8.0), size)
    middle = at("less", math.tan(math.pi / 8.0), size)
    top = graph.choose(middle, at("subtract", size, 1.0), size)
    bottom = graph.choose(middle, at("add", size, 1.0), 1.0)
    t = at(
        "divide",
        graph.choose(steep, -1.0, top),
        graph.choose(steep, size, bottom),
    )
    z = at("multiply", t, t)
    bend = at("multiply", z, _polynomial(graph, z, ARC_TERMS))

    def base(whole: float) -> Value:
        return graph.choose(steep, whole, graph.choose(middle, 0.5 * whole, 0.0))

    rest = at("subtract", at("multiply", t, bend), base(QUARTERS[1]))
    angle = at("subtract", base(QUARTERS[0]), at("subtract", rest, t))
    sign = at("bits_and", at("to_bits", x), SIGN)
    return at("from_bits", at("bits_or", at("to_bits", angle), sign))


def tan(graph: Graph, x: Value) -> Value:
    """Tangent, of angles up to 1e9."""
    return graph.apply("divide", sin(graph, x), cos(graph, x))


def cbrt(graph: Graph, x: Value) -> Value:
    """Cube root."""
    at = graph.apply
    size = at("magnitude", x)
    guess = exp(graph, at("multiply", log(graph, size), 1.0 / 3.0))
    square = at("multiply", guess, guess)
    over = at("fused", square, guess, at("negate", size))
    better = at("subtract", guess, at("divide", over, at("multiply", square, 3.0)))
    regular = at("and", at("less", 0.0, guess), at("less", guess, math.inf))
    root = graph.choose(regular, better, guess)
    sign = at("bits_and", at("to_bits", x), SIGN)
    return at("from_bits", at("bits_or", at("to_bits", root), sign))
