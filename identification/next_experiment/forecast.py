"""What rivals predict for a test that nobody has done, how far apart, and how much of that can be explained away.

The separation of a wrong rival b from the right one a is d^2 = delta' (I + J C J')^-1 delta: the squared difference of
their predictions in units of the noise, less what b's numbers, moved within what the records so far leave open, take
away. docs/theory.md, "The next experiment", derives it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi, sqrt

import numpy as np

from identification.evaluate import Evaluator, TimeTarget, carry_noise
from identification.evidence import unit_of
from identification.hypothesis import Hypothesis, OwnNumber, Unknown, coordinates, own_numbers
from identification.next_experiment.bench import Bench
from identification.next_experiment.planned import PlannedTest
from identification.next_experiment.rivals import Rival
from identification.noise import Noise
from identification.prepare import horizons, start_unknowns
from models.arrays import FloatArray
from models.band_limit import STOP_EDGE
from models.modal import build_modal
from models.record import Record
from models.simulate import Settings
from models.simulators.modal import held
from models.simulators.protocol import Hold

LOOKED_AT = 2.0
"""Seconds of a steady test that are simulated; the rest of it tells as much again."""

LARGEST_MOVE = 0.05
"""Of an unknown in its own coordinate, within which a prediction is taken to change in proportion."""

PHASE_SPREAD = pi / sqrt(3.0)
"""Standard deviation of a phase of which nothing is known."""

START_SPREAD = 10.0
"""What is known of the state at the first sample of a decay: nothing, in units of a typical size."""


@dataclass(frozen=True, eq=False)
class Forecast:
    """Predictions of all rivals for one test.

    Attributes:
        test: that is planned.
        evaluator: with the test's record, in which the first rival's prediction stands for what was measured.
        models: the rivals on this test, with their starts.
        residuals: (K, n_data) predictions less the first rival's, in units of the noise.
        misfit: residual over noise that the best model leaves, 1 at least.
        n_before: real numbers in the residuals of the records so far.
        useful: seconds of the test for which neighbouring motions stay together.
        reach: largest reading that a rival predicts, times the largest so far.
    """

    test: PlannedTest
    evaluator: Evaluator
    models: tuple[Hypothesis, ...]
    residuals: FloatArray
    misfit: float
    n_before: int
    useful: float
    reach: float

    @property
    def longer(self) -> float:
        """The useful part of the test over what of it is simulated."""
        (target,) = self.evaluator.timed
        return max(1.0, self.useful / target.record.duration)

    @property
    def unit(self) -> float:
        """The square of the unit in which old and new records together will be weighed (``evidence.unit_of``)."""
        n_data = self.n_before + self.longer * self.evaluator.n_data
        return unit_of(self.evaluator.repeats, self.misfit, n_data)

    @property
    def weight(self) -> float:
        """What a unit of squared difference says afterwards."""
        return self.longer / self.unit

    def scatter(self, columns: Sequence[FloatArray] | None = None) -> FloatArray:
        """(K, K, K) covariance of the log odds of the first rival against the two others, if the first is right.

        Args:
            columns: (m, n_data) of each rival, what its numbers can do; without them nothing is explained away.
        """
        k = len(self.residuals)
        found = np.zeros((k, k, k))
        for a in range(k):
            delta = np.sqrt(self.weight) * (self.residuals - self.residuals[a])
            left = np.stack(
                [_left(d, None if columns is None else np.sqrt(self.weight) * columns[b]) for b, d in enumerate(delta)]
            )
            size = np.sqrt(np.maximum(np.sum(delta * left, axis=1), 0.0))
            length = np.linalg.norm(left, axis=1)
            along = left * (size / np.where(length > 0.0, length, 1.0))[:, None]
            found[a] = along @ along.T
        return found


def _left(delta: FloatArray, columns: FloatArray | None) -> FloatArray:
    """(n_data,) S^-1 delta with S = I + columns' columns, by the Woodbury identity."""
    if columns is None or not len(columns):
        return delta
    inner = np.eye(len(columns)) + columns @ columns.T
    return np.asarray(delta - columns.T @ np.linalg.solve(inner, columns @ delta))


