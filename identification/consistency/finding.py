"""What a calibration shows that no one set of numbers within its tolerances does, and how sure that is."""

from dataclasses import dataclass
from math import inf, lgamma, log
from typing import Literal

from scipy import special, stats

What = Literal["tolerance", "records", "times", "modes", "record apart"]


@dataclass(frozen=True)
class CalibrationFinding:
    """One contradiction in a calibrated model.

    Attributes:
        what: a number left its ``tolerance``; it differs between ``records`` (levels), ``times`` or ``modes``, or the
            residual does; a ``record apart`` is not predicted by the numbers of the others.
        number: path of the number in the rig file, empty where it is the residual.
        where: what each value belongs to, in words.
        values: the number in its unit, or residual over noise.
        stds: standard deviation of each value; empty for residuals.
        unit: of the values.
        sigma: significance in standard deviations of a normal number.
        words: the finding as a sentence.
    """

    what: What
    number: str
    where: tuple[str, ...]
    values: tuple[float, ...]
    stds: tuple[float, ...]
    unit: str
    sigma: float
    words: str

    @property
    def told(self) -> str:
        """The finding among others that are not of the calibrated model."""
        return f"calibrated model: {self.words}"


def sigmas_of(chi2: float, degrees: int, known_by: float = inf) -> float:
    """How many standard deviations a normal number would have to be off to be as improbable, to either side.

    Args:
        chi2: as a chi-square where the noise's size is known.
        degrees: of freedom, 1 or more.
        known_by: degrees of freedom from which the noise's size was estimated.
    """
    if degrees < 1 or chi2 <= 0.0:
        return 0.0
    if known_by < inf:
        chance = float(stats.f.logsf(chi2 / degrees, degrees, known_by))
    else:
        chance = float(stats.chi2.logsf(chi2, degrees))
    if chance == -inf:
        # The first term of the incomplete gamma function's series for large arguments.
        chance = (0.5 * degrees - 1.0) * log(0.5 * chi2) - 0.5 * chi2 - lgamma(0.5 * degrees)
    return max(0.0, -float(special.ndtri_exp(chance - log(2.0))))


def least_sigma(chance: float, tests: int) -> float:
    """What the largest of so many normal numbers exceeds, to either side, with this probability (Bonferroni).

    Args:
        chance: that one of them does.
        tests: how many.
    """
    return float(stats.norm.isf(0.5 * chance / max(tests, 1)))
