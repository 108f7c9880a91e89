"""Laws and shapes by name: the package's own, and users' from files and modules."""

import contextlib
import dis
import functools
import hashlib
import importlib
import importlib.util
import inspect
import stat
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, ModuleType
from typing import NamedTuple

from ._packages import is_installed
from .errors import InputError, did_you_mean, nearest
from .interruption import is_interrupt

CURE = (
    "give every parameter a default: name: Scalar = parameter(default, unit, range, "
    "meaning)"
)


def describe_error(error: BaseException) -> str:
    """Describe an error of users' code: its kind and, if there is any, its message."""
    message = ""
    with contextlib.suppress(Exception):  # of an error that cannot say what it is
        message = str(error).partition("\n")[0]
    kind = type(error).__name__
    kind += " (which would end the program)" if isinstance(error, SystemExit) else ""
    return f"{kind}: {message}" if message else kind


def users_line(error: BaseException) -> tuple[str | None, int | None]:
    """Find the line of a file named by the user in which an error arose; None, None
    where it arose elsewhere."""
    modules = [vars(m) for m in [*sys.modules.values()] if isinstance(m, ModuleType)]
    files = {names["__file__"] for names in modules if READ_BY_NAME in names}
    frames = traceback.extract_tb(error.__traceback__)
    lines = [(f.filename, f.lineno) for f in frames if f.filename in files]
    return lines[-1] if lines else (None, None)


def find_part(slot: str, base: type, text: str, directory: Path | None = None):
    """Find a law or a shape, with its default parameters, by name.

    Args:
        slot: what it is for, as in "flow"; named in errors.
        base: the class that it derives from.
        text: name of one of the package's own ("FluidityRate"; capitals, blanks, `-`
            and `_` do not matter), or "file.py:Class", or "package.module:Class".
        directory: from which the file is looked for; the working directory if none.

    A file is run, as `python file.py` would run it: name only files that you trust.

    Raises InputError, with the cure, for what is not there or cannot be used.
    """
    kind = find_class(slot, base, text, directory)
    try:
        return kind()
    except BaseException as error:
        if isinstance(error, InputError) or is_interrupt(error):
            raise
        cure = f"; {CURE}" if isinstance(error, TypeError) else ""
        raise InputError(
            f"{slot} {text!r} cannot be made without arguments: "
            f"{describe_error(error)}{cure}"
        ) from error


def find_class(slot: str, base: type, text: str, directory: Path | None = None) -> type:
    """Find the class that `find_part` makes a part of."""
    place, colon, name = text.rpartition(":")
    if not colon:
        known = {_folded(kind.__name__): kind for kind in shipped(base)}
        if _folded(text) in known:
            return known[_folded(text)]
        names = [kind.__name__ for kind in shipped(base)]
        near = nearest(text, names)
        hint = f"; did you mean {near}?" if near else ""
        raise InputError(
            f"{slot} {text!r} is unknown{hint} (there "
            f"are {', '.join(names)}; one of your own is named as 'file.py:Class')"
        )
    if place.endswith(".py"):
        module = _module_of_file(slot, (directory or Path()) / place)
    else:
        try:
            module = importlib.import_module(place)
        except BaseException as error:
            if is_interrupt(error):
                raise
            raise InputError(
                f"{slot} {text!r}: the module {place} cannot be imported: "
                f"{describe_error(error)}; a file is named with its ending, as in "
                "'my_laws.py:Class'"
            ) from error
    kind = getattr(module, name, None)
    if not isinstance(kind, type):
        kinds = [
            n
            for n, value in vars(module).items()
            if isinstance(value, type) and value.__module__ == vars(module)["__name__"]
        ]
        hint = f"; {did_you_mean(name, kinds)}" if kinds else ""
        raise InputError(f"{slot} {text!r}: there is no class {name}{hint}")
    if not issubclass(kind, base):
        raise InputError(
            f"{slot} {text!r}: {name} must derive from {base.__name__} "
            f"(class {name}({base.__name__}): ...)"
        )
    if inspect.isabstract(kind):
        missing = ", ".join(sorted(kind.__abstractmethods__))
        raise InputError(f"{slot} {text!r}: {name} does not define {missing}")
    return kind


def shipped(base: type) -> list[type]:
    """List the package's own classes that derive from one, in the order of their
    files."""
    kinds = []
    for kind in base.__subclasses__():
        # Not those that are made as a program runs, of several shapes.
        at_home = getattr(sys.modules.get(kind.__module__), kind.__name__, None)
        is_ours = kind.__module__.partition(".")[0] == __name__.partition(".")[0]
        if is_ours and at_home is kind:
            kinds += [] if inspect.isabstract(kind) else [kind]
            kinds += shipped(kind)
    return kinds


def _folded(name: str) -> str:
    return "".join(c for c in name.lower() if c.isalnum())


def file_of(kind: type) -> Path | None:
    """Return the file by which a class is named: where it stands, if it was read from
    there or from the program that runs; None for one of a module that can be
    imported."""
    module = sys.modules.get(kind.__module__)
    is_program = (
        kind.__module__ == "__main__" and getattr(module, "__spec__", None) is None
    )
    return _file(module) if is_program or hasattr(module, READ_BY_NAME) else None


def class_of_file(path: str, name: str) -> type:
    """Return the class of a file that `file_of` gave, in another process."""
    return getattr(_module_of_file("class", Path(path)), name)


READ_BY_NAME = "__jaximpact_read_by_name__"
"""Set in modules that were read from files that users named."""


