"""Laws of users: what is wrong with one is said in one line."""

import dataclasses
import re

import jax
import numpy as np
import pytest

from jaximpact import Block, Impact, Scene, Soil, simulate
from jaximpact.errors import InputError

pytestmark = pytest.mark.slow

HEAD = """
import math
import jax.numpy as jnp
import numpy as np
from jaximpact.laws import *
"""
WRONG = {
    "numpy inside": (
        """
class Wrong(AbstractFlow):
    def __call__(self, load, hardening, foundation, *, branch=None):
        return displacement_rates(np.exp(load.size), load, 0.0, branch=branch)
""",
        r"flow Wrong: numpy is used in line 9 of .*laws.py .*; use jax.numpy",
    ),
    "a function of math": (
        """
class Wrong(AbstractFlow):
    def __call__(self, load, hardening, foundation, *, branch=None):
        return displacement_rates(math.exp(load.size), load, 0.0, branch=branch)
""",
        r"flow Wrong: a value is looked at in line 9 .*use jnp.where and jax.numpy",
    ),
    "an if": (
        """
class Wrong(AbstractHardening):
    def __call__(self, hardening, flow, foundation, *, branch=None):
        return flow.normal if flow.normal > 0.0 else -flow.normal
""",
        r"hardening Wrong: a value is looked at in line 9 .*use jnp.where",
    ),
    "a sum over impacts": (
        """
class Wrong(AbstractHardening):
    def __call__(self, hardening, flow, foundation, *, branch=None):
        return jnp.max(flow.normal)
""",
        r"hardening Wrong: __call__ .* gave shape \(\) for the result; use functions",
    ),
    "an array too many": (
        """
class Wrong(AbstractBearing):
    def __call__(self, foundation, unit_weight_normal, factors, *, branch=None):
        return jnp.stack([foundation.length] * 3)
""",
        r"bearing Wrong: __call__ .* gave shape \(3, 2\) for the result",
    ),
    "a bare tuple": (
        """
class Wrong(AbstractFlow):
    def __call__(self, load, hardening, foundation, *, branch=None):
        return (load.size, 0.0, 0.0)
""",
        r"returned a tuple of 3, but FlowRate\(normal, tangential, rotational\)",
    ),
    "nothing": (
        """
class Wrong(AbstractPeakFriction):
    def __call__(self, friction_angle, relative_density):
        friction_angle + 0.1
""",
        r"peak_friction Wrong: __call__ gave None .* but a float64 number is needed",
    ),
    "aside under a central load": (
        """
class Wrong(AbstractFlow):
    def __call__(self, load, hardening, foundation, *, branch=None):
        return FlowRate(load.size, 0.1, 0.0)
""",
        "gives a tangential or rotational rate of 0.1 under a central load",
    ),
    "other arguments": (
        """
class Wrong(AbstractFlow):
    def __call__(self, load, hardening):
        return FlowRate(load.size, 0.0, 0.0)
""",
        r"the model calls __call__\(self, load, hardening, foundation, \*, branch=None",
    ),
    "a parameter without a default": (
        """
class Wrong(AbstractFlow):
    rate: Scalar
    def __call__(self, load, hardening, foundation, *, branch=None):
        return FlowRate(load.size, 0.0, 0.0)
""",
        r"missing 1 required .* 'rate'; give every parameter a default",
    ),
    "a bare number": (
        """
class Wrong(AbstractFlow):
    rate: float = 3.0
    def __call__(self, load, hardening, foundation, *, branch=None):
        return FlowRate(load.size, 0.0, 0.0)
""",
        r"Wrong.rate is no parameter; write rate: Scalar = parameter",
    ),
    "two parameters of one name": (
        """
class Wrong(AbstractFlow):
    c_v: Scalar = parameter(1.0, "-", "(0, inf)", "mine")
    def __call__(self, load, hardening, foundation, *, branch=None):
        return FlowRate(load.size, 0.0, 0.0)
""",
        "HardeningPerLength.c_v and Wrong.c_v are two parameters of one name; rename",
    ),
    "a column that there is": (
        """
class Wrong(AbstractFlow):
    weight: Scalar = parameter(1.0, "-", "(0, inf)", "mine", column="mass_kg")
    def __call__(self, load, hardening, foundation, *, branch=None):
        return FlowRate(load.size, 0.0, 0.0)
""",
        "two parameters have the column mass_kg: mass of the block and weight of",
    ),
    "a column of results": (
        """
class Wrong(AbstractFlow):
    e_n: Scalar = parameter(1.0, "-", "(0, inf)", "mine")
    def __call__(self, load, hardening, foundation, *, branch=None):
        return FlowRate(load.size, 0.0, 0.0)
""",
        "the parameter e_n of the soil has the column e_n, which is that of a result",
    ),
    "a range that is none": (
        """
class Wrong(AbstractFlow):
    rate: Scalar = parameter(1.0, "-", "above 0", "mine")
""",
        r"the range must be an interval as in '\(0, inf\)'",
    ),
    "a default out of its range": (
        """
class Wrong(AbstractFlow):
    rate: Scalar = parameter(-1.0, "-", "[0, 1]", "mine")
""",
        "the default is not in the range",
    ),
    "no equation": (
        """
class Wrong(AbstractFlow):
    pass
""",
        "Wrong does not define __call__",
    ),
    "another kind of law": (
        """
class Wrong(Vesic):
    pass
""",
        r"Wrong must derive from AbstractFlow \(class Wrong\(AbstractFlow\): ...\)",
    ),
    "another name": ("class Other: pass", "there is no class Wrong; did you mean"),
    "an error of its own": ("1 / 0", r"cannot be run .* \(line 6\): ZeroDivisionError"),
    "no Python": ("class (:", "SyntaxError"),
}
SLOTS = {
    "Hardening": "hardening",
    "Bearing": "bearing",
    "PeakFriction": "peak_friction",
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_with_a_law_is_told(what, tmp_path):
    text, message = WRONG[what]
    (tmp_path / "laws.py").write_text(HEAD + text)
    derives = re.search(r"Wrong\(Abstract(\w+)\)", text)
    slot = SLOTS.get(derives[1], "flow") if derives else "flow"
    with pytest.raises(InputError, match=message):
        simulate(Block(), Soil(**{slot: f"{tmp_path}/laws.py:Wrong"}), Impact())


def test_a_law_by_its_class_or_an_unknown_name_is_told():
    with pytest.raises(InputError, match=r"write Vesic\(\)"):
        Soil(bearing=type(Soil().bearing))
    with pytest.raises(InputError, match="cannot be read"):
        Soil(flow="not_there.py:Mine")
    with pytest.raises(InputError, match="cannot be imported"):
        Soil(flow="no.such.module:Mine")
    with pytest.raises(TypeError, match=r"no parameter 'gama_v'; did you mean gamma_v"):
        Soil(gama_v=1.0)
    with pytest.raises(AttributeError, match="with flow FluidityRate; did you mean"):
        _ = Soil(flow="fluidity-rate").gama


def test_values_are_kept_and_set_by_name_alone():
    soil = Soil(flow="PowerNucleus", gamma_v=2.0, nucleus_exponent=3.0, c_v=[0.5, 1.0])
    assert float(soil.gamma_v) == float(soil.flow.gamma_v) == 2.0
    assert float(soil.nucleus_exponent) == 3.0
    changed = dataclasses.replace(soil, gamma_v=4.0, n_E=0.3)
    assert float(changed.flow.gamma_v) == 4.0
    assert float(changed.elasticity.n_E) == pytest.approx(0.3)
    assert changed.c_v.shape == (2,)
    assert "gamma_v            4 m/s" in str(changed)
    assert "PowerNucleus(gamma_v=4 m/s" in repr(changed)


@pytest.mark.parametrize("name", ["my_shape", "nucleus_exponent"])
def test_derivatives_by_a_parameter_of_a_law_of_one_s_own(name, tmp_path):
    # Against differences at "reference", whose derivatives are good to 1e-4.
    (tmp_path / "laws.py").write_text(
        HEAD
        + """
class Mine(AbstractFlow):
    my_rate: Scalar = parameter(3.0, "m/s", "[0, inf)", "rate")
    my_shape: Scalar = parameter(1.5, "-", "(0, inf)", "shape")
    def __call__(self, load, hardening, foundation, *, branch=None):
        excess = overstress(load.size, hardening, branch=branch)
        rate = self.my_rate * jnp.arcsinh(excess / self.my_shape)
        return displacement_rates(rate, load, 0.0, branch=branch)
"""
    )
    flow = f"{tmp_path}/laws.py:Mine" if name == "my_shape" else "PowerNucleus"

    def depth(value):
        soil = Soil(flow=flow, **{name: value})
        scene = Scene(Block(aspect_ratio=2.0), soil, Impact(angle=0.6))
        return simulate(scene, accuracy="reference").max_penetration

    # Steps so long that the error of results, 1e-7, is a small part of what they do.
    at, step = (1.5, 1e-2) if name == "my_shape" else (2.0, 2e-2)
    difference = (depth(at + step) - depth(at - step)) / (2.0 * step)
    forward = jax.jacfwd(depth)(at)
    np.testing.assert_allclose(forward, difference, rtol=1e-3)
    np.testing.assert_allclose(jax.grad(depth)(at), forward, rtol=1e-12)
