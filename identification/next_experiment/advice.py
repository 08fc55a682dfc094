"""What to measure next where no group of effects is to be told apart."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from identification.evaluate import Evaluator
from identification.hypothesis import Hypothesis
from identification.locating.located import Located
from identification.next_experiment import candidates
from identification.next_experiment.bench import Bench
from identification.next_experiment.costs import COSTS
from identification.next_experiment.planned import PlannedTest
from identification.next_experiment.proposal import Proposal
from identification.prepare import horizons
from identification.result import ErrorMap, MissingForce, loudest
from models.arrays import FloatArray
from models.simulate import Settings, Trace

CHAOTIC = 1e4
"""Growth of a small disturbance over a record from which its motion cannot be followed."""

LOWER, HIGHER = (0.7, 0.5, 0.3, 0.2, 0.1), (2.0, 4.0)
"""Levels, times those of the records, that are tried for a motion that can be followed, or that reaches further."""


def lower_level(records: Evaluator, bench: Bench, model: Hypothesis) -> Proposal:
    """A level at which the motion can be followed.

    Args:
        records: so far.
        bench: the same in short.
        model: the best there is.
    """
    for factor in LOWER:
        limits = horizons(_louder(records, factor), model)
        if all(limit.growth <= CHAOTIC for limit in limits):
            break
    return Proposal(
        f"repeat at a lower level, {factor:g} times that of the records",
        f"neighbouring motions part too fast to be followed; at {factor:g} times the level they stay together",
        _steady(bench, factor),
    )


def higher_level(records: Evaluator, bench: Bench, model: Hypothesis, *, known: bool) -> Proposal:
    """A level at which the motion reaches what it has not reached so far.

    Args:
        records: so far.
        bench: the same in short.
        model: the best there is.
        known: whether an effect was found, that is, whether the model is to be tried or to be completed.
    """
    sleeves = [contact.sleeve for contact in model.plant().contacts]
    factor, found = _further(sleeves, {level: _pressed(records, model, level) for level in (1.0, *HIGHER)})
    reason = (
        "the updated model predicts what was kept aside; beyond these levels it has not been tried"
        if known
        else "a nonlinearity shows only where the motion reaches it"
    )
    words = f"repeat at a higher level, {factor:g} times that of the records"
    return Proposal(words, f"{reason}; {found}" if found else reason, _steady(bench, factor))


def _further(sleeves: Sequence[str], pressed: Mapping[float, FloatArray]) -> tuple[float, str]:
    """The least level at which a wall is touched that was not, and what is touched there, in words.

    Args:
        sleeves: names.
        pressed: (2, n_sleeves) largest force of each lower and upper wall, N, by level; 1 is that of the records.
    """
    if not sleeves:
        return HIGHER[0], ""
    now = pressed[1.0]
    for level in HIGHER:
        is_new = ((now == 0.0) & (pressed[level] > 0.0)).T.tolist()
        fresh = [
            f"{WALLS[wall, other]} of {name}"
            for name, (wall, other) in zip(sleeves, is_new, strict=True)
            if wall or other
        ]
        if fresh:
            return level, f"what no record has touched is touched there: {' and '.join(fresh)}"
    if np.any(now == 0.0):
        return HIGHER[-1], f"up to {HIGHER[-1]:g} times the level it reaches no other wall"
    deeper = float(pressed[HIGHER[0]].max() / now.max())
    return HIGHER[0], f"every wall has been touched; there they are pressed {deeper:.2g} times as hard"


WALLS = {(True, False): "the lower wall", (False, True): "the upper wall", (True, True): "both walls"}
"""Of a sleeve, by whether it is the lower and the upper one."""


def learn_from(records: Evaluator, bench: Bench, model: Hypothesis, missed: Sequence[str]) -> Proposal:
    """What was kept aside among the records learnt from, and another record kept aside.

    Args:
        records: learnt from so far.
        bench: the same in short.
        model: the best there is.
        missed: names of the records kept aside on which it does not hold.
    """
    test = _steady(bench, 1.0)
    names = " and ".join(missed)
    words = f"learn from {names} too, and keep another record aside"
    reasons = [f"what was learnt does not hold on {names}, so that tells what the others do not"]
    sleeves = [contact.sleeve for contact in model.plant().contacts]
    untouched = np.any(_pressed(records, model, 1.0) == 0.0, axis=0)
    if np.any(untouched):
        walls = " and ".join(name for name, is_open in zip(sleeves, untouched, strict=True) if is_open)
        reasons.append(f"no record learnt from has touched both walls of {walls}")
    return Proposal(f"{words}: {test.words}" if test else words, "; ".join(reasons), test)


def another_kind(bench: Bench) -> Proposal:
    """A record to be kept aside, of a kind that the fit has not seen."""
    test = candidates.swept(bench, COSTS, 1.0) if bench.level else None
    words = "a record that is kept aside (--holdout), of another kind than those fitted"
    return Proposal(f"{words}: {test.words}" if test else words, "to see whether the updated model predicts it", test)


def same_again(bench: Bench) -> Proposal:
    """The same test, of which it is seen first that it is one of this rig.

    Args:
        bench: the records so far.
    """
    return Proposal(
        "the same test again, once it is seen that it moves this rig, and which channel is which sensor's",
        "whatever its numbers, the model tells next to nothing of what was measured, as where that is noise, or of "
        "another rig",
        _steady(bench, 1.0),
    )


def more_of_what_is_left(
    bench: Bench, maps: Sequence[ErrorMap], forces: Sequence[MissingForce], located: Located | None
) -> Proposal:
    """Where and when nothing explains the motion, seen longer and at another level.

    Args:
        bench: the records so far.
        maps: errors of the best model.
        forces: that the calibrated model lacks.
        located: where one of them would explain it, if that was looked for.
    """
    parts = []
    band = bench.band
    if maps:
        worst = max(maps, key=lambda m: float(np.nanmax(_beyond(m))))
        line = int(np.nanargmax(np.nanmean(_beyond(worst), axis=0)))
        middle = float(worst.frequency[line])
        band = candidates.about(middle, band)
        parts.append(f"the model misses most about {middle:.3g} Hz in {worst.record}")
    place = _place(forces, located)
    if place:
        parts.append(f"the force that is missing acts at {place}")
    test = candidates.steady(bench, COSTS, 0.5, band, "level") if bench.level else None
    near = f", with a sensor at {place}" if place else ""
    return Proposal(
        f"half the level and the same level again, in a narrow band{near}",
        "; ".join([*parts, "how what is left grows with the level, and what it does at its place, tells its kind"]),
        test,
    )


def _place(forces: Sequence[MissingForce], located: Located | None) -> str:
    """Where the missing force acts; empty where no one place is told."""
    if located is not None:
        return "" if located.sensor else located.where
    return loudest(forces).place if forces else ""


def _beyond(error_map: ErrorMap) -> FloatArray:
    """(n_sensors, n_bands) error beyond the noise."""
    return np.maximum(error_map.by_frequency - error_map.noise_by_frequency, 0.0)


def _steady(bench: Bench, factor: float) -> PlannedTest | None:
    return candidates.steady(bench, COSTS, factor, bench.band, "level") if bench.level else None


def _louder(records: Evaluator, factor: float) -> Evaluator:
    """The time records with their excitation made larger; what began in motion moves more."""
    louder = []
    for target in records.timed:
        force = target.driven.excitation
        driven = replace(target.driven, excitation=None if force is None else factor * force)
        louder.append(target.driven_by(driven))
    return records.with_targets(louder)


def _pressed(records: Evaluator, model: Hypothesis, factor: float) -> FloatArray:
    """(2, n_contacts) largest force of each sleeve's lower and upper wall over all records, N."""
    started = replace(model, starts={name: factor * start for name, start in model.starts.items()})
    responses = _louder(records, factor).responses(started, Settings(trace=True))
    walls = [_walls(response.trace) for response in responses if response.trace is not None]
    return np.max(walls, axis=0) if walls else np.zeros((2, 0))


def _walls(trace: Trace) -> FloatArray:
    """(2, n_contacts) largest force upwards, from the lower wall, and downwards."""
    return np.stack([trace.contact_forces.max(axis=1, initial=0.0), -trace.contact_forces.min(axis=1, initial=0.0)])
