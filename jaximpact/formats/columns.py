"""The edge of the package: names and units of every quantity in tables and files.

One row here says how a column of a table, a key of a TOML file and a field of `Block`,
`Soil` or `Impact` belong together, in which unit, with which default and range.
"""

import dataclasses
import math

import numpy as np

from .units import DEGREE, UNITS, USUAL


@dataclasses.dataclass(frozen=True)
class InputColumn:
    """A quantity of the scene as users write it."""

    name: str
    part: str
    """"block", "soil" or "impact"."""
    field: str
    factor: float
    """SI value = factor x value in the column's unit."""
    default: float
    lower: float
    upper: float
    lower_allowed: bool
    upper_allowed: bool
    unit: str
    meaning: str
    usual: tuple[float, float] = (-math.inf, math.inf)
    """Values beyond which a unit may have been mistaken, in the column's unit."""

    @property
    def range_text(self) -> str:
        """The range in words."""
        if self.lower == -math.inf and self.upper == math.inf:
            return "finite"
        if self.upper == math.inf:
            return f"{'at least' if self.lower_allowed else 'above'} {self.lower:g}"
        left = "[" if self.lower_allowed else "("
        right = "]" if self.upper_allowed else ")"
        return f"in {left}{self.lower:g}, {self.upper:g}{right}"

    @property
    def requirement(self) -> str:
        """The range with its unit, to follow "must be"."""
        has_unit = self.unit != "-" and self.range_text != "finite"
        return f"{self.range_text} {self.unit}" if has_unit else self.range_text

    @property
    def si_unit(self) -> str:
        """Unit of the field."""
        units = UNITS.get(self.unit, {})
        return next((u for u, size in units.items() if size * self.factor == 1.0), "-")

    def hint(self, number: float, unit: str) -> str:
        """Which unit may have been meant by a number that was taken to be in `unit`, to
        follow a message; empty if none makes it usual."""
        units = UNITS.get(self.unit, {})
        for other, size in units.items():
            value = size * number
            if other == unit or not self.holds(value) or not self.is_usual(value):
                continue
            if other != "%" or 1.0 < number <= 100.0:
                meant = f"{value / units[unit]:.4g} {unit}".removesuffix(" -")
                return f"; {other}? {number:g} {other} is {meant}"
        return ""

    def told(self, number: float, unit: str, where: str = "") -> str:
        """A number in `unit` in words, with the column's unit, its place, the usual
        values if it is no error, and the unit that may be meant."""
        value = UNITS.get(self.unit, {}).get(unit, 1.0) * number
        text = f"{number:g} {unit}".removesuffix(" -")
        if unit != self.unit:
            text += f" = {value:.4g} {self.unit}"
        text += where
        if self.holds(value):
            usual = "usual are {:g} to {:g} {}".format(*self.usual, self.unit)
            text += "; " + usual.removesuffix(" -")
        return text + self.hint(number, unit)

    def is_usual(self, value: float) -> bool:
        """Whether a value, in the column's unit, is within the usual ones."""
        low, high = self.usual
        return low <= value <= high

    def holds(self, value: float) -> bool:
        """Whether one value, in the column's unit, is finite and in range."""
        above = value >= self.lower if self.lower_allowed else value > self.lower
        below = value <= self.upper if self.upper_allowed else value < self.upper
        return above and below and math.isfinite(value)

    def is_allowed(self, values) -> np.ndarray:
        """Which values, in the column's unit, are finite and in range."""
        values = np.asarray(values, float)
        above = values >= self.lower if self.lower_allowed else values > self.lower
        below = values <= self.upper if self.upper_allowed else values < self.upper
        return np.isfinite(values) & above & below


def _column(name, part, field, default, interval, unit, meaning, factor=1.0):
    left, right = interval[0], interval[-1]
    lower, upper = (float(x) for x in interval[1:-1].split(","))
    return InputColumn(
        name=name,
        part=part,
        field=field,
        factor=factor,
        default=default,
        lower=lower,
        upper=upper,
        lower_allowed=left == "[",
        upper_allowed=right == "]",
        unit=unit,
        meaning=meaning,
        usual=USUAL.get(name, (-math.inf, math.inf)),
    )


