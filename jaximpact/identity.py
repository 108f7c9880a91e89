"""Identity of laws and shapes, for keys and manifests: a law that was edited is
another law.

Where a class is the package's, its name is enough, with the version. Where it is a
user's, `code_state` lists all that it computes with. That list, as it is now, tells
within a process whether what was compiled for a class still holds (`heed_edits`); its
digest is in manifests, journals and keys of fits. Compiled code on disk needs neither:
it is kept by its own text.
"""

import contextlib
import dataclasses
import functools
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import equinox as eqx
import jax

from . import parameters
from ._fixed_fields import fixed_fields, unusual_fields
from .code_state import PACKAGE, Atom, digest, plain_values, walk
from .parameters import Composite, Part, parts_of


def part_names(*wholes: Composite) -> dict[str, str]:
    """Name the parts of soil and block as a manifest tells them: what each is for, its
    class, fields that are no parameters and not at their defaults and, of one that is
    not the package's, a digest of its code and its constants."""
    return {
        slot: name_with_fields(getattr(whole, slot))
        for whole in wholes
        for slot in parts_of(type(whole))
    }


def name_with_fields(part: Part) -> str:
    """Name the class of a part, as `name_of`, and those of its fields that are no
    parameters and not at their defaults."""
    fields = unusual_fields(part).items()
    said = (
        f", {name}={value if _is_plain(value) else digest(walk(value))[:16]}"
        for name, value in fields
    )
    return name_of(type(part)) + "".join(said)


def name_of(kind: type[Part]) -> str:
    """Return the module and name of a class; of one that is not the package's the name
    of its file, however it was found, a digest of its code, and the constants that it
    takes from modules and classes. Of one that is made of several, those of each."""
    if kinds := made_of(kind):
        return " and ".join(name_of(one) for one in kinds)
    if is_ours(kind):
        return f"{kind.__module__}.{kind.__qualname__}"
    file = getattr(sys.modules.get(kind.__module__), "__file__", None)
    module = Path(file).stem if file else kind.__module__
    atoms = _state_of(kind, (kind,))
    values = [f"{name}={value}" for name, value in plain_values(atoms).items()]
    details = [digest(atoms)[:16], *values[:8]]
    return f"{module}.{kind.__qualname__} ({', '.join(details)})"


def code_digest(kind: type) -> str:
    """Compute the digest of all that a class computes with; "" for the package's."""
    kinds = [one for one in made_of(kind) or (kind,) if not is_ours(one)]
    return "".join(digest(_state_of(one, (one,))) for one in kinds)


def described(tree) -> tuple | None:
    """Return everything of a tree that a program compiled for it depends on: classes,
    digests of those that are not the package's, and static fields; None if that is not
    known, of a node that is neither a module nor a container of Python."""
    if tree is None or jax.tree_util.all_leaves([tree]):
        return ("value", tree is not None)
    kind, static = type(tree), {}
    if isinstance(tree, eqx.Module):
        fields = {f.name: getattr(tree, f.name) for f in dataclasses.fields(tree)}
        static = {name: fields.pop(name) for name in fixed_fields(kind)}
    elif isinstance(tree, tuple | list | dict):
        fields = tree if isinstance(tree, dict) else dict(enumerate(tree))
    else:
        return None
    inner = [described(x) for x in fields.values()]
    if None in inner:
        return None
    name = kind.__module__, kind.__qualname__, code_digest(kind)
    known = ((key, digest(walk(value))) for key, value in static.items())
    return *name, tuple(known), tuple(zip(fields, inner, strict=True))


def users_code(tree) -> list:
    """List what a tree has that is not the package's: classes of its nodes, and static
    fields that are more than plain values."""
    if tree is None or jax.tree_util.all_leaves([tree]):
        return []
    if isinstance(tree, tuple | list | dict):
        nodes = tree.values() if isinstance(tree, dict) else tree
        inside = [part for node in nodes for part in users_code(node)]
        is_plain = is_ours(type(tree)) or type(tree) in (tuple, list, dict)
        return inside if is_plain else [tree, *inside]
    if not isinstance(tree, eqx.Module):
        return [tree]
    kind = type(tree)
    users: list = [one for one in made_of(kind) or (kind,) if not is_ours(one)]
    for field in dataclasses.fields(tree):
        value = getattr(tree, field.name)
        if not field.metadata.get("static"):
            users += users_code(value)
        elif not _is_plain(value):
            users.append(value)
    return users


def _is_plain(value) -> bool:
    if type(value) is tuple:
        return all(map(_is_plain, value))
    return value is None or type(value) in (bool, int, float, str)


@functools.lru_cache(maxsize=1024)
def _users_code_of(structure) -> tuple:
    return tuple(users_code(jax.tree.unflatten(structure, [0] * structure.num_leaves)))


_clearing: list[Callable[[], None]] = [
    *(cache.cache_clear for cache in parameters.caches_by_class),
    jax.clear_caches,
]


class _Known(NamedTuple):
    roots: tuple
    first: tuple[Atom, ...]
    """Before anything was traced; digests are of this."""
    last: tuple[Atom, ...]
    """As it is now, but for edits."""


_known: dict[Any, _Known] = {}
"""State of each user's class, and of the users' code in each structure."""
_lock = threading.RLock()


def clear_when_edited(clear: Callable[[], None]) -> None:
    """Have a cache cleared whenever the code of a user's class is found to be another
    than before."""
    _clearing.append(clear)


def heed_edits(structure) -> None:
    """Forget all that was compiled or worked out for classes, if a user's class in a
    tree of this structure has changed in this process: by an edit that a notebook has
    reloaded, or by a constant with another value.

    Costs a microsecond where all is the package's, else a tenth of a millisecond a
    class. What a user has put into a `jax.jit` of his own stays as it was traced, as
    everywhere in JAX, until a call outside finds the change.
    """
    users = _users_code_of(structure)
    if not users:
        return
    with _lock:
        is_new = structure not in _known
        _state_of(structure, users)
        for kind in users:
            if isinstance(kind, type) and (is_new or kind not in _known):
                _state_of(kind, (kind,))


def _state_of(key, roots: tuple) -> tuple[Atom, ...]:
    """Return the state of users' code before it was traced; all is forgotten if the
    code was edited since it was seen last."""
    with _lock:
        state, known = walk(*roots), _known.get(key)
        if known is not None and known.last == state:
            return known.first
        if known is not None:
            _known.clear()
            for clear in _clearing:
                clear()
        _known[key] = _Known(roots, state, state)
        return state


@contextlib.contextmanager
def tracing() -> Iterator[None]:
    """Trace users' code: what it changes itself, such as a counter or a memory of its
    own, is no edit."""
    with _lock:
        for key, known in [*_known.items()]:
            _state_of(key, known.roots)
    try:
        yield
    finally:
        with _lock:
            for key, known in _known.items():
                _known[key] = known._replace(last=walk(*known.roots))


def made_of(kind: type) -> tuple[type[Part], ...]:
    """List the classes that one which stands for several is made of, as
    `MixedShapes`."""
    kinds = getattr(kind, "kinds", ())
    return kinds if isinstance(kinds, tuple) else ()


def is_ours(kind: type) -> bool:
    """Tell whether a class is the package's."""
    return kind.__module__.partition(".")[0] == PACKAGE
