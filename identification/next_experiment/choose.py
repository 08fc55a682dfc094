"""Which affordable test separates the rivals most per minute."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import sqrt

import numpy as np

from identification.evaluate import Evaluator
from identification.next_experiment import candidates
from identification.next_experiment.bench import Bench
from identification.next_experiment.candidates import ABOVE, LEAST_WIDTH, about
from identification.next_experiment.confirm import confirmed
from identification.next_experiment.costs import COSTS, LIMITS, Costs, Limits
from identification.next_experiment.forecast import Forecast, explained_away, followed, forecast
from identification.next_experiment.odds import expected_probability, present_probability
from identification.next_experiment.planned import PlannedTest
from identification.next_experiment.proposal import Option
from identification.next_experiment.rivals import Rival
from identification.outcome import EXCLUDED_BY
from models.arrays import FloatArray
from models.errors import InputError
from models.simulate import Settings
from models.simulators import simulator
from models.simulators.protocol import Resolution

DECISIVE, EXCLUDED = 0.95, sqrt(EXCLUDED_BY)
"""Probability of the right rival that settles a matter, and the separation, in standard deviations, at which
the records themselves exclude a rival in the mean (``outcome.undecided``): of two that predict the same one may be as
probable beforehand, and no test has settled that."""

SHOWN = 5
"""Options that are told."""

MOST_PROJECTED, MOST_OF_A_FAMILY = 12, 2
"""Tests, and those of one family, for which is computed what the rivals' numbers explain away."""


@dataclass(frozen=True, eq=False)
class Question:
    """What is to be decided, and with what.

    Attributes:
        bench: what the rig was tested with.
        rivals: the most probable first, two at least.
        old: the records so far, on which the rivals were fitted; without them no separation is confirmed by a fit.
        misfit: residual over noise of the best of them, 1 at least.
        settings: resolution of the model.
        jobs: cores.
        costs: minutes of what is done.
        limits: how far a test may go.
    """

    bench: Bench
    rivals: tuple[Rival, ...]
    old: Evaluator | None = None
    misfit: float = 1.0
    settings: Settings = field(default_factory=Settings)
    jobs: int = 1
    costs: Costs = COSTS
    limits: Limits = LIMITS

    @property
    def chances(self) -> FloatArray:
        """(K,) present probabilities."""
        return np.array([rival.chance for rival in self.rivals])

    def seen(self, tests: Iterable[PlannedTest]) -> Iterator[Forecast]:
        """The forecast of each test that stays within the limits and that all rivals survive."""
        for test in tests:
            try:
                if not candidates.allowed(test, self.bench, self.limits):
                    continue
                seen = forecast(self.bench, self.rivals, test, self.misfit, self.settings, self.jobs)
            except (ArithmeticError, InputError):
                continue
            if seen.reach <= self.limits.reading:
                yield seen


def options_of(question: Question) -> tuple[Option, ...]:
    """The tests that promise most, the best first.

    What the numbers of the rivals explain away only takes from a separation, and so does a fit: a test is looked at
    closely only if it is good before that, and none is proposed whose separation was not confirmed.

    Args:
        question: what is to be decided, and with what.
    """
    seen = list(question.seen(_tests(question)))
    rough = [(each, _option(question, each, each.scatter())) for each in seen]
    rough.sort(key=lambda pair: _merit(question, pair[1]), reverse=True)
    rows = [_projected(question, each) for each, _ in _varied(rough)]
    rows.sort(key=lambda row: _merit(question, row.option), reverse=True)
    if question.old is None:
        return tuple(row.option for row in rows[:SHOWN])
    for _ in range(MOST_CONFIRMED):
        if not rows or rows[0].option.confirmed:
            break
        rows = [*_confirmed(question, question.old, rows[0]), *rows[1:]]
        rows.sort(key=lambda row: _merit(question, row.option), reverse=True)
    sure = next((number for number, row in enumerate(rows) if row.option.confirmed), len(rows))
    return tuple(row.option for row in rows[sure : sure + SHOWN])


MOST_CONFIRMED = 6
"""Of the best tests whose promise is confirmed by fits, until the best of all is; if none is by then, the best of these
is proposed."""


@dataclass(frozen=True, eq=False)
class _Row:
    option: Option
    seen: Forecast
    scatter: FloatArray


def _projected(question: Question, seen: Forecast) -> _Row:
    """With what can be followed only, and without what the rivals' numbers explain away."""
    part = followed(seen)
    scatter = explained_away(part, question.rivals)
    return _Row(_option(question, part, scatter), part, scatter)


def _confirmed(question: Question, old: Evaluator, row: _Row) -> list[_Row]:
    """A row with what fits leave of its promise; none where a fit has lost its way."""
    try:
        scatter = confirmed(row.seen, question.rivals, old, row.scatter)
    except ArithmeticError:
        return []
    option = replace(_option(question, row.seen, scatter), confirmed=True)
    return [replace(row, option=option, scatter=scatter)]


