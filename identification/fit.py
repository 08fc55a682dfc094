"""Nonlinear least squares over the unknowns of a hypothesis, with what is known beforehand as further data.

Levenberg and Marquardt's method. Differences for all columns of the Jacobian cost many times what a step does, so the
columns follow what the steps show (``_along_step``), and are formed anew where a step does not bring what it promised,
and where the fit ends. Columns that another fit has formed are kept as they are until then, or follow the steps too.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from identification.evaluate import Evaluator
from identification.hypothesis import Hypothesis, Unknown, at_coordinates, coordinates
from identification.wire import sent_once
from models.arrays import BoolArray, FloatArray


@sent_once
@dataclass(frozen=True, eq=False)
class Fit:
    """A hypothesis at the least-squares minimum of some unknowns.

    Attributes:
        hypothesis: with the fitted values.
        unknowns: what was moved.
        chi2: sum of squared residuals in units of the noise, without the prior's part.
        penalty: the prior's part.
        n_data: chi-square that noise alone leaves in the mean: the numbers in the residual, but for samples at the
            start of a record that are not judged in full.
        residual: (n_data,) in units of the noise.
        jacobian: (n_unknowns, n_data).
        covariance: (n_unknowns, n_unknowns) in the unknowns' own coordinates, for noise of the estimated size,
            times ``widened`` on both sides.
        repeats: how many times chi-square counts noise that all channels share, at most.
        widened: (n_unknowns,) or 1, factor on each deviation for what noise does not do (``scatter.widening``).
    """

    hypothesis: Hypothesis
    unknowns: tuple[Unknown, ...]
    chi2: float
    penalty: float
    n_data: int
    residual: FloatArray
    jacobian: FloatArray
    covariance: FloatArray
    repeats: float = 1.0
    widened: FloatArray | float = 1.0

    @property
    def cost(self) -> float:
        """What was minimised."""
        return self.chi2 + self.penalty

    @property
    def ratio(self) -> float:
        """Residual over noise: 1 for a perfect model and a perfect estimate of the noise."""
        return float(np.sqrt(self.chi2 / self.n_data))

    def std(self) -> FloatArray:
        """Standard deviation of each unknown in its own coordinate, widened where the model misses the data."""
        return np.asarray(np.sqrt(np.diag(self.covariance)) * max(1.0, self.ratio))

    @property
    def unfinished(self) -> float:
        """Share of the cost that a step more would take away, were the model linear there: next to 0 at a minimum."""
        _, promise = newton_step(self.hypothesis, self.unknowns, self.jacobian, self.residual)
        return promise / max(self.cost, LEAST_GAIN)


def newton_step(
    hypothesis: Hypothesis, unknowns: Sequence[Unknown], jacobian: FloatArray, residual: FloatArray
) -> tuple[FloatArray, float]:
    """(n_unknowns,) step to where a linear model has its minimum, within bounds, and by how much the cost would fall.

    Args:
        hypothesis: where it begins.
        unknowns: what may move.
        jacobian: (n_unknowns, n_data) slopes there.
        residual: (n_data,) there.
    """
    prior, x = prior_of(unknowns), coordinates(hypothesis, unknowns)
    gradient = jacobian @ residual + prior * x
    normal = jacobian @ jacobian.T + np.diag(prior)
    held = normal + NEAR_DAMPING * np.diag(np.diag(normal) + np.finfo(float).tiny)
    step = _bounded(_free_step(_State(hypothesis, x, residual, 0.0), tuple(unknowns), held, gradient))
    return step, max(0.0, _promise(gradient, normal, step))


def prior_of(unknowns: Sequence[Unknown]) -> FloatArray:
    """(n_unknowns,) 1 for what is known beforehand, in its own coordinate, and 0 for the others."""
    return np.array([1.0 if unknown.prior else 0.0 for unknown in unknowns])


@dataclass
class _State:
    hypothesis: Hypothesis
    x: FloatArray
    residual: FloatArray
    cost: float


def fit(
    evaluator: Evaluator,
    hypothesis: Hypothesis,
    unknowns: Sequence[Unknown],
    *,
    max_iterations: int = 12,
    jacobian: FloatArray | None = None,
    keep: bool = False,
    along_steps: bool = False,
    precise: bool = False,
    formed: bool = False,
    tolerance: float = 2e-4,
    like: Fit | None = None,
) -> Fit:
    """Move the unknowns to the minimum of chi-square plus prior.

    Args:
        evaluator: records and noise.
        hypothesis: where to start.
        unknowns: what may move; those of records that the evaluator does not hold are left out.
        max_iterations: of Levenberg and Marquardt; a step before which all columns follow the steps counts for less.
        jacobian: (n_kept, n_data) columns of the first unknowns, known from an earlier fit nearby.
        keep: never form the columns in ``jacobian`` anew; a quick look, not the minimum.
        along_steps: these follow what the steps show, where they are not formed anew.
        precise: go on where no step brings anything, with next to no damping, and end with differences taken where the
            fit ends, of which covariances and evidence can be formed.
        formed: ``jacobian`` has all columns, and they were formed where the fit begins.
        tolerance: relative decrease of the cost that ends the fit.
        like: a fit nearby, perhaps to other records: its slopes tell how far to move a number for its first difference.

    Raises:
        ArithmeticError: the start itself diverges.
    """
    there = {target.record.name for target in evaluator.targets}
    unknowns = tuple(unknown for unknown in unknowns if unknown.record is None or unknown.record in there)
    prior = prior_of(unknowns)
    state = _start(evaluator, hypothesis, unknowns, prior)
    rows, kept = _known_rows(jacobian, (len(unknowns), evaluator.n_data))
    _differentiate(evaluator, state, unknowns, rows, range(kept, len(unknowns)), like)
    fresh, follow, near, curved, damping = formed or kept == 0, False, False, False, FAR_DAMPING
    kept, spent = 0 if formed else kept, 0.0
    while spent < max_iterations:
        spent += WITHOUT_DIFFERENCES if follow else 1.0
        tries = 1 if follow else MOST_TRIES
        new, promised, next_damping = _step(
            evaluator, state, unknowns, prior, rows, damping, tries, bent=curved and fresh
        )
        gained = state.cost - new.cost
        if gained > 0 or not follow:
            damping = next_damping
        before, state = state, new if gained > 0 else state
        share, least = gained / max(promised, LEAST_GAIN), max(tolerance * state.cost, LEAST_GAIN)
        curved = curved or (not follow and (gained < POOR_SHARE * promised or damping > FAR_DAMPING))
        small = gained < least and (keep or share < 1.0 / POOR_SHARE)
        if small and (fresh or keep or (precise and promised < least)):
            if near or not precise:
                break
            near, damping = True, NEAR_DAMPING
        refresh_all = near or (not keep and (small or not POOR_SHARE < share < 1.0 / POOR_SHARE))
        follow = not (refresh_all or kept or curved) and FOLLOWED_SHARE < share < 1.0 / FOLLOWED_SHARE
        follow = follow and spent < max_iterations
        first = 0 if refresh_all else kept
        if follow or along_steps:
            _along_step(evaluator, rows, state.x - before.x, state.residual - before.residual)
        if not follow:
            _differentiate(evaluator, state, unknowns, rows, range(first, len(unknowns)))
        if near:
            _along_valleys(evaluator, state, unknowns, rows)
        fresh = not follow and first == 0
    if precise and not near:
        if not fresh or max_iterations == 0:  # those formed before any step may be too wide
            _differentiate(evaluator, state, unknowns, rows, range(len(unknowns)))
        _along_valleys(evaluator, state, unknowns, rows)
    normal = rows @ rows.T + np.diag(prior)
    chi2 = float(state.residual @ state.residual)
    return Fit(
        state.hypothesis,
        unknowns,
        chi2,
        state.cost - chi2,
        evaluator.n_judged,
        state.residual,
        rows,
        inverse_of(normal),
        evaluator.repeats,
    )


def _known_rows(jacobian: FloatArray | None, shape: tuple[int, int]) -> tuple[FloatArray, int]:
    """Rows for all slopes, of which the first are known, and how many."""
    rows, kept = np.zeros(shape), 0 if jacobian is None else len(jacobian)
    if jacobian is not None:
        rows[:kept] = jacobian
    return rows, kept


LOOK, LOOK_TOLERANCE = 5, 0.02
"""Iterations and tolerance of a look at where a fit is going, before it is followed."""


LAST_ITERATIONS = 6
"""Of a run of the fit of everything, before it is asked whether it goes on."""


def fit_to_its_end(
    evaluator: Evaluator,
    hypothesis: Hypothesis,
    unknowns: Sequence[Unknown],
    iterations: int = LAST_ITERATIONS,
    like: Fit | None = None,
) -> Fit:
    """The fit, gone on from where it stopped for as long as a step more promises much and each run keeps its promise.

    A curved valley is followed by short steps, which look like an end.

    Args:
        evaluator: records and noise.
        hypothesis: where to start.
        unknowns: what may move.
        iterations: of a run.
        like: a fit nearby, perhaps to other records, as for ``fit``.

    Raises:
        ArithmeticError: the start itself diverges.
    """
    run = partial(fit, evaluator, unknowns=unknowns, max_iterations=iterations, tolerance=0.0, precise=True)
    found, largest = run(hypothesis, like=like), np.inf
    for _ in range(MOST_RUNS - 1):
        promised = found.unfinished * found.cost
        if promised < NO_FARTHER * max(1.0, found.ratio**2) or found.cost > largest:
            break
        largest = found.cost - KEPT * promised
        found = run(found.hypothesis, jacobian=found.jacobian, formed=True)
    return found


MOST_RUNS = 4

NO_FARTHER, KEPT = 4.0, 0.1
"""Decrease of chi-square that a step more promises, two standard deviations' worth of what is left, from which a fit
goes on, and the share of the last promise that each run must have kept: six iterations on 40 s of records stopped 50
standard deviations before the end of a valley."""


def inverse_of(normal: FloatArray) -> FloatArray:
    """The inverse in which what the data do not tell is not known, instead of known to be 0.

    Args:
        normal: (n_unknowns, n_unknowns) information in the unknowns' own coordinates.
    """
    value, vector = np.linalg.eigh(normal)
    return np.asarray((vector / np.maximum(value, NOT_TOLD)) @ vector.T)


NOT_TOLD = 1e-6
"""Information, in an unknown's own coordinate, that counts as none: a standard deviation of a thousand units."""

