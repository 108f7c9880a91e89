"""Settings of NumPy, JAX and Python that the package makes as it computes."""

import contextlib
import gc
from collections.abc import Iterator

import numpy as np


def numpy_settings() -> np.errstate:
    """Make the settings that the package computes with, whatever the user's are.

    It is the decorator of what users call from Python, and of the commands. Under
    `numpy.seterr(all="raise")` a probability that underflows to 0, as it should, would
    end a calibration; libraries below compute such numbers too. Nothing is hidden that
    NumPy tells by itself.
    """
    return np.errstate(divide="warn", over="warn", under="ignore", invalid="warn")


@contextlib.contextmanager
def own_settings() -> Iterator[None]:
    """Let the package's own work pass the guards of JAX, also as a decorator.

    `jax.transfer_guard` is there to find transfers that nobody meant: whoever makes a
    soil of a number, or calls `simulate`, means that number to reach the device.
    `jax_numpy_rank_promotion` is there to find shapes that nobody meant.
    """
    import jax  # which the help of a command does not need

    to_device = jax.transfer_guard_host_to_device("allow")
    to_host = jax.transfer_guard_device_to_host("allow")
    with to_device, to_host, jax.numpy_rank_promotion("allow"):
        yield


@contextlib.contextmanager
def thread_settings() -> Iterator[None]:
    """Make the settings of JAX that a new thread does not take over from the one that
    starts it."""
    import jax

    with jax.enable_x64(True), own_settings():
        yield


@contextlib.contextmanager
def collector_paused() -> Iterator[None]:
    """Pause the collection of reference cycles, for code that makes none.

    Many rows make it run often, and so does a graph that is traced; it goes through all
    that is being built again and again, and takes a third of the time. And JAX has a
    callback in it: Ctrl-C that arrives there is reported as ignored, and is lost.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()
