"""What a sleeve's number at the end of its tolerance would be as an effect.

Nothing in the neighbourhood of such a number shows it: the number itself does all that, but for its end.
"""

from collections.abc import Iterator, Mapping

from identification.calibrate import strained
from identification.fit import Fit
from identification.scene import sleeves_of
from models.effects import Effect, Registry
from models.plant import contact_of


def said_of_far_numbers(found: Fit, registry: Registry) -> Iterator[tuple[list[Effect], Mapping[str, float]]]:
    """For each sleeve's number that a fit needs at its end, the effects that say as much, and the rig's numbers beside.

    Args:
        found: whose last effect is left out.
        registry: kinds to try.

    Yields:
        effects of no kind that sits in that sleeve already, and all numbers of the rig, that one as it was given.
    """
    bare = found.hypothesis.without_effect(len(found.hypothesis.effects) - 1)
    taken = {(part.kind, part.place.sleeve) for effect in bare.effects for part in effect.parts()}
    for unknown in strained(found):
        within, path = unknown.set(bare, 0.0), unknown.parameter.path
        for number, place in enumerate(sleeves_of(bare.rig)):
            contact, key = contact_of(within.updated_rig.sleeves[number]), path.removeprefix(f"sleeves[{number}].")
            kinds = (kind for name, kind in registry.items() if (name, place.sleeve) not in taken)
            said = (kind.from_sleeve_number(place, contact, key, bare.values[path]) for kind in kinds)
            if effects := [effect for effect in said if effect is not None]:
                yield effects, within.values
