"""A motion that is driven does not die away; a free decay does, also a slow one, and one that ends in noise."""

import numpy as np
import pytest
from a_rig_and_its_records import FS, a_rig, noise
from test_records_bad_files import npz

from testbed.records.dying import undying
from testbed.records.read import read_record

TIME = np.arange(8192) / FS


def decay(falls, *, freqs=(10.0, 62.0), seed=0, sensor_noise=1e-3):
    """Two channels that fall by so many Np each in the record."""
    modes = [np.exp(-falls * TIME / TIME[-1]) * np.cos(2.0 * np.pi * freq * TIME) for freq in freqs]
    still = sensor_noise * noise(seed, TIME.size, 2)
    return [modes[0] + 0.3 * modes[1] + still[0], modes[0] - 0.5 * modes[1] + still[1]]


def driven(seed):
    """Two channels under a random force, below the recorder's edge."""
    spectrum = np.fft.rfft(noise(seed, TIME.size, 2))
    spectrum[:, np.fft.rfftfreq(TIME.size, 1.0 / FS) > 300.0] = 0.0
    return list(np.fft.irfft(spectrum, TIME.size))


@pytest.mark.parametrize("falls", [0.25, 1.0, 5.0, 30.0])
@pytest.mark.parametrize("freqs", [(10.0, 62.0), (10.0, 10.4)], ids=["apart", "beating"])
def test_a_decay_dies_away(falls, freqs):
    assert undying(decay(falls, freqs=freqs)) is None


def test_a_decay_that_begins_within_the_record_dies_away():
    late = [np.roll(samples, 1000) for samples in decay(12.0)]
    assert undying(late) is None


def test_noise_alone_says_nothing():
    assert undying(list(noise(3, TIME.size, 2))) is None


@pytest.mark.parametrize("seed", range(5))
def test_a_steady_motion_is_told(seed):
    assert undying(driven(seed)).startswith("the motion does not die away: in its last ")


def test_a_motion_that_grows_is_told():
    assert "in its last tenth it is 6" in undying([samples[::-1] for samples in decay(2.0)])


def test_a_record_that_is_driven_says_so_without_its_force(tmp_path):
    path = npz(shaker=np.zeros(TIME.size), **dict(zip(("P1", "P2"), driven(1), strict=True)), P3=None, P4=None)(
        tmp_path
    )
    findings = read_record(path, a_rig(), strict=False).findings
    assert [finding for finding in findings if finding.startswith("bad.npz: the motion does not die away")]


def test_a_record_with_its_force_does_not(tmp_path):
    path = npz(shaker=noise(7, TIME.size), **dict(zip(("P1", "P2"), driven(1), strict=True)), P3=None, P4=None)(
        tmp_path
    )
    findings = read_record(path, a_rig(), strict=False).findings
    assert not [finding for finding in findings if "die away" in finding]
