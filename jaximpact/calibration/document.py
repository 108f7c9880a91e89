"""A document of a few kinds of blocks, as one HTML page and as Markdown."""

import base64
import html
import re
from typing import NamedTuple

from ..formats.directory import NewFile
from ..formats.files import replacing

STYLE = """\
body { max-width: 60rem; margin: 1.5rem auto; padding: 0 1rem; color: #222;
  font: 1rem/1.5 system-ui, sans-serif; }
h1 { font-size: 1.6rem; line-height: 1.25; }
h2 { font-size: 1.3rem; margin-top: 2.5rem; border-bottom: 1px solid #ccc; }
h3 { font-size: 1.05rem; margin-top: 1.75rem; }
.verdict { border-left: 4px solid #0072b2; background: #f2f7fa;
  padding: .5rem 1rem; }
.warning { border-left: 4px solid #d55e00; background: #fdf4ee;
  padding: .5rem 1rem; }
.verdict p, .warning p { margin: .4rem 0; }
.verdict p:first-child { font-weight: 600; }
.table { overflow-x: auto; }
table { border-collapse: collapse; font-size: .9rem; margin: .5rem 0;
  font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .7rem; text-align: left; vertical-align: top;
  border-bottom: 1px solid #ddd; }
th { border-bottom: 2px solid #999; }
td.number { white-space: nowrap; }
.figures { display: flex; flex-wrap: wrap; gap: 1rem; }
figure { margin: 0; flex: 1 1 19rem; max-width: 29rem; }
figure img { width: 100%; height: auto; }
figcaption { font-size: .85rem; color: #444; }
@media print { body { max-width: none; font-size: 10pt; margin: 0; }
  h2, h3 { break-after: avoid; } figure, tr { break-inside: avoid; }
  .table { overflow: visible; } td.number { white-space: normal; }
  .figures { display: block; } figure { display: inline-block; width: 48%; } }
"""
WORDY = 40
"""Characters beyond which a cell may be broken into lines."""


class Heading(NamedTuple):
    """Of level 1, which stands once, to 3."""

    level: int
    text: str


class Paragraph(NamedTuple):
    """Text."""

    text: str


class Points(NamedTuple):
    """A list."""

    items: list[str]


class Box(NamedTuple):
    """Text that is to be read first.

    `kind` is "verdict" or "warning".
    """

    kind: str
    lines: list[str]


class Table(NamedTuple):
    """Rows of cells, the head first."""

    rows: list[tuple[str, ...]]


class Picture(NamedTuple):
    """A PNG."""

    name: str
    """Of its file."""
    png: bytes
    description: str
    """For those who do not see it."""
    caption: str


class Pictures(NamedTuple):
    """Side by side where there is room."""

    pictures: list[Picture]


Block = Heading | Paragraph | Points | Box | Table | Pictures


def as_html(blocks: list[Block]) -> str:
    """One page that needs nothing else."""
    title = next(block.text for block in blocks if isinstance(block, Heading))
    body = "\n".join(_html(block) for block in blocks)
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{html.escape(title)}</title>\n<style>\n{STYLE}</style>\n</head>\n"
        f"<body>\n{body}\n</body>\n</html>\n"
    )


def as_markdown(blocks: list[Block], folder: str) -> str:
    """The same, its pictures in a folder beside it."""
    return "\n\n".join(_markdown(block, folder) for block in blocks) + "\n"


def pictures_of(blocks: list[Block]) -> list[Picture]:
    """All pictures."""
    return [
        p for block in blocks if isinstance(block, Pictures) for p in block.pictures
    ]


def save_pictures(blocks: list[Block], folder: str, new: NewFile) -> None:
    """Write the pictures, in a folder of that name."""
    for picture in pictures_of(blocks):
        with replacing(new(f"{folder}/{picture.name}")) as temporary:
            temporary.write_bytes(picture.png)


def _html(block: Block) -> str:
    text = html.escape
    match block:
        case Heading(level, words):
            return f"<h{level}>{text(words)}</h{level}>"
        case Paragraph(words):
            return f"<p>{text(words)}</p>"
        case Points(items):
            lines = "\n".join(f"<li>{text(item)}</li>" for item in items)
            return f"<ul>\n{lines}\n</ul>"
        case Box(kind, lines):
            inner = "\n".join(f"<p>{text(line)}</p>" for line in lines)
            return f'<div class="{kind}">\n{inner}\n</div>'
        case Table(rows):
            return _html_table(rows)
        case Pictures(pictures):
            inner = "\n".join(_html_picture(picture) for picture in pictures)
            return f'<div class="figures">\n{inner}\n</div>'


def _html_table(rows) -> str:
    head = "".join(f'<th scope="col">{html.escape(cell)}</th>' for cell in rows[0])
    lines = [f"<thead><tr>{head}</tr></thead>", "<tbody>"]
    for row in rows[1:]:
        cells = "".join(
            f"<td>{html.escape(cell)}</td>"
            if len(cell) > WORDY
            else f'<td class="number">{html.escape(cell)}</td>'
            for cell in row
        )
        lines.append(f"<tr>{cells}</tr>")
    inner = "\n".join([*lines, "</tbody>"])
    return f'<div class="table">\n<table>\n{inner}\n</table>\n</div>'


def _html_picture(picture: Picture) -> str:
    data = base64.b64encode(picture.png).decode()
    return (
        f'<figure><img src="data:image/png;base64,{data}" '
        f'alt="{html.escape(picture.description, quote=True)}">'
        f"<figcaption>{html.escape(picture.caption)}</figcaption></figure>"
    )


def _markdown(block: Block, folder: str) -> str:
    match block:
        case Heading(level, words):
            return "#" * level + " " + _plain(words)
        case Paragraph(words):
            return _plain(words)
        case Points(items):
            return "\n".join(f"* {_plain(item)}" for item in items)
        case Box(_, lines):
            return "\n>\n".join(f"> {_plain(line)}" for line in lines)
        case Table(rows):
            cells = [" | ".join(_plain(cell) for cell in row) for row in rows]
            rule = " | ".join("---" for _ in rows[0])
            return "\n".join(f"| {line} |" for line in (cells[0], rule, *cells[1:]))
        case Pictures(pictures):
            return "\n\n".join(
                f"![{_plain(p.description)}]({folder}/{p.name})\n\n{_plain(p.caption)}"
                for p in pictures
            )


def _plain(text: str) -> str:
    """Text that Markdown shows as it stands."""
    text = " ".join(text.split("\n"))
    # Underscores within words are shown as they are.
    return re.sub(r"([\\`*\[\]<>|#])", r"\\\1", text)
