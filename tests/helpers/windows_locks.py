"""Stands in for `msvcrt`, of which locks on Windows are made; imported before the
package, it also hides `fcntl` from it. Where Windows removes no file that is open, this
does not say so."""

import fcntl
import os
import sys

LK_NBLCK = 2


def locking(descriptor, mode, count):
    """Lock bytes from the position on, or raise PermissionError."""
    assert mode == LK_NBLCK
    place = os.lseek(descriptor, 0, os.SEEK_CUR)
    try:
        fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB, count, place)
    except BlockingIOError:
        raise PermissionError(13, "Permission denied") from None


if "jaximpact" not in sys.modules:
    sys.modules["fcntl"], sys.modules["msvcrt"] = None, sys.modules[__name__]
