"""What the test bench really is: the rod off its drawing, grease in the sleeves, all drawn before any model ran.

The rod and its contacts are the same in all tests; every pair of contact rings comes with grease of its own. The grease
is the same at the begin of every test, so what it does over time is the same in all tests of a clearance.
"""

import numpy as np

from models.effects import Effect
from models.effects.coulomb_friction import CoulombFriction
from models.effects.protocol import Place
from models.effects.squeeze_film import SqueezeFilm
from models.effects.time_varying_damping import TimeVaryingDamping
from testbed.article.published import published
from testbed.article.rig import Drive, Geometry
from testbed.hidden_effects.truth import Truth
from testbed.virtual.as_built import perturbed
from testbed.virtual.noise import Noise

SEED = 1458
"""Of the rod's numbers, the grease and the noise; set before any model ran on what comes out."""

FILM = (0.5, 2.0)
"""Damping of the squeeze film in the middle of the gap, N s/m, log-uniform."""

FRESH, LEFT = (60.0, 160.0), (0.15, 0.45)
"""Contact damping with fresh grease, N s/m, and the share of it that stays, both log-uniform."""

RUNS_OFF = (1.5, 5.0)
"""Time constant with which the grease runs off, s, log-uniform."""

KNOTS = (0.0, 1.0, 2.0, 4.0, 6.0, 8.0)
"""At which the damping over time is told, s; straight between them."""

FRICTION, SLIP = (0.3, 1.2), (5e-3, 2e-2)
"""In the second sleeve, where the rod lies at every clearance: N and m/s, log-uniform."""

NOISE = Noise(response=0.003, excitation=0.003)
"""Of the sensors, as a share of all channels' rms in a record, and of the excitation's."""


def truth_of(geometry: Geometry, clearance: float, drive: Drive, engine: str) -> Truth:
    """What stands on the test bench.

    Args:
        geometry: of the rig as its owner describes it.
        clearance: of both sleeves, m, one of the article's.
        drive: which test.
        engine: that moves it.
    """
    given = geometry.rig(clearance, drive)
    number = [test.clearance for test in published()].index(clearance)
    grease = np.random.default_rng([SEED, 1, number])
    hidden: list[Effect] = []
    for sleeve in given.sleeves:
        place = Place(sleeve=sleeve.name, position=sleeve.position)
        hidden += [SqueezeFilm(place, damping=_log_uniform(grease, FILM)), _running_off(grease, place)]
    second = hidden[-1].place
    hidden.append(
        CoulombFriction(second, friction_force=_log_uniform(grease, FRICTION), slip_velocity=_log_uniform(grease, SLIP))
    )
    return Truth(perturbed(given, np.random.default_rng([SEED, 0])), tuple(hidden), engine, NOISE)


def _running_off(grease: np.random.Generator, place: Place) -> TimeVaryingDamping:
    fresh, left, lasts = _log_uniform(grease, FRESH), _log_uniform(grease, LEFT), _log_uniform(grease, RUNS_OFF)
    values = fresh * (left + (1.0 - left) * np.exp(-np.array(KNOTS) / lasts))
    return TimeVaryingDamping(place, times=KNOTS, values=tuple(values.tolist()))


def _log_uniform(rng: np.random.Generator, bounds: tuple[float, float]) -> float:
    return float(np.exp(rng.uniform(*np.log(bounds))))
