"""The laws that the package has besides the usual ones."""

import dataclasses

from jaximpact import Soil
from jaximpact.finding import shipped
from jaximpact.parameters import parts_of


def other_laws() -> list[tuple[str, type]]:
    """What each is for, and its class."""
    usual = {field.name: field.default_factory for field in dataclasses.fields(Soil)}
    return [
        (slot, kind)
        for slot, base in parts_of(Soil).items()
        for kind in shipped(base)
        if kind is not usual[slot]
    ]
