"""Drawings of a back-analysis."""

from functools import partial

import numpy as np
from matplotlib.figure import Figure

from ...plotting.style import (
    BLUE,
    GREY,
    VERMILION,
    in_style,
    legend_outside,
    panels,
)
from ...reports.tables import at_x
from .posterior import FittedParameter
from .predictive import ChannelPrediction, Curve
from .problem import ENDS

# Inches: two stand side by side on a page.
panel = partial(panels, height=3.5, width=4.6)


@in_style
def draw_marginal(fitted: FittedParameter, samples: np.ndarray) -> Figure:
    """Draw samples of a parameter beside its prior."""
    figure, (axes,) = panel()
    prior, name = fitted.parameter.prior, fitted.parameter.name
    bulk = tuple(np.quantile(samples, (0.002, 0.998)))
    look = {"color": BLUE, "alpha": 0.6, "label": "posterior"}
    counts, edges, _ = axes.hist(samples, 20, range=bulk, density=True, **look)
    low, high = min(edges[0], fitted.prior_low), max(edges[-1], fitted.prior_high)
    u = np.linspace(ENDS[0], ENDS[-1], 2001)
    x = prior.values(u)
    apart = np.maximum(np.diff(x), 1e-300)
    axes.plot(0.5 * (x[1:] + x[:-1]), np.diff(u) / apart, color=GREY, label="prior")
    for end in (fitted.low, fitted.high):
        axes.axvline(end, color=VERMILION, ls="--", lw=1.0, label="95 % interval")
    axes.set(xlabel=name, ylabel="density", xlim=(low, high))
    axes.set_ylim(0.0, 1.1 * float(np.max(counts)))
    legend_outside(figure)
    return figure


@in_style
def draw_channel(prediction: ChannelPrediction) -> Figure:
    """Draw the cumulative share of observed values, and the band of predicted ones."""
    figure, (axes,) = panel()
    channel, predicted = prediction.channel, prediction.predicted
    finite = predicted[np.isfinite(predicted)]
    observed = np.sort(channel.values)
    # One block that went far would press all others together.
    most = np.quantile(finite, (0.01, 0.99)) if len(finite) else observed
    every = np.concatenate([most, observed])
    x = np.linspace(np.min(every), np.max(every), 200)
    rows = [row[np.isfinite(row)] for row in predicted]
    shares = [np.searchsorted(row, x, "right") / len(row) for row in rows if len(row)]
    if shares:
        low, middle, high = np.quantile(shares, (0.025, 0.5, 0.975), axis=0)
        axes.fill_between(x, low, high, color=BLUE, alpha=0.25, label="95 %")
        axes.plot(x, middle, color=BLUE, label="predicted")
    # From 0 on, so that the line is seen of one block too.
    steps = np.arange(len(observed) + 1) / len(observed)
    at = np.concatenate([observed[:1], observed])
    axes.step(at, steps, where="post", color=VERMILION, label="observed")
    axes.set(xlabel=channel.words, ylabel="cumulative share", ylim=(0.0, 1.0))
    legend_outside(figure)
    return figure


@in_style
def draw_curve(curve: Curve) -> Figure:
    """Draw the share of released blocks that exceed a value."""
    figure, (axes,) = panel()
    axes.fill_between(curve.values, curve.low, curve.high, color=BLUE, alpha=0.25)
    axes.plot(curve.values, curve.share, color=BLUE)
    axes.set(
        xlabel=f"{curve.quantity} at {at_x(curve.place)}",
        ylabel="share of blocks that exceed it",
        ylim=(0.0, max(1e-3, 1.05 * float(np.max(curve.high)))),
    )
    return figure
