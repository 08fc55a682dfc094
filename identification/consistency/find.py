"""All contradictions of a calibrated model, the plainest first; none where one set of numbers is enough.

Wrong numbers within their tolerances are no effects. A number that must leave its tolerance, that drifts between
records, levels or times, or that fits the first modes and fails on others or on a record held out, is a finding.
docs/theory.md, "One set of numbers", derives the tests.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from identification.calibrate import STRAINED_SHARE, strained
from identification.consistency import words
from identification.consistency.cells import cells_of, weighted
from identification.consistency.finding import CalibrationFinding, least_sigma
from identification.consistency.held_out import HeldOut, held_out
from identification.consistency.modes import ModeBands, clearly_larger, missed_modes, mode_bands
from identification.consistency.noise_seen import Scatter
from identification.consistency.own_values import Groups, OwnValues, Parts
from identification.evaluate import Evaluator, TimeTarget
from identification.evidence import misfit_of, unit_of
from identification.fit import Fit, inverse_of, prior_of
from identification.hypothesis import LARGEST_SIGMA, RigUnknown, coordinates
from identification.intervals import finer
from identification.rest_target import ModesTarget
from models.rig import Rig

FALSE_ALARM = 0.01
"""Probability of any finding where nothing is wrong: half for the tolerances, half for what the noise could feign."""

MOST = 6
"""Findings at most, the first of each kind before the second of any."""

MOST_OF_A_KIND = 2

ELSEWHERE = 2
"""Group of the data that take no part in a comparison of two."""


@dataclass(frozen=True, eq=False)
class _Comparison:
    """A number is given a value of its own in each group of cells; those compared are of these records."""

    parts: Parts
    groups: Groups
    compared: tuple[int, ...]
    records: tuple[int, ...]
    tell: Callable[[RigUnknown, OwnValues, Sequence[str]], CalibrationFinding]


def calibration_findings(evaluator: Evaluator, found: Fit, rng: np.random.Generator) -> tuple[CalibrationFinding, ...]:
    """What speaks against one set of numbers within the tolerances, the most significant first.

    What the steps of the model could feign is not told: a finding is one where steps are finer too.

    Args:
        evaluator: records that were fitted.
        found: the calibrated model at its minimum.
        rng: of realisations of the excitations' noise, asked for only where something stands out.
    """
    first = _findings(evaluator, found, rng)
    if not evaluator.timed or all(finding.what == "tolerance" for finding in first):
        return first
    residual = finer(evaluator, found.hypothesis).residuals([(found.hypothesis, None)])[0]
    if residual is None:
        return first
    again = _findings(evaluator, replace(found, residual=residual), rng)
    both = {(finding.what, finding.number) for finding in first}
    return tuple(finding for finding in again if (finding.what, finding.number) in both)


def beyond_models(findings: Sequence[CalibrationFinding], found: Fit) -> tuple[CalibrationFinding, ...]:
    """Those that two ways to compute the same rig do not make between them, where the noise is reached.

    Nothing else is left then that could make them: a Young's modulus that two converged codes tell 0.05 % apart is five
    and more deviations of the noise. Numbers that left their tolerance are held against that, not against the noise.

    Args:
        findings: of the calibrated model.
        found: that model, whose residual is the noise.
    """
    least = least_sigma(FALSE_ALARM, len(findings)) * np.sqrt(unit_of(found.repeats, found.ratio, found.n_data))
    return tuple(each for each in findings if each.what == "tolerance" or each.sigma > least)


def pushed_out(evaluator: Evaluator, found: Fit, rng: np.random.Generator) -> list[RigUnknown]:
    """The numbers at the end of their tolerance that lie further out than it and the force's noise together put them.

    Where neighbouring motions part, what the measured force has wrong acts like another set of numbers.

    Args:
        evaluator: records that were fitted.
        found: the calibrated model at its minimum.
        rng: of realisations of the excitations' noise, asked for only where a number is at its end.
    """
    at_end = strained(found)
    if not at_end:
        return []
    rig = {i: u for i, u in enumerate(found.unknowns) if isinstance(u, RigUnknown)}
    data = weighted(evaluator, found, mode_bands(evaluator, found.hypothesis).edge)
    beyond = _beyond(Scatter(evaluator, found.hypothesis, data, rng), found, rig)
    return [rig[i] for i in beyond if rig[i] in at_end]


def _findings(evaluator: Evaluator, found: Fit, rng: np.random.Generator) -> tuple[CalibrationFinding, ...]:
    """The same at the steps of the fit."""
    rig = {i: u for i, u in enumerate(found.unknowns) if isinstance(u, RigUnknown)}
    if not rig:
        return ()
    x = coordinates(found.hypothesis, found.unknowns)
    prior = prior_of(found.unknowns)
    bands = mode_bands(evaluator, found.hypothesis)
    data = weighted(evaluator, found, bands.edge)
    scatter = Scatter(evaluator, found.hypothesis, data, rng)
    by_band = Parts(tuple(cells_of(data, in_time=False)), x, prior, in_time=False)
    by_time = Parts(tuple(cells_of(data, in_time=True)), x, prior, in_time=True)
    comparisons = _comparisons(evaluator, found.hypothesis.rig, by_band, by_time, bands)
    n_records = len(evaluator.targets)
    tests = len(rig) * len(comparisons) + (2 * n_records if n_records > 1 else 0) + 1
    least = least_sigma(0.5 * FALSE_ALARM, tests)
    findings = _out_of_tolerance(scatter, found, rig)
    for comparison in comparisons:
        findings += _disagreements(scatter, comparison, rig, least)
    missed = missed_modes(evaluator, found, bands)
    if missed is not None and missed.sigma > least:
        findings.append(words.modes_missed(missed))
    if n_records > 1:
        findings += _records_apart(scatter, found, by_band, least)
    return _plainest(findings)


def _out_of_tolerance(scatter: Scatter, found: Fit, rig: Mapping[int, RigUnknown]) -> list[CalibrationFinding]:
    """Numbers that left their tolerance, told."""
    strained_from, std, x = STRAINED_SHARE * LARGEST_SIGMA, found.std(), coordinates(found.hypothesis, found.unknowns)
    return [
        words.left_tolerance(rig[i], float(x[i]), float(np.hypot(std[i], far.moved)), strained_from, far.sigma)
        for i, far in _beyond(scatter, found, rig).items()
    ]


@dataclass(frozen=True)
class _Far:
    """A number that left its tolerance.

    Attributes:
        sigma: of where it would be if no fit held it back, by the tolerance and the force's noise together.
        moved: by the force's noise, in tolerances.
    """

    sigma: float
    moved: float


def _beyond(scatter: Scatter, found: Fit, rig: Mapping[int, RigUnknown]) -> dict[int, _Far]:
    """Numbers further from the rig file than one of so many true ones, and than the force's noise moves them.

    Held against what the owner says, the records speak in the unit of the model's own error: a number that they hardly
    tell goes as far as it can for a two-thousandth of what is left.
    """
    x = coordinates(found.hypothesis, found.unknowns)
    least = min(least_sigma(0.5 * FALSE_ALARM, len(rig)), STRAINED_SHARE * LARGEST_SIGMA)
    far = [i for i in rig if abs(x[i]) > least]
    if not far:
        return {}
    prior, unit = prior_of(found.unknowns), misfit_of(found)
    told = inverse_of(found.jacobian @ found.jacobian.T / unit + np.diag(prior))
    unheld = x - told @ (found.jacobian @ found.residual / unit + prior * x)
    moved = scatter.moved(found)
    seen = {i: _Far(abs(float(unheld[i])) / float(np.hypot(1.0, moved[i])), float(moved[i])) for i in far}
    return {i: each for i, each in seen.items() if each.sigma > least}


def _comparisons(evaluator: Evaluator, rig: Rig, by_band: Parts, by_time: Parts, bands: ModeBands) -> list[_Comparison]:
    """Between records, between low and high modes, and between early and late in each record."""
    targets = evaluator.targets
    every, rows = tuple(range(len(targets))), []
    if len(targets) > 1:
        quantity = "" if rig.excitation is None else rig.excitation.quantity
        tell = partial(words.between_records, targets=targets, quantity=quantity)
        groups = tuple(cell.record for cell in by_band.cells)
        rows.append(_Comparison(by_band, groups, every, every, tell))
    if bands.edge is not None:
        shapes = {k for k, target in enumerate(targets) if isinstance(target, ModesTarget)}
        groups = tuple(ELSEWHERE if cell.record in shapes else cell.part for cell in by_band.cells)
        rows.append(_Comparison(by_band, groups, (0, 1), every, partial(words.between_modes, bands=bands)))
    for k, target in enumerate(targets):
        if isinstance(target, TimeTarget):
            groups = tuple(cell.part if cell.record == k else ELSEWHERE for cell in by_time.cells)
            rows.append(_Comparison(by_time, groups, (0, 1), (k,), partial(words.between_times, target=target)))
    return rows


def _disagreements(
    scatter: Scatter, comparison: _Comparison, rig: Mapping[int, RigUnknown], least: float
) -> list[CalibrationFinding]:
    """The numbers that disagree most, each beside those before it: what imitates the first is not told again.

    Of numbers that explain nearly as much, the one that has to drift least by its owner's tolerance is told, and the
    others are named beside it.
    """
    beside: dict[int, Groups] = {}
    findings = []
    for _ in range(MOST_OF_A_KIND):
        own = _borne_out(scatter, comparison, [i for i in rig if i not in beside], beside, least)
        most = max((values.sigma for values in own.values()), default=0.0)
        if most <= least:
            break
        alike = sorted((i for i in own if own[i].sigma >= ALIKE * most), key=lambda i: float(np.ptp(own[i].x)))
        beside[alike[0]] = comparison.groups
        others = tuple(rig[i].parameter.label for i in alike[1:])
        findings.append(comparison.tell(rig[alike[0]], own[alike[0]], others))
    return findings


def _borne_out(
    scatter: Scatter, comparison: _Comparison, numbers: Sequence[int], beside: Mapping[int, Groups], least: float
) -> dict[int, OwnValues]:
    """Values of those numbers that count, with significances that the noise, as it comes to the data, bears out."""
    parts, missed = comparison.parts, sum(scatter.data[k].missed for k in comparison.records)
    plain = {i: parts.own_values(i, comparison.groups, comparison.compared, beside) for i in numbers}
    own: dict[int, OwnValues] = {}
    most = least
    for i in sorted(plain, key=lambda i: -plain[i].sigma):
        values = plain[i]
        if values.sigma <= least or values.sigma < ALIKE * most or values.chi2 < LEAST_SHARE * missed:
            continue
        sigma = scatter.sigmas(parts, values.weighs, values.moves, values.chi2, len(values.groups) - 1, least)
        own[i] = replace(values, sigma=sigma)
        most = max(most, sigma)
    return own


LEAST_SHARE = 0.02
"""Share of the squared misfit beyond the noise that a finding takes away: a misfit has no law by which less is told."""

ALIKE = 0.75
"""Share of the greatest significance from which a number explains what drifts for all that one can say."""


def _records_apart(scatter: Scatter, found: Fit, parts: Parts, least: float) -> list[CalibrationFinding]:
    """The record that the others predict worst, if one is not predicted."""
    rows = []
    for k, target in enumerate(scatter.evaluator.targets):
        is_its_own = np.array([unknown.record == target.record.name for unknown in found.unknowns], dtype=bool)
        held = held_out(scatter.data, parts, k, is_its_own)
        counts = held.chi2 >= LEAST_SHARE * scatter.data[k].missed
        own = scatter.sigmas(parts, held.weighs, held.moves, held.chi2, held.degrees, least) if counts else 0.0
        sigma = max(own, _beyond_the_others(scatter.evaluator, held, found.repeats))
        if sigma > least:
            rows.append(words.record_apart(held, target, sigma))
    return sorted(rows, key=lambda row: -row.sigma)[:1]


def _beyond_the_others(evaluator: Evaluator, held: HeldOut, repeats: float) -> float:
    """Significance of a record that is met clearly worse than the others even with its own share in the numbers."""
    mine = evaluator.targets[held.record].n_data
    rest = evaluator.n_data - mine
    return clearly_larger(held.fitted, int(mine / repeats), held.others, int(rest / repeats))


def _plainest(findings: list[CalibrationFinding]) -> tuple[CalibrationFinding, ...]:
    """The first of each kind, then the most significant of the others, as many as a person reads."""
    ordered = sorted(findings, key=lambda finding: -finding.sigma)
    kinds = [finding.what for finding in ordered]
    first = [f for k, f in enumerate(ordered) if f.what not in kinds[:k]]
    rest = [f for f in ordered if f not in first]
    return tuple(sorted((*first, *rest[: MOST - len(first)]), key=lambda finding: -finding.sigma))
