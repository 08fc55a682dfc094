"""The inverse FFT of a spectrum that is zero outside a band, at the full rate of its n samples.

With n = M D, sample D q + r is the M-point inverse transform, at q, of the spectrum turned by r samples and folded onto
M bins. That is exact for every band, and the transforms are short where the band is narrow. ``LANES`` neighbours r run
through each transform side by side, in a block that stays in the processor's own cache and fills its vector units.
"""

from typing import NamedTuple

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.compiled import compiled

LANES = 16
"""Neighbouring samples that one transform works out side by side."""

FEWEST_TURNS = 8
"""Times at least that the longest transform goes into n."""

SHORTEST = 256
"""Points below which a shorter transform saves nothing."""

POINT, CACHED = 6.0, 2048
"""A point of a transform takes as long as folding this many bins, and one more for each CACHED points around it."""


class Tables(NamedTuple):
    """Roots of unity for transforms of M points into n samples, as (2, ...) real and imaginary parts.

    Attributes:
        inner: (2, M) exp(2 pi j k / M).
        turn: (2, n) exp(2 pi j k / n).
        lanes: (2, M, LANES) exp(2 pi j k r / n).
    """

    inner: FloatArray
    turn: FloatArray
    lanes: FloatArray


def n_samples(least: int) -> int:
    """A number of samples n, ``least`` or a little more, that transforms of many lengths divide."""
    longest = _longest(least)
    return -(-least // longest) * longest


def transform_length(n: int, n_bins: int) -> int:
    """The length M that is fastest for a band of ``n_bins``; n comes from ``n_samples``."""
    longest = _longest(n)
    lengths = [longest]
    while lengths[-1] > SHORTEST:
        lengths.append(lengths[-1] // 2)
    return min(lengths, key=lambda M: -(-(n // M) // LANES) * (M * (POINT + M / CACHED) + n_bins))


def _longest(n: int) -> int:
    return 1 << max((n // FEWEST_TURNS).bit_length() - 1, 0)


def tables(n: int, length: int) -> Tables:
    """What transforms of ``length`` points into n samples need."""
    turn = np.exp(2j * np.pi * np.arange(n) / n)
    lanes = turn[np.outer(np.arange(length), np.arange(LANES)) % n]
    return Tables(*(np.stack((each.real, each.imag)) for each in (turn[:: n // length], turn, lanes)))


def workspace(n: int) -> FloatArray:
    """What ``inverse_of_band`` works in, whichever length of transform it is given; one for each thread."""
    return np.empty((4, _longest(n) * LANES))


@compiled
def inverse_of_band(
    spectrum: ComplexArray, gains: FloatArray, first: int, by: Tables, work: FloatArray, out: ComplexArray
) -> None:
    """Fill ``out`` with sum_k X_k gains_k exp(2 pi j k t / n), t = 0, 1, ...: no factor 1 / n.

    Args:
        spectrum: (n // 2 + 1,) of a real signal of n samples; its other bins follow from them.
        gains: (n_bins,) of the bins first, first + 1, ..., which may lie below 0 or above n / 2.
        first: the band's first bin.
        by: tables for n.
        work: from ``workspace``.
        out: (N,) filled; N is at most n.

    Source: Stockham's order: van Loan, Computational Frameworks for the Fast Fourier Transform, 1992, section 1.7.
    """
    M, n = by.inner.shape[1], by.turn.shape[1]
    band = np.empty((2, gains.shape[0]))
    for i in range(gains.shape[0]):
        k = (first + i) % n
        value = spectrum[k] if 2 * k <= n else spectrum[n - k].conjugate()
        band[0, i], band[1, i] = gains[i] * value.real, gains[i] * value.imag
    turned, size = np.empty_like(band), M * LANES
    re, im, re2, im2 = work[0, :size], work[1, :size], work[2, :size], work[3, :size]
    for r in range(0, n // M, LANES):
        fold(band, first, r, by, turned, re, im)
        points, stride = M, LANES
        while points > 1:
            if points >= 4:
                quarter(re, im, re2, im2, points, stride, by.inner)
                points, stride = points // 4, stride * 4
            else:
                halve(re, re2, stride)
                halve(im, im2, stride)
                points, stride = points // 2, stride * 2
            re, im, re2, im2 = re2, im2, re, im
        put(re, im, r, n // M, out)


@compiled
def fold(band: FloatArray, first: int, r: int, by: Tables, turned: FloatArray, re: FloatArray, im: FloatArray) -> None:
    """Fill ``re`` and ``im`` (M LANES,) with the band turned by r, r + 1, ... samples, its bins taken modulo M.

    Args:
        band: (2, n_bins) real and imaginary parts.
        first: the band's first bin.
        r: first lane's sample.
        by: tables.
        turned: (2, n_bins) to work in.
        re: filled.
        im: filled.
    """
    M, n = by.inner.shape[1], by.turn.shape[1]
    end, row = first + band.shape[1], first % M
    k = row * r % n
    for i in range(band.shape[1]):
        c, s = by.turn[0, k], by.turn[1, k]
        turned[0, i], turned[1, i] = band[0, i] * c - band[1, i] * s, band[0, i] * s + band[1, i] * c
        row, k = row + 1, k + r
        if k >= n:
            k -= n
        if row == M:
            row, k = 0, 0
    re[:], im[:] = 0.0, 0.0
    cos, sin = np.empty(LANES), np.empty(LANES)
    for turn in range(first // M, (end - 1) // M + 1):
        for l in range(LANES):
            k = turn * (r + l) % (n // M) * M
            cos[l], sin[l] = by.turn[0, k], by.turn[1, k]
        for i in range(max(first, turn * M), min(end, (turn + 1) * M)):
            a, b, at = turned[0, i - first], turned[1, i - first], (i - turn * M) * LANES
            x, y = leg(re, at, LANES), leg(im, at, LANES)
            for l in range(LANES):
                x[l] += a * cos[l] - b * sin[l]
                y[l] += a * sin[l] + b * cos[l]
    lane_cos, lane_sin = by.lanes[0].ravel(), by.lanes[1].ravel()
    for i in range(M * LANES):
        x_i, y_i = re[i], im[i]
        re[i], im[i] = x_i * lane_cos[i] - y_i * lane_sin[i], x_i * lane_sin[i] + y_i * lane_cos[i]


@compiled
def quarter(
    re: FloatArray, im: FloatArray, re2: FloatArray, im2: FloatArray, size: int, stride: int, inner: FloatArray
) -> None:
    """A pass of radix 4 from (re, im) to (re2, im2): transforms of ``size`` points become four of a quarter each."""
    h, step = size // 4, inner.shape[1] // size
    for p in range(h):
        k, i, o = p * step, p * stride, 4 * p * stride
        c1, c2, c3 = inner[0, k], inner[0, 2 * k], inner[0, 3 * k]
        s1, s2, s3 = inner[1, k], inner[1, 2 * k], inner[1, 3 * k]
        ar, ai = leg(re, i, stride), leg(im, i, stride)
        br, bi = leg(re, i + h * stride, stride), leg(im, i + h * stride, stride)
        cr, ci = leg(re, i + 2 * h * stride, stride), leg(im, i + 2 * h * stride, stride)
        dr, di = leg(re, i + 3 * h * stride, stride), leg(im, i + 3 * h * stride, stride)
        er, ei = leg(re2, o, stride), leg(im2, o, stride)
        fr, fi = leg(re2, o + stride, stride), leg(im2, o + stride, stride)
        gr, gi = leg(re2, o + 2 * stride, stride), leg(im2, o + 2 * stride, stride)
        hr, hi = leg(re2, o + 3 * stride, stride), leg(im2, o + 3 * stride, stride)
        for l in range(stride):
            ur, ui, vr, vi = ar[l] + cr[l], ai[l] + ci[l], ar[l] - cr[l], ai[l] - ci[l]
            xr, xi, yr, yi = br[l] + dr[l], bi[l] + di[l], br[l] - dr[l], bi[l] - di[l]
            er[l], ei[l] = ur + xr, ui + xi
            fr[l], fi[l] = (vr - yi) * c1 - (vi + yr) * s1, (vr - yi) * s1 + (vi + yr) * c1
            gr[l], gi[l] = (ur - xr) * c2 - (ui - xi) * s2, (ur - xr) * s2 + (ui - xi) * c2
            hr[l], hi[l] = (vr + yi) * c3 - (vi - yr) * s3, (vr + yi) * s3 + (vi - yr) * c3


@compiled
def halve(x: FloatArray, x2: FloatArray, stride: int) -> None:
    """The last pass where M is no power of 4, on real or imaginary parts: transforms of 2 points."""
    a, b, c, d = leg(x, 0, stride), leg(x, stride, stride), leg(x2, 0, stride), leg(x2, stride, stride)
    for l in range(stride):
        c[l], d[l] = a[l] + b[l], a[l] - b[l]


@compiled
def put(re: FloatArray, im: FloatArray, r: int, D: int, out: ComplexArray) -> None:
    """Write the samples D q + r, D q + r + 1, ... of all q to their places."""
    for q in range(re.shape[0] // LANES):
        start, at = D * q + r, q * LANES
        room = min(LANES, D - r, out.shape[0] - start)
        if room == LANES:  # a loop of known length becomes vector instructions
            for l in range(LANES):
                out[start + l] = complex(re[at + l], im[at + l])
        else:
            for l in range(room):
                out[start + l] = complex(re[at + l], im[at + l])


@compiled
def leg(x: FloatArray, start: int, size: int) -> FloatArray:
    """A view of ``size`` numbers."""
    return x[start : start + size]
