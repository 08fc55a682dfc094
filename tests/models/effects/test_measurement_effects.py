"""Effects in the measurement chain, which leave the rig alone."""

from dataclasses import replace

import numpy as np
import pytest
from effect_scenes import BEAM, scene_at

from models.effects import Place
from models.effects.force_gain import ForceGain
from models.effects.protocol import Measurement
from models.effects.sensor_gain import SensorGain
from models.effects.sensor_swap import SensorSwap
from models.errors import NotComputableError
from models.linear import frf, linearised
from models.modal import build_modal
from models.plant import build_plant
from models.structure import Structure

MEASUREMENT = Measurement(("tip", "mid"), 1000.0, {})
CHANNELS = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])


def test_one_channel_reads_gain_times_the_truth():
    read = SensorGain(Place(sensor="mid"), gain=-0.5).change_channels(CHANNELS, MEASUREMENT)
    np.testing.assert_array_equal(read, [[1.0, 2.0, 3.0], [-2.0, -2.5, -3.0]])
    assert CHANNELS[1, 0] == 4.0


def test_a_record_without_that_channel_is_as_it_was():
    gain = SensorGain(Place(sensor="far"), gain=2.0)
    np.testing.assert_array_equal(gain.change_channels(CHANNELS, MEASUREMENT), CHANNELS)


def test_an_inverted_sensor_twice_is_the_truth():
    flip = SensorGain(Place(sensor="tip"), gain=-1.0)
    twice = flip.change_channels(flip.change_channels(CHANNELS, MEASUREMENT), MEASUREMENT)
    np.testing.assert_array_equal(twice, CHANNELS)
    assert "upside down" in flip.in_words()


@pytest.mark.parametrize("place", [Place(sensor="tip", other="mid"), Place(sensor="mid", other="tip")])
def test_two_sensors_are_exchanged_and_twice_is_the_truth(place):
    swap, structure = SensorSwap(place), Structure.of(BEAM.structure)
    once = swap.change_sensors(BEAM.sensors, structure)
    assert [(sensor.name, sensor.position) for sensor in once] == [("tip", 0.7), ("mid", 1.5)]
    assert swap.change_sensors(once, structure) == BEAM.sensors


def test_exchanged_sensors_show_in_the_frf_and_in_a_record_without_the_other():
    swapped = build_plant(BEAM, extra=(SensorSwap(Place(sensor="tip", other="mid")),))
    frequency, both = np.linspace(5.0, 60.0, 12), ("tip", "mid")
    plain, changed = (frf(linearised(build_modal(p, 100.0)), frequency, both) for p in (build_plant(BEAM), swapped))
    np.testing.assert_allclose(changed, plain[::-1])
    np.testing.assert_allclose(frf(linearised(build_modal(swapped, 100.0)), frequency, ("tip",))[0], plain[1])


def test_the_true_force_is_what_the_channel_reads_over_the_gain():
    np.testing.assert_allclose(ForceGain(Place(), gain=1.25).change_excitation(CHANNELS[0]), [0.8, 1.6, 2.4])
    np.testing.assert_array_equal(ForceGain(Place(), gain=1.0).change_excitation(CHANNELS[0]), CHANNELS[0])


def test_a_force_in_another_unit_is_tried_as_large_as_the_channels_ask_for_whichever_its_sign():
    near, far = (
        [trial.gain for trial in ForceGain.trials(replace(scene_at(Place()), loudness=loudness))]
        for loudness in (1.2, 9.81)
    )
    assert near == [0.8, 0.95, 1.05, 1.25, -1.0]
    assert far == [*near, -1.0 / 9.81, 1.0 / 9.81]


def test_a_gain_of_nothing_tells_of_no_force():
    with pytest.raises(NotComputableError, match="gain = 0"):
        ForceGain(Place(), gain=0.0).change_excitation(CHANNELS[0])


def test_a_driven_base_has_no_force_channel_to_try():
    assert not list(ForceGain.trials(scene_at(Place(), driven_base=True)))


@pytest.mark.parametrize("effect", [SensorGain(Place(sensor="mid"), gain=2.0), ForceGain(Place(), gain=2.0)])
def test_the_rig_is_left_alone(effect):
    plain, changed = build_plant(BEAM), build_plant(BEAM, extra=(effect,))
    for part in ("structure", "contacts", "laws", "sensors"):
        assert getattr(plain, part) == getattr(changed, part)
