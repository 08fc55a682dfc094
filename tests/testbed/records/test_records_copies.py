"""Copies of a test are known by what they read, and other tests are none."""

from dataclasses import replace

import numpy as np
import pytest
from a_rig_and_its_records import a_record, noise

from models.record import FrfRecord, ModeShapeRecord
from testbed.records.copies import is_same_test

RECORD = a_record()
FRFS = FrfRecord("h.uff", np.arange(1.0, 41.0), ("P1", "P2"), noise(3, 40, 2) + 1j * noise(4, 40, 2))
MODES = ModeShapeRecord("m.uff", ("P1", "P2"), np.array([9.0, 30.0, 80.0]), None, noise(5, 2, 3) + 0j)


@pytest.mark.parametrize(
    "copy",
    [
        replace(RECORD, name="b", excitation=None),
        replace(RECORD, responses=RECORD.responses.round(5)),
        replace(RECORD, responses=RECORD.responses[:, :500], excitation=None),
        replace(RECORD, sensors=("P4", "P2"), responses=RECORD.responses[[3, 1]]),
        replace(RECORD, fs=1.0001 * RECORD.fs),
    ],
    ids=["another excitation", "printed with five digits", "cut short", "fewer sensors", "rate with few digits"],
)
def test_copies_are_the_same_test(copy):
    assert is_same_test(RECORD, copy)
    assert is_same_test(copy, RECORD)


@pytest.mark.parametrize(
    "other",
    [
        replace(RECORD, responses=RECORD.responses + 1e-3 * noise(7, 600, 4)),
        replace(RECORD, responses=RECORD.responses[:, ::-1]),
        replace(RECORD, responses=2.0 * RECORD.responses),
        replace(RECORD, fs=2.0 * RECORD.fs),
        replace(RECORD, sensors=("Q1", "Q2", "Q3", "Q4")),
        FRFS,
        MODES,
    ],
    ids=["noise of 60 dB", "backwards", "louder", "another rate", "no sensor shared", "FRFs", "mode shapes"],
)
def test_other_tests_are_not(other):
    assert not is_same_test(RECORD, other)
    assert not is_same_test(other, RECORD)


def test_frfs_and_mode_shapes_are_compared_as_well():
    assert is_same_test(FRFS, replace(FRFS, name="copy.csv", coherence=np.ones((2, 40))))
    assert not is_same_test(FRFS, replace(FRFS, values=1.01 * FRFS.values))
    assert not is_same_test(FRFS, replace(FRFS, frequency=FRFS.frequency + 0.5))
    assert is_same_test(MODES, replace(MODES, name="copy.uff"))
    assert not is_same_test(MODES, replace(MODES, shapes=1.01 * MODES.shapes))
    assert not is_same_test(MODES, replace(MODES, natural_freqs=MODES.natural_freqs[:2], shapes=MODES.shapes[:2]))
    assert not is_same_test(MODES, replace(MODES, natural_freqs=1.01 * MODES.natural_freqs))
