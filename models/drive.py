"""What drives the model between the samples: measured excitation and unmeasured base motion at the step's rate."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np
from scipy.integrate import cumulative_trapezoid

from models.arrays import FloatArray
from models.band_limit import raise_rate, record_channels
from models.plant import Plant
from models.record import Record
from models.rig import ExcitationQuantity

ORDER: dict[ExcitationQuantity, int] = {"base_displacement": 0, "base_velocity": 1, "base_acceleration": 2}
"""How often the base's displacement has been differentiated in the measured quantity."""


@dataclass(frozen=True, eq=False)
class Drive:
    """Inputs at the stepper's rate and what the sensors see of the base.

    Attributes:
        force: (M,) N, or None.
        base: (M,) acceleration of the base, m/s^2, or None.
        base_motion: (2, M) displacement and velocity of the base; (2, 0) where the base is still.
        seen: (3, N) displacement, velocity and acceleration of the base at the record's rate, or None.
    """

    force: FloatArray | None
    base: FloatArray | None
    base_motion: FloatArray
    seen: FloatArray | None

    @cached_property
    def peaks(self) -> tuple[float, float]:
        """Of the force, N, and of the base's acceleration, m/s^2; 0 where there is none."""
        force, base = (0.0 if each is None else float(np.abs(each).max()) for each in (self.force, self.base))
        return force, base


STILL = np.zeros((2, 0))

_raised: "WeakKeyDictionary[Record, dict[tuple[str, int, bool], Drive]]" = WeakKeyDictionary()
"""By quantity and factor: of a record's channel, and of one that reads 1 throughout."""


def drive_of(record: Record, plant: Plant, factor: int, free: Mapping[str, float], zero: float = 0.0) -> Drive:
    """The record's excitation and the effects' base motion for steps of 1 / (factor fs).

    Args:
        record: with its measured excitation.
        plant: whose effects may correct the excitation channel and shake the base.
        factor: steps per sample.
        free: the record's own parameters of the effects.
        zero: what the excitation channel reads at rest, SI.
    """
    return _shaken(_measured(record, plant, factor, zero), record.n_samples, record.fs, plant, factor, free)


def true_drive(excitation: FloatArray, fs: float, plant: Plant, factor: int, free: Mapping[str, float]) -> Drive:
    """What drives a plant whose true excitation is known, not read from a channel.

    Args:
        excitation: (N,) at fs, in the unit of the plant's excitation; 0 for a plant without one.
        fs: Hz.
        plant: whose effects may shake the base.
        factor: steps per sample.
        free: the record's own parameters of the effects.
    """
    quantity = "force" if plant.excitation is None else plant.excitation.quantity
    return _shaken(_raise(excitation, fs, quantity, factor), len(excitation), fs, plant, factor, free)


def _shaken(drive: Drive, n_samples: int, fs: float, plant: Plant, factor: int, free: Mapping[str, float]) -> Drive:
    """The drive with the base motion of the effects."""
    if not plant.effects:
        return drive
    time = np.arange(n_samples * factor) / (fs * factor)
    shaken = [effect.base_acceleration(time, free) for effect in plant.effects]
    present = [acceleration for acceleration in shaken if acceleration is not None]
    return _with_base(drive, np.sum(present, axis=0), n_samples, fs, factor) if present else drive


def _measured(record: Record, plant: Plant, factor: int, zero: float) -> Drive:
    """From the excitation channel, kept for the next call where no effect changes it."""
    if record.excitation is None or plant.excitation is None:
        return Drive(np.zeros(record.n_samples * factor), None, STILL, None)
    quantity = plant.excitation.quantity
    measured = record.excitation - zero if zero else record.excitation
    true = measured
    for effect in plant.effects:
        true = effect.change_excitation(true)
    if true is not measured:
        return _raise(true, record.fs, quantity, factor)
    plain = _kept(record, record.excitation, quantity, factor, is_one=False)
    if not zero:
        return plain
    return _less(plain, _kept(record, np.ones(record.n_samples), quantity, factor, is_one=True), zero)


def _kept(record: Record, signal: FloatArray, quantity: ExcitationQuantity, factor: int, *, is_one: bool) -> Drive:
    kept = _raised.setdefault(record, {})
    if (quantity, factor, is_one) not in kept:
        kept[quantity, factor, is_one] = _raise(signal, record.fs, quantity, factor)
    return kept[quantity, factor, is_one]


def _less(drive: Drive, one: Drive, zero: float) -> Drive:
    """A drive less so many times another of the same quantity: raising the rate is linear."""
    return Drive(
        None if drive.force is None or one.force is None else drive.force - zero * one.force,
        None if drive.base is None or one.base is None else drive.base - zero * one.base,
        drive.base_motion - zero * one.base_motion,
        None if drive.seen is None or one.seen is None else drive.seen - zero * one.seen,
    )


def _raise(signal: FloatArray, fs: float, quantity: ExcitationQuantity, factor: int) -> Drive:
    if quantity == "force":
        return Drive(raise_rate(signal, factor, for_linear_hold=True), None, STILL, None)
    order = ORDER[quantity]
    rows = [raise_rate(signal, factor, derivative=k) * fs**k for k in range(3 - order)]
    motion = _integrated(rows, 1.0 / (fs * factor))
    held = raise_rate(signal, factor, derivative=2 - order, for_linear_hold=True) * fs ** (2 - order)
    return Drive(None, held, motion[:2], motion[:, ::factor])


def _with_base(measured: Drive, acceleration: FloatArray, n_samples: int, fs: float, factor: int) -> Drive:
    """The drive with an acceleration of the base, (M,), added; a recorder filters what its sensors see of it."""
    motion = _integrated([acceleration], 1.0 / (fs * factor))
    held, seen = _for_linear_hold(acceleration), record_channels(motion, factor, n_samples, fs)
    if measured.base is None or measured.seen is None:
        return Drive(measured.force, held, motion[:2], seen)
    return Drive(measured.force, measured.base + held, measured.base_motion + motion[:2], measured.seen + seen)


def _integrated(rows: list[FloatArray], h: float) -> FloatArray:
    """(3, M) displacement, velocity and acceleration; what lies below the first row is integrated from rest."""
    while len(rows) < len(ORDER):
        rows = [cumulative_trapezoid(_for_linear_hold(rows[0]), dx=h, initial=0), *rows]
    return np.stack(rows)


def _for_linear_hold(signal: FloatArray) -> FloatArray:
    """(M,) the samples whose straight connections have the integrals of the signal, to fourth order of the step."""
    return signal - np.pad(np.diff(signal, 2), 1, mode="edge") / 12.0
