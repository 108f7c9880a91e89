"""Which quotients are written as products with inverses.

A division takes the time of some ten products. So several quotients by one divisor
share its inverse, and the inverse of a product, a quotient or a choice is put together
from the inverses of its parts, where these are wanted anyway. What comes out differs
from the quotient by a few roundings. It is the same for finite operands but where an
inverse leaves the range of normal numbers: there zero by next to nothing is NaN.
"""

from collections import Counter

from .graph import INPUT, Node, Value


def parts_of(value: Node) -> tuple[Value, ...]:
    """What has to be inverted for the inverse of a value; nothing if the value is no
    product, quotient or choice."""
    if value.operation == "multiply":
        return value.arguments
    if value.operation == "divide":
        return value.arguments[:1]
    if value.operation == "choose_float":
        return value.arguments[1:]
    return ()


def _is_quotient(node: Node) -> bool:
    """Whether a node divides, but not a value by itself: that is one exactly."""
    return node.operation == "divide" and node.arguments[0] is not node.arguments[1]


class Divisors:
    """What nodes divide by."""

    def __init__(self, nodes: list[Node]):
        divisors = [node.arguments[1] for node in nodes if _is_quotient(node)]
        self._wanted = {id(divisor) for divisor in divisors}
        self._splits: dict[int, bool] = {}
        self._uses = Counter(id(divisor) for divisor in divisors)
        for divisor in {id(d): d for d in divisors if self.splits(d)}.values():
            self._uses.update(id(part) for part in parts_of(divisor))

    def splits(self, value: Value) -> bool:
        """Whether the inverse of a value is put together from those of its parts."""
        if not isinstance(value, Node):
            return False
        known = self._splits.get(id(value))
        if known is None:
            parts = parts_of(value)
            known = bool(parts) and all(map(self._is_at_hand, parts))
            self._splits[id(value)] = known
        return known

    def _is_at_hand(self, part: Value) -> bool:
        """Whether the inverse of a part costs nothing, or next to nothing: inputs are
        the same for all that a step does."""
        return (
            not isinstance(part, Node)
            or part.operation == INPUT
            or id(part) in self._wanted
            or self.splits(part)
        )

    def inverted(self, node: Node) -> bool:
        """Whether a node is a quotient to be written as a product."""
        if not _is_quotient(node):
            return False
        divisor = node.arguments[1]
        return (
            not isinstance(divisor, Node)
            or self.splits(divisor)
            or self._uses[id(divisor)] > 1
        )
