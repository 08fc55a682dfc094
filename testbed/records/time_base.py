"""The sampling rate of a recording, and whether its time base is uniform."""

import numpy as np

from models.arrays import FloatArray
from models.errors import InputError
from testbed.records.recording import Recording
from testbed.records.units import seconds

UNIFORM = 1e-3
"""Largest departure of a time stamp from an even grid, as a share of a step, beyond how it was rounded."""

LARGEST_ROUNDING = 0.25
"""Rounded more coarsely than this share of a step, time stamps prove nothing."""

RATES_AGREE = 1e-3
"""A file that says its rate twice may differ by this share."""


def sampling_rate(recording: Recording, n_samples: int) -> float:
    """The rate, Hz, from the file's ``fs`` or its time base.

    Args:
        recording: with ``fs``, ``time`` or both.
        n_samples: length of its channels.

    Raises:
        InputError: no rate, a rate that is not above 0, or a time base that is not uniform.
    """
    file, fs = recording.file, recording.fs
    if fs is not None and not (np.isfinite(fs) and fs > 0):
        raise InputError(f"{file}: fs = {fs} Hz", "a sampling rate is above 0", "correct fs in the file")
    if recording.time is None:
        if fs is None:
            raise InputError(
                f"{file}: neither fs nor time",
                "a record says its sampling rate",
                "add fs in Hz, or a time base named time in s",
            )
        return float(fs)
    if recording.time.ndim != 1 or len(recording.time) != n_samples:
        raise InputError(
            f"{file}: time of size {_size(recording.time)}, channels of {n_samples} samples",
            "there is one time for each sample",
            "write time as long as the channels",
        )
    rate = _rate_of(recording.time * seconds(recording.time_unit, file), file)
    if fs is None:
        return rate
    if abs(rate / fs - 1) > RATES_AGREE:
        raise InputError(
            f"{file}: fs = {fs:g} Hz and a time base of {rate:g} Hz",
            "both say the same rate",
            "remove the one that is wrong",
        )
    return float(fs)


def likely_rate(rate: float, share: float) -> float:
    """A rate known to within a share of itself: the whole number of Hz in that range, if there is one.

    A step printed with six digits turns 2048 Hz into 2048.001 Hz, a sixteenth of a sample after a minute.

    Args:
        rate: Hz.
        share: of the rate, by which it may be off.
    """
    whole = float(round(rate))
    return whole if whole > 0 and abs(whole - rate) <= share * rate else rate


def rounding(times: FloatArray) -> float:
    """How far, at most, the stamps were rounded when they were stored: single precision or few decimals.

    Args:
        times: (N,) s.
    """
    largest = float(np.abs(times).max())
    if np.array_equal(times, times.astype(np.float32).astype(float)):
        return float(np.spacing(np.float32(largest))) / 2
    tail = times[-256:]
    for decimals in range(15):
        if np.all(np.abs(np.round(tail, decimals) - tail) <= 4 * np.spacing(largest)):
            return float(0.5 * 10.0**-decimals)
    return float(np.spacing(largest))


def _rate_of(times: FloatArray, file: str) -> float:
    bad = np.flatnonzero(~np.isfinite(times))
    if bad.size:
        raise InputError(
            f"{file}: time, sample {bad[0]} is {times[bad[0]]}", "times are finite", "repair the time base"
        )
    step = (times[-1] - times[0]) / (len(times) - 1) if len(times) > 1 else 0.0
    if step <= 0:
        raise InputError(
            f"{file}: time does not grow", "a time base grows from sample to sample", "repair it or give fs"
        )
    rounded = rounding(times)
    allowed = UNIFORM * step + min(2 * rounded, LARGEST_ROUNDING * step)
    off = np.abs(times - times[0] - step * np.arange(len(times)))
    if off.max() > allowed:
        steps = np.diff(times)
        sample = int(np.abs(steps - np.median(steps)).argmax()) + 1
        raise InputError(
            f"{file}: time, sample {sample} is {times[sample]:.9g} s, {steps[sample - 1]:.6g} s after the one before; "
            f"the others are {np.median(steps):.6g} s apart",
            "a time base is uniform, to a thousandth of a step",
            "resample the record, fill the lost samples, or print the times with more digits",
        )
    return likely_rate(1 / step, 2 * float(off.max() / (times[-1] - times[0])) + 1e-12)


def _size(values: FloatArray) -> str:
    return " x ".join(str(n) for n in values.shape) or "1"
