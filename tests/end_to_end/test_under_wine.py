"""Machine code for Windows, run where Wine and a compiler for Windows are installed: in
a program of C, since no Python for Windows is at hand."""

import os
import shutil
import subprocess

import jax
import numpy as np
import pytest
from paths import HELPERS

from jaximpact import Block, Impact, Scene, Soil
from jaximpact.backend import native_backend, operation
from jaximpact.backend.simd import KernelSet, kernel
from jaximpact.backend.simd.driver import Operation, Program, driver_text
from jaximpact.backend.simd.object_files import module_of
from jaximpact.backend.simd.target import Target, host
from jaximpact.impact.problem import Assembly
from jaximpact.impact.reduced_models import MODELS

COMPILER = "x86_64-w64-mingw32-gcc"
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not shutil.which("wine"), reason="needs Wine"),
    pytest.mark.skipif(not shutil.which(COMPILER), reason="needs MinGW"),
]
LANES = 200


class AsCoff(Target):
    object_triple = property(lambda self: self.triple)


def compiled_for_windows(monkeypatch):
    """The model's kernel, and object files of it and of the driver for Windows."""
    texts, compile_functions = [], kernel.compile_functions

    def noted(functions, *how):
        texts.append(module_of(functions))
        return compile_functions(functions, *how)

    monkeypatch.setattr(kernel, "compile_functions", noted)
    monkeypatch.setattr(native_backend, "kept_code", lambda what, tree, make: make())
    scene = Scene(Block(mass=500.0, aspect_ratio=2.0), Soil(), Impact(speed=15.0))
    assembly = Assembly(jax.tree.structure(scene), MODELS[-1], ledger=True)
    here = native_backend.compile_native.__wrapped__(assembly)
    target = AsCoff("x86_64-pc-windows-msvc", *host())
    files = {
        "kernel.o": target.object_file(texts[-1], external_calls=False),
        "driver.o": target.object_file(driver_text("x86"), external_calls=True),
    }
    return scene, here, files


def offsets(structure, *names):
    return {name: getattr(structure, name).offset for name in names}


def test_windows_gives_the_same_bits(tmp_path, monkeypatch):
    scene, here, files = compiled_for_windows(monkeypatch)
    tolerance, floor = 1e-4, 1e-6
    leaves, structure = jax.tree.flatten(scene)
    common = np.array([*map(float, leaves), tolerance, floor])
    places = [jax.tree.unflatten(structure, range(len(leaves))).impact.speed]
    lanes = [np.linspace(1.0, 40.0, LANES), np.arange(LANES) * 1.0, np.zeros(LANES)]
    called = KernelSet([here])
    expected = operation.call(called, common, places, lanes[:1], *lanes[1:])

    inside = Operation(count=1, leaves=here.code.common_inputs)
    inside.programs[0] = Program.from_buffer_copy(here.layout)
    of_program = offsets(Program, "begin", "step", "finish")
    defined = {
        **{"operation": len(bytes(inside)), "common": len(common)},
        **{"lanes": LANES, "rows": here.code.result_rows},
        **offsets(Operation, "create_thread", "wait", "close"),
        **{n: Operation.programs.offset + of_program[n] for n in of_program},
    }
    for name, data in files.items():
        (tmp_path / name).write_bytes(data)
    command = [COMPILER, *(f"-D{n.upper()}={value}" for n, value in defined.items())]
    command += [HELPERS / "windows_host.c", *files, "-o", "host.exe"]
    # MinGW has a name of its own for the function that touches a large frame.
    command.append("-Wl,--defsym=__chkstk=___chkstk_ms")
    subprocess.run(command, cwd=tmp_path, check=True)
    environment = os.environ | {"WINEDEBUG": "-all", "WINEPREFIX": str(tmp_path / "w")}
    for inside.threads in (1, 3):
        operands = np.concatenate([common, places, *lanes])
        (tmp_path / "input").write_bytes(bytes(inside) + operands.tobytes())
        done = subprocess.run(
            ["wine", "host.exe"], cwd=tmp_path, env=environment, capture_output=True
        )
        assert done.returncode == 0, (done.stdout, done.stderr)
        assert (tmp_path / "output").read_bytes() == np.array(expected).tobytes()
        (tmp_path / "output").unlink()
