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
import contextvars
import dataclasses
import functools
import hashlib
import importlib
import inspect
import io
import linecache
import operator
import pickle
import re
import sys
import types
import weakref
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ._jax_internals import Tracer
from ._packages import FOUNDATIONS, PACKAGE, is_installed, is_of_python, top_of
from .finding import codes_of, imported_in

PLAIN = (type(None), bool, int, float, complex, str, bytes, type(...))
NOT_CODE = {
    *("__dict__", "__weakref__", "__module__", "__doc__", "__annotations__"),
    *("__abstractmethods__", "_abc_impl", "__abstractvars__", "__abstractclassvars__"),
    *("__dataclass_params__", "__dataclass_fields__", "__match_args__"),
    *("__parameters__", "__orig_bases__", "__slotnames__"),
    *("__firstlineno__", "__static_attributes__", "__annotate__", "__annotate_func__"),
    *("__annotations_cache__", "__qualname__", "__conditional_annotations__"),
}
"""Attributes of a class that no result depends on, or that are made from others."""

WRAPPERS: dict[type, Callable[[Any], list]] = {
    dataclasses.Field: lambda f: [f.name, f.default, f.default_factory, f.metadata],
    property: lambda wrapper: [wrapper.fget],
    functools.partial: lambda wrapper: [wrapper.func, wrapper.args, wrapper.keywords],
    types.MethodType: lambda method: [method.__func__, method.__self__],
    staticmethod: lambda method: [method.__func__],
    classmethod: lambda method: [method.__func__],
    functools.cached_property: lambda wrapper: [wrapper.func],
    functools.singledispatchmethod: lambda wrapper: [wrapper.dispatcher, wrapper.func],
    weakref.ref: lambda reference: [reference()],
    contextvars.ContextVar: lambda variable: [variable.get()],
    memoryview: lambda view: [view.tobytes()],
    operator.attrgetter: lambda getter: [*getter.__reduce__()],
    # These hold their content weakly, as that of `functools.singledispatch`.
    weakref.WeakKeyDictionary: lambda cache: [type(cache)],
    weakref.WeakValueDictionary: lambda cache: [type(cache)],
    weakref.WeakSet: lambda cache: [type(cache)],
}
WRAPPERS[functools.partialmethod] = WRAPPERS[functools.partial]
"""What wraps functions or values -> its parts."""
BY_ANY_NAME = {"getattr", "vars", "globals", "eval", "exec", "__dict__"}
"""Names in code that may read a name which stands nowhere."""
BY_TEXT = {"import_module", "__import__"}
"""Functions that import a module that a text names."""
CONTENT: dict[type, Callable] = {
    Mapping: lambda value: [part for pair in value.items() for part in pair],
    set: lambda value: set(value),
    frozenset: lambda value: set(value),
    tuple: lambda value: list(tuple.__iter__(value)),
    list: lambda value: list(list.__iter__(value)),
    float: float.__repr__,
    int: int.__repr__,
    complex: complex.__repr__,
    str: str.__str__,
    bytes: bytes.__repr__,
    np.ndarray: np.asarray,
}
"""What objects of classes that derive from those of Python have beside attributes."""

Atom = tuple[str, Any]
"""Kind and value of one thing that a class depends on, hashable."""


def walk(*roots) -> tuple[Atom, ...]:
    """List everything that users' classes, functions and objects compute with.

    Two lists of one process are equal if and only if nothing has changed between them.
    """
    walker = _Walker({top_of(kind.__module__) for root in roots for kind in _mro(root)})
    for root in roots:
        walker.visit(root)
    walker.visit_modules()
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
    constants, name = {}, None
    for kind, value in atoms:
        if name is not None and kind in ("bool", "int", "float", "complex", "str"):
            constants[name] = value
        name = value if kind == "constant" else None
    return constants


