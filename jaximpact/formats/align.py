"""Text in columns."""


def align(rows: list[tuple[str, ...]]) -> str:
    """Rows of cells as text in columns, indented by two."""
    widths = [max(map(len, cells)) for cells in zip(*rows, strict=True)]
    return "\n".join(
        "  "
        + "  ".join(
            cell.ljust(width) for cell, width in zip(row, widths, strict=True)
        ).rstrip()
        for row in rows
    )