_INPUTS = (
    _column("mass_kg", "block", "mass", 100.0, "(0, inf)", "kg", "mass"),
    _column("density_kgm3", "block", "density", 2577.8, "(0, inf)", "kg/m3", "density"),
    _column(
        "aspect_ratio",
        "block",
        "aspect_ratio",
        1.0,
        "(0, inf)",
        "-",
        "H/R; below 1 an oblate block",
    ),
    _column(
        "out_of_plane_ratio", "block", "out_of_plane_ratio", 1.0, "(0, inf)", "-", "W/R"
    ),
    _column("speed_mps", "impact", "speed", 14.0, "(0, inf)", "m/s", "impact speed"),
    _column(
        "angle_deg",
        "impact",
        "angle",
        0.0,
        "(-90, 90)",
        "deg",
        "impact angle from the ground's normal; negative up-slope",
        DEGREE,
    ),
    _column(
        "orientation_deg",
        "impact",
        "orientation",
        0.0,
        "(-inf, inf)",
        "deg",
        "angle from the ground's normal to the major axis",
        DEGREE,
    ),
    _column(
        "angular_velocity_degps",
        "impact",
        "angular_velocity",
        0.0,
        "(-inf, inf)",
        "deg/s",
        "spin at impact, clockwise positive",
        DEGREE,
    ),
    _column(
        "slope_deg", "impact", "slope", 0.0, "(-90, 90)", "deg", "slope angle", DEGREE
    ),
    _column(
        "unit_weight_kNm3",
        "soil",
        "unit_weight",
        18.0,
        "(0, inf)",
        "kN/m3",
        "unit weight of the ground",
        1e3,
    ),
    _column(
        "friction_angle_deg",
        "soil",
        "friction_angle",
        30.0,
        "(0, 60)",
        "deg",
        "friction angle phi'",
        DEGREE,
    ),
    _column(
        "relative_density",
        "soil",
        "relative_density",
        0.90,
        "[0, 1]",
        "-",
        "relative density D_r0 (0 to 1, not percent)",
    ),
    _column("k_E", "soil", "k_E", 900.0, "(0, inf)", "-", "modulus number"),
    _column("n_E", "soil", "n_E", 0.40, "[0, 2]", "-", "modulus exponent"),
    _column("poisson", "soil", "poisson", 0.30, "[0, 0.5]", "-", "Poisson's ratio"),
    _column("S_ef", "soil", "S_ef", 1.0, "(0, inf)", "-", "factor on the modulus"),
    _column("eta_N", "soil", "eta_N", 0.0, "[0, inf)", "-", "damping ratio, normal"),
    _column(
        "eta_T", "soil", "eta_T", 0.0, "[0, inf)", "-", "damping ratio, tangential"
    ),
    _column(
        "eta_R", "soil", "eta_R", 0.0, "[0, inf)", "-", "damping ratio, rotational"
    ),
    _column("beta", "soil", "beta", 0.90, "(0, 2)", "-", "loading surface exponent"),
    _column("c_v", "soil", "c_v", 1.0, "[0, inf)", "-", "hardening rate"),
    _column("gamma_v", "soil", "gamma_v", 8.7, "[0, inf)", "m/s", "fluidity"),
    _column(
        "delta_1", "soil", "delta_1", 5.0, "(-inf, inf)", "-", "peak friction slope"
    ),
    _column(
        "delta_2", "soil", "delta_2", 1.0, "(-inf, inf)", "-", "peak friction offset"
    ),
    _column(
        "alpha_vT", "soil", "alpha_vT", 2.53, "[0, inf)", "-", "hardening by sliding"
    ),
    _column(
        "alpha_vR", "soil", "alpha_vR", 0.0, "[0, inf)", "-", "hardening by rocking"
    ),
    _column("psi", "soil", "psi", 0.33, "(0, inf)", "-", "moment intercept"),
    _column(
        "alpha_s",
        "soil",
        "alpha_s",
        1.0,
        "[0, inf)",
        "-",
        "block-soil over soil friction",
    ),
    _column("dilatancy", "soil", "dilatancy", 0.0, "[0, 1]", "-", "heave admitted"),
)
INPUT_COLUMNS: dict[str, InputColumn] = {column.name: column for column in _INPUTS}


