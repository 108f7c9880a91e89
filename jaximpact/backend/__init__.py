"""Engines that run the integration: machine code of our own, or XLA's programs.

Engines have names: machine code, or diffrax with one of its solvers.
"""

from typing import TYPE_CHECKING, NamedTuple, Union

from ..errors import InputError, nearest

if TYPE_CHECKING:  # which takes a while to load
    import diffrax

MACHINE_CODE, DIFFRAX = ENGINES = "machine code", "diffrax"
XLA = "XLA"
"""Name, in results, of what computes where there is no machine code."""


class Engine(NamedTuple):
    """A way to compute impacts."""

    name: str
    solver: "diffrax.AbstractAdaptiveSolver | None" = None
    """Solver that takes the steps; None for the package's method."""

    @property
    def is_machine_code(self) -> bool:
        """Tell whether machine code is asked for; else diffrax integrates."""
        return self.name == MACHINE_CODE


NATIVE = Engine(MACHINE_CODE)


def get_engine(engine: Union[str, "diffrax.AbstractAdaptiveSolver"]) -> Engine:
    """Find an engine by its name, or by a solver of diffrax.

    Raises InputError for an unknown name, with the nearest known, and for a solver that
    cannot be used.
    """
    if isinstance(engine, str) and engine in ENGINES:
        return Engine(engine)
    import diffrax

    from ..integrator.diffrax_solvers import usable_solver

    if isinstance(engine, diffrax.AbstractSolver):
        return Engine(f"{DIFFRAX}, {type(engine).__name__}", usable_solver(engine))
    if isinstance(engine, type) and issubclass(engine, diffrax.AbstractSolver):
        raise InputError(
            f"engine is the class {engine.__name__}; need a solver made of it, "
            f"{engine.__name__}()"
        )
    near = nearest(engine, ENGINES)
    hint = f"; did you mean {near!r}?" if near else ""
    raise InputError(
        f"engine must be one of {', '.join(ENGINES)}, or a solver of diffrax, but "
        f"{engine!r} was given{hint}"
    )
