"""Numbers and verdicts as a person reads them."""

from math import floor, isfinite, log10

import numpy as np

from identification.locating.located import PlacedForce
from identification.reached import ERROR_REACHED, NOISE_REACHED
from identification.result import Candidate, Diagnosis, Estimate, MissingForce, Score, Stage, largest_at, loudest

COUNTS = ("no effect", "one effect", "two effects", "three effects", "four effects", "five effects")


def percent(share: float) -> str:
    """A share with two digits: ``24 %``, ``5.0 %``, ``0.71 %``.

    Args:
        share: 1 is 100 %.
    """
    return f"{100.0 * share:.0f} %" if abs(share) >= TWO_DIGITS else f"{100.0 * share:#.2g} %"


TWO_DIGITS = 0.0995


def error_of(candidate: Candidate) -> str:
    """What a model with a suspect misses, a bound where it was not refitted: ``5.0 %``, ``at most 5.0 %``.

    Args:
        candidate: judged in a round.
    """
    return ("" if candidate.refitted else "at most ") + percent(candidate.nrmse)


def chance(probability: float) -> str:
    """A probability, certain only where it is.

    Args:
        probability: from 0 to 1.
    """
    if LEAST_CHANCE <= probability <= MOST_CHANCE:
        return percent(probability)
    return f"< {100.0 * LEAST_CHANCE:g} %" if probability < LEAST_CHANCE else f"> {100.0 * MOST_CHANCE:g} %"


LEAST_CHANCE, MOST_CHANCE = 1e-4, 0.999


def number(value: float) -> str:
    """Four digits, with a power of ten where it is long: ``80``, ``0.00015``, ``2.1e11``.

    Args:
        value: in any unit.
    """
    mantissa, _, power = f"{value:.4g}".partition("e")
    return f"{mantissa}e{int(power)}" if power else mantissa


def with_std(estimate: Estimate) -> str:
    """Value and standard deviation to two digits of the latter, with the unit: ``18.5 ± 0.4 N s/m``.

    Args:
        estimate: one number or several.
    """
    unit = "" if estimate.unit in ("", "-") else f" {estimate.unit}"
    values, stds = np.atleast_1d(estimate.value), np.atleast_1d(estimate.std)
    shown = [_rounded(float(v), float(s)) for v, s in zip(values, stds, strict=True)]
    return f"({', '.join(shown)}){unit}" if isinstance(estimate.value, tuple) else f"{shown[0]}{unit}"


def _rounded(value: float, std: float) -> str:
    if not isfinite(std) or std <= 0.0:
        return number(value)
    power = floor(log10(std)) - 1
    largest = floor(log10(max(abs(value), std)))
    if largest >= SHORTEST_POWER or largest < -SMALLEST_POWER:
        digits = max(0, min(largest - power, MOST_DIGITS))
        return f"({value / 10.0**largest:.{digits}f} ± {std / 10.0**largest:.{digits}f})e{largest}"
    decimals = min(max(0, -power), MOST_DIGITS)
    return f"{value:.{decimals}f} ± {std:.{decimals}f}"


SHORTEST_POWER, SMALLEST_POWER, MOST_DIGITS = 5, 3, 8
"""Numbers from 1e5 on and below 1e-3 are written with a power of ten; none with more than eight decimals."""


def stage_kind(diagnosis: Diagnosis, stage: Stage) -> str:
    """``given``, ``calibrated`` or ``updated``, the key of its colour."""
    if stage is diagnosis.stages[0]:
        return "given"
    return "updated" if stage.hypothesis.effects else "calibrated"


