"""What drives the model between the samples: the measured excitation raised to the step's rate, force or base motion."""

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from scipy.integrate import cumulative_trapezoid

from models.arrays import FloatArray
from models.band_limit import raise_rate
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


STILL = np.zeros((2, 0))

_raised: "WeakKeyDictionary[Record, dict[tuple[str, int], Drive]]" = WeakKeyDictionary()


def drive_of(record: Record, plant: Plant, factor: int) -> Drive:
    """The record's excitation for steps of 1 / (factor fs), kept for the next call where no effect changes it.

    Args:
        record: with its measured excitation.
        plant: whose effects may correct the excitation channel.
        factor: steps per sample.
    """
    if record.excitation is None or plant.excitation is None:
        return Drive(np.zeros(record.n_samples * factor), None, STILL, None)
    quantity, measured = plant.excitation.quantity, record.excitation
    true = measured
    for effect in plant.effects:
        true = effect.change_excitation(true)
    if true is not measured:
        return _raise(true, record.fs, quantity, factor)
    kept = _raised.setdefault(record, {})
    if (quantity, factor) not in kept:
        kept[quantity, factor] = _raise(true, record.fs, quantity, factor)
    return kept[quantity, factor]


def _raise(signal: FloatArray, fs: float, quantity: ExcitationQuantity, factor: int) -> Drive:
    if quantity == "force":
        return Drive(raise_rate(signal, factor, for_linear_hold=True), None, STILL, None)
    fine = _motion(signal, fs, ORDER[quantity], factor)
    held = raise_rate(signal, factor, derivative=2 - ORDER[quantity], for_linear_hold=True) * fs ** (2 - ORDER[quantity])
    return Drive(None, held, fine[:2], fine[:, ::factor])


def _motion(signal: FloatArray, fs: float, order: int, factor: int) -> FloatArray:
    """(3, M) displacement, velocity and acceleration; what lies below the measured order is integrated from rest."""
    rows: list[FloatArray] = []
    for derivative in range(3):
        if derivative >= order:
            rows.append(raise_rate(signal, factor, derivative=derivative - order) * fs ** (derivative - order))
    while len(rows) < len(ORDER):
        rows.insert(0, cumulative_trapezoid(rows[0], dx=1.0 / (fs * factor), initial=0.0))
    return np.stack(rows)
