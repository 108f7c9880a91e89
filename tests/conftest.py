"""Settings of all tests: double precision, no programs kept from run to run, garbage
that is collected seldom, and property tests that repeat exactly; and a directory for
tests of commands."""

import functools
import gc
import os
import sys
import tempfile

import jax
import pytest
from hypothesis import settings
from text_files import write_changed

from jaximpact.backend.xla_compilation import keep_programs

jax.config.update("jax_enable_x64", True)

# Compiling is most of the time. What one worker of pytest-xdist, command or notebook
# has compiled the others find: in a directory of the session, which workers inherit,
# not in the home of whoever runs the tests.
if "PYTEST_XDIST_WORKER" not in os.environ:
    _CACHE = tempfile.TemporaryDirectory(prefix="jaximpact-tests-")
    os.environ["XDG_CACHE_HOME"] = _CACHE.name
keep_programs()
# Those of single operations too, which JAX keeps only if they took a second: a sixth of
# the time.
jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)

# Programs that are traced and kept are millions of objects, through which Python's
# collector would go again and again: a twentieth of the time for next to no memory.
gc.set_threshold(50_000, 10, 20)

# The first example of a property compiles, which no deadline allows for; a seed of its
# own each run would make failures come and go.
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")

# JAX keeps the lowered form of each program, and with it a context of MLIR: the more of
# them there are, the longer another one takes, a fifth of a second at 500. They are
# private to JAX, so that later versions may have others, or none.
_LOWERED = [
    getattr(sys.modules.get("jax._src.pjit"), "_pjit_lower", None),
    getattr(
        sys.modules.get("jax._src.interpreters.pxla"), "_cached_lowering_to_hlo", None
    ),
]


def pytest_runtest_teardown():
    """Drop lowered forms of what a test has compiled; the programs stay."""
    for kept in _LOWERED:
        getattr(kept, "cache_clear", lambda: None)()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty working directory."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """An empty directory for what is compiled."""
    from jaximpact.store import open_cache

    monkeypatch.setenv("JAXIMPACT_CACHE_DIR", str(tmp_path / "cache"))
    open_cache.cache_clear()
    yield tmp_path / "cache"
    open_cache.cache_clear()


@pytest.fixture(scope="session")
def slope_results(tmp_path_factory):
    """The study of `slope_study`, computed once for all tests."""
    # A late import: the settings above come first.
    from slope_study import slope_results_in

    return slope_results_in(tmp_path_factory.mktemp("slope"))


@pytest.fixture(scope="session")
def twin(tmp_path_factory):
    """The calibration of `calibrated_twin`, computed once for all tests."""
    from calibrated_twin import calibrated_twin

    return calibrated_twin(tmp_path_factory.mktemp("twin"))


@pytest.fixture
def slope(folder, request):
    """The study `SLOPE` of the test's module, as slope.toml in an empty directory."""
    path = folder / "slope.toml"
    path.write_text(request.module.SLOPE)
    return path


@pytest.fixture
def changed(slope, request):
    """A function that writes that study with replacements, pairs of texts, and gives
    its path."""
    return functools.partial(write_changed, slope, request.module.SLOPE)