def headline(diagnosis: Diagnosis) -> str:
    """The verdict in one plain sentence."""
    first, last = diagnosis.stages[0].score, diagnosis.final.score
    fall = f"the error falls from {percent(first.nrmse)} to {percent(last.nrmse)}"
    floor_is = f"the noise alone leaves {percent(last.noise_nrmse)}"
    if diagnosis.verdict == "missing_effect":
        named = " and ".join(added.effect.label() for added in diagnosis.added)
        count = COUNTS[len(diagnosis.added)] if len(diagnosis.added) < len(COUNTS) else "several effects"
        with_it = "it" if len(diagnosis.added) == 1 else "them"
        return f"The given model lacks {count}, {named}: with {with_it} {fall}, and {floor_is}{_more(last)}."
    if diagnosis.verdict == "complete":
        own = "; what is left beyond it is the model's own error" if _more(last) else ""
        return f"These records show nothing missing: calibrated within its tolerances, {fall}, and {floor_is}{own}."
    if _meets_only_what_it_saw(diagnosis):
        return (
            f"Something is missing that shows in a record kept aside: the calibrated model meets what it was fitted to "
            f"({fall}, and {floor_is}), and what was learnt does not hold there."
        )
    return (
        f"Something is missing, and no effect of the library is sure to be it: the best model still errs by "
        f"{percent(last.nrmse)} (as given {percent(first.nrmse)}), while {floor_is}."
    )


def _meets_only_what_it_saw(diagnosis: Diagnosis) -> bool:
    """Whether what is unexplained is a record kept aside alone."""
    met = not _more(diagnosis.final.score) and diagnosis.times_noise <= NOISE_REACHED
    return diagnosis.verdict == "unexplained" and met and bool(diagnosis.not_predicted)


def _more(last: Score) -> str:
    """That something is left beyond the noise, where it is."""
    if last.noise_nrmse <= 0.0 or last.nrmse <= ERROR_REACHED * last.noise_nrmse:
        return ""
    return f"; what is left, {last.nrmse / last.noise_nrmse:.2g} times the noise, is not explained"


BELOW_THE_FLOOR = 0.9
"""Residual over noise, line by line, of time records below which neither chance nor the fit takes it: of the thousands
of lines of a record, both take a hundredth."""


def second_line(diagnosis: Diagnosis) -> str:
    """Whether the floor stands too high, what the records kept aside say, and where an unexplained force acts."""
    parts: list[str] = []
    if diagnosis.final.score.records and diagnosis.times_noise < BELOW_THE_FLOOR:
        parts.append(
            f"The model leaves {diagnosis.times_noise:.2f} times the noise line by line: the sensors' or the force's "
            "noise was estimated too high, and what the model still misses may hide below it."
        )
    if "updated" in diagnosis.holdout:
        held = diagnosis.holdout["updated"]
        before = (
            f" instead of {percent(diagnosis.holdout['as given'].nrmse)}" if "as given" in diagnosis.holdout else ""
        )
        parts.append(
            f"On records kept aside it errs by {percent(held.nrmse)}{before} (noise {percent(held.noise_nrmse)})."
        )
        parts += [f"{told[0].upper()}{told[1:]}." for told in diagnosis.not_predicted]
    else:
        parts.append("No record was kept aside, so nothing here was tested on data the fit has not seen.")
    if diagnosis.verdict == "unexplained" and not _meets_only_what_it_saw(diagnosis):
        parts += _unexplained_force(diagnosis)
    return " ".join(parts)


def _unexplained_force(diagnosis: Diagnosis) -> list[str]:
    """Where it acts, by the profile along the beam, and when it is largest; at the laws' places where there is none."""
    found = diagnosis.located
    if found is not None and found.sensor and found.where:
        return [f"What is left lies in channel {found.sensor}."]
    if found is not None and found.where:
        return [f"It acts at {found.where}, {_size(loudest(found.forces))}."]
    if found is not None:
        return [f"Where along the beam: {found.words}."]
    if not diagnosis.missing_forces:
        return []
    most = loudest(diagnosis.missing_forces)
    return [f"The unexplained force is largest {at(most.place)}, {_size(most)}."]


def _size(force: PlacedForce | MissingForce) -> str:
    size = number(float(f"{force.force.std():.3g}"))
    return f"{size} N rms in {force.record} and largest there at {largest_at(force):.3g} s"


def at(place: str) -> str:
    """Where a missing force acts, in words.

    Args:
        place: of a ``MissingForce``.
    """
    return "at the mass" if place == "mass" else f"at {place}"