@dataclasses.dataclass(frozen=True)
class ResultColumn:
    """A number of the result as users read it."""

    name: str
    field: str
    unit: str
    meaning: str


RESULT_COLUMNS: dict[str, ResultColumn] = {
    column.name: column
    for column in (
        ResultColumn("e_n", "e_n", "-", "apparent normal restitution"),
        ResultColumn("e_t", "e_t", "-", "apparent tangential restitution"),
        ResultColumn(
            "e_contact", "e_contact", "-", "normal restitution at the contact"
        ),
        ResultColumn("e_bar", "e_bar", "-", "energetic restitution"),
        ResultColumn("R_r", "R_r", "-", "final rotational over total kinetic energy"),
        ResultColumn("max_penetration_m", "max_penetration", "m", "largest u_n"),
        ResultColumn("max_sinking_m", "max_sinking", "m", "largest u_D"),
        ResultColumn("max_normal_force_N", "max_normal_force", "N", "largest N"),
        ResultColumn("max_moment_Nm", "max_moment", "N m", "largest |M|"),
        ResultColumn("duration_s", "duration", "s", "time in contact"),
        ResultColumn("rotation_rad", "rotation", "rad", "rotation during contact"),
        ResultColumn("v_n_mps", "normal_velocity", "m/s", "final v_n, into the ground"),
        ResultColumn("v_t_mps", "tangential_velocity", "m/s", "final v_t, down-slope"),
        ResultColumn("omega_radps", "angular_velocity", "rad/s", "final spin"),
    )
}
FURTHER_COLUMNS: dict[str, ResultColumn] = {
    column.name: column
    for column in (
        ResultColumn("e_n_vijayakumar", "e_n_vijayakumar", "-", "e_n of a rigid body"),
        ResultColumn(
            "max_tangential_force_N", "max_tangential_force", "N", "largest |T|"
        ),
        ResultColumn(
            "time_of_max_penetration_s",
            "time_of_max_penetration",
            "s",
            "when u_n is largest",
        ),
        ResultColumn(
            "time_of_max_sinking_s", "time_of_max_sinking", "s", "when u_D is"
        ),
        ResultColumn(
            "time_of_max_normal_force_s", "time_of_max_normal_force", "s", "when N is"
        ),
        ResultColumn(
            "time_of_max_tangential_force_s",
            "time_of_max_tangential_force",
            "s",
            "when |T| is",
        ),
        ResultColumn("time_of_max_moment_s", "time_of_max_moment", "s", "when |M| is"),
        ResultColumn("final_penetration_m", "final_penetration", "m", "u_n at the end"),
        ResultColumn("final_sinking_m", "final_sinking", "m", "u_D at the end"),
        ResultColumn("steps", "steps", "-", "steps of the integration"),
    )
}
"""Results that a table of results does not hold."""
OUTCOME_COLUMN = "outcome"
OUTCOME_MEANING = (
    "how it ended: detached, toppled, arrested, in contact, separating or failed"
)
SIGMA_PREFIX = "sigma_"
"""Before the name of a result column: the standard deviation of a measured value."""
LABEL_COLUMNS = ("name", "id", "test", "campaign", "source", "note", "comment")
"""Columns of free text, which identify a row and are carried along."""


def column_of_field(part: str, field: str) -> InputColumn:
    """The input column that stands for a field."""
    return next(c for c in _INPUTS if c.part == part and c.field == field)
