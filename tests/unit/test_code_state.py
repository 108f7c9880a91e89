"""Everything that a user's law computes with is seen, and another number is another
state, within a process and in the digest."""

import copy
import importlib
import pickle
import re
import sys
import textwrap
from types import SimpleNamespace

import jax
import numpy as np
import pytest

from jaximpact import identity
from jaximpact.code_state import digest, walk
from jaximpact.finding import find_class
from jaximpact.identity import code_digest, heed_edits, name_of, tracing
from jaximpact.laws import AbstractKinematics, FluidityRate
from jaximpact.part_checks import check_part
from jaximpact.shapes import Ellipsoid

LAW = """
from jaximpact.laws import AbstractKinematics
from jaximpact.laws import AbstractKinematics as Base

{head}

class Mine(Base):
    def sinking_arm(self, foundation):
        return foundation.tangency_arm * ({value})
"""
OF_CASES = """
in the code: NUMBER
global constant: F
    F = NUMBER
import from: F
    from numbers_of import F
import of a module: numbers_of.F
    import numbers_of
import of a package: parts_of.inner.F
    import parts_of.inner
import inside: f()
    def f():
        from numbers_of import F
        return F
import of a part of a package inside: f()
    def f():
        from parts_of import inner
        return inner.F
import by name: f()
    import importlib
    def f(): return importlib.import_module('numbers_of').F
import function: __import__('numbers_of').F
attribute by name: getattr(numbers_of, 'F')
    import numbers_of
name made by code: getattr(numbers_of, 'fF'[1:])
    import numbers_of
attribute getter: f(numbers_of)
    import numbers_of, operator
    f = operator.attrgetter('F')
evaluated text: eval('F * 1.0')
    F = NUMBER
function of a function: f()
    def f(): return g()
    def g(): return NUMBER
closure: f()
    def make(x):
        def f(): return x
        return f
    f = make(NUMBER)
default: f()
    def f(x=NUMBER): return x
keyword default: f()
    def f(*, x=NUMBER): return x
class attribute: Numbers.F
    class Numbers: F = NUMBER
base class: self.F
    class Base(Base): F = NUMBER
property of the law: self.F
    class Base(Base): F = property(lambda self: NUMBER)
dispatch of a method: self.f(1.0)
    import functools
    class Base(Base):
        @functools.singledispatchmethod
        def f(self, x): return NUMBER
default of a parameter: self.F
    from jaximpact.laws import Scalar, parameter
    class Base(Base): F: Scalar = parameter(NUMBER, '-', '(0, inf)', 'factor')
static field: self.F
    import equinox as eqx
    class Base(Base): F: float = eqx.field(default=NUMBER, static=True)
module in a class: self.M.F
    import numbers_of
    class Base(Base): M = numbers_of
module as an argument: f(numbers_of)
    import numbers_of
    def f(m): return m.F
module that makes its names: m.F
    import types
    m = types.ModuleType('m')
    m.__getattr__ = lambda name: NUMBER
module of another class: m.F
    import types
    class M(types.ModuleType): F = NUMBER
    m = M('m')
attribute of an object: n.F
    class Numbers: pass
    n = Numbers()
    n.F = NUMBER
object with slots: n.F
    class Numbers: __slots__ = ('F',)
    n = Numbers()
    n.F = NUMBER
method that is bound: f()
    class Numbers:
        def f(self): return self.F
    n = Numbers()
    n.F, f = NUMBER, n.f
dictionary: D['inner'][0]
    D = dict(inner=[NUMBER])
array of NumPy: A[0]
    import numpy as np
    A = np.array([NUMBER])
data file read at import: A
    import numpy as np, pathlib
    A = np.loadtxt(pathlib.Path(__file__).with_name('data.txt'))
object of a library: float(f(1.0))
    from scipy.interpolate import PchipInterpolator
    f = PchipInterpolator([0.0, 1.0], [0.0, NUMBER])
partial: p()
    import functools
    def f(x): return x
    p = functools.partial(f, NUMBER)
decorated: f()
    import functools
    def scaled(by):
        def wrap(f): return functools.wraps(f)(lambda: by * f())
        return wrap
    @scaled(NUMBER)
    def f(): return 1.0
compiled by JAX: f(1.0)
    import jax
    @jax.jit
    def f(x): return x * NUMBER
rule of a derivative: f(1.0)
    import jax
    @jax.custom_jvp
    def f(x): return x
    f.defjvp(lambda p, t: (p[0], t[0] * NUMBER))
rule of Equinox: f(1.0)
    import equinox as eqx
    @eqx.filter_custom_jvp
    def f(x): return x * NUMBER
layer of Equinox: f(1.0)
    import equinox as eqx, jax
    key = jax.random.key(0)
    f = eqx.nn.MLP(1, 1, 2, 1, activation=lambda x: NUMBER * x, key=key)
key of random numbers: jax.random.normal(k)
    import jax
    k = jax.random.key(int(4 * NUMBER))
function made with the names of a library: f()
    import jax.numpy as jnp
    names = dict(vars(jnp))
    exec('def f(): return NUMBER', names)
    f = names['f']
number of a class of its own: F
    class Q(float): pass
    F = Q(NUMBER)
dictionary of attributes: d.F
    class Q(dict): __getattr__ = dict.__getitem__
    d = Q(F=NUMBER)
tuple with methods: n.f()
    from typing import NamedTuple
    class N(NamedTuple):
        a: float = 1.0
        def f(self): return NUMBER
    n = N()
array of a class of its own: n.F
    import numpy as np
    class Q(np.ndarray): F = NUMBER
    n = np.ones(1).view(Q)
masked array: n.sum()
    import numpy as np
    n = np.ma.array([1.0, 2.0], mask=[NUMBER > 2, False])
class of a class: A.F
    class Meta(type): F = NUMBER
    class A(metaclass=Meta): pass
object that wraps: f()
    import functools
    class Scaled:
        def __init__(self, f):
            functools.update_wrapper(self, f)
            self.F = NUMBER
        def __call__(self): return self.F
    @Scaled
    def f(): return 1.0
function in an object of a library: f(1.0)
    import numpy as np
    def g(x): return x * NUMBER
    f = np.vectorize(g)
object in a container of a library: d[0].F
    import collections
    class A: F = NUMBER
    d = collections.deque([A()])
context variable: F.get()
    import contextvars
    F = contextvars.ContextVar('F', default=NUMBER)
weak reference: r().F
    import weakref
    class A: F = NUMBER
    a = A()
    r = weakref.ref(a)
view of bytes: float(v.tobytes().decode())
    v = memoryview(b'NUMBER')
"""
"""Where the number of an edit stands: a name, what the law computes with, and the code
above the law."""