LEAST_GAIN = 0.1
"""A smaller decrease of chi-square moves no unknown by more than a third of its standard deviation."""

POOR_SHARE = 0.6
"""Where a step brings less than this share of what it promised, or that much more, the kept columns are out of date. So
much more it brings along a valley that bends, and however little that is, it is not the end."""

FOLLOWED_SHARE, WITHOUT_DIFFERENCES = 0.8, 0.25
"""The same for columns that follow the steps, and what a step with them counts for among the iterations: the rest are
the differences, of ten numbers or so."""

FAR_DAMPING, NEAR_DAMPING = 1e-3, 1e-9
"""Damping at first, as a share of each unknown's information: from afar, and near the minimum with fine differences,
where what is left to follow are valleys that only a prior closes."""

DAMPINGS = (1.0, 0.03, 30.0)
"""Factors on the damping tried together, so that no core waits."""

MOST_TRIES = 4
"""Dampings, each a hundred times the one before, until a step takes anything away; one where columns follow the steps,
which are then formed anew."""

LARGEST_STEP = 2.0
"""Largest move of an unknown in one iteration, in its own coordinate."""


def _start(evaluator: Evaluator, hypothesis: Hypothesis, unknowns: tuple[Unknown, ...], prior: FloatArray) -> _State:
    residual = evaluator.residuals([(hypothesis, None)])[0]
    if residual is None:
        raise ArithmeticError("the model to start from diverges")
    x = coordinates(hypothesis, unknowns)
    return _State(hypothesis, x, residual, float(residual @ residual + prior @ x**2))


