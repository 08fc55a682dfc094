"""What small motion cannot tell apart is equally probable, and what acts in proportion is named first."""

import pytest
from trial_records import REFERENCE, fit_of

from identification.evidence import Ranked
from identification.hypothesis import Hypothesis
from identification.tangent_ties import is_linear, tied
from models.effects import Place
from models.effects.bouc_wen import BoucWen
from models.effects.clamp_compliance import ClampCompliance
from models.effects.clearance import Clearance
from models.effects.coulomb_friction import CoulombFriction
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain
from models.effects.squeeze_film import SqueezeFilm

SLEEVE, HERE = Place(sleeve="sleeve 2", position=1.0), Place(position=1.0)
FILM, DASHPOT, MASS = SqueezeFilm(SLEEVE, 20.0), PointDamping(HERE, 660.0), PointMass(HERE, 0.2)


def ranked(effect, chi2, log_evidence, *, refitted=True):
    return Ranked(effect, fit_of(effect, chi2), refitted=refitted, log_evidence=log_evidence)


@pytest.mark.parametrize("effect", [DASHPOT, MASS, ClampCompliance(Place(), 2e4), SensorGain(Place(sensor="P1"), 0.8)])
def test_springs_dashpots_masses_and_sensors_are_linear(effect):
    assert is_linear(Hypothesis(REFERENCE, effects=(FILM, effect)))


@pytest.mark.parametrize(
    "effect",
    [
        FILM,
        CoulombFriction(HERE, friction_force=1.0, slip_velocity=1e-3),
        CubicStiffness(HERE, stiffness=1e8),
        BoucWen(HERE, 1.0, 1e-4, 1.0),
        Clearance(SLEEVE, clearance=1e-4),
    ],
)
def test_films_friction_hardening_hysteresis_and_gaps_are_not(effect):
    assert not is_linear(Hypothesis(REFERENCE, effects=(DASHPOT, effect)))


def test_of_what_fits_alike_the_linear_is_first_and_none_more_probable():
    rows = [ranked(FILM, 1000.0, 0.0), ranked(DASHPOT, 1003.0, -8.0), ranked(MASS, 1500.0, -260.0)]

    found = tied(rows)

    assert [(row.effect, row.log_evidence) for row in found] == [(DASHPOT, 0.0), (FILM, 0.0), (MASS, -260.0)]
    quick = ranked(MASS, 400.0, -260.0, refitted=False)
    assert [row.effect for row in tied([*rows[:2], quick])] == [DASHPOT, FILM, MASS]


def test_what_fits_worse_or_was_not_refitted_is_no_tie():
    rows = [ranked(FILM, 1000.0, 0.0), ranked(DASHPOT, 1050.0, -30.0), ranked(MASS, 400.0, -1.0, refitted=False)]

    assert [(row.effect, row.log_evidence) for row in tied(rows)] == [(r.effect, r.log_evidence) for r in rows]
    assert tied([]) == []
