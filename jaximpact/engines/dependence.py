"""Which results of a traced function depend on one of its arguments."""

import jax

_CALLS = {"jit": "jaxpr", "pjit": "jaxpr", "custom_jvp_call": "call_jaxpr"}


def depends(jaxpr: jax.extend.core.Jaxpr, varied: list[bool]) -> list[bool]:
    """For each result whether it may change, to first order, with the arguments that
    are varied.

    True may be too much: of an operation that is not looked into all results count.
    """
    changes = {
        var for var, is_varied in zip(jaxpr.invars, varied, strict=True) if is_varied
    }

    def may_change(atom) -> bool:
        return not isinstance(atom, jax.extend.core.Literal) and atom in changes

    for equation in jaxpr.eqns:
        inputs = [may_change(atom) for atom in equation.invars]
        if not any(inputs) or equation.primitive.name == "stop_gradient":
            continue
        results = [True] * len(equation.outvars)
        if equation.primitive.name in _CALLS:
            inner = equation.params[_CALLS[equation.primitive.name]]
            results = depends(inner.jaxpr, inputs)
        changes |= {
            var for var, yes in zip(equation.outvars, results, strict=True) if yes
        }
    return [may_change(atom) for atom in jaxpr.outvars]
