"""What drives the model between the samples: force, measured base motion, and base motion that no channel measures."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from model_scenes import REFERENCE, burst, driven, record_of

from models.drive import ORDER, drive_of
from models.effects import EFFECTS, Effect, Place
from models.effects.protocol import Parameter
from models.plant import build_plant

FS, N, FACTOR = 1024.0, 2048, 4
TIME = np.arange(N) / FS
FINE_TIME = np.arange(N * FACTOR) / (FS * FACTOR)
FREQ = 30.0
OMEGA = 2.0 * np.pi * FREQ


@dataclass(frozen=True)
class Tremor(Effect):
    """a(t) = size sin(2 pi 30 Hz t + phase), with a phase of its own in every record."""

    kind: ClassVar[str] = "tremor"
    family: ClassVar[str] = "measurement"
    source: ClassVar[str] = "a test"
    record_parameters: ClassVar[dict] = {"phase": Parameter("phi", "rad", scale="linear")}

    size: float = 1.0

    def base_acceleration(self, time, free):
        return self.size * np.sin(OMEGA * time + free["phase"])


def force_plant(*effects):
    return build_plant(REFERENCE, extra=effects)


def test_a_force_is_raised_for_a_linear_hold_and_kept():
    record = record_of(force_plant(), burst(FS, N, FREQ, 3.0), FS)
    drive = drive_of(record, force_plant(), FACTOR, {})
    gain = 1.0 / np.sinc(FREQ / (FS * FACTOR)) ** 2
    np.testing.assert_allclose(drive.force[::FACTOR], gain * record.excitation, atol=3e-4)  # the burst has a width
    assert drive.base is None
    assert drive.base_motion.shape == (2, 0)
    assert drive.seen is None
    assert drive_of(record, force_plant(), FACTOR, {}) is drive
    assert drive_of(record, force_plant(), 2, {}) is not drive


def test_an_effect_on_the_channel_corrects_the_force_and_is_not_kept():
    record = record_of(force_plant(), burst(FS, N, FREQ, 3.0), FS)
    plain = drive_of(record, force_plant(), FACTOR, {}).force
    gain = EFFECTS["force_gain"](Place(), gain=2.0)
    for _ in range(2):
        np.testing.assert_allclose(drive_of(record, force_plant(gain), FACTOR, {}).force, plain / 2.0, atol=1e-12)


def test_without_excitation_no_force_acts():
    drive = drive_of(record_of(force_plant(), None, FS, N), force_plant(), FACTOR, {})
    assert not drive.force.any()
    assert len(drive.force) == N * FACTOR


@pytest.mark.parametrize(
    ("quantity", "order"), [("base_displacement", 0), ("base_velocity", 1), ("base_acceleration", 2)]
)
def test_a_measured_base_motion_gives_the_two_others(quantity, order):
    """A burst whose displacement is known; its derivatives from a spectrum, which is exact for what fits the record."""
    bell = burst(FS * FACTOR, N * FACTOR, FREQ, 1e-3)
    spectrum = np.fft.rfft(bell)
    s = 2j * np.pi * np.fft.rfftfreq(N * FACTOR, 1.0 / (FS * FACTOR))
    exact = [np.fft.irfft(spectrum * s**k, N * FACTOR) for k in range(3)]
    plant = build_plant(driven(REFERENCE, quantity))
    drive = drive_of(record_of(plant, exact[order][::FACTOR], FS), plant, FACTOR, {})
    assert drive.force is None
    peaks = [np.abs(row).max() for row in exact]
    tolerance = 1e-6  # of the peak: fourth order of the fine step
    np.testing.assert_allclose(drive.base_motion[0], exact[0], atol=tolerance * peaks[0])
    np.testing.assert_allclose(drive.base_motion[1], exact[1], atol=tolerance * peaks[1])
    for row in range(3):
        np.testing.assert_allclose(drive.seen[row], exact[row][::FACTOR], atol=tolerance * peaks[row])
    hold = np.sinc(FREQ / (FS * FACTOR)) ** 2
    np.testing.assert_allclose(drive.base, exact[2] / hold, atol=3e-4 * peaks[2])


def test_an_unmeasured_shake_drives_the_base_beside_the_force():
    record = record_of(force_plant(), burst(FS, N, FREQ, 3.0), FS)
    free = {"phase": 0.5 * np.pi}
    drive = drive_of(record, force_plant(Tremor(Place(), size=0.2)), FACTOR, free)
    np.testing.assert_array_equal(drive.force, drive_of(record, force_plant(), FACTOR, {}).force)
    held = 0.2 * np.cos(OMEGA * FINE_TIME) / np.sinc(FREQ / (FS * FACTOR)) ** 2
    np.testing.assert_allclose(drive.base[1:-1], held[1:-1], rtol=1e-4, atol=1e-6)
    velocity = 0.2 / OMEGA * np.sin(OMEGA * FINE_TIME)
    displacement = 0.2 / OMEGA**2 * (1.0 - np.cos(OMEGA * FINE_TIME))
    np.testing.assert_allclose(drive.base_motion[1], velocity, atol=1e-4 * 0.2 / OMEGA)
    np.testing.assert_allclose(drive.base_motion[0], displacement, atol=1e-4 * 0.2 / OMEGA**2)
    inside = slice(100, -100)
    np.testing.assert_allclose(drive.seen[2, inside], 0.2 * np.cos(OMEGA * TIME)[inside], atol=1e-3)


def test_two_shakes_and_a_measured_base_add():
    plant = build_plant(driven(REFERENCE, "base_acceleration"))
    record = record_of(plant, burst(FS, N, FREQ, 1.0), FS)
    free = {"phase": 0.0}
    shakes = [
        replace(plant, effects=tuple(Tremor(Place(), size=size) for size in sizes)) for sizes in ((), (1, 2), (3,))
    ]
    none, both, sum_of_both = (drive_of(record, shaken, FACTOR, free) for shaken in shakes)
    alone = drive_of(record_of(force_plant(), None, FS, N), replace(shakes[2], excitation=None), FACTOR, free)
    np.testing.assert_allclose(both.base, sum_of_both.base, atol=1e-12)
    for name in ("base", "base_motion", "seen"):
        total = getattr(none, name) + getattr(alone, name)
        np.testing.assert_allclose(getattr(sum_of_both, name), total, atol=1e-12)


@pytest.mark.parametrize("quantity", ["force", *ORDER])
def test_a_channel_with_a_zero_of_its_own_drives_as_one_without(quantity):
    plant, signal = build_plant(driven(REFERENCE, quantity)), burst(FS, N, FREQ, 1.0)
    off = drive_of(record_of(plant, signal + 0.25, FS), plant, FACTOR, {}, 0.25)
    right = drive_of(record_of(plant, signal, FS), plant, FACTOR, {})
    for name in ("force", "base", "base_motion", "seen"):
        found, expected = getattr(off, name), getattr(right, name)
        if expected is None:
            assert found is None
        else:
            np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max(initial=0.0))