def _differentiate(
    evaluator: Evaluator,
    state: _State,
    unknowns: tuple[Unknown, ...],
    rows: FloatArray,
    which: Iterable[int],
    like: Fit | None = None,
) -> None:
    """Fill rows with differences that tell numbers apart.

    A coordinate is moved by what changes the residual by a small share only: where two numbers nearly imitate each
    other, the curvature over wide differences is larger than what tells them apart, and the fit crawls. How much that
    is the row so far tells, or that of a fit nearby; a first row that was far off is formed again.
    """
    wanted = max(LEAST_CHANGE, SHARE_OF_RESIDUAL * float(np.linalg.norm(state.residual)))
    known = {k: float(np.linalg.norm(rows[k])) for k in which}
    guessed = {} if like is None else _sizes_of(like, evaluator.n_data)
    steps = {k: _step_for(unknowns[k], norm or guessed.get(unknowns[k], 0.0), wanted) for k, norm in known.items()}
    _difference(evaluator, state, unknowns, rows, steps)
    first = {k: float(np.linalg.norm(rows[k])) for k, norm in known.items() if norm == 0.0}
    better = {k: _step_for(unknowns[k], norm, wanted) for k, norm in first.items()}
    changes = {k: norm * steps[k] for k, norm in first.items()}
    far_off = [
        k
        for k, change in changes.items()
        if change > FAR_OFF * wanted or (change < wanted / FAR_OFF and steps[k] < unknowns[k].step)
    ]
    _difference(evaluator, state, unknowns, rows, {k: better[k] for k in far_off})


