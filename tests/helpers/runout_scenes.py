"""What the tests of run-outs share: simple blocks and slopes, a study, laws of contact,
and the energy that runs gain."""

import jax
import numpy as np

from jaximpact import (
    Block,
    BozzoloPamini,
    ConstantCoefficients,
    FrictionalEllipsoid,
    PfeifferBowen,
    RigidEllipsoid,
)
from jaximpact.runout import ClosedForm, Profile
from jaximpact.runout.blocks import BlockOutline
from jaximpact.shapes import Ellipsoid, SemiAxes

G = 9.81
SPHERE = Block()
R = float(SPHERE.semi_axes.minor)
FLAT = Profile([0.0, 1000.0], [0.0, 0.0])
BIPLANAR = Profile([0.0, 400.0, 1000.0], [230.0, 0.0, 0.0])
DEAD = ClosedForm(ConstantCoefficients(0.0, 1.0))
"""No bounce, and nothing lost along the ground."""
SLOPE_STUDY = """
count = 70
seed = 7
collectors_m = [60, 40]
bins = 4
[profile]
points_m = [[0, 50], [50, 20], [55, 20], [80, 0], [200, 0]]
[ground]
c_v = { mean = 0.5, sd = 0.1, least = 0.1 }
roughness_deg = 3
[block]
mass_kg = { mean = 100, sd = 60, least = 20 }
shape = ["Ellipsoid", "EllipticCylinder"]
[release]
x_m = { from = 2, to = 6 }
clearance_m = 0.5
[contacts]
law = "constant coefficients"
e_n = 0.35
e_t = 0.85
"""
"""Study of a slope with random inputs: two portions of an executor."""
LAWS = (
    ConstantCoefficients(0.5, 0.8),
    ConstantCoefficients(0.95, 1.0),
    PfeifferBowen(0.35, 0.85),
    RigidEllipsoid(0.6),
    FrictionalEllipsoid(0.5, 0.5),
    BozzoloPamini(),
)


def ellipse(major, minor):
    """The outlines of blocks of these semi-axes [m]."""
    axes = SemiAxes(major, minor, minor)
    shape = Ellipsoid(aspect_ratio=major / minor)
    outline = BlockOutline(
        shape, axes, np.maximum(major, minor), np.minimum(major, minor)
    )
    return jax.tree.map(lambda leaf: np.broadcast_to(leaf, np.shape(major)), outline)


def pieces_of(runs, way):
    """The pieces of one way of going on."""
    chosen = runs.pieces.motion == way
    return type(runs.pieces)(*(column[chosen] for column in runs.pieces))


def gain_between_pieces(runs):
    """Energy [J] gained from each piece to the next of its block, and the block's mass
    [kg]."""
    same = np.diff(runs.pieces.trajectory) == 0
    gain = np.diff(runs.energy_of_pieces())[same]
    return gain, runs.release.mass_properties.mass[runs.pieces.trajectory[1:]][same]


def gain_over_contacts(runs):
    """Energy [J] gained over each contact, and the block's mass [kg]."""
    contacts = runs.contacts
    mass, inertia = (
        value[contacts.trajectory] for value in runs.release.mass_properties
    )

    def energy(v_n, v_t, spin, y):
        return 0.5 * (mass * (v_n**2 + v_t**2) + inertia * spin**2) + mass * G * y

    before = energy(*contacts[7:10], contacts.y)
    return energy(*contacts[10:13], contacts.y_after) - before, mass
