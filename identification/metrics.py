"""How close a model comes to a measurement, as the field's numbers. Pure functions; the model always comes first."""

from collections.abc import Sequence

import numpy as np

from models.arrays import AnyArray, ComplexArray, FloatArray
from models.errors import InputError

BAND_LINES = 9
"""Frequency lines in the sliding band of the channel-wise CSAC and CSF: some half-power widths, less than the spacing
of two modes at the usual resolution. A report states it with the numbers."""


def nrmse(model: AnyArray, measured: AnyArray, quantities: Sequence[str] | None = None) -> float:
    """rms(model - measured) / rms(measured) over all samples, and over all channels where there are several.

    Args:
        model: (N,) or (n_sensors, N) predicted signals, or FRFs over N lines.
        measured: the same shape and units.
        quantities: what each channel measures; None where all measure one.

    Raises:
        InputError: the shapes differ, or the measurement of a quantity is 0 throughout.

    Source: the definition of ``nrmse`` in the format of ``compare.json``.
    """
    _same_shape(model, measured)
    error, power = (np.sum(np.abs(np.atleast_2d(each)) ** 2, axis=1) for each in (model - measured, measured))
    kinds = quantities or ("",) * len(power)
    if np.any(mean_by_quantity(power, kinds) == 0.0):
        raise InputError("a measured signal of zeros", "its rms normalises the error", "leave the dead channel out")
    return pooled_nrmse(error, power, kinds)


def pooled_nrmse(error: FloatArray, power: FloatArray, quantities: Sequence[str]) -> float:
    """The nrmse over channels: those of one quantity are normalised by their rms together.

    Metres cannot be added to metres per second squared: each quantity counts by its number of channels.

    Args:
        error: (n_sensors,) sum of squares of model - measured.
        power: (n_sensors,) the same of measured.
        quantities: what each channel measures.
    """
    scale = np.maximum(mean_by_quantity(power, quantities), np.finfo(float).tiny)
    return float(np.sqrt(np.mean(error / scale)))


def mean_by_quantity(power: FloatArray, quantities: Sequence[str]) -> FloatArray:
    """(n_sensors,) for every channel the mean over all that measure the same.

    Args:
        power: (n_sensors,) of each channel.
        quantities: what each measures.
    """
    kinds = np.asarray(quantities)
    return np.array([np.mean(power[kinds == kind]) for kind in kinds])


def overall_nrmse(per_record: Sequence[float]) -> float:
    """The nrmse over several records: each is normalised by its own rms, and the squares are averaged.

    Args:
        per_record: the nrmse of each record.

    Raises:
        InputError: there is no record.

    Source: the definition of ``nrmse`` in the format of ``compare.json``.
    """
    if not per_record:
        raise InputError("no records", "an overall error needs at least one", "name a record")
    return float(np.sqrt(np.mean(np.square(per_record))))


def mre(model: ComplexArray, measured: ComplexArray) -> FloatArray:
    """Mean relative error of the FRF magnitude, mean_f | |Ha| - |Hx| | / |Hx|, per sensor.

    Args:
        model: (n_sensors, n_freq) predicted FRFs Ha.
        measured: (n_sensors, n_freq) measured FRFs Hx, in the same unit.

    Returns:
        (n_sensors,) errors, 0 or more. Lines where Hx is exactly 0 have no relative error and are left out.

    Raises:
        InputError: the shapes differ, or a sensor's measured FRF is 0 throughout.

    Source: Zhang et al., Actuators 14 (2025) 58, table 4.
    """
    _frf_pair(model, measured)
    size = np.abs(measured)
    lines = np.count_nonzero(size, axis=1)
    if np.any(lines == 0):
        raise InputError(
            f"a measured FRF of zeros (row {int(np.argmin(lines))})",
            "the error is relative to its magnitude",
            "leave the dead channel out",
        )
    error = np.abs(np.abs(model) - size)
    relative = np.divide(error, size, out=np.zeros_like(size), where=size > 0.0)
    return np.asarray(relative.sum(axis=1) / lines)


