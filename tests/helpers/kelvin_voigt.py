"""A mass that strikes a spring and a dashpot side by side, which cannot pull: an impact
with a closed form, posed as `integrate` takes it."""

from types import SimpleNamespace

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from jaximpact import Soil
from jaximpact.impact.events import Margins, Switches
from jaximpact.impact.problem import Observed, Watched
from jaximpact.impact.reduced_models import VERTICAL

MASS, SPEED = 2_700.0, 10.0
STIFFNESS, DAMPING = 4e6, 2e4


def exact_restitution(stiffness, damping):
    r"""Speed when the force is back at zero, by that at touch.

    $x = v\,e^{-\delta t}\sin(\omega t)/\omega$; the force is zero where $\ddot x$ is.
    """
    decay = damping / (2.0 * MASS)
    pulsation = jnp.sqrt(stiffness / MASS - decay**2)
    phase = jnp.pi - jnp.arctan(2.0 * decay * pulsation / (pulsation**2 - decay**2))
    faded = jnp.exp(-decay * phase / pulsation)
    return faded * (decay / pulsation * jnp.sin(phase) - jnp.cos(phase))


def exact_deepest(stiffness, damping):
    """Largest displacement, where the velocity is zero, and its time."""
    decay = damping / (2.0 * MASS)
    pulsation = np.sqrt(stiffness / MASS - decay**2)
    time = np.arctan(pulsation / decay) / pulsation
    return SPEED * np.exp(-decay * time) * np.sqrt(MASS / stiffness), time


class KelvinVoigt(eqx.Module):
    """The initial value problem: displacement and velocity, without switches."""

    stiffness: Float[Array, ""]
    damping: Float[Array, ""]
    tolerance: Float[Array, ""]

    max_steps: int = eqx.field(default=100_000, static=True)

    model = VERTICAL._replace(unknowns=("penetration", "normal_velocity"))
    ledger = False
    ground = SimpleNamespace(soil=Soil())
    settled_sinking = -jnp.inf
    """All forces count, that of the start too."""

    @property
    def scale(self):
        """Displacement and velocity without damping."""
        return jnp.stack([SPEED * jnp.sqrt(MASS / self.stiffness), self.speed])

    @property
    def speed(self):
        return jnp.full_like(self.stiffness, SPEED)

    @property
    def start(self):
        return jnp.stack([jnp.zeros_like(self.stiffness), self.speed])

    @property
    def passing_time(self):
        return jnp.sqrt(MASS / self.stiffness)

    def allowed_error(self, size, largest_force):
        return self.tolerance * jax.lax.stop_gradient(size + 0.01 * self.scale)

    def force(self, rows):
        return self.stiffness * rows[0] + self.damping * rows[1]

    def rates(self, rows, branch=None, stalled=None):
        return [rows[1], -self.force(rows) / MASS]

    def watch(self, rows, largest_force, branch=None):
        force, still = self.force(rows), jnp.zeros_like(rows[0])
        observed = Observed(rows[0], rows[0], force, still, still)
        switches = Switches(*[still + 1.0] * 8)
        return Watched(observed, self.margins(rows, largest_force), switches)

    def watch_with_rate(self, vector, rates, largest_force, branch):
        return jax.jvp(
            lambda rows: self.watch(rows, largest_force),
            (list(vector),),
            (list(rates),),
        )

    def is_jump_of_forces(self, before, after):
        return jnp.zeros(before.shape[1:], bool)

    def on_next_side(self, vector, branch, watched):
        return vector

    def margins(self, rows, largest_force):
        one = jnp.ones_like(rows[0])
        at_touch = jax.lax.stop_gradient(self.damping * SPEED)
        return Margins(self.force(rows) / at_touch, one, one, one)
