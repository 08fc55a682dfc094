import numpy as np
import pytest
from a_rig_and_its_records import noise

from models.record import is_dead
from testbed.records.samples import first_clipped

T = np.arange(4000) / 2000.0
SLOW = np.sin(2 * np.pi * 3.0 * T)
RANDOM = np.convolve(noise(1, 4000), np.hanning(15), mode="same")
PULSES = np.where(T % 0.5 < 0.01, np.sin(2 * np.pi * 50 * T) ** 2, 0.0)


def quantised(signal, levels):
    return np.round(signal / np.ptp(signal) * levels)


CLIPPED = {
    "random": np.clip(RANDOM, -3.0, 3.0),
    "at the top alone": np.minimum(RANDOM, 3.0),
    "at the bottom alone": np.maximum(RANDOM, -3.0),
    "hard": np.clip(RANDOM, -0.5, 0.5),
    "a sine": np.clip(SLOW, -0.9, 0.9),
    "by a 16-bit converter": np.clip(quantised(RANDOM, 65536), -20000, 20000),
    "by a 12-bit converter": np.clip(quantised(SLOW, 4096), -1500, 1500),
    "in single precision": np.clip(RANDOM, -3.0, 3.0).astype(np.float32).astype(float),
    "hammer blows": np.minimum(PULSES, 0.7),
    "with an offset": np.clip(RANDOM, -3.0, 3.0) + 0.123,
    "short": np.clip(np.sin(2 * np.pi * 40 * T[:200]), -0.8, 0.8),
}

SOUND = {
    "random": RANDOM,
    "slow": SLOW,
    "two values": np.sign(noise(1, 4000)),
    "square": np.sign(SLOW),
    "three levels": quantised(RANDOM, 2),
    "ten levels": quantised(RANDOM, 10),
    "slow in ten levels": quantised(SLOW, 10),
    "slow in 200 levels": quantised(SLOW, 200),
    "slow in 12 bits": quantised(SLOW, 4096),
    "slow with six digits": np.array([float(f"{v:.5e}") for v in SLOW]),
    "very slow in single precision": np.sin(2 * np.pi * 0.5 * T).astype(np.float32).astype(float),
    "zeros at rest": np.where(T > 1, RANDOM, 0.0),
    "pulses from rest": PULSES,
    "pulses from rest with an offset": PULSES + 0.25,
    "half waves from rest": np.maximum(0.0, np.sin(2 * np.pi * 93.7 * T)),
    "half waves from rest with an offset": np.maximum(0.0, np.sin(2 * np.pi * 93.7 * T - 1)) + 0.25,
    "one peak": np.where(np.abs(T - 1) < 0.1, 1.0, 0.5 * RANDOM / np.abs(RANDOM).max()),
    "dead": np.full(100, 3.0),
    "two samples": np.array([1.0, 2.0]),
    "no sample": np.array([]),
    "a few": np.array([0.0, 1.0, 1.0, 0.5, 1.0, 1.0, 0.0]),
}


@pytest.mark.parametrize("case", CLIPPED)
def test_clipped_channels_are_seen_where_it_begins(case):
    signal = CLIPPED[case]
    first = first_clipped(signal)
    assert first is not None
    assert signal[first] in (signal.min(), signal.max())
    assert np.all(signal[first : first + 3] == signal[first])


@pytest.mark.parametrize("case", SOUND)
def test_sound_channels_are_not(case):
    assert first_clipped(SOUND[case]) is None


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("levels", [None, 5, 50, 500])
def test_no_false_alarm_on_unclipped_noise_of_any_resolution(seed, levels):
    signal = np.convolve(noise(seed, 20000), np.hanning(9), mode="same")
    assert first_clipped(signal if levels is None else quantised(signal, levels)) is None


def test_dead_is_constant_to_rounding():
    assert is_dead(np.zeros(5))
    assert is_dead(0.1 + 1e-15 * noise(1))
    assert not is_dead(0.1 + 1e-6 * noise(1))
    assert not is_dead(1e-9 * noise(1))