class _Walker:
    """Visits what values depend on, each once. Packages of which the roots are count as
    the user's wherever they are installed."""

    def __init__(self, own: set[str]):
        self.own = own - FOUNDATIONS
        self.atoms: list[Atom] = []
        self._seen: dict[int, int] = {}
        self._kept: list = []
        self._names: set[str] = set()
        self._modules: dict[types.ModuleType, set[str]] = {}

    def add(self, kind: str, value) -> None:
        self.atoms.append((kind, value))

    def visit(self, value) -> None:
        """Add a value and what it depends on, but for what modules have."""
        kind = type(value)
        if kind in PLAIN:
            self.add(kind.__name__, repr(value))
            if kind is str:
                self._names.update(value.split("."))
        elif kind is np.ndarray or isinstance(value, np.generic | jax.Array):
            self._array(value)
        elif id(value) in self._seen:
            self.add("again", self._seen[id(value)])
        else:
            self._seen[id(value)] = len(self._seen)
            self._kept.append(value)  # whose `id` must not be another's
            self._other(value)

    def visit_modules(self) -> None:
        """Add what the modules that were found have under the names that were found.

        Which code reads which module is not known: a module may be an argument, an
        attribute or an item.
        """
        more = True
        while more:
            more = False
            for module, done in [*self._modules.items()]:
                inside = vars(module)
                named = inside.keys() if self._names & BY_ANY_NAME else self._names
                # Of what Python itself puts into a module, only the function for
                # names that are not there counts.
                names = {name for name in named if not name.startswith("__")}
                names = (names | {"__getattr__"}) & inside.keys() - done
                done |= names
                more = more or bool(names)
                self._named({name: inside[name] for name in names})

    def _named(self, values: Mapping) -> None:
        for name in sorted(values):
            self.add("constant", name)
            self.visit(values[name])

    def _array(self, value) -> None:
        if isinstance(value, Tracer):
            self.add("identity", value)
            return
        if jnp.issubdtype(value.dtype, jax.dtypes.prng_key):  # of random numbers
            value = jax.random.key_data(value)
        array = np.asarray(value)
        if array.dtype.hasobject:
            self.visit(array.tolist())
            return
        content = hashlib.blake2b(np.ascontiguousarray(array).tobytes()).hexdigest()
        self.add("array", (array.dtype.str, array.shape, content))

    def _other(self, value) -> None:
        kind = type(value)
        if isinstance(value, types.ModuleType):
            self.visit(kind)
            if self._is_known(value.__name__):
                self.add("module", value.__name__)
            else:
                self._modules.setdefault(value, set())
        elif self._is_of_user(kind) and not isinstance(value, type):
            self._object(value)
        elif name := self._in_library(value):
            self.add("library", name)
        elif isinstance(value, types.FunctionType):
            self._function(value)
        elif isinstance(value, type):
            self._class(value)
        elif kind in (dict, types.MappingProxyType):
            for key in value:
                self.visit(key)
                self.visit(value[key])
        elif kind in (tuple, list):
            self.add(kind.__name__, len(value))
            for item in value:
                self.visit(item)
        elif kind in (set, frozenset):
            for item in sorted(value, key=repr):
                self.visit(item)
        elif parts := _parts_of(value):
            for part in parts:
                self.visit(part)
        else:
            self._of_library(value)

    def _function(self, function: types.FunctionType) -> None:
        self.add("function", function.__qualname__)
        self.visit(function.__defaults__)
        self.visit(function.__kwdefaults__)
        for cell in function.__closure__ or ():
            with contextlib.suppress(ValueError):  # not set yet
                self.visit(cell.cell_contents)
        self.visit(vars(function))  # such as `__wrapped__`
        known, code = function.__globals__, function.__code__
        module = sys.modules.get(known.get("__name__", ""))
        # What `exec` has made may have the names of a library.
        if self._is_known(known.get("__name__")) and _attributes(module) is known:
            return
        self.add("code", code)
        names = _names_in(code)
        self._names |= names
        for name, items in sorted(_modules_in(code)):
            # Now, or else its numbers would be seen only after the first call.
            with contextlib.suppress(Exception):
                module = importlib.import_module(name, known.get("__package__"))
                self.visit(module)
                for item in items if hasattr(module, "__path__") else ():
                    if item not in vars(module):
                        importlib.import_module(f"{module.__name__}.{item}")
        if names & BY_ANY_NAME:
            names |= {name for name in known if not name.startswith("__")}
        self._named({name: known[name] for name in names if name in known})

    def _class(self, kind: type) -> None:
        self.visit(type(kind))
        for base in kind.__mro__:
            self.add("class", base.__qualname__)
            # One made by `exec` may say that it is of `builtins`.
            if not self._in_library(base):
                fields = vars(base).get("__dataclass_fields__", {})
                inside = vars(base).keys() - NOT_CODE - fields.keys()
                inside = {name: vars(base)[name] for name in inside}
                self.visit(list(fields.values()))
                self._named({k: v for k, v in inside.items() if not _is_generated(v)})

    def _object(self, value) -> None:
        kind = type(value)
        # Without its module: one of a file by name is called by what is in the file.
        self.add("object", kind.__qualname__)
        self.visit(kind)
        attributes = _attributes(value)
        self.visit({n: attributes[n] for n in attributes if n not in _worked_out(kind)})
        for name in _slots(kind):
            with contextlib.suppress(Exception):  # not set
                self.visit(getattr(value, name))
        for base, content in CONTENT.items():
            if isinstance(value, base):
                self.visit(content(value))

    def _of_library(self, value) -> None:
        """Add an object of a library's class, by what `pickle` knows of it."""
        kind = type(value)
        self.add("object", f"{kind.__module__}.{kind.__qualname__}")
        if dataclasses.is_dataclass(kind):
            names = {field.name for field in dataclasses.fields(kind)}
            attributes = {name: getattr(value, name, None) for name in names}
            self.visit(_attributes(value) | attributes)
            return
        stream = io.BytesIO()
        pickler = _Pickler(stream, self)
        try:
            pickler.dump(value)
        except Exception:  # whatever an object does that is not made for it
            self.add("identity", value if _is_hashable(value) else id(value))
        else:
            self.add("content", hashlib.blake2b(stream.getvalue()).hexdigest())
            for part in pickler.apart:
                self.visit(part)

    def _is_of_user(self, kind: type) -> bool:
        ours = kind.__module__.startswith(f"{PACKAGE}.")
        return ours or not self._is_known(kind.__module__)

    def _in_library(self, value) -> str | None:
        """Return the name under which a library has a function, class or object."""
        module = getattr(value, "__module__", None)
        name = getattr(value, "__qualname__", None)
        if not (isinstance(module, str) and isinstance(name, str)):
            return None
        if not self._is_known(module) or "<" in name:
            return None
        value_there: Any = sys.modules.get(module)
        for part in name.split("."):
            value_there = getattr(value_there, part, None)
        return f"{module}.{name}" if value_there is value else None

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
    for kind, parts in WRAPPERS.items():
        if isinstance(value, kind):
            with contextlib.suppress(LookupError):  # a context variable without value
                return parts(value)
    if callable(value) and hasattr(value, "__wrapped__"):
        # Such as `functools.lru_cache`, `jax.jit`, `jax.custom_jvp` with its rule
        inside = filter(callable, _attributes(value).values())
        return [value.__wrapped__, *inside]
    return []


