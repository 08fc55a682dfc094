"""The Cramer-Rao bound: the least variance that any unbiased estimator of a decay's numbers can have.

For white Gaussian noise of variance s^2 the information about numbers p is sum_n (dx_n / dp)(dx_n / dp)' / s^2.
docs/theory.md, section 11.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from identification.decay.poles import Poles, pole_covariance
from models.arrays import ComplexArray, FloatArray

DRAWS = 4000
"""Of errors with the bound's covariance, over which the floor of an rms error is averaged."""


@dataclass(frozen=True, eq=False)
class Form:
    """A decay rate of a known form, sigma(t; p), 1/s.

    Attributes:
        rate: (n_params,) p and (N,) s -> (N,) sigma.
        loss: the same -> (N,) its integral from 0, Np.
        gradient: the same -> (n_params, N) of the integral over p.
        values: (n_params,) p.
    """

    rate: Callable[[FloatArray, FloatArray], FloatArray]
    loss: Callable[[FloatArray, FloatArray], FloatArray]
    gradient: Callable[[FloatArray, FloatArray], FloatArray]
    values: FloatArray


def straight(start: float, slope: float) -> Form:
    """Sigma(t) = start + slope t, 1/s and 1/s^2."""
    return Form(
        rate=lambda p, t: p[0] + p[1] * t,
        loss=lambda p, t: p[0] * t + 0.5 * p[1] * t**2,
        gradient=lambda p, t: np.stack([t, 0.5 * t**2]),  # noqa: ARG005
        values=np.array([start, slope]),
    )


def stepped(before: float, after: float, time: float) -> Form:
    """Sigma(t) = before until a time, s, and after from then on, 1/s."""
    return Form(
        rate=lambda p, t: np.where(t <= p[2], p[0], p[1]),
        loss=lambda p, t: p[0] * np.minimum(t, p[2]) + p[1] * np.maximum(t - p[2], 0.0),
        gradient=lambda p, t: np.stack(
            [np.minimum(t, p[2]), np.maximum(t - p[2], 0.0), np.where(t > p[2], p[0] - p[1], 0.0)]
        ),
        values=np.array([before, after, time]),
    )


@dataclass(frozen=True, eq=False)
class Floor:
    """What cannot be undercut in the mean.

    Attributes:
        covariance: (n_params, n_params) of the form's numbers.
        rms: root of the mean square error of sigma, over time and records, 1/s.
        mean_rms: mean over records of the rms error along a record, 1/s; less than ``rms`` where records differ.
    """

    covariance: FloatArray
    rms: float
    mean_rms: float


def decay_floor(form: Form, *, omega: float, phase: float, snr_db: float, fs: float, n_samples: int) -> Floor:
    """The bound for one mode exp(-integral of sigma) cos(omega t + phase) whose damping has a known form.

    Amplitude, phase and frequency are unknown as well. A jump's time is a number like the others here; its likelihood
    has the corner that the signal has, so the bound on it is that of large samples.

    Args:
        form: of sigma, with its true numbers.
        omega: rad/s.
        phase: rad.
        snr_db: mean power of the signal over that of the noise, dB.
        fs: Hz.
        n_samples: of the record.

    Source: Kay, Fundamentals of Statistical Signal Processing: Estimation Theory, 1993, section 3.9.
    """
    t = np.arange(n_samples) / fs
    wave = np.exp(-form.loss(form.values, t) + 1j * (omega * t + phase))
    gradient = form.gradient(form.values, t)
    columns = np.vstack([wave.real, -wave.imag, -t * wave.imag, -gradient * wave.real])
    variance = float(np.mean(wave.real**2)) * 10.0 ** (-snr_db / 10.0)
    covariance = information_inverse(columns, variance)[3:, 3:]
    errors = np.random.default_rng(0).multivariate_normal(np.zeros(len(form.values)), covariance, DRAWS, method="svd")
    coarse = np.linspace(0.0, n_samples / fs, 4 * DRAWS)
    truth = form.rate(form.values, coarse)
    squares = [np.mean((form.rate(form.values + error, coarse) - truth) ** 2) for error in errors]
    return Floor(covariance, float(np.sqrt(np.mean(squares))), float(np.mean(np.sqrt(squares))))


def information_inverse(columns: FloatArray, variance: float) -> FloatArray:
    """(n, n) bound on the covariance of n numbers.

    Args:
        columns: (n, N) derivatives of the signal.
        variance: of white noise.
    """
    scale = 1.0 / np.linalg.norm(columns, axis=1)
    information = (columns * scale[:, None]) @ (columns * scale[:, None]).T / variance
    return np.asarray(np.linalg.inv(information) * np.outer(scale, scale))


def poles_bound(values: ComplexArray, shapes: ComplexArray, noise: FloatArray, *, fs: float, n_samples: int) -> Poles:
    """Modes that stay, with the least covariance that their poles can be estimated with.

    Args:
        values: (n_modes,) poles, 1/s.
        shapes: (n_modes, n_channels) complex amplitudes at the first sample.
        noise: (n_channels,) standard deviation.
        fs: Hz.
        n_samples: of the record.
    """
    return Poles(values, shapes, pole_covariance(values, shapes, noise, fs, n_samples), noise)
