"""Settings of all tests: double precision, no programs kept from run to run, and
property tests that repeat exactly; and a directory for tests of commands."""

import os
import tempfile

import jax
import pytest
from hypothesis import settings

jax.config.update("jax_enable_x64", True)

# The commands keep what they compile; not in the home of whoever runs the tests.
_CACHE = tempfile.TemporaryDirectory(prefix="jaximpact-tests-")
os.environ["XDG_CACHE_HOME"] = _CACHE.name

# The first example of a property compiles, which no deadline allows for; a seed of its
# own each run would make failures come and go.
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty working directory."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
