"""The same effect at another place: a fit moves a place downhill only, and along a beam there are many valleys.

Beside the numbers that a fit has found, those of the rig and of other effects, which are nearly right wherever the
records are nearly explained, the other valleys show.
"""

from dataclasses import replace

from identification.evaluate import Evaluator
from identification.fit import Fit
from identification.hypothesis import free_place
from identification.in_its_place import RULED_OUT, Leader, against, refit, seen_at, without_last
from identification.in_step import tried_with
from identification.scene import valley
from models.effects import Registry

OTHER_PLACES = 2
"""Valleys that are tried beside the one the effect sits in."""


def elsewhere(fitting: Evaluator, base: Fit, found: Fit, registry: Registry, n_effects: int = 1) -> list[Fit]:
    """Refits of a fit's last effect at other places, where they come near what it leaves.

    Args:
        fitting: records of the fit.
        base: a model with all but the fit's last effects, for its unknowns.
        found: the fit.
        registry: in which its last effect's kind is.
        n_effects: of the fit's last effects that are taken out for it.
    """
    effect = found.hypothesis.effects[-1]
    if not free_place(effect):
        return []
    bare = without_last(found.hypothesis, n_effects)
    beside = replace(base, hypothesis=bare)
    seen = seen_at(None, fitting, base, bare, {effect.kind: registry[effect.kind]}, OTHER_PLACES + 1)
    others = [s.effect for s in seen if not _is_near(s.effect.place.position, effect.place.position, valley(bare.rig))]
    leader, fits = Leader(found, fitting), []
    for other in others[:OTHER_PLACES]:
        first, farther = against(leader, beside, tried_with(fitting, bare, other))
        if first is None or farther > RULED_OUT:
            continue
        result = refit(fitting, base, first.hypothesis)
        if result is not None:
            fits.append(result)
    return fits


def _is_near(here: float | None, there: float | None, distance: float) -> bool:
    return here is not None and there is not None and abs(here - there) <= distance
