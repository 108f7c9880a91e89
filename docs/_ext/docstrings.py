"""The package's docstrings, made ready for Sphinx.

They are Markdown with formulas in TeX between dollars, and sections such as `Args:`.
Formulas become directives and roles, names between backquotes become links where a page
of the reference describes them, and classes that declare parameters get a table of
them.
"""

import dataclasses
import importlib
import inspect
import math
import re
from pathlib import Path

from sphinx.util.docutils import SphinxDirective

from jaximpact.parameters import (
    TABLE_HEADING,
    Declared,
    declared_of,
    default_part,
    parts_of,
)

BLOCK = re.compile(r"\$\$(.+?)\$\$", re.DOTALL)
CODE = re.compile(r"``?([^`\n]+(?:\n[^`\n]+)?)``?")
INLINE = re.compile(r"\$([^$\n]+(?:\n[^$\n]+)?)\$")
KEPT = re.compile("\x00(\\d+)\x00")
LIST = re.compile(r"```\{api\} (\S+)\n(.*?)```", re.DOTALL)


def described(folder: Path) -> dict[str, str]:
    """Name to full name of what the pages of the reference list."""
    full = {}
    for page in sorted(folder.glob("*.md")):
        for module, names in LIST.findall(page.read_text(encoding="utf-8")):
            full |= {name: f"{module}.{name}" for name in names.split()}
    return full


def as_rst(text: str, links: dict[str, str]) -> str:
    """Markdown with TeX, as reStructuredText."""
    # Code and formulas are taken out first, so that neither is looked for in the other.
    kept: list[str] = []

    def keep(rst: str) -> str:
        kept.append(rst)
        return f"\x00{len(kept) - 1}\x00"

    def block(match: re.Match) -> str:
        line = text.rfind("\n", 0, match.start()) + 1
        indent = re.match(" *", text[line:])[0]
        formula = keep(f".. math:: {' '.join(match[1].split())}")
        return f"\n\n{indent}{formula}\n\n{indent}"

    def code(match: re.Match) -> str:
        name = " ".join(match[1].split())
        link = links.get(name)
        return keep(f":py:obj:`{name} <{link}>`" if link else f"``{name}``")

    def inline(match: re.Match) -> str:
        return keep(f":math:`{' '.join(match[1].split())}`")

    def put_back(match: re.Match) -> str:
        role = kept[int(match[1])]
        if role.startswith(".."):
            return role
        # A role must stand between blanks or marks; an escaped blank prints nothing.
        before = "" if re.search(r"(^|[\s(\[{'\"])$", rst[: match.start()]) else "\\ "
        after = "" if re.match(r"$|[\s.,:;!?)\]}'\"]", rst[match.end() :]) else "\\ "
        return f"{before}{role}{after}"

    rst = INLINE.sub(inline, CODE.sub(code, BLOCK.sub(block, text)))
    rst = re.sub(r"\||(?<=\w)_(?!\w)", r"\\\g<0>", rst)
    return KEPT.sub(put_back, rst)


def parameter_table(kind: type) -> str:
    """What a class of laws, shapes or parts of the scene declares."""
    if not (inspect.isclass(kind) and dataclasses.is_dataclass(kind)):
        return ""
    rows = [_cells(name, said) for name, said in declared_of(kind).items()]
    for slot in parts_of(kind):
        usual = default_part(kind, slot)
        rows.append((f"`{slot}`", f"`{slot}`", f"`{usual.__name__}`", "", "", ""))
        rows += [_cells(name, said) for name, said in declared_of(usual).items()]
    if not rows:
        return ""
    rows.insert(0, ("parameter", "in files", "meaning", "unit", "default", "range"))
    body = "".join("\n   * - " + "\n     - ".join(row) for row in rows)
    return f"\n\n.. list-table::\n   :header-rows: 1\n{body}\n"


def _cells(name: str, said: Declared) -> tuple[str, ...]:
    return (
        f"`{name}`",
        f"`{said.column}`",
        said.meaning,
        said.unit.replace("-", r"\-"),
        "" if math.isnan(said.default) else f"{said.default:g}",
        said.range,
    )


class Api(SphinxDirective):
    """Describe public names of a module, one to a line.

    That every public name is on a page is held by tests/end_to_end/test_pages.py.
    """

    has_content = True
    required_arguments = 1

    def run(self):
        module = importlib.import_module(self.arguments[0])
        lines = ["```{eval-rst}"]
        for name in filter(None, map(str.strip, self.content)):
            value = getattr(module, name)
            if inspect.isclass(value):
                kind, options = "class", ["   :members:"]
                if getattr(vars(value).get("__call__"), "__doc__", None):
                    options.append("   :special-members: __call__")
            elif callable(value):
                kind, options = "function", []
            else:
                kind, options = "data", ["   :no-value:"]
            lines += [f".. auto{kind}:: {module.__name__}.{name}", *options, ""]
        return self.parse_text_to_nodes("\n".join([*lines, "```"]))


def setup(app) -> dict:
    links = described(Path(app.srcdir) / "reference")

    attributes: dict[str, list[str]] = {}

    def translate(app, what, name, obj, options, lines) -> None:
        text = "\n".join(lines)
        if what == "class":
            # The table for `help` gives way to that of the site.
            text = text.partition(TABLE_HEADING)[0].rstrip() + parameter_table(obj)
        lines[:] = as_rst(text, links).split("\n")
        if what in ("attribute", "data", "property"):
            # Napoleon would take what stands before a colon for the type.
            attributes[name], lines[:] = lines[:], []

    def put_back(app, what, name, obj, options, lines) -> None:
        lines[:] = attributes.pop(name, lines)

    def skip(app, what, name, obj, skipped, options) -> bool | None:
        # What Python writes for a field of a NamedTuple that nobody described
        undescribed = (getattr(obj, "__doc__", None) or "").startswith(
            "Alias for field"
        )
        return True if undescribed else None

    # Before and after Napoleon reads the sections
    app.connect("autodoc-process-docstring", translate, priority=400)
    app.connect("autodoc-process-docstring", put_back, priority=600)
    app.connect("autodoc-skip-member", skip)
    app.add_directive("api", Api)
    return {"parallel_read_safe": True}