def rmse(model: ComplexArray, measured: ComplexArray) -> FloatArray:
    """Root mean square of the complex FRF error, sqrt(mean_f |Ha - Hx|^2), per sensor.

    Args:
        model: (n_sensors, n_freq) predicted FRFs Ha.
        measured: (n_sensors, n_freq) measured FRFs Hx, in the same unit.

    Returns:
        (n_sensors,) errors in the unit of the FRFs; the phase counts.

    Raises:
        InputError: the shapes differ.

    Source: Zhang et al., Actuators 14 (2025) 58, table 4, with the complex difference in place of the magnitudes'.
    """
    _frf_pair(model, measured)
    return np.asarray(np.sqrt(np.mean(np.abs(model - measured) ** 2, axis=1)))


def frac(model: ComplexArray, measured: ComplexArray) -> FloatArray:
    """Frequency response assurance criterion |Hx^H Ha|^2 / ((Hx^H Hx)(Ha^H Ha)) over frequency, per sensor.

    Args:
        model: (n_sensors, n_freq) predicted FRFs Ha.
        measured: (n_sensors, n_freq) measured FRFs Hx.

    Returns:
        (n_sensors,) values from 0 to 1; 1 where the two are proportional by any complex factor.

    Raises:
        InputError: the shapes differ.

    Source: Heylen and Lammens, FRAC: a consistent way of comparing frequency response functions, 1996.
    """
    _frf_pair(model, measured)
    return _assurance(*_products(model, measured))


def csac(model: ComplexArray, measured: ComplexArray) -> FloatArray:
    """Cross signature assurance criterion |Hx^H Ha|^2 / ((Hx^H Hx)(Ha^H Ha)) over the sensors, per frequency.

    Args:
        model: (n_sensors, n_freq) predicted FRFs Ha; two sensors or more say something.
        measured: (n_sensors, n_freq) measured FRFs Hx.

    Returns:
        (n_freq,) values from 0 to 1: is the deflection shape right? A common complex factor does not matter.

    Raises:
        InputError: the shapes differ.

    Source: Grafe, Model updating of large structural dynamics models using measured response functions, 1998, ch. 4.
    """
    _frf_pair(model, measured)
    return _assurance(*_products(model.T, measured.T))


def csf(model: ComplexArray, measured: ComplexArray) -> FloatArray:
    """Cross signature scale factor 2 |Hx^H Ha| / (Hx^H Hx + Ha^H Ha) over the sensors, per frequency.

    Args:
        model: (n_sensors, n_freq) predicted FRFs Ha.
        measured: (n_sensors, n_freq) measured FRFs Hx, in the same unit.

    Returns:
        (n_freq,) values from 0 to 1: is the level right too? 1 only for equal shape and size.

    Raises:
        InputError: the shapes differ.

    Source: Grafe, Model updating of large structural dynamics models using measured response functions, 1998, ch. 4.
    """
    _frf_pair(model, measured)
    return _scale(*_products(model.T, measured.T))


def channel_csac(model: ComplexArray, measured: ComplexArray, *, n_band: int = BAND_LINES) -> FloatArray:
    """The CSAC of each sensor alone: over the lines of a sliding band instead of over sensors, then averaged.

    At one frequency a single sensor's CSAC is 1 whatever the model. So Hx and Ha hold the ``n_band`` neighbouring
    lines of one sensor; the band moves line by line over the whole range, and the mean over its places is returned.
    It sees whether peaks and phase turns stand where they should, and not the level.

    Args:
        model: (n_sensors, n_freq) predicted FRFs on equally spaced lines.
        measured: (n_sensors, n_freq) measured FRFs.
        n_band: lines in the band, from 2 to n_freq.

    Returns:
        (n_sensors,) values from 0 to 1.

    Raises:
        InputError: the shapes differ, or the band does not fit.

    Source: Grafe 1998, ch. 4, for the criterion; the band is ours.
    """
    return np.asarray(_assurance(*_products(*_bands(model, measured, n_band))).mean(axis=-1))


