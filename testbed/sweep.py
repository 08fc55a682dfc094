"""Nonlinear FRFs of a rig at some levels, and the backbone of one resonance: what ``testbed sweep`` shows."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from identification.progress import Progress
from models.errors import InputError
from models.harmonic_balance import PeriodicCurve, backbone, from_both_ends
from models.plant import Plant, build_plant
from models.rig import Rig
from testbed.outputs import Json
from testbed.quantities import unit_of


@dataclass(frozen=True, eq=False)
class Sweep:
    """Curves at some levels.

    Attributes:
        rig: that is driven.
        sensor: whose reading is shown.
        band: Hz, that was asked for; a curve's last points, and the backbone, may lie beyond it.
        curves: up from the band's lower end; where one folds back out of it, down from the upper end too.
        spine: the backbone at this sensor, or None.
        without_spine: why there is none, in words.
    """

    rig: Rig
    sensor: str
    band: tuple[float, float]
    curves: tuple[PeriodicCurve, ...]
    spine: PeriodicCurve | None
    without_spine: str

    @property
    def unit(self) -> str:
        """Of the reading."""
        return unit_of(self.rig.sensor(self.sensor).quantity)

    @property
    def level_unit(self) -> str:
        """Of the amplitudes."""
        assert self.rig.excitation is not None
        return unit_of(self.rig.excitation.quantity)


def swept(
    rig: Rig,
    amplitudes: Sequence[float],
    band: tuple[float, float],
    sensor: str | None,
    highest: float,
    progress: Progress,
) -> Sweep:
    """Follow the motion under sines through a band, at each amplitude, and the resonance over the amplitude.

    Args:
        rig: with its effects.
        amplitudes: of the sine, in the quantity of the rig's excitation.
        band: Hz.
        sensor: whose reading is shown; the last of the rig by default.
        highest: frequency up to which modes follow the motion, Hz.
        progress: told what is being done.

    Raises:
        InputError: a band or a level that is none, a rig without sensors, or what harmonic balance refuses.
        DivergenceError: no periodic motion was found where a curve begins.
    """
    if not 0.0 < band[0] < band[1] <= highest:
        raise InputError(
            f"a band from {band[0]:g} to {band[1]:g} Hz with modes up to {highest:g} Hz",
            "a band begins above 0 and ends above its beginning, where modes still follow",
            "change --from and --to, or raise --up-to",
        )
    if not amplitudes or min(amplitudes) <= 0.0:
        raise InputError(
            f"amplitudes {', '.join(f'{a:g}' for a in amplitudes) or 'none'}",
            "a sine has an amplitude above 0, in the unit of the rig's excitation",
            "give --amplitude once a level",
        )
    names = [one.name for one in rig.sensors]
    if not names or (sensor is not None and sensor not in names):
        raise InputError(
            f"sensor {sensor}" if names else "a rig without sensors",
            f"a curve shows what a sensor of the rig reads: {', '.join(names) or 'there are none'}",
            "choose one of them with --sensor" if names else "add [[sensors]] to the rig file",
        )
    seen = sensor if sensor is not None else names[-1]
    plant, curves = build_plant(rig), list[PeriodicCurve]()
    for amplitude in sorted(set(amplitudes)):
        progress(f"following the motion under {amplitude:g} from {band[0]:g} to {band[1]:g} Hz")
        curves += from_both_ends(plant, amplitude, band, highest, progress)
    progress(f"following the resonance that {seen} sees up to {max(amplitudes):g}")
    spine, without = _spine(plant, seen, max(amplitudes), band, highest)
    return Sweep(rig, seen, band, tuple(curves), spine, without)


def _spine(
    plant: Plant, sensor: str, amplitude: float, band: tuple[float, float], highest: float
) -> tuple[PeriodicCurve | None, str]:
    """The backbone, or why there is none: a band may hold no resonance, which is no fault of the curves."""
    try:
        return backbone(plant, sensor, amplitude, band, highest), ""
    except (InputError, ArithmeticError) as none:
        return None, str(none)


def sweep_json(found: Sweep) -> Json:
    """The content of ``sweep.json``.

    Args:
        found: finished.
    """
    return {
        "sensor": found.sensor,
        "unit": found.unit,
        "level_unit": found.level_unit,
        "curves": [_curve(curve, found.sensor) for curve in found.curves],
        "backbone": None if found.spine is None else _curve(found.spine, found.sensor),
        "without_backbone": found.without_spine,
    }


def _curve(curve: PeriodicCurve, sensor: str) -> Json:
    first = curve.read([sensor])[:, 0, 1]
    return {
        "amplitude": curve.amplitudes,
        "frequency": curve.freqs,
        "peak": curve.peaks([sensor])[:, 0],
        "first_harmonic": {"real": first.real, "imag": first.imag},
        "stable": curve.is_stable,
        "loss": list(curve.losses),
        "harmonics": np.count_nonzero(np.abs(curve.motion).max(axis=1) > 0.0, axis=1) - 1,
        "left_out": float(curve.left_out.max()),
        "ended": curve.ended,
    }
