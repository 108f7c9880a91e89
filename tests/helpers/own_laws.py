"""A law and a shape as users write them, in files of their own."""

FLOW = '''
from jaxtyping import Array, Float

from jaximpact.laws import AbstractFlow, displacement_rates, overstress
from jaximpact.parameters import parameter


class Creeping(AbstractFlow):
    """Perzyna's flow, and a part of it below yield too."""

    my_rate: Float[Array, ""] = parameter(8.7, "m/s", "[0, inf)", "fluidity")
    my_creep: Float[Array, ""] = parameter(
        0.0, "-", "[0, 1]", "flow below yield", column="my_creep_share"
    )

    def __call__(self, load, hardening, foundation, *, branch=None):
        nucleus = overstress(load.size, hardening, branch=branch)
        creep = self.my_creep * load.size / hardening
        return displacement_rates(
            self.my_rate * (nucleus + creep), load, 0.0, branch=branch
        )
'''

SHAPE = '''
from jaxtyping import Array, Float

from jaximpact.parameters import parameter
from jaximpact.shapes import Ellipsoid


class Hollow(Ellipsoid):
    """An ellipsoid whose mass sits further out."""

    spread: Float[Array, ""] = parameter(1.0, "-", "[1, 3]", "inertia by that of mass")

    def inertia(self, mass, axes):
        return self.spread * super().inertia(mass, axes)
'''


def write_laws(folder):
    """The files `my_laws.py` and `my_shapes.py`."""
    (folder / "my_laws.py").write_text(FLOW)
    (folder / "my_shapes.py").write_text(SHAPE)
