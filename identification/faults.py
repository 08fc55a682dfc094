"""What the channels say of the measurement itself, before any physics is blamed.

A sensor that is dead, upside down, late, mis-scaled or displaced contradicts all others, and physics that explains one
channel alone is rare: so each channel is left out in turn, and the rig's numbers are fitted to the rest. Two sensors
whose cables were exchanged agree again when they are exchanged once more. A hum, or a floor that shakes, stands in a
few lines of all channels: so these lines are left out. A force in another unit, or upside down, makes all channels
louder or quieter by one factor, or turns them over.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations, islice
from math import inf

import numpy as np

from identification.at_rest import linear_model
from identification.calibrate import beginning, concerning
from identification.evaluate import Evaluator, TimeTarget, unwhitened, whitened
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis
from identification.lines import lines_left
from identification.parallel import in_parallel
from identification.reached import FAINT
from identification.scene import each_sensor
from identification.screen import Projection
from identification.sketch import afresh
from identification.together import off_by
from models.arrays import BoolArray, FloatArray
from models.band_limit import SCORE_EDGE
from models.effects import Place, Registry
from models.linear import natural_modes
from models.rig import Rig

PLAINLY = 0.3
"""Share of the excess of chi-square over the noise that is left at most without what is at fault."""

MOSTLY = 0.5
"""The same without a few lines of thousands; what a floor does as it begins to shake is no line."""

LARGE = 3.0
"""Residual over noise above which slopes say too little, and the numbers are fitted without each channel."""

MOST_SENSORS = 2
"""At fault at once; where more disagree, it is not the sensors."""

MOST_PAIRS, PROMISED = 3, 0.7
"""Pairs that are exchanged in a fit, and the share of the excess that slopes leave of them at most."""

HOPED = 0.7
"""Share of the excess that a look leaves, or slopes where the fit with all channels has ended, of what is fitted in
full at most."""

LEAST_SENSORS = 3
"""Channels of which one can be outvoted."""

WINDOW = (0.1, 0.75)
"""Share of the response's energy, and seconds at least, on which channels are left out in turn."""

AROUND = 3.0
"""Lines of the record on either side of one that are left out with it: the record's ends make it wide."""

ITERATIONS, ITERATIONS_LOOK, TOLERANCE = 6, 14, 1e-2
"""Of the rig's numbers without a channel, and of the look that tells whether it is worth them."""


@dataclass(frozen=True)
class Suspicion:
    """What is wrong with the measurement, as far as the channels say.

    Attributes:
        channels: sensors without which the others agree, the worst first, or a pair that agrees when it is exchanged.
        in_lines: all that is left stands in single lines.
        of_force: all channels are off by one factor, or upside down.
        words: what was seen, for the report; empty where nothing was.
    """

    channels: tuple[Place, ...] = ()
    in_lines: bool = False
    of_force: bool = False
    words: str = ""

    def __bool__(self) -> bool:
        """Something is suspected."""
        return bool(self.channels) or self.in_lines or self.of_force

    def kinds(self, registry: Registry) -> Registry:
        """The kinds of effects that could do this.

        Args:
            registry: all kinds.
        """
        sits = {"sensor" if place.other is None else "sensor pair" for place in self.channels}
        return {
            name: kind
            for name, kind in registry.items()
            if sits & set(kind.places)
            or (kind.record_parameters and self.in_lines)
            or (kind.is_of_excitation() and self.of_force)
        }

    def beside(self, rig: Rig) -> tuple[Place, ...]:
        """Where effects on channels may sit if physics is looked for as well: on every sensor, and on a suspected pair.

        Args:
            rig: with the sensors.
        """
        return (*each_sensor(rig), *(place for place in self.channels if place.other is not None))


NO_SUSPICION = Suspicion()


