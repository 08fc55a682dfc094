"""Where to look for what is missing: kinds and places worth a refit, seen from two sides.

Small misfits are seen beside the calibrated numbers; large ones from the numbers as given, on the beginning of the
records, since a calibration without the missing effect pulls the numbers to where they imitate it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from identification.calibrate import Windows, beginning, concerning, put_back
from identification.evaluate import Evaluator
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis
from identification.progress import Progress
from identification.scene import Longer, valley
from identification.screen import Projection, Suspect, promising, screen, survey
from identification.sketch import HEATS, Sketch, afresh, ground_of, heats, sketched_from_calibrated
from models.effects import Effect, Place, Registry

PER_KIND = 2
"""Places of each kind that are sketched."""

MOST_LONG_SKETCHES = 8
"""Suspects sketched where it takes whole records."""


@dataclass(frozen=True, eq=False)
class View:
    """What suspects are looked for in.

    Attributes:
        evaluator: records, at the resolution of the search.
        there: the calibrated model on them.
        registry: kinds to look for.
        channels: on which effects may sit (``scene.places_of``).
        is_late: the records begin where a misfit does (``onset``), or are pieces of others.
        is_unbent: ``there`` is what all channels but the suspected ones tell, which these have bent in the calibration.
    """

    evaluator: Evaluator
    there: Fit
    registry: Registry
    channels: tuple[Place, ...] | None = None
    is_late: bool = False
    is_unbent: bool = False

    @property
    def is_lasting(self) -> bool:
        """Kinds that act over the length of a record, which its beginning does not show."""
        return any(kind.family == "time" for kind in self.registry.values())

    @cached_property
    def told(self) -> Longer:
        """What these seconds tell beside the model there, and their beginning does not."""
        return Longer.told_by(self.evaluator, self.there.hypothesis)


def beside(view: View, base: Fit, progress: Progress) -> list[Sketch]:
    """Sketches of what could take most away beyond the rig's numbers.

    They begin at the calibrated numbers, but for those that were pulled away, very likely by what is missing. Where the
    beginning of the records tells enough, it is surveyed: nothing has to be in proportion to an effect's size there.

    Args:
        view: what to look in.
        base: the calibrated model on all that is fitted.
        progress: told what is being done.
    """
    evaluator, there, registry = view.evaluator, view.there, view.registry
    plain = view.is_lasting or bool(evaluator.at_rest)  # FRFs have no beginning
    back = there.hypothesis if evaluator.at_rest else put_back(there)
    start = there.hypothesis if plain else back
    telling = None if plain else _telling(evaluator, start, base)
    if telling is None:
        seen = promising(screen(evaluator, there, registry, progress, view.channels), PER_KIND, valley(start.rig))
        effects = [suspect.effect for suspect in first_of_each_kind(seen)[:MOST_LONG_SKETCHES]]
        progress(f"sketching {len(effects)} suspects on {evaluator.extent}")
        starts = [start] if back is start else [start, back]
        return sketched_from_calibrated(evaluator, there, starts, effects, registry, lasting=view.is_lasting)
    (share, seconds), bare = telling
    short = beginning(evaluator, share, seconds)
    suspects = _surveyed(view, short, bare, progress)
    where = f"on the beginning of the records, the best of them on {evaluator.extent}"
    progress(f"sketching {len(suspects)} suspects {where}")
    schedule = [(*window, MOST_LONG_SKETCHES) for window in _ever_longer(evaluator, share, seconds)]
    return heats(evaluator, start, base, suspects, registry, schedule, near=True)


def _surveyed(view: View, short: Evaluator, bare: Fit, progress: Progress) -> list[Effect]:
    """The best places of every kind that are worth a sketch, from the beginning of what is viewed and a model there."""
    found = survey(short, bare, view.registry, progress, channels=view.channels, longer=view.told)
    return [suspect.effect for suspect in worth_a_sketch(promising(found, PER_KIND, valley(bare.hypothesis.rig)))]


def _ever_longer(evaluator: Evaluator, share: float, seconds: float) -> Windows:
    """Beginnings of the records, each with some twice the samples of the one before, the last with all of them.

    A suspect that explains one second of records to the noise was found to be lost where five followed at once.
    """
    windows = [(share, seconds)]
    while 2 * beginning(evaluator, *windows[-1]).n_data < evaluator.n_data:
        share, seconds = 2.0 * share, 2.0 * seconds
        windows.append((share, seconds))
    return (*windows, (1.0, 0.0))


def afar(view: View, base: Fit, progress: Progress) -> list[Sketch]:
    """Sketches of the best places of every kind, from the beginning of the records and the numbers as given.

    A calibration without the missing effect pulls the numbers to where they imitate it, and the effect added to that
    makes matters worse; from the numbers as given, it helps.

    Args:
        view: what to look in.
        base: the calibrated model on all that is fitted.
        progress: told what is being done.
    """
    start = afresh(base.hypothesis)
    short = beginning(view.evaluator, *HEATS[0][:2])
    bare = fit(short, start, concerning(base, short), max_iterations=0)
    suspects = _surveyed(view, short, bare, progress)
    progress(f"sketching {len(suspects)} suspects on the beginning of the records")
    return heats(view.evaluator, start, base, suspects, view.registry)


def _telling(evaluator: Evaluator, start: Hypothesis, base: Fit) -> tuple[tuple[float, float], Fit] | None:
    """The shortest beginning on which more than noise is left beside the rig's numbers, and the model there.

    Numbers that leave more in proportion to the slopes may leave nothing once they are fitted.
    """
    for share_and_seconds in TELLING_WINDOWS:
        window = beginning(evaluator, *share_and_seconds)
        try:
            bare = fit(window, start, concerning(base, window), max_iterations=0)
        except ArithmeticError:
            return None
        if Projection(bare).misfit > TELLING**2 * bare.n_data and ground_of(window, start, base).bare.ratio > TELLING:
            return share_and_seconds, bare
    return None


TELLING_WINDOWS: Windows = ((0.02, 0.4), (0.1, 0.75), (0.2, 1.5))
"""Shares of the response's energy, and seconds at least, that are surveyed."""

TELLING = 1.3
"""Residual over noise that tells effects apart."""


def worth_a_sketch(suspects: Sequence[Suspect]) -> list[Suspect]:
    """Those that took away more than next to nothing, at one of the sizes they were surveyed at, of what the best did.

    Beside numbers that are off, what is missing took a quarter of that at least; half of all suspects took nothing, or
    made matters worse at every size.

    Args:
        suspects: the best first, with what they took away.
    """
    least = NEXT_TO_NOTHING * suspects[0].gain if suspects else 0.0
    return [suspect for suspect in suspects if suspect.gain >= least] if least > 0.0 else list(suspects)


NEXT_TO_NOTHING = 0.02
"""Share of what the best suspect takes away; where none takes anything, all are sketched."""


def first_of_each_kind(suspects: Sequence[Suspect]) -> list[Suspect]:
    """The best place of every kind before the second place of any.

    Args:
        suspects: the best first.
    """
    best = {suspect.effect.kind: suspect for suspect in reversed(suspects)}
    return [*(s for s in suspects if s is best[s.effect.kind]), *(s for s in suspects if s is not best[s.effect.kind])]
