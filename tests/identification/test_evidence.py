"""The evidence: probabilities sum to one, and of two that fit alike the one with fewer numbers is believed."""

from dataclasses import replace
from math import log, pi, sqrt

import numpy as np
import pytest
from trial_records import REFERENCE, fit_of

from identification.evidence import (
    MODEL_ERROR,
    PLACES,
    SIMPLER,
    Ranked,
    log_occam,
    log_standing,
    log_without,
    probabilities,
    ranked_together,
    reranked,
    with_evidence,
)
from identification.hypothesis import rig_unknowns
from models.effects import Place
from models.effects.bouc_wen import BoucWen
from models.effects.clearance import Clearance
from models.effects.gap_offset import GapOffset
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain

HERE = Place(position=0.7)
SLEEVE = Place(sleeve="sleeve 1")
MASS = PointMass(HERE, mass=0.3)


N_DATA = 1000
OWN = MODEL_ERROR * N_DATA
"""What the unit of chi-square has beside the noise: the model's own error."""


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


def test_what_the_channels_share_speaks_once():
    alone = [ranked(MASS, 900.0), ranked(PointDamping(HERE, damping=1.0), 940.0)]
    shared = [replace(row, fit=replace(row.fit, repeats=4.0)) for row in alone]

    first, second = with_evidence(alone)
    again, other = with_evidence(shared)

    assert first.log_evidence - second.log_evidence == pytest.approx(20.0 / (1.0 + OWN))
    assert again.log_evidence - other.log_evidence == pytest.approx(20.0 / (4.0 + OWN))


def test_what_was_ruled_out_stays_as_far_behind_the_best_of_its_own_ranking():
    def ranking(chi2, behind):
        rows = with_evidence([ranked(MASS, chi2)])
        out = Ranked(PointDamping(HERE, damping=1.0), rows[0].fit, refitted=False, log_evidence=0.0)
        return [*rows, replace(out, log_evidence=rows[0].log_evidence - behind)]

    best, worse, *ruled_out = ranked_together(ranking(1100.0, 3.0), ranking(900.0, 5.0))

    assert (best.fit.chi2, worse.fit.chi2) == (900.0, 1100.0)
    assert [row.refitted for row in ruled_out] == [False, False]
    assert [row.log_evidence for row in ruled_out] == pytest.approx([worse.log_evidence - 3.0, best.log_evidence - 5.0])


def test_the_evidence_of_a_log_number_is_laplaces():
    (only,) = with_evidence([ranked(MASS, 900.0)])

    # Half of chi-square, the posterior's width 0.01 beside the prior's 1, and the odds of a law with one number.
    unit = 1.0 + OWN
    assert only.fit.n_data == N_DATA
    assert only.log_evidence == pytest.approx(
        -0.5 * (900.0 - N_DATA) / unit + log(0.01 * sqrt(unit)) - log(SIMPLER), abs=1e-3
    )


def test_the_occam_factor_of_a_place_and_of_a_linear_number():
    moving = fit_of(MASS, 900.0, places=True)
    gain = fit_of(SensorGain(Place(sensor="P3"), gain=0.5), 900.0)

    assert log_occam(moving) == pytest.approx(log(0.01) + log(sqrt(2 * pi) * 0.01 / PLACES), abs=1e-4)
    # The prior of a gain is 1 wide, 2 in units of the fitted 0.5.
    assert log_occam(gain) == pytest.approx(log(0.01 / 2.0), abs=1e-4)


def test_a_number_that_the_data_do_not_tell_earns_nothing_for_one_that_they_do():
    told = fit_of(MASS, 900.0, places=True)
    untold = replace(told, covariance=np.diag([told.covariance[0, 0], 1e6]))

    assert log_occam(untold) == pytest.approx(log(0.01), abs=0.01)


def test_data_that_tell_nothing_cost_nothing():
    assert log_occam(fit_of(MASS, 900.0, std=50.0)) == 0.0


