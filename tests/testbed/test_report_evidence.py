"""What speaks for a verdict: the channel, the lines, the course or the place that shows it, and the rival that lost."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_diagnosis import FILM, FRICTION, made_up_diagnosis

from identification.assess import score
from identification.hypothesis import Hypothesis
from identification.locating.located import Located
from identification.prepare import prepare
from identification.result import AddedEffect, Candidate, Stage
from models.effects import Place
from models.effects.force_gain import ForceGain
from models.effects.mains_hum import MainsHum
from models.effects.modal_damping import ModalDamping
from models.effects.sensor_delay import SensorDelay
from models.effects.sensor_gain import SensorGain
from testbed.report.evidence import because, beside, channel_ratios, evidence_picture, left_picture
from testbed.report.picture import Picture
from tests.identification.trial_records import REFERENCE, measured, multisine

RIG = REFERENCE.model_copy(update={"sensors": REFERENCE.sensors[2:5]})
BUILT = Hypothesis(RIG)
P4 = Place(sensor="P4")
LATE = SensorDelay(P4, delay=3e-4)
PLACE = Picture("data:,", "Place of the missing force", "")


def found(effect, verdict="missing_effect"):
    """A diagnosis that knows the rig as built and names the effect that is there."""
    truth = BUILT.with_effects(effect)
    record, _ = measured(truth, multisine(4096, rms=2.0, low=10.0), name="multisine")
    evaluator = prepare(BUILT, [record], 1, np.random.default_rng(0))
    models = {"as given": BUILT, "calibrated": BUILT, f"+ {effect.label()}": truth}
    stages = tuple(Stage(label, model, score(evaluator, model)) for label, model in models.items())
    made_up = made_up_diagnosis(RIG, record, verdict)
    return replace(made_up, stages=stages, added=(AddedEffect(effect, 0.97, ()),), candidates=(), indistinguishable=())


def located(interval):
    """One force at sleeve 2 or elsewhere explains it."""
    none = np.zeros(0)
    return Located(none, none, (), 5.0, 1.0, sum(interval) / 2.0, interval, None, None, 0.99, True, "", (), None)


@pytest.fixture(scope="module")
def late():
    return found(LATE)


def ratios_of(diagnosis):
    row = diagnosis.calibrated.score.records[0]
    frequency, ratios = channel_ratios(row)
    i = row.record.sensors.index("P4")
    return frequency, ratios[i], np.delete(ratios, i, axis=0)


def test_a_late_channel_is_behind_the_model_in_proportion_to_frequency(late):
    frequency, own, others = ratios_of(late)

    heard = ~np.isnan(own)
    assert heard.sum() > 20
    assert np.median(np.abs(np.angle(own[heard]) + 2.0 * np.pi * frequency[heard] * LATE.delay)) < 0.01
    assert np.nanmedian(np.abs(own)) == pytest.approx(1.0, abs=0.01)
    assert np.nanmedian(np.abs(others - 1.0)) < 0.01


def test_a_weak_channel_stands_at_its_gain():
    _, own, others = ratios_of(found(SensorGain(P4, gain=-0.8)))

    assert np.nanmedian(own.real) == pytest.approx(-0.8, abs=0.01)
    assert np.nanmedian(np.abs(others - 1.0)) < 0.01


def test_bands_in_which_nothing_moves_say_nothing():
    row = found(SensorGain(P4, gain=0.8)).calibrated.score.records[0]
    silent = row.predicted.copy()
    silent[0] = 0.0

    _, ratios = channel_ratios(replace(row, predicted=silent))

    assert np.isnan(ratios[0]).all()
    assert not np.isnan(ratios[1]).all()


@pytest.mark.parametrize(
    ("effect", "shown"),
    [
        (LATE, "Measured over calibrated model, P4"),
        (ForceGain(Place(), gain=1.1), "Measured over calibrated model, every channel"),
        (MainsHum(Place(), frequency=50.0, amplitude=0.3), "What the models leave of"),
        (ModalDamping(Place(), ratio=2.0), "What the models leave of"),
        (FILM, "What the models leave of"),
    ],
    ids=lambda each: getattr(each, "kind", ""),
)
def test_the_picture_is_of_where_the_effect_shows(effect, shown):
    drawn = evidence_picture(replace(found(effect), located=located((0.4, 0.6))), RIG, PLACE)

    assert drawn.alt.startswith(shown)


def test_the_place_speaks_for_what_sits_there_and_only_for_that():
    at_sleeve = found(FILM)

    assert evidence_picture(replace(at_sleeve, located=located((0.9, 1.1))), RIG, PLACE) is PLACE
    assert evidence_picture(at_sleeve, RIG, None) is None


def test_a_complete_model_is_shown_at_its_noise_and_an_unexplained_force_at_its_place(late):
    without = replace(late, stages=late.stages[:2], added=())

    assert evidence_picture(replace(without, verdict="complete"), RIG, PLACE).alt.startswith("What the models leave")
    assert evidence_picture(replace(without, verdict="unexplained"), RIG, PLACE) is PLACE


def test_what_is_left_is_shown_of_the_channel_that_the_effect_mends(late):
    assert left_picture(late, RIG).alt == "What the models leave of P4 in multisine"


def test_the_rival_that_lost_is_named_with_what_it_leaves():
    diagnosis = made_up_diagnosis(RIG)

    words = because(diagnosis)

    assert FILM.signature.place in words
    assert "misses 0.71 %" in words
    assert f"{FRICTION.label()}, misses 5.0 % and stands 9 behind in log evidence, decisively" in words


def test_what_the_candidates_were_judged_beside_is_told():
    """Where a second effect was added, the first round is judged again beside it, and its errors are of both."""
    diagnosis = made_up_diagnosis(RIG)
    both = replace(diagnosis, candidates_beside=(SensorGain(P4, gain=0.8),))

    assert (beside(diagnosis), beside(both)) == ("", "sensor_gain on P4")
    assert f"With {FILM.label()} beside sensor_gain on P4 the model misses 0.71 %" in because(both)
    assert f"With {FILM.label()} the model misses 0.71 %" in because(diagnosis)


def test_the_signature_of_the_kind_is_no_evidence_unless_the_records_show_the_place():
    diagnosis = made_up_diagnosis(RIG)

    assert because(diagnosis).startswith(f"What gives {FILM.kind} away in general: ")
    assert "Whether these records show its place was not judged" in because(diagnosis)
    here = replace(diagnosis, located=replace(located((0.99, 1.01)), place=1.0))
    assert "these records show the place: without assuming a law they put the missing force at 0.99 to" in because(here)
    away = replace(diagnosis, located=located((0.4, 0.6)))
    assert "These records do not show it by place" in because(away)


def test_a_rival_of_its_own_group_is_no_rival():
    diagnosis = made_up_diagnosis(RIG)
    third = Candidate(SensorGain(P4, gain=0.8), 0.0, 0.2, -3.0, refitted=False)
    grouped = replace(diagnosis, candidates=(*diagnosis.candidates, third), indistinguishable=((FILM, FRICTION),))

    words = because(grouped)

    assert "sensor_gain on P4, misses at most 20 % and stands 3 behind in log evidence, not decisively" in words
    assert FRICTION.label() not in words


def test_the_rival_is_one_that_was_refitted_where_there_is_one():
    """The beginning of a sweep, where little moves, says less against a suspect than whole records would."""
    diagnosis = made_up_diagnosis(RIG)
    screened = Candidate(SensorGain(P4, gain=0.8), 0.0, 0.2, -1.0, refitted=False)

    words = because(replace(diagnosis, candidates=(*diagnosis.candidates, screened)))

    assert f"the next best, {FRICTION.label()}, misses 5.0 %" in words


def test_the_best_that_was_not_enough_is_named():
    words = because(made_up_diagnosis(RIG, verdict="unexplained"))

    assert words.startswith(f"Of 2 suspects the best, {FILM.label()}, would miss 0.71 %")
    assert because(replace(made_up_diagnosis(RIG), candidates=())) == ""
