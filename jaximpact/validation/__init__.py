"""The model against what others have published: the paper's claims, and laws."""

from .run import Validation, validate
from .verdict import Finding, Judgement, Verdict

__all__ = ["Finding", "Judgement", "Validation", "Verdict", "validate"]
