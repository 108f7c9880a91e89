"""An impact as an operation of JAX, in processes of their own: over several devices,
and from programs that JAX has kept."""

import os
import subprocess
import sys

import pytest
from paths import ROOT

pytestmark = pytest.mark.slow

COMMON = """
import functools
import jax
jax.config.update("jax_enable_x64", True)
import jax.numpy as jnp
import numpy as np
from jaximpact import Block, Impact, Soil, simulate

def rebound(c_v, speed):
    impact = Impact(speed=speed, angle=0.4, orientation=0.3)
    return simulate(Block(), Soil(c_v=c_v), impact, accuracy="fast").e_n

c_v, speed = jnp.linspace(0.5, 1.0, 22), jnp.linspace(5.0, 25.0, 22)
"""

SHARDED = """
from jax.sharding import AxisType, PartitionSpec as P

assert len(jax.devices()) == 2
mesh = jax.make_mesh((2,), ("lanes",), axis_types=(AxisType.Auto,))
over = functools.partial(jax.shard_map, mesh=mesh, out_specs=P("lanes"))
both = over(in_specs=(P("lanes"), P("lanes")))
one = over(in_specs=(P(), P("lanes")))
derivative = jax.grad(rebound)
expected = rebound(c_v, speed)
by_c_v = jax.jit(jax.vmap(derivative))(c_v, speed)

def same(found, expected):
    np.testing.assert_array_equal(np.asarray(found), np.asarray(expected))

same(both(rebound)(c_v, speed), expected)
same(jax.jit(both(jax.vmap(rebound)))(c_v, speed), expected)
same(jax.jit(both(jax.vmap(derivative)))(c_v, speed), by_c_v)
of_sum = jax.grad(lambda c_v: jnp.sum(both(jax.vmap(rebound))(c_v, speed)))
same(jax.jit(of_sum)(c_v), by_c_v)
# A parameter that all devices have in common
same(jax.jit(one(rebound))(0.8, speed), rebound(0.8, speed))
summed = jax.grad(lambda c_v: jnp.sum(one(rebound)(c_v, speed)))(0.8)
alone = jnp.sum(jax.vmap(derivative, (None, 0))(0.8, speed))
# Sums in another order
np.testing.assert_allclose(summed, alone, rtol=1e-14)
"""

KEPT = """
hits = []
jax.monitoring.register_event_listener(lambda event, **_: hits.append(event))
program = jax.jit(jax.vmap(jax.value_and_grad(rebound)))
value, derivative = program(c_v, speed)
print(np.asarray(value).tobytes().hex(), np.asarray(derivative).tobytes().hex())
print(sum(event == "/jax/compilation_cache/cache_hits" for event in hits))
"""

EXPORTED = """
import pathlib
import re
from jax import export

derivative = jax.jit(jax.vmap(jax.value_and_grad(rebound), (None, 0)))
some = jax.ShapeDtypeStruct(export.symbolic_shape("lanes"), float)
text = derivative.lower(0.8, some).as_text()
path = pathlib.Path("exported")
if path.exists():
    program = export.deserialize(bytearray(path.read_bytes()))
else:
    names = set(re.findall(r"jaximpact_[0-9a-f]{32}", text))
    allowed = [export.DisabledSafetyCheck.custom_call(name) for name in names]
    program = export.export(derivative, disabled_checks=allowed)(0.8, some)
    path.write_bytes(program.serialize())
value, slope = program.call(0.8, speed)
np.testing.assert_array_equal(value, rebound(0.8, speed))
print(np.asarray(value).tobytes().hex(), np.asarray(slope).tobytes().hex())
"""


def run(text: str, **variables: str) -> list[str]:
    """Runs Python and gives what it printed."""
    done = subprocess.run(
        [sys.executable, "-c", COMMON + text],
        env=os.environ | variables,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def test_over_several_devices():
    run(SHARDED, XLA_FLAGS="--xla_force_host_platform_device_count=2")


def test_programs_that_jax_has_kept(tmp_path):
    """Another process finds them, and the operation that they call."""
    kept = {
        "JAX_COMPILATION_CACHE_DIR": str(tmp_path),
        "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0",
        "JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES": "-1",
    }
    (first, _), (second, hits) = run(KEPT, **kept), run(KEPT, **kept)
    assert second == first
    assert int(hits) > 0


def test_an_exported_program_runs_in_another_process(tmp_path, monkeypatch):
    """It has to lower such a program, and to compute none, before."""
    pytest.importorskip("flatbuffers")
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    monkeypatch.chdir(tmp_path)
    first, second = run(EXPORTED, PYTHONPATH=path), run(EXPORTED, PYTHONPATH=path)
    assert first == second
