"""The article's verification: an oscillator in free decay whose damping steps or drifts, and which is known exactly."""

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np

from models.arrays import FloatArray
from models.errors import InputError

MASS, STIFFNESS = 5.0, 800.0
"""kg and N/m. Source: section 3.3 of the article, where the stiffness is given in m/N."""

OMEGA = float(np.sqrt(STIFFNESS / MASS))
"""rad/s."""

SAMPLING_RATE, DURATION = 256.0, 100.0
"""Hz and s. The article's scale of 2^6.68 samples is one of some seconds at this rate; it gives none itself."""

START = (1.0, 0.0)
"""Displacement in m and velocity in m/s."""

TERMS = 14
"""Of the power series over one sample; omega / fs is 0.05, so the next would be far below round-off."""


class Piece(NamedTuple):
    """A stretch of time in which the damping is a straight line.

    Attributes:
        start: s, the time of a sample.
        damping: at the start, N s/m.
        slope: N/m.
    """

    start: float
    damping: float
    slope: float


CASES = {
    "step": (Piece(0.0, 0.06, 0.0), Piece(50.0, 0.01, 0.0)),
    "line": (Piece(0.0, 0.06, -0.0002),),
}
"""c(t) = 0.06, from 50 s on 0.01 N s/m; c(t) = 0.06 - 0.0002 t. Source: section 3.3 of the article."""


@dataclass(frozen=True, eq=False)
class KnownDecay:
    """A free decay with its damping.

    Attributes:
        time: (N,) s.
        signal: (N,) displacement, m.
        damping: (N,) c, N s/m; at a jump, what it was before.
    """

    time: FloatArray
    signal: FloatArray
    damping: FloatArray


@cache
def verification_decay(case: str) -> KnownDecay:
    """The decay of a case.

    Args:
        case: a name in ``CASES``.

    Raises:
        InputError: another name.
    """
    if case not in CASES:
        raise InputError(f"case {case!r}", f"the verification has {' and '.join(CASES)}", "choose one of them")
    return known_decay(CASES[case])


def known_decay(pieces: tuple[Piece, ...]) -> KnownDecay:
    """The free decay of the oscillator with a damping in pieces, exact to rounding.

    From sample to sample the motion is a power series, whose coefficients follow from m x'' + c(t) x' + k x = 0 with c
    a straight line: (i + 2) (i + 1) a_(i+2) = -((i + 1) c a_(i+1) + (i c' + k) a_i) / m.

    Args:
        pieces: in order of time, the first from 0 on.
    """
    time = np.arange(round(DURATION * SAMPLING_RATE)) / SAMPLING_RATE
    number = np.searchsorted([piece.start for piece in pieces], time, side="right") - 1
    start, damping, slope = np.array(pieces)[number].T
    ahead = damping + slope * (time - start)
    h, last = 1.0 / SAMPLING_RATE, np.zeros((2, 2, len(time)))
    last[0, 0] = last[1, 1] = 1.0  # from displacement and velocity, the second index, to the series' first terms
    terms = [last[0], last[1]]
    for i in range(TERMS):
        terms.append(
            -((i + 1) * ahead * terms[i + 1] + (i * slope + STIFFNESS) * terms[i]) / (MASS * (i + 2) * (i + 1))
        )
    steps = np.stack(
        (
            sum(term * h**i for i, term in enumerate(terms)),
            sum(i * term * h ** (i - 1) for i, term in enumerate(terms) if i > 0),
        )
    )
    states = np.empty((len(time), 2))
    states[0] = START
    for i in range(len(time) - 1):
        states[i + 1] = steps[:, :, i] @ states[i]
    behind = np.append(damping[0], ahead[:-1] + h * slope[:-1])
    decay = KnownDecay(time, states[:, 0].copy(), behind)
    for array in (decay.time, decay.signal, decay.damping):
        array.setflags(write=False)
    return decay


def noisy(signal: FloatArray, snr_db: float, seed: int) -> FloatArray:
    """A signal under white noise.

    Args:
        signal: (N,).
        snr_db: rms of the signal over that of the noise, dB.
        seed: of the noise.
    """
    rms = float(np.sqrt(np.mean(signal**2))) * 10.0 ** (-snr_db / 20.0)
    return np.asarray(signal + rms * np.random.default_rng(seed).standard_normal(signal.size))
