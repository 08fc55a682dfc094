import numpy as np
import pytest
from a_rig_and_its_records import a_rig, noise

from models.beam.clamped_free import clamped_free_modes
from testbed.records.plausibility import find_faults, own_zeros, white_rms

LENGTH = 1.469
N = 4096


def placed(*positions, quantity="acceleration"):
    return a_rig(
        sensors=[{"name": f"S{i}", "position": x, "quantity": quantity} for i, x in enumerate(positions)],
    )


def in_mode(rig, mode, derivative=0, noise_level=0.0):
    """All sensors in one mode alone: the worst that a healthy record can be."""
    x = np.array([sensor.position for sensor in rig.sensors]) / LENGTH
    shape = clamped_free_modes(x, mode, derivative)[:, mode - 1]
    smooth = np.convolve(noise(1, N), np.hanning(40), mode="same")
    channels = shape[:, None] * smooth + noise_level * noise(2, N, len(x))
    return {sensor.name: channel for sensor, channel in zip(rig.sensors, channels, strict=True)}


def faults(rig, responses):
    return find_faults(responses, rig, tuple(sensor.name for sensor in rig.sensors))


@pytest.mark.parametrize("mode", [1, 2, 3, 4])
@pytest.mark.parametrize("nearest", [0.01, 0.03, 0.1])
def test_a_sensor_near_the_clamp_is_no_fault(mode, nearest):
    rig = placed(nearest * LENGTH, 0.3 * LENGTH, 0.5 * LENGTH, 0.7 * LENGTH, LENGTH)
    assert faults(rig, in_mode(rig, mode)) == []


def test_a_sensor_at_the_tip_among_others_near_the_clamp_is_no_fault():
    rig = placed(*(share * LENGTH for share in (0.05, 0.08, 0.1, 1.0)))
    assert faults(rig, in_mode(rig, 1)) == []


@pytest.mark.parametrize(("mode", "node"), [(2, 0.7834), (3, 0.5035), (3, 0.8677)])
def test_a_sensor_on_the_node_of_the_only_mode_is_no_fault(mode, node):
    # Placed to the nearest millimetre, as sensors are.
    rig = placed(0.2 * LENGTH, 0.4 * LENGTH, round(node * LENGTH, 3) + 0.001, LENGTH)
    assert faults(rig, in_mode(rig, mode)) == []


@pytest.mark.parametrize("nearest", [0.05, 0.2])
def test_a_gyroscope_near_the_clamp_is_no_fault(nearest):
    rig = placed(nearest * LENGTH, 0.3 * LENGTH, 0.7 * LENGTH, LENGTH, quantity="angular_velocity")
    assert faults(rig, in_mode(rig, 1, derivative=1)) == []


@pytest.mark.parametrize("factor", [1000.0, 100.0, 1e-3])
def test_a_unit_off_by_a_thousand_is_a_fault(factor):
    rig = placed(0.3, 0.6, 0.9, 1.2)
    responses = in_mode(rig, 1)
    responses["S1"] = factor * responses["S1"]
    found = faults(rig, responses)
    assert [fault.sensors for fault in found] == [("S1",)]
    assert "channel S1 is implausible" in found[0].reason


def test_an_unplugged_sensor_that_hears_noise_alone_is_a_fault():
    rig = placed(0.3, 0.6, 0.9, 1.2)
    responses = in_mode(rig, 1, noise_level=0.01)
    responses["S2"] = 0.01 * noise(9, N)
    assert [fault.sensors for fault in faults(rig, responses)] == [("S2",)]


def test_of_two_sensors_nobody_knows_which_is_wrong():
    rig = placed(0.6, 1.2)
    responses = in_mode(rig, 1)
    responses["S1"] = 1e4 * responses["S1"]
    assert faults(rig, responses) == []


def test_different_quantities_are_not_compared():
    rig = a_rig(
        sensors=[
            {"name": f"S{i}", "position": 0.3 + 0.2 * i, "quantity": quantity}
            for i, quantity in enumerate(["acceleration"] * 3 + ["displacement"] * 3)
        ]
    )
    responses = {f"S{i}": (1.0 if i < 3 else 1e-6) * noise(i, N) for i in range(6)}
    assert faults(rig, responses) == []


@pytest.mark.parametrize(("quantity", "told"), [("acceleration", True), ("displacement", False)])
def test_what_an_accelerometer_reads_at_rest_is_told(quantity, told):
    rig = placed(0.3, 0.9, quantity=quantity)
    responses = in_mode(rig, 1)
    assert own_zeros(responses, rig) == []

    responses["S1"] = responses["S1"] + 9.81

    mean = responses["S1"].mean()
    words = f"the mean of S1 ({mean:.3g} m/s^2) is taken for the sensor's own zero, or gravity's share, and not judged"
    assert own_zeros(responses, rig) == ([words] if told else [])


def test_white_noise_is_measured_in_the_stopped_band():
    smooth = np.convolve(noise(1, N), np.hanning(40), mode="same")
    assert white_rms(smooth + 0.05 * noise(2, N)) == pytest.approx(0.05, rel=0.1)
