"""Eq. 17: force and sphericity, S_p = A_r^(-2/3)."""

from ..parts import FALLS, from_to, judge, steps_that_go, trend, trends
from ..study import Datasets, along_major_axis, along_minor_axis
from ..verdict import Judgement


def force_falls_with_sphericity(sets: Datasets) -> Judgement:
    """The largest N falls with A_r, thus with falling S_p."""
    vertical = {
        axis: sets[name].max_normal_force_N.values / 1e3
        for axis, name in (("major", "I"), ("minor", "II"))
    }
    inclined = {
        "major": along_major_axis(sets).max_normal_force_N,
        "minor": along_minor_axis(sets).max_normal_force_N,
    }
    return judge(
        "; ".join(
            f"vertical along the {axis} axis {from_to(force, 'kN')}, "
            f"{steps_that_go(force, FALLS)}"
            for axis, force in vertical.items()
        ),
        [
            *(trend(force, FALLS) for force in vertical.values()),
            *(
                trends(force, "aspect_ratio", FALLS, f"inclined, {axis} axis: falls")
                for axis, force in inclined.items()
            ),
        ],
        {
            f"{axis}_axis_{which}_kN": force[place]
            for axis, force in vertical.items()
            for which, place in (("sphere", 0), ("longest", -1))
        },
    )


CLAIMS = {"C33": force_falls_with_sphericity}
