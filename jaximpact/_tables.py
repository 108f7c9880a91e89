"""Tables of cells, as lines of text and as HTML for notebooks."""

import html
from collections.abc import Iterable, Sequence

Row = tuple[str, ...]


def align(rows: Sequence[Row]) -> str:
    """Write rows of cells as text in columns, indented by two."""
    widths = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
    lines = (
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        for row in rows
    )
    return "\n".join(f"  {line}".rstrip() for line in lines)


def html_table(heads: Iterable[str], rows: Sequence[Row]) -> str:
    """Write lines with a table below them.

    A row of one cell is a heading within the table, and a row that begins with an empty
    cell names its columns.
    """
    lines = [f"<div>{html.escape(head.strip())}</div>" for head in heads]
    if rows:
        lines.append("<table>")
    for row in rows:
        tag = "td" if row[0] and len(row) > 1 else "th"
        span = "" if len(row) > 1 else " colspan=3"
        cells = (
            f'<{tag}{span} style="text-align:left">{html.escape(cell)}</{tag}>'
            for cell in row
        )
        lines.append(f"<tr>{''.join(cells)}</tr>")
    return "\n".join([*lines, "</table>"] if rows else lines)
