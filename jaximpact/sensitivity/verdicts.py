"""What can be said of a number: whether it has a meaning, whether it is confirmed."""

import enum


class State(enum.IntEnum):
    """Whether an output has an elasticity by a parameter, or why not."""

    defined = 0
    """It has one."""
    parameter_is_zero = 1
    """No relative change of the parameter; the derivative is given."""
    output_is_zero = 2
    """No relative change of the output: it is zero, to the integration's error; the
    derivative is given."""
    output_has_no_value = 3
    """NaN, as e_t is at vertical incidence."""
    impact_failed = 4
    """The integration did not finish."""
    derivative_is_not_finite = 5
    """The impact has a value, but its derivative was lost."""

    def __str__(self) -> str:
        return self.name.replace("_", " ")

    @property
    def short(self) -> str:
        """As it fits in a cell of a table, x being the parameter and y the output."""
        return ("defined", "x=0", "y=0", "none", "failed", "lost")[self]


class Check(enum.IntEnum):
    """What differences of neighbouring impacts say of a derivative."""

    agrees = 0
    """Within `AGREES_WITHIN`."""
    differs = 1
    """The differences are smooth and give something else: do not trust it."""
    undecided = 2
    """The output has a jump or a kink so near that differences straddle it."""
    unchecked = 3
    """No check was asked for, or a neighbour has no value."""

    def __str__(self) -> str:
        return self.name


AGREES_WITHIN = 1e-3
"""Part of the larger of output and relative derivative by which the two may differ."""


def flags(kind: type[enum.IntEnum]) -> dict:
    """Attributes that say what codes mean, as the CF conventions write it."""
    return {
        "flag_values": [int(member) for member in kind],
        "flag_meanings": " ".join(member.name for member in kind),
    }