def channel_csf(model: ComplexArray, measured: ComplexArray, *, n_band: int = BAND_LINES) -> FloatArray:
    """The CSF of each sensor alone: over the lines of a sliding band instead of over sensors, then averaged.

    Args:
        model: (n_sensors, n_freq) predicted FRFs on equally spaced lines.
        measured: (n_sensors, n_freq) measured FRFs, in the same unit.
        n_band: lines in the band (see ``channel_csac``), from 2 to n_freq.

    Returns:
        (n_sensors,) values from 0 to 1; unlike ``channel_csac`` it sees the level too.

    Raises:
        InputError: the shapes differ, or the band does not fit.

    Source: Grafe 1998, ch. 4, for the criterion; the band is ours.
    """
    return np.asarray(_scale(*_products(*_bands(model, measured, n_band))).mean(axis=-1))


def mac(model: AnyArray, measured: AnyArray) -> FloatArray:
    """Modal assurance criterion |phi_a^H phi_x|^2 / ((phi_a^H phi_a)(phi_x^H phi_x)) of every pair of mode shapes.

    Args:
        model: (n_model, n_sensors) real or complex shapes, any scale.
        measured: (n_measured, n_sensors) shapes at the same sensors.

    Returns:
        (n_model, n_measured) values from 0 to 1.

    Raises:
        InputError: the shapes are not at the same sensors.

    Source: Allemang and Brown, A correlation coefficient for modal vector analysis, IMAC 1, 1982.
    """
    if model.ndim != 2 or measured.ndim != 2 or model.shape[1] != measured.shape[1]:
        raise InputError(
            f"mode shapes of size {model.shape} and {measured.shape}",
            "both are (modes, sensors) with the same sensors",
            "keep the sensors that both have, in one order",
        )
    a, x = model[:, np.newaxis, :], measured[np.newaxis, :, :]
    return _assurance(*_products(*np.broadcast_arrays(a, x)))


def _products(model: AnyArray, measured: AnyArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """|Hx^H Ha|, Ha^H Ha and Hx^H Hx over the last axis, summed alike so that equal inputs give equal numbers."""
    cross = np.abs((measured.conj() * model).sum(axis=-1))
    return cross, (model.conj() * model).sum(axis=-1).real, (measured.conj() * measured).sum(axis=-1).real


def _assurance(cross: FloatArray, model: FloatArray, measured: FloatArray) -> FloatArray:
    """The squared cosine; two factors, since the product of two small energies could underflow."""
    return np.asarray(np.minimum(_ratio(cross, model, measured) * _ratio(cross, measured, model), 1.0))


def _scale(cross: FloatArray, model: FloatArray, measured: FloatArray) -> FloatArray:
    total = model + measured
    return np.asarray(np.minimum(_ratio(2.0 * cross, total, total), 1.0))


def _ratio(top: FloatArray, bottom: FloatArray, other: FloatArray) -> FloatArray:
    """top / bottom; nothing against nothing agrees (1), nothing against something does not (0)."""
    nothing = np.where(other == 0.0, 1.0, 0.0)
    ratio: FloatArray = np.divide(top, bottom, out=nothing, where=bottom > 0.0)
    return ratio


def _bands(model: ComplexArray, measured: ComplexArray, n_band: int) -> tuple[ComplexArray, ComplexArray]:
    _frf_pair(model, measured)
    if not 2 <= n_band <= model.shape[1]:
        raise InputError(
            f"n_band = {n_band} of {model.shape[1]} frequency lines",
            "the sliding band holds from 2 to all lines",
            "choose a narrower band or a finer resolution",
        )
    return (
        np.lib.stride_tricks.sliding_window_view(model, n_band, axis=1),
        np.lib.stride_tricks.sliding_window_view(measured, n_band, axis=1),
    )


def _same_shape(model: AnyArray, measured: AnyArray) -> None:
    if model.shape != measured.shape:
        raise InputError(
            f"a model of size {model.shape} and a measurement of size {measured.shape}",
            "both have the same channels and samples or lines",
            "evaluate the model on the measurement's own time base or frequencies",
        )


def _frf_pair(model: AnyArray, measured: AnyArray) -> None:
    _same_shape(model, measured)
    if model.ndim != 2 or model.size == 0:
        raise InputError(
            f"FRFs of size {model.shape}",
            "FRFs are (sensors, frequencies) with at least one of each",
            "for a single sensor pass frf[np.newaxis, :]",
        )
