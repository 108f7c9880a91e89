"""Laws of users: what is wrong with one is said in one line."""

import dataclasses

import equinox as eqx
import jax
import numpy as np
import pytest

from jaximpact import Block, Impact, Scene, Soil, simulate
from jaximpact.errors import InputError
from jaximpact.laws import Perzyna

pytestmark = pytest.mark.slow

HEAD = """
import math
import jax.numpy as jnp
import numpy as np
from jaximpact.laws import *
"""
ARGUMENTS = {
    "flow": "self, load, hardening, foundation, *, branch=None",
    "hardening": "self, hardening, flow, foundation, *, branch=None",
    "bearing": "self, foundation, unit_weight_normal, factors, *, branch=None",
    "peak_friction": "self, friction_angle, relative_density",
}
NO_FLOW = "return FlowRate(load.size, 0.0, 0.0)"


def law(slot, equation=NO_FLOW, parameter="", arguments=None):
    """The text of a law; `equation` stands in its line 9."""
    base = "Abstract" + slot.title().replace("_", "")
    call = f"    def __call__({arguments or ARGUMENTS[slot]}):\n        {equation}\n"
    return f"class Wrong({base}):\n    {parameter}\n{call}"


def of_parameter(name="rate", default=1.0, interval="(0, inf)", more="", unit="-"):
    value = f'parameter({default}, "{unit}", "{interval}", "x"{more})'
    return law("flow", parameter=f"{name}: Scalar = {value}")


WRONG = {
    "numpy inside": (
        law("flow", "return displacement_rates(np.exp(load.size), load, 0.0)"),
        r"flow Wrong: numpy is used in line 9 of .*laws.py .*; use jax.numpy",
    ),
    "a function of math": (
        law("flow", "return displacement_rates(math.exp(load.size), load, 0.0)"),
        r"flow Wrong: a value is looked at in line 9 .*use jnp.where and jax.numpy",
    ),
    "an if": (
        law("hardening", "return flow.normal if flow.normal > 0.0 else -flow.normal"),
        r"hardening Wrong: a value is looked at in line 9 .*use jnp.where",
    ),
    "a sum over impacts": (
        law("hardening", "return jnp.max(flow.normal)"),
        r"hardening Wrong: __call__ .* gave shape \(\) for the result; use functions",
    ),
    "an array too many": (
        law("bearing", "return jnp.stack([foundation.length] * 3)"),
        r"bearing Wrong: __call__ .* gave shape \(3, 2\) for the result",
    ),
    "a bare tuple": (
        law("flow", "return (load.size, 0.0, 0.0)"),
        r"returned a tuple of 3, but FlowRate\(normal, tangential, rotational\)",
    ),
    "nothing": (
        law("peak_friction", "friction_angle + 0.1"),
        r"peak_friction Wrong: __call__ gave None .* but a float64 number is needed",
    ),
    "aside under a central load": (
        law("flow", "return FlowRate(load.size, 0.1, 0.0)"),
        "gives a tangential or rotational rate of 0.1 under a central load",
    ),
    "flow below yield that is denied": (
        law("flow", parameter="flows_below_yield = False"),
        "says flows_below_yield = False, but flows at 0.005 m/s below yield",
    ),
    "other arguments": (
        law("flow", arguments="self, load, hardening"),
        r"the model calls __call__\(self, load, hardening, foundation, \*, branch=None",
    ),
    "other arguments of a method that is not __call__": (
        "class Wrong(Perzyna):\n"
        "    def flow_size(self, load):\n        return load.size\n",
        r"; the model calls flow_size\(self, load, hardening, foundation, branch\)$",
    ),
    "a parameter without a default": (
        law("flow", parameter="rate: Scalar"),
        r"missing 1 required .* 'rate'; give every parameter a default",
    ),
    "a bare number": (
        law("flow", parameter="rate: float = 3.0"),
        r"Wrong.rate is no parameter; write rate: Scalar = parameter",
    ),
    "two parameters of one name": (
        of_parameter("c_v"),
        "HardeningPerLength.c_v and Wrong.c_v are two parameters of one name; rename",
    ),
    "a column that there is": (
        of_parameter("weight", more=', column="mass_kg"'),
        "two parameters have the column mass_kg: mass of the block and weight of",
    ),
    "a column of results": (
        of_parameter("e_n"),
        "the parameter e_n of the soil has the column e_n, which is that of a result",
    ),
    "a column that names a part": (
        of_parameter("weight", more=', column="shape"'),
        "has the column shape, which is the name of",
    ),
    "a range that is none": (
        of_parameter(interval="above 0"),
        r"the range must be an interval as in '\(0, inf\)'",
    ),
    "a unit that is not SI": (
        of_parameter(unit="mm"),
        r"the unit must be of .*, as in 'N s/m' .*, but has 'mm'",
    ),
    "a default out of its range": (
        of_parameter(default=-1.0, interval="[0, 1]"),
        "the default is not in the range",
    ),
    "no equation": (
        "class Wrong(AbstractFlow): pass",
        "Wrong does not define __call__",
    ),
    "another kind of law": (
        "class Wrong(Vesic): pass",
        r"Wrong must derive from AbstractFlow \(class Wrong\(AbstractFlow\): ...\)",
    ),
    "another name": ("class Other: pass", "there is no class Wrong; known are Other"),
    "an error of its own": ("1 / 0", r"cannot be run .* \(line 6\): ZeroDivisionError"),
    "no Python": ("class (:", "SyntaxError"),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_with_a_law_is_told(what, tmp_path):
    text, message = WRONG[what]
    (tmp_path / "laws.py").write_text(HEAD + text)
    slots = [slot for slot, arguments in ARGUMENTS.items() if arguments in text]
    with pytest.raises(InputError, match=message):
        simulate(Block(), Soil(**{(slots or ["flow"])[0]: f"{tmp_path}/laws.py:Wrong"}))


def test_an_array_that_is_no_parameter_is_refused():
    """JAX compares what is static, which arrays do not let it do."""

    class OfTable(Perzyna):
        table: tuple = eqx.field(default=(), static=True)

    assert Soil(flow=OfTable(table=(1.0, 2.0))).flow.table == (1.0, 2.0)
    with pytest.warns(UserWarning, match="static"):  # of Equinox
        of_array = OfTable(table=np.ones(2))
    with pytest.raises(InputError, match=r"OfTable.table is an array.* write a tuple"):
        Soil(flow=of_array)


def test_a_law_by_its_class_or_an_unknown_name_is_told():
    with pytest.raises(InputError, match=r"write Vesic\(\)"):
        Soil(bearing=type(Soil().bearing))
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


def test_derivatives_by_a_parameter_of_another_law():
    """Against differences at "reference", whose derivatives are good to 1e-4. Those of
    a law of one's own are tested beside its elasticities."""

    def depth(exponent):
        soil = Soil(flow="PowerNucleus", nucleus_exponent=exponent)
        scene = Scene(Block(aspect_ratio=2.0), soil, Impact(angle=0.6))
        return simulate(scene, accuracy="reference").max_penetration

    # Steps so long that the error of results, 1e-7, is a small part of what they do.
    at, step = 2.0, 2e-2
    difference = (depth(at + step) - depth(at - step)) / (2.0 * step)
    forward = jax.jacfwd(depth)(at)
    np.testing.assert_allclose(forward, difference, rtol=1e-3)
    np.testing.assert_allclose(jax.grad(depth)(at), forward, rtol=1e-12)
