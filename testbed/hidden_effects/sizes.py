"""The size at which an effect shows as many times the noise as was drawn for it."""

from collections.abc import Iterator
from math import exp, log

import numpy as np

from models.effects import Effect
from testbed.hidden_effects.imitation import Imitation

CLOSE = 1.25
"""Factor within which a size meets what was drawn for it."""

SEARCHES = 8
"""Sizes tried."""

SMALLEST, LARGEST = 1e-5, 30.0
"""Factors on a trial value of the library between which a size is looked for."""

INSIDE = 0.2
"""Share of a bracket that a next size stays away from its ends."""

LEAP, MOST_SHOWN = log(6.0), 1e4
"""Largest step towards a bracket, in e-folds, and what counts as much too much."""

ROUNDS = 4
"""Steps of the calibration that stands for the diagnosis' own."""

SPREAD, WIDER = 1.0, 1.5
"""Of the random factors, in e-folds, on the numbers of a trial: hidden ones do not lie where a search begins; the
second where size is not a factor."""


def sized(start: Effect, imitation: Imitation, wanted: float, rng: np.random.Generator) -> tuple[Effect, float] | None:
    """The effect that shows about as much as wanted, and how much it does; None where no size does.

    Args:
        start: a trial value of the library.
        imitation: what shows beyond what the rig's numbers imitate.
        wanted: times the noise.
        rng: moves the numbers about.
    """
    start = jittered(start, rng, SPREAD)
    has_size = any(about.neutral is not None for _, about in start.fitted_parameters())
    tried = _scaled(start, imitation, wanted) if has_size else _varied(start, imitation, wanted, rng)
    return next(((effect, shown) for effect, shown in tried if 1.0 / CLOSE < shown / wanted < CLOSE), None)


def _scaled(start: Effect, imitation: Imitation, wanted: float) -> Iterator[tuple[Effect, float]]:
    """An effect made larger and smaller, and how much it shows each time."""
    low, high = log(SMALLEST), log(LARGEST)
    for _ in range(10):  # without calibration an effect shows at its smallest size
        middle = 0.5 * (low + high)
        shown = imitation.shown((start.scaled(exp(middle)),), rounds=0)
        low, high = (middle, high) if shown < wanted else (low, middle)
    size, largest = low, log(LARGEST)
    below: tuple[float, float] | None = None
    above: tuple[float, float] | None = None
    for _ in range(SEARCHES):
        effect = start.scaled(exp(size))
        shown = imitation.shown((effect,), ROUNDS)
        yield effect, shown
        if shown < wanted:
            below = (size, log(shown))
        else:
            above = (size, log(min(shown, MOST_SHOWN)))
        if below is not None and above is not None:
            share = (log(wanted) - below[1]) / (above[1] - below[1])
            size = below[0] + min(max(share, INSIDE), 1.0 - INSIDE) * (above[0] - below[0])
        elif below is not None:
            rise = 0.5 * log((wanted**2 - 1.0) / max(shown**2 - 1.0, 1e-3))  # squares beyond the noise in proportion
            size += min(rise, LEAP)
        else:
            size -= LEAP
        if size > largest:
            return


def _varied(
    start: Effect, imitation: Imitation, wanted: float, rng: np.random.Generator
) -> Iterator[tuple[Effect, float]]:
    """An effect without a scale: numbers at random, then halfway between what shows too little and too much."""
    small: Effect | None = None
    large: Effect | None = None
    for _ in range(SEARCHES):
        effect = jittered(start, rng, WIDER) if small is None or large is None else _between(small, large)
        shown = imitation.shown((effect,), ROUNDS)
        yield effect, shown
        small, large = (effect, large) if shown < wanted else (small, effect)


def _between(one: Effect, other: Effect) -> Effect:
    """The effect with the mean of two effects' numbers, the geometric one where both have a sign in common."""
    first, second = one.fitted_values(), other.fitted_values()
    product = first * second
    mean = np.sign(first) * np.sqrt(np.abs(product))
    return one.with_fitted(np.where(product > 0.0, mean, 0.5 * (first + second)))


def jittered(effect: Effect, rng: np.random.Generator, spread: float) -> Effect:
    """The effect with its numbers moved by random factors, thrown back from their bounds.

    At a bound an effect may be another kind (a Hertz contact of exponent 1 is a stiffer spring), which it must not.

    Args:
        effect: of any kind.
        rng: draws the factors.
        spread: standard deviation of their logarithms; at most what is believed beforehand of one that has a scale.
    """
    values = effect.fitted_values()
    for i, (_, about) in enumerate(effect.fitted_parameters()):
        folds = min(spread, about.spread) if about.scale == "log" else spread
        moved = values[i] * np.exp(folds * rng.standard_normal())
        if about.scale == "log" and moved < about.lower:
            moved = about.lower**2 / moved
        elif about.scale == "log" and moved > about.upper:
            moved = about.upper**2 / moved
        values[i] = np.clip(moved, about.lower, about.upper)
    return effect.with_fitted(values)


def on_the_beam(effect: Effect, length: float) -> Effect:
    """The effect with its positions as they act: one beyond the free end is the free end.

    Args:
        effect: of any kind.
        length: of the beam, m.
    """
    values = effect.fitted_values()
    for i, (_, about) in enumerate(effect.fitted_parameters()):
        values[i] = min(values[i], length) if about.on_beam else values[i]
    return effect.with_fitted(values)
