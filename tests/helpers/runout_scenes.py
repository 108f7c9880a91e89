"""What the tests of run-outs share: simple blocks and slopes, a study, laws of contact,
scenes from behind, and what is compared of runs."""

import dataclasses

import jax
import numpy as np

from jaximpact import (
    Block,
    BozzoloPamini,
    ConstantCoefficients,
    FrictionalEllipsoid,
    Impact,
    PfeifferBowen,
    RigidEllipsoid,
)
from jaximpact.runout import ClosedForm, MotionMode, Profile, Release
from jaximpact.runout.blocks import BlockOutline
from jaximpact.runout.trajectory import state_after
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


def rolling_sphere(profile, x, speed):
    """The sphere on the segment below x [m], rolling to the right at a speed [m/s]."""
    slope = profile.slope[np.searchsorted(profile.x, x, "right") - 1]
    along, down = np.cos(slope), np.sin(slope)
    y = profile.height(x) + R / along
    return Release(SPHERE, x, y, speed * along, -speed * down, 0.0, speed / R)


def height_over(x, y, profile):
    """Distances of points from a profile [m]; below it they are negative."""
    start = np.stack([profile.x[:-1], profile.y[:-1]], axis=1)
    along = np.stack([np.diff(profile.x), np.diff(profile.y)], axis=1)
    to = np.stack([x, y], axis=1)[:, None] - start
    part = np.clip(np.sum(to * along, axis=2) / np.sum(along**2, axis=1), 0.0, 1.0)
    distance = np.min(np.hypot(*np.moveaxis(to - part[..., None] * along, 2, 0)), 1)
    return np.where(profile.height(x) > y, -distance, distance)


def blocks_over(profile, g, count, shape="Ellipsoid"):
    """Blocks of 1 kg to 50 t in the upper part of a slope, above all ground near."""
    aspect_ratio = g.choice([1.0, 1.5, 2.0, 4.0], count)
    mass = 10.0 ** g.uniform(0.0, 4.7, count)
    block = Block(mass=mass, aspect_ratio=aspect_ratio, shape=shape)
    high = 4.0 * float(np.max(np.asarray(block.semi_axes.major)))
    length = profile.x[-1] - profile.x[0]
    x = profile.x[0] + length * g.uniform(0.05, 0.4, count)
    near = np.abs(profile.x - x[:, None]) < high
    top = np.max(np.where(near, profile.y, -np.inf), axis=1)
    return Release(
        block,
        x,
        np.maximum(top, profile.height(x)) + 0.5 * high,
        g.uniform(-3.0, 12.0, count),
        0.0,
        g.uniform(0.0, np.pi, count),
        g.normal(0.0, 5.0, count),
    )


def mirrored(profile, release):
    """The same scene from behind."""
    ground = Profile(
        -profile.x[::-1],
        profile.y[::-1],
        rolling_friction_angle=profile.rolling_friction_angle[::-1],
    )
    return ground, dataclasses.replace(
        release,
        x=-release.x,
        v_x=-release.v_x,
        orientation=-release.orientation,
        angular_velocity=-release.angular_velocity,
    )


def assert_same_bits(runs, same):
    """Two runs of the same blocks agree to the last bit."""
    for name in ("ending", "x", "y", "time", "events"):
        np.testing.assert_array_equal(getattr(runs, name), getattr(same, name))
    for name in ("contacts", "pieces"):
        jax.tree.map(
            np.testing.assert_array_equal, getattr(runs, name), getattr(same, name)
        )


def rows_of_records(records, chosen):
    """Some rows of contacts, pieces or passages."""
    return type(records)(*(column[chosen] for column in records))


def impact_of(contacts):
    """The impacts of contacts, as they begin."""
    into, along = contacts.normal_velocity_before, contacts.tangential_velocity_before
    return Impact(
        speed=np.hypot(into, along),
        angle=np.arctan2(along, into),
        orientation=contacts.orientation,
        angular_velocity=contacts.angular_velocity_before,
        slope=contacts.slope,
    )


def pieces_of(runs, motion):
    """The pieces of one mode of motion."""
    return rows_of_records(runs.pieces, runs.pieces.motion == motion)


def gain_between_pieces(runs):
    """Energy [J] gained from each flight, roll or slide to the next of its block, and
    the block's mass [kg]."""
    moves = runs.pieces.motion != MotionMode.contact
    trajectory = runs.pieces.trajectory[moves]
    same = np.diff(trajectory) == 0
    gain = np.diff(runs.energy_of_pieces()[moves])[same]
    return gain, runs.release.mass_properties.mass[trajectory[1:]][same]


def gain_in_contacts(runs):
    """Kinetic energy [J] gained within each piece of a contact beyond that of its fall,
    and the block's mass [kg]."""
    struck = pieces_of(runs, MotionMode.contact)
    mass, inertia = (value[struck.trajectory] for value in runs.release.mass_properties)
    end = state_after(struck, struck.duration)

    def kinetic(of):
        squared = of.v_x**2 + of.v_y**2
        return 0.5 * (mass * squared + inertia * of.angular_velocity**2)

    fall = np.maximum(struck.y - end.y, 0.0)
    return kinetic(end) - kinetic(struck) - mass * G * fall, mass


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


def assert_no_energy_gained(runs):
    """From piece to piece of a block, and over each contact, but for a lift by 1e-7 m:
    a touch may be early by 1e-9 of the block, and blocks are of some metres at most."""
    for gain, mass in (gain_between_pieces(runs), gain_over_contacts(runs)):
        assert np.max(gain / (mass * G), initial=0.0) < 1e-7
