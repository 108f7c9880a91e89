"""The constitutive laws against plain numbers, known values and their promises."""

import dataclasses
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaximpact import Block, Impact, Scene, Soil
from jaximpact.backend.xla_compilation import unfused_jit
from jaximpact.errors import InputError
from jaximpact.impact.dynamics import contact, force_rate, initial_motion, prepare
from jaximpact.laws import (
    Coulomb,
    DeepestPoint,
    FlowRate,
    Forces,
    Load,
    NovaMontrasio,
    Stiffness,
    Vesic,
    VesicWithInertia,
    flow_direction,
    overstress,
    safe_power,
    safe_sqrt,
)
from jaximpact.laws.bearing import bearing_factors
from jaximpact.laws.elasticity import shape_factor
from jaximpact.laws.loading_surface import TANGENT_FROM, VERTEX_ROUNDING
from jaximpact.laws.slider import RELAXATION_TIME
from jaximpact.parameters import parts_of
from jaximpact.shapes import Foundation

# Two orders of summation of the same formula.
ROUNDING = 1e-13


def all_finite(tree):
    return bool(np.all([np.all(np.isfinite(leaf)) for leaf in jax.tree.leaves(tree)]))


def footing(length, width, sinking=0.1):
    return Foundation(length, width, sinking, 0.2, 0.0, 0.0)


def elastic_stiffness(length, width, unit_weight_normal, soil):
    return soil.elasticity(footing(length, width), unit_weight_normal, 1e-3)


def bearing_capacity(length, width, sinking, unit_weight_normal, factors):
    return Vesic()(footing(length, width, sinking), unit_weight_normal, factors)


def loading_surface(xi, h, m, beta):
    """By forces that are the dimensionless ones already."""
    law = dataclasses.replace(NovaMontrasio(psi=1.0), beta=beta)
    return law(Forces(xi, h, m), 1.0, footing(1.0, 1.0), 1.0)


def flow_rate(load, hardening, length, friction_slope, soil):
    load = load._replace(
        tangential_scale=friction_slope, rotational_scale=soil.psi * length
    )
    return soil.flow(load, hardening, footing(length, length))


def hardening_rate(hardening, flow, length, width, soil):
    return soil.hardening(hardening, flow, footing(length, width))


# Functions that laws are made of: finite with their gradient at the singular point

SAFE = {
    "sqrt": (safe_sqrt, np.sqrt, lambda x: 0.5 / np.sqrt(x)),
    **{
        f"power {n}": (
            lambda x, n=n: safe_power(x, n),
            lambda x, n=n: x**n,
            lambda x, n=n: n * x ** (n - 1.0),
        )
        for n in (0.4, 1.0, 2.0)
    },
}


@pytest.mark.parametrize("name", SAFE)
def test_safe_functions_are_zero_with_zero_gradient_at_and_below_zero(name):
    function, plain, plain_slope = SAFE[name]
    for point in (0.0, -0.0, -1.0, -1e300):
        for differentiate in (jax.grad, jax.jacfwd):
            assert function(point) == differentiate(function)(point) == 0.0
    # One lane at the singular point must not spoil its neighbours, nor they it.
    points = jnp.asarray([-2.0, 0.0, 1e-12, 0.3, 4.0])
    value, slope = jax.vmap(jax.value_and_grad(function))(points)
    positive = np.asarray(points[2:])
    np.testing.assert_array_equal((value[:2], slope[:2]), 0.0)
    # The power is an exponential of a logarithm near -28, whose rounding it magnifies.
    np.testing.assert_allclose(value[2:], plain(positive), rtol=28e-14)
    np.testing.assert_allclose(slope[2:], plain_slope(positive), rtol=28e-14)


def test_power_is_differentiable_in_its_exponent():
    slope = jax.grad(safe_power, argnums=1)
    assert slope(0.0, 0.4) == 0.0
    np.testing.assert_allclose(slope(0.3, 0.4), np.log(0.3) * 0.3**0.4, rtol=1e-14)


