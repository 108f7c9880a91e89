"""The result of one impact, or of many: its numbers, and what they were computed from.

Arrays of NumPy, of JAX, and those that a JAX transformation traces serve alike. Words,
tables and pictures need values that are known.
"""

import dataclasses
from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

import equinox as eqx
import jax
import numpy as np

from ._jax_internals import Tracer
from ._packages import versions
from ._tables import Row, align, html_table
from .accuracy import Accuracy
from .backend import MACHINE_CODE
from .identity import part_names
from .impact.events import Outcome
from .impact.results import History, ImpactSummary
from .quantities import ENERGY_COLUMNS, FURTHER_COLUMNS, RESULT_COLUMNS
from .scene import Scene, Selection
from .scene_quantities import scene_values

if TYPE_CHECKING:  # both take a while to load
    import pandas as pd
    import xarray as xr


class ImpactResult(ImpactSummary):
    """Everything about one impact, or about many: its numbers, its scene, its history.

    The number of one impact is a scalar; of many impacts it is an array of the shape
    `result.shape`, and the result is indexed as such an array: `result[3]`,
    `result[2:5]`, `result[result.e_n > 0.1]`, `result[i, j]`. A selection is again a
    result, with the scenes that belong to it, in arrays of NumPy or of JAX as before.
    A failed impact has NaN in every number but `steps`, the steps that it took.

    Symbols: n is into the ground, t down-slope, rotation clockwise; u_n is the
    penetration of the block's centre, u_D that of its lowest point, v_n and v_t are
    velocities of the centre; N, T and M are the normal force, the tangential force and
    the moment of the ground. `e_n` is -v_n after over v_n before the impact, and
    negative where the block still moves into the ground as the contact ends.
    """

    scene: Scene
    """The impacts' blocks, soils and arrivals, in SI units."""
    accuracy: Accuracy = eqx.field(static=True)
    """Tolerances of the integration."""
    history: History | None = None
    """Forces, motion and energies against time; None where none was asked for."""
    engine: str = eqx.field(default=MACHINE_CODE, static=True)
    """Engine asked for: machine code (XLA where there is none), or diffrax, with the
    name of the solver if that is not the package's own."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of every number; `()` for one impact."""
        return np.shape(self.outcome_code)

    @property
    def outcome(self) -> Outcome | np.ndarray:
        """How the impact ended; of many impacts an array of words, of type `str`
        as in tables and datasets, which compares with a word:
        `result.outcome == "failed"`.

        Inside a JAX transformation there is `outcome_code` alone, which compares with
        the members of `Outcome`.
        """
        if self.shape == ():
            return Outcome(int(self.outcome_code))
        from .io.result_table import outcomes_in_words

        return outcomes_in_words(self.outcome_code)

    def outcome_counts(self) -> dict[str, int]:
        """Count the impacts that ended in each way; ways that did not occur are left
        out."""
        from .io.result_table import count_outcomes

        return count_outcomes(self)

    def __len__(self) -> int:
        if self.shape == ():
            raise TypeError("this is the result of one impact, which has no length")
        return self.shape[0]

    def __bool__(self) -> bool:
        """True for one impact; of many, whether there are any. Without this the truth
        of one impact would be asked of its length, which it does not have."""
        return self.shape == () or len(self) > 0

    def __iter__(self) -> "Iterator[ImpactResult]":
        if self.shape == ():
            raise TypeError(
                "this is the result of one impact, over which nothing can be iterated"
            )
        return (self[index] for index in range(len(self)))

    def __getitem__(self, index) -> "ImpactResult":
        """Select some of the impacts, as an array of them is indexed.

        Fields of the scene that are one number for all impacts stay one number, but a
        shape that differs from impact to impact becomes that of the impact selected.

        Raises IndexError as NumPy does; inside a JAX transformation an index beyond an
        end counts as the end, as in JAX.
        """
        selection = Selection(self.shape, index, self)
        selected = {
            field.name: selection.of_numbers(getattr(self, field.name))
            for field in dataclasses.fields(ImpactSummary)
        }
        selected["scene"] = selection.of_scene(self.scene)
        selected["history"] = selection.of_history(self.history)
        if isinstance(self.outcome_code, jax.Array) and not selection.traced:
            selected = jax.device_put(selected)
        return dataclasses.replace(self, **selected)

    def __repr__(self) -> str:
        if not self._is_known():
            return eqx.Module.__repr__(self)
        heads, rows = self._shown()
        return "\n".join([*heads, *([align(rows)] if rows else [])])

    def _repr_html_(self) -> str:
        if not self._is_known():
            return f"<pre>{eqx.Module.__repr__(self)}</pre>"
        return html_table(*self._shown())

    def _shown(self) -> tuple[list[str], list[Row]]:
        from .io.display import heads_and_rows

        return heads_and_rows(self, self.scene, self.accuracy.name, self.history)

    def _is_known(self) -> bool:
        """Whether the values can be shown: not while a transformation traces them or
        holds other things in the fields, nor in trees of derivatives or of means, which
        have no outcomes."""
        names = [f.name for f in dataclasses.fields(ImpactSummary)]
        numbers = [getattr(self, name) for name in names if name != "energy"]
        leaves = jax.tree.leaves((self.scene, numbers), is_leaf=lambda x: x is None)
        if not all(map(_is_known, leaves)):
            return False
        # Derivatives of codes are 0, as the code of an outcome is, but so are those of
        # steps, of which every impact that ended has some.
        ended = ~np.isin(self.outcome_code, (Outcome.separating, Outcome.failed))
        known = np.isin(self.outcome_code, list(Outcome))
        return bool(np.all(known & ~(ended & (np.asarray(self.steps) < 1.0))))

    def _check_known(self, what: str) -> None:
        """Raise ValueError, for a method, where JAX traces or differentiates."""
        if any(isinstance(leaf, Tracer) for leaf in jax.tree.leaves(self)):
            raise ValueError(
                f"{what} needs numbers that are known; call it outside of jit, vmap "
                "and derivatives"
            )

    def to_dataframe(self, *, all_inputs: bool = False) -> "pd.DataFrame":
        """Make a table with one row an impact, as `jaximpact batch` writes it.

        Columns, from the left:

        - the quantities of the scene that vary, in the units of their names
          (`mass_kg`, `angle_deg`; NaN where the shape of a row has no such parameter),
        - the results: `e_n`, `e_t`, `e_contact`, `e_bar`, `R_r` [-],
          `max_penetration_m`, `max_sinking_m` [m], `max_normal_force_N` [N],
          `max_moment_Nm` [N m], `duration_s` [s], `rotation_rad` [rad], `v_n_mps`,
          `v_t_mps` [m/s], `omega_radps` [rad/s]; NaN in a failed impact,
        - `outcome` in words.

        Rows are numbered from 0; with several axes there is a level of the index for
        each.

        Args:
            all_inputs: also the quantities that are the same for all impacts, and the
                names of laws and shapes that are not the usual ones.
        """
        from .io.datasets import frame_of

        self._check_known("to_dataframe")
        return frame_of(self, self.scene, all_inputs)

    def to_xarray(self, dims: tuple[str, ...] | None = None) -> "xr.Dataset":
        """Make a dataset of every number, with units, meanings and provenance, as
        `sweep` gives it.

        Quantities of the scene that vary are coordinates along the dimensions along
        which they do; all others stand in the attribute `base`. With the energy ledger
        there are variables `energy_*_J`, and histories at times
        of `save_at` that all impacts share are variables over `time`.

        Args:
            dims: names of the dimensions, one for each axis of `result.shape`; by
                default `scene`, or `scene_0`, `scene_1` and so on. The name of a
                quantity that varies along that axis alone (`"angle_deg"`) makes it the
                index of the dimension.

        Raises InputError for names that cannot be those of the dimensions.
        """
        from .io.datasets import dataset_of_impacts

        self._check_known("to_xarray")
        return dataset_of_impacts(self, self.scene, self.accuracy, dims)

    def plot(self, path=None, *, ax=None) -> "np.ndarray":
        """Draw force, penetration, rotation and energy against time, and a side view.

        The history is drawn if every step was asked for; otherwise the impact is
        recorded again.

        Args:
            path: where to save the figure too, in the format that the suffix names
                (png, pdf, svg); a file of that name is replaced once the new one is
                whole.
            ax: five axes to draw on. Without axes and path the figure is one of
                `matplotlib.pyplot`, which notebooks show.

        Returns the axes of the five panels.

        Raises ValueError for a result of many impacts, and for a suffix that names no
        format.
        """
        from .backend.derivative_rules import solve_recorded
        from .plotting.impact import plot_impact
        from .plotting.style import plotted

        self._check_known("plot")
        if self.shape:
            raise ValueError(
                f"plot draws one impact, but the result has shape {self.shape}; choose "
                "one, as in result[0].plot()"
            )
        recorded = self.history
        # At the times of `save_at` it need not hold the peaks, nor the end.
        if recorded is None or recorded.in_contact is not None:
            _, recorded = solve_recorded(self.scene, self.accuracy)
        return plotted(partial(plot_impact, self, self.scene, recorded), path, ax)

    def manifest(self) -> dict:
        """State what is needed to compute this again, ready for JSON."""
        self._check_known("manifest")
        return {
            "scene": scene_values(self.scene),
            "laws": part_names(self.scene.soil, self.scene.block),
            "accuracy": dataclasses.asdict(self.accuracy),
            "engine": self.engine,
            "versions": versions(),
        }


def _is_known(leaf) -> bool:
    if isinstance(leaf, jax.Array):
        return not isinstance(leaf, Tracer) and not leaf.is_deleted()
    return isinstance(leaf, np.ndarray | np.generic | float)


def _described(heading: str, columns: dict) -> str:
    """Return the numbers with unit and meaning, as lines of a docstring."""
    lines = [f"        {c.field} [{c.unit}]: {c.meaning}." for c in columns.values()]
    return "\n".join(["", f"    {heading}:", *lines, ""])


ImpactResult.__doc__ = f"{ImpactResult.__doc__}" + "".join(
    [
        _described("Numbers", RESULT_COLUMNS | FURTHER_COLUMNS),
        _described("Energies, in `energy`", ENERGY_COLUMNS),
    ]
)
"""Every number with its unit and meaning, from the one place where these are said."""
