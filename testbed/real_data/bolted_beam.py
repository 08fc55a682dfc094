"""The Brake-Reuss beam: two halves bolted together, a joint that slips a little at any level and more at higher ones.

Sources: W. Chen et al., MSSP 166 (2022) 108401; M. Jin et al., MSSP 166 (2022) 108402.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from identification.evaluate import Evaluator
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis, rig_unknowns
from identification.progress import Progress
from identification.stepped_sine.balance import Balance
from identification.stepped_sine.record import SteppedSine
from identification.stepped_sine.search import Addition, add_effects, on_trial
from identification.stepped_sine.target import SteppedTarget, scatter
from models.arrays import ComplexArray
from models.effects import EFFECTS
from models.errors import DivergenceError, InputError
from models.rig import Excitation, Oscillator, Rig, Sensor
from testbed.real_data.bars import Bar
from testbed.real_data.files import read_variables, set_folder

SOURCE = "github.com/mattiacenedese/BRBtesting"
FILE = "ForcedFrequencyResponses.mat"

HELD_OUT = 2
"""Index of the force level that is kept aside; the others are learnt from."""

HELD_OUT_BAR = 4.5
"""M/s^2, rms of the complex amplitude."""

HYSTERESIS = "bouc_wen"
"""The kind of the library with a memory of where it slipped."""

TOLERANCES = {"mass": 0.2, "stiffness": 0.2, "damping": 1.0}
"""One standard deviation of what the lowest level tells; of the damping hardly anything, it is the joint's in part."""


@dataclass(frozen=True, eq=False)
class Suspect:
    """A kind in the place of another, with everything fitted again.

    Attributes:
        label: kind and variant.
        log_odds: natural logarithm of the odds of the best one in that place against it.
        held_out: rms error at the level kept aside, m/s^2, or None where it has no steady state there.
    """

    label: str
    log_odds: float
    held_out: float | None


@dataclass(frozen=True, eq=False)
class BoltedBeam:
    """The finished study.

    Attributes:
        levels: the tests.
        noise: standard deviation of real and imaginary part that all lines are judged in, m/s^2.
        models: label -> fit, from the linear mode of the lowest level to the final model.
        errors: label -> rms error at each level, m/s^2, None where there is no steady state.
        rounds: what was tried in each round of adding.
        alone: every kind by itself beside the linear mode, the best first; empty where nothing was added.
        trial: every kind in the place of the hysteresis, the hysteresis first; empty where it was not found.
        decisions: in words.
        predicted: label -> level -> (n,) complex amplitudes, m/s^2, of the models that have them.
    """

    levels: Sequence[SteppedSine]
    noise: float
    models: Mapping[str, Fit]
    errors: Mapping[str, Sequence[float | None]]
    rounds: Sequence[Addition]
    alone: Sequence[Suspect]
    trial: Sequence[Suspect]
    decisions: Sequence[str]
    predicted: Mapping[str, Sequence[ComplexArray | None]]

    @property
    def final(self) -> str:
        """Label of the last model."""
        return list(self.models)[-1]

    @property
    def bars(self) -> tuple[Bar, ...]:
        """What it has to reach."""
        first = self.trial[0].label if self.trial else "nothing with a memory"
        held_out = self.errors[self.final][HELD_OUT]
        return (
            Bar("preferred where the joint slips", first, HYSTERESIS),
            Bar("level kept aside", float("inf") if held_out is None else held_out, HELD_OUT_BAR, "m/s^2"),
        )


def read_levels(folder: Path) -> list[SteppedSine]:
    """The force-controlled levels, the lowest first.

    The published phase is that of the displacement against the force, so that the acceleration stands against it.

    Args:
        folder: with the published files.

    Raises:
        InputError: a file that is missing or not the published one.
    """
    content = read_variables(set_folder(folder, "brake_reuss_beam") / FILE, ("FRdata",), SOURCE)["FRdata"]
    try:
        return [_level(f"level {k + 1}", row) for k, row in enumerate(content["ForceControl"])]
    except (KeyError, TypeError, IndexError) as error:
        raise InputError(
            f"{FILE}: FRdata.ForceControl is not as published ({error})",
            "it holds frequency, force, amplitude and phase of each level",
            f"get it again from {SOURCE}",
        ) from error


