"""Files that tests write and read: CSV tables, and texts with replacements."""

import csv


def rows_of(path):
    """Rows of a file, each by the names of its columns."""
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write_rows(path, columns, rows):
    """A file of named columns; numbers stand in it with all their digits."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(rows)


def write_columns(path, columns):
    """A file of columns by name; gives its path."""
    write_rows(path, columns, zip(*columns.values(), strict=True))
    return path


def write_changed(path, text, *pairs):
    """A file of a text in which the first of each pair, which must stand in it once,
    has become the second; gives its path."""
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")
    return path
