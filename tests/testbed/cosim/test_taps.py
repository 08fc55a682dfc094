"""Taps in equal times, and that they leave contacts as they are."""

import numpy as np
import pytest
from cosim_scenes import REFERENCE, with_sleeves

from models.plant import build_plant
from models.record import Record
from models.simulate import Settings, simulate
from testbed.cosim.taps import BILATERAL_PEAK, REHEARSED, SHARE, Taps, rehearse

FS = 2048.0
TAPS = Taps(period=0.2, width=4e-3, peak=1.0)


def test_each_tap_has_its_impulse():
    force = TAPS.force(FS, 0, round(2.0 * FS))
    # A half sine has 2 / pi of peak times width; eight samples of it sum to that within 1 %.
    assert force.sum() / FS == pytest.approx(10 * 2.0 / np.pi * 4e-3, rel=0.01)
    assert force.max() <= 1.0
    starts = np.flatnonzero((force[1:] > 0.0) & (force[:-1] == 0.0)) / FS
    np.testing.assert_allclose(starts, 0.1 + 0.2 * np.arange(10), atol=1.0 / FS)


def test_pieces_joined_are_the_whole_and_nothing_acts_before_the_first():
    whole = TAPS.force(FS, 0, 1000)
    np.testing.assert_array_equal(np.hstack([TAPS.force(FS, i, 100) for i in range(0, 1000, 100)]), whole)
    assert not TAPS.force(FS, -500, 500).any()


def moved(rig, taps):
    """The trace and the rest of a rig under taps."""
    plant, n = build_plant(rig), round(REHEARSED * taps.period * FS)
    names = tuple(sensor.name for sensor in plant.sensors)
    record = Record("taps", FS, taps.force(FS, 0, n), names, np.zeros((len(names), n)))
    done = simulate(plant, record, Settings(trace=True))
    return done, plant


def test_no_contact_opens_or_closes_and_one_comes_as_near_to_it_as_allowed():
    rehearsal = rehearse(build_plant(REFERENCE), TAPS, FS)
    done, plant = moved(REFERENCE, Taps(TAPS.period, TAPS.width, rehearsal.peak))
    rest, trace = done.model.rest, done.trace
    held = np.abs(rest.contact_forces[1])
    change = np.abs(trace.contact_forces[1] - rest.contact_forces[1]).max() / held
    port = next(i for i, p in enumerate(trace.ports) if p.position == plant.contacts[0].position)
    way = np.abs(trace.q[port] - rest.position[port]).max() / -rest.penetration[0]
    # The rehearsal's rig is linear: what a thousandth of a newton does is what the taps do, to rounding of the stepper.
    assert max(change, way) == pytest.approx(SHARE, rel=1e-4)
    assert not trace.contact_forces[0].any()


def test_the_channels_level_is_that_of_the_taps():
    rehearsal = rehearse(build_plant(REFERENCE), TAPS, FS)
    done, _ = moved(REFERENCE, Taps(TAPS.period, TAPS.width, rehearsal.peak))
    # All are accelerometers, so that one level holds for all.
    np.testing.assert_allclose(rehearsal.rms, np.sqrt(np.mean(done.channels**2)), rtol=1e-4)


def test_sleeves_without_clearance_bear_any_tap():
    assert rehearse(build_plant(with_sleeves(clearance=0.0)), TAPS, FS).peak == BILATERAL_PEAK
