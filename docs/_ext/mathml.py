"""Formulas as MathML, which browsers draw themselves.

Pages need no script and no network for them, and a formula that cannot be translated
is a warning of the build.
"""

import re

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging

logger = logging.getLogger(__name__)

ACCENT = re.compile(
    r"\\(dot|bar|hat|tilde)\s*(\\[a-zA-Z]+|[a-zA-Z]|\{[^{}]*\})(\s*(?=[_^]))?"
)
FRACTION = re.compile(r"\\([td]?frac)\s*([0-9a-zA-Z])\s*([0-9a-zA-Z])")
FUNCTION = re.compile(
    r"(?P<before>(?<=[\w})])\s*)?\\(?P<name>sin|cos|tan|arctan)\b(?P<after>\s*(?=[\\\w]))?"
)


def _accent(match: re.Match) -> str:
    # docutils would set an index of an accented letter under the letter.
    index = "" if match[3] is None else "{}"
    return rf"{{\{match[1]}{{{match[2]}}}}}{index}"


def _function(match: re.Match) -> str:
    before = "" if match["before"] is None else r"\,"
    after = "" if match["after"] is None else r"\,"
    return rf"{before}\{match['name']}{after} "


def prepared(source: str) -> str:
    """TeX as docutils reads and sets it rightly.

    Of a fraction without braces it would take a number of two digits for the numerator,
    and bars it would set as operators.
    """
    source = re.sub(r"(?<!\\left)\\lvert\b", r"\\left\\lvert", source)
    source = re.sub(r"(?<!\\right)\\rvert\b", r"\\right\\rvert", source)
    source = FRACTION.sub(r"\\\1{\2}{\3}", source)
    return FUNCTION.sub(_function, ACCENT.sub(_accent, source))


def _translated(node: nodes.Element, *, block: bool) -> str:
    source = node.astext()
    try:
        return tex2mathml(prepared(source), as_block=block)
    except MathError as error:
        logger.warning("formula %r: %s", source, error, location=node)
        return f"<code>{source}</code>"


def _inline(self, node: nodes.math) -> None:
    self.body.append(_translated(node, block=False))
    raise nodes.SkipNode


def _block(self, node: nodes.math_block) -> None:
    self.body.append(f'<div class="formula">{_translated(node, block=True)}</div>')
    raise nodes.SkipNode


def setup(app) -> dict:
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
