"""A diagnosis fits on a part of the records, and on everything where the part hides what is missing."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from trial_records import OSCILLATOR, REFERENCE, evaluator_of, measured, multisine, rising_session

from identification.evaluate import carry_noise
from identification.fit import fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.prepare import Horizon, cut_to
from identification.reached import reaches_noise
from identification.session import LENGTHENED, Session
from models.effects import EFFECTS, Place
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.end_stop import EndStop
from models.effects.time_varying_damping import TimeVaryingDamping


def test_what_only_the_end_of_a_record_shows_makes_the_whole_of_it_count():
    truth = Hypothesis(OSCILLATOR, effects=(CubicStiffness(Place(), stiffness=2e10),))
    session, part = rising_session(truth, 1.0)
    assert part.ratio < 1.15

    assert session.lengthen(part)

    assert session.fitting.n_data == session.all_predicted.n_data > 3 * part.n_data
    assert "are explained, all 4.0 s of records not" in session.decisions[-1]


def test_a_part_is_enough_where_the_whole_is_explained_too():
    session, part = rising_session(Hypothesis(OSCILLATOR), 1.0)

    assert not session.lengthen(part)

    assert session.fitting.n_data == part.n_data
    assert session.decisions == []


def shaken_session():
    """A session on a force with much noise, none of which is carried through a model, and the same with it."""
    session, part = rising_session(Hypothesis(OSCILLATOR), 1.0, force_noise=0.1)
    ended = session.to_the_end(part).hypothesis
    carried = carry_noise(session.everything, ended, np.random.default_rng(session.seed))
    return session, part, session.everything.with_targets(carried)


def test_the_noise_that_the_model_itself_carries_makes_no_record_count():
    session, part, loud = shaken_session()
    opened = Session(loud, session.fitting, session.limits, EFFECTS, lambda _: None, 0)
    opened.everything = session.everything  # what another model carried was next to nothing

    assert not opened.lengthen(part)

    assert opened.fitting is session.fitting
    assert "the force's noise, as this model carries it" in opened.decisions[-1]
    assert opened.everything.nrmse_of_noise == pytest.approx(loud.nrmse_of_noise, rel=0.1)
    assert reaches_noise(opened.all_predicted, opened.to_the_end(part))


def test_what_rigs_within_the_tolerances_carry_is_excused_where_the_given_one_carries_less():
    session, part, loud = shaken_session()  # as if the given one carried none

    assert not session.lengthen(part)

    assert session.everything.nrmse_of_noise == pytest.approx(loud.nrmse_of_noise, rel=0.1)
    assert reaches_noise(session.all_predicted, session.to_the_end(part))


def test_no_more_noise_is_excused_than_rigs_within_the_tolerances_carry(monkeypatch):
    session, part, loud = shaken_session()
    trembling, quiet = session.to_the_end(part).hypothesis, session.everything.targets
    monkeypatch.setattr(
        "identification.session.carry_noise", lambda _, model, *__: loud.targets if model is trembling else quiet
    )

    assert session.lengthen(part)

    assert session.fitting.n_data == session.all_predicted.n_data
    assert not reaches_noise(session.all_predicted, session.to_the_end(part))


def test_the_last_fit_is_made_once_for_the_same_records():
    session, part = rising_session(Hypothesis(OSCILLATOR), 1.0)

    first = session.to_the_end(part)

    assert session.to_the_end(part) is first
    assert first.ratio == pytest.approx(1.0, abs=0.1)
    session.everything = session.everything.with_targets(session.everything.targets)
    assert session.to_the_end(part) is not first


def test_a_record_is_used_as_far_as_the_model_that_explains_it_sees():
    parting = Hypothesis(OSCILLATOR, effects=(EndStop(Place(), stiffness=1e7, gap=1e-3),))
    session, part = rising_session(parting, 0.5)
    assert part.ratio < 1.15  # the stop is not reached yet
    assert session.not_followed == ""
    found = fit(session.fitting, parting, part.unknowns, max_iterations=0)

    ended = session.to_the_end(found)

    assert 0.5 < session.limits[0].seconds < 4.0
    assert ended.n_data < 0.9 * session.everything.n_data
    assert "neighbouring motions part" in session.decisions[-1]
    assert ended.ratio == pytest.approx(1.0, abs=0.1)
    assert f"{session.limits[0].seconds:.1f} of 4.0 s" in session.not_followed


COURSE = TimeVaryingDamping(
    Place(sleeve=REFERENCE.sleeves[-1].name), times=(0.0, 1.0, 2.0, 3.0, 4.0), values=(12.0, 17.0, 48.0, 1.2, 4.6)
)


def part_of_course(seconds, begin):
    """A session that has heard so many seconds of 4 s in which a sleeve's damping takes its course, and a table fitted
    to them."""
    everything = evaluator_of(measured(Hypothesis(REFERENCE, effects=(COURSE,)), multisine(8192, rms=5.0)))
    limits = [Horizon("test", 1.0, 4.0)]
    session = Session(everything, cut_to(everything, seconds, limits), limits, EFFECTS, lambda _: None, 0)
    begun = Hypothesis(REFERENCE, effects=(begin,))
    return session, fit(session.fitting, begun, (*rig_unknowns(REFERENCE), *effect_unknowns(begun)), precise=True)


def test_a_table_in_time_is_told_value_by_value():
    """Of five values the part that is fitted tells three, and the others begin far off."""
    session, part = part_of_course(1.6, replace(COURSE, values=(*COURSE.values[:3], 200.0, 200.0)))
    assert part.hypothesis.effects[0].values[3:] == (200.0, 200.0)

    ended = session.to_the_end(part)

    assert ended.ratio == pytest.approx(1.0, abs=0.05)
    assert ended.hypothesis.effects[0].values == pytest.approx(COURSE.values, rel=0.02)


@pytest.mark.study
def test_a_table_too_coarse_for_what_comes_later_gets_more_values():
    session, part = part_of_course(1.0, replace(COURSE, times=COURSE.times[::2], values=(12.0, 22.0, 0.03)))
    assert part.ratio == pytest.approx(1.0, abs=0.1)

    ended = session.to_the_end(part)

    assert ended.ratio == pytest.approx(1.0, abs=0.05)
    assert ended.hypothesis.effects[0].values == pytest.approx(COURSE.values, rel=0.02)


QUICK = 0.02
"""Share of these lengths by which one with a quick transform may be shorter."""


def test_beside_short_records_a_long_one_is_lengthened_no_faster(monkeypatch):
    """All of the seconds gained are the long record's: the short ones are heard to their ends."""
    truth = Hypothesis(REFERENCE, effects=(COURSE,))
    pairs = [measured(truth, multisine(n, rms=2.0), name=f"{n}") for n in (2048, 2048, 8192)]
    everything = evaluator_of(*pairs)
    limits = [Horizon(target.record.name, 1.0, target.record.duration) for target in everything.timed]
    session = Session(everything, cut_to(everything, 2.4, limits), limits, EFFECTS, lambda _: None, 0)
    heard = []

    def followed(evaluator, hypothesis, *_):
        heard.append(max(target.record.duration for target in evaluator.timed))
        return SimpleNamespace(hypothesis=hypothesis)

    monkeypatch.setattr("identification.session.fit_to_its_end", followed)

    session.told_later(truth)

    assert heard[0] == pytest.approx(LENGTHENED * 0.8, rel=QUICK)
    assert np.all(np.diff(np.log(heard)) < np.log(LENGTHENED) + QUICK)
    assert 4.0 / LENGTHENED < heard[-1] < 4.0


