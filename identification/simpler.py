"""Laws with fewer numbers, begun where a law with more has come to: what it may be imitating.

A law with more numbers has more ways down, and may reach what is there as its own limit (an absorber so stiff that it
is a mass), while the plain law itself was stopped on its way. It is tried once more from there.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from identification.hypothesis import free_place
from identification.sketch import Sketch
from models.effects import Effect


def simpler_ones(leader: Effect, sketches: Sequence[Sketch]) -> Iterator[Effect]:
    """The best sketch of each kind that has fewer numbers than the leader and can sit where it sits, moved there.

    Args:
        leader: a found effect.
        sketches: suspects, the best first.
    """
    seen: set[str] = {leader.kind}
    for sketch in sketches:
        effect = sketch.effect
        if effect.kind in seen or effect.n_numbers >= leader.n_numbers or not _can_sit(effect, leader):
            continue
        seen.add(effect.kind)
        yield _alike(replace(effect, place=leader.place), leader)


def _can_sit(effect: Effect, leader: Effect) -> bool:
    """Whether both have a place of one sort; sleeves are not exchanged."""
    if free_place(leader):
        return free_place(effect)
    return effect.place == leader.place


def _alike(effect: Effect, leader: Effect) -> Effect:
    """The effect with the leader's numbers where both have one of the same name and unit."""
    own = zip(effect.fitted_parameters(), effect.fitted_values(), strict=True)
    theirs = {
        (name, about.unit): float(value)
        for (name, about), value in zip(leader.fitted_parameters(), leader.fitted_values(), strict=True)
    }
    values = [theirs.get((name, about.unit), float(value)) for (name, about), value in own]
    return effect.with_fitted(np.array(values))
