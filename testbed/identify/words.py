"""What an identification says, in an engineer's words."""

from identification.decay.cause import Cause
from identification.decay.course import Course
from identification.decay.identify import Identification

AMPLITUDE_LAWS = {
    -1.0: "as dry friction does",
    1.0: "as drag of the velocity's square or slip in a joint does",
    2.0: "as a cubic force does",
}
SURE = 0.95
"""Probability from which a jump is told."""


def cause_in_words(what: str, cause: Cause, course: Course, *, several: bool) -> str:
    """One sentence on what a mode's frequency or damping depends on.

    Args:
        what: ``damping`` or ``frequency``.
        cause: finished.
        course: of the mode in the first decay.
        several: whether decays of several levels were compared.
    """
    jumps = [jump for jump in course.jumps if jump.probability > SURE]
    if cause.verdict == "steady" and cause.probabilities["steady"] > SURE:
        return f"{what}: steady (probability {cause.probabilities['steady']:.3f})"
    if cause.verdict == "steady":
        return f"{what}: no change beyond its intervals"
    if cause.verdict == "irregular":
        at = ", ".join(f"{jump.time:.4g} +- {jump.std:.2g} s (1 std)" for jump in jumps)
        sudden = f"; it jumps at {at}" if jumps else ""
        return f"{what}: changes, and follows no simple law of amplitude or time{sudden}"
    if cause.verdict == "undecided":
        told = ", ".join(f"{name} {value:.2f}" for name, value in cause.probabilities.items())
        return f"{what}: changes, and these decays do not tell with what ({told}); repeat them from another level"
    assert cause.law is not None
    odds = cause.probabilities[cause.verdict]
    if cause.verdict == "time":
        return f"{what}: drifts with time, about as t^{cause.law.power:g} (probability {odds:.4f})"
    law = AMPLITUDE_LAWS.get(cause.law.power, f"about as the amplitude to the power {cause.law.power:g}")
    basis = "by decays of several levels" if several else "by the shape of one decay"
    return f"{what}: depends on amplitude, {law} (probability {odds:.4f}, {basis})"


def findings_of(found: Identification) -> list[str]:
    """All sentences, mode by mode."""
    sentences = list(found.findings)
    several = len(found.decays) > 1
    for m, mode in enumerate(found.decays[0].modes):
        name = f"mode {m + 1} ({mode.natural_freq:.4g} Hz)"
        damping = cause_in_words("damping", found.damping_causes[m], mode.smoothed.decay, several=several)
        frequency = cause_in_words("frequency", found.frequency_causes[m], mode.smoothed.turning, several=several)
        sentences += [f"{name}: {damping}", f"{name}: {frequency}"]
    sentences += [word for one in found.denoised for word in one.what]
    return sentences