def test_a_misfit_common_to_all_softens_the_judgement():
    reached = with_evidence([ranked(MASS, 1000.0), ranked(PointDamping(HERE, damping=1.0), 1100.0)])
    missed = with_evidence([ranked(MASS, 100000.0), ranked(PointDamping(HERE, damping=1.0), 110000.0)])

    def odds(rows):
        return rows[0].log_evidence - rows[1].log_evidence

    assert odds(reached) == pytest.approx(50.0 / (1.0 + OWN))
    assert odds(missed) == pytest.approx(5000.0 / (100.0 + OWN))  # a hundred times the difference, and the noise's unit
    assert with_evidence([]) == []


def test_a_difference_of_the_models_own_error_decides_nothing():
    rich, poor = ranked(BoucWen(HERE, 3.0, 2e-5, 1.0), 99500.0), ranked(MASS, 100000.0)
    many = [replace(row, fit=replace(row.fit, n_data=100000)) for row in (rich, poor)]

    assert with_evidence(many)[0].effect is poor.effect


def test_a_better_fit_of_the_first_keeps_the_order_honest():
    rows = with_evidence([ranked(MASS, 1500.0), ranked(PointDamping(HERE, damping=1.0), 1600.0)])
    out = Ranked(SensorGain(Place(sensor="P3"), gain=0.5), rows[1].fit, refitted=False, log_evidence=-2000.0)
    behind = out.log_evidence - rows[0].log_evidence

    again = reranked([*rows, out], fit_of(MASS, 1000.0))

    assert [row.effect.kind for row in again] == ["point_mass", "point_damping", "sensor_gain"]
    assert again[0].fit.chi2 == 1000.0
    assert again[0].log_evidence - again[1].log_evidence == pytest.approx(300.0 / (1.0 + OWN))
    assert again[2].log_evidence - again[0].log_evidence == pytest.approx(behind)


def test_a_number_that_an_effect_takes_out_of_play_is_as_wide_as_its_tolerance():
    """Of one wall, an offset tells its distance with the clearance, a clearance of its own without: equal odds."""
    offset, own = GapOffset(SLEEVE, 1e-4), Clearance(SLEEVE, 2e-4)
    numbers = rig_unknowns(REFERENCE)
    at = next(i for i, unknown in enumerate(numbers) if "clearance" in unknown.parameter.path)
    fine = 1e-3

    def fit_with(effect, together):
        about = fit_of(effect, 1000.0)
        information = np.diag([*np.ones(len(numbers)), 0.0])
        # The wall is where offset and clearance put it, or where the effect's own clearance does.
        wall = np.zeros(len(numbers) + 1)
        wall[-1], wall[at] = 1.0, float(together)
        covariance = np.linalg.inv(information + np.outer(wall, wall) / fine**2)
        return replace(about, unknowns=(*numbers, *about.unknowns), covariance=covariance)

    shared, alone = fit_with(offset, together=True), fit_with(own, together=False)
    assert log_without(shared, 1.0) - log_without(alone, 1.0) == pytest.approx(log(fine), abs=1e-3)
    assert 0.5 * log(shared.covariance[-1, -1] / alone.covariance[-1, -1]) == pytest.approx(-log(fine), abs=1e-3)


def test_a_further_effect_does_not_pay_again_for_what_was_found_before_it():
    """The first one's mass is known to a thousandth beside both models: of them only the second effect's is new."""
    base, further = fit_of(MASS, 1000.0), PointDamping(HERE, damping=1.0)
    known = np.diag([1e-6])
    both = replace(
        base,
        hypothesis=replace(base.hypothesis, effects=(MASS, further)),
        unknowns=(*base.unknowns, *(replace(unknown, effect=1) for unknown in fit_of(further, 1000.0).unknowns)),
        covariance=np.diag([1e-6, 1e-2]),
    )

    odds = log_without(both, 1.0) - log_standing(replace(base, covariance=known), 1.0)

    assert odds == pytest.approx(0.0, abs=1e-6)
