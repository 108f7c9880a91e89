"""The laws that the package has besides the usual ones: finite, dissipative, equal to
the usual one where they must be, and the equation that each names."""

import math
from types import SimpleNamespace

import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from impact_scenes import mixed_scenes
from other_laws import other_laws

from jaximpact import Block, Impact, Outcome, Scene, Soil, simulate, simulate_batch
from jaximpact import laws as known
from jaximpact import shapes as known_shapes
from jaximpact.impact.events import Margins
from jaximpact.integrator.summarise import _falls_through
from jaximpact.laws import Forces
from jaximpact.laws.flow import AbstractFluidityFlow
from jaximpact.shapes import Foundation

pytestmark = pytest.mark.slow

OTHERS = other_laws()
FLOWS = [known.Perzyna, *(kind for slot, kind in OTHERS if slot == "flow")]
SURFACES = [kind for slot, kind in OTHERS if slot == "loading_surface"]
FRICTION = 0.9
"""tan phi_p"""
# Two orders of summation of the same formula.
ROUNDING = 1e-13


def footing(length=0.4, width=0.3, sinking=0.05):
    return Foundation(*map(jnp.asarray, (length, width, sinking, 0.2, 0.1, 0.05)))


def load_of(normal=3e4, tangential=8e3, moment=-1e3, surface=None, base=None):
    forces = Forces(*map(jnp.asarray, (normal, tangential, moment)))
    surface = surface or known.NovaMontrasio()
    return surface(forces, jnp.asarray(1e5), base or footing(), FRICTION)


def numbers_of(result):
    names = ("e_n", "e_bar", "max_penetration", "max_normal_force", "duration")
    return np.array([getattr(result, name) for name in names])


def ids(pair):
    return pair[1].__name__


@pytest.mark.parametrize("other", OTHERS, ids=ids)
def test_impacts_end_with_numbers_and_the_ground_gives_no_energy(other):
    slot, kind = other
    scene = mixed_scenes(200)
    soil = Soil(**{slot: kind()}, gamma_v=scene.soil.gamma_v)
    result = simulate_batch(
        Scene(scene.block, soil, scene.impact), accuracy="balanced", ledger=True
    )
    assert not np.any(result.outcome_code == Outcome.failed)
    assert np.all(np.isfinite(numbers_of(result)))
    energy = result.energy
    incoming = np.asarray(energy.kinetic_in)
    # By no more than the ledger misses.
    missed = np.abs(np.asarray(energy.residual)) + 1e-9 * incoming
    assert np.max(missed / incoming) < 1e-2
    assert np.all(np.asarray(energy.viscoplastic) >= -missed)
    assert np.all(np.asarray(energy.slider) >= -missed)


def wide_scenes(count, seed=1):
    """Blocks, grounds and impacts over decades."""
    random = np.random.default_rng(seed)

    def decades(low, high):
        return 10.0 ** random.uniform(low, high, count)

    block = Block(mass=decades(0, 4), aspect_ratio=random.uniform(1.0, 3.0, count))
    impact = Impact(
        speed=random.uniform(1.0, 40.0, count),
        angle=random.uniform(0.0, 1.48, count),
        orientation=random.uniform(0.0, np.pi, count),
        angular_velocity=random.uniform(-20.0, 20.0, count),
    )
    numbers = dict(gamma_v=decades(-1, 2), c_v=decades(-1, 1), k_E=decades(2, 4))
    return block, impact, numbers


class Exponential(AbstractFluidityFlow):
    """Flow at every load, e^100 times the fluidity at yield."""

    def flow_size(self, load, hardening, foundation, branch):
        return self.gamma_v * jnp.expm1(100.0 * load.size / hardening)


STEEP = [(slot, kind, {}) for slot, kind in OTHERS] + [
    ("flow", known.PowerNucleus, {"nucleus_exponent": 7.0}),
    ("flow", known.PowerNucleus, {"nucleus_exponent": 20.0}),
    ("flow", Exponential, {}),
]


