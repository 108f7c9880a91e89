"""Machine code that comes with the package is that of its source, and no other."""

import shutil
import sys

import jax
import numpy as np
import pytest
from impact_scenes import mixed_scenes

from jaximpact import Block, Impact, Soil, simulate
from jaximpact.accuracy import PRESETS
from jaximpact.backend import lane_functions, native_backend, shipped
from jaximpact.backend.simd import LEVELS, Kernel, KernelSet, Mode, host
from jaximpact.identity import described
from jaximpact.impact.problem import Assembly, naming
from jaximpact.impact.reduced_models import PLANAR, VERTICAL
from jaximpact.impact.results import empty_summary
from jaximpact.scene import Scene
from jaximpact.shapes import EllipticCylinder

STRUCTURE = jax.tree.structure(Scene())


def named(*impact):
    what, tree = naming(*impact)
    return what, described(tree)


VALUES = named(Assembly(STRUCTURE, VERTICAL, False), Mode.VALUES, False)

for_this_machine = pytest.mark.skipif(
    host()[0] not in LEVELS or not sys.platform.startswith("linux"),
    reason="code is shipped for Linux and for levels of x86",
)


@pytest.fixture
def opened_anew(monkeypatch):
    """Archives are opened, and their source looked at, as by a new process."""
    shipped.names_in_archive.cache_clear()
    yield monkeypatch
    monkeypatch.undo()
    shipped.names_in_archive.cache_clear()


@pytest.mark.parametrize("level", LEVELS)
def test_archives_are_those_of_the_source(level):
    held = shipped.names_in_archive(level)
    assert held, "run `make machine-code`"
    names = {shipped.name_of(*named(*impact)) for impact in shipped.usual_impacts()}
    assert held == {*names, shipped.MANIFEST}


@for_this_machine
@pytest.mark.parametrize(
    ("model", "mode"),
    [
        (VERTICAL, Mode.VALUES),
        pytest.param(VERTICAL, Mode.FORWARD, marks=pytest.mark.slow),
        pytest.param(PLANAR, Mode.FORWARD, marks=pytest.mark.slow),
        pytest.param(PLANAR, Mode.REVERSE, marks=pytest.mark.slow),
    ],
)
def test_what_is_shipped_is_what_is_compiled(model, mode):
    """To the last bit: values, derivatives by k_E, gamma_v and c_v, and the gradient of
    the sum of all results by all leaves."""
    assembly = Assembly(STRUCTURE, model, False)
    setting = PRESETS["fast"]
    leaves = [*jax.tree.leaves(mixed_scenes(300)), setting.tolerance, setting.floor]
    inputs = np.stack(np.broadcast_arrays(*leaves))
    places = jax.tree.unflatten(STRUCTURE, range(STRUCTURE.num_leaves)).soil
    along = ()
    if mode == Mode.FORWARD:
        along = places.k_E, places.gamma_v, places.c_v
    if mode == Mode.REVERSE:
        count = jax.tree.structure(empty_summary(False)).num_leaves
        inputs = np.concatenate([inputs, np.ones((count, inputs.shape[1]))])

    def computed(code):
        kernels = KernelSet([Kernel(code, None)]).along(len(along))
        return kernels.compute(inputs, 1, along=along)[0]

    code = shipped.shipped_code(*named(assembly, mode, False))
    assert code is not None
    made = lane_functions.code_of_lanes(assembly, mode, sampled=False)
    results = computed(code)
    assert np.isfinite(results).mean() > 0.5
    np.testing.assert_array_equal(results, computed(made))


@for_this_machine
def test_usual_scenes_compile_nothing(cache, monkeypatch):
    """Neither values nor derivatives, alone or many; other shapes do, where no test has
    left their code in the cache."""

    def compiled(*_, **__):
        raise AssertionError("compiled")

    monkeypatch.setattr(lane_functions, "code_of_lanes", compiled)
    native_backend.compile_native.cache_clear()
    from jaximpact.backend import kernel_choice

    monkeypatch.setattr(kernel_choice, "_kernel_sets", {})
    simulate(Block(), Soil(), Impact(angle=0.3))
    simulate(Block(), Soil(), Impact(angle=0.3), history=True)
    jax.grad(lambda k: simulate(Block(), Soil(k_E=k), Impact()).e_n)(900.0)
    assert simulate(mixed_scenes(10)).e_n.shape == (10,)
    with pytest.raises(AssertionError, match="compiled"):
        simulate(Block(shape=EllipticCylinder()), Soil(), Impact())


@for_this_machine
def test_code_of_another_source_is_not_used(opened_anew, tmp_path):
    assert shipped.shipped_code(*VALUES) is not None
    shipped.names_in_archive.cache_clear()
    root = shutil.copytree(shipped.ROOT, tmp_path / "jaximpact")
    opened_anew.setattr(shipped, "ROOT", root)
    assert shipped.shipped_code(*VALUES) is not None
    for name in "laws/flow.py", "integrator/rosenbrock.py", "backend/simd/llvm_ir.py":
        file = root / name
        content = file.read_text()
        file.write_text(content + "\n")
        shipped.names_in_archive.cache_clear()
        assert shipped.shipped_code(*VALUES) is None
        file.write_text(content)
    file.unlink()
    shipped.names_in_archive.cache_clear()
    assert shipped.shipped_code(*VALUES) is None


@pytest.mark.parametrize("damage", ["missing", "cut short", "no archive"])
def test_damaged_archives_count_as_none(opened_anew, tmp_path, damage):
    level, path = next(iter(LEVELS)), shipped.ARCHIVES
    content = (path / f"{level}.zip").read_bytes()
    contents = {"missing": None, "cut short": content[:-100], "no archive": b"version"}
    opened_anew.setattr(shipped, "ARCHIVES", tmp_path)
    if contents[damage] is not None:
        (tmp_path / f"{level}.zip").write_bytes(contents[damage])
    assert not shipped.names_in_archive(level)


@pytest.mark.parametrize(
    ("platform", "level"),
    [("win32", "x86-64-v3"), ("darwin", "apple-m1"), ("linux", "znver9")],
)
def test_other_machines_compile(monkeypatch, platform, level):
    monkeypatch.setattr(sys, "platform", platform)
    monkeypatch.setattr(shipped, "host", lambda: (level, ""))
    assert shipped.shipped_code(*VALUES) is None
