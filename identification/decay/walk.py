"""One level along a record and the rate at which it runs: state space, filter and smoother.

The level (a log-amplitude or a phase) is observed as its mean over blocks, with known variances. Its rate may stay, run
straight, wander (a random walk), bend (a random walk of its slope) or jump at stated times. All of that is one linear
Gaussian model with the state (level, rate, slope of the rate), so its evidence and its smoothed state are exact.
docs/theory.md, section 10.
"""

from math import log, pi
from typing import NamedTuple

import numpy as np

from models.arrays import FloatArray
from models.compiled import compiled


class Points(NamedTuple):
    """Observed levels.

    Attributes:
        edges: (n + 1,) s, where the blocks begin, and where the last one ends.
        times: (n,) s, their centres.
        levels: (n,) means of the level over each block, Np or rad.
        variances: (n,) of the levels' errors, which are independent.
    """

    edges: FloatArray
    times: FloatArray
    levels: FloatArray
    variances: FloatArray


class Freedom(NamedTuple):
    """What the rate is free to do, as variances; 0 where it is not.

    Attributes:
        rate: of the rate at the start, 1/s^2.
        slope: of its slope at the start, 1/s^4.
        wander: of a random walk of the rate, per second, 1/s^3.
        bend: of a random walk of its slope, per second, 1/s^5.
        jump: of each jump of the rate, 1/s^2.
    """

    rate: float
    slope: float
    wander: float
    bend: float
    jump: float


class Jumps(NamedTuple):
    """Where the rate jumps.

    Attributes:
        times: (n,) s, growing.
        kicks: (n,) s, what the level jumps by for a unit jump of the rate: see ``kick_of``.
    """

    times: FloatArray
    kicks: FloatArray


@compiled
def advance(k: int, points: Points, free: Freedom, jumps: Jumps, Q: FloatArray, shared: FloatArray) -> None:
    """What the way from point k - 1 to point k adds to the state's covariance, and to what is observed there.

    A jump belongs to the block in which it lies, and the state at that block's centre is the line after the jump, drawn
    back if the jump comes later; the block's mean then differs from the state's level in proportion to the jump.

    Args:
        k: number of the point.
        points: observed.
        free: variances.
        jumps: where the rate jumps.
        Q: (3, 3) filled with the covariance of the state's noise.
        shared: (4,) filled with its covariance with the mean's, and the variance of the mean's.
    """
    h = points.times[k] - points.times[k - 1]
    w, b = free.wander, free.bend
    Q[0, 0] = w * h**3 / 3.0 + b * h**5 / 20.0
    Q[0, 1] = w * h * h / 2.0 + b * h**4 / 8.0
    Q[1, 1] = w * h + b * h**3 / 3.0
    Q[0, 2], Q[1, 2], Q[2, 2] = b * h**3 / 6.0, b * h * h / 2.0, b * h
    shared[:] = 0.0
    start, end = points.edges[k], points.edges[k + 1]
    for m in range(jumps.times.shape[0]):
        if start <= jumps.times[m] < end:
            level = points.times[k] - jumps.times[m] + jumps.kicks[m]
            after = end - jumps.times[m]
            beside = after * (0.5 * after + jumps.kicks[m]) / (end - start) - level
            Q[0, 0] += free.jump * level * level
            Q[0, 1] += free.jump * level
            Q[1, 1] += free.jump
            shared[0] += free.jump * level * beside
            shared[1] += free.jump * beside
            shared[3] += free.jump * beside * beside
    Q[1, 0], Q[2, 0], Q[2, 1] = Q[0, 1], Q[0, 2], Q[1, 2]


@compiled
def moved(h: float, P: FloatArray, Q: FloatArray, new: FloatArray) -> None:
    """Fill ``new`` (3, 3) with F P F' + Q, F being the transition over a time h."""
    g = 0.5 * h * h
    for j in range(3):
        new[0, j] = P[0, j] + h * P[1, j] + g * P[2, j]
        new[1, j] = P[1, j] + h * P[2, j]
        new[2, j] = P[2, j]
    for i in range(3):
        a, b, c = new[i, 0], new[i, 1], new[i, 2]
        new[i, 0] = a + h * b + g * c + Q[i, 0]
        new[i, 1] = b + h * c + Q[i, 1]
        new[i, 2] = c + Q[i, 2]


