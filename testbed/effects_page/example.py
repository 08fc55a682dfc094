"""One effect of a kind to show: at a place where it acts, of a size that shows."""

from collections.abc import Callable
from math import inf, log

import numpy as np

from identification.scene import sleeves_of
from models.effects import Effect, Place
from models.errors import DivergenceError
from models.rig import Beam
from testbed.effects_page.bench import Bench
from testbed.effects_page.spectra import amplitudes, lines

WANTED = 0.5
"""Rms over the band of the change in the logarithm of amplitudes, of the sensor and level that change most: 4 dB. Each
octave counts alike, as it does in the picture: what shows at the upper edge of the band alone is not seen there."""

FEW, SMOOTHED = 3, 2.0
"""Realisations, and Hz, over which trials are judged: impacts make single lines depend on everything."""

CLOSE, STEPS = 0.1, 5
"""Relative distance from the wanted size that is good enough, and how many steps lead there."""

LEAST, LARGEST = 0.25, 1.4
"""Share of a trial's size to which it may be scaled: the largest trial is about the largest of its kind."""

UNSEEN = 0.02
"""A size at which amplitudes do not show an effect, but phases may: the last trial, the largest, is then shown."""

ALONG = 0.6
"""Share of the length at which an effect sits that can sit anywhere."""

DIGITS = 3
"""Of a parameter's distance from the value at which the effect is not there."""


def example_of(kind: type[Effect], bench: Bench) -> Effect:
    """The trial value of a kind that comes closest to the wanted size, made as large as that where it can be scaled.

    Args:
        kind: of the library.
        bench: where it is shown.

    Raises:
        DivergenceError: there is no trial value under which the motion stays finite.
    """

    def size(effect: Effect) -> float:
        return _size(effect, bench)

    place = place_for(kind, bench)
    trials = list(kind.trials(bench.scene(place)))
    sizes = {effect: size(effect) for effect in [each for each in trials if not _ends_as_it_began(each)] or trials}
    best = min(reversed(sizes), key=lambda effect: abs(_away(sizes[effect])))
    if sizes[best] == inf:
        message = f"{best.label()}: there is no trial value under which the motion stays finite"
        raise DivergenceError(message)
    return _rounded(_scaled(best, size))


def _ends_as_it_began(effect: Effect) -> bool:
    """A table over the length of a record with the same value at both ends, whose early and late parts look alike."""
    tables = (getattr(effect, name) for name, about in effect.parameters().items() if about.fitted)
    return any(isinstance(table, tuple) and table[0] == table[-1] for table in tables)


def place_for(kind: type[Effect], bench: Bench) -> Place:
    """Where a kind is shown: the sleeve that moves most, else well out on the beam, else a sensor in the middle.

    Args:
        kind: of the library.
        bench: with the rig.
    """
    rig = bench.rig
    if "sleeve" in kind.places:
        return max(sleeves_of(rig), key=lambda place: bench.scene(place).velocity)
    if "position" in kind.places and isinstance(rig.structure, Beam):
        return Place(position=round(ALONG * rig.structure.length, 2))
    if "sensor" in kind.places:
        return Place(sensor=rig.sensors[len(rig.sensors) // 2].name)
    if "sensor pair" in kind.places:
        return Place(sensor=rig.sensors[len(rig.sensors) // 2].name, other=rig.sensors[-1].name)
    return Place()


def _size(effect: Effect, bench: Bench) -> float:
    """Largest change of a sensor's amplitudes at any level; infinite where the motion diverges."""
    try:
        answers = bench.answers_with(effect, realisations=FEW)
    except DivergenceError:
        return inf
    changes = []
    for level, rows in answers.items():
        records = bench.records[level][:FEW]
        before, after = (amplitudes(r, records, SMOOTHED) for r in (bench.answers[level][:FEW], rows))
        changes.append(np.sqrt(np.average(np.log(after / before) ** 2, axis=1, weights=1.0 / lines())).max())
    return float(max(changes))


def _away(size: float) -> float:
    """Logarithmic distance from the wanted size."""
    return log(max(size, UNSEEN) / WANTED)


def _scaled(effect: Effect, size: Callable[[Effect], float]) -> Effect:
    """The effect as large as wanted, if its parameters have a value at which it is not there and amplitudes show it."""
    if size(effect) < UNSEEN or all(about.neutral is None for _, about in effect.fitted_parameters()):
        return effect
    factor = 1.0
    for _ in range(STEPS):
        now = size(effect.scaled(factor))
        if abs(_away(now)) < CLOSE:
            break
        factor = min(max(factor * WANTED / now, LEAST), LARGEST)
    return effect.scaled(factor)


def _rounded(effect: Effect) -> Effect:
    nothing = [about.neutral for _, about in effect.fitted_parameters()]
    from_there = [0.0 if value is None or value == inf else value for value in nothing]
    values = zip(effect.fitted_values(), from_there, strict=True)
    return effect.with_fitted(np.array([there + float(f"{value - there:.{DIGITS}g}") for value, there in values]))
