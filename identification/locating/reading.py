"""The shape of a force in words, from what functions of the motion predict: no kind of effect is named."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from identification.locating.courses import Course

MORE, SHARE_OF_REST = 0.02, 0.3
"""A richer function is told if it predicts this much more of the power, and this share of what is left."""

ALIKE = 0.02
"""Difference in what two quantities predict that does not tell them apart."""

WHOLE = 0.8
"""Share predicted, below which the force follows more than the motion at the moment."""

UNITS = {"displacement": (1e3, "mm"), "velocity": (1e3, "mm/s"), "acceleration": (1.0, "m/s^2")}

FORMS = {
    "linear": "in proportion (linear)",
    "hardening": "growing more than in proportion (hardening)",
    "softening": "growing less than in proportion (softening)",
    "saturating": "of the same size beyond {bend} (saturating)",
    "threshold": "only beyond {bend} from the middle (a threshold, as of a stop)",
}

SIDES = {
    "odd": "odd",
    "even": "even: the same on both sides",
    "lopsided": "lopsided",
    "one side": "seen on one side only",
}


@dataclass(frozen=True, eq=False)
class Facts:
    """What was found of a force.

    Attributes:
        explained: share of its power that each quantity predicts alone.
        chosen: quantities worth telling, the best first.
        together: share that they predict.
        surface: share that any function of displacement and velocity together predicts.
        growing: share that the chosen ones predict if the force may grow with time.
        trend: by what factor it then has grown over a record.
        power: exponent of its size over that of the first quantity; not a number where the sizes are too much alike.
        courses: over each chosen quantity.
    """

    explained: Mapping[str, float]
    chosen: tuple[str, ...]
    together: float
    surface: float
    growing: float
    trend: float
    power: float
    courses: Mapping[str, Course]

    @property
    def predicted(self) -> float:
        """Share that the best of all functions predicts."""
        return max(self.together, self.surface, self.growing)


def is_worth(now: float, more: float) -> bool:
    """Whether what predicts more is worth telling.

    Args:
        now: share predicted.
        more: by a richer function.
    """
    return more - now > max(MORE, SHARE_OF_REST * (1.0 - now))


def reading(facts: Facts) -> tuple[str, ...]:
    """What a force follows, a sentence each.

    Args:
        facts: found.
    """
    words = [_follows(facts)]
    if facts.together >= TELLING:
        words += [f"over the {name}: {_course(name, facts.courses[name])}" for name in facts.chosen]
    if is_worth(facts.together, facts.surface):
        words.append(
            f"displacement and velocity act together, not side by side: {facts.surface:.0%} as a function of both, as "
            "where the resistance to motion depends on where the beam is"
        )
    if is_worth(facts.together, facts.growing):
        words.append(f"at the same motion it {_trend(facts.trend)}")
    if facts.predicted < WHOLE:
        words.append(
            f"{1.0 - facts.predicted:.0%} of it none of the functions tried predicts from the motion at the same "
            "moment: it depends on displacement and velocity jointly and more steeply than they can, as grease near a "
            "wall, remembers what was before, acts elsewhere besides, or is not told from noise"
        )
    if np.isfinite(facts.power) and facts.together >= TELLING:
        words.append(f"its size grows as that of the {facts.chosen[0]} to the power of {facts.power:.1f}")
    return tuple(words)


TELLING = 0.2
"""Share predicted, below which a course says nothing."""

TOLD = 0.5
"""Share predicted, below which the quantity that predicts most need not be the one that acts."""


def _trend(factor: float) -> str:
    """What a force does through the record, from how many times as large it ends."""
    if abs(factor - 1.0) < STEADY:
        return "is not of one size through the record, but ends as large as it began"
    return f"{'grows' if factor > 1.0 else 'falls'} through the record, to {factor:.2g} times its size at the beginning"


STEADY = 0.05
"""Growth over a record that is none."""


def _follows(facts: Facts) -> str:
    chosen, explained = facts.chosen, facts.explained
    if facts.together < TELLING:
        return (
            "it follows neither displacement nor velocity nor acceleration by themselves at the same moment "
            f"({facts.together:.0%})"
        )
    if facts.predicted < TOLD:
        most = " and the ".join(chosen)
        return f"what it follows is hardly told: most nearly the {most}, which predicts {facts.together:.0%} of it"
    alone = [name for name in UNITS if name not in chosen]
    alike = [name for name in alone if explained[chosen[0]] - explained[name] < ALIKE] if len(chosen) == 1 else []
    if alike:
        either = " or the ".join([chosen[0], *alike])
        return f"it follows the {either} ({facts.together:.0%}): this motion does not part them"
    rest = ", ".join(f"the {name} {explained[name]:.0%}" for name in alone)
    return (
        f"it follows the {' and the '.join(chosen)} ({facts.together:.0%}){'; by themselves ' + rest if rest else ''}"
    )


def _course(name: str, course: Course) -> str:
    scale, unit = UNITS[name]
    form = FORMS[course.form].format(bend=f"{scale * course.bend:.2g} {unit}")
    return f"{'against' if course.against else 'along with'} it, {SIDES[course.side]}, {form}"
