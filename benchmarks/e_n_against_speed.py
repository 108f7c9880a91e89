"""e_n against the impact speed: which laws follow what was measured on turf, and why.

    python -m benchmarks.e_n_against_speed [--out docs/images/e-n-against-speed.png]

The measurements are a published law, not points: e_n = 0.510 - 0.0375 v + 0.000903 v^2
for golf balls on turf up to 20 m/s (Penner 2002, The run of a golf ball, Can. J. Phys.
80, 931-940). It is evaluated at 17 speeds from 1 to 17.5 m/s; five laws are fitted to
it, and compared by single tests. Told are the comparison, and for two grounds the mean
pressure and the stiffness of the springs at the largest force.
"""

import argparse
from pathlib import Path

import jax
import numpy as np

MASS, RADIUS = 0.04593, 0.021335
SPEEDS = np.array([*np.arange(1.0, 17.0), 17.5])
GROUNDS = "model", "elasticity ContactPressureModulus"
LAWS = (
    *("model", "ContactPressureModulus", "FluidityRate"),
    *("constant coefficients", "Pfeiffer and Bowen"),
)


def main() -> None:
    jax.config.update("jax_enable_x64", True)
    from jaximpact.calibration import compare
    from jaximpact.plotting.style import in_style

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    drops = measured_drops()
    block = {name: drops[name] for name in ("mass_kg", "density_kgm3")}
    measured = drops["e_n"]
    found = compare(drops, LAWS)
    print(found)
    for law in found.compared.laws:
        print(f"{law.name}: rms {law.rms[0]:.3f}, left out {law.rms_left_out[0]:.3f}")
    for name in GROUNDS:
        _explain(name, found.law(name).parameters, block)
    if arguments.out:
        in_style(_draw)(found, measured, arguments.out)


def measured_drops() -> dict:
    """Columns of the drops, as the law has them."""
    density = MASS / (4.0 / 3.0 * np.pi * RADIUS**3)
    measured = 0.510 - 0.0375 * SPEEDS + 0.000903 * SPEEDS**2
    block = {"mass_kg": MASS, "density_kgm3": density}
    return block | {"speed_mps": SPEEDS, "e_n": measured}


def _explain(name: str, parameters: dict[str, float], block: dict) -> None:
    """Print pressure and stiffness at the largest force for a slow and a fast drop."""
    from jaximpact import Block, Impact, Soil, simulate
    from jaximpact.laws import ContactPressureModulus, DuncanChang

    elasticity = DuncanChang() if name == "model" else ContactPressureModulus()
    soil = Soil(elasticity=elasticity, **parameters)
    for speed in (SPEEDS[0], SPEEDS[-1]):
        result = simulate(
            Block(mass=block["mass_kg"], density=block["density_kgm3"]),
            soil,
            Impact(speed=speed),
            history=True,
        )
        history = result.history
        assert history is not None  # it was asked for
        place = int(np.argmax(history.normal_force))
        force = float(history.normal_force[place])
        length = float(history.foundation_length[place])
        pressure = force / (0.25 * np.pi * length**2)
        # The elastic energy of a spring is half of force times displacement.
        stiffness = force**2 / (2.0 * float(history.elastic[place]))
        print(
            f"{name}, {speed:g} m/s: e_n {float(result.e_n):.3f}, force {force:.3g} N, "
            f"pressure {pressure / 1e3:.3g} kPa, stiffness {stiffness / 1e3:.3g} kN/m"
        )


def _draw(found, measured: np.ndarray, path: Path) -> None:
    from jaximpact.plotting.style import curve, panels, save_figure

    figure, (axes,) = panels(1, 1, height=3.6)
    axes.plot(SPEEDS, measured, "ko", ms=4, label="turf, after Penner (2002)")
    for place, law in enumerate(found.compared.laws):
        label = f"{law.name}, rms {law.rms_left_out[0]:.3f}"
        axes.plot(SPEEDS, law.left_out.predicted[:, 0], label=label, **curve(place))
    axes.set(
        xlabel="impact speed [m/s]", ylabel="e_n, each left out [-]", ylim=(0, 0.6)
    )
    axes.legend()
    save_figure(figure, path)


if __name__ == "__main__":
    main()
