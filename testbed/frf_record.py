"""FRFs of one record, level by level, with or without the rig it belongs to."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.signal import welch

from identification.frf import FrfEstimate, estimate_frf, estimate_frf_per_level
from models.arrays import ComplexArray, FloatArray
from models.errors import InputError
from testbed.channel_checks import check_driven, check_length
from testbed.channels import Channels, no_excitation
from testbed.compare import SEGMENTS_PER_RECORD
from testbed.quantities import ratio_unit, unit_of

EXCITED = 1e-5
"""Share of the excitation's strongest line from which another one is excited: a sensor's noise is further below."""

FINEST, FEWEST_LINES = 2.0, 16
"""Least spacing of lines in units of 1 / T, and fewest of them up to half the rate."""


@dataclass(frozen=True, eq=False)
class Levels:
    """The FRFs of a record at each of its levels, the strongest first."""

    channels: Channels
    estimates: tuple[FrfEstimate, ...]

    @property
    def excitation_unit(self) -> str:
        """SI."""
        return unit_of(self.channels.excitation_quantity)

    @property
    def units(self) -> tuple[str, ...]:
        """Of each sensor's FRF."""
        return tuple(ratio_unit(unit_of(quantity), self.excitation_unit) for quantity in self.channels.quantities)


def levels_of(channels: Channels, resolution: float | None = None) -> Levels:
    """H1, H2 and coherence at each level, over the excited band; of the whole record where no level fills two segments.

    Args:
        channels: of the record.
        resolution: spacing of the lines, Hz, where the excitation does not repeat; an eighth of the record by default.

    Raises:
        InputError: no excitation or one that does not move, a record that is too short, or a resolution that it cannot
            have.
    """
    if channels.excitation is None:
        raise no_excitation(channels.name, channels.sensors)
    n_samples = channels.responses.shape[1]
    check_length(channels.name, n_samples)
    check_driven(channels)
    finest, coarsest = FINEST * channels.fs / n_samples, 0.5 * channels.fs / FEWEST_LINES
    lines = SEGMENTS_PER_RECORD * channels.fs / n_samples if resolution is None else resolution
    if not finest <= lines <= coarsest:
        raise InputError(
            f"--resolution {lines:g} Hz for {channels.name}, {n_samples / channels.fs:g} s at {channels.fs:g} Hz",
            f"lines are {finest:.3g} Hz apart or more, to average two parts of the record, and {coarsest:.3g} Hz or "
            f"less, for {FEWEST_LINES} lines up to half its rate",
            "ask for a spacing in between, or leave --resolution out",
        )
    signals = (channels.excitation, channels.responses, channels.fs)
    estimates = estimate_frf_per_level(*signals, resolution=lines) or (estimate_frf(*signals, resolution=lines),)
    return Levels(channels, tuple(_where_excited(estimate, channels.excitation, channels.fs) for estimate in estimates))


def _where_excited(estimate: FrfEstimate, excitation: FloatArray, fs: float) -> FrfEstimate:
    """Without the lines below and above the band that the excitation fills, on which there is noise over noise."""
    if estimate.period is not None:
        return estimate
    spacing = float(np.diff(estimate.frequency).min(initial=estimate.frequency[-1]))
    # Without each segment's own mean, which would leak into the lowest lines.
    level = excitation - excitation.mean()
    lines, power = welch(level, fs, nperseg=min(level.size, round(fs / spacing)), detrend=False)
    filled = lines[power > EXCITED * power.max()]
    kept = (estimate.frequency >= filled[0] - 0.5 * spacing) & (estimate.frequency <= filled[-1] + 0.5 * spacing)
    rows = (estimate.h1[:, kept], estimate.h2[:, kept], estimate.coherence[:, kept])
    return replace(estimate, frequency=estimate.frequency[kept], h1=rows[0], h2=rows[1], coherence=rows[2])


def levels_json(levels: Levels) -> dict[str, Any]:
    """The content of ``frf.json``.

    Args:
        levels: finished.
    """
    channels = levels.channels
    return {
        "record": channels.name,
        "excitation_unit": levels.excitation_unit,
        "levels": [
            {
                "level": estimate.level,
                "averages": estimate.n_averages,
                "frequency": estimate.frequency,
                "channels": [
                    {
                        "sensor": name,
                        "unit": levels.units[i],
                        "h1": _parts(estimate.h1[i]),
                        "h2": _parts(estimate.h2[i]),
                        "coherence": estimate.coherence[i],
                    }
                    for i, name in enumerate(channels.sensors)
                ],
            }
            for estimate in levels.estimates
        ],
        "findings": [*channels.findings, *incoherent(levels)],
    }


COHERENT = 0.8
"""Mean coherence below which most of what an estimate says is not the force's doing."""

UNREPEATED = (
    "it comes of noise, another input or a nonlinearity, or the force is a sweep, which passes each line in one part "
    "of the record alone, where the parts before still ring; a multisine that repeats has FRFs, and testbed compare "
    "takes a sweep as it is"
)


def incoherent(levels: Levels) -> list[str]:
    """In words, at which levels the responses follow the force on few lines, and what that may come of.

    Args:
        levels: finished.
    """
    channels = levels.channels
    said = []
    for estimate in levels.estimates:
        coherence = float(estimate.coherence.mean())
        if coherence >= COHERENT:
            continue
        cause = "it comes of noise: over whole periods nothing else differs" if estimate.period else UNREPEATED
        said.append(
            f"{channels.name}: mean coherence {coherence:.2f} at {estimate.level:.3g} {levels.excitation_unit} rms: "
            f"these FRFs tell little; {cause}"
        )
    return said


def _parts(values: ComplexArray) -> dict[str, FloatArray]:
    return {"real": values.real, "imag": values.imag}
