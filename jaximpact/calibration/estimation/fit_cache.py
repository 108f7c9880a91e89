"""Cache of finished fits in files, so that an interrupted study continues.

A file is named by a digest of all that the fit depends on: the same fit of the same
numbers with the same versions is read, and whatever has changed in the study or its
data is fitted again.
"""

import hashlib
import io
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ...backend.native_backend import installed
from ...io.files import make_directory
from ...store import Store
from ..problem.objective import Objective, Points
from .least_squares import Fits, Reason


class FitCache:
    """Cache of finished fits in a folder, which is made with the first fit.

    Args:
        folder: other files in it are left alone.
    """

    def __init__(self, folder: Path):
        self.folder = Path(folder)
        self._store = Store(self.folder)
        self._counting = threading.Lock()
        self.found = 0
        """Number of fits that were read instead of made."""

    def recall(
        self, objective: Objective, details: tuple, make: Callable[[], Fits]
    ) -> Fits:
        """Read a fit from its file, or make and keep it.

        Args:
            details: arrays, and objects told apart by `repr`, that the fit depends on
                beside the objective.
        """
        key = _digest(objective, details)
        stored = self._store.get("fit", key)
        if stored is not None:
            with self._counting:
                self.found += 1
            return _fits_of(stored)
        fits = make()
        make_directory(self.folder, option="the directory")
        self._store.put("fit", key, _as_bytes(fits))
        return fits

    def forget(self) -> None:
        """Remove all fits, of whatever study, and the folder once it is empty."""
        self._store.clear()


def _as_bytes(fits: Fits) -> bytes:
    buffer = io.BytesIO()
    reasons = np.array([reason.name for reason in fits.reasons])
    np.savez(buffer, *fits.points, reasons=reasons, steps=fits.steps)
    return buffer.getvalue()


def _fits_of(data: bytes) -> Fits:
    with np.load(io.BytesIO(data)) as stored:
        points = Points(*(stored[f"arr_{i}"] for i in range(len(Points._fields))))
        reasons = [Reason[str(name)] for name in stored["reasons"]]
        return Fits(points, reasons, stored["steps"])


def _digest(objective: Objective, details: tuple) -> str:
    digest = hashlib.sha256(repr((installed(), objective.engine.name)).encode())
    for part in (*objective.depends_on(), *details):
        if isinstance(part, np.ndarray):
            digest.update(repr((part.dtype.str, part.shape)).encode())
            digest.update(np.ascontiguousarray(part).tobytes())
        else:
            digest.update(repr(part).encode())
    return digest.hexdigest()
