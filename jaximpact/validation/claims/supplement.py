"""The supplementary material: other pairs of c_v and gamma_v."""

from collections import Counter

from ...parametric_sets import GROUNDS
from ..parts import condition, judge
from ..study import Study
from ..verdict import Judgement, Verdict
from . import figure_4, figure_5, figure_6, figure_7, figure_8, figure_9

OF_SETS = (
    figure_4.CLAIMS
    | figure_5.CLAIMS
    | figure_6.CLAIMS
    | figure_7.CLAIMS
    | figure_8.CLAIMS
    | figure_9.CLAIMS
)
"""The claims of sets I to IV."""


def alike_on_other_grounds(study: Study) -> Judgement:
    """The claims of sets I to IV have the same verdict on the other two grounds."""
    table_1, *others = (
        {name: judge(study.on(ground)).verdict for name, judge in OF_SETS.items()}
        for ground in GROUNDS
    )
    parts, words, numbers = [], [in_words(GROUNDS[0], table_1)], {}
    for ground, verdicts in zip(GROUNDS[1:], others, strict=True):
        different = [name for name in OF_SETS if verdicts[name] != table_1[name]]
        parts += [condition(verdicts[name] == table_1[name]) for name in OF_SETS]
        changes = ", ".join(f"{name} {verdicts[name]}" for name in different)
        words.append(f"{in_words(ground, verdicts)}, others: {changes or 'none'}")
        numbers[f"different_with_{ground.replace(', ', '_').replace(' ', '_')}"] = len(
            different
        )
    return judge("; ".join(words), parts, numbers)


def in_words(ground: str, verdicts: dict[str, Verdict]) -> str:
    """How many of the claims hold on a ground."""
    counts = Counter(verdicts.values())
    kinds = (Verdict.holds, Verdict.partly, Verdict.fails)
    return f"{ground}: " + "/".join(str(counts[kind]) for kind in kinds)


CLAIMS = {"C38": alike_on_other_grounds}
