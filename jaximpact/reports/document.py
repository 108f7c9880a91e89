"""Documents: a title, the answer, and sections behind it, as text and as one page of
HTML that needs no other file.

What a document says is written once, as a list of parts. A part is a paragraph (text),
a list of points, a `Table`, a `Box`, a `Picture` or several side by side, or a
`ReportSection`; parts that are empty are left out. On a page sections are folded, and
open where it is printed; in text pictures are left out.
"""

import base64
import dataclasses
import re
import textwrap
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, NamedTuple

from .tables import Table

if TYPE_CHECKING:
    from markupsafe import Markup
    from matplotlib.figure import Figure

WIDTH = 88
"""Characters in a line of text."""
PIXELS_PER_INCH = 96
"""Size of a figure on a page: letters of 9 points are as large as those of the page."""
LONGEST_NUMBER = 40
"""Characters of a cell that is not broken into lines."""


class Box(NamedTuple):
    """Framed lines, the first of them in bold."""

    kind: str
    """"verdict" or "warning"."""
    lines: Sequence[str]


class Picture(NamedTuple):
    """Drawing on a page."""

    draw: Callable[[], "Figure"]
    """Called when a page is written; text needs no drawing."""
    description: str
    """What it shows, for those who cannot see it."""
    caption: str


@dataclasses.dataclass(frozen=True)
class ReportSection:
    """Parts under a heading."""

    title: str
    parts: Sequence["Part"]
    printed: bool = True
    """Whether the section belongs into the text too."""

    def __bool__(self) -> bool:
        return any(self.parts)


@dataclasses.dataclass(frozen=True)
class Interactive:
    """Part of a page alone, with a template of its own."""

    package: str
    """Module whose folder `templates` holds the template."""
    template: str
    contents: dict


Part = (
    str
    | Sequence[str]
    | Table
    | Box
    | Picture
    | Sequence[Picture]
    | ReportSection
    | Interactive
    | None
)


class Document(NamedTuple):
    """Report of a result."""

    title: str
    answer: Sequence[Part]
    """First screen of the page: what was found, how sure, and what is wrong with it."""
    sections: Sequence[ReportSection]

    def text(self) -> str:
        """Write the document as text."""
        head = [f"{self.title}\n{'=' * len(self.title)}\n"] if self.title else []
        parts = _filled((*self.answer, *self.sections))
        lines = "\n".join([*head, *(_text(part, 2) for part in parts)])
        return re.sub(r"\n{3,}", "\n\n", lines).strip("\n") + "\n"

    def html(self) -> str:
        """Write the document as HTML to be shown in a notebook, nothing folded."""
        parts = _filled((*self.answer, *self.sections))
        return "".join(_html(part, 2) for part in parts)

    def page(self) -> str:
        """Write the document as a page."""
        return _render(
            __package__ or "",
            "page.jinja",
            {
                "title": self.title,
                "answer": [_html(part, 2) for part in _filled(self.answer)],
                "sections": [
                    (section.title, [_html(part, 3) for part in _filled(section.parts)])
                    for section in self.sections
                    if section
                ],
            },
        )


def _filled(parts: Sequence[Part]) -> list[Part]:
    return [part for part in parts if part]


def _text(part: Part, level: int) -> str:
    match part:
        case str():
            return _wrapped(part)
        case Box():
            first, *others = part.lines
            return "\n".join(["", _wrapped(first), *(_indented(x) for x in others)])
        case Table():
            return part.text()
        case ReportSection(printed=True):
            line = "\n" + "-" * len(part.title) if level < 3 else ""
            inner = (_text(one, level + 1) for one in _filled(part.parts))
            return "\n".join([f"\n{part.title}{line}", *inner])
        case [str(), *_]:
            return "\n".join(_indented(str(one)) for one in part)
    return ""


def _wrapped(text: str, first: int = 0, further: int = 0) -> str:
    return textwrap.fill(
        text,
        WIDTH,
        initial_indent=" " * first,
        subsequent_indent=" " * further,
        break_on_hyphens=False,
    )


def _indented(text: str) -> str:
    return _wrapped(text, 2, 4)


def _html(part: Part, level: int) -> "Markup":
    # Imported with the first page: fits need none.
    from markupsafe import Markup

    def element(template: str, *inner) -> Markup:
        return Markup(template).format(*inner)

    def each(template: str, inner) -> Markup:
        return Markup("").join(element(template, one) for one in inner)

    match part:
        case str():
            return element("<p>{}</p>\n", part)
        case Box():
            lines = each("<p>{}</p>\n", part.lines)
            return element('<div class="{}">\n{}</div>\n', part.kind, lines)
        case Table():
            rows = (
                Markup("").join(
                    element(
                        "<td>{}</td>"
                        if len(cell) > LONGEST_NUMBER
                        else '<td class="number">{}</td>',
                        cell,
                    )
                    for cell in row
                )
                for row in part.shown()
            )
            return element(
                '<div class="table"><table>\n<thead><tr>{}</tr></thead>\n'
                "<tbody>\n{}</tbody>\n</table></div>\n",
                each('<th scope="col">{}</th>', part.columns),
                each("<tr>{}</tr>\n", rows),
            )
        case ReportSection():
            inner = [_html(one, level + 1) for one in _filled(part.parts)]
            head = element(f"<h{level}>{{}}</h{level}>\n", part.title)
            return head + Markup("").join(inner)
        case Interactive():
            return Markup(_render(part.package, part.template, part.contents))
        case Picture() | [Picture(), *_]:
            every = [part] if isinstance(part, Picture) else part
            inner = Markup("").join(_figure(one) for one in every)
            return element('<div class="figures">\n{}</div>\n', inner)
        case [str(), *_]:
            return element("<ul>\n{}</ul>\n", each("<li>{}</li>\n", part))
    return Markup("")


def _figure(picture: Picture) -> "Markup":
    from markupsafe import Markup

    from ..plotting.style import png_bytes

    figure = picture.draw()
    return Markup(
        '<figure style="width: {}px"><img src="data:image/png;base64,{}" alt="{}">'
        "<figcaption>{}</figcaption></figure>\n"
    ).format(
        round(PIXELS_PER_INCH * figure.get_figwidth()),
        base64.b64encode(png_bytes(figure)).decode(),
        picture.description,
        picture.caption,
    )


def _render(package: str, template: str, contents: dict) -> str:
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader(package),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    text = environment.get_template(template).render(contents)
    return re.sub(r"\n{2,}", "\n", text).strip("\n") + "\n"
