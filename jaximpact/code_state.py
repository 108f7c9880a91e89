"""State of the code of users' classes: everything that they compute with.

A law in a user's file or notebook may take numbers from anywhere: from constants of its
module and of others, closures, defaults, class attributes, arrays, functions that call
functions. `walk` goes through all of it, from the code objects that would run now to
the values that their names have now. The package and what it is built on are left out:
versions tell those.

A function that `importlib.import_module` or `getattr` would find is followed by the
strings in the code. What a law reads from elsewhere while it is traced, such as a file
or an environment variable, is not seen.
"""

import contextlib
import dataclasses
import dis
import functools
import hashlib
import importlib
import inspect
import linecache
import pickle
import sys
import types
from collections.abc import Iterable, Mapping
from typing import Any

import jax
import numpy as np

from ._jax_internals import Tracer
from ._packages import FOUNDATIONS, PACKAGE, is_installed, is_of_python, top_of

PLAIN = (type(None), bool, int, float, complex, str, bytes, type(...))
NOT_CODE = {
    *("__dict__", "__weakref__", "__module__", "__doc__", "__annotations__"),
    *("__abstractmethods__", "_abc_impl", "__abstractvars__", "__abstractclassvars__"),
    *("__dataclass_params__", "__dataclass_fields__", "__match_args__"),
    *("__parameters__", "__orig_bases__"),
    *("__firstlineno__", "__static_attributes__", "__annotate__", "__annotate_func__"),
    *("__annotations_cache__", "__qualname__", "__conditional_annotations__"),
}
"""Attributes of a class that no result depends on, or that are made from others."""

Atom = tuple[str, Any]
"""Kind and value of one thing that a class depends on, hashable."""


def walk(*roots) -> tuple[Atom, ...]:
    """List everything that users' classes, functions and objects compute with.

    Two lists of one process are equal if and only if nothing has changed between them.
    """
    walker = _Walker({top_of(kind.__module__) for root in roots for kind in _mro(root)})
    for root in roots:
        walker.visit(root, frozenset())
    return tuple(walker.atoms)


def digest(atoms: Iterable[Atom]) -> str:
    """Compute the SHA-256 of what `walk` lists.

    It is the same in every process: of a function the source counts, if it is known to
    be that of the code that runs, else its instructions.
    """
    summary = hashlib.sha256()
    for kind, value in atoms:
        if kind == "code":
            value = _source_of(value) or _instructions(value)
        elif kind == "identity":
            value = type(value).__qualname__
        summary.update(f"{kind} {value!r}\n".encode(errors="surrogatepass"))
    return summary.hexdigest()


def plain_values(atoms: Iterable[Atom]) -> dict[str, Any]:
    """Select the numbers and texts among what `walk` lists that have a name: constants
    of modules, functions and classes."""
    found, name = {}, None
    for kind, value in atoms:
        if name is not None and kind in ("bool", "int", "float", "complex", "str"):
            found[name] = value
        name = value if kind == "constant" else None
    return found


