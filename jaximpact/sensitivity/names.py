"""What is varied and what is watched, by the names of the tables."""

from collections.abc import Iterable

from ..errors import InputError
from ..formats.checks import checked_names
from ..formats.columns import (
    RESULT_COLUMNS,
    InputColumn,
    ResultColumn,
    columns_of,
)
from ..formats.datasets import OUTPUT_COLUMNS
from ..scene import Scene

USUAL_PARAMETERS = ("c_v", "gamma_v", "k_E")
DEFAULT_OUTPUTS = tuple(RESULT_COLUMNS)
WATCHED = {name: c for name, c in OUTPUT_COLUMNS.items() if name != "steps"}
"""The numbers that belong to the impact, not to how it was computed."""


def default_parameters(scene: Scene) -> tuple[str, ...]:
    """Of the parameters that matter with the usual laws those that the scene has."""
    columns = columns_of(scene)
    found = tuple(name for name in USUAL_PARAMETERS if name in columns)
    if not found:
        raise InputError(
            f"parameters must be named, as the scene's laws have none of "
            f"{', '.join(USUAL_PARAMETERS)}"
        )
    return found


def parameter_columns(scene: Scene, names: Iterable[str]) -> tuple[InputColumn, ...]:
    """The columns of parameters of a scene. Raises InputError for a name that is
    unknown or stands twice, and for none."""
    columns = columns_of(scene)
    names = checked_names("parameter", names, columns)
    return tuple(columns[name] for name in names)


def output_columns(names: Iterable[str]) -> tuple[ResultColumn, ...]:
    """The columns of outputs. Raises InputError as `parameter_columns` does."""
    return tuple(WATCHED[name] for name in checked_names("output", names, WATCHED))