@pytest.mark.parametrize(
    ("slot", "kind", "values"), STEEP, ids=[f"{k.__name__}{v}" for _, k, v in STEEP]
)
def test_the_integration_converges_with_every_law(slot, kind, values):
    """Steps land on what each law has for switches: one that is missed costs the
    method its order, and e_n some hundredths. At `balanced` it is right to 1e-4, as
    with the usual laws; nothing is lost at the onset, where rates are largest."""
    block, impact, numbers = wide_scenes(400)
    soil = Soil(**{slot: kind(**values)}, **numbers)
    # The ledger is not asked for here: with it the kernels are those of the test above.
    coarse, close = (
        simulate(block, soil, impact, accuracy=accuracy, ledger=True)
        for accuracy in ("balanced", "reference")
    )
    np.testing.assert_array_equal(coarse.outcome_code, close.outcome_code)
    assert not np.any(coarse.outcome_code == Outcome.failed)
    np.testing.assert_allclose(coarse.e_n, close.e_n, rtol=2e-4, atol=2e-4)


def test_an_impact_that_stalls_is_tried_once_more():
    """At this tolerance, or one beside it, steps at the onset never grow."""
    soil = Soil(
        loading_surface=known.SharperVertex(),
        **dict(gamma_v=2.485542, c_v=0.4099751, k_E=7533.262, friction_angle=0.3635157),
        **dict(unit_weight=21481.53, relative_density=0.9408929, beta=0.9527253),
        **dict(psi=0.3355094, alpha_vT=3.31399, alpha_vR=0.9919649, alpha_s=1.060613),
        **dict(n_E=0.05640413, poisson=0.3198447),
    )
    block = Block(mass=103.859, density=2640.822, aspect_ratio=0.6195983)
    impact = Impact(29.68266, -0.9511691, -1.228766, -10.44417, -0.4112623)
    coarse, close = (
        simulate(block, soil, impact, accuracy=accuracy, ledger=True)
        for accuracy in ("balanced", "reference")
    )
    assert float(coarse.e_n) == pytest.approx(float(close.e_n), abs=2e-4)


@pytest.mark.parametrize(
    "dashpots",
    [{"eta_R": 0.1}, {"eta_R": 1e-6}, {"eta_T": 0.1}, {"eta_N": 0.1}],
    ids=lambda dashpots: "".join(dashpots),
)
def test_one_dashpot_alone(dashpots):
    """What has none is known, and does not follow the springs: it would chatter."""
    block, impact, numbers = wide_scenes(300, seed=2)
    results = [
        simulate(block, Soil(**numbers, **dashpots), impact, accuracy=accuracy)
        for accuracy in ("balanced", "reference")
    ]
    coarse, close = (np.asarray(result.e_n) for result in results)
    assert not np.any(np.isnan(coarse) | np.isnan(close))
    # Where forces jump to another state, one in a hundred ends otherwise.
    assert np.mean(np.abs(coarse - close) > 1e-3 * (1.0 + np.abs(close))) < 0.01


def test_a_rocking_dashpot_against_the_independent_integrator():
    """The e_n of `model_oracle` at a tolerance of 1e-9."""
    block = Block(mass=89.8799674702231, aspect_ratio=3.3766069694587673)
    numbers = dict(gamma_v=35.30271269708544, c_v=0.14428063161848484, eta_R=0.1)
    impact = Impact.from_degrees(
        *(1.0340160358598818, -33.32015373400228, -179.78303921105467),
        *(152.61474929710823, -23.726539262685023),
    )
    found = simulate(block, Soil(k_E=779.2198065269046, **numbers), impact)
    assert float(found.e_n) == pytest.approx(-0.09733698, rel=1e-4)


def test_the_largest_force_is_no_overshoot_of_a_jump():
    """Forces with dashpots jump; the rate after that is none of the step."""
    shape = known_shapes.RectangularPrism(
        aspect_ratio=3.23658, out_of_plane_ratio=0.42439
    )
    impact = Impact.from_degrees(5.01351, -47.7874, -88.8541, 6.67923, 0)
    soil = Soil(gamma_v=12.5024, c_v=1.80349, k_E=580.07, eta_N=0.1)
    block = Block(mass=6.85639, shape=shape)
    largest = [
        float(simulate(block, soil, impact, accuracy=accuracy).max_normal_force)
        for accuracy in ("balanced", "reference")
    ]
    assert largest[0] == pytest.approx(largest[1], rel=1e-4)


