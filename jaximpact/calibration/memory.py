"""Fits that are finished, kept in files, so that a study that was cut short goes on.

The same fit, of the same numbers with the same versions, is not made again. A file is
named by a digest of all that the fit depends on, so whatever is changed in between, in
the study or in its data, is fitted anew.
"""

import contextlib
import hashlib
import re
import threading
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..engines.machine import installed
from ..formats.files import make_directory, replacing
from .least_squares import Fits
from .objective import Objective, Points
from .stopping import Reason

SUFFIX = ".npz"
KEPT = re.compile(r"\.?[0-9a-f]{64}(\.[0-9]+\.partial)?\.npz")
"""Names of fits, and of those that a kill left half-written."""


class Memory:
    """Finished fits in a folder, which is made when there is one to keep.

    Args:
        folder: whatever else it holds is left alone.
    """

    def __init__(self, folder: Path):
        self.folder = Path(folder)
        self._counting = threading.Lock()
        self.found = 0
        """Fits that were there and needed not be made."""

    def recall(
        self, objective: Objective, details: tuple, make: Callable[[], Fits]
    ) -> Fits:
        """A fit from its file, or made and kept.

        Args:
            details: arrays, and what `repr` tells apart, that the fit depends on beside
                the objective.
        """
        path = self.folder / (_digest(objective, details) + SUFFIX)
        # What cannot be read is made anew.
        with contextlib.suppress(OSError, KeyError, ValueError, zipfile.BadZipFile):
            fits = _read(path)
            with self._counting:
                self.found += 1
            return fits
        fits = make()
        make_directory(self.folder, option="the directory")
        with replacing(path) as temporary:
            np.savez(
                temporary,
                *fits.points,
                reasons=np.array([reason.name for reason in fits.reasons]),
                steps=fits.steps,
            )
        return fits

    def forget(self) -> None:
        """Remove all fits, of whatever study, and the folder if that leaves it
        empty."""
        with contextlib.suppress(OSError):
            for path in self.folder.iterdir():
                if KEPT.fullmatch(path.name):
                    path.unlink()
            self.folder.rmdir()


def _read(path: Path) -> Fits:
    with open(path, "rb") as file, np.load(file) as stored:
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
