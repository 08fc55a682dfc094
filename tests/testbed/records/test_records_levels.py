"""Each channel by the unit it was read in, and its level in SI."""

import numpy as np
import pytest
from a_rig_and_its_records import a_rig, csv_lines, sensors

from testbed.records.formats import read_file
from testbed.records.levels import levels_of


@pytest.fixture
def columns(tmp_path):
    """A record of labels of all sorts, and its numbers as they stand in the file."""
    path = tmp_path / "run.csv"
    lines = csv_lines(units=("kN", "g", "mV", "m/s^2", "m/s^2"))
    path.write_text("\n".join([lines[0].replace("P3 [m/s^2]", "P3"), *lines[1:]]) + "\n")
    return read_file(path), np.loadtxt(lines[1:], delimiter=",")[:, 1:]


def test_labels_factors_and_levels(columns):
    recording, numbers = columns
    levels = levels_of(recording, a_rig(sensors=sensors(sensitivity="10 mV/g")))
    assert [(level.channel, level.label, level.unit) for level in levels] == [
        ("shaker", "kN", "N"),
        ("P1", "g", "m/s^2"),
        ("P2", "mV", "m/s^2"),
        ("P3", None, "m/s^2"),
        ("P4", "m/s^2", "m/s^2"),
    ]
    factors = np.array([1e3, 9.80665, 0.980665, 0.980665, 1.0])
    np.testing.assert_allclose([level.factor for level in levels], factors)
    np.testing.assert_allclose([level.rms for level in levels], factors * np.sqrt(np.mean(numbers**2, axis=0)))
    np.testing.assert_allclose([level.peak for level in levels], factors * np.abs(numbers).max(axis=0))


def test_channels_that_are_left_out_have_no_level(columns):
    rig = a_rig(sensors=sensors(sensitivity="10 mV/g"))
    assert [level.channel for level in levels_of(columns[0], rig, ("shaker", "P2"))] == ["P1", "P3", "P4"]