def suspicion(evaluator: Evaluator, there: Fit) -> Suspicion:
    """What the channels say of the measurement beside a calibrated model.

    Args:
        evaluator: records, at the resolution of the search.
        there: the calibrated model on them.
    """
    if not evaluator.timed:
        return NO_SUSPICION
    evaluator, there = _in_time(evaluator, there)
    shared = _of_force(evaluator, there) or _in_lines(evaluator, there)
    if shared:
        return shared
    there_are = {name for target in evaluator.timed for name in target.record.sensors}
    names = [sensor.name for sensor in there.hypothesis.rig.sensors if sensor.name in there_are]
    if len(names) < 2:
        return NO_SUSPICION
    alone = [Place(sensor=name) for name in names] if len(names) >= LEAST_SENSORS else []
    pairs = [Place(sensor=one, other=other) for one, other in combinations(names, 2)]
    rows = [_left_beside(evaluator, there, [*alone, *pairs])]
    if there.ratio >= LARGE:
        rows.append(_left_in(beginning(evaluator, *WINDOW), there, alone, pairs))
    left = min(rows, key=lambda row: min(row.values(), default=1.0))
    at_fault = sorted((place for place in left if left[place] < PLAINLY), key=left.__getitem__)
    if not at_fault:
        return NO_SUSPICION
    worst = at_fault[0]
    remains = f"{max(left[worst], 0.0):.0%} of the misfit is left"
    if worst.other is not None:
        words = f"{worst.sensor} and {worst.other} seem to be exchanged: exchanged once more, {remains}"
        return Suspicion((worst,), words=words)
    words = f"{worst.sensor} contradicts the other channels: without it {remains}"
    return Suspicion(tuple(place for place in at_fault if place.other is None)[:MOST_SENSORS], words=words)


def _in_time(evaluator: Evaluator, there: Fit) -> tuple[Evaluator, Fit]:
    """The time records alone, and a fit's residual and slopes there: FRFs and mode shapes have no channels in time."""
    if not evaluator.at_rest:
        return evaluator, there
    timed = evaluator.with_targets(evaluator.timed)
    is_timed = [isinstance(target, TimeTarget) for target in evaluator.targets]
    mine = np.repeat(is_timed, [target.n_data for target in evaluator.targets])
    residual = there.residual[mine]
    return timed, replace(
        there,
        residual=residual,
        jacobian=there.jacobian[:, mine],
        chi2=float(residual @ residual),
        n_data=timed.n_judged,
    )


def _left_beside(evaluator: Evaluator, there: Fit, faults: Sequence[Place]) -> dict[Place, float]:
    """Share of the excess that is left without each channel or with each pair exchanged, by the numbers' slopes."""
    whole = _left_of(there)
    return {fault: _left_of(_mended(evaluator, there, fault)) / whole if whole > 0.0 else 1.0 for fault in faults}


def _left_of(there: Fit) -> float:
    return Projection(there).misfit - there.n_data


def _mended(evaluator: Evaluator, there: Fit, fault: Place) -> Fit:
    """The fit's residual and slopes as they would be without a channel, or with two exchanged."""
    rows, residuals, n_data = [], [], 0.0
    ends = np.cumsum([target.n_data for target in evaluator.timed])
    for target, end in zip(evaluator.timed, ends, strict=True):
        part = slice(end - target.n_data, end)
        slopes, residual = there.jacobian[:, part], there.residual[part]
        if fault.other is None:
            kept = np.repeat([name != fault.sensor for name in target.record.sensors], 2 * target.measured.shape[1])
            slopes, residual = slopes[:, kept], residual[kept]
        else:
            mended = _without_fault(target, fault)
            model = unwhitened(residual, target) * np.sqrt(target.record.n_samples) + target.measured
            residual = whitened(model - mended.measured, mended)
            slopes = slopes * np.repeat(np.sqrt(target.density / mended.density), 2)
        rows.append(slopes)
        residuals.append(residual)
        n_data += target.n_judged * len(residual) / target.n_data
    return replace(
        there, jacobian=np.concatenate(rows, axis=1), residual=np.concatenate(residuals), n_data=round(n_data)
    )


