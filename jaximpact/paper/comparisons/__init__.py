"""The model beside laws that others fitted to measured impacts."""

from ...progress import Progress, ProgressFunction, as_progress
from .comparison import Comparison
from .restitution_angle import compare_restitution_angle
from .vertical_drops import compare_scaling, compare_stopping_depth

STUDIES = (compare_scaling, compare_restitution_angle, compare_stopping_depth)


def compare_with_laws(
    progress: Progress | ProgressFunction | None = None,
) -> list[Comparison]:
    """Make every comparison with a law, on Table 1; some seconds on two cores.

    Args:
        progress: called as `progress(done, studies)`.

    Needs double precision, as everything here does. The figures are drawn when a
    comparison's `draw` is called; those of one `figure_name` are the same.
    """
    progress = as_progress(progress)
    rows: list[Comparison] = []
    for done, study in enumerate(STUDIES, start=1):
        rows += study()
        progress("laws", done, len(STUDIES))
    return rows
