from pathlib import Path

import numpy as np
import pytest

from models.effects import EFFECTS, Place
from models.errors import InputError
from models.plant import build_plant
from models.rig_file import read_rig
from testbed.virtual import (
    Noise,
    half_sine_hammer,
    logarithmic_sweep,
    perturbed,
    random_phase_multisine,
    virtual_record,
)
from testbed.virtual.virtual_record import as_read

FS = 2048.0


@pytest.fixture(scope="module")
def rig():
    return read_rig(Path(__file__).parents[1] / "data/reference_rig.toml")


def multisine(n=1024, seed=0):
    return random_phase_multisine(np.random.default_rng(seed), FS, n, 1, 10.0, 300.0, 8.0)


def test_a_multisine_repeats_has_its_rms_and_stays_in_its_band():
    signal = random_phase_multisine(np.random.default_rng(1), FS, 4096, 4, 20.0, 200.0, 3.0)
    np.testing.assert_array_equal(signal[:1024], signal[3072:])
    assert np.sqrt(np.mean(signal**2)) == pytest.approx(3.0)
    assert abs(signal[0]) < 0.1
    amplitude = np.abs(np.fft.rfft(signal[:1024]))
    freq = np.fft.rfftfreq(1024, 1 / FS)
    inside = (freq >= 20.0) & (freq <= 200.0)
    assert np.ptp(amplitude[inside]) < 1e-9 * amplitude.max()
    assert amplitude[~inside].max() < 1e-9 * amplitude.max()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((1000, 3, 10.0, 100.0), r"1000 samples in 3 periods; .*whole number of samples; choose a length"),
        ((1024, 1, 10.1, 10.2), r"a band of 10.1 to 10.2 Hz with lines 2 Hz apart; .*; widen the band"),
    ],
)
def test_a_multisine_that_cannot_be_is_refused(arguments, message):
    with pytest.raises(InputError, match=message):
        random_phase_multisine(np.random.default_rng(0), FS, *arguments, rms=1.0)


def test_a_sweep_passes_the_mean_of_the_logarithms_at_half_time():
    signal = logarithmic_sweep(FS, 8192, 10.0, 250.0, 2.0)
    crossings = np.flatnonzero(np.diff(np.sign(signal[3072:5120]))) + 3072
    freq = 0.5 / np.diff(crossings / FS)
    assert np.interp(4096, crossings[:-1], freq) == pytest.approx(50.0, rel=0.1)
    assert np.abs(signal).max() == pytest.approx(2.0, rel=1e-3)
    assert abs(signal[0]) + abs(signal[-1]) < 1e-2


def test_a_hammer_gives_its_momentum():
    signal = half_sine_hammer(FS, 2048, 0.1, 8e-3, 100.0)
    assert signal.sum() / FS == pytest.approx(2 / np.pi * 100.0 * 8e-3, rel=2e-3)
    assert signal.min() == 0.0
    assert np.flatnonzero(signal)[0] / FS == pytest.approx(0.1, abs=1 / FS)


def test_a_rig_as_built_is_off_by_its_tolerances_and_no_more(rig):
    rng = np.random.default_rng(0)
    drawn = [[(p.value, p.path) for p in perturbed(rig, rng).parameters()] for _ in range(200)]
    for i, parameter in enumerate(rig.parameters()):
        assert drawn[0][i][1] == parameter.path
        off = (np.array([row[i][0] for row in drawn]) - parameter.value) / parameter.std
        assert np.abs(off).max() <= 2.0
        assert off.std() == pytest.approx(0.88, abs=0.15)  # a normal cut at 2 deviations; 200 draws


def test_a_virtual_record_is_the_same_for_the_same_seed_and_has_the_noise_it_says(rig):
    force, quiet = multisine(), Noise(0.0, 0.0)
    clean = virtual_record(rig, [], force, FS, quiet, np.random.default_rng(0), "clean")
    noisy = virtual_record(rig, [], force, FS, Noise(0.01, 0.02), np.random.default_rng(7), "noisy")
    again = virtual_record(rig, [], force, FS, Noise(0.01, 0.02), np.random.default_rng(7), "noisy")
    np.testing.assert_array_equal(noisy.responses, again.responses)
    off = noisy.responses - clean.responses
    whole = np.sqrt(np.mean(clean.responses**2))
    np.testing.assert_allclose(off.std(axis=1), 0.01 * whole, rtol=0.1)  # 1024 samples
    assert np.std(noisy.excitation - clean.excitation) == pytest.approx(0.02 * 8.0, rel=0.1)
    assert clean.sensors == tuple(sensor.name for sensor in rig.sensors)
    np.testing.assert_allclose(clean.excitation, force, atol=8e-3)  # in the recorder's band but for the record's ends


def test_noise_can_be_a_share_of_each_channel_and_pass_the_low_pass(rig):
    channels = np.outer([1.0, 100.0], np.sin(np.arange(4096)))
    noise = Noise(0.1, 0.0, share_of="channel", noise="before")
    off = noise.on_channels(channels, rig.sensors[:2], FS, np.random.default_rng(0)) - channels
    np.testing.assert_allclose(off.std(axis=1), [0.1 * np.sqrt(0.8 / 2), 10.0 * np.sqrt(0.8 / 2)], rtol=0.05)
    spectrum = np.abs(np.fft.rfft(off[1] * np.hanning(4096)))
    assert spectrum[np.fft.rfftfreq(4096) > 0.44].max() < 1e-3 * spectrum.max()


def test_the_force_channel_reads_what_its_effects_say(rig):
    force = multisine()
    plant = build_plant(rig, [EFFECTS["force_gain"](Place(), gain=1.2)])
    np.testing.assert_allclose(as_read(plant, force), 1.2 * force, rtol=1e-9)
    assert as_read(build_plant(rig), force) is force