def _without_fault(target: TimeTarget, fault: Place) -> TimeTarget:
    """The record without a channel, or with two of them exchanged; as it is without a fault."""
    if fault.sensor is None:
        return target
    return target.without(fault.sensor) if fault.other is None else target.exchanged(fault.sensor, fault.other)


def _left_in(window: Evaluator, there: Fit, alone: Sequence[Place], pairs: Sequence[Place]) -> dict[Place, float]:
    """The same with the numbers fitted on the beginning of the records; of the pairs only those that slopes promise.

    A look tells which of them are fitted in full, besides slopes where the fit with all channels as they are has ended;
    the most promising one always is. The shares of the others are those of their looks.
    """
    grounds = list(_grounds(window, there))
    promised = [_left_beside(window, ground, pairs) for ground in grounds]
    least = {pair: min((row[pair] for row in promised), default=1.0) for pair in pairs}
    promising = [pair for pair in sorted(pairs, key=least.__getitem__)[:MOST_PAIRS] if least[pair] < PROMISED]
    faults = [*alone, *promising]
    asked = [(Place(), False), *((fault, True) for fault in faults)]
    whole, *looks = _fitted_without(window, grounds, asked)
    if whole is None or whole.ratio <= FAINT:
        return dict.fromkeys(faults, 1.0)
    left = {fault: _beyond_noise(look) / _beyond_noise(whole) for fault, look in zip(faults, looks, strict=True)}
    beside = _left_beside(window, whole, faults)
    hope = {fault: min(left[fault], beside[fault]) for fault in faults}
    best_first = sorted(faults, key=hope.__getitem__)
    likely = [fault for fault in best_first if fault is best_first[0] or hope[fault] < HOPED]
    fitted = _fitted_without(window, grounds, [(fault, False) for fault in likely])
    shares = {fault: _beyond_noise(full) / _beyond_noise(whole) for fault, full in zip(likely, fitted, strict=True)}
    return {fault: min(left[fault], shares.get(fault, left[fault])) for fault in faults}


def _fitted_without(window: Evaluator, grounds: Sequence[Fit], asked: Sequence[tuple[Place, bool]]) -> list[Fit | None]:
    """The rig's numbers fitted without each fault, from the ground that is better for it; None where all diverge.

    Args:
        window: records to fit.
        grounds: the models that fits start from.
        asked: each fault, and whether a look is enough.
    """
    work = partial(_begun_at, window.with_jobs(1))
    items = [(ground, fault, is_look) for fault, is_look in asked for ground in grounds]
    found = iter(in_parallel(window.jobs, work, items))
    fits = [[one for one in islice(found, len(grounds)) if one is not None] for _ in asked]
    return [min(each, key=_beyond_noise, default=None) for each in fits]


def _begun_at(window: Evaluator, asked: tuple[Fit, Place, bool]) -> Fit | None:
    """The rig's numbers fitted without a fault from one ground; None where that diverges.

    A fault changes no motion, so that each fit begins with the slopes that all share; in a mere look these follow its
    steps, which take two runs each, and are never formed anew.
    """
    ground, fault, is_look = asked
    mended = [_without_fault(target, fault) for target in window.timed]
    heard = window.with_targets([target for target in mended if target.record.sensors])
    unknowns = concerning(ground, heard)
    slopes = _mended(window, ground, fault).jacobian[[ground.unknowns.index(unknown) for unknown in unknowns]]
    try:
        return fit(
            heard,
            ground.hypothesis,
            unknowns,
            max_iterations=ITERATIONS_LOOK if is_look else ITERATIONS,
            jacobian=slopes,
            keep=is_look,
            along_steps=is_look,
            formed=not is_look,
            tolerance=TOLERANCE,
        )
    except ArithmeticError:
        return None