class _Walker:
    """Visits what values depend on, each once.

    Args:
        own: packages of which the roots are; they count as the user's wherever they
            are installed.
    """

    def __init__(self, own: set[str]):
        self.own = own - FOUNDATIONS
        self.atoms: list[Atom] = []
        self._seen: dict[Any, int] = {}
        self._kept: list = []

    def add(self, kind: str, value) -> None:
        self.atoms.append((kind, value))

    def visit(self, value, names: frozenset[str]) -> None:
        """Add a value and what it depends on.

        Args:
            names: those that the code that refers to it uses.
        """
        if isinstance(value, PLAIN):
            self.add(type(value).__name__, repr(value))
        elif isinstance(value, types.ModuleType):
            self._once((id(value), names), value, self._module, names)
        elif isinstance(value, np.ndarray | np.generic | jax.Array):
            self._array(value)
        else:
            self._once(id(value), value, self._other, names)

    def _once(self, key, value, visit, names: frozenset[str]) -> None:
        if key in self._seen:
            self.add("again", self._seen[key])
            return
        self._seen[key] = len(self._seen)
        self._kept.append(value)  # whose `id` must not be another's
        visit(value, names)

    def _named(self, values: Mapping, names: frozenset[str]) -> None:
        for name in sorted(values):
            self.add("constant", name)
            self.visit(values[name], names)

    def _module(self, module: types.ModuleType, names: frozenset[str]) -> None:
        if self._is_known(module.__name__):
            self.add("module", module.__name__)
        else:
            used = names & vars(module).keys()
            self._named({name: vars(module)[name] for name in used}, names)

    def _array(self, value) -> None:
        if isinstance(value, Tracer):
            self.add("identity", value)
            return
        array = np.asarray(value)
        if array.dtype.hasobject:
            self.visit(array.tolist(), frozenset())
            return
        content = hashlib.blake2b(np.ascontiguousarray(array).tobytes()).hexdigest()
        self.add("array", (array.dtype.str, array.shape, content))

    def _other(self, value, names: frozenset[str]) -> None:
        if name := self._in_library(value):
            self.add("library", name)
        elif isinstance(value, types.FunctionType):
            self._function(value)
        elif isinstance(value, type):
            self._class(value)
        elif isinstance(value, Mapping):
            for key in value:
                self.visit(key, names)
                self.visit(value[key], names)
        elif isinstance(value, tuple | list):
            self.add(type(value).__name__, len(value))
            for item in value:
                self.visit(item, names)
        elif isinstance(value, set | frozenset):
            for item in sorted(value, key=repr):
                self.visit(item, names)
        elif parts := _parts_of(value):
            for part in parts:
                self.visit(part, names)
        else:
            self._object(value)

    def _function(self, function: types.FunctionType) -> None:
        self.add("function", function.__qualname__)
        for value in (function.__defaults__, function.__kwdefaults__):
            self.visit(value, frozenset())
        for cell in function.__closure__ or ():
            try:
                content = cell.cell_contents
            except ValueError:  # not set yet
                continue
            self.visit(content, _names_in(function.__code__))
        self.visit(vars(function), frozenset())  # such as `__wrapped__`
        known = function.__globals__
        if self._is_known(known.get("__name__")):
            return
        self.add("code", function.__code__)
        names = _names_in(function.__code__)
        found = {name: known[name] for name in names if name in known}
        package = known.get("__package__") or ""
        for name in names - found.keys():
            # Imported inside the function: now, or else its numbers would be seen only
            # after the first call.
            for full in (name, f"{package}.{name}"):
                if name in _imports_in(function.__code__):
                    with contextlib.suppress(Exception):
                        importlib.import_module(full)
                if full in sys.modules:
                    found[name] = sys.modules[full]
        self._named(found, names)

    def _class(self, kind: type) -> None:
        for base in kind.__mro__:
            self.add("class", base.__qualname__)
            # One made by `exec` may say that it is of `builtins`.
            if not self._in_library(base):
                fields = vars(base).get("__dataclass_fields__", {})
                inside = vars(base).keys() - NOT_CODE - fields.keys()
                inside = {name: vars(base)[name] for name in inside}
                self.visit(list(fields.values()), frozenset())
                self._named(
                    {k: v for k, v in inside.items() if not _is_generated(v)},
                    frozenset(),
                )

    def _object(self, value) -> None:
        kind = type(value)
        self.add("object", f"{kind.__module__}.{kind.__qualname__}")
        if not self._is_known(kind.__module__) or kind.__module__.startswith(PACKAGE):
            self._once(id(kind), kind, lambda kind, _: self._class(kind), frozenset())
            slots = {name: getattr(value, name, None) for name in _slots(kind)}
            self.visit(_attributes(value) | slots, frozenset())
            return
        try:
            content = hashlib.blake2b(pickle.dumps(value)).hexdigest()
        except Exception:  # whatever an object does that is not made for it
            self.add("identity", value if _is_hashable(value) else id(value))
        else:
            self.add("content", content)

    def _in_library(self, value) -> str | None:
        """Return the name under which a library has a function, class or object."""
        module = getattr(value, "__module__", None)
        name = getattr(value, "__qualname__", None)
        if not (isinstance(module, str) and isinstance(name, str)):
            return None
        if not self._is_known(module) or "<" in name:
            return None
        found: Any = sys.modules.get(module)
        for part in name.split("."):
            found = getattr(found, part, None)
        return f"{module}.{name}" if found is value else None

    def _is_known(self, module: str | None) -> bool:
        """Tell whether a module is of this package, of Python, or of an installed
        package that is not the user's own."""
        if module is None or top_of(module) in self.own:
            return False
        return is_installed(module, getattr(sys.modules.get(module), "__file__", None))


