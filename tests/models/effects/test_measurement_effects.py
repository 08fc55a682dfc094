"""Effects in the measurement chain, which leave the rig alone."""

import numpy as np
import pytest
from effect_scenes import BEAM, scene_at

from models.effects import Place
from models.effects.force_gain import ForceGain
from models.effects.protocol import Measurement
from models.effects.sensor_gain import SensorGain
from models.effects.sensor_swap import SensorSwap
from models.plant import build_plant

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
def test_two_sensors_exchange_their_channels_and_twice_is_the_truth(place):
    swap = SensorSwap(place)
    once = swap.change_channels(CHANNELS, MEASUREMENT)
    np.testing.assert_array_equal(once, CHANNELS[::-1])
    np.testing.assert_array_equal(swap.change_channels(once, MEASUREMENT), CHANNELS)


def test_a_record_with_one_of_two_exchanged_sensors_is_as_it_was():
    swap = SensorSwap(Place(sensor="tip", other="far"))
    np.testing.assert_array_equal(swap.change_channels(CHANNELS, MEASUREMENT), CHANNELS)


def test_the_true_force_is_what_the_channel_reads_over_the_gain():
    np.testing.assert_allclose(ForceGain(Place(), gain=1.25).change_excitation(CHANNELS[0]), [0.8, 1.6, 2.4])
    np.testing.assert_array_equal(ForceGain(Place(), gain=1.0).change_excitation(CHANNELS[0]), CHANNELS[0])


def test_a_driven_base_has_no_force_channel_to_try():
    assert not list(ForceGain.trials(scene_at(Place(), driven_base=True)))


@pytest.mark.parametrize("effect", [SensorGain(Place(sensor="mid"), gain=2.0), ForceGain(Place(), gain=2.0)])
def test_the_rig_is_left_alone(effect):
    plain, changed = build_plant(BEAM), build_plant(BEAM, extra=(effect,))
    for part in ("structure", "contacts", "laws", "sensors"):
        assert getattr(plain, part) == getattr(changed, part)
