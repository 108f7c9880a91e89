"""How arithmetic is written: quotients by inverses, sums with products in one
instruction.

A division takes the time of some ten products. So a quotient is written as a product
with the inverse of its divisor, which all quotients by it share; and the inverse of a
product, a quotient or a choice is put together from those of its parts. A sum takes the
product in it along.

How a value is written depends on what it is made of alone, and never on what else is
worked out beside it: code with derivatives, or with a ledger, gives the same values to
the last bit as code without.

What comes out differs from the rounded quotient by a few roundings. For finite operands
it is a number where that is, but where an inverse leaves the range of normal numbers:
there zero by next to nothing is NaN.
"""

from .graph import Node, Value

MAY_BE_PRODUCTS = {"multiply", "divide", "negate", "choose_float", "magnitude"}
"""Operations of a product, or of what may hand one on as it is."""


def is_quotient(node: Node) -> bool:
    """Whether a node is written as a product with an inverse. A value by itself is not:
    that is one exactly."""
    return node.operation == "divide" and node.arguments[0] is not node.arguments[1]


def parts_to_invert(value: Node) -> tuple[Value, ...]:
    """What has to be inverted for the inverse of a value; nothing if the value is no
    product, quotient or choice."""
    if value.operation == "multiply":
        return value.arguments
    if value.operation == "divide":
        return value.arguments[:1]
    if value.operation == "choose_float":
        return value.arguments[1:]
    return ()


def product_in(node: Node) -> int | None:
    """Place among the operands of a sum or difference of the product that goes into one
    instruction with it, which rounds once; None if none does.

    Not where both operands may be products: what is zero by symmetry would become the
    rounding of one of them, and the first steps noise.
    """
    if node.operation not in ("add", "subtract"):
        return None
    may_be = [
        isinstance(operand, Node) and operand.operation in MAY_BE_PRODUCTS
        for operand in node.arguments
    ]
    if sum(may_be) != 1:
        return None
    place = may_be.index(True)
    return place if node.arguments[place].operation == "multiply" else None
