"""Delay, displaced sensors, hum and a shaking floor: what they do to channels, and that the rig is left alone."""

from math import pi

import numpy as np
import pytest
from effect_scenes import BEAM, OSCILLATOR, scene_at

from models.effects import Place
from models.effects.base_motion import BaseMotion
from models.effects.mains_hum import MainsHum
from models.effects.protocol import Measurement
from models.effects.sensor_delay import SensorDelay
from models.effects.sensor_position import SensorPosition
from models.linear import frf, linearised, measurement_chain
from models.modal import build_modal
from models.plant import build_plant
from models.record import Record
from models.rig import Excitation, Rig
from models.simulate import simulate

FS, N = 1000.0, 2000
TIME = np.arange(N) / FS
BURST = np.sin(2 * pi * 61.0 * TIME) * np.sin(pi * TIME * FS / N) ** 4
MEASUREMENT = Measurement(("tip", "mid"), FS, {})


def test_a_late_channel_reads_what_was():
    late = SensorDelay(Place(sensor="mid"), delay=0.00137)
    read = late.change_channels(np.stack([BURST, BURST]), MEASUREMENT)
    then = TIME - 0.00137
    expected = np.sin(2 * pi * 61.0 * then) * np.sin(pi * then * FS / N) ** 4
    np.testing.assert_array_equal(read[0], BURST)
    np.testing.assert_allclose(read[1], expected, atol=1e-6)  # where the record is continued


def test_no_delay_is_none_and_whole_samples_only_shift():
    for samples in (0, 3):
        late = SensorDelay(Place(sensor="tip"), delay=samples / FS)
        read = late.change_channels(np.stack([BURST, BURST]), MEASUREMENT)[0]
        np.testing.assert_allclose(read[samples:], BURST[: N - samples], atol=1e-12)


def test_a_delay_turns_the_phase_in_proportion_to_frequency():
    plant = build_plant(BEAM, extra=(SensorDelay(Place(sensor="mid"), delay=4e-4),))
    frequency = np.linspace(5.0, 300.0, 40)
    chain = measurement_chain(plant, ("tip", "mid"), frequency)
    np.testing.assert_allclose(chain[0], 1.0, atol=1e-12)
    np.testing.assert_allclose(chain[1], np.exp(-2j * pi * frequency * 4e-4), atol=1e-4)  # a kernel of finite length


def test_a_displaced_sensor_reads_the_motion_elsewhere():
    plain = linearised(build_modal(build_plant(BEAM), 400.0))
    moved = linearised(
        build_modal(build_plant(BEAM, extra=(SensorPosition(Place(sensor="mid"), position=1.5),)), 400.0)
    )
    frequency = np.linspace(5.0, 300.0, 40)
    np.testing.assert_allclose(frf(moved, frequency, ("mid",)), frf(plain, frequency, ("tip",)))
    beyond = build_plant(BEAM, extra=(SensorPosition(Place(sensor="mid"), position=9.0),))
    assert [sensor.position for sensor in beyond.sensors] == [1.5, 1.5]


def test_a_hum_is_three_lines_on_all_channels_alike():
    free = {"hum_phase_1": 0.3, "hum_phase_3": -1.0, "hum_phase_5": 2.0}
    read = MainsHum(Place(), frequency=50.0, amplitude=0.6).change_channels(
        np.zeros((2, N)), Measurement(("tip", "mid"), FS, free)
    )
    np.testing.assert_array_equal(read[0], read[1])
    lines = 2.0 * np.fft.rfft(read[0]) / N
    for harmonic in (1, 3, 5):
        expected = 0.6 / harmonic * np.exp(1j * free[f"hum_phase_{harmonic}"])
        assert lines[harmonic * 100] == pytest.approx(expected, rel=1e-9)
    assert np.sum(np.abs(lines) > 1e-9) == 3


def test_a_harmonic_above_the_recorders_band_is_not_recorded():
    read = MainsHum(Place(), frequency=100.0, amplitude=1.0).change_channels(np.zeros((1, N)), MEASUREMENT)
    assert np.flatnonzero(np.abs(np.fft.rfft(read[0])) > 1.0).tolist() == [200, 600]


