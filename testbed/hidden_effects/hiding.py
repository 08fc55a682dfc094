"""What is hidden in a rig: effects of the library, or a law outside it, sized to show as much as was drawn."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, log

import numpy as np

from models.effects import Effect
from models.rig import Beam
from testbed.hidden_effects.imitation import Imitation
from testbed.hidden_effects.outside import OUTSIDE_LAWS
from testbed.hidden_effects.places import draw_place, is_apart, scene_at
from testbed.hidden_effects.plan import KINDS, NOTHING, OUTSIDE, TWO, Task
from testbed.hidden_effects.sets import EACH_OF_TWO, FEW, FEW_SHARE, MANY, MOST, SETS
from testbed.hidden_effects.sizes import ROUNDS, on_the_beam, sized
from testbed.hidden_effects.tolerated import tolerated
from testbed.hidden_effects.trials import Trial
from testbed.virtual.noise import Noise

PLACES = 2
"""Places tried on one rig."""


@dataclass(frozen=True)
class Hidden:
    """Effects that a rig's description lacks.

    Attributes:
        effects: none, one or two.
        shown: how many times the noise each shows by itself, by the search.
    """

    effects: tuple[Effect, ...] = ()
    shown: tuple[float, ...] = ()


def draw_wanted(task: Task, rng: np.random.Generator) -> tuple[float, ...]:
    """How many times the noise each effect of a case is to show.

    Args:
        task: the case.
        rng: draws it.
    """
    if task.kind == NOTHING:
        return ()
    if task.kind == TWO:
        return (EACH_OF_TWO.draw(rng), EACH_OF_TWO.draw(rng))
    low, high = (FEW, MANY) if rng.random() < FEW_SHARE else (MANY, MOST)
    return (exp(rng.uniform(log(low), log(high))),)


def hide(task: Task, trial: Trial, noise: Noise, wanted: Sequence[float], rng: np.random.Generator) -> Hidden | None:
    """What to hide in this rig; None where it has no place for it.

    Args:
        task: the case.
        trial: the rig and the forces.
        noise: of the measurement chain.
        wanted: times the noise, for each effect.
        rng: draws places and numbers.

    Raises:
        DivergenceError: the motion without an effect left the finite numbers.
    """
    kinds = _kinds(task, rng)
    if not kinds:
        return Hidden()
    imitation = Imitation(trial, noise, rng)
    hidden = Hidden()
    for kind, share in zip(kinds, wanted, strict=True):
        found = _one(kind, trial, imitation, share, hidden.effects, rng)
        if found is None:
            return None
        hidden = Hidden((*hidden.effects, found[0]), (*hidden.shown, found[1]))
    together = imitation.shown(hidden.effects, ROUNDS)
    return hidden if together >= FEW else None


def _kinds(task: Task, rng: np.random.Generator) -> tuple[type[Effect], ...]:
    if task.kind == NOTHING:
        return ()
    if task.kind == OUTSIDE:
        return (OUTSIDE_LAWS[task.number % SETS[task.case_set].batches[task.seed].n_laws],)
    if task.kind == TWO:
        every = tuple(KINDS.values())
        one, other = rng.choice(len(every), 2, replace=False)
        return (every[int(one)], every[int(other)])
    return (KINDS[task.kind],)


def _one(
    kind: type[Effect],
    trial: Trial,
    imitation: Imitation,
    wanted: float,
    others: tuple[Effect, ...],
    rng: np.random.Generator,
) -> tuple[Effect, float] | None:
    """An effect that shows about as much as wanted, away from the others."""
    built = trial.built
    assert isinstance(built.structure, Beam)
    for _ in range(PLACES):
        place = draw_place(kind, built, rng)
        if not all(is_apart(place, other.place, built.structure.length) for other in others):
            continue
        trials = list(kind.trials(scene_at(place, trial)))
        if not trials:
            return None
        found = sized(trials[int(rng.integers(len(trials)))], imitation, wanted, rng)
        if found is not None and not tolerated(found[0], trial.rig, built):
            return on_the_beam(found[0], built.structure.length), found[1]
    return None
