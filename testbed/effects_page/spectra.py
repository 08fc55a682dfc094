"""Spectra of the last period of the bench's multisines, where nothing is left of the start."""

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.signal import get_window

from models.arrays import ComplexArray, FloatArray
from models.record import Record
from testbed.effects_page.bench import BAND, FS, PERIOD


def lines() -> FloatArray:
    """(n_lines,) Hz, that the force holds."""
    return np.arange(round(BAND[1] * PERIOD) + 1)[_excited()] / PERIOD


def spectra(rows: FloatArray) -> ComplexArray:
    """(..., n_lines) spectra of signals under a Hann window: a hum need not be on a line.

    Args:
        rows: (..., N).
    """
    last = rows[..., -round(PERIOD * FS) :]
    return np.asarray(np.fft.rfft(last * get_window("hann", last.shape[-1]), axis=-1)[..., _excited()])


def amplitudes(rows: FloatArray, records: Sequence[Record], smoothed: float = 0.0) -> FloatArray:
    """(..., n_lines) rms over the realisations of channels' spectra over that of the force.

    Args:
        rows: (n_realisations, ..., N) channels.
        records: whose force it is, one a realisation.
        smoothed: Hz over which powers are averaged besides.
    """
    power = np.mean(np.abs(spectra(rows)) ** 2, axis=0)
    if smoothed:
        power = uniform_filter1d(power, round(smoothed * PERIOD), axis=-1)
    return np.asarray(np.sqrt(power / np.mean(np.abs(spectra(_forces(records))) ** 2, axis=0)))


def _forces(records: Sequence[Record]) -> FloatArray:
    return np.stack([np.asarray(record.excitation) for record in records])


def _excited() -> slice:
    return slice(round(BAND[0] * PERIOD), round(BAND[1] * PERIOD) + 1)
