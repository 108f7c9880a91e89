"""Settings of all tests: double precision, and property tests that repeat exactly."""

import jax
from hypothesis import settings

jax.config.update("jax_enable_x64", True)

# The first example of a property compiles, which no deadline allows for; a seed of its
# own each run would make failures come and go.
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")