CASES = {
    name: (value, textwrap.dedent(head))
    for name, value, head in re.findall(
        r"^(\w[^:]*): (.*)\n((?: +.*\n)*)", OF_CASES, re.M
    )
}


@pytest.fixture
def law_of(tmp_path, monkeypatch):
    """Function that writes a law with a number, and imports it anew."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def law_of(case, number):
        value, head = case
        text = LAW.format(value=value, head=head).replace("NUMBER", number)
        (tmp_path / "law_of_mine.py").write_text(text)
        (tmp_path / "numbers_of.py").write_text(f"F = {number}\n")
        (tmp_path / "data.txt").write_text(number)
        (tmp_path / "parts_of").mkdir(exist_ok=True)
        (tmp_path / "parts_of" / "__init__.py").write_text("")
        (tmp_path / "parts_of" / "inner.py").write_text(f"F = {number}\n")
        for name in ("law_of_mine", "numbers_of", "parts_of", "parts_of.inner"):
            sys.modules.pop(name, None)
        importlib.invalidate_caches()
        return importlib.import_module("law_of_mine").Mine

    return law_of


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_another_number_is_another_state(law_of, case):
    one = law_of(case, "1.25")
    before, name = walk(one), digest(walk(one))
    assert walk(one) == before
    other = law_of(case, "2.5")
    assert walk(other) != before
    assert digest(walk(other)) != name
    again = law_of(case, "1.25")
    assert digest(walk(again)) == name


def test_a_value_that_is_changed_in_place_is_seen(law_of):
    law = law_of(CASES["array of NumPy"], "1.25")
    before = walk(law)
    sys.modules["law_of_mine"].A[0] = np.nextafter(1.25, 2.0)
    assert walk(law) != before


def test_numbers_that_compare_equal_are_told_apart(law_of):
    states = [
        digest(walk(law_of(CASES["global constant"], number)))
        for number in ("1", "1.0", "True", "-0.0", "0.0", "float('nan')")
    ]
    assert len(set(states)) == len(states)


def test_what_runs_counts_not_the_file(law_of, tmp_path):
    """A file that was edited since says another number than the class has."""
    law = law_of(CASES["in the code"], "1.25")
    name = digest(walk(law))
    path = tmp_path / "law_of_mine.py"
    path.write_text(path.read_text().replace("1.25", "2.5"))
    after = digest(walk(law))
    other = digest(walk(law_of(CASES["in the code"], "2.5")))
    assert len({name, after, other}) == 3  # its instructions are known, no source


def test_a_name_in_a_manifest_shows_the_constants(law_of):
    name = name_of(law_of(CASES["import from"], "1.25"))
    assert name.startswith("law_of_mine.Mine (")
    assert name.endswith(", F=1.25)")


def test_pickling_changes_nothing(law_of):
    """`copyreg` notes on the class what slots it has."""
    law = law_of(CASES["in the code"], "1.25")
    before = walk(law)
    pickle.dumps(law())
    copy.deepcopy(law())
    assert walk(law) == before


def test_a_law_that_refers_to_itself_has_an_end(law_of):
    head = "D = {}\nD['self'] = D\ndef f(): return f if D else 1.0"
    assert walk(law_of(("1.0 if f else D", head), "1.0"))


def test_a_law_file_is_read_again_with_what_it_imports(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    path = tmp_path / "law_by_name.py"
    text = LAW.format(value="F", head="from middle import F")
    path.write_text(text)
    (tmp_path / "middle.py").write_text("from numbers_by_name import F")

    def find():
        return find_class("kinematics", AbstractKinematics, f"{path}:Mine")

    kinds = []
    for number in ("1.25", "2.5", "1.25"):
        (tmp_path / "numbers_by_name.py").write_text(f"F = {number}\n")
        kinds.append(find())
        assert find() is kinds[-1]
        assert f"F={number}" in name_of(kinds[-1])
        # As `pickle` looks for it
        assert sys.modules[kinds[-1].__module__].Mine is kinds[-1]
    assert digest(walk(kinds[0])) == digest(walk(kinds[2]))


def test_a_law_file_is_read_again_with_the_data_that_it_names(tmp_path):
    path = tmp_path / "law_of_data.py"
    value, head = CASES["data file read at import"]
    path.write_text(LAW.format(value=value, head=head))
    values = []
    for number in ("1.25", "1.25", "2.5"):
        (tmp_path / "data.txt").write_text(number)
        kind = find_class("kinematics", AbstractKinematics, f"{path}:Mine")
        values.append(kind)
    assert values[0] is values[1]
    assert digest(walk(values[1])) != digest(walk(values[2]))


CHANGED_BY_ITSELF = {
    "nothing": "pass",
    "counter": "global N; N += 1",
    "list": "L.append(len(L))",
    "memory": "M[len(M)] = 1.0",
    "random numbers": "R.normal()",
    "logger": "logging.getLogger('a law').debug('traced')",
    "dispatch": "dispatched(1)",
}
HEAD_OF_STATE = """
import functools, logging
import numpy as np
N, L, M, R, F = 0, [], {{}}, np.random.default_rng(1), 1.0
@functools.singledispatch
def dispatched(x): return 1.0
def changed():
    {change}
    return F