def _attributes(value) -> dict[str, Any]:
    attributes = getattr(value, "__dict__", None)
    return attributes if isinstance(attributes, dict) else {}


def _worked_out(kind: type) -> set[str]:
    """List what objects of the package work out when first asked: it follows from the
    rest. Users may set theirs."""
    return {
        name
        for base in kind.__mro__
        if top_of(base.__module__) == PACKAGE
        for name, attribute in vars(base).items()
        if isinstance(attribute, functools.cached_property)
    }


def _slots(kind: type) -> list[str]:
    slots_of_bases = (vars(base).get("__slots__", ()) for base in kind.__mro__)
    slots = [[each] if isinstance(each, str) else list(each) for each in slots_of_bases]
    return [name for each in slots for name in each if name != "__weakref__"]


def _is_hashable(value) -> bool:
    try:
        hash(value)
    except TypeError:
        return False
    return True


class _Pickler(pickle.Pickler):
    """Pickles an object without what it holds of functions, classes and modules, of
    which `pickle` would keep the names only."""

    def __init__(self, stream: io.BytesIO, walker: _Walker):
        super().__init__(stream)
        self._walker, self.apart = walker, []

    def persistent_id(self, obj):
        apart = isinstance(obj, types.FunctionType | type | types.ModuleType)
        apart = apart or type(obj) in (set, frozenset)  # whose order changes
        apart = apart or (callable(obj) and bool(_parts_of(obj)))
        if not apart or self._walker._in_library(obj):
            return None
        self.apart.append(obj)
        return len(self.apart)


@functools.lru_cache(maxsize=4096)
def _names_in(code: types.CodeType) -> frozenset[str]:
    """Return the names that code refers to, and those in its texts."""
    names = set(code.co_names) | set(code.co_freevars)
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            names |= _names_in(constant)
        elif isinstance(constant, str):
            names |= set(re.findall(r"[^\W\d]\w*", constant))
    return frozenset(names)


@functools.lru_cache(maxsize=4096)
def _modules_in(code: types.CodeType) -> frozenset[tuple[str, tuple[str, ...]]]:
    """Return the modules that code imports while it runs, and what it takes from
    them."""
    modules = {*imported_in(code)}
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            modules |= _modules_in(constant)
    if BY_TEXT & set(code.co_names):
        texts = {text for text in code.co_consts if isinstance(text, str)}
        modules |= {(t, ()) for t in texts if t.replace(".", "").isidentifier()}
    return frozenset(modules)


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
    if code not in codes_of("".join(lines), code.co_filename):
        return None
    return "".join(inspect.getblock(lines[code.co_firstlineno - 1 :]))
