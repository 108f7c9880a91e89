"""Structure of the package: layers of imports, lengths of modules, documented public
names, and documentation that names only what exists."""

import ast
import contextlib
import functools
import graphlib
import importlib
import importlib.util
import inspect
import io
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from paths import DOCS, ROOT

import jaximpact
import jaximpact.runout
from jaximpact.cli import main

LAYERS = """
    _public_names
    errors _types _tables _safe _checks _jax_internals _settings _precision units
    _module _fixed_fields _packages interruption progress progress_lines file_locks
    store finding code_state parameters identity accuracy
    shapes laws part_checks scene
    quantities scene_quantities
    impact restitution
    integrator
    backend
    io
    plotting
    reports
    result
    tasks
    simulation
    batch lazy sweeping parametric_sets impact_response second_derivatives
    rebound
    calibration
    sensitivity
    lookup
    runout
    cli __main__
"""
"""Rooms of the package, from below: a module imports from its own room, from rooms of
lower lines, and from rooms that stand to the left in its own line."""

ROOMS = {room: place for place, room in enumerate(LAYERS.split())}

PUBLIC = (
    *("jaximpact", "jaximpact.calibration", "jaximpact.errors", "jaximpact.laws"),
    *("jaximpact.lookup", "jaximpact.parameters"),
    *("jaximpact.plotting", "jaximpact.rebound", "jaximpact.runout"),
    *("jaximpact.sensitivity", "jaximpact.shapes"),
)

LONGEST_MODULE = 600
"""Lines of a module beyond which nobody reads it in one go."""

PAGES = sorted(
    page
    for page in [*ROOT.glob("*.md"), *DOCS.rglob("*.md"), *ROOT.glob("*/README.md")]
    # The changelog names what was, and Sphinx writes pages of its own.
    if page.name != "CHANGELOG.md" and "_build" not in page.parts
)