def test_no_item_of_the_ledger_exceeds_what_was_supplied():
    """Powers of a load between two steps may be of any size, and cancel."""
    block, impact, numbers = wide_scenes(2000, seed=4)
    flow = known.PowerNucleus(nucleus_exponent=13.0, dilatancy=0.7)
    result = simulate(block, Soil(flow=flow, **numbers), impact, ledger=True)
    energy = result.energy
    supplied = energy.kinetic_in + sum(
        map(np.abs, (energy.gravity, energy.arm, energy.stiffness))
    )
    ended = result.outcome_code != Outcome.failed
    assert np.mean(ended) > 0.995
    items = np.abs(np.stack(energy))[:, ended]
    assert np.all(items <= 2.0 * np.asarray(supplied)[ended])


@pytest.mark.parametrize(
    ("approach", "force", "toppling", "falls"),
    [
        (2.0, -1e-3, -1e-9, True),
        (-2.0, -1e-3, -1e-9, False),  # it rises: it has detached
        (2.0, 50.0, -1e-9, False),  # under load: it topples
        (2.0, -1e-3, 0.2, False),  # another end than the edge
    ],
)
def test_what_falls_through_the_ground_is_failed(approach, force, toppling, falls):
    """A block that still sinks at the edge of a foundation that carries nothing has not
    detached: steps have lost the force, as they may where beta is above 1.2."""
    end = SimpleNamespace(
        event=jnp.asarray(True),
        margins=Margins(*map(jnp.asarray, (0.1, 0.1, toppling, 0.1))),
    )
    now = SimpleNamespace(
        approach=(jnp.asarray(approach),), normal_force_before_cut=jnp.asarray(force)
    )
    assert bool(_falls_through(end, now)) is falls


RATIOS = st.floats(-1.0, 1.0).map(lambda x: math.copysign(abs(x) ** 3, x))


@pytest.mark.parametrize("flow", FLOWS)
@pytest.mark.parametrize("surface", [known.NovaMontrasio, *SURFACES])
@given(
    normal=st.floats(0.0, 1e6),
    shear=RATIOS,
    rocking=RATIOS,
    hardening=st.floats(1e-3, 1.0),
    length=st.floats(1e-6, 3.0),
    dilatancy=st.floats(0.0, 1.0),
    beta=st.floats(0.3, 1.9),
)
def test_flow_dissipates(
    flow, surface, normal, shear, rocking, hardening, length, dilatancy, beta
):
    base = footing(length=length)
    forces = normal, 3.0 * shear * normal, 3.0 * rocking * length * normal
    load = load_of(*forces, surface=surface(beta=beta), base=base)
    rates = flow(dilatancy=dilatancy)(load, jnp.asarray(hardening), base)
    assert np.all(np.isfinite(rates))
    powers = np.multiply(forces, rates)
    assert np.sum(powers) >= -1e-12 * np.sum(np.abs(powers))


# Where each is the usual law


def test_a_fluidity_that_is_a_rate_is_one_of_speed_times_the_length():
    load, hardening = load_of(), jnp.asarray(0.1)
    for rate, speed in (
        (known.FluidityRate(dilatancy=0.3), known.Perzyna(dilatancy=0.3)),
        (known.PowerNucleusRate(dilatancy=0.3), known.PowerNucleus(dilatancy=0.3)),
    ):
        same = np.array(speed(load, hardening, footing(length=1.0)))
        at_one, at_half = (
            np.array(rate(load, hardening, footing(length=size))) for size in (1.0, 0.5)
        )
        np.testing.assert_array_equal(at_one, same)
        np.testing.assert_allclose(at_half, 0.5 * same, rtol=ROUNDING)


