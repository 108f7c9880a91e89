"""Everything that a user's law computes with is seen, and another number is another
state, within a process and in the digest."""

import copy
import importlib
import pickle
import sys
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

{head}

class Mine({base}):
    {inside}
    def sinking_arm(self, foundation{default}):
        return foundation.tangency_arm * ({value})
"""
PARTS = dict(head="", base="AbstractKinematics", inside="", default="", value="1.0")
# In each, NUMBER stands where the edit is.
CASES = {
    "in the code": dict(value="NUMBER"),
    "global constant": dict(head="F = NUMBER", value="F"),
    "import from": dict(head="from numbers_of import F", value="F"),
    "import from, renamed": dict(head="from numbers_of import F as g", value="g"),
    "import of a module": dict(head="import numbers_of", value="numbers_of.F"),
    "import of a package": dict(head="import parts_of.inner", value="parts_of.inner.F"),
    "import inside": dict(
        head="def f():\n    from numbers_of import F\n    return F", value="f()"
    ),
    "import of a part of a package inside": dict(
        head="def f():\n    from parts_of import inner\n    return inner.F", value="f()"
    ),
    "import by name": dict(
        head="import importlib\ndef f():\n"
        "    return importlib.import_module('numbers_of').F",
        value="f()",
    ),
    "attribute by name": dict(
        head="import numbers_of", value="getattr(numbers_of, 'F')"
    ),
    "function of a function": dict(
        head="def f(): return g()\ndef g(): return NUMBER", value="f()"
    ),
    "closure": dict(
        head="def make(x):\n    def f(): return x\n    return f\nf = make(NUMBER)",
        value="f()",
    ),
    "default": dict(default=", factor=NUMBER", value="factor"),
    "keyword default": dict(default=", *, factor=NUMBER", value="factor"),
    "class attribute": dict(head="class Numbers:\n    F = NUMBER", value="Numbers.F"),
    "attribute of the law": dict(inside="F = NUMBER\n", value="self.F"),
    "property of the law": dict(
        inside="@property\n    def F(self): return NUMBER\n", value="self.F"
    ),
    "base class": dict(
        head="class Base(AbstractKinematics):\n    F = NUMBER\n",
        base="Base",
        value="self.F",
    ),
    "attribute of an object": dict(
        head="class Numbers:\n    def __init__(self): self.F = NUMBER\nn = Numbers()",
        value="n.F",
    ),
    "object with slots": dict(
        head="class Numbers:\n    __slots__ = ('F',)\n"
        "    def __init__(self): self.F = NUMBER\nn = Numbers()",
        value="n.F",
    ),
    "dictionary": dict(head="D = dict(inner=[NUMBER])", value="D['inner'][0]"),
    "array of NumPy": dict(
        head="import numpy as np\nA = np.array([NUMBER])", value="A[0]"
    ),
    "array of JAX": dict(
        head="import jax.numpy as jnp\nA = jnp.asarray([NUMBER])", value="A[0]"
    ),
    "data file read at import": dict(
        head="import numpy as np, pathlib\n"
        "A = np.loadtxt(pathlib.Path(__file__).with_name('data.txt'))",
        value="A",
    ),
    "object of a library": dict(
        head="from scipy.interpolate import PchipInterpolator\n"
        "f = PchipInterpolator([0.0, 1.0], [0.0, NUMBER])",
        value="float(f(1.0))",
    ),
    "partial": dict(
        head="import functools\ndef f(x): return x\np = functools.partial(f, NUMBER)",
        value="p()",
    ),
    "decorated": dict(
        head="import functools\ndef scaled(by):\n    def wrap(f):\n"
        "        @functools.wraps(f)\n        def inner(): return by * f()\n"
        "        return inner\n    return wrap\n"
        "@scaled(NUMBER)\ndef f(): return 1.0",
        value="f()",
    ),
    "cached": dict(
        head="import functools\n@functools.cache\ndef f(): return NUMBER", value="f()"
    ),
    "compiled by JAX": dict(
        head="import jax\n@jax.jit\ndef f(x): return x * NUMBER", value="f(1.0)"
    ),
    "rule of a derivative": dict(
        head="import jax\n@jax.custom_jvp\ndef f(x): return x\n"
        "f.defjvp(lambda p, t: (p[0], t[0] * NUMBER))",
        value="f(1.0)",
    ),
    "default of a parameter": dict(
        head="from jaximpact.laws import Scalar, parameter",
        inside="F: Scalar = parameter(NUMBER, '-', '(0, inf)', 'factor')\n",
        value="self.F",
    ),
    "static field": dict(
        head="import equinox as eqx",
        inside="F: float = eqx.field(default=NUMBER, static=True)\n",
        value="self.F",
    ),
    "method that is bound": dict(
        head="class Numbers:\n    def __init__(self): self.F = NUMBER\n"
        "    def f(self): return self.F\nf = Numbers().f",
        value="f()",
    ),
    "module in a class": dict(
        head="import numbers_of", inside="M = numbers_of\n", value="self.M.F"
    ),
    "module as an argument": dict(
        head="import numbers_of\ndef f(m): return m.F", value="f(numbers_of)"
    ),
    "module in an object": dict(
        head="import numbers_of\nclass A: pass\na = A()\na.m = numbers_of",
        value="a.m.F",
    ),
    "name made by code": dict(
        head="import numbers_of", value="getattr(numbers_of, 'fF'[1:])"
    ),
    "attribute getter": dict(
        head="import numbers_of, operator\nf = operator.attrgetter('F')",
        value="f(numbers_of)",
    ),
    "evaluated text": dict(head="F = NUMBER", value="eval('F * 1.0')"),
    "module that makes its names": dict(
        head="import types\nm = types.ModuleType('m')\n"
        "m.__getattr__ = lambda name: NUMBER",
        value="m.F",
    ),
    "module of another class": dict(
        head="import types\nclass M(types.ModuleType):\n    F = NUMBER\nm = M('m')",
        value="m.F",
    ),
    "import function": dict(value="__import__('numbers_of').F"),
    "function made with the names of a library": dict(
        head="import jax.numpy as jnp\nnames = dict(vars(jnp))\n"
        "exec('def f(): return NUMBER', names)\nf = names['f']",
        value="f()",
    ),
    "number of a class of its own": dict(
        head="class Q(float):\n    pass\nF = Q(NUMBER)", value="F"
    ),
    "dictionary of a class of its own": dict(
        head="class Q(dict):\n    F = NUMBER\nd = Q()", value="d.F"
    ),
    "dictionary of attributes": dict(
        head="class Q(dict):\n    __getattr__ = dict.__getitem__\nd = Q(F=NUMBER)",
        value="d.F",
    ),
    "tuple with methods": dict(
        head="from typing import NamedTuple\nclass N(NamedTuple):\n"
        "    a: float = 1.0\n    def f(self): return NUMBER\nn = N()",
        value="n.f()",
    ),
    "array of a class of its own": dict(
        head="import numpy as np\nclass Q(np.ndarray):\n    F = NUMBER\n"
        "n = np.ones(1).view(Q)",
        value="n.F",
    ),
    "masked array": dict(
        head="import numpy as np\n"
        "n = np.ma.array([1.0, 2.0], mask=[NUMBER > 2, False])",
        value="n.sum()",
    ),
    "class of a class": dict(
        head="class Meta(type):\n    F = NUMBER\nclass A(metaclass=Meta): pass",
        value="A.F",
    ),
    "object that wraps": dict(
        head="import functools\nclass Scaled:\n    def __init__(self, f):\n"
        "        functools.update_wrapper(self, f)\n        self.F = NUMBER\n"
        "    def __call__(self): return self.F\n@Scaled\ndef f(): return 1.0",
        value="f()",
    ),
    "function in an object of a library": dict(
        head="import numpy as np\ndef g(x): return x * NUMBER\nf = np.vectorize(g)",
        value="f(1.0)",
    ),
    "object in a container of a library": dict(
        head="import collections\nclass A:\n    F = NUMBER\n"
        "d = collections.deque([A()])",
        value="d[0].F",
    ),
    "default of a dictionary": dict(
        head="import collections\nd = collections.defaultdict(lambda: NUMBER)",
        value="d['a']",
    ),
    "dispatch of a method": dict(
        head="import functools",
        inside="@functools.singledispatchmethod\n    def f(self, x): return NUMBER\n",
        value="self.f(1.0)",
    ),
    "rule of Equinox": dict(
        head="import equinox as eqx\n@eqx.filter_custom_jvp\n"
        "def f(x): return x * NUMBER",
        value="f(1.0)",
    ),
    "layer of Equinox": dict(
        head="import equinox as eqx, jax\nf = eqx.nn.MLP(1, 1, 2, 1, "
        "activation=lambda x: NUMBER * x, key=jax.random.key(0))",
        value="f(1.0)",
    ),
    "key of random numbers": dict(
        head="import jax\nk = jax.random.key(int(4 * NUMBER))",
        value="jax.random.normal(k)",
    ),
    "context variable": dict(
        head="import contextvars\nF = contextvars.ContextVar('F', default=NUMBER)",
        value="F.get()",
    ),
    "weak reference": dict(
        head="import weakref\nclass A:\n    F = NUMBER\na = A()\nr = weakref.ref(a)",
        value="r().F",
    ),
    "view of bytes": dict(
        head="v = memoryview(b'NUMBER')", value="float(v.tobytes().decode())"
    ),
}


@pytest.fixture
def law_of(tmp_path, monkeypatch):
    """Function that writes a law with a number, and imports it anew."""
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def law_of(case, number):
        text = LAW.format(**PARTS | case).replace("NUMBER", number)
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
    assert walk(law_of(dict(head=head, value="1.0 if f else D"), "1.0"))


def test_a_law_file_is_read_again_with_what_it_imports(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    path = tmp_path / "law_by_name.py"
    text = LAW.format(**PARTS | dict(head="from middle import F", value="F"))
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
    path.write_text(LAW.format(**PARTS | CASES["data file read at import"]))
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
    law = law_of(dict(head=head, value="changed()"), "1.0")
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
