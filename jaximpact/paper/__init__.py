"""The model against what others have published: the paper's claims, and laws."""

from .criteria import Finding, Judgement, Verdict
from .report import Validation
from .validation import validate

__all__ = ["Finding", "Judgement", "Validation", "Verdict", "validate"]