def _is_generated(value) -> bool:
    """Tell whether a method was made by `dataclasses`, from fields that count."""
    return (
        isinstance(value, types.FunctionType)
        and value.__name__ in ("__init__", "__repr__", "__eq__", "__hash__")
        and value.__code__.co_filename == "<string>"
    )


def _mro(root) -> tuple[type, ...]:
    kind = root if isinstance(root, type) else type(root)
    return tuple(base for base in kind.__mro__ if not is_of_python(base.__module__))


def _parts_of(value) -> list:
    """List what a wrapper of functions is made of; nothing for other objects."""
    if isinstance(value, dataclasses.Field):
        return [value.name, value.default, value.default_factory, value.metadata]
    if isinstance(value, property):
        return [value.fget]
    if isinstance(value, functools.partial | functools.partialmethod):
        return [value.func, value.args, value.keywords]
    if isinstance(value, types.MethodType):
        return [value.__func__, value.__self__]
    if isinstance(value, staticmethod | classmethod):
        return [value.__func__]
    if isinstance(value, functools.cached_property):
        return [value.func]
    if callable(value) and hasattr(value, "__wrapped__"):
        # Such as `functools.lru_cache`, `jax.jit`, `jax.custom_jvp` with its rule
        inside = filter(callable, _attributes(value).values())
        return [value.__wrapped__, *inside]
    return []


def _attributes(value) -> dict[str, Any]:
    found = getattr(value, "__dict__", None)
    return found if isinstance(found, dict) else {}


def _slots(kind: type) -> list[str]:
    given = (vars(base).get("__slots__", ()) for base in kind.__mro__)
    slots = [[each] if isinstance(each, str) else list(each) for each in given]
    return [name for each in slots for name in each if name != "__weakref__"]


def _is_hashable(value) -> bool:
    try:
        hash(value)
    except TypeError:
        return False
    return True


@functools.lru_cache(maxsize=4096)
def _names_in(code: types.CodeType) -> frozenset[str]:
    """Return the names that code refers to, and its texts that may be some."""
    names = set(code.co_names) | set(code.co_freevars)
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            names |= _names_in(constant)
        elif isinstance(constant, str) and constant.replace(".", "").isidentifier():
            names.add(constant)
    return frozenset(names)


@functools.lru_cache(maxsize=4096)
def _imports_in(code: types.CodeType) -> frozenset[str]:
    """Return the modules that code imports while it runs."""
    steps = dis.get_instructions(code)
    return frozenset(step.argval for step in steps if step.opname == "IMPORT_NAME")


def _instructions(code: types.CodeType) -> tuple:
    """Everything that code does, without where it stands."""
    constants = [
        _instructions(c) if isinstance(c, types.CodeType) else _constant(c)
        for c in code.co_consts
    ]
    return code.co_code, tuple(constants), code.co_names, code.co_varnames


def _constant(value) -> str:
    if isinstance(value, frozenset):
        return f"frozenset {sorted(map(repr, value))}"
    return repr(value)


def _source_of(code: types.CodeType) -> str | None:
    """Return the source of code; None if it is not known to be that."""
    linecache.checkcache(code.co_filename)
    lines = linecache.getlines(code.co_filename)
    if code not in _codes_of("".join(lines), code.co_filename):
        return None
    return "".join(inspect.getblock(lines[code.co_firstlineno - 1 :]))


@functools.lru_cache(maxsize=64)
def _codes_of(text: str, file: str) -> frozenset[types.CodeType]:
    """Return all code objects that a file compiles to."""
    try:
        found, new = set(), [compile(text, file, "exec", dont_inherit=True)]
    except (SyntaxError, ValueError):
        return frozenset()
    while new:
        code = new.pop()
        found.add(code)
        new += [c for c in code.co_consts if isinstance(c, types.CodeType)]
    return frozenset(found)