def test_numbers_that_the_forces_noise_pardons_are_asked_for_once_a_calibration(monkeypatch):
    truth = Hypothesis(OSCILLATOR.with_values({"stiffness": OSCILLATOR.structure.stiffness * np.exp(6 * 0.03)}))
    session, off = rising_session(truth, 1.0)
    found = replace(off, chi2=float(off.n_data))  # as if the noise were reached
    asked, told, out = [], [], []
    session.progress = told.append
    monkeypatch.setattr("identification.session.pushed_out", lambda *_: asked.append(1) or out)

    assert not session.left_tolerance(found)
    assert not session.left_tolerance(found)
    assert len(asked) == 1
    (words,) = told
    assert words == "mass, stiffness: no further out than the tolerance and the force's noise together put it here"

    out.append(found.unknowns[0])
    assert session.left_tolerance(replace(found, penalty=0.0))


def test_what_is_left_in_one_short_record_alone_is_not_the_noise():
    """All samples together hardly show it: most of them are of the other record."""
    truth = Hypothesis(OSCILLATOR, effects=(CubicStiffness(Place(), stiffness=2e10),))
    quiet = measured(truth, multisine(32768, rms=1.0), name="quiet")
    loud = measured(truth, multisine(512, rms=12.0), name="loud")
    evaluator = evaluator_of(quiet, loud)

    without = fit(evaluator, Hypothesis(OSCILLATOR), rig_unknowns(OSCILLATOR))
    right = fit(evaluator, truth, rig_unknowns(OSCILLATOR))

    assert without.ratio < 1.15
    assert reaches_noise(evaluator, right)
    assert not reaches_noise(evaluator, without)