def _step_for(unknown: Unknown, size: float, wanted: float) -> float:
    """The step that changes the residual by so much where the slopes are of this norm; its own where that is 0."""
    return unknown.step if size == 0.0 else min(max(wanted / size, LEAST_STEP), unknown.step)


def _sizes_of(found: Fit, n_data: int) -> dict[Unknown, float]:
    """Norm that each unknown's slopes of a fit would have on so many data; of a record's own as many as they had."""
    longer = float(np.sqrt(n_data / max(found.jacobian.shape[1], 1)))
    norms = np.linalg.norm(found.jacobian, axis=1).tolist()
    rows = zip(found.unknowns, norms, strict=True)
    return {unknown: norm * (longer if unknown.record is None else 1.0) for unknown, norm in rows}


def _difference(
    evaluator: Evaluator, state: _State, unknowns: tuple[Unknown, ...], rows: FloatArray, steps: Mapping[int, float]
) -> None:
    """Fill rows with one-sided differences over these steps; a coordinate at its bound is moved the other way."""
    moved: list[Hypothesis] = []
    for k, step in steps.items():
        forward = unknowns[k].set(state.hypothesis, state.x[k] + step)
        if abs(unknowns[k].get(forward) - state.x[k]) < 0.5 * step:
            forward = unknowns[k].set(state.hypothesis, state.x[k] - step)
        moved.append(forward)
    results = evaluator.residuals([(h, unknowns[k].record) for h, k in zip(moved, steps, strict=True)])
    for k, new, hypothesis in zip(steps, results, moved, strict=True):
        change = unknowns[k].get(hypothesis) - state.x[k]
        if new is None or change == 0:
            rows[k] = 0.0
            continue
        rows[k] = np.where(_acts(evaluator, unknowns[k]), new - state.residual, 0.0) / change


