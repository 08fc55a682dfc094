"""The force's noise as the model carries it that explains the records, where the given one carries less."""

import numpy as np
import pytest
from trial_records import REFERENCE, evaluator_of, measured, multisine

from identification.carried import carried_by_best, excused, louder_by, on_its_noise
from identification.evaluate import carry_noise
from identification.evidence import Ranked
from identification.fit import fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.reached import NOISE_REACHED, is_faint
from identification.session import Session
from models.effects import EFFECTS, Place
from models.effects.modal_damping import ModalDamping
from models.effects.point_mass import PointMass

GIVEN = Hypothesis(REFERENCE.model_copy(update={"sleeves": (), "tolerances": {}}))
RINGING = GIVEN.with_effects(ModalDamping(Place(), ratio=0.2))


@pytest.fixture(scope="module")
def heard():
    """A rig that rings longer than its file says, under a noisy force: by the file it carries too little of that."""
    evaluator = evaluator_of(measured(RINGING, multisine(8192, rms=4.0), force_noise=0.05), rig=GIVEN.rig)
    return evaluator.with_targets(carry_noise(evaluator, GIVEN, np.random.default_rng(0)))


def fits_of(evaluator, model=RINGING):
    base = fit(evaluator, GIVEN, ())
    return base, fit(evaluator, model, effect_unknowns(model, places=False), precise=True)


def session_of(evaluator):
    return Session(evaluator, evaluator, [], EFFECTS, lambda _: None, 0)


def test_the_noise_is_that_which_the_right_model_carries(heard):
    session, (base, found) = session_of(heard), fits_of(heard)
    assert is_faint(heard, found)

    (_, again), ((row,),) = carried_by_best(session, [base, found], [[Ranked.of(found)]])

    assert again.ratio == pytest.approx(1.0, abs=0.03)
    assert row.fit.ratio == pytest.approx(1.0, abs=0.03)
    assert session.fitting.nrmse_of_noise > 1.1 * heard.nrmse_of_noise
    assert "as modal_damping carries it" in session.decisions[-1]
    assert louder_by(session, base, again) is None  # nothing is left to be noise


def test_what_a_model_carries_is_found_once_for_the_same_records(heard):
    session = session_of(heard)
    first = session.carried_by(RINGING)

    assert session.carried_by(RINGING) is first
    given = session.carried_by(GIVEN)
    assert given is not first
    session.everything = first
    assert session.carried_by(GIVEN) is not given


def test_what_has_not_explained_the_rest_excuses_nothing(heard):
    session, (base, found) = session_of(heard), fits_of(heard)
    imitation = fit(heard, GIVEN.with_effects(PointMass(Place(position=0.7), mass=0.05)), ())

    assert louder_by(session, base, imitation) is None
    assert louder_by(session, found, found) is None
    assert carried_by_best(session, [base, imitation], [[]]) == ([base, imitation], [[]])
    assert session.decisions == []


DULL = GIVEN.with_effects(ModalDamping(Place(), ratio=5.0))


@pytest.mark.parametrize(("given", "true", "lower"), [(RINGING, DULL, True), (DULL, DULL, False)])
def test_the_floor_of_the_model_that_was_found_holds_the_noise_as_it_carries_it(given, true, lower):
    """A rig that is damped more than its file says moves less at a noisy force."""
    evaluator = evaluator_of(measured(true, multisine(8192, rms=4.0), force_noise=0.05), rig=GIVEN.rig)
    evaluator = evaluator.with_targets(carry_noise(evaluator, given, np.random.default_rng(0)))
    session = session_of(evaluator)
    stage = session.stage("+ modal_damping", true)

    now = on_its_noise(session, stage)

    assert (now is not stage) == lower
    assert now.score.nrmse == stage.score.nrmse
    assert now.score.noise_nrmse == pytest.approx(now.score.nrmse, rel=0.15)
    assert bool(session.decisions) == lower


LOOSE = Hypothesis(REFERENCE.model_copy(update={"sleeves": (), "tolerances": {"rayleigh_damping": 0.8}}))
"""A rig of which the owner hardly knows the damping."""

RINGS_LONGER = {parameter.path: 0.25 * parameter.value for parameter in LOOSE.rig.parameters()}
"""Within its tolerance."""


def calibrated(*effects):
    """A session on the noise as the given rig carries it, half of that of the true one; its rig's numbers, fitted."""
    truth = Hypothesis(LOOSE.rig, RINGS_LONGER, effects=effects)
    evaluator = evaluator_of(measured(truth, multisine(8192, rms=4.0), force_noise=0.2), rig=LOOSE.rig)
    evaluator = evaluator.with_targets(carry_noise(evaluator, LOOSE, np.random.default_rng(0)))
    return session_of(evaluator), fit(evaluator, LOOSE, rig_unknowns(LOOSE.rig), precise=True)


def test_what_a_calibrated_model_leaves_may_be_the_forces_noise_as_it_carries_it():
    session, found = calibrated()
    given = session.fitting.nrmse_of_noise
    assert found.ratio > NOISE_REACHED

    again = excused(session, found)

    assert again.ratio < NOISE_REACHED
    assert session.fitting.nrmse_of_noise > 1.5 * given
    assert "as the calibrated model carries it" in session.decisions[-1]
    assert excused(session, again) is again


def test_a_calibrated_model_that_lacks_an_effect_is_not_excused():
    session, found = calibrated(PointMass(Place(position=0.7), mass=0.02))
    before = session.fitting

    assert excused(session, found) is found

    assert session.fitting is before
    assert session.decisions == []


def test_a_model_whose_numbers_left_their_tolerances_is_not_excused(monkeypatch):
    session, found = calibrated()
    monkeypatch.setattr(Session, "left_tolerance", lambda *_: True)
    before = session.everything, session.fitting

    assert excused(session, found) is found

    assert (session.everything, session.fitting) == before


def test_a_model_that_runs_away_excuses_nothing(monkeypatch):
    session, found = calibrated()

    def lost(*_):
        raise ArithmeticError

    monkeypatch.setattr("identification.carried.carry_noise", lost)
    assert excused(session, found) is found