def test_a_hum_is_no_part_of_an_frf():
    plant = build_plant(BEAM, extra=(MainsHum(Place(), frequency=50.0, amplitude=3.0),))
    chain = measurement_chain(plant, ("tip", "mid"), np.linspace(5.0, 300.0, 40))
    np.testing.assert_allclose(chain, 1.0, atol=1e-9)


@pytest.mark.parametrize("rig", [BEAM, OSCILLATOR], ids=["beam", "oscillator"])
def test_a_shaking_floor_is_a_driven_base(rig):
    """The same acceleration, once measured as the excitation and once hidden."""
    floor = BaseMotion(Place(), frequency=22.0, amplitude=0.7)
    acceleration = floor.base_acceleration(TIME, {"base_phase": 0.0})
    fade = np.sin(pi * TIME * FS / N) ** 2
    quiet = Record("test", FS, np.zeros(N), ("tip", "mid"), np.zeros((2, N)))
    hidden = simulate(build_plant(rig, extra=(floor,)), quiet, free={"base_phase": 0.0}).channels
    driven_rig = Rig(**{**dict(rig), "excitation": Excitation(quantity="base_acceleration")})
    driven = Record("test", FS, acceleration, ("tip", "mid"), np.zeros((2, N)))
    expected = simulate(build_plant(driven_rig), driven).channels
    # A measured acceleration is band-limited, a floor that begins at once is not.
    assert np.linalg.norm((hidden - expected) * fade) < 0.01 * np.linalg.norm(expected * fade)


def test_a_floor_moves_an_oscillator_as_the_textbook_says():
    """Absolute over base acceleration, (k + i omega c) / (k + i omega c - omega^2 m), once the start has died out."""
    beam = OSCILLATOR.structure
    damped = OSCILLATOR.model_copy(update={"structure": beam.model_copy(update={"damping": 12.0})})
    floor = BaseMotion(Place(), frequency=5.0, amplitude=0.4)
    n = 8000
    record = Record("test", FS, np.zeros(n), ("tip", "mid"), np.zeros((2, n)))
    read = simulate(build_plant(damped, extra=(floor,)), record, free={"base_phase": 0.5}).channels[0]
    omega = 2 * pi * 5.0
    held = beam.stiffness + 1j * omega * 12.0
    time = np.arange(n) / FS
    expected = 0.4 * np.real(held / (held - omega**2 * beam.mass) * np.exp(1j * (omega * time + 0.5)))
    settled = slice(5000, 7800)
    assert np.abs(read[settled] - expected[settled]).max() < 2e-3 * np.abs(expected).max()  # what is left of the start


@pytest.mark.parametrize(
    "effect",
    [
        SensorDelay(Place(sensor="mid"), delay=1e-3),
        SensorPosition(Place(sensor="mid"), position=0.9),
        MainsHum(Place(), frequency=50.0, amplitude=1.0),
        BaseMotion(Place(), frequency=20.0, amplitude=1.0),
    ],
    ids=lambda effect: effect.kind,
)
def test_the_rig_itself_is_left_as_it_was(effect):
    plain, changed = build_plant(BEAM), build_plant(BEAM, extra=(effect,))
    for part in ("structure", "contacts", "laws"):
        assert getattr(plain, part) == getattr(changed, part)


def test_a_delay_longer_than_the_continuation_still_shifts():
    late = SensorDelay(Place(sensor="tip"), delay=0.4)
    read = late.change_channels(np.stack([BURST, BURST]), MEASUREMENT)[0]
    np.testing.assert_allclose(read[400:], BURST[: N - 400], atol=1e-9)


def test_a_hum_is_looked_for_at_every_line_the_likely_ones_first():
    lines = (67.2, 50.03, 16.7)
    scene = scene_at(Place(), lines=lines)
    assert [trial.frequency for trial in MainsHum.trials(scene)] == [50.03, 67.2, 16.7]
    assert [trial.frequency for trial in MainsHum.trials(scene_at(Place()))] == [50.0, 60.0]
