"""What is read of a test, whether it was measured or predicted: four modes from the taps, FRFs from the multisine.

Measurement and model go through the same estimators, so whatever these get wrong is alike in both.
"""

from dataclasses import dataclass
from math import floor

import numpy as np

from identification.decay.free import SETTLING
from identification.decay.stream import speaks_for
from identification.decay.window_fit import fit_window
from identification.frf import estimate_frf
from models.arrays import ComplexArray, FloatArray
from models.errors import DivergenceError
from models.linear import linearised, natural_modes
from models.record import Record
from models.rig import Rig
from testbed.article.bench import PERIOD, TAP_EVERY, TAP_WIDTH
from testbed.article.rig import BAND, at_rest

MODES = 4


@dataclass(frozen=True, eq=False)
class TappedModes:
    """The four modes after every tap.

    Attributes:
        times: (n_taps, 4) s, for which each mode's damping speaks.
        natural_freqs, damping_ratios: (n_taps, 4) Hz and -.
        ratio_stds: (n_taps, 4) of the damping ratios.
        shapes: (n_taps, 4, n_sensors) complex amplitudes right after the tap.
    """

    times: FloatArray
    natural_freqs: FloatArray
    damping_ratios: FloatArray
    ratio_stds: FloatArray
    shapes: ComplexArray

    @property
    def mean_freqs(self) -> FloatArray:
        """(4,) Hz."""
        return np.asarray(self.natural_freqs.mean(axis=0))

    @property
    def mean_shapes(self) -> ComplexArray:
        """(4, n_sensors) turned and scaled to one another by least squares, then averaged."""
        first = self.shapes[0]
        turned = [
            shapes * (np.sum(shapes.conj() * first, axis=1) / np.sum(np.abs(shapes) ** 2, axis=1))[:, None]
            for shapes in self.shapes
        ]
        return np.asarray(np.mean(turned, axis=0))


@dataclass(frozen=True, eq=False)
class Frfs:
    """H1 of the multisine's excited lines, its first period left out.

    Attributes:
        frequency: (n_lines,) Hz.
        h1: (n_sensors, n_lines) SI.
    """

    frequency: FloatArray
    h1: ComplexArray


def tapped_modes(taps: Record, rig: Rig) -> TappedModes:
    """Fit the modes between two taps, to all channels at once.

    Args:
        taps: the record.
        rig: as its owner describes it, from whose modes the search begins.

    Raises:
        DivergenceError: a tap after which the modes do not stand out.
    """
    home, fs, rows = home_poles(rig), taps.fs, []
    for number in range(floor(taps.duration / TAP_EVERY)):
        tapped = (number + 0.5) * TAP_EVERY
        begin = round((tapped + TAP_WIDTH) * fs) + SETTLING
        end = min(round((tapped + TAP_EVERY) * fs) - SETTLING, taps.n_samples)
        found = fit_window(taps.responses[:, begin:end], fs, home, home)
        if found is None or not set(range(MODES)) <= set(found[1].tolist()):
            message = f"{taps.name}: after the tap at {tapped:g} s the first four modes do not stand out of the noise"
            raise DivergenceError(message)
        poles, numbers = found
        chosen = [numbers.tolist().index(mode) for mode in range(MODES)]
        rates = -poles.values.real[chosen]
        rows.append(
            (
                begin / fs + speaks_for(rates, (end - begin) / fs, fs),
                poles.natural_freqs[chosen],
                poles.damping_ratios[chosen],
                poles.damping_ratio_stds[chosen],
                poles.shapes[chosen],
            )
        )
    times, freqs, ratios, stds, shapes = (np.stack(column) for column in zip(*rows, strict=True))
    return TappedModes(times, freqs, ratios, stds, shapes)


def home_poles(rig: Rig) -> ComplexArray:
    """(n,) poles of small motion about rest, 1/s.

    Args:
        rig: of this study.
    """
    modes = natural_modes(linearised(at_rest(rig)), (), BAND)
    turn = 2.0 * np.pi * modes.natural_freqs
    return np.asarray(turn * (-modes.damping_ratios + 1j * np.sqrt(1.0 - modes.damping_ratios**2)))


def frfs_of(struck: Record, channels: FloatArray | None = None) -> Frfs:
    """The FRFs of the multisine.

    Args:
        struck: record of the multisine.
        channels: (n_sensors, N) predicted from its excitation; the measured ones where None.
    """
    assert struck.excitation is not None
    seen = slice(round(PERIOD * struck.fs), None)
    read = struck.responses if channels is None else channels
    estimate = estimate_frf(struck.excitation[seen], read[:, seen], struck.fs, resolution=1.0 / PERIOD)
    return Frfs(estimate.frequency, estimate.h1)
