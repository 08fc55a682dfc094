"""A record cut into blocks: the complex amplitude of one mode in each, all modes fitted side by side.

Blocks do not overlap, so their errors are independent; none reaches beyond the record, so its ends need no treatment.
"""

from dataclasses import dataclass

import numpy as np

from identification.decay.poles import ROUNDING
from identification.decay.walk import Points
from models.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from models.errors import InputError

MOST_BLOCKS = 256
APART = 1.5
"""Periods of the beat with the nearest mode in a block, so that the two can be told apart in it."""

LEAST_BLOCKS = 8
"""That a mode stands out in, for its course to be followed; blocks are made longer for a mode that does not."""

SAMPLES_PER_MODE = 8
"""In a block at least; each mode has two numbers there."""

LEAST_TRIPLES = 16
MEDIAN_OF_SQUARE = 0.4549364
"""Of a standard normal number."""

SURE = 5.0
"""Times the root of the number of blocks: three deviations of a median of correlated squares, in logarithms."""

FINEST = 1e-6
"""Error of a block's amplitude as a share of it at least: no recorder is better, and sums of squares are not either."""

DROWNED = -200.0
"""Np below which a path's level makes no difference any more."""

STEEPEST = 300.0
"""Np from a block's begin to its middle at most, so that squares stay finite; where a mode falls by more it is dead."""

UNTOLD = 1e60
"""Variance of an amplitude of which a block says nothing, for noise of 1."""

CLEAR = 0.1
"""Error of a block's amplitude as a share of it, below which the logarithm is taken and not its tangent."""


@dataclass(frozen=True, eq=False)
class Deviations:
    """What the blocks say of one mode's path beyond the path they were fitted with.

    Attributes:
        edges: (n + 1,) s, where the blocks begin and the last one ends.
        times: (n,) s, their centres.
        log_amplitude: (n,) Np; nan where no block shows the mode.
        phase: (n,) rad, unwrapped.
        variances: (n,) of either, which are independent; infinite where a block says nothing.
        clear: (n,) whether the mode stands well out of the noise.
        shape: (n_channels,) complex amplitudes of the channels at a path's level 0.
        noise: (n_channels,) standard deviation of what all modes together leave.
    """

    edges: FloatArray
    times: FloatArray
    log_amplitude: FloatArray
    phase: FloatArray
    variances: FloatArray
    clear: BoolArray
    shape: ComplexArray
    noise: FloatArray

    @property
    def last_clear(self) -> float:
        """End of the last block in which the mode stands out, s."""
        return float(self.edges[1 + np.flatnonzero(self.clear)[-1]]) if self.clear.any() else float(self.edges[1])

    def points(self, levels: FloatArray) -> Points:
        """These blocks' levels as observations."""
        return Points(self.edges, self.times, levels, self.variances)


def block_edges(n_samples: int, fs: float, freqs: FloatArray, mode: int, most: int = MOST_BLOCKS) -> IntArray:
    """(n_blocks + 1,) first samples of a mode's blocks, about whole half periods long, and the end of the last one.

    Where the mode dies before it has beaten twice with its neighbour it has two shorter ones, and what they leave open
    shows in their variances. One is returned where not even two hold half a period and their numbers.

    Args:
        n_samples: in which the mode is seen.
        fs: Hz.
        freqs: (n_modes,) Hz.
        mode: which.
        most: blocks.
    """
    half = 0.5 / freqs[mode]
    apart = np.abs(np.delete(freqs, mode) - freqs[mode]).min(initial=np.inf)
    shortest = max(half, SAMPLES_PER_MODE * len(freqs) / fs)
    length = np.ceil(max(n_samples / fs / most, APART / apart, shortest) / half - 1e-9) * half
    n = max(int(n_samples / fs / length), 2) if n_samples / fs >= 2.0 * shortest else 1
    return np.round(np.linspace(0, n_samples, n + 1)).astype(np.int64)


