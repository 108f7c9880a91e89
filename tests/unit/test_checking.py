"""Shapes of users' own are tried before they are computed with; errors say what to
change."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaximpact.errors import InputError
from jaximpact.parameters import parameter
from jaximpact.part_checks import check_part
from jaximpact.shapes import (
    Ellipsoid,
    EllipticCylinder,
    RectangularPrism,
    Section,
    SemiAxes,
)


def changed(**functions):
    """A cylinder of this module, with some of its functions changed."""
    fields = {
        "aspect_ratio": parameter(1.5, "-", "(0, inf)", "H/R"),
        "out_of_plane_ratio": parameter(1.0, "-", "(0, inf)", "W/R"),
    }
    annotations = dict.fromkeys(fields, float)
    return type(EllipticCylinder)(
        "Mine",
        (EllipticCylinder,),
        fields | functions | {"__module__": __name__, "__annotations__": annotations},
    )()


def with_section(function):
    def section(self, axes, sin, cos, height, sinking):
        found = EllipticCylinder.section(self, axes, sin, cos, height, sinking)
        return function(found, sinking)

    return changed(section=section)


@pytest.mark.slow
@pytest.mark.parametrize("kind", [Ellipsoid, EllipticCylinder, RectangularPrism])
def test_the_packages_own_shapes_pass_as_users(kind):
    mine = type(kind)(
        f"My{kind.__name__}",
        (kind,),
        {"__module__": __name__, "__annotations__": {}},
    )
    # Of a class derived from one that declares the ratios they are declared too.
    check_part("shape", mine(aspect_ratio=1.5))


@pytest.mark.slow
def test_a_shape_that_declares_its_ratios_passes():
    check_part("shape", changed())


def numpy_inside(self, axes, sin, cos):
    return np.sqrt(float(sin)) + axes.minor


def wrong_axes(self, axes, sin, cos):
    return jnp.sqrt((axes.minor * cos) ** 2 + (axes.major * sin) ** 2)


def lopsided(self, axes, sin, cos):
    return EllipticCylinder.support(self, axes, sin, cos) + 0.1 * sin * cos


def twice_as_far(self, axes, sin, cos, *, side=None):
    return 2.0 * EllipticCylinder.tangency_arm(self, axes, sin, cos)


def wrong_if_elongated(self, axes, sin, cos, height, sinking):
    found = EllipticCylinder.section(self, axes, sin, cos, height, sinking)
    sign = jnp.where(self.aspect_ratio > 1.8, -1.0, 1.0)
    return found._replace(width=sign * found.width)


def without_a_root(found, sinking):
    return found._replace(width=jnp.sqrt(sinking))


@pytest.mark.parametrize(
    ("shape", "words"),
    [
        (
            lambda: changed(support=numpy_inside),
            r"Mine: a value is looked at in line \d+",
        ),
        (lambda: changed(support=wrong_axes), "at 0 degrees must be the half size H"),
        (lambda: changed(support=lopsided), "symmetric about its axes"),
        (
            lambda: changed(tangency_arm=twice_as_far),
            "tangency_arm must be the derivative of support by the orientation",
        ),
        (
            lambda: changed(unit_volume=property(lambda self: jnp.ones(3))),
            r"Mine: unit_volume.* must return a number, but returns an array",
        ),
        (
            lambda: changed(unit_inertia=property(lambda self: -1.0)),
            r"Mine: unit_inertia must be positive, but is -1",
        ),
        (lambda: with_section(lambda found, _: found[0]), r"must return Section\("),
        (
            lambda: with_section(lambda found, _: Section(*found[:2], jnp.ones(2))),
            r"Mine: section \(width\) must return a number, but returns an array of",
        ),
        (lambda: with_section(without_a_root), r"Mine: section.* is not finite"),
        (
            lambda: with_section(lambda f, _: f._replace(left=f.right, right=f.left)),
            "left <= right",
        ),
        (
            lambda: changed(section=wrong_if_elongated),
            "width that is not negative.* at an aspect ratio of 2 and an orientation",
        ),
        (
            lambda: changed(support=lambda self, axes: axes.minor),
            r"shape Mine: TypeError in line|the model calls",
        ),
    ],
)
def test_errors_name_function_and_cure(shape, words):
    with pytest.raises(InputError, match=words):
        check_part("shape", shape())


def lobed(self, axes, sin, cos):
    return EllipticCylinder.support(self, axes, sin, cos) * (
        1.0 + 0.1 * (sin * cos) ** 2
    )


def test_what_holds_for_an_ellipse_does_not_hold_for_what_is_none():
    one = jnp.asarray(1.0)
    axes, sin, cos = SemiAxes(one, one, one), jnp.sin(0.4), jnp.cos(0.4)
    shape = changed(aspect_ratio=parameter(1.0, "-", "(0, inf)", "H/R"), support=lobed)
    assert not shape.is_round()
    assert not shape.is_upright(0.4)
    # d/dx of 0.1 sin^2 x cos^2 x, by hand.
    expected = 0.1 * float(jnp.sin(0.8) * jnp.cos(0.8))
    assert float(shape.tangency_arm(axes, sin, cos)) == pytest.approx(
        expected, rel=1e-12
    )
    change = shape.support_change(axes, (0.0, 1.0), (sin, cos), sin)
    assert float(change) == pytest.approx(0.025 * float(jnp.sin(0.8)) ** 2, rel=1e-12)

    round_one = changed(aspect_ratio=parameter(1.0, "-", "(0, inf)", "H/R"))
    assert round_one.is_round()
    assert round_one.is_upright(0.4)


def test_a_shape_is_tried_at_aspect_ratios_of_its_range_alone():
    below = parameter(1.5, "-", "(0, 1.8]", "H/R")
    check_part("shape", changed(section=wrong_if_elongated, aspect_ratio=below))


def test_a_shape_is_tried_once():
    calls = []

    def support(self, axes, sin, cos):
        calls.append(1)
        return EllipticCylinder.support(self, axes, sin, cos)

    shape = changed(support=support)
    check_part("shape", shape)
    count = len(calls)
    check_part("shape", jax.tree.map(lambda x: 2.0 * x, shape))
    assert len(calls) == count > 0
