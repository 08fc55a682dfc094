"""The judgement: evidence sums to one, prefers fewer numbers, and looks at few of each kind."""

from math import log, pi, sqrt

import numpy as np
import pytest
from trial_records import REFERENCE

from identification.fit import Fit
from identification.hypothesis import Hypothesis, effect_unknowns
from identification.judge import (
    FAR_BEHIND,
    LEAST_REFITS,
    PLACES,
    Ranked,
    _best,
    _Sketch,
    log_occam,
    probabilities,
    with_evidence,
)
from models.effects import Place
from models.effects.bouc_wen import BoucWen
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.point_stiffness import PointStiffness
from models.effects.sensor_gain import SensorGain

HERE = Place(position=0.7)
MASS = PointMass(HERE, mass=0.3)


def fit_of(effect, chi2, *, std=0.01, n_data=1000, places=False):
    hypothesis = Hypothesis(REFERENCE, effects=(effect,))
    unknowns = effect_unknowns(hypothesis, places=places)
    n = len(unknowns)
    return Fit(hypothesis, unknowns, chi2, 0.0, n_data, np.zeros(n_data), np.zeros((n, n_data)), std**2 * np.eye(n))


def ranked(effect, chi2, **about):
    return Ranked(effect, fit_of(effect, chi2, **about), refitted=True, log_evidence=0.0)


def test_probabilities_are_shares_of_the_evidence():
    assert probabilities([0.0, log(3.0)]) == pytest.approx([0.25, 0.75])
    assert sum(probabilities([-5.0, 2.0, 1.0])) == pytest.approx(1.0)
    assert probabilities([-1e6, -1e6 - 800.0]) == pytest.approx([1.0, 0.0])


def test_only_differences_of_the_evidence_count():
    assert probabilities([1.0, 2.0, 3.0]) == pytest.approx(probabilities([-1e5 + 1.0, -1e5 + 2.0, -1e5 + 3.0]))


def test_of_two_that_fit_alike_the_one_with_fewer_numbers_is_believed():
    rich, poor = ranked(BoucWen(HERE, 3.0, 2e-5, 1.0), 1000.0), ranked(MASS, 1000.0)

    assert [r.effect for r in with_evidence([rich, poor])] == [poor.effect, rich.effect]


def test_more_numbers_are_believed_where_they_explain_more():
    rich, poor = ranked(BoucWen(HERE, 3.0, 2e-5, 1.0), 1000.0), ranked(MASS, 1100.0)

    assert with_evidence([poor, rich])[0].effect is rich.effect


def test_the_evidence_of_a_log_number_is_laplaces():
    (only,) = with_evidence([ranked(MASS, 900.0)])

    # Half of chi-square, and the posterior's width 0.01 beside the prior's 1.
    assert only.log_evidence == pytest.approx(-450.0 + log(0.01))


def test_the_occam_factor_of_a_place_and_of_a_linear_number():
    moving = fit_of(MASS, 900.0, places=True)
    gain = fit_of(SensorGain(Place(sensor="P3"), gain=0.5), 900.0)

    assert log_occam(moving) == pytest.approx(log(0.01) + log(sqrt(2 * pi) * 0.01 / PLACES))
    # The prior of a gain is 1 wide, 2 in units of the fitted 0.5.
    assert log_occam(gain) == pytest.approx(log(0.01 / 2.0))


def test_data_that_tell_nothing_cost_nothing():
    assert log_occam(fit_of(MASS, 900.0, std=50.0)) == 0.0


def test_a_misfit_common_to_all_softens_the_judgement():
    reached = with_evidence([ranked(MASS, 1000.0), ranked(PointDamping(HERE, damping=1.0), 1100.0)])
    missed = with_evidence([ranked(MASS, 100000.0), ranked(PointDamping(HERE, damping=1.0), 110000.0)])

    def odds(rows):
        return rows[0].log_evidence - rows[1].log_evidence

    assert odds(reached) == pytest.approx(50.0)
    assert odds(missed) == pytest.approx(50.0)  # a hundred times the difference, a hundred times the scale
    assert with_evidence([]) == []


BASE = fit_of(MASS, 1000.0)


def sketch(effect, share):
    return _Sketch(BASE, fit_of(effect, 1000.0 * (1.0 - share)))


def kinds(sketches):
    return [s.fit.hypothesis.effects[-1].kind for s in sketches]


def test_the_share_of_a_sketch_is_what_it_takes_away_less_its_occam_factor():
    assert sketch(MASS, 0.3).share == pytest.approx(0.3 + 2.0 * log(0.01) / 1000.0)


def test_the_best_sketches_are_few_of_each_kind():
    rows = [sketch(PointMass(Place(position=x), mass=0.1), 0.9 - x / 10) for x in (0.2, 0.6, 1.0)]
    rows += [sketch(PointDamping(HERE, damping=1.0), 0.8)]

    assert kinds(_best(rows, 4, 2)) == ["point_mass", "point_mass", "point_damping"]
    assert len(_best(rows, 1, 2)) == 1


def test_two_sketches_that_ended_at_one_place_are_one():
    rows = [sketch(PointMass(Place(position=x), mass=0.1), 0.9) for x in (0.7, 0.71)]
    rows.append(sketch(PointMass(Place(position=0.9), mass=0.1), 0.6))

    assert [s.fit.hypothesis.effects[-1].place.position for s in _best(rows, 4, 2)] == [0.7, 0.9]


def test_those_far_behind_are_left_out_when_there_are_enough_and_those_that_worsen_always():
    close = [MASS, PointDamping(HERE, damping=1.0), PointStiffness(HERE, stiffness=1.0)]
    far = SensorGain(Place(sensor="P3"), gain=0.5)
    rows = [sketch(effect, 0.9) for effect in close] + [sketch(far, 0.9 * FAR_BEHIND - 0.05)]

    assert len(close) == LEAST_REFITS
    assert "sensor_gain" not in kinds(_best(rows, 9, 2))
    assert "sensor_gain" in kinds(_best(rows[1:], 9, 2))
    assert _best([sketch(MASS, -0.1)], 9, 2) == []