# Elasticity


def test_modulus_is_k_E_atmospheres_at_one_atmosphere():
    # gamma r_0 = 100 kPa; k_n = J_s 2 E* r_0 with E* = E / (1 - nu^2): Hertz's slope.
    soil = Soil(S_ef=1.0)
    radius = 1e5 / 18e3
    normal = elastic_stiffness(2.0 * radius, 2.0 * radius, 18e3, soil).normal
    reduced = 900.0 * 1e5 / (1.0 - 0.3**2)
    expected = float(shape_factor(1.0)) * 2.0 * reduced * radius
    assert float(normal) == pytest.approx(expected, rel=ROUNDING)


def test_shape_factor_is_near_one_for_a_circle_and_follows_gazetas():
    # 0.9955 at 1: the paper's interpolation. Gazetas' 1 + small growth, 1.12 at 4.
    assert float(shape_factor(1.0)) == pytest.approx(0.9955, abs=5e-5)
    assert float(shape_factor(4.0)) == pytest.approx(1.1204, abs=5e-5)


def test_laws_are_finite_with_their_gradients_at_singular_points():
    """On a vertical slope, at ground level, without flow and without force. Both sizes
    of a foundation vanish together: their ratio stays that of the block."""
    factors = bearing_factors(0.7)
    for law, point in [
        (lambda *sizes: elastic_stiffness(*sizes, Soil()), (1e-12, 1e-12, 0.0)),
        (lambda u: bearing_capacity(1e-12, 0.3, u, 18e3, factors), (0.0,)),
        (
            lambda *rates: hardening_rate(0.1, FlowRate(*rates), 0.3, 0.4, Soil()),
            (0.0,) * 3,
        ),
        (Coulomb(), (0.0, 0.0, 1e6, 0.5)),
    ]:
        slopes = jax.jacfwd(law, argnums=tuple(range(len(point))))
        # One program of XLA, where each operation by itself would be compiled alone.
        found = jax.jit(lambda *at, law=law, slopes=slopes: (law(*at), slopes(*at)))
        assert all_finite(found(*point))


def test_dashpots_against_plain_numbers():
    soil = Soil(eta_N=0.1, eta_T=0.2, eta_R=0.3)
    found = soil.damping(Stiffness(4e6, 1e6, 9e4), 100.0, 4.0)
    expected = (0.2 * math.sqrt(4e8), 0.4 * math.sqrt(1e8), 0.6 * math.sqrt(36e4))
    np.testing.assert_allclose(found, expected, rtol=ROUNDING)


# Bearing capacity


@pytest.mark.parametrize(
    ("degrees", "surcharge", "weight"), [(30, 18.40, 22.40), (40, 64.20, 109.41)]
)
def test_bearing_factors_are_those_of_vesic_s_table(degrees, surcharge, weight):
    factors = bearing_factors(math.radians(degrees))
    # The table has two decimals.
    assert float(factors.surcharge) == pytest.approx(surcharge, abs=0.006)
    assert float(factors.weight) == pytest.approx(weight, abs=0.006)
    tangent = math.tan(math.radians(degrees))
    assert float(factors.friction_slope) == pytest.approx(tangent, rel=ROUNDING)
    hansen = 2.0 * tangent * (1.0 - math.sin(math.radians(degrees))) ** 2
    assert float(factors.depth) == pytest.approx(hansen, rel=ROUNDING)


@pytest.mark.parametrize(("degrees", "factor"), [(20, 14.83), (30, 30.14), (40, 75.31)])
def test_the_factor_of_cohesion_is_that_of_vesic_s_table(degrees, factor):
    assert float(bearing_factors(math.radians(degrees)).cohesion) == pytest.approx(
        factor, abs=0.006
    )