def _level(name: str, row: Mapping[str, Any]) -> SteppedSine:
    keys = ("frequency", "force", "amplitude", "phase")
    frequency, force, amplitude, phase = (np.ravel(row[key]).astype(float) for key in keys)
    accelerance = -amplitude * np.exp(1j * phase) / force
    return SteppedSine(name, frequency, ("acceleration",), accelerance[None], force=force)


def rig_of(level: SteppedSine) -> Rig:
    """One mode as the lowest level shows it: mass, stiffness and damping of a line through its dynamic stiffness.

    Args:
        level: stepped sine at which the joint holds nearly still.
    """
    omega = 2.0 * pi * level.frequency
    dynamic = -(omega**2) / level.values[0]
    weight = np.abs(level.responses[0]) / omega**2
    slope, constant = np.polyfit(omega**2, dynamic.real, 1, w=weight)
    damping = float(np.average(dynamic.imag / omega, weights=weight**2))
    return Rig(
        structure=Oscillator(kind="oscillator", mass=-float(slope), stiffness=float(constant), damping=damping),
        tolerances=TOLERANCES,
        excitation=Excitation(name="force", quantity="force"),
        sensors=(Sensor(name="acceleration", quantity="acceleration"),),
    )


def study_bolted_beam(folder: Path, jobs: int, progress: Progress) -> BoltedBeam:
    """Name what the joint does from three force levels and predict the fourth.

    Args:
        folder: with the published files.
        jobs: cores.
        progress: told what is being done.

    Raises:
        InputError: a file that is missing or not the published one.
    """
    levels = read_levels(folder)
    noise = float(np.sqrt(np.mean([scatter(level) ** 2 for level in levels])))
    targets = [SteppedTarget(level, noise) for level in levels]
    given = Hypothesis(rig_of(levels[0]))
    unknowns = rig_unknowns(given.rig)
    lowest = fit(Evaluator(targets[:1], 1), given, unknowns, max_iterations=ITERATIONS)
    learning = Evaluator([target for k, target in enumerate(targets) if k != HELD_OUT], jobs)
    base = fit(learning, lowest.hypothesis, unknowns, max_iterations=ITERATIONS, precise=True)
    rounds, decisions = add_effects(learning, base, EFFECTS, progress)
    models = {"linear, lowest level": lowest, "linear": base}
    models |= {f"+ {found.fit.hypothesis.effects[-1].label()}": found.fit for found in rounds}
    predicted = {label: [_predicted(model.hypothesis, level) for level in levels] for label, model in models.items()}
    errors = {label: [_rms(*pair) for pair in zip(rows, levels, strict=True)] for label, rows in predicted.items()}
    alone = _suspects(rounds[0], levels[HELD_OUT]) if rounds else ()
    trial = _trial(learning, rounds, levels[HELD_OUT], progress)
    return BoltedBeam(levels, noise, models, errors, rounds, alone, trial, decisions, predicted)


ITERATIONS = 40


def _trial(
    learning: Evaluator, rounds: Sequence[Addition], held_out: SteppedSine, progress: Progress
) -> tuple[Suspect, ...]:
    """Every kind in the place of the hysteresis of the final model."""
    kinds = [found.fit.hypothesis.effects[-1].kind for found in rounds]
    if HYSTERESIS not in kinds:
        return ()
    index = kinds.index(HYSTERESIS)
    # The round that added it last has tried them all beside the same others.
    last = index == len(kinds) - 1
    judged = rounds[index] if last else on_trial(learning, rounds[-1].fit, index, EFFECTS, progress)
    return _suspects(judged, held_out)


def _suspects(judged: Addition, held_out: SteppedSine) -> tuple[Suspect, ...]:
    """What was tried in one place, the best first."""
    first = judged.ranked[0].log_evidence
    return tuple(
        Suspect(
            row.effect.label(),
            first - row.log_evidence,
            _rms(_predicted(row.fit.hypothesis, held_out), held_out),
        )
        for row in judged.ranked
    )


def _predicted(hypothesis: Hypothesis, level: SteppedSine) -> ComplexArray | None:
    try:
        return np.asarray(Balance.of(hypothesis, level).steady_state()[0])
    except DivergenceError:
        return None


def _rms(predicted: ComplexArray | None, level: SteppedSine) -> float | None:
    return None if predicted is None else float(np.sqrt(np.mean(np.abs(predicted - level.responses[0]) ** 2)))
