"""One round of looking: what a channel at fault has bent is told by the others."""

import numpy as np
import pytest
from trial_records import REFERENCE, evaluator_of, measured, multisine

from identification.calibrate import calibrate
from identification.hypothesis import Hypothesis, coordinates, rig_unknowns
from identification.look import View
from identification.rounds import _unbent
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
