"""Models and rankings follow what a diagnosis fits on, and the noise as it is known."""

from dataclasses import replace

import numpy as np
import pytest
from trial_records import OSCILLATOR, beam_session, found_with, rising_session

from identification.evidence import Ranked
from identification.fit import fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.noise_left import with_noise
from identification.outcome import candidates_of
from identification.relearning import HOPELESS, everything_again, fitted_again
from models.effects import Place
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.point_mass import PointMass


def test_what_was_ranked_on_the_part_is_ranked_on_the_whole():
    effect = CubicStiffness(Place(), stiffness=2e10)
    session, part = rising_session(Hypothesis(OSCILLATOR, effects=(effect,)), 1.0)
    added = Hypothesis(OSCILLATOR, effects=(effect,))
    unknowns = (*rig_unknowns(OSCILLATOR), *effect_unknowns(added))
    suspect = fit(session.fitting, added, unknowns, max_iterations=0)  # the part hardly tells its size
    row = Ranked(effect, suspect, refitted=True, log_evidence=0.0)
    session.lengthen(part)

    chain, rounds = everything_again(session, [part], [[row]])

    assert chain[0].n_data == rounds[0][0].fit.n_data == session.fitting.n_data > suspect.n_data
    (told,) = candidates_of(rounds[0], [1.0], session.fitting, 1.0, Hypothesis(OSCILLATOR))
    assert told.nrmse == pytest.approx(session.fitting.targets[0].nrmse_of_noise, rel=0.1)


def test_a_fit_that_has_ended_is_not_made_again():
    session, part = rising_session(Hypothesis(OSCILLATOR), 1.0)
    ended, other = fitted_again(session, [part, part])

    chain, _ = everything_again(session, [ended, other], [], ended=ended)

    assert chain[0] is ended
    assert chain[1] is not other


@pytest.mark.parametrize(("behind", "moved"), [(0.5 * HOPELESS, True), (2.0 * HOPELESS, False)])
def test_a_hopeless_row_stays_where_it_is_and_is_weighed_on_the_noise_as_it_is_now(behind, moved):
    session = beam_session(PointMass(Place(position=0.86), mass=0.1))
    right = Ranked.of(found_with(session, PointMass(Place(position=0.86), mass=0.1)))
    begun = found_with(session, PointMass(Place(position=0.5), mass=0.05), iterations=0)
    row = replace(Ranked.of(begun), log_evidence=-behind)
    louder = [replace(target.noise, sensors=2.0 * target.noise.sensors) for target in session.fitting.timed]
    session.fitting = with_noise(session.fitting, louder, right.fit.hypothesis, np.random.default_rng(0))

    _, (rows,) = everything_again(session, [], [[right, row]])

    again = next(each for each in rows if each.effect.place != right.effect.place and each is not rows[0])
    assert (again.effect != row.effect) == moved
    assert again.fit.chi2 < 0.5 * begun.chi2
