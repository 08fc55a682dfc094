"""One round of looking: what a channel at fault has bent is told by the others."""

from dataclasses import replace

import numpy as np
import pytest
from trial_records import REFERENCE, beam_session, evaluator_of, fit_of, measured, multisine

from identification.calibrate import calibrate
from identification.hypothesis import Hypothesis, coordinates, rig_unknowns
from identification.look import View
from identification.rounds import WORTH_MORE, _recalibrated, _unbent
from models.effects import EFFECTS, Place
from models.effects.sensor_delay import SensorDelay

LATE = SensorDelay(Place(sensor="P3"), delay=0.05)
KINDS = {kind: EFFECTS[kind] for kind in ("sensor_delay", "sensor_gain")}
RIG = REFERENCE


def viewed(effects, channels):
    evaluator = evaluator_of(measured(Hypothesis(RIG, effects=effects), multisine(4096, rms=20.0), noise=1e-3))
    base = calibrate(evaluator, Hypothesis(RIG), rig_unknowns(RIG))
    return View(evaluator, base, KINDS, tuple(Place(sensor=name) for name in channels)), base


def test_the_numbers_are_those_that_the_other_channels_tell():
    view, base = viewed((LATE,), ("P3",))
    bent = np.abs(coordinates(base.hypothesis, base.unknowns)).max()
    assert bent > 2.0

    told = _unbent(view, base)

    assert told.is_unbent
    assert np.abs(coordinates(told.there.hypothesis, base.unknowns)).max() < 0.5
    assert told.evaluator is view.evaluator
    assert told.there.n_data == view.there.n_data


@pytest.mark.parametrize(
    ("effects", "channels"),
    [((), ("P3",)), ((LATE,), ()), ((LATE,), ("P1",)), ((LATE,), tuple(s.name for s in RIG.sensors))],
)
def test_a_view_stays_where_nothing_is_bent_or_the_others_tell_no_model(effects, channels):
    view, base = viewed(effects, channels)
    assert _unbent(view, base) is view


@pytest.mark.parametrize(
    ("costs", "ends"),
    [
        ((WORTH_MORE + 0.01,), None),
        ((WORTH_MORE - 0.01, 0.99), None),
        ((WORTH_MORE - 0.01, 0.97, 0.96), 0.96),
    ],
    ids=["ends above", "comes to the same", "comes lower"],
)
def test_numbers_beside_an_effect_are_followed_only_as_long_as_they_promise_another_calibration(
    costs, ends, monkeypatch
):
    """A look, its end and the precise fit there, of which each takes longer than the one before."""
    bare = replace(fit_of(LATE, 1e6), hypothesis=Hypothesis(RIG), unknowns=rig_unknowns(RIG))
    begun = []

    def fitted(_, hypothesis, unknowns, **how):
        begun.append((hypothesis, how))
        return replace(bare, hypothesis=hypothesis, chi2=costs[len(begun) - 1] * bare.cost)

    monkeypatch.setattr("identification.rounds.fit", fitted)

    again = _recalibrated(beam_session(n=256), bare, fit_of(LATE, 1e3))

    assert len(begun) == len(costs)
    assert all(not hypothesis.effects for hypothesis, _ in begun)
    assert [how.get("precise", False) for _, how in begun] == [False, False, True][: len(costs)]
    assert again is None if ends is None else again.cost == ends * bare.cost


def test_beside_effects_that_are_held_nothing_is_calibrated_again():
    base = fit_of(LATE, 1e6)
    assert _recalibrated(beam_session(n=256), base, base) is None