def _varied(rough: Sequence[tuple[Forecast, Option]]) -> list[tuple[Forecast, Option]]:
    """The first ones, few of each family, so that a family that is all explained away leaves others."""
    kept: list[tuple[Forecast, Option]] = []
    for pair in rough:
        family = [other for other in kept if other[1].test.family == pair[1].test.family]
        if len(family) < MOST_OF_A_FAMILY:
            kept.append(pair)
    return kept[:MOST_PROJECTED]


def _option(question: Question, seen: Forecast, scatter: FloatArray) -> Option:
    pairs = ~np.eye(len(scatter), dtype=bool)
    apart = np.stack([np.diag(each) for each in scatter])[pairs]
    return Option(
        test=seen.test,
        expected_probability=expected_probability(question.chances, scatter),
        separation=float(np.sqrt(apart.min())),
        reach=seen.reach,
        followed=seen.useful,
    )


def _merit(question: Question, option: Option) -> tuple[bool, float, float, float]:
    """Decisive first; then the gain of probability per minute, to two digits; where that is alike, the separation.

    A separation that is ample needs no more: then the test that is gentlest on the rig.
    """
    gain = (option.expected_probability - present_probability(question.chances)) / option.test.minutes
    ample = min(option.separation, AMPLE)
    return settles(option), float(f"{gain:.2g}"), ample, -option.reach


def settles(option: Option) -> bool:
    """Whether a test is expected to leave one rival alone, by what it measures."""
    return is_decisive(option.expected_probability, option.separation)


def is_decisive(expected_probability: float, separation: float) -> bool:
    """Whether a promise is that of a test that settles the matter.

    Args:
        expected_probability: of the right one afterwards.
        separation: in standard deviations.
    """
    return expected_probability >= DECISIVE and separation >= EXCLUDED


AMPLE = 10.0
"""Standard deviations beyond which more would only make up for a model that is wrong in another way."""


def _tests(question: Question) -> Iterator[PlannedTest]:
    """All that is worth a forecast; what the first of them shows decides about bands and a sensor."""
    bench, costs = question.bench, question.costs
    yield from candidates.at_the_shaker(bench, costs)
    yield from candidates.elsewhere(bench, costs)
    yield from candidates.in_bands(bench, costs, _bands(question))
    for spot in _spots(question):
        yield from candidates.with_a_sensor(bench, costs, spot)
    for test in (*candidates.struck(bench, costs), *candidates.released(bench, costs)):
        yield from _within_reach(question, test)


def _within_reach(question: Question, unit: PlannedTest) -> Iterator[PlannedTest]:
    """A blow or a hold as hard as the sensors have seen, and harder."""
    free = replace(question, rivals=question.rivals[:1], limits=replace(question.limits, reading=np.inf))
    (small,) = list(free.seen([unit])) or (None,)
    if small is not None and small.reach > 0.0:
        for wanted in READINGS:
            yield candidates.scaled(unit, wanted / small.reach)


READINGS = (1.0, 3.0)
"""Largest readings that blows and holds aim at, times the largest so far."""


def _bands(question: Question) -> Mapping[str, tuple[float, float]]:
    """The lowest resonances, and where the rivals differ most."""
    bench = question.bench
    if bench.level == 0.0:
        return {}
    low, high = bench.band
    bands: dict[str, tuple[float, float]] = {}
    plant = question.rivals[0].hypothesis.plant()
    if plant.structure.is_beam:
        second = float(simulator("modal").natural_freqs(plant, 2, Resolution())[1])
        if low < second < high / NARROWER:
            bands["lowest resonances"] = (low, ABOVE * second)
    here = list(question.seen([candidates.steady(bench, question.costs, 1.0, bench.band, "")]))
    if here:
        centre = _differs_most(here[0])
        bands["where the rivals differ"] = about(centre, bench.band)
    return {words: band for words, band in bands.items() if band[1] - band[0] >= LEAST_WIDTH}


NARROWER = 1.6
"""How much narrower than the whole the band of the lowest resonances is at least, as a ratio of upper edges."""


def _differs_most(seen: Forecast) -> float:
    """Frequency, Hz, about which the rivals lie farthest apart in a test."""
    (target,) = seen.evaluator.timed
    rows = seen.residuals.view(complex).reshape(len(seen.residuals), *target.measured.shape)
    power = np.sum(np.abs(rows) ** 2, axis=(0, 1))
    freq = np.arange(len(power)) / target.record.duration
    total = np.concatenate([[0.0], np.cumsum(power)])
    inside = np.searchsorted(freq, ABOVE * freq) - np.searchsorted(freq, freq / ABOVE)
    first = np.searchsorted(freq, freq / ABOVE)
    return float(freq[np.argmax(total[first + inside] - total[first])])


def _spots(question: Question) -> list[float]:
    """Where one more sensor would see the rivals lie farthest apart."""
    bench, spots = question.bench, candidates.between(question.bench)
    if not spots or bench.level == 0.0:
        return []
    test = candidates.steady(bench, question.costs, 1.0, bench.band, "")
    apart = []
    for spot in spots:
        rows = list(question.seen([replace(test, sensor=spot)]))
        change = (
            rows[0].residuals.reshape(len(question.rivals), len(bench.sensors) + 1, -1)[:, -1] if rows else np.zeros(1)
        )
        apart.append(float(np.sum(change**2)))
    return [spots[int(np.argmax(apart))]]