@compiled
def filtered(
    points: Points, free: Freedom, jumps: Jumps, x: FloatArray, P: FloatArray, errors: FloatArray, gains: FloatArray
) -> float:
    """Kalman's filter from the first point on; returns the log-evidence of the others.

    Args:
        points: (n,) observed.
        free: variances.
        jumps: where the rate jumps.
        x: (n, 3) filled with the filtered states.
        P: (n, 3, 3) filled with their covariances.
        errors: (n, 2) filled with what was not foreseen at each point, and its variance.
        gains: (n, 3) filled with what the state takes of it.

    Source: Kalman, J. Basic Eng. 82 (1960) 35; evidence: Schweppe, IEEE Trans. Inf. Theory 11 (1965) 61.
    """
    t, y, r = points.times, points.levels, points.variances
    Q, spread, shared = np.zeros((3, 3)), np.zeros((3, 3)), np.zeros(4)
    x[0, 0], x[0, 1], x[0, 2] = y[0], 0.0, 0.0
    P[0] = 0.0
    P[0, 0, 0], P[0, 1, 1], P[0, 2, 2] = r[0], free.rate, free.slope
    total = 0.0
    for k in range(1, t.shape[0]):
        h = t[k] - t[k - 1]
        advance(k, points, free, jumps, Q, shared)
        moved(h, P[k - 1], Q, spread)
        x[k, 0] = x[k - 1, 0] + h * x[k - 1, 1] + 0.5 * h * h * x[k - 1, 2]
        x[k, 1] = x[k - 1, 1] + h * x[k - 1, 2]
        x[k, 2] = x[k - 1, 2]
        error, variance = y[k] - x[k, 0], spread[0, 0] + 2.0 * shared[0] + shared[3] + r[k]
        errors[k, 0], errors[k, 1] = error, variance
        total -= 0.5 * (log(2.0 * pi * variance) + error * error / variance)
        for i in range(3):
            gains[k, i] = (spread[i, 0] + shared[i]) / variance
            x[k, i] += gains[k, i] * error
        for i in range(3):
            for j in range(3):
                P[k, i, j] = spread[i, j] - gains[k, i] * gains[k, j] * variance
    return total


@compiled
def evidence(points: Points, free: Freedom, jumps: Jumps) -> float:
    """Log of the probability density of all levels but the first."""
    n = points.times.shape[0]
    x, P, errors, gains = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty((n, 2)), np.empty((n, 3))
    return filtered(points, free, jumps, x, P, errors, gains)


@compiled
def evidence_with_jump(points: Points, free: Freedom, jumps: Jumps, times: FloatArray, kicks: FloatArray) -> FloatArray:
    """(m,) log-evidence with one more jump at each of (m,) times, whose kicks are given."""
    n, m, known = points.times.shape[0], times.shape[0], jumps.times.shape[0]
    x, P, errors, gains = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty((n, 2)), np.empty((n, 3))
    at, by, out = np.empty(known + 1), np.empty(known + 1), np.empty(m)
    at[:known], by[:known] = jumps.times, jumps.kicks
    for i in range(m):
        at[known], by[known] = times[i], kicks[i]
        out[i] = filtered(points, free, Jumps(at, by), x, P, errors, gains)
    return out


@compiled
def smoothed(points: Points, free: Freedom, jumps: Jumps) -> tuple[FloatArray, FloatArray]:
    """(n, 3) states given all points, and (n, 3, 3) their covariances.

    Source: Durbin and Koopman, Time Series Analysis by State Space Methods, 2012, section 4.4.
    """
    t = points.times
    n = t.shape[0]
    x, P, errors, gains = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty((n, 2)), np.empty((n, 3))
    filtered(points, free, jumps, x, P, errors, gains)
    states, covariances = x.copy(), P.copy()
    r, N, A = np.zeros(3), np.zeros((3, 3)), np.zeros((3, 3))
    for k in range(n - 2, -1, -1):
        h, gain = t[k + 1] - t[k], gains[k + 1]
        error, variance = errors[k + 1, 0], errors[k + 1, 1]
        # A = L F, the way of an error in the state at k to the state at k + 1, with L = 1 - gain (1, 0, 0)
        for i in range(3):
            unit = 1.0 if i == 0 else 0.0
            A[i, 0] = unit - gain[i]
            A[i, 1] = h * A[i, 0] + (1.0 if i == 1 else 0.0)
            A[i, 2] = 0.5 * h * h * A[i, 0] + (h if i == 1 else 0.0) + (1.0 if i == 2 else 0.0)
        seen = (1.0, h, 0.5 * h * h)
        carried = product(N, A)
        new = (r[0], r[1], r[2])
        for i in range(3):
            r[i] = seen[i] * error / variance + A[0, i] * new[0] + A[1, i] * new[1] + A[2, i] * new[2]
            for j in range(3):
                N[i, j] = seen[i] * seen[j] / variance
                for m in range(3):
                    N[i, j] += A[m, i] * carried[m, j]
        taken = product(N, P[k])
        for i in range(3):
            for j in range(3):
                states[k, i] += P[k, i, j] * r[j]
                for m in range(3):
                    covariances[k, i, j] -= P[k, i, m] * taken[m, j]
    return states, covariances


@compiled
def product(left: FloatArray, right: FloatArray) -> FloatArray:
    """(3, 3) matrix product, without the call that larger ones are worth."""
    out = np.zeros((3, 3))
    for i in range(3):
        for m in range(3):
            for j in range(3):
                out[i, j] += left[i, m] * right[m, j]
    return out
