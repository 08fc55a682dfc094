"""One mode about each instant: a weighted least-squares fit of an amplitude and its slope to a record that has ends.

About the instant b, with the weight w, tau = t - b, the carrier's phase theta and a rate sigma guessed beforehand, the
record is taken for

    x(t) = Re[(z0 + z1 tau) exp(-sigma tau + j (theta(t) - theta(b)))].

Setting the derivatives of sum w (x - model)^2 to zero gives, for k = 0 and 1,

    2 T_k = sum_l S_(k+l) z_l + R_(k+l) conj z_l,

    T_k = sum w tau^k exp(-sigma tau) x exp(-j (theta(t) - theta(b))),
    S_m = sum w tau^m exp(-2 sigma tau),
    R_m = sum w tau^m exp(-2 sigma tau) exp(-2j (theta(t) - theta(b))),

all of them over the samples that exist; R is the carrier's image at the negative frequency. docs/theory.md tells what
this has to do with the ridge of a wavelet transform, and why it needs no treatment of the ends.
"""

import numpy as np
from scipy.fft import fft, ifft, next_fast_len

from models.arrays import ComplexArray, FloatArray
from models.compiled import compiled

SOLUTION, SUMS = 170.0, 40.0
"""Operations for the carrier and the equations of each sample, and for the powers and sums of each tap."""


def fit_inside(
    signal: FloatArray, step: float | FloatArray, taps: FloatArray, rate: float = 0.0
) -> tuple[ComplexArray, ComplexArray]:
    """Fit with the samples of the record and no others.

    Args:
        signal: (N,).
        step: of the carrier's phase per sample, rad; or (N,), where the carrier's frequency changes.
        taps: (2 K + 1,) even weight of the samples -K to K about each instant.
        rate: sigma, per sample.

    Returns:
        (N,) z0, turned with the carrier; (N,) z1 / z0 - sigma, the logarithmic slope beside the carrier, per sample.
    """
    n, half = len(signal), len(taps) // 2
    carrier, away = np.exp(1j * phase_of(step, n)), np.arange(-half, half + 1)
    T = _moments(signal / carrier, taps * np.exp(-rate * away), 2)
    T *= carrier
    weight = taps * np.exp(-2.0 * rate * away)
    steady = isinstance(step, float)
    # A steady carrier's image is the same about every instant, so that sums over the window's part serve all of them.
    image = _running(weight * np.exp(-2j * step * away)) if steady else _moments(carrier**-2, weight, 3) * carrier**2
    z0, z1 = solved(T, _running(weight).real.copy(), image, steady)
    return z0, z1 / (z0 * half) - rate


def fit_through(
    signal: FloatArray, before: FloatArray, after: FloatArray, step: float | FloatArray, taps: FloatArray
) -> tuple[ComplexArray, ComplexArray]:
    """The ridge of a transform: no image, and all windows full, with what is put before the record and after it.

    Args:
        signal: (N,).
        before: (K,) what is taken for the signal before the record.
        after: (K,) and after it.
        step: see ``fit_inside``.
        taps: see ``fit_inside``.

    Returns:
        (N,) z0 and z1 / z0, as in ``fit_inside``.
    """
    n, half = len(signal), len(taps) // 2
    phase, outside = phase_of(step, n), np.arange(1, half + 1)
    first, last = (step, step) if isinstance(step, float) else (step[0], step[-1])
    longer = np.concatenate((-first * outside[::-1], phase, phase[-1] + last * outside))
    T = _moments(np.concatenate((before, signal, after)) * np.exp(-1j * longer), taps, 2)[:, half : half + n]
    z0, z1 = 2.0 * T[0] / np.sum(taps), 2.0 * T[1] / np.sum(taps * np.linspace(-1.0, 1.0, len(taps)) ** 2)
    return z0 * np.exp(1j * phase), z1 / (z0 * half)