def deviations(
    signals: FloatArray, fs: float, paths: ComplexArray, mode: int, edges: IntArray, colour: float = 1.0
) -> Deviations:
    """Fit all modes to every block along their paths, and read what one of them does beside its own.

    Args:
        signals: (n_channels, N).
        fs: Hz.
        paths: (n_modes, N) log of each mode's complex amplitude, up to a constant for each channel.
        mode: which.
        edges: (n_blocks + 1,) first samples.
        colour: density of the noise about the mode over that of white noise.

    Raises:
        InputError: no more samples than the modes have numbers in all blocks.
    """
    signals, paths = signals[:, : edges[-1]], paths[:, : edges[-1]]
    centre = (edges[1:] + edges[:-1] - 1) // 2
    level = np.repeat(paths.real[:, centre], np.diff(edges), axis=1)
    beside = paths - level
    waves = np.exp(np.minimum(beside.real, STEEPEST) + 1j * beside.imag)
    basis = np.concatenate([waves.real, -waves.imag])
    rows = len(basis)
    if signals.shape[1] <= rows * len(centre):
        raise InputError(
            f"{len(paths)} modes in {len(centre)} blocks of {signals.shape[1]} samples together",
            "each mode has two numbers in each block, and what is left tells the noise",
            "take fewer blocks or modes, or a higher rate",
        )
    gram = np.empty((len(centre), rows, rows))
    for i in range(rows):
        for j in range(i + 1):
            gram[:, i, j] = gram[:, j, i] = np.add.reduceat(basis[i] * basis[j], edges[:-1])
    right = np.stack([np.add.reduceat(basis * signal, edges[:-1], axis=1).T for signal in signals], axis=2)
    covariance = np.linalg.pinv(gram, hermitian=True)
    numbers = covariance @ right
    energy = np.sum(signals**2, axis=1)
    unexplained = energy - np.einsum("bic,bic->c", right, numbers)
    noise = np.sqrt(np.maximum(unexplained, ROUNDING * energy) / (signals.shape[1] - rows * len(centre)))
    own = np.asarray(colour * covariance)
    return _read(numbers, own, mode, paths.real[mode, centre], np.asarray(noise), np.asarray((edges - 0.5) / fs))


def _read(
    numbers: FloatArray, covariance: FloatArray, mode: int, level: FloatArray, noise: FloatArray, edges: FloatArray
) -> Deviations:
    """One mode's deviations from all modes' (n_blocks, 2 n_modes, n_channels) numbers in blocks of a given level."""
    imag = mode + numbers.shape[1] // 2
    found = numbers[:, mode] + 1j * numbers[:, imag]
    own = 0.5 * (covariance[:, mode, mode] + covariance[:, imag, imag])
    own = np.where(own > 0.0, own, UNTOLD)  # of a block that cannot part the modes a direction is lost
    shape, size = _shape(found, noise, own), np.exp(np.maximum(level, DROWNED))
    weights = shape.conj() / noise**2
    strength = float((weights @ shape).real)
    along = found @ weights / strength / size
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):  # not finite where no block shows the mode
        trust = size**2 / own
        scale = np.sum(np.abs(along) * trust) / np.sum(trust) * np.exp(1j * np.angle(np.sum(along * trust)))
        ratio = along / scale
        variances = own / (strength * np.abs(scale * size) ** 2)
    clear = variances < CLEAR**2 * np.abs(ratio) ** 2
    log, phase = ratio.real - 1.0, np.array(ratio.imag)
    log[clear], phase[clear] = np.log(np.abs(ratio[clear])), np.unwrap(np.angle(ratio[clear]))
    variances[clear] /= np.abs(ratio[clear]) ** 2
    variances = np.maximum(variances * scatter(log, variances) ** 2, FINEST**2)
    return Deviations(edges, 0.5 * (edges[1:] + edges[:-1]), log, phase, variances, clear, shape * scale, noise)


def _shape(found: ComplexArray, noise: FloatArray, own: FloatArray) -> ComplexArray:
    """(n_channels,) the complex shape that the blocks' (n_blocks, n_channels) amplitudes have in common, of any scale.

    A block may be turned and scaled by what its path lacks, so the shape is the leading singular vector.
    """
    rows = np.linalg.svd(found / noise / np.sqrt(own)[:, None], full_matrices=False)[2]
    return np.asarray(rows[0] * noise)


def scatter(levels: FloatArray, variances: FloatArray) -> float:
    """How many times their standard deviations levels scatter about a smooth course; 1 where the noise tells it.

    Second differences of (n,) levels against (n,) variances; the median does not mind a jump. Where noise is not white,
    as in a band cut out of a record, what a block leaves does not tell the error of its amplitude, and this does.
    """
    if len(levels) < LEAST_TRIPLES:
        return 1.0
    bends = levels[2:] - 2.0 * levels[1:-1] + levels[:-2]
    expected = variances[2:] + 4.0 * variances[1:-1] + variances[:-2]
    factor = float(np.sqrt(np.median(bends**2 / expected) / MEDIAN_OF_SQUARE))
    sure = SURE / np.sqrt(len(bends))
    return factor if abs(np.log(factor)) > sure else 1.0
