"""Cards of the notebooks: title, first paragraph and first picture of each."""

import base64
import json
import re
from pathlib import Path

from sphinx.util.docutils import SphinxDirective


def card(notebook: Path, pictures: Path) -> str:
    """A card as MyST, its picture written beside the others."""
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    head = "".join(cells[0]["source"])
    title = re.search(r"^# (.+)$", head, re.MULTILINE)[1]
    prose = [
        paragraph
        for cell in cells
        if cell["cell_type"] == "markdown"
        for paragraph in re.split(r"\n\s*\n", "".join(cell["source"]))
        if not paragraph.lstrip().startswith(("#", "|", "$$", "```"))
    ]
    outputs = (output for cell in cells for output in cell.get("outputs", []))
    images = (output.get("data", {}).get("image/png") for output in outputs)
    image = next(filter(None, images), None)
    lines = [f"## [{title}](notebooks/{notebook.name})", ""]
    if image is not None:
        pictures.mkdir(parents=True, exist_ok=True)
        data = base64.b64decode("".join(image))
        (pictures / f"{notebook.stem}.png").write_bytes(data)
        target = f"notebooks/{notebook.name}"
        lines += [
            f"```{{image}} {pictures.name}/{notebook.stem}.png",
            f":alt: {title}",
            f":target: {target}",
            ":class: gallery",
            "```",
            "",
        ]
    return "\n".join([*lines, *prose[:1], ""])


class Gallery(SphinxDirective):
    """A card for each notebook."""

    def run(self):
        source = Path(self.env.srcdir)
        found = sorted((source / "notebooks").glob("*.ipynb"))
        for path in found:
            self.env.note_dependency(str(path))
        text = "\n".join(card(path, source / "_pictures") for path in found)
        return self.parse_text_to_nodes(text, allow_section_headings=True)


def setup(app) -> dict:
    app.add_directive("gallery", Gallery)
    return {"parallel_read_safe": True}
