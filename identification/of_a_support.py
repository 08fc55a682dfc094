"""Whether a law more general than any of the library stands for the simple kinds that a support is made of."""

from math import log

from identification.acceptance import is_explained
from identification.established import OF_A_SUPPORT
from identification.evidence import LEAST_EVIDENCE, SIMPLER, log_fit, misfit_of
from identification.fit import Fit, fit_to_its_end
from identification.hypothesis import numbers_with_place
from identification.in_its_place import has_fewer, refit, seen_at, without_last
from identification.in_step import tried_with
from identification.reached import is_faint
from identification.session import Session

MOST_LEFT = 0.1
"""Share of the squared misfit beyond the noise, as the best of the library leaves it, up to which a general law that
leaves it ends the search: a small second effect may be all that is left, of which a curve takes some."""


FIRST_OF_A_SUPPORT = 2
"""Kinds that show most in a law's place, from which models of a support begin: the first of two is not always that."""


def is_of_a_support(session: Session, base: Fit, law: Fit) -> bool:
    """Whether simple kinds in a general law's place leave so little that it may stand for them.

    A friction and a dashpot, or a spring and a dashpot, are what a support is made of: one curve holds both. A kind of
    those that show most there is fitted, then another beside it, up to the numbers that a support may have together.
    Beside a law that leaves no more than the noise no further effect would be looked for: there the law has to be
    clearly likelier than these models, fitted to their end, and they have to leave more than the noise. Else a small
    effect elsewhere, of which the law takes some, may be all that simple kinds leave.

    Args:
        session: with the records.
        base: the model without effects.
        law: the general one.
    """
    for first in range(FIRST_OF_A_SUPPORT):
        support = _support(session, base, law, first)
        if support is not base and _may_stand_for(session, law, support):
            return True
    return False


def _may_stand_for(session: Session, law: Fit, support: Fit) -> bool:
    """Whether a support reaches the noise too, or the law in its place is not clearly better, its numbers counted."""
    if not is_faint(session.fitting, support):
        return True
    if not is_explained(session, law):
        return beyond_noise(law) > MOST_LEFT * max(beyond_noise(support), 1.0)
    ended = fit_to_its_end(session.fitting, support.hypothesis, support.unknowns, like=support)
    scale, more = misfit_of(ended), max(_n_numbers(law) - _n_numbers(ended), 0)
    better = log_fit(law, scale) - log_fit(ended, scale) - log(SIMPLER) * more
    return not is_faint(session.fitting, ended) or better < LEAST_EVIDENCE


def _n_numbers(model: Fit) -> int:
    """Of all effects, with their places."""
    return sum(map(numbers_with_place, model.hypothesis.effects))


def _support(session: Session, base: Fit, law: Fit, first: int) -> Fit:
    """The model with simple kinds in a law's place, one after the other; that without any where none is seen there.

    Args:
        session: with the records.
        base: the model without effects.
        law: the general one.
        first: which of the kinds that show most there comes first.
    """
    place, kinds = law.hypothesis.effects[-1].place, session.kinds_at_a_place(base.hypothesis.rig)
    model, begun, numbers, which = base, without_last(law.hypothesis), 0, first
    while numbers < OF_A_SUPPORT:
        most = min(OF_A_SUPPORT - 1, OF_A_SUPPORT - numbers)
        simple = {name: kind for name, kind in kinds.items() if has_fewer(kind, most + 1)}
        seen = seen_at(place.position, session.fitting, model, begun, simple)[which:]
        found = refit(session.fitting, model, tried_with(session.fitting, begun, seen[0].effect)) if seen else None
        if found is None:
            break
        model, begun, which = found, found.hypothesis, 0
        numbers += found.hypothesis.effects[-1].n_numbers
    return model


def beyond_noise(found: Fit) -> float:
    """Squared misfit beyond the noise.

    Args:
        found: the fit.
    """
    return max(found.chi2 - found.n_data, 0.0)
