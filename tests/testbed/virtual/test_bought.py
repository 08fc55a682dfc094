"""A bought sensor does to a signal what its data sheet says, and no more."""

import numpy as np
import pytest
from scipy.signal import welch

from models.errors import InputError
from testbed.virtual.bought import PRESETS, Bought, bought
from testbed.virtual.experiment import SensorTable

FS, N = 2048.0, 1 << 15
TIME = np.arange(N) / FS
RNG = np.random.default_rng(1)


def tone(freq, amplitude=1.0):
    return amplitude * np.sin(2.0 * np.pi * round(freq * N / FS) * FS / N * TIME)


def test_an_ideal_sensor_reads_the_truth():
    np.testing.assert_allclose(Bought().reads(tone(100.0), FS, RNG), tone(100.0), atol=1e-12)


def test_the_noise_has_its_density_within_the_recorders_band():
    heard = Bought(noise_density=1e-3).reads(np.zeros(N), FS, np.random.default_rng(2))
    freq, density = welch(heard, FS, nperseg=1024)
    assert np.sqrt(density[(freq > 50.0) & (freq < 0.35 * FS)].mean()) == pytest.approx(1e-3, rel=0.03)
    assert density[freq > 0.45 * FS].max() < 1e-3 * density.max()


def test_a_gain_a_range_and_a_converter():
    sensor = Bought(gain_error=0.1, range=0.5, bits=8)
    heard = sensor.reads(tone(50.0), FS, RNG)
    assert np.abs(heard).max() == pytest.approx(0.5)
    steps = heard / (1.0 / 2**8)
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
    small = Bought(gain_error=0.1).reads(tone(50.0, 0.1), FS, RNG)
    assert np.abs(small).max() == pytest.approx(0.11, rel=1e-4)


def test_a_mounted_resonance_amplifies_below_it():
    heard = Bought(resonance=1000.0, quality=50.0).reads(tone(500.0), FS, RNG)
    assert np.abs(heard).max() == pytest.approx(1.0 / (1.0 - 0.25), rel=1e-3)


@pytest.mark.parametrize("name", PRESETS)
def test_presets_have_sources_and_can_be_changed(name):
    assert PRESETS[name].source
    changed = bought(SensorTable(preset=name, mass=0.5), "sensors.P1")
    assert (changed.mass, changed.range) == (0.5, PRESETS[name].range)


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"preset": "PCB 1"}, r"sensors.P1.preset = .PCB 1.; the presets are PCB 352C66, .*; choose one"),
        ({"bits": 12}, r"sensors.P1.bits = 12 without a range; a converter spreads .*; add range"),
    ],
)
def test_what_makes_no_sensor_is_told(table, message):
    with pytest.raises(InputError, match=message):
        bought(SensorTable(**table), "sensors.P1")