def _module_of_file(slot: str, path: Path):
    try:
        is_file = stat.S_ISREG(path.stat().st_mode)
        content = path.read_bytes() if is_file else b""
    except (OSError, ValueError) as error:
        # A ValueError is of a name that the file system's encoding lacks.
        reason = getattr(error, "strerror", None) or error
        raise InputError(
            f"cannot be read: {reason}; it is named as the {slot}", file=path
        ) from error
    if not is_file:
        raise InputError(f"is no file; it is named as the {slot}", file=path)
    program = sys.modules.get("__main__")
    if getattr(program, "__spec__", 0) is None and path.resolve() == _file(program):
        return program  # which must not be run once more
    return _loaded(path.resolve(), content)


class _Loaded(NamedTuple):
    module: ModuleType
    content: bytes
    imports: list[str]
    """Modules of the user's that it imports."""
    files: dict[Path, bytes]
    """Digests of what was in their files, and in files that texts in them name."""


_files: dict[Path, _Loaded] = {}


def _loaded(path: Path, content: bytes) -> ModuleType:
    """Load the module of a file, anew if it, or a module that it imports, has been
    edited since."""
    known, name = _files.get(path), hashlib.sha256(content)
    if known is not None:
        now = {file: _digest(file) for file in known.files}
        if now == known.files:
            if content == known.content:
                return known.module
        else:
            # Python would give the law the old ones again.
            for imported in known.imports:
                sys.modules.pop(imported, None)
            importlib.invalidate_caches()
            name.update(b"".join(now.values()))
    module = _load(path, f"{path.stem}_{name.hexdigest()[:12]}")
    imports = dict(imports_of(module))
    files = {Path(file) for file in imports.values()}
    files |= {named for file in (path, *files) for named in _files_named_in(file)}
    now = {file: _digest(file) for file in sorted(files)}
    _files[path] = _Loaded(module, content, [*imports], now)
    return module


def _digest(file: Path) -> bytes:
    try:
        return hashlib.sha256(file.read_bytes()).digest()
    except OSError:  # removed since
        return b""


def _files_named_in(file: Path) -> Iterator[Path]:
    """Find the files that texts in a module name, from its folder or the working
    directory: data that it may read as it is imported."""
    for code in _codes_of_file(file):
        for text in code.co_consts:
            if isinstance(text, str):
                for place in (file.parent / text, Path(text)):
                    with contextlib.suppress(OSError, ValueError):  # no name of a file
                        if place.is_file():
                            yield place


def imports_of(module: ModuleType) -> Iterator[tuple[str, str]]:
    """Find the modules that a module imports, and those that they import, with their
    files; but for installed ones."""
    seen, new = {module.__name__}, [module]
    while new:
        module = new.pop()
        for name in _names_imported(module):
            other = sys.modules.get(name)
            file = getattr(other, "__file__", None)
            if other is None or file is None or name in seen:
                continue
            seen.add(name)
            if file.endswith(".py") and not is_installed(name, file):
                new.append(other)
                yield name, file


def _names_imported(module: ModuleType) -> set[str]:
    """Return the full names of what may be modules in the imports of a module."""
    names = set()
    for code in _codes_of_file(Path(str(module.__file__))):
        for name, items in imported_in(code):
            with contextlib.suppress(ImportError):  # above the topmost package
                full = importlib.util.resolve_name(name, module.__package__)
                names |= {full, *(f"{full}.{item}" for item in items)}
    return names


def imported_in(code: CodeType) -> Iterator[tuple[str, tuple[str, ...]]]:
    """Find the modules that code imports, without the code inside of it: their names,
    relative ones with dots before, and what is taken from them."""
    every = dis.get_instructions(code)
    steps = [step for step in every if step.opname != "EXTENDED_ARG"]
    for level, items, step in zip(steps, steps[1:], steps[2:], strict=False):
        if step.opname == "IMPORT_NAME":
            yield "." * level.argval + step.argval, items.argval or ()


@functools.lru_cache(maxsize=64)
def codes_of(text: str, file: str) -> frozenset[CodeType]:
    """Return all code objects that the text of a file compiles to; none where it is not
    valid."""
    try:
        codes, new = set(), [compile(text, file, "exec", dont_inherit=True)]
    except (SyntaxError, ValueError):
        return frozenset()
    while new:
        code = new.pop()
        codes.add(code)
        new += [c for c in code.co_consts if isinstance(c, CodeType)]
    return frozenset(codes)


def _codes_of_file(file: Path) -> frozenset[CodeType]:
    try:
        return codes_of(file.read_text("utf-8-sig"), str(file))
    except (OSError, ValueError):
        return frozenset()


def _file(module) -> Path | None:
    file = getattr(module, "__file__", None)
    return None if file is None else Path(file).resolve()


def _load(path: Path, name: str) -> ModuleType:
    """Load the module of a file under a name of its own, under which `pickle` finds it
    in this process."""
    being_read = sys.modules.get(name)
    if being_read is not None and being_read.__file__ == str(path):
        return being_read  # a program that names a law of its own
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None, path  # its name ends in .py
    assert spec.loader is not None, path
    module: ModuleType = importlib.util.module_from_spec(spec)
    setattr(module, READ_BY_NAME, True)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException as error:
        _, row = users_line(error)
        del sys.modules[name]
        if is_interrupt(error):
            raise
        line = "" if row is None else f" (line {row})"
        problem = describe_error(error)
        problem += f"; {CURE}" if "non-default argument" in problem else ""
        raise InputError(
            f"cannot be run as the file of a law or a shape{line}: {problem}",
            file=path,
        ) from error
    return module
