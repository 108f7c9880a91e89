"""Impacts as a data frame: one row an impact, under the names of the tables."""

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from ..parameters import declared_of
from ..scene import Scene
from .columns import OUTCOME_COLUMN, RESULT_COLUMNS
from .datasets import SCENE_DIMENSION, dimension_names
from .inputs import Input, inputs_of, is_of_some, kind_of_each, varying_axes
from .results import outcomes_in_words
from .scenes import SHAPE, text_of, unusual_parts

if TYPE_CHECKING:
    from ..result import ImpactResult


def frame_of(result: "ImpactResult", all_inputs: bool) -> pd.DataFrame:
    """The data frame that `ImpactResult.to_dataframe` gives."""
    scene, shape = result.scene, result.shape
    columns: dict[str, object] = {}
    kinds = kind_of_each(scene, shape)
    if all_inputs:
        columns |= unusual_parts(scene)
    if kinds is not None and (all_inputs or varying_axes(kinds)):
        columns[SHAPE] = [text_of(kind) for kind in kinds.flat]
    for name, quantity in inputs_of(scene, shape).items():
        if quantity.axes or all_inputs:
            columns[name] = _values(scene, quantity, kinds)
    for name, column in RESULT_COLUMNS.items():
        columns[name] = np.ravel(np.asarray(getattr(result, column.field)))
    columns[OUTCOME_COLUMN] = np.ravel(outcomes_in_words(result.outcome_code))
    return pd.DataFrame(columns, index=_rows(shape))


def _values(scene: Scene, quantity: Input, kinds: np.ndarray | None) -> np.ndarray:
    """A column of a quantity; NaN in rows whose shape has no such parameter."""
    column, values, _ = quantity
    if kinds is None or not is_of_some(column, scene):
        return values.ravel()
    has = [column.field in declared_of(kind) for kind in kinds.flat]
    return np.where(has, values.ravel(), np.nan)


def _rows(shape: tuple[int, ...]) -> pd.Index:
    """Places of the impacts."""
    if len(shape) > 1:
        names = dimension_names(len(shape))
        return pd.MultiIndex.from_product(map(range, shape), names=names)
    return pd.RangeIndex(*(shape or (1,)), name=SCENE_DIMENSION)
