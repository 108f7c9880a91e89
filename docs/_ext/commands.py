"""What the commands print for `--help`, as it is when the site is built."""

import os
import subprocess
import sys

from sphinx.util.docutils import SphinxDirective


class CommandHelp(SphinxDirective):
    """Help of the command that the argument names."""

    required_arguments = 1

    def run(self):
        command = [sys.executable, "-m", "jaximpact", self.arguments[0], "--help"]
        environment = os.environ | {"COLUMNS": "100"}
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, check=True
        )
        return self.parse_text_to_nodes(f"````text\n{done.stdout}````")


def setup(app) -> dict:
    app.add_directive("command-help", CommandHelp)
    return {"parallel_read_safe": True}
