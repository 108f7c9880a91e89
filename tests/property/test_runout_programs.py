"""Programs of run-outs: what they compute, and that they are found again on disk by
another process, and by no other law."""

import os
import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from runout_scenes import SLOPE_STUDY, ellipse

from jaximpact import Block, Impact
from jaximpact.backend.simd import kernel
from jaximpact.backend.simd.object_files import module_of
from jaximpact.backend.simd.tables import address_of
from jaximpact.finding import find_part
from jaximpact.identity import described
from jaximpact.rebound import AbstractRebound
from jaximpact.runout import Profile, blocks
from jaximpact.runout.contacts import contact_models
from jaximpact.runout.flight.ground_search import first_contact
from jaximpact.runout.lane_programs import LaneProgram, closed_form

LAW = """
from jaximpact.parameters import parameter
from jaximpact.rebound import AbstractRebound, Rebound

class Sticky(AbstractRebound):
    e_n: object = parameter(0.5, "-", "[0, 1]", "normal restitution")

    def __call__(self, block, impact):
        return Rebound(-self.e_n * impact.normal_velocity, CONSTANT, 0.0)
"""
OUTLINE, THETA = ellipse(np.array([2.0, 1.5]), np.ones(2)), np.array([0.3, 1.1])


def test_a_program_computes_its_function():
    """Of inputs that broadcast, and whether they matter or not."""

    def function(pair, scale, unused):
        a, b = pair
        return {"product": scale * jnp.sin(a) * b, "larger": jnp.maximum(a, b), "a": a}

    a = np.array([0.3, 1.1, 2.0])
    found = closed_form(function)((a, 1.5), 3.0, 7.0)
    # Sine of the compiled code and NumPy's: to rounding.
    np.testing.assert_allclose(found["product"], 4.5 * np.sin(a), rtol=1e-14)
    np.testing.assert_array_equal(found["larger"], [1.5, 1.5, 2.0])
    np.testing.assert_array_equal(found["a"], a)


def test_what_passes_through_programs_alone():
    """Nothing to compute, and nothing to compute it from."""
    same, one = closed_form(lambda x, y: (x, 1.0))(np.array([1.0, 2.0]), 3.0)
    np.testing.assert_array_equal(same, [1.0, 2.0])
    np.testing.assert_array_equal(one, [1.0, 1.0])
    np.testing.assert_array_equal(closed_form(lambda x: x)(np.arange(3)), [0, 1, 2])


@pytest.fixture
def compiled(monkeypatch):
    """A list that grows by each program that is compiled."""
    compile_functions, made = kernel.compile_functions, []

    def counted(functions, *how):
        made.append(module_of(functions))
        return compile_functions(functions, *how)

    monkeypatch.setattr(kernel, "compile_functions", counted)
    return made


def of_a_new_process(program):
    """The program without what this process has of it."""
    return LaneProgram(*program.functions, names=program.names)


def found():
    return of_a_new_process(blocks.support_of)(OUTLINE, THETA)


def test_a_program_is_compiled_once(cache, compiled):
    made = found()
    assert len(compiled) == 1
    for expected, value in zip(made, found(), strict=True):
        np.testing.assert_array_equal(value, expected)
    assert len(compiled) == 1


def test_a_loop_is_kept_by_its_functions(cache, compiled):
    body = blocks.Body(*(np.array([v]) for v in (0.0, 3.0, 5.0, 0.0, 0.4, 5.0)))
    outline = ellipse(np.array([0.5]), np.array([0.2]))
    covers = Profile([-50.0, 50.0], [0.0, 0.0]).covers
    given = body, outline, address_of(covers), 50.0, 1e3
    expected = of_a_new_process(first_contact)(*given)
    value = of_a_new_process(first_contact)(*given)
    assert len(compiled) == 1
    np.testing.assert_array_equal(value, expected)
    begin, step, finish = first_contact.functions
    LaneProgram(begin, lambda state: step(state), finish)(*given)
    assert len(compiled) == 2


def test_a_law_meets_no_program_of_another_constant(cache, compiled, tmp_path):
    path = tmp_path / "my_rebound.py"
    block, impact = Block(), Impact.from_degrees(speed=10.0, angle=30.0)
    for number, constant in enumerate((0.25, 0.75, 0.25), 1):
        path.write_text(LAW.replace("CONSTANT", str(constant)))
        law = find_part("rebound", AbstractRebound, f"{path}:Sticky")
        after = of_a_new_process(contact_models._rebound)(law, block, impact)
        assert after.tangential_velocity == constant
        # The second time the program of the first constant is found kept.
        assert len(set(compiled)) == min(number, 2)


def test_a_law_that_nothing_tells_is_not_kept(cache, compiled):
    """A closure, whose variables are in no source."""
    block, impact = Block(), Impact.from_degrees(speed=10.0, angle=30.0)
    for constant in (0.25, 0.75):
        law = jax.tree_util.Partial(
            lambda block, impact, constant=constant: (0.0, jnp.asarray(constant), 0.0)
        )
        assert described(law) is None
        after = of_a_new_process(contact_models._rebound)(law, block, impact)
        assert after.tangential_velocity == constant
    assert len(compiled) == 2


@pytest.mark.slow
def test_a_study_in_a_second_process_compiles_nothing(tmp_path):
    """To the last bit what the first one computed."""
    (tmp_path / "slope.toml").write_text(SLOPE_STUDY)
    program = f"""
import jax, sys
jax.config.update("jax_enable_x64", True)
from jaximpact.backend.simd import kernel
from jaximpact.runout import read_slope_study, run_slope_study
compile_functions, made = kernel.compile_functions, []
kernel.compile_functions = lambda *x: made.append(x) or compile_functions(*x)
found = run_slope_study(read_slope_study({str(tmp_path / "slope.toml")!r}))
print(len(made), *(found[name].values.tobytes().hex() for name in found.data_vars))
"""
    variables = {"JAXIMPACT_CACHE_DIR": str(tmp_path / "cache")}
    first, second = (
        subprocess.run(
            [sys.executable, "-c", program],
            env=os.environ | variables,
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        ).stdout.split()
        for _ in range(2)
    )
    assert int(first[0]) > 0
    assert int(second[0]) == 0
    assert first[1:] == second[1:]