def forecast(
    bench: Bench, rivals: Sequence[Rival], test: PlannedTest, misfit: float, settings: Settings, jobs: int
) -> Forecast:
    """Predict a test with every rival at its fit.

    Args:
        bench: what the rig was tested with.
        rivals: the first of which stands for what was measured.
        test: to be done.
        misfit: residual over noise that the best model leaves, 1 at least.
        settings: resolution of the model.
        jobs: cores.

    Raises:
        ArithmeticError: a rival's motion leaves the finite numbers.
        InputError: a rival finds no rest under the hold.
    """
    if test.sensor is not None:
        bench = bench.with_sensor(test.sensor)
    seconds = min(test.seconds, LOOKED_AT) if test.is_steady else test.seconds
    silent = test.record("next", bench.sensors, seconds)
    models = tuple(_let_go(bench.at(rival.hypothesis), test, silent.name) for rival in rivals)
    noise = Noise(bench.noise, 0.0 if test.is_held else bench.force_noise, "of the records so far", "")
    bare = Evaluator([TimeTarget.of(silent, noise)], jobs, settings)
    clean = bare.responses(models[0])[0].channels
    record = replace(silent, responses=clean)
    evaluator = bare.with_targets([TimeTarget.of(record, noise)])
    evaluator = evaluator.with_targets(carry_noise(evaluator, models[0], np.random.default_rng(0), CARRIED))
    rows = evaluator.residuals([(model, None) for model in models])
    if any(row is None for row in rows):
        raise ArithmeticError("a rival diverges in this test")
    residuals = np.stack([row for row in rows if row is not None])
    n_before = rivals[0].fit.n_data
    return Forecast(test, evaluator, models, residuals, misfit, n_before, test.seconds, bench.reach(clean))


CARRIED = 2
"""Realisations of the excitation's noise."""


def _let_go(hypothesis: Hypothesis, test: PlannedTest, name: str) -> Hypothesis:
    """The hypothesis with the state at the first sample, if the test begins with a hold."""
    if not test.is_held:
        return hypothesis
    model = build_modal(hypothesis.plant(), STOP_EDGE * test.fs)
    bent = held(model, Hold(test.excitation["position"], test.excitation["force"]))
    return replace(hypothesis, starts={name: np.append(bent, np.zeros(model.n))})


def followed(seen: Forecast) -> Forecast:
    """The forecast without what lies beyond the time for which neighbouring motions stay together.

    Args:
        seen: predictions at the fits.
    """
    (target,) = seen.evaluator.timed
    seconds, whole = target.record.duration, seen.test.seconds
    silent = TimeTarget.of(seen.test.record(target.record.name, target.record.sensors), target.noise)
    (limit,) = horizons(seen.evaluator.with_targets([silent]), seen.models[0])
    useful = min(limit.seconds, whole)
    part = replace(seen, useful=useful)
    if useful >= seconds:
        return part
    short = seen.evaluator.with_targets([target.cut(round(useful * target.record.fs))])
    rows = short.residuals([(model, None) for model in seen.models])
    return replace(part, evaluator=short, residuals=np.stack([row for row in rows if row is not None]))


def explained_away(seen: Forecast, rivals: Sequence[Rival]) -> FloatArray:
    """(K, K, K) covariance of the log odds when each rival's numbers have explained away what they can.

    Args:
        seen: predictions at the fits.
        rivals: the same.
    """
    parts = zip(rivals, seen.models, seen.residuals, strict=True)
    return seen.scatter([columns_of(seen.evaluator, rival, model, row) for rival, model, row in parts])


def columns_of(evaluator: Evaluator, rival: Rival, model: Hypothesis, residual: FloatArray) -> FloatArray:
    """(m, n_data) what each principal axis of what is known of a rival does to its prediction.

    Args:
        evaluator: with the test's record.
        rival: of the group.
        model: the rival on this test.
        residual: (n_data,) its own.
    """
    at, own = replace(rival, hypothesis=model), own_of_test(model, [t.record for t in evaluator.timed])
    moves, spreads = [], []
    for axis in rival.axes:
        share = min(1.0, LARGEST_MOVE / max(float(np.abs(axis).max()), np.finfo(float).tiny))
        moves.append(_within_bounds(at, share * axis))
        spreads.append(1.0 / share)
    for unknown in own:
        moves.append(unknown.set(model, unknown.get(model) + unknown.step))
        spreads.append((PHASE_SPREAD if isinstance(unknown, OwnNumber) else START_SPREAD) / unknown.step)
    rows = evaluator.residuals([(moved, None) for moved in moves])
    kept = [spread * (row - residual) for row, spread in zip(rows, spreads, strict=True) if row is not None]
    return np.stack(kept) if kept else np.empty((0, len(residual)))


def own_of_test(model: Hypothesis, records: Sequence[Record]) -> tuple[Unknown, ...]:
    """What the records of a test have for themselves: states at the start, and numbers of effects, as phases.

    Args:
        model: of a rival.
        records: of the test.
    """
    names = [record.name for record in records]
    own = (unknown for i, effect in enumerate(model.effects) for unknown in own_numbers(effect, i, names))
    return (*start_unknowns(model, records), *own)


def _within_bounds(rival: Rival, along: FloatArray) -> Hypothesis:
    """The rival moved along an axis, the other way where a number is at its bound."""
    before = coordinates(rival.hypothesis, rival.unknowns)
    ways = [rival.moved(along), rival.moved(-along)]
    gone = [float(np.abs(coordinates(way, rival.unknowns) - before).sum()) for way in ways]
    return ways[0] if gone[0] >= gone[1] else ways[1]