"""


@pytest.mark.parametrize("change", CHANGED_BY_ITSELF.values(), ids=CHANGED_BY_ITSELF)
def test_what_a_law_changes_itself_is_no_edit(law_of, change, monkeypatch):
    """Else it would be traced at each call, and a worker would refuse it."""
    head = HEAD_OF_STATE.format(change=change)
    law = law_of(("changed()", head), "1.0")
    structure, cleared = jax.tree.structure(law()), []
    monkeypatch.setattr(identity, "_clearing", [lambda: cleared.append(1)])
    before = code_digest(law)
    for _ in range(3):
        heed_edits(structure)
        with tracing():
            law().sinking_arm(SimpleNamespace(tangency_arm=1.0))
    heed_edits(structure)
    assert not cleared
    assert code_digest(law) == before
    vars(sys.modules["law_of_mine"])["F"] = 2.0
    heed_edits(structure)
    assert cleared
    assert code_digest(law) != before


class AFlow(FluidityRate):
    """Flow of the package, as a law of a user's."""


class AShape(Ellipsoid):
    """Shape of the package, as one of a user's."""


def test_a_law_may_be_checked_first_inside_of_jit():
    @jax.jit
    def checked(x):
        check_part("flow", AFlow())
        check_part("shape", AShape())
        return x

    assert checked(1.0) == 1.0
