"""Identity of laws and shapes, for keys and manifests: a law that was edited is
another law."""

import contextlib
import dataclasses
import functools
import hashlib
import site
import sys
import sysconfig
from pathlib import Path
from types import ModuleType

import equinox as eqx
import jax

from .finding import READ_BY_NAME
from .parameters import Composite, Part, parts_of

PACKAGE = __name__.partition(".")[0]


def part_names(*wholes: Composite) -> dict[str, str]:
    """Name the parts of soil and block as a manifest tells them: what each is for, its
    class and, of one that is not the package's, a digest of its source."""
    return {
        slot: name_of(type(getattr(whole, slot)))
        for whole in wholes
        for slot in parts_of(type(whole))
    }


def name_of(kind: type[Part]) -> str:
    """Return the module and name of a class; of one that is not the package's the name
    of its file, however it was found, and a digest of its source. Of one that is made
    of several, those of each."""
    if kinds := made_of(kind):
        return " and ".join(name_of(one) for one in kinds)
    if is_ours(kind):
        return f"{kind.__module__}.{kind.__qualname__}"
    file = getattr(sys.modules.get(kind.__module__), "__file__", None)
    module = Path(file).stem if file else kind.__module__
    digest = source_digest(kind)
    told = digest[:16] if digest else "source not known"
    return f"{module}.{kind.__qualname__} ({told})"


def described(tree) -> tuple | None:
    """Return everything of a tree that a program compiled for it depends on: classes,
    digests of those that are not the package's, and static fields; None if that is not
    known: of a class without source, or whose source was edited since, of a static
    field that holds more than plain values, or of a node that is neither a module nor a
    container of Python."""
    if tree is None or jax.tree_util.all_leaves([tree]):
        return ("value", tree is not None)
    kind, static = type(tree), {}
    if isinstance(tree, eqx.Module):
        fields = {f.name: getattr(tree, f.name) for f in dataclasses.fields(tree)}
        marked = (f.name for f in dataclasses.fields(tree) if f.metadata.get("static"))
        static = {name: fields.pop(name) for name in marked}
    elif isinstance(tree, tuple | list | dict):
        fields = tree if isinstance(tree, dict) else dict(enumerate(tree))
    else:
        return None
    digest, inner = source_digest(kind), [described(x) for x in fields.values()]
    if digest is None or None in inner or not _is_plain((*fields, *static.values())):
        return None
    if digest and _may_be_edited(kind):
        return None
    name = kind.__module__, kind.__qualname__, digest
    return *name, repr(static), tuple(zip(fields, inner, strict=True))


def _is_plain(value) -> bool:
    """Tell whether Python's text of a value says all of it."""
    if type(value) is tuple:
        return all(map(_is_plain, value))
    return value is None or type(value) in (bool, int, float, str)


@functools.cache
def source_digest(kind: type) -> str | None:
    """Compute the digest of the sources that a class is made of: its module, those of
    the classes it derives from, and those that they take names from, but for installed
    packages. "" if all are the package's; None if one has no source, as in an
    interactive session, or was made inside a function, whose variables no source
    tells."""
    if kinds := made_of(kind):
        digests = [source_digest(one) for one in kinds]
        known = [digest for digest in digests if digest is not None]
        return "".join(known) if len(known) == len(digests) else None
    modules = _modules_of(kind)
    sources = [*map(_source_of, modules or ())]
    if modules is None or None in sources:
        return None
    digest = hashlib.sha256(b"".join(source for source in sources if source))
    return digest.hexdigest() if modules else ""


@functools.cache
def _modules_of(kind: type) -> list[ModuleType] | None:
    """Return the modules that `source_digest` reads, by their names; None if the class
    is in none."""
    modules: dict[str, ModuleType] = {}
    for base in kind.__mro__:
        module = sys.modules.get(base.__module__)
        if not _holds(module, base):
            return None
        _gather(module, modules)
    return [modules[name] for name in sorted(modules)]


def _may_be_edited(kind: type) -> bool:
    """Whether a source may be newer than the class that was made of it, as in a
    notebook that goes on after an edit: then its digest tells another law."""
    if kinds := made_of(kind):
        return any(map(_may_be_edited, kinds))
    return not all(_is_as_read(module, kind) for module in _modules_of(kind) or ())


def _is_as_read(module: ModuleType, kind: type) -> bool:
    file = Path(module.__file__ or "")
    if hasattr(module, READ_BY_NAME):
        content = hashlib.sha256(file.read_bytes()).hexdigest()
        return module.__name__ == f"{file.stem}_{content[:12]}"
    return file.stat().st_mtime_ns <= getattr(kind, "made_at", 0)


def made_of(kind: type) -> tuple[type[Part], ...]:
    """List the classes that one which stands for several is made of, as
    `MixedShapes`."""
    kinds = getattr(kind, "kinds", ())
    return kinds if isinstance(kinds, tuple) else ()


def _holds(module: ModuleType | None, kind: type) -> bool:
    found = module
    for name in kind.__qualname__.split("."):
        found = getattr(found, name, None)
    return found is kind


def _gather(module: ModuleType | None, found: dict[str, ModuleType]) -> None:
    """Add a module, and those that it takes names from, unless they are installed."""
    if module is None or module.__name__ in found or _is_installed(module):
        return
    found[module.__name__] = module
    for value in list(vars(module).values()):
        if isinstance(value, ModuleType):
            _gather(value, found)
        else:
            _gather(sys.modules.get(getattr(value, "__module__", None) or ""), found)


def is_ours(kind: type) -> bool:
    """Tell whether a class is the package's."""
    return kind.__module__.partition(".")[0] == PACKAGE


def _is_installed(module: ModuleType) -> bool:
    top = module.__name__.partition(".")[0]
    if top == PACKAGE or module.__name__ in sys.builtin_module_names:
        return True
    if top in sys.stdlib_module_names:
        return module.__name__ != "__main__"
    file = getattr(module, "__file__", None)
    if file is None:
        return hasattr(module, "__path__")  # a namespace package
    return any(Path(file).is_relative_to(place) for place in _places())


@functools.cache
def _places() -> tuple[Path, ...]:
    names = ("stdlib", "platstdlib", "purelib", "platlib")
    places = [sysconfig.get_path(name) for name in names]
    return tuple(Path(place) for place in (*places, *site.getsitepackages()))


def _source_of(module: ModuleType) -> bytes | None:
    file = getattr(module, "__file__", None) or ""
    with contextlib.suppress(OSError):
        return Path(file).read_bytes() if file.endswith(".py") else None
    return None