def test_cohesion_without_friction_is_prandtl_s():
    """N_c = 2 + pi, and by series on its way there."""
    factors, slopes = jax.jvp(bearing_factors, (0.0,), (1.0,))
    assert float(factors.cohesion) == pytest.approx(2.0 + math.pi, rel=ROUNDING)
    # N_c = (e^z - 1)/t with z = (2 + pi) t to second order
    assert float(slopes.cohesion) == pytest.approx(0.5 * (2.0 + math.pi) ** 2)
    for friction in (1e-5, 0.9999e-4, 1.0001e-4, 1e-3):
        z = math.pi * math.tan(friction) + 2.0 * math.asinh(math.tan(friction))
        exact = math.expm1(z) / math.tan(friction)
        found = bearing_factors(friction).cohesion
        assert float(found) == pytest.approx(exact, rel=ROUNDING)


def test_cohesion_adds_its_own_term():
    friction, cohesion = 0.6, 5e3
    factors, base = bearing_factors(friction), footing(0.4, 0.3, 0.1)
    plain = Vesic()(base, 18e3, factors)
    found = Vesic(cohesion=cohesion)(base, 18e3, factors) - plain
    tangent, ratio = math.tan(friction), 0.3 / 0.4
    surcharge, factor = float(factors.surcharge), float(factors.cohesion)
    d_q = 1.0 + float(factors.depth) * math.atan(0.1 / 0.3)
    d_c = d_q + (d_q - 1.0) / (factor * tangent)
    s_c = 1.0 + ratio * surcharge / factor
    area = 0.25 * math.pi * 0.4 * 0.3
    expected = area * cohesion * factor * s_c * d_c
    # The difference has lost two digits.
    assert float(found) == pytest.approx(expected, rel=100 * ROUNDING)


def test_inertia_is_that_of_katsuragi_s_sphere():
    """A steel sphere of 69.2 g and 25.4 mm in beads of 1520 kg/m3: m v^2/d_1 with
    d_1 = 8.7 +- 0.7 cm, on the whole section."""
    law, base = VesicWithInertia(), footing(0.0254, 0.0254, 0.05)
    factors = bearing_factors(0.5)

    def limit(velocity):
        return float(law.at_velocity(base, 1520 * 9.81, factors, velocity, 1520.0))

    at_rest = float(Vesic()(base, 1520 * 9.81, factors))
    assert limit(0.0) == limit(-2.0) == at_rest
    assert limit(3.0) - at_rest == pytest.approx(0.0692 * 9.0 / 0.087, rel=0.08)
    # It begins without a kink.
    at = jax.grad(law.at_velocity, 3)
    assert at(base, 1520 * 9.81, factors, 0.0, 1520.0) == 0.0


@pytest.mark.parametrize(
    ("relative_density", "degrees", "values"),
    [
        (0.1, 30.0, {}),
        (0.2, 30.0, {}),
        (0.9, 40.5, {}),
        (1.0, 42.0, {}),
        (1.0, 42.0, {"delta_1": 7.0}),
    ],
)
def test_peak_friction_is_bolton_s(relative_density, degrees, values):
    # 3 degrees times I_R = 5 D_r - 1, between 0 and 4.
    soil = Soil(relative_density=relative_density, **values)
    found = soil.peak_friction(soil.friction_angle, soil.relative_density)
    assert float(found) == pytest.approx(math.radians(degrees), rel=ROUNDING)


def test_bearing_capacity_above_ground_is_that_at_ground_level():
    factors = bearing_factors(0.7)

    def capacity(length, depth):
        return bearing_capacity(length, 0.3, depth, 18e3, factors)

    at_ground = capacity(0.3, 0.0)
    # A strip of round footing: weight term alone, shape factor 0.6.
    plain = 0.25 * math.pi * 0.09 * 18e3 * 0.5 * 0.3 * factors.weight * 0.6
    assert float(at_ground) == pytest.approx(float(plain), rel=ROUNDING)
    assert float(capacity(0.3, -0.1)) == float(at_ground)


# Loading surface

surface = jax.jit(loading_surface)
BETAS = [0.3, 0.9, 1.0, 1.9]