def _beyond_noise(found: Fit | None) -> float:
    """What a fit leaves beyond the noise, with what its numbers are off; no number where there is none."""
    return inf if found is None else found.cost - found.n_data


def _grounds(window: Evaluator, there: Fit) -> Iterator[Fit]:
    """The models that fits on the beginning start from, with their slopes; without those that diverge."""
    for start in _starts(there):
        try:
            yield fit(window, start, concerning(there, window), max_iterations=0)
        except ArithmeticError:
            continue


def _starts(base: Fit) -> Iterator[Hypothesis]:
    yield base.hypothesis
    if base.hypothesis.values and not base.hypothesis.effects:
        yield replace(base.hypothesis, values={})


def _of_force(evaluator: Evaluator, base: Fit) -> Suspicion:
    """Whether all channels of each record driven by a measured force are off by one factor, or upside down.

    Beside the numbers as given: a force that is wrong pulls them to where hardly anything is alike.
    """
    excitation = base.hypothesis.rig.excitation
    if excitation is None or excitation.quantity != "force":
        return NO_SUSPICION
    try:
        responses = evaluator.responses(afresh(base.hypothesis))
    except ArithmeticError:
        return NO_SUSPICION
    pairs = zip(evaluator.timed, responses, strict=True)
    driven = [(t.record, r.channels[:, : t.record.n_samples]) for t, r in pairs if t.record.excitation is not None]
    seen = [off_by(record.responses, model) for record, model in driven]
    return Suspicion(of_force=True, words=f"{driven[0][0].name}: {seen[0]}") if seen and all(seen) else NO_SUSPICION


def _in_lines(evaluator: Evaluator, base: Fit) -> Suspicion:
    """Whether all that the model leaves stands in lines that it does not explain, and at no resonance of its own.

    A lightly damped resonance that is a little off leaves lines as narrow as a hum does.
    """
    seen = lines_left(evaluator, base.hypothesis).free
    resonances = _resonances(evaluator, base.hypothesis) if seen else np.empty(0)
    frequencies = tuple(line for line in seen if np.all(abs(resonances / line - 1.0) > RESONANT))
    if not frequencies:
        return NO_SUSPICION
    residual = base.residual
    outside = np.concatenate([_outside(target, frequencies) for target in evaluator.timed])
    shares = np.concatenate([np.full(target.n_data, target.n_judged / target.n_data) for target in evaluator.timed])
    excess = float(residual @ residual) - base.n_data
    left = float(residual[outside] @ residual[outside]) - float(shares[outside].sum())
    if not excess > 0.0 or left > MOSTLY * excess:
        return NO_SUSPICION
    told = ", ".join(f"{frequency:.4g}" for frequency in sorted(frequencies))
    words = (
        f"what is left stands in single lines at {told} Hz: without them {max(left / excess, 0.0):.0%} of it remains"
    )
    return Suspicion(in_lines=True, words=words)


def _resonances(evaluator: Evaluator, hypothesis: Hypothesis) -> FloatArray:
    """Natural frequencies, Hz, with the sleeves as they are at rest and with all of them open."""
    band = SCORE_EDGE * max(target.record.fs for target in evaluator.timed)
    linear = linear_model(hypothesis, band)
    held = natural_modes(linear, (), band).natural_freqs
    opened = linear.model.omega / (2.0 * np.pi)
    return np.concatenate([held, opened[(opened > 0.0) & (opened < band)]])


RESONANT = 0.02
"""Distance of a line from a resonance, as a share of its frequency, within which it belongs to that."""


def _outside(target: TimeTarget, frequencies: tuple[float, ...]) -> BoolArray:
    """(n_data,) whether an entry of the residual is away from all of these frequencies, Hz."""
    lines = np.arange(target.measured.shape[1]) * target.record.fs / target.record.n_samples
    near = np.abs(lines[:, None] - np.array(frequencies)) < AROUND * target.record.fs / target.record.n_samples
    return np.repeat(np.tile(~near.any(axis=1), len(target.measured)), 2)