def test_hardening_by_every_length_is_the_same_where_lengths_are():
    flow = known.FlowRate(*map(jnp.asarray, (0.3, -0.1, 0.2)))
    hardening = jnp.asarray(0.2)
    values = {"c_v": 0.7, "alpha_vT": 1.5, "alpha_vR": 0.4}

    def rate(kind, **sizes):
        return float(kind(**values)(hardening, flow, footing(**sizes)))

    for length, width in ((0.5, 0.2), (1.0, 1.0)):
        path = 0.7 * 0.8 * (0.3 + 1.5 * 0.1 + 0.4 * length * 0.2)
        for kind, size in (
            (known.HardeningPerLength, length),
            (known.HardeningPerRootArea, math.sqrt(length * width)),
            (known.HardeningPerMetre, 1.0),
        ):
            found = rate(kind, length=length, width=width)
            assert found == pytest.approx(path / size, rel=ROUNDING)


TALL = Block(aspect_ratio=2.0)


@pytest.mark.parametrize(
    ("usual", "other", "scenes"),
    [
        # A sphere's foundation is as wide as long.
        (
            Soil(),
            Soil(hardening=known.HardeningPerRootArea()),
            [(Block(), Impact(angle=0.6))],
        ),
        # Without an exponent the modulus is the same everywhere.
        (
            Soil(n_E=0.0),
            Soil(elasticity=known.ContactPressureModulus(n_E=0.0)),
            [(TALL, Impact(angle=0.5, orientation=0.4))],
        ),
        # Arms are equal under central loads.
        (
            Soil(),
            Soil(kinematics=known.WorkConjugate()),
            [
                (TALL, Impact()),
                (TALL, Impact(orientation=0.5 * math.pi)),
                (Block(), Impact(angle=0.6, angular_velocity=20.0)),
            ],
        ),
    ],
    ids=["hardening", "elasticity", "kinematics"],
)
def test_impacts_are_the_usual_ones_where_the_laws_are(usual, other, scenes):
    for block, impact in scenes:
        pair = [
            simulate(block, soil, impact, accuracy="reference")
            for soil in (usual, other)
        ]
        np.testing.assert_allclose(*map(numbers_of, pair), rtol=1e-7)


def test_work_conjugate_sinking_has_no_arm_work():
    # Eccentric, where the usual arm work is 14 % of the incoming energy.
    impact = Impact(orientation=math.radians(30.0), angle=0.3)
    usual, conjugate = (
        simulate(TALL, Soil(kinematics=kind()), impact)
        for kind in (known.DeepestPoint, known.WorkConjugate)
    )
    assert float(usual.energy.arm) < -0.1 * float(usual.energy.kinetic_in)
    assert float(conjugate.energy.arm) == 0.0
    residual = abs(float(conjugate.energy.residual))
    assert residual < 1e-4 * float(conjugate.energy.kinetic_in)
    # What the form of the model leaves open in an eccentric impact.
    assert abs(float(conjugate.e_n) - float(usual.e_n)) < 0.2
    assert abs(float(conjugate.e_n)) < 0.02


# The equation that each names


def test_flows_change_what_they_name():
    hardening, base, load = jnp.asarray(0.2), footing(), load_of()
    usual = np.array(known.Perzyna()(load, hardening, base))
    ratio = float(load.size) / 0.2
    assert ratio > 1.0
    for flow, factor in (
        (known.AbsoluteOverstress(), 0.2),
        (known.SquaredOverstress(), ratio - 1.0),
        (known.PowerNucleus(nucleus_exponent=3.0), ratio**3 / (ratio - 1.0)),
        (known.PowerNucleus(), ratio**2 / (ratio - 1.0)),
    ):
        np.testing.assert_allclose(
            flow(load, hardening, base), factor * usual, rtol=1e-12
        )


def test_a_nucleus_without_a_threshold_flows_below_yield():
    load, hardening = load_of(), jnp.asarray(0.9)
    assert float(load.size) < 0.9
    assert float(known.Perzyna()(load, hardening, footing()).normal) == 0.0
    assert float(known.PowerNucleus()(load, hardening, footing()).normal) > 0.0


class Creep(known.Perzyna):
    """Perzyna's law with a power of the load in place of the overstress."""

    def flow_size(self, load, hardening, foundation, branch):
        return self.gamma_v * (load.size / hardening) ** 2


class CreepOfAnotherName(Creep):
    """Nothing is changed."""


