"""The windows that a ridge can look through, by name, each brought to the same width.

The width is the standard deviation of the window taken as a weight, so that a scale of a samples means the same for
all of them, and for the Gaussian it is the Morlet wave's.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.integrate import quad
from scipy.special import i0

from models.arrays import FloatArray
from models.errors import InputError

GAUSSIAN_REACH = 6.0
"""Standard deviations at which the Gaussian is cut; it has fallen to 1.5e-8 there."""

KAISER_BETA = 8.0
"""Kaiser's parameter: sidelobes of -58 dB."""


@dataclass(frozen=True)
class Window:
    """A weight that is 0 beyond the distance 1.

    Attributes:
        shape: weight at distances (...) from -1 to 1, even.
    """

    shape: Callable[[FloatArray], FloatArray]

    @cached_property
    def half_width(self) -> float:
        """Distance at which the weight ends, in standard deviations of the weight."""
        total, spread = (
            quad(lambda v, power=power: v**power * float(self.shape(np.array(v))), 0.0, 1.0)[0] for power in (0, 2)
        )
        return float(np.sqrt(total / spread))

    def taps(self, scale: float) -> FloatArray:
        """(2 K + 1,) weights of the samples -K to K about the middle one.

        Args:
            scale: standard deviation of the weight, samples.
        """
        K = int(self.half_width * scale)
        return self.shape(np.arange(-K, K + 1) / (self.half_width * scale))


WINDOWS = {
    "gaussian": Window(lambda v: np.exp(-0.5 * (GAUSSIAN_REACH * v) ** 2)),
    "hann": Window(lambda v: np.cos(0.5 * np.pi * v) ** 2),
    "kaiser": Window(lambda v: i0(KAISER_BETA * np.sqrt(1.0 - v**2)) / i0(KAISER_BETA)),
    "triangular": Window(lambda v: 1.0 - np.abs(v)),
    "parabolic": Window(lambda v: 1.0 - v**2),
    "rectangular": Window(np.ones_like),
}
"""All windows; the Gaussian makes the ridge of the Morlet transform."""


def window_named(name: str) -> Window:
    """The window of a name.

    Raises:
        InputError: a name that is not in ``WINDOWS``.
    """
    if name not in WINDOWS:
        raise InputError(f"window = {name!r}", f"the windows are {', '.join(WINDOWS)}", "choose one of them")
    return WINDOWS[name]
