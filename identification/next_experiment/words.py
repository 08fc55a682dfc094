"""A proposal as a person reads it."""

from collections.abc import Sequence

from identification.next_experiment.costs import Limits
from identification.next_experiment.proposal import Option

MOST_SIGMAS = 30.0
"""Standard deviations beyond which a separation is told as more than this: no model is known that well."""


def why(rivals: Sequence[str], best: Option, present: float, limits: Limits) -> str:
    """What a test promises, and what it asks of the rig.

    Args:
        rivals: labels of the group.
        best: what is proposed.
        present: probability that the right one has on average now.
        limits: how far a test may go.
    """
    promise = (
        f"the records so far do not tell {' from '.join(rivals)}; in this test their predictions part by "
        f"{sigmas(best.separation)} standard deviations of the noise and of the model's own error, whatever numbers "
        f"they take, and the right one is expected to have a probability of {_sure(best.expected_probability)} "
        f"afterwards, {present:.2g} now"
    )
    rows = [promise]
    if best.reach > limits.warned:
        rows.append(f"readings up to {best.reach:.1f} times the largest so far are expected")
    if best.followed < best.test.seconds:
        rows.append(f"only its first {best.followed:.2g} s can be followed")
    return "; ".join(rows)


PARTED = 1.0
"""Separation below which two predictions are one: a law that holds another within it follows wherever that goes."""


def words_of(best: Option) -> str:
    """What to do; where even the best test parts nothing, that there is none.

    Args:
        best: of all tests that were weighed.
    """
    if best.separation >= PARTED:
        return best.test.words
    return f"no test within reach parts them; the best of those weighed is {best.test.words}"


def sigmas(separation: float) -> str:
    """A separation, as far as it means anything.

    Args:
        separation: in standard deviations.
    """
    return f"more than {MOST_SIGMAS:g}" if separation > MOST_SIGMAS else f"{separation:.2g}"


def _sure(probability: float) -> str:
    return f"more than {MOST_SURE:g}" if probability > MOST_SURE else f"{probability:.3g}"


MOST_SURE = 0.999
"""Probability beyond which nothing is told; a library does not hold everything."""


def in_vain(rivals: Sequence[str], best: Option | None) -> str:
    """That nothing at hand settles the matter.

    Args:
        rivals: labels of the group.
        best: the best there is, or None where nothing could be tried.
    """
    named = " from ".join(rivals)
    if best is None:
        return f"the records so far do not tell {named}, and no test within reach could be weighed"
    if best.separation < PARTED:
        return f"no affordable test tells {named}: one of them may still do what another does in the best test"
    return (
        f"no affordable test tells {named} for certain: in the best test their predictions part by "
        f"{sigmas(best.separation)} standard deviations, and the right one is expected to have a probability of "
        f"{_sure(best.expected_probability)} afterwards"
    )
