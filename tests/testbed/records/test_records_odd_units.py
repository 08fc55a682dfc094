"""One label that is not its neighbours': told where the level says that it is wrong, and nowhere else."""

import numpy as np
import pytest
from a_rig_and_its_records import a_rig, csv_lines, noise, sensors

from models.beam.clamped_free import clamped_free_modes
from testbed.records.odd_units import odd_units
from testbed.records.read import read_record
from testbed.records.recording import Tag

G = 9.80665
NAMES = ("P1", "P2", "P3", "P4")


def shaken(rig, n_modes=5):
    """(N,) of each sensor in modes that are equally loud, SI."""
    x = np.array([sensor.position for sensor in rig.sensors]) / rig.structure.length
    channels = clamped_free_modes(x, n_modes) @ noise(1, channels=n_modes)
    return {sensor.name: channel for sensor, channel in zip(rig.sensors, channels, strict=True)}


def tags(**units):
    return {name: Tag(name, unit=units.get(name, "m/s^2")) for name in NAMES}


@pytest.mark.parametrize("name", NAMES)
def test_a_label_in_g_over_numbers_in_si_is_told_wherever_the_sensor_is(name):
    responses = shaken(a_rig())
    (told,) = odd_units({**responses, name: G * responses[name]}, tags(**{name: "g"}), a_rig())
    assert told.startswith(f'channel {name} is in "g", most others of its quantity in "m/s^2", and its rms is ')
    assert told.endswith(f'correct the label of {name} if it is in "m/s^2" too')


@pytest.mark.parametrize("n_modes", [1, 2, 5])
@pytest.mark.parametrize("name", NAMES)
def test_a_right_label_among_others_is_fine(name, n_modes):
    assert odd_units(shaken(a_rig(), n_modes), tags(**{name: "g"}), a_rig()) == []


def test_a_label_in_si_over_numbers_in_g_is_told():
    responses = shaken(a_rig())
    labels = {name: Tag(name, unit="m/s^2" if name == "P3" else "g") for name in NAMES}
    (told,) = odd_units({**responses, "P3": responses["P3"] / G}, labels, a_rig())
    assert told.startswith('channel P3 is in "m/s^2", most others of its quantity in "g"')


def test_nothing_is_said_where_no_unit_is_the_others():
    responses = shaken(a_rig())
    loud = {**responses, "P4": G * responses["P4"]}
    assert odd_units(loud, tags(P4="g", P3="g"), a_rig()) == []
    assert odd_units({name: loud[name] for name in ("P3", "P4")}, tags(P4="g"), a_rig()) == []


def test_volts_and_channels_without_unit_are_not_weighed():
    rig = a_rig(sensors=sensors(sensitivity="100 mV/g"))
    responses = shaken(rig)
    assert odd_units({**responses, "P4": G * responses["P4"]}, tags(P4="mV"), rig) == []
    assert odd_units({**responses, "P4": G * responses["P4"]}, {**tags(), "P4": Tag("P4")}, rig) == []


def test_the_reader_tells_it(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("\n".join(csv_lines(units=("N", "m/s^2", "m/s^2", "g", "m/s^2"))) + "\n")
    assert [told.startswith('run.csv: channel P3 is in "g"') for told in read_record(path, a_rig()).findings] == [True]