def _along_valleys(evaluator: Evaluator, state: _State, unknowns: tuple[Unknown, ...], rows: FloatArray) -> None:
    """Correct the rows along directions in which they nearly cancel, where their own errors would close a valley.

    Differences of impacting motion are good to a hundredth. Of two rows whose difference is smaller than that, only a
    difference along the valley itself tells what is left. What one record alone has (its start, its own phase) stays
    without slope in the others. Source: C. G. Broyden, Math. Comput. 19 (1965) 577, eq. 4.5; where slopes are known to
    be 0, L. K. Schubert, Math. Comput. 24 (1970) 27.
    """
    records = list(_by_record(evaluator, unknowns))
    for _ in range(VALLEY_ROUNDS):
        norms = np.linalg.norm(rows, axis=1)
        told = np.flatnonzero(norms > 0.0)
        if not len(told):
            return
        unit = rows[told] / norms[told, None]
        size, directions = np.linalg.eigh(unit @ unit.T)
        weak = np.flatnonzero(size < NEARLY_CANCELLED**2)
        if not len(weak):
            return
        slope_of: dict[int, FloatArray] = {}
        for k in weak.tolist():
            along = np.zeros(len(unknowns))
            along[told] = directions[:, k] / norms[told]
            slope = _slope_along(evaluator, state, unknowns, along, float(np.sqrt(max(size[k], 0.0))))
            if slope is not None and np.linalg.norm(slope) < TOO_STEEP:
                slope_of[k] = slope
        if not slope_of:
            return
        valleys, slopes = directions[:, list(slope_of)], np.stack(list(slope_of.values()))
        for acts, data in records:
            unit[:, data] += _least_change(valleys, acts[told], slopes[:, data] - valleys.T @ unit[:, data])
        rows[told] = unit * norms[told, None]


def _along_step(evaluator: Evaluator, rows: FloatArray, step: FloatArray, change: FloatArray) -> None:
    """Correct the rows by what a step has changed, in each record the least in units in which each has norm 1 there.

    What has no slope in a record keeps none. Source: C. G. Broyden, Math. Comput. 19 (1965) 577, eq. 4.5; K. Madsen,
    H. B. Nielsen, O. Tingleff, Methods for non-linear least squares problems (2004), section 3.5; where slopes are
    known to be 0, L. K. Schubert, Math. Comput. 24 (1970) 27.

    Args:
        evaluator: records of the fit.
        rows: (n_unknowns, n_data) slopes, changed in place.
        step: (n_unknowns,) by how much the unknowns were moved.
        change: (n_data,) what that did to the residual.
    """
    for _, data in _data_of(evaluator):
        part = rows[:, data]
        weights = step * np.einsum("kn,kn->k", part, part)
        length = float(step @ weights)
        if length > 0.0:
            part += np.outer(weights / length, change[data] - step @ part)


def _by_record(evaluator: Evaluator, unknowns: tuple[Unknown, ...]) -> Iterator[tuple[BoolArray, slice]]:
    """For each record, (n_unknowns,) which unknowns act in it, and where its numbers are in the residual."""
    for name, data in _data_of(evaluator):
        yield np.array([unknown.record in (None, name) for unknown in unknowns]), data


def _data_of(evaluator: Evaluator) -> Iterator[tuple[str, slice]]:
    """The name of each record, and where its numbers are in the residual."""
    start = 0
    for target in evaluator.targets:
        yield target.record.name, slice(start, start + target.n_data)
        start += target.n_data


def _least_change(directions: FloatArray, acts: BoolArray, missed: FloatArray) -> FloatArray:
    """(n_rows, n_data) the least change of the rows that act which adds to each direction what it misses.

    Args:
        directions: (n_rows, n_directions) orthonormal.
        acts: (n_rows,) rows that may change.
        missed: (n_directions, n_data); of what hardly acts, only its share is added.
    """
    own = directions * acts[:, None]
    share, turned = np.linalg.eigh(own.T @ own)
    return np.asarray(own @ (turned / np.maximum(share, LEAST_ACTING)) @ (turned.T @ missed))