def plain_size(xi, h, m, beta):
    """rho* from its definition, in plain numbers."""
    eta = math.sqrt((h**2 + m**2) / xi**2 + VERTEX_ROUNDING**2) - VERTEX_ROUNDING
    w = eta ** (1.0 / beta)
    if w <= TANGENT_FROM:
        return xi / (1.0 - w)
    return xi * (20.0 + 400.0 * (w - TANGENT_FROM))


@jax.jit
def slopes_of_surface(xi, h, m, beta):
    return jax.grad(lambda *a: loading_surface(*a).size, argnums=(0, 1, 2))(
        xi, h, m, beta
    )


@pytest.mark.parametrize("beta", BETAS)
@pytest.mark.parametrize("load", [(0.2, 0.05, 0.1), (0.3, -0.1, 0.02), (0.1, 0.3, 0.5)])
def test_size_and_gradient_of_a_load(load, beta):
    found = surface(*load, beta)
    # The plain difference root - e loses two digits, the power 1 / beta some more.
    assert float(found.size) == pytest.approx(plain_size(*load, beta), rel=1e-11)
    slopes = slopes_of_surface(*load, beta)
    scale = np.abs(slopes).max()
    np.testing.assert_allclose(found[1:4], slopes, atol=ROUNDING * scale, rtol=1e-12)


@pytest.mark.parametrize("beta", BETAS)
def test_surface_equation_holds_up_to_the_rounding_of_the_vertex(beta):
    rho = 0.4
    # The tangent takes over at w = 0.95, that is below xi = 0.05 rho.
    for part in np.linspace(0.07, 1.0, 12):
        xi = part * rho
        # A load on the sharp surface h^2 + m^2 = xi^2 (1 - xi/rho)^(2 beta)
        side = (1.0 - part) ** beta
        h, m = xi * side * math.cos(0.8), xi * side * math.sin(0.8)
        size = float(surface(xi, h, m, beta).size)
        rounded = max(1.0 - xi / size, 0.0) ** beta
        # eta = sqrt(x^2 + e^2) - e lies between x - e and x; rounding at the vertex.
        assert side - VERTEX_ROUNDING <= rounded + 1e-6
        assert rounded <= side + 1e-6
        # Nor is the surface anywhere farther off than that.
        assert size <= rho * (1.0 + 1e-6)


def flow_of_load(xi, h, m, beta, hardening):
    soil = Soil()
    return flow_rate(loading_surface(xi, h, m, beta), hardening, 0.3, 0.8, soil)


@unfused_jit
def flow_with_slopes(beta, *loads):
    """Of all loads at once; one program, which serves every beta."""

    def of_load(xi, h, m):
        point = (xi, h, m, beta, 0.01)
        slope = jax.jacfwd(flow_of_load, argnums=(0, 1, 2, 3, 4))(*point)
        return flow_of_load(*point), slope, loading_surface(xi, h, m, beta)

    return jax.vmap(of_load)(*loads)


@pytest.mark.slow
@pytest.mark.parametrize("beta", BETAS)
def test_no_load_and_vanishing_loads_are_finite_with_their_gradients(beta):
    # xi, h, m: none; lifted off; no moment and no shear; vanishing normal load with
    # and without shear (N comes down from 1e4 N: 1e-12 of that is nought).
    corners = [
        (0.0, 0.0, 0.0),
        (0.0, 0.1, 0.1),
        (-0.1, 0.1, 0.0),
        (0.2, 0.0, 0.0),
        (1e-30, 0.0, 0.0),
        (1e-12, 0.1, 0.0),
        (1e-30, 0.0, 0.1),
        (50.0, 1e3, 1e3),
    ]
    loads = [jnp.asarray(column) for column in zip(*corners, strict=True)]

    value, slope, load = flow_with_slopes(beta, *loads)
    for i, corner in enumerate(corners):
        lane = jax.tree.map(lambda x, i=i: x[i], (value, slope, load))
        assert all_finite(lane), corner
    # Without load nothing flows.
    np.testing.assert_array_equal(np.stack(value)[:, 0], 0.0)
    # As the normal load vanishes the flow goes to what it is without and below.
    np.testing.assert_array_equal(np.stack(value)[:, 2], np.stack(value)[:, 5])
    # Central load flows straight down.
    np.testing.assert_array_equal(np.stack(value[1:])[:, 3:5], 0.0)
    assert value.normal[3] > 0.0


