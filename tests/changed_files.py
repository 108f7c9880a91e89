"""How tests of commands change the files that these read."""


def write_changed(path, text, *pairs):
    """A file of a text in which the first of each pair, which must stand in it once,
    has become the second; gives its path."""
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    path.write_text(text)
    return path
