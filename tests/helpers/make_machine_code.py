"""Make the archives of `jaximpact.backend.shipped`: `make machine-code`.

Any processor does, since code for either level is only written. The same source, JAX
and llvmlite give the same files.
"""

import json
import os
import pickle
import sys
import zipfile
from pathlib import Path

import jax

from jaximpact._packages import versions
from jaximpact.backend.lane_functions import code_of_lanes
from jaximpact.backend.shipped import (
    ARCHIVES,
    MANIFEST,
    ROOT,
    SOURCE,
    digest_of,
    name_of,
    usual_impacts,
)
from jaximpact.backend.simd import LEVELS, compiling_for
from jaximpact.backend.threads import VARIABLE
from jaximpact.identity import described
from jaximpact.impact.problem import naming


def make_archive(level: str) -> Path:
    """Compile what is shipped for a level, and write it."""
    contents = {}
    with compiling_for(level):
        for impact in usual_impacts():
            code = code_of_lanes(*impact, thorough=True)
            what, tree = naming(*impact)
            contents[name_of(what, described(tree))] = pickle.dumps(code)
    # What is loaded has made the code, but for what names it.
    loaded = {name for name in sys.modules if name.startswith("jaximpact")}
    loaded.remove("jaximpact.backend.shipped")
    files = sorted(Path(str(sys.modules[name].__file__)) for name in loaded)
    source = {file.relative_to(ROOT).as_posix(): digest_of(file) for file in files}
    manifest = {SOURCE: source, "versions": versions()}
    contents[MANIFEST] = json.dumps(manifest, indent=1).encode()
    path = ARCHIVES / f"{level}.zip"
    path.parent.mkdir(exist_ok=True)
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in contents.items():
            # All of one date, so that the same code gives the same file.
            info = zipfile.ZipInfo(name)
            archive.writestr(info, content, zipfile.ZIP_LZMA)
    return path


if __name__ == "__main__":
    # Code is made in as many parts, and the same files, on any number of cores.
    os.environ[VARIABLE] = "2"
    jax.config.update("jax_enable_x64", True)
    for level in LEVELS:
        print(make_archive(level))