def test_gradient_is_continuous_at_the_vertex_for_a_large_exponent():
    sides = np.array([1e-3, 1e-6, 1e-9])
    slopes = [float(surface(0.2, side, 0.0, 1.9).tangential) for side in sides]
    # It goes to 0 as h^(2/beta - 1) = h^0.05, slowly.
    assert slopes[0] > slopes[1] > slopes[2] > 0.0
    assert slopes[2] / slopes[1] == pytest.approx(1e-3 ** (2.0 / 1.9 - 1.0), rel=1e-3)
    assert surface(0.2, 0.0, 0.0, 1.9).tangential == 0.0


# Flow


def test_overstress_is_relative_and_one_sided():
    assert float(overstress(0.3, 0.2)) == pytest.approx(0.5, rel=ROUNDING)
    assert overstress(0.1, 0.2) == 0.0


def test_flow_direction_is_a_unit_vector_with_the_heave_reduced():
    rising = Load(1.0, -3.0, 2.0, 6.0, 1.0, 1.0)
    associated = flow_direction(rising, 1.0)
    np.testing.assert_allclose(associated, (-3 / 7, 2 / 7, 6 / 7), rtol=ROUNDING)
    flat = flow_direction(rising, 0.0)
    np.testing.assert_allclose(flat, (0.0, *np.array([2.0, 6.0]) / math.sqrt(40)))
    sinking = Load(1.0, 3.0, 2.0, -6.0, 1.0, 1.0)
    for dilatancy in (0.0, 0.5, 1.0):
        expected = (3 / 7, 2 / 7, -6 / 7)
        np.testing.assert_allclose(
            flow_direction(sinking, dilatancy), expected, rtol=ROUNDING
        )


# Hardening


@given(
    hardening=st.floats(0.0, 2.0),
    normal=st.floats(-1e3, 1e3),
    tangential=st.floats(-1e3, 1e3),
    rotational=st.floats(-1e4, 1e4),
)
def test_hardening_grows_towards_one_and_never_passes_it(
    hardening, normal, tangential, rotational
):
    flow = FlowRate(normal, tangential, rotational)
    rate = hardening_rate(hardening, flow, 0.3, 0.4, Soil(alpha_vR=1.0))
    # Towards 1 from below, from above, and at rest there: so it is never passed.
    assert np.isfinite(rate)
    assert float(rate) * (1.0 - hardening) >= 0.0
    if hardening == 1.0:
        assert rate == 0.0


# Slider


@given(
    T=st.floats(-1e6, 1e6),
    N=st.floats(0.0, 1e6),
    stiffness=st.floats(1e3, 1e9),
    friction=st.floats(0.0, 2.0),
)
def test_slip_follows_coulomb_and_is_antisymmetric(T, N, stiffness, friction):
    rate = float(Coulomb()(T, N, stiffness, friction))
    assert rate == -float(Coulomb()(-T, N, stiffness, friction))
    if abs(T) <= N * friction:
        assert rate == 0.0
    else:
        excess = math.copysign(abs(T) - N * friction, T)
        expected = excess / (stiffness * RELAXATION_TIME)
        # Rounding of the difference.
        assert rate == pytest.approx(expected, rel=1e-12, abs=1e-300)
        # Slip dissipates.
        assert rate * T >= 0.0


# The laws together


def scene_at_work():
    return Scene(
        Block(aspect_ratio=2.0),
        Soil(alpha_vR=0.5, eta_N=0.1, alpha_s=0.4),
        Impact(angle=0.6, orientation=0.4),
    )


