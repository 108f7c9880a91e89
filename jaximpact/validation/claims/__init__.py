"""The paper's claims: what each says (claims.csv), and a function that judges it.

One module for each figure. A function takes datasets by name (`Study`) and gives a
`Judgement`; what it asks for stands as the criterion in claims.csv, which was written
down before anything was computed.
"""

import csv
from collections.abc import Callable
from importlib import resources
from typing import NamedTuple

from ..verdict import Judgement
from . import energy, figure_13, slope, sphericity, supplement


class Claim(NamedTuple):
    """A row of claims.csv."""

    id: str
    where: str
    claim: str
    criterion: str


def read_claims() -> dict[str, Claim]:
    """Every claim by its id."""
    text = resources.files(__package__).joinpath("claims.csv").read_text("utf-8")
    rows = csv.DictReader(text.splitlines())
    return {row["id"]: Claim(**row) for row in rows}


JUDGES: dict[str, Callable[..., Judgement]] = (
    supplement.OF_SETS
    | energy.CLAIMS
    | figure_13.CLAIMS
    | sphericity.CLAIMS
    | slope.CLAIMS
    | supplement.CLAIMS
)
"""Functions by the id of the claim that they judge."""
SLOPE_CLAIMS = tuple(slope.CLAIMS)
"""Those on runs down a slope, which have readings of their own."""

__all__ = ["JUDGES", "SLOPE_CLAIMS", "Claim", "read_claims"]