def operations(n_samples: int, n_taps: int) -> float:
    """Additions and multiplications of ``fit_inside`` with a steady carrier, to the leading terms.

    Transforms are charged for the length they need, not for the next fast one, whose steps are not the window's doing.

    Args:
        n_samples: of the signal.
        n_taps: of the window.
    """
    n = n_samples + n_taps // 2
    transforms = (3.0 + 2.0 * 0.5) * 5.0 * n * np.log2(n)  # three complex ones, two of real numbers
    return float(transforms + 2.0 * 6.0 * n + SOLUTION * n_samples + SUMS * n_taps)


def phase_of(step: float | FloatArray, n: int) -> FloatArray:
    """(n,) rad, 0 at the first sample, by the trapezoidal rule where the step changes."""
    if isinstance(step, float):
        return np.asarray(step * np.arange(n))
    return np.append(0.0, np.cumsum(0.5 * (step[1:] + step[:-1])))


def _moments(signal: FloatArray | ComplexArray, taps: FloatArray, count: int) -> ComplexArray:
    """(count, N) sums of w u^k times the samples about each instant, u running from -1 to 1 across the window."""
    half = len(taps) // 2
    n = next_fast_len(len(signal) + half)
    spectrum, kernel = fft(signal, n), np.zeros(n)
    out = np.empty((count, len(signal)), dtype=complex)
    for k in range(count):
        weights = taps * np.linspace(-1.0, 1.0, len(taps)) ** k
        kernel[: half + 1], kernel[n - half :] = weights[half:], weights[:half]
        out[k] = ifft(spectrum * fft(kernel).conj(), overwrite_x=True)[: len(signal)]
    return out


def _running(taps: FloatArray | ComplexArray) -> ComplexArray:
    """(3, 2 K + 2) sums of w u^m over all taps before each."""
    away = np.linspace(-1.0, 1.0, len(taps))
    return np.cumsum(np.stack([np.append(0.0, taps * away**m) for m in range(3)]), axis=1, dtype=complex)


@compiled
def solved(T: ComplexArray, S: FloatArray, R: ComplexArray, steady: bool) -> tuple[ComplexArray, ComplexArray]:  # noqa: FBT001
    """(N,) z0 and z1 of the normal equations, in blocks of 2 x 2 for their real and imaginary parts.

    Args:
        T: (2, N).
        S: (3, 2 K + 2) running sums over the window.
        R: (3, 2 K + 2) the same, or (3, N) its values.
        steady: which of the two.
    """
    n, width = T.shape[1], S.shape[1] - 1
    z0, z1 = np.empty(n, dtype=np.complex128), np.empty(n, dtype=np.complex128)
    for i in range(n):
        start, stop = max(width // 2 - i, 0), min(width // 2 + n - i, width)
        s0, s1, s2 = S[0, stop] - S[0, start], S[1, stop] - S[1, start], S[2, stop] - S[2, start]
        if steady:
            r0, r1, r2 = R[0, stop] - R[0, start], R[1, stop] - R[1, start], R[2, stop] - R[2, start]
        else:
            r0, r1, r2 = R[0, i], R[1, i], R[2, i]
        a, b, c = s0 + r0.real, r0.imag, s0 - r0.real
        d, e, f = s1 + r1.real, r1.imag, s1 - r1.real
        g, h, k = s2 + r2.real, r2.imag, s2 - r2.real
        p, q, r, s = 2.0 * T[0, i].real, 2.0 * T[0, i].imag, 2.0 * T[1, i].real, 2.0 * T[1, i].imag
        det = a * c - b * b
        # (m o, u v) = (d e, e f) (a b, b c)^-1 takes z0 out of the second pair of equations
        m, o, u, v = (d * c - e * b) / det, (e * a - d * b) / det, (e * c - f * b) / det, (f * a - e * b) / det
        g, h, k = g - m * d - o * e, h - m * e - o * f, k - u * e - v * f
        r, s = r - m * p - o * q, s - u * p - v * q
        rest = g * k - h * h
        x, y = (k * r - h * s) / rest, (g * s - h * r) / rest
        p, q = p - d * x - e * y, q - e * x - f * y
        z0[i], z1[i] = complex((c * p - b * q) / det, (a * q - b * p) / det), complex(x, y)
    return z0, z1
