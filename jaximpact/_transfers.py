"""Transfers to and from a device that the package itself makes."""

import contextlib
from collections.abc import Iterator

import jax


@contextlib.contextmanager
def own_transfers() -> Iterator[None]:
    """Let the package's transfers pass `jax.transfer_guard`, also as a decorator.

    A guard is there to find transfers that nobody meant. Whoever makes a soil of a
    number, or calls `simulate`, means that number to reach the device.
    """
    to_device = jax.transfer_guard_host_to_device("allow")
    with to_device, jax.transfer_guard_device_to_host("allow"):
        yield
