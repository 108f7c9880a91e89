"""Laws and shapes that a table of a TOML file names."""

from collections.abc import Mapping
from pathlib import Path

from ..errors import InputError
from ..parameters import Composite, parts_of
from .scenes import part_named, replaced_parts
from .toml_values import typed


def with_named_parts(
    path: Path, where: str, table: Mapping, whole: Composite
) -> Composite:
    """A soil or a block with the laws or the shape that a table names; its other keys
    are passed over.

    Args:
        path: of the file, from whose directory files of laws are looked for.
        where: name of the table.

    Raises InputError, naming file and key, for a name that cannot be used.
    """
    found = {}
    for slot in parts_of(type(whole)):
        if slot in table:
            key = f"{where}.{slot}"
            text = typed(path, {key: table[slot]}, key, str)
            try:
                found[slot] = part_named(slot, text, path.parent)
            except InputError as error:
                raise InputError(str(error), file=path, key=key) from error
    try:
        return replaced_parts(whole, found)
    except InputError as error:
        raise InputError(str(error), file=path, key=where) from error