def _slope_along(
    evaluator: Evaluator, state: _State, unknowns: tuple[Unknown, ...], along: FloatArray, size: float
) -> FloatArray | None:
    """(n_data,) central difference along a direction whose slope is about so large; None where a bound stops it."""
    wanted = max(LEAST_CHANGE, SHARE_OF_RESIDUAL * float(np.linalg.norm(state.residual)))
    length = min(wanted / max(size, 1e-12), VALLEY_STEP / np.abs(along).max())
    there, back = (at_coordinates(state.hypothesis, unknowns, state.x + way * length * along) for way in (1.0, -1.0))
    span = coordinates(there, unknowns) - coordinates(back, unknowns)
    after, before = evaluator.residuals([(there, None), (back, None)])
    if after is None or before is None or not np.allclose(span, 2.0 * length * along, rtol=1e-6, atol=1e-12):
        return None
    return np.asarray((after - before) / (2.0 * length))


VALLEY_ROUNDS = 2
"""What is left after the first correction has another direction."""

LEAST_ACTING = 0.5
"""Square of a direction's part that acts in a record, from which on that part takes up all that is missed there; of a
smaller one so much less: it would have to change by more than the slope that is missed."""

NEARLY_CANCELLED = 0.05
"""Norm of a combination of rows, each of norm 1, below which a hundredth of a row is no longer little."""

TOO_STEEP = 10.0 * NEARLY_CANCELLED
"""Slope along a valley, of rows of norm 1, that rows good to a hundredth cannot have missed: the difference was taken
over so short a step, or beside a motion so near to sticking, that it is none."""

VALLEY_STEP = 0.3
"""Longest move of any unknown along a valley to either side, in its own coordinate."""

LEAST_CHANGE, SHARE_OF_RESIDUAL = 3.0, 0.01
"""Norm, in standard deviations of the noise, by which a difference moves the residual: at least, and of its own."""

FAR_OFF = 10.0
"""Times that change at which a first difference is taken again over a smaller step, or a larger one where it is so much
less."""

LEAST_STEP = 1e-6
"""Smallest difference, in an unknown's own coordinate; a smaller one drowns in the stepper's own tolerance."""


def _acts(evaluator: Evaluator, unknown: Unknown) -> BoolArray:
    """(n_data,) whether an unknown can change a number of the residual."""
    if unknown.record is None:
        return np.ones(evaluator.n_data, bool)
    mine = [target.record.name == unknown.record for target in evaluator.targets]
    return np.repeat(mine, [target.n_data for target in evaluator.targets])


def _step(
    evaluator: Evaluator,
    state: _State,
    unknowns: tuple[Unknown, ...],
    prior: FloatArray,
    rows: FloatArray,
    damping: float,
    tries: int,
    *,
    bent: bool,
) -> tuple[_State, float, float]:
    """The best of a few damped steps, bent or straight; the decrease that a linear model promised; the next damping.

    Where none of them takes anything away, shorter ones are tried, so many times in all.
    """
    gradient = rows @ state.residual + prior * state.x
    normal = rows @ rows.T + np.diag(prior)
    size = np.maximum(np.diag(normal), 1e-12 * np.max(np.diag(normal), initial=1e-300))
    best, promised = replace(state, cost=np.inf), 0.0
    factors = BENT_DAMPINGS if bent else DAMPINGS[: max(2, evaluator.jobs)]
    for _ in range(tries):
        held = [normal + factor * damping * np.diag(size) for factor in factors]
        steps = [_bounded(_free_step(state, unknowns, each, gradient)) for each in held]
        ways = _bent(evaluator, state, unknowns, rows, held, steps) if bent else steps
        trials = [at_coordinates(state.hypothesis, unknowns, state.x + way) for way in ways]
        results = evaluator.residuals([(trial, None) for trial in trials])
        for factor, trial, residual, step in zip(factors, trials, results, steps, strict=True):
            if residual is None:
                continue
            x = coordinates(trial, unknowns)
            cost = float(residual @ residual + prior @ x**2)
            if cost < best.cost:
                best = _State(trial, x, residual, cost)
                promised, chosen = _promise(gradient, normal, step), factor
        if best.cost < state.cost:
            return best, promised, float(np.clip(damping * chosen, 1e-9, 1e6))
        if max(_promise(gradient, normal, step) for step in steps) < LEAST_GAIN:  # nothing is left to take
            break
        damping = min(damping * 100.0, 1e6)
    return best, promised, damping


