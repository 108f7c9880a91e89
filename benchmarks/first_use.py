"""One first use in a process of its own: `python -m benchmarks.first_use`.

Prints JSON with the seconds up to the end of the import, and of the first and the
second use.
"""

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path


def uses() -> dict[str, Callable]:
    """What can be used first, by name: functions of nothing that wait for results."""
    import jax
    import jax.numpy as jnp

    from jaximpact import Block, Impact, Soil, simulate
    from jaximpact.shapes import EllipticCylinder

    ellipsoid, cylinder = Block(), Block(shape=EllipticCylinder())

    def impact(soil, block=ellipsoid, **impact):
        return lambda: float(simulate(block, soil, Impact(**impact)).e_n)

    def gradient(block):
        def e_n(logs):
            names = ("k_E", "gamma_v", "c_v")
            soil = Soil(**dict(zip(names, jnp.exp(logs), strict=True)))
            return simulate(block, soil, Impact(angle=0.5)).e_n

        def compute():
            logs = jnp.log(jnp.asarray([900.0, 8.7, 1.0]))
            jax.block_until_ready(jax.jacfwd(e_n)(logs))

        return compute

    def batch():
        from jaximpact import simulate_batch

        from .impacts import mixed_scenes

        simulate_batch(mixed_scenes(1000, 1), accuracy="fast")

    return {
        "import": lambda: None,
        "vertical impact": impact(Soil()),
        "planar impact": impact(Soil(), angle=0.5),
        "impact with dashpots": impact(
            Soil(eta_N=0.1, eta_T=0.1, eta_R=0.1), angle=0.5
        ),
        "gradient": gradient(ellipsoid),
        "batch": batch,
        "planar impact of a cylinder": impact(Soil(), cylinder, angle=0.5),
        "gradient of a cylinder": gradient(cylinder),
    }


def use_of_peer(name: str, directory: str) -> Callable:
    """A batch of a few impacts by a peer."""
    from .charts.methods import find_peers
    from .impacts import mixed_scenes

    peers = find_peers(Path(directory), lambda text: None)
    peer = next(peer for peer in peers if peer.name == name)
    tolerance = peer.tolerances[len(peer.tolerances) // 2]
    scenes = mixed_scenes(4, 1)
    return lambda: peer.solve(scenes, tolerance, batch=True)


def main(started: str, name: str, directory: str) -> None:
    """Use and report.

    Args:
        started: `time.time()` when the process was started.
        name: of the use, or of a peer.
        directory: of the peers; empty for a use of our own. The import of a peer is not
            counted: it holds that of JAX, for the scenes.
    """
    import jax

    jax.config.update("jax_enable_x64", True)
    use = use_of_peer(name, directory) if directory else uses()[name]
    imported = 0.0 if directory else time.time() - float(started)
    seconds = []
    for _ in range(2):
        begin = time.perf_counter()
        use()
        seconds.append(time.perf_counter() - begin)
    first, second = seconds
    print(json.dumps({"import_s": imported, "first_s": first, "second_s": second}))


if __name__ == "__main__":
    main(*sys.argv[1:])