def rates_of(scene, *, damped):
    """Everything that a state in full contact gives under the laws of a scene."""
    ground = prepare(scene)
    motion = initial_motion(scene)._replace(
        penetration=jnp.asarray(0.05),
        elastic_normal=jnp.asarray(1e-3),
        elastic_tangential=jnp.asarray(2e-3),
        elastic_rotation=jnp.asarray(1e-3),
    )
    forces = Forces(*map(jnp.asarray, (4e3, 1e3, 2e2))) if damped else None
    now = contact(ground, motion, forces)
    leaves = jax.tree.leaves((now, force_rate(ground, now, 0.01, 0.0)))
    return np.array([float(leaf) for leaf in leaves])


@pytest.mark.parametrize("slot", parts_of(Soil))
def test_every_law_can_be_replaced_and_is_used(slot):
    scene = scene_at_work()
    law = getattr(scene.soil, slot)

    def one_percent_more(name):
        def method(self, *arguments, **branch):
            found = getattr(law, name)(*arguments, **branch)
            return jax.tree.map(lambda x: 1.01 * x, found)

        return method

    name = "sinking_arm" if slot == "kinematics" else "__call__"
    kind = type("Changed", (type(law),), {name: one_percent_more(name)})
    other = kind(
        **{field.name: getattr(law, field.name) for field in dataclasses.fields(law)}
    )
    soil = dataclasses.replace(scene.soil, **{slot: other})
    if slot == "kinematics":
        turning = dataclasses.replace(scene.impact, angular_velocity=5.0)
        scene = dataclasses.replace(scene, impact=turning)
    changed = dataclasses.replace(scene, soil=soil)
    damped = slot == "damping"
    with_change, usual = (rates_of(each, damped=damped) for each in (changed, scene))
    assert not np.allclose(with_change, usual, rtol=1e-6)


@unfused_jit  # With fusion it compiles for minutes.
def contact_with_slopes(scene, motions):
    def numbers(scene, motion):
        return contact(prepare(scene), motion)

    def with_slopes(motion):
        slopes = jax.jacfwd(numbers, argnums=(0, 1))(scene, motion)
        return numbers(scene, motion), slopes

    return jax.vmap(with_slopes)(motions)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("aspect_ratio", "orientation"), [(1.0, 0.0), (2.0, 0.0), (2.0, 0.4)]
)
def test_contact_is_finite_with_its_gradients_at_every_singular_state(
    aspect_ratio, orientation
):
    scene = Scene(
        Block(aspect_ratio=aspect_ratio), Soil(), Impact(orientation=orientation)
    )
    start = initial_motion(scene)
    zero = jnp.zeros(())
    unloaded = start._replace(elastic_normal=zero)
    states = {
        "at the start": start,
        "no foundation": start._replace(penetration=zero),
        "in the air": start._replace(penetration=zero - 0.1),
        "no force": unloaded,
        "no force, no foundation": unloaded._replace(penetration=zero),
        "pulled": start._replace(elastic_normal=zero - 1e-4),
        "shear without normal force": unloaded._replace(elastic_tangential=zero + 1e-4),
        "turned": start._replace(rotation=zero + 1.3),
        "at rest": unloaded._replace(normal_velocity=zero),
        "hardened": start._replace(hardening=zero + 1.0),
    }
    batch = jax.tree.map(lambda *leaves: jnp.stack(leaves), *states.values())

    value, slopes = contact_with_slopes(jax.tree.map(jnp.asarray, scene), batch)
    for i, name in enumerate(states):
        lane = jax.tree.map(lambda x, i=i: x[i], (value, slopes))
        assert all_finite(lane), name


def test_a_law_without_parameters_refuses_any():
    with pytest.raises(TypeError, match="DeepestPoint has no field 'x'; it has none"):
        DeepestPoint(x=1.0)


def test_a_law_in_a_file_whose_name_cannot_be_encoded_is_refused():
    """As every letter beyond ASCII where Python runs with `LC_ALL=C` and without its
    UTF-8 mode."""
    with pytest.raises(InputError, match=r"cannot be read: .*it is named as the flow"):
        Soil(flow="\ud800.py:F")