class Oil(known.DampingRatios):
    """A dashpot beside the ratios."""

    def __call__(self, stiffness, mass, inertia):
        found = super().__call__(stiffness, mass, inertia)
        return found._replace(normal=found.normal + 2000.0)


class Smooth(known.HardeningPerLength):
    """Hardening with kinks of its own."""

    def __call__(self, hardening, flow, foundation, *, branch=None):
        return self.c_v * (1.0 - hardening) * jnp.abs(flow.rotational)


def test_what_a_law_says_of_itself_is_not_said_of_a_law_derived_from_it():
    assert not known.Perzyna.flows_below_yield
    assert Creep.flows_below_yield
    assert CreepOfAnotherName.flows_below_yield
    assert not any(known.DampingRatios().acts())
    assert all(Oil().acts())
    assert known.HardeningPerLength().heeds_signs() == (True, False)
    assert all(Smooth().heeds_signs())


def test_pressed_springs_carry_the_pressure_that_their_modulus_is_taken_at():
    law = known.ContactPressureModulus(k_E=700.0, n_E=0.3, poisson=0.25, S_ef=0.8)
    length, width, elastic = 0.5, 0.32, 2e-3
    stiffness = law(footing(length, width), jnp.asarray(18e3), jnp.asarray(elastic))
    normal = float(stiffness.normal) * elastic
    pressure = normal / (0.25 * math.pi * length * width)
    shear = 0.8 * 700.0 * 1e5 * (pressure / 1e5) ** 0.3 / 2.5
    radius = 0.5 * math.sqrt(length * width)
    shape = 0.957 * math.exp(0.0394 * length / width)
    expected = (
        shape * 4.0 * shear * radius / 0.75,
        8.0 * shear * radius / 1.75,
        8.0 * shear * radius**3 / 2.25,
    )
    np.testing.assert_allclose(stiffness, expected, rtol=1e-12)
    unloaded = law(footing(), jnp.asarray(18e3), jnp.asarray(0.0))
    assert np.all(np.isfinite(unloaded))
    assert np.all(np.array(unloaded) > 0.0)


@pytest.mark.parametrize(
    ("kind", "initial"), [(known.SofterStart, 0.001), (known.HarderStart, 0.1)]
)
def test_another_start_of_hardening_is_that_and_nothing_else(kind, initial):
    impact = Impact(angle=0.3)
    result = simulate(Block(), Soil(hardening=kind()), impact, history=True)
    assert float(result.history.hardening[0]) == initial
    flow = known.FlowRate(*map(jnp.asarray, (0.3, -0.1, 0.2)))
    for hardening in (0.01, 0.2, 0.99):
        rates = [
            law(jnp.asarray(hardening), flow, footing())
            for law in (kind(), known.HardeningPerLength())
        ]
        assert float(rates[0]) == float(rates[1])


def test_a_vertex_is_rounded_by_what_is_named():
    xi, h, m = 0.3, 8e3 / (FRICTION * 1e5), 1e3 / (0.33 * 0.4 * 1e5)
    for surface, rounding in (
        (known.NovaMontrasio(), 0.01),
        (known.SharperVertex(), 1e-3),
        (known.BlunterVertex(), 0.1),
    ):
        eta = math.hypot(math.hypot(h, m) / xi, rounding) - rounding
        load = load_of(surface=surface)
        assert float(load.size) == pytest.approx(
            xi / (1.0 - eta ** (1.0 / 0.9)), rel=1e-12
        )


def test_limit_loads_lack_what_they_name():
    friction = jnp.asarray(0.7)
    base = footing(0.4, 0.3, 0.2)

    def limit(bearing):
        return float(bearing(base, jnp.asarray(18e3), bearing.factors(friction)))

    usual, shallow, least = (
        limit(getattr(known, f"Vesic{name}")())
        for name in ("", "WithoutDepthFactor", "WithoutSurcharge")
    )
    surcharge = float(known.Vesic().factors(friction).surcharge)
    of_depth = 0.25 * math.pi * 0.4 * 0.3 * 18e3 * 0.2 * surcharge
    shape = 1.0 + 0.75 * math.tan(0.7)
    assert shallow - least == pytest.approx(of_depth * shape, rel=1e-12)
    assert usual > shallow
