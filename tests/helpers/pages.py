"""Blocks of the pages of the documentation, run one after the other.

`python tests/helpers/pages.py [PAGE ...]`, or `make pages`, puts what blocks print now
in the place of what the pages say.
"""

import contextlib
import io
import os
import re
import shlex
import sys
import tempfile
import tomllib
import unittest.mock
from pathlib import Path
from typing import NamedTuple

from paths import DOCS, ROOT

from jaximpact.cli import main

FENCE = re.compile(
    r"(?:^<!-- shown only: (?P<why>[^\n]+) -->\n)?"
    r"(?:^`(?P<file>[\w./-]+\.\w+)`[^\n]*:\n\n)?"
    r"^```(?P<language>\w+)\n(?P<text>.*?)^```\n"
    r"(?P<printed>(?:\n+(?: {4}[^\n]*\n)+)*)",
    re.MULTILINE | re.DOTALL,
)
"""A fenced block with what stands about it: why it is not run, the name of the file
that it is, and what it prints."""
NOT_RUN = {"math", "text"}
FILES = {"toml", "csv", "python"}


def all_pages() -> list[Path]:
    """README.md and the pages of docs/, but for the reference."""
    pages = (
        page
        for page in DOCS.rglob("*.md")
        if page.relative_to(DOCS).parts[0] not in ("reference", "notebooks", "_build")
    )
    return [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(pages)]


class Block(NamedTuple):
    """One fenced block of a page."""

    language: str
    text: str
    file: str | None
    """Name of the file that the block is."""
    printed: str | None
    """What the page says that the block prints."""
    span: tuple[int, int]
    """Place in the page of what is printed, or of where it would be."""

    def __str__(self) -> str:
        return f"```{self.language}\n{self.text}```"


def blocks_of(page: Path) -> list[Block]:
    """Blocks of a page that are run, in order."""
    found = []
    for match in FENCE.finditer(page.read_text(encoding="utf-8")):
        if match["why"] or match["language"] in NOT_RUN:
            continue
        printed = "".join(line[4:] for line in match["printed"].splitlines(True)[1:])
        found.append(
            Block(
                match["language"],
                match["text"],
                match["file"],
                printed or None,
                match.span("printed"),
            )
        )
    return found


def run(block: Block, names: dict) -> str:
    """Write the block's file, or run the block, and return what it prints.

    Python is run in `names`. Of files without a name, which are parts of files, it is
    checked that they can be read.
    """
    if block.file is not None:
        assert block.language in FILES, f"a file of an unknown kind:\n{block}"
        Path(block.file).write_text(block.text, encoding="utf-8")
        return ""
    if block.language == "toml":
        tomllib.loads(block.text)
        return ""
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        if block.language == "python":
            exec(compile(block.text, "block of the page", "exec"), names)
        else:
            assert block.language == "sh", f"no code, no file with a name:\n{block}"
            for line in block.text.replace("\\\n", " ").splitlines():
                _run_command(line)
    return printed.getvalue()


def _run_command(line: str) -> None:
    words, settings = shlex.split(line, comments=True), {}
    while words and "=" in words[0]:
        name, _, settings[name] = words.pop(0).partition("=")
    if words:
        assert words.pop(0) == "jaximpact", (
            f"only commands of jaximpact are run: {line}"
        )
        with unittest.mock.patch.dict(os.environ, settings):
            assert main(words) == 0, line


@contextlib.contextmanager
def folder_of_a_page(folder: Path):
    """Working directory in which a page is run: files of the page are modules there,
    and the project's studies are named as from its root."""
    for studies in ("calibration", "slopes"):
        (folder / studies).symlink_to(ROOT / studies)
    known = set(sys.modules)
    sys.path.insert(0, str(folder))
    try:
        with contextlib.chdir(folder):
            yield
    finally:
        sys.path.remove(str(folder))
        for name in set(sys.modules) - known:
            file = getattr(sys.modules[name], "__file__", None)
            if file is not None and Path(file).parent == folder:
                del sys.modules[name]


def words_of(printed: str) -> list[str]:
    """What is printed, without regard to blanks and ends of lines."""
    return printed.split()


def refresh(page: Path) -> None:
    """Put what the blocks of a page print now in the place of what it says."""
    text, changes, names = page.read_text(encoding="utf-8"), [], {}
    with tempfile.TemporaryDirectory() as folder, folder_of_a_page(Path(folder)):
        for block in blocks_of(page):
            printed = run(block, names)
            if block.printed and words_of(printed) != words_of(block.printed):
                lines = [line.rstrip() for line in printed.rstrip().splitlines()]
                shown = "".join(f"    {line}".rstrip() + "\n" for line in lines)
                changes.append((block.span, f"\n{shown}"))
    for (start, end), shown in reversed(changes):
        text = text[:start] + shown + text[end:]
    page.write_text(text, encoding="utf-8")
    print(f"{page.relative_to(ROOT)}: {len(changes)} changed")


if __name__ == "__main__":
    import jax

    jax.config.update("jax_enable_x64", True)
    for page in [Path(name).resolve() for name in sys.argv[1:]] or all_pages():
        refresh(page)
