"""The model against what others have published: the paper's claims, and laws."""

from .findings import Validation
from .run import validate
from .verdict import Finding, Judgement, Verdict

__all__ = ["Finding", "Judgement", "Validation", "Verdict", "validate"]
