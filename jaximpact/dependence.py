"""Which results of a traced function depend on one of its arguments."""

from ._jax_internals import Jaxpr, Literal, called


def depends(jaxpr: Jaxpr, varied: list[bool]) -> list[bool]:
    """For each result whether it may change, to first order, with the arguments that
    are varied.

    True may be too much: of an operation that is not looked into all results count.
    """
    changes = {
        var for var, is_varied in zip(jaxpr.invars, varied, strict=True) if is_varied
    }

    def may_change(atom) -> bool:
        return not isinstance(atom, Literal) and atom in changes

    for equation in jaxpr.eqns:
        inputs = [may_change(atom) for atom in equation.invars]
        if not any(inputs) or equation.primitive.name == "stop_gradient":
            continue
        results = [True] * len(equation.outvars)
        if (inner := called(equation)) is not None:
            results = depends(inner.jaxpr, inputs)
        changes |= {
            var for var, yes in zip(equation.outvars, results, strict=True) if yes
        }
    return [may_change(atom) for atom in jaxpr.outvars]
