"""Between what a test is chosen: effects that are two, not one whose place along the beam is not told."""

import numpy as np
import pytest

from identification.evidence import Ranked
from identification.fit import Fit
from identification.hypothesis import Hypothesis, effect_unknowns
from identification.next_experiment.rivals import rivals_of
from models.effects import Place
from models.effects.absorber import Absorber
from models.effects.point_mass import PointMass
from tests.identification.trial_records import REFERENCE


def ranked(effect):
    hypothesis = Hypothesis(REFERENCE, effects=(effect,))
    unknowns = effect_unknowns(hypothesis)
    zeros = np.zeros((len(unknowns), 100))
    fit = Fit(hypothesis, unknowns, 100.0, 0.0, 100, np.zeros(100), zeros, 1e-4 * np.eye(len(unknowns)))
    return Ranked(effect, fit, refitted=True, log_evidence=0.0)


def mass(position):
    return PointMass(Place(position=position), mass=0.3)


@pytest.mark.parametrize(("position", "n_rivals"), [(0.78, 0), (1.3, 2)])
def test_one_effect_at_places_of_one_valley_has_no_rival(position, n_rivals):
    rivals = rivals_of([ranked(mass(0.7)), ranked(mass(position))], [0.6, 0.4])

    assert len(rivals) == n_rivals


def test_what_is_one_is_as_probable_as_all_its_places():
    absorber = Absorber(Place(position=0.7), mass=0.3, frequency=20.0, damping_ratio=0.1)

    rivals = rivals_of([ranked(absorber), ranked(mass(0.7)), ranked(mass(0.78))], [0.4, 0.3, 0.3])

    assert [(rival.effect, rival.chance) for rival in rivals] == [(mass(0.7), pytest.approx(0.6)), (absorber, 0.4)]