def modules():
    """File of each module of the package, by the module's name."""
    found = {}
    for path in sorted((ROOT / "jaximpact").rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        found[".".join(parts).removesuffix(".__init__")] = path
    return found


@functools.cache
def imports():
    """Modules that each module imports, anywhere in it: late imports and those for type
    checkers count too."""
    known = modules()
    found = {name: set() for name in known}
    for name, path in known.items():
        package = name if path.name == "__init__.py" else name.rpartition(".")[0]
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                imported = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                base = "." * node.level + (node.module or "")
                base = importlib.util.resolve_name(base, package)
                submodules = [f"{base}.{alias.name}" for alias in node.names]
                imported = [sub if sub in known else base for sub in submodules]
            else:
                continue
            found[name].update({*imported} & {*known} - {name})
    return found


def room_of(module):
    return module.split(".")[1] if "." in module else "__init__"


def test_every_room_has_its_layer():
    assert {room_of(name) for name in modules()} - {"__init__"} == {*ROOMS}


def test_imports_point_downwards():
    """The package's own front, `jaximpact/__init__.py`, is above every room."""
    places = ROOMS | {"__init__": len(ROOMS)}
    upwards = [
        f"{name} imports {other}"
        for name, others in imports().items()
        for other in others
        if places[room_of(other)] > places[room_of(name)]
    ]
    assert not upwards


@pytest.mark.parametrize("depth", [2, 3, 9])
def test_imports_make_no_circle(depth):
    """Neither among rooms, nor among their inner rooms, nor among modules."""

    def room(name):
        return ".".join(name.split(".")[:depth])

    graph = {room(name): set() for name in imports()}
    for name, others in imports().items():
        graph[room(name)] |= {room(other) for other in others} - {room(name)}
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        pytest.fail(" <- ".join(error.args[1]))


@pytest.mark.parametrize("package", [jaximpact, jaximpact.runout])
def test_type_checkers_see_the_names_that_load_lazily(package):
    stub = Path(package.__file__).with_suffix(".pyi").read_text(encoding="utf-8")
    told = {
        alias.name: "." * node.level + (node.module or "")
        for node in ast.parse(stub).body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    assert sorted(told) == package.__all__
    assert {*told} <= {*dir(package)}
    for name, place in told.items():
        module = importlib.import_module(place, package.__name__)
        assert getattr(package, name) is getattr(module, name)
    with pytest.raises(AttributeError, match=f"'{package.__name__}' has no attribute"):
        package.nothing  # noqa: B018


def test_what_is_slow_to_load_is_loaded_late():
    """Signals are served before NumPy loads. JAX takes a second, in which `--help` is
    shown; a setting that it refuses is told in one line, and it may be set up after
    the package is imported. Matplotlib takes half a second in each worker of a fit."""
    code = """
import sys, jaximpact
assert "numpy" not in sys.modules
import jaximpact.cli
assert "jax" not in sys.modules
import jaximpact.calibration
assert "matplotlib" not in sys.modules
from jaximpact.runout import ClosedForm, FullModel, Profile, Release, simulate_runout
assert not {"matplotlib", "pandas", "xarray"} & {*sys.modules}
from jaximpact.runout import *
"""
    float32 = os.environ | {"JAX_ENABLE_X64": "0"}
    subprocess.run([sys.executable, "-c", code], cwd=ROOT, env=float32, check=True)


def test_modules_are_short():
    lengths = {
        name: len(path.read_text(encoding="utf-8").splitlines())
        for name, path in modules().items()
    }
    assert {n: k for n, k in lengths.items() if k > LONGEST_MODULE} == {}


def public_names():
    """Classes and functions that users import, each once, with its module."""
    found = {}
    for name in PUBLIC:
        module = importlib.import_module(name)
        for attribute in getattr(module, "__all__", None) or vars(module):
            value = getattr(module, attribute)
            ours = getattr(value, "__module__", "").startswith("jaximpact")
            documented = inspect.isroutine(value) or inspect.isclass(value)
            if documented and ours and not attribute.startswith("_"):
                found.setdefault(value, f"{name}.{attribute}")
    return {name: value for value, name in found.items()}


def test_public_names_are_documented():
    """Each with a first line that is a sentence by itself."""
    first = {
        name: (value.__doc__ or "").strip().partition("\n")[0]
        for name, value in public_names().items()
    }
    assert {n: line for n, line in first.items() if not line.endswith(".")} == {}


@pytest.fixture(params=PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def page(request):
    return request.param


def test_pages_name_files_that_exist(page):
    """Paths in code spans that begin with a folder of the repository or the package."""
    text = page.read_text(encoding="utf-8")
    tops = ROOT, ROOT / "jaximpact"
    folders = {path.name for top in tops for path in top.iterdir()}
    named = [
        path
        for path in re.findall(r"`([\w-]+/[\w./-]*)`", text)
        if path.partition("/")[0] in folders
    ]
    places = *tops, page.parent
    missing = [p for p in named if not any((place / p).exists() for place in places)]
    assert not missing


def exists(name):
    """Whether a dotted name is a module, or leads to something in one."""
    parts = name.split(".")
    for cut in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:cut]))
        except ModuleNotFoundError:
            continue
        return all(
            (found := getattr(found, part, None)) is not None for part in parts[cut:]
        )
    return False


def test_pages_name_modules_that_exist(page):
    """Dotted names, `jaximpact.room.name`, and what is imported from them."""
    text = page.read_text(encoding="utf-8")
    named = {*re.findall(r"(?<![\w./-])jaximpact(?:\.[A-Za-z_]\w*)+", text)}
    for module, inside, line in re.findall(
        r"^\s*from (jaximpact[\w.]*) import (?:\(([^)]*)\)|(.*))$", text, re.M
    ):
        names = re.sub(r"#.*| as \w+", "", inside or line)
        named |= {f"{module}.{name}" for name in re.findall(r"\w+", names)}
    assert not [name for name in sorted(named) if not exists(name)]


@functools.cache
def help_of(*command):
    """Help of a command; None if there is no such command."""
    with contextlib.redirect_stdout(io.StringIO()) as out:
        try:
            refused = main([*command, "--help"])
        except SystemExit:
            refused = 0
    return None if refused else out.getvalue()


def test_pages_name_commands_that_exist(page):
    """`jaximpact COMMAND --option`, in code spans and console blocks."""
    text = page.read_text(encoding="utf-8").replace("\\\n", " ")
    blocks = re.findall(r"^```(?:console|bash|sh)\n(.*?)^```", text, re.M | re.S)
    named = re.findall(r"^(?:\$ )?jaximpact ([a-z]+)(.*)", "\n".join(blocks), re.M)
    named += re.findall(r"`jaximpact ([a-z]+)([^`]*)`", text)
    missing = []
    for command, rest in named:
        shown = help_of(command)
        options = re.findall(r"(?<!\S)--[a-z][a-z-]*", rest)
        if shown is None or not all(option in shown for option in options):
            missing.append(f"{command} {rest}")
    assert not missing
