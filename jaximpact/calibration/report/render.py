"""Texts from templates: one layout in HTML or plain text."""

import re
import textwrap
from typing import TYPE_CHECKING

from ...io.display import align

if TYPE_CHECKING:
    import jinja2

WIDTH = 88
PACKAGE = "jaximpact.calibration.report"
"""Module whose templates hold the macros."""


def render(layout: str, kind: str, contents: dict, package: str = PACKAGE) -> str:
    """Render a layout, the name of a template.

    Args:
        kind: "html" or "txt": the macros with which the layout is written.
        contents: variables of the layout, as plain values.
        package: module whose folder of templates has the layout.
    """
    template = environment(kind, package).get_template(f"{layout}.jinja")
    text = template.render(contents, macros=f"{kind}.jinja")
    # Blank lines of the macros add up.
    return re.sub(r"\n{3,}", "\n\n", re.sub(r" +\n", "\n", text)).strip("\n") + "\n"


def environment(kind: str, package: str) -> "jinja2.Environment":
    """Make the environment of templates of this package and of another, as `render`
    takes them."""
    # Imported with the first text: fits need none.
    import jinja2

    found = jinja2.Environment(
        loader=jinja2.ChoiceLoader([*map(jinja2.PackageLoader, {package, PACKAGE})]),
        autoescape=kind == "html",
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    found.filters.update(wrap=_wrapped, align=align)
    return found


def _wrapped(text: str, first: int = 0, further: int = 0) -> str:
    """Wrap text, the first and the further lines indented by so much."""
    return textwrap.fill(
        text,
        WIDTH,
        initial_indent=" " * first,
        subsequent_indent=" " * further,
        break_on_hyphens=False,
    )