def _promise(gradient: FloatArray, normal: FloatArray, step: FloatArray) -> float:
    """By how much the cost would fall, were the model linear."""
    return float(-2.0 * gradient @ step - step @ normal @ step)


def _bent(
    evaluator: Evaluator,
    state: _State,
    unknowns: tuple[Unknown, ...],
    rows: FloatArray,
    held: Sequence[FloatArray],
    steps: Sequence[FloatArray],
) -> list[FloatArray]:
    """The steps bent along the valley: to second order, from the residual's second derivative along each of them.

    A step whose bend is no small part of it, or that a bound stops, is left straight. Source: M. K. Transtrum and J. P.
    Sethna, Improvements to the Levenberg-Marquardt algorithm for nonlinear least-squares minimization, arXiv:1201.5885
    (2012), eq. 25 to 28.
    """
    probes = [at_coordinates(state.hypothesis, unknowns, state.x + PROBED * step) for step in steps]
    bent: list[FloatArray] = []
    seen = evaluator.residuals([(each, None) for each in probes])
    for normal, step, probe, residual in zip(held, steps, probes, seen, strict=True):
        way, moves = step.copy(), np.flatnonzero(step)
        if residual is not None and len(moves) and np.allclose(coordinates(probe, unknowns) - state.x, PROBED * step):
            second = 2.0 / PROBED * ((residual - state.residual) / PROBED - step @ rows)
            bend = -np.linalg.solve(normal[np.ix_(moves, moves)], rows[moves] @ second)
            size = np.diag(normal)[moves]
            if 2.0 * np.sqrt(bend**2 @ size) <= LARGEST_BEND * np.sqrt(step[moves] ** 2 @ size):
                way[moves] += 0.5 * bend
        bent.append(_bounded(way))
    return bent


PROBED, LARGEST_BEND = 0.1, 0.75
"""Share of a step at which its second derivative is taken; twice the bend over the step up to where it is believed."""

BENT_DAMPINGS = (1.0, 0.2, 5.0)
"""Factors on the damping tried together once a step brought less than it promised, or had to be shortened."""


def _free_step(state: _State, unknowns: tuple[Unknown, ...], normal: FloatArray, gradient: FloatArray) -> FloatArray:
    """Newton's step in the unknowns that it does not push out of their bounds."""
    free = np.ones(len(gradient), dtype=bool)
    step = np.zeros_like(gradient)
    for _ in range(len(gradient)):
        step[:] = 0.0
        step[free] = -np.linalg.solve(normal[np.ix_(free, free)], gradient[free])
        stuck = [k for k in np.flatnonzero(free).tolist() if _at_bound(unknowns[k], state, k, step[k])]
        if not stuck:
            break
        free[stuck] = False
    return step


def _at_bound(unknown: Unknown, state: _State, k: int, move: float) -> bool:
    """The unknown cannot move that way at all."""
    if move == 0.0:
        return False
    nudge = np.sign(move) * min(abs(move), unknown.step)
    moved = unknown.get(unknown.set(state.hypothesis, state.x[k] + nudge))
    return bool(abs(moved - state.x[k]) < AT_BOUND * abs(nudge))


AT_BOUND = 1e-3


def _bounded(step: FloatArray) -> FloatArray:
    largest = np.abs(step).max(initial=0.0)
    return step * min(1.0, LARGEST_STEP / largest) if largest > 0 else step
