import numpy as np
import pytest

from identification.decay.walk import Freedom, Jumps, Points, evidence, evidence_with_jump, smoothed

GAUSS = np.polynomial.legendre.leggauss(6)
"""Exact for the integrands, which are polynomials of degree 4."""

NONE = Jumps(np.empty(0), np.empty(0))


def points_on(levels, std, n=60, duration=6.0, seed=0):
    """Blocks of equal length whose levels are those of a function at their centres, with noise."""
    edges = np.linspace(0.0, duration, n + 1)
    times = 0.5 * (edges[1:] + edges[:-1])
    noise = std * np.random.default_rng(seed).standard_normal(n)
    return Points(edges, times, levels(times) + noise, np.full(n, std**2))


def dense(points, free, jumps):
    """Mean, covariance of the states and log-evidence from the joint normal law of everything, without a recursion."""
    t = points.times
    n = len(t)
    # prior covariance of the states, from the first point's level on
    K = np.zeros((n, 3, n, 3))
    start = np.diag([points.variances[0], free.rate, free.slope])
    F = [np.array([[1, h, h * h / 2], [0, 1, h], [0, 0, 1]]) for h in t - t[0]]
    for i in range(n):
        for j in range(n):
            K[i, :, j, :] = F[i] @ start @ F[j].T
            half = 0.5 * (min(t[i], t[j]) - t[0])
            s, w = t[0] + half * (GAUSS[0] + 1.0), half * GAUSS[1]
            for power, noise in ((1, free.wander), (2, free.bend)):
                if noise and min(i, j) > 0:
                    last = np.full_like(s, power - 1.0)
                    a, b = (np.stack([(t[k] - s) ** power / power, (t[k] - s) ** (power - 1), last]) for k in (i, j))
                    K[i, :, j, :] += noise * (a * w) @ b.T
    K = K.reshape(3 * n, 3 * n)
    H = np.zeros((n, 3 * n))
    H[np.arange(n), 3 * np.arange(n)] = 1.0
    for time, kick in zip(*jumps, strict=True):
        own = np.searchsorted(points.edges, time, side="right") - 1
        e = np.zeros((n, 3))
        e[own:, 0], e[own:, 1] = t[own:] - time + kick, 1.0
        K = K + free.jump * np.outer(e.ravel(), e.ravel())
        fine = np.linspace(points.edges[own], points.edges[own + 1], 20001)
        mean = np.mean(np.where(fine > time, fine - time + kick, 0.0))
        # the block's mean sees the jump itself, so it enters as one more unknown
        return K, H, e, mean - e[own, 0], own
    return K, H, None, 0.0, 0


def conditioned(points, free, jumps):
    K, H, e, beside, own = dense(points, free, jumps)
    n = len(points.times)
    S = H @ K @ H.T
    cross = K @ H.T
    if e is not None:
        extra = np.zeros(n)
        extra[own] = beside
        seen = H @ e.ravel()
        S += free.jump * (np.outer(seen, extra) + np.outer(extra, seen) + np.outer(extra, extra))
        cross = cross + free.jump * np.outer(e.ravel(), extra)
    # the first point is exact knowledge of its level up to its variance, which the start already holds
    rest = slice(1, n)
    S, cross = S[rest, rest] + np.diag(points.variances[rest]), cross[:, rest]
    fault = points.levels[rest] - points.levels[0]
    states = (cross @ np.linalg.solve(S, fault)).reshape(n, 3)
    states[:, 0] += points.levels[0]
    covariance = (K - cross @ np.linalg.solve(S, cross.T)).reshape(n, 3, n, 3)
    log = -0.5 * (fault @ np.linalg.solve(S, fault) + np.linalg.slogdet(2.0 * np.pi * S)[1])
    return states, np.stack([covariance[i, :, i, :] for i in range(n)]), log


@pytest.mark.parametrize(
    ("free", "jumps"),
    [
        (Freedom(1.0, 0.0, 0.0, 0.0, 0.0), NONE),
        (Freedom(1.0, 0.5, 0.0, 0.0, 0.0), NONE),
        (Freedom(1.0, 0.0, 0.3, 0.0, 0.0), NONE),
        (Freedom(1.0, 0.5, 0.0, 0.2, 0.0), NONE),
        (Freedom(1.0, 0.0, 0.0, 0.0, 0.7), Jumps(np.array([2.03]), np.array([0.02]))),
        (Freedom(1.0, 0.0, 0.1, 0.0, 0.7), Jumps(np.array([2.97]), np.array([-0.05]))),
    ],
    ids=["constant", "line", "wandering", "bending", "jump", "jump and wandering"],
)
def test_the_recursion_is_the_joint_normal_law(free, jumps):
    points = points_on(np.sin, 0.05, n=24)
    states, covariances, log = conditioned(points, free, jumps)
    found, spread = smoothed(points, free, jumps)
    # round-off of the dense law, whose matrices have conditions up to 1e8; the block's mean is a sum of 20,000 pieces
    assert found == pytest.approx(states, rel=1e-6, abs=1e-6)
    assert spread == pytest.approx(covariances, rel=1e-4, abs=1e-7)
    assert evidence(points, free, jumps) == pytest.approx(log, abs=1e-4)


def test_a_jump_tried_elsewhere_is_a_jump_given():
    points = points_on(lambda t: np.maximum(t - 3.0, 0.0), 0.01)
    free = Freedom(1.0, 0.0, 0.0, 0.0, 1.0)
    places, kicks = np.array([1.0, 2.9, 3.1]), np.array([0.0, 0.01, -0.01])
    together = evidence_with_jump(points, free, NONE, places, kicks)
    one_by_one = [evidence(points, free, Jumps(places[i : i + 1], kicks[i : i + 1])) for i in range(3)]
    assert together == pytest.approx(one_by_one, rel=1e-12)


def test_the_evidence_is_highest_where_the_rate_jumps():
    points = points_on(lambda t: np.maximum(t - 3.02, 0.0), 1e-3)
    free = Freedom(1.0, 0.0, 0.0, 0.0, 1.0)
    places = np.linspace(2.8, 3.2, 401)
    best = places[np.argmax(evidence_with_jump(points, free, NONE, places, np.zeros_like(places)))]
    # block means of the kinked level: the line after the jump is known to std sqrt(4 / 30) 1e-3
    assert best == pytest.approx(3.02, abs=3e-3)


def test_an_exact_line_is_followed_exactly():
    points = points_on(lambda t: 2.0 - 0.3 * t, 0.0)._replace(variances=np.full(60, 1e-8))
    states, _ = smoothed(points, Freedom(1.0, 0.0, 0.0, 0.0, 0.0), NONE)
    # the prior of the rate, variance 1, pulls by about 1e-8 / (sum of squares of the times)
    assert states[:, 1] == pytest.approx(-0.3, abs=1e-8)
