"""A study fitted in a process of its own: `python -m benchmarks.our_fit`.

Prints JSON: seconds up to the end of the import, of compiling and of the fits, impacts
computed, and for each variant the rms at the end of every start, the given one first.
"""

import json
import sys
import time
from pathlib import Path


def main(started: str, path: str) -> None:
    """Fit and report.

    Args:
        started: `time.time()` when the process was started.
        path: of a study with one target, all of it measured, and sigmas estimated.
    """
    import jax
    import numpy as np

    jax.config.update("jax_enable_x64", True)
    from jaximpact.calibration import fit_study, read_study
    from jaximpact.calibration.problem.forward_model import models_of
    from jaximpact.calibration.problem.program import ImpactProgram

    imported, begin = time.time() - float(started), time.perf_counter()
    study = read_study(Path(path))
    models_of(study)
    compiled = time.perf_counter() - begin
    counts, run = [], ImpactProgram.run

    def counted(program, rows, accuracy, *, derivatives):
        counts.append(len(rows.unknowns))
        return run(program, rows, accuracy, derivatives=derivatives)

    ImpactProgram.run = counted
    result = fit_study(study)
    tests = len(study.tests)
    # With one sigma the cost is half the sum of squares over it.
    rms = [
        [float(v.sigma[0, 0] * np.sqrt(2.0 * v.cost / tests))] for v in result.variants
    ]
    answer = {"import_s": imported, "compile_s": compiled, "fit_s": result.seconds}
    print(json.dumps(answer | {"impacts": sum(counts), "rms": rms}))


if __name__ == "__main__":
    main(*sys.argv[1:])
