"""Whether a mode was followed for long enough to be told, and whether it can be one at all.

For a mode A exp(-sigma t) cos(omega t + phase) in white noise of standard deviation s, sampled at fs, the bound of
Cramer and Rao on the variances of sigma and omega over a time T is 16 sigma^3 (s / A)^2 / fs over the share of
``information_share(sigma T)``. A decay of infinite length thus tells a damping ratio to 4 (s / A) (sigma / fs)^(1/2) of
itself, and most of that before it has fallen by 30 dB. docs/theory.md, section 11.
"""

import numpy as np

from identification.decay.mode_search import LEAST_PERIODS
from identification.decay.poles import Poles
from identification.decay.smoother import SmoothedMode
from models.arrays import FloatArray

MOST_OF_IT = 0.95
"""Share of all that a decay can ever tell of its damping with which it is long enough, whatever its periods."""

SHARP = 0.01
"""Of a frequency: its standard deviation is below this, or below half its resonance's width, or it is told from no
other."""

LOUDEST = 2.0
"""Times the record's peak: two close modes that begin against each other can each be as loud."""


def information_share(loss: float) -> float:
    """How much of what an endless decay tells of its rate is told by the time it has fallen by ``loss``, Np; 0 to 1.

    Source: Kay, Fundamentals of Statistical Signal Processing: Estimation Theory, 1993, section 3.9, amplitude and
    phase being unknown as well.
    """
    x = 2.0 * loss
    if x < 1e-2:
        return float(x**3 / 12.0)  # of the series, whose next term is smaller by x / 2
    fallen = np.exp(-x)
    energy, first, second = 1.0 - fallen, 1.0 - (1.0 + x) * fallen, 2.0 - (2.0 + 2.0 * x + x**2) * fallen
    return float(second - first**2 / energy)


def long_enough(freq: float, sigma: float, seconds: float) -> bool:
    """Whether a mode was followed over its least periods, or until it had told most of what it can.

    Args:
        freq: Hz.
        sigma: decay rate, 1/s.
        seconds: over which it was followed.
    """
    return bool(freq * seconds >= LEAST_PERIODS or information_share(max(sigma, 0.0) * seconds) >= MOST_OF_IT)


def why_untold(mode: SmoothedMode | None, poles: Poles, number: int, peaks: FloatArray) -> str | None:
    """Why a mode is not told, in words that follow its frequency; None where it is.

    Args:
        mode: as it was followed; None where it was lost.
        poles: of the decay.
        number: of the mode among them.
        peaks: (n_channels,) largest magnitudes of the channels.
    """
    freq, ratio = float(poles.natural_freqs[number]), float(poles.damping_ratios[number])
    if mode is None:
        return f"(damping {ratio:.1%}) does not stand out of what the other modes leave for long enough to be followed"
    seconds = float(mode.blocks.edges[-1])
    if not long_enough(freq, mode.sigma, seconds):
        return (
            f"(damping {ratio:.1%}) is followed for {seconds:.3g} s, {freq * seconds:.1f} periods and a fall of "
            f"{8.686 * mode.sigma * seconds:.0f} dB; {LEAST_PERIODS:g} periods or 30 dB are asked for"
        )
    if mode.turning.low.min() <= 0.0 or np.exp(mode.loudest) * np.max(np.abs(mode.blocks.shape) / peaks) > LOUDEST:
        return "follows a course that no mode can have: it may turn backwards, or is louder than the record"
    if poles.natural_freq_stds[number] > max(abs(ratio), SHARP) * freq:
        std = poles.natural_freq_stds[number]
        return f"(damping {ratio:.1%}) is told to {std:.2g} Hz, which is more than half its resonance's width"
    return None
